//! The layout of texts: what it changes, what it leaves, and that nothing is another program afterwards.

use velour_grammar::{FormatError, Options, format, format_bytes, parse};

fn laid_out(text: &str) -> String {
    let options = Options::default();
    let new = format("a.osl", text, &options).unwrap_or_else(|error| panic!("{error}: {text}\n{}", told(text)));
    assert_eq!(format("a.osl", &new, &options).unwrap(), new, "once more");
    new
}

fn told(text: &str) -> String {
    let parsed = parse("a.osl", text, &Options::default());
    parsed.sources.render(&parsed.diagnostics, velour_grammar::Format::Short, false)
}

/// What becomes of the inside of a shader.
fn inside(text: &str) -> String {
    let whole = laid_out(&format!("surface s()\n{{\n{text}\n}}\n"));
    whole.strip_prefix("surface s()\n{\n").unwrap().strip_suffix("}\n").unwrap().to_owned()
}

#[test]
fn spaces_go_where_they_help() {
    let cases = [
        ("float a=1,b =-2 ;", "    float a = 1, b = -2;"),
        ("a=b+c*-d-(-e)- -f;", "    a = b + c * -d - (-e) - -f;"),
        ("a=b+ +c; a=- -b; a=!b&&! c||~d;", "    a = b + +c; a = - -b; a = !b && !c || ~d;"),
        ("i ++; ++ i; a=i++ +j; a=i+ ++j; a=i-- -j;", "    i++; ++i; a = i++ + j; a = i + ++j; a = i-- - j;"),
        ("f ( a,b ) ; g( ) ;", "    f(a, b); g();"),
        ("a [ 1 ] [ 2 ]=m[i ][j];", "    a[1][2] = m[i][j];"),
        ("float x[ 2 ]={ 1,2 };", "    float x[2] = { 1, 2 };"),
        ("x=( float ) y; x=(color)- y; x=( float )(y);", "    x = (float)y; x = (color)-y; x = (float)(y);"),
        ("c=color( 1,0 , 0 )*float(2);", "    c = color(1, 0, 0) * float(2);"),
        ("a=b?c:d;", "    a = b ? c : d;"),
        (
            "a<<=1; a=b<<c>>d; a=b<c; a=b>=c; a^=b|c&d;",
            "    a <<= 1; a = b << c >> d; a = b < c; a = b >= c; a ^= b | c & d;",
        ),
        ("a . b . c=d.e ;", "    a.b.c = d.e;"),
        ("for(;;){break;}", "    for (;;) { break; }"),
        ("for(int i=0;i<3;++i)x+=i;", "    for (int i = 0; i < 3; ++i) x += i;"),
        ("if(not a and(b)or c)return;", "    if (not a and (b) or c) return;"),
        ("string s=\"a\"\"b\"   \"c\";", "    string s = \"a\" \"b\" \"c\";"),
        ("return(a);", "    return (a);"),
        ("float f(float x){return x;}", "    float f(float x) { return x; }"),
        (
            "a = b /*x*/ + /* y */c; f(/*none*/); f(a /*b*/, c);",
            "    a = b /*x*/ + /* y */c; f(/*none*/); f(a /*b*/, c);",
        ),
        ("do{x=1;}while(x<2);", "    do { x = 1; } while (x < 2);"),
        ("{}", "    {}"),
        (";", "    ;"),
    ];
    for (text, wanted) in cases {
        assert_eq!(inside(text), format!("{wanted}\n"), "{text}");
    }
}

#[test]
fn lines_keep_their_ends_and_lose_what_they_had_before() {
    let cases = [
        (
            "if (a)\nx=1;\nelse if (b)\nx=2;\nelse\nx=3;\ny=1;",
            "    if (a)\n        x = 1;\n    else if (b)\n        x = 2;\n    else\n        x = 3;\n    y = 1;",
        ),
        (
            "if (a) if (b) x=1; else x=2; else x=3;\ny=1;",
            "    if (a) if (b) x = 1; else x = 2; else x = 3;\n    y = 1;",
        ),
        (
            "if (a)\nfor (;;)\nif (b)\nx=1;\nelse\nx=2;\ny=1;",
            "    if (a)\n        for (;;)\n            if (b)\n                x = 1;\n            else\n                x = 2;\n    y = 1;",
        ),
        (
            "if (a) {\nx=1;\n} else {\nx=2;\n}\ny=1;",
            "    if (a) {\n        x = 1;\n    } else {\n        x = 2;\n    }\n    y = 1;",
        ),
        (
            "if (a)\n{\nx=1;\n}\nelse\n{\nx=2;\n}",
            "    if (a)\n    {\n        x = 1;\n    }\n    else\n    {\n        x = 2;\n    }",
        ),
        (
            "do\nx=1;\nwhile (a);\nwhile (b)\nx=2;\ny=1;",
            "    do\n        x = 1;\n    while (a);\n    while (b)\n        x = 2;\n    y = 1;",
        ),
        ("do if (a) x=1; while (b);\ny=1;", "    do if (a) x = 1; while (b);\n    y = 1;"),
        ("x = a\n+ b\n+ c;\ny=1;", "    x = a\n        + b\n        + c;\n    y = 1;"),
        ("  float x = a +\n            b;", "    float x = a +\n              b;"),
        ("f(a,\nb,\ng(\nc\n)\n);", "    f(a,\n        b,\n        g(\n            c\n        )\n    );"),
        ("f(aaa,\n  bbb);", "    f(aaa,\n      bbb);"),
        ("if (a &&\nb)\nx=1;", "    if (a &&\n            b)\n        x = 1;"),
        (
            "float a; // one\nfloat bcd; // two\n           // more\n\n// three\nx=1; // four",
            "    float a;   // one\n    float bcd; // two\n               // more\n\n    // three\n    x = 1; // four",
        ),
        ("/* a\n   b\n */\nx=1;", "    /* a\n       b\n     */\n    x = 1;"),
        (
            "int    a  = 1;\nfloat  bb = 2;\ncolor ccc = 3;",
            "    int    a  = 1;\n    float  bb = 2;\n    color ccc = 3;",
        ),
        ("if (a)\n// why\nx=1;\n// then\ny=1;", "    if (a)\n        // why\n        x = 1;\n    // then\n    y = 1;"),
    ];
    for (text, wanted) in cases {
        assert_eq!(inside(text), format!("{wanted}\n"), "{text}");
    }
    let whole = laid_out(
        "\n\n\nstruct A{\nfloat x;\n\n\n\ncolor c;};\n\n\nfloat\nf(float x)\n{ return x; }\nsurface s\n[[ string help=\"x\" ]]\n(\nfloat a=1 [[ float min=0,\nfloat max=1 ]],\nfloat b[2]={1,\n2},\n)\n{\n}   \n\n",
    );
    assert_eq!(
        whole,
        "struct A {\n    float x;\n\n    color c; };\n\nfloat\nf(float x)\n{ return x; }\nsurface s\n    [[ string help = \"x\" ]]\n(\n    float a = 1 [[ float min = 0,\n        float max = 1 ]],\n    float b[2] = { 1,\n        2 },\n)\n{\n}\n"
    );
}

#[test]
fn what_the_preprocessor_reads_stays_as_it_is() {
    let text = "  #  define  A(x)   ((x)  +1) // why  \n#define B \\\n      2  \\\n   +3\nsurface s()\n{\n   #if defined(A)&&1\nif (a) {\n #else\nif (b) {\n  #endif\nx=A( B );\n}\n#pragma osl nowarn\nfloat y=1;\n}\n";
    let wanted = "#  define  A(x)   ((x)  +1) // why\n#define B \\\n      2  \\\n   +3\nsurface s()\n{\n#if defined(A)&&1\n    if (a) {\n#else\n    if (b) {\n#endif\n        x = A(B);\n    }\n#pragma osl nowarn\n    float y = 1;\n}\n";
    assert_eq!(laid_out(text), wanted);
    // A macro that makes a string of its argument counts the spaces in it.
    let text = "#define TEXT(x) #x\nsurface s() { string a=TEXT( a+b ,c ); }\n".replace(" ,c", "");
    assert_eq!(laid_out(&text), "#define TEXT(x) #x\nsurface s() { string a = TEXT( a+b ); }\n");
    // What brings its own end begins no longer line.
    let text = "#define DO(x) f(x);\nsurface s() {\nDO(1)\nDO(2)\nfloat x=1;\n}\n";
    assert_eq!(laid_out(text), "#define DO(x) f(x);\nsurface s() {\n    DO(1)\n    DO(2)\n    float x = 1;\n}\n");
}

#[test]
fn what_would_be_another_program_stays_as_it_is() {
    let options = Options { own_files: vec![("q.h".into(), "#define QUOTE(x) #x\n".into())], ..Options::default() };
    let counted = |text: &str| matches!(format("a.osl", text, &options), Err(FormatError::Counted));
    assert!(counted("surface s() {\n\n\n\nint i = __LINE__; }\n"));
    assert!(counted("#include \"q.h\"\nsurface s() { string a = QUOTE(a+b); }\n"));
    assert!(!counted("surface s() {\n\nint i = __LINE__; }\n"));
    for wrong in ["surface s() {", "x", "#include \"none.h\"\n", "surface s() { a = ; }", "\0"] {
        assert!(matches!(format("a.osl", wrong, &options), Err(FormatError::Wrong(..))), "{wrong:?}");
    }
}

#[test]
fn line_ends_and_encodings_are_kept() {
    assert_eq!(
        laid_out("surface s()\r\n{\r\nx=1;\r\n\r\n\r\n/* a\r\n b */\r\n}"),
        "surface s()\r\n{\r\n    x = 1;\r\n\r\n    /* a\r\n     b */\r\n}\r\n"
    );
    assert_eq!(laid_out("\u{feff}surface s() { x=1; } // \u{1f9f5}"), "\u{feff}surface s() { x = 1; } // \u{1f9f5}\n");
    assert_eq!(laid_out(""), "");
    let options = Options::default();
    assert_eq!(
        format_bytes("a", b"surface s() { string x=\"\xe9\"; } // \xff", &options).unwrap(),
        b"surface s() { string x = \"\xe9\"; } // \xff\n"
    );
    assert!(matches!(format_bytes("a", b"surface s() { } // \xe9 \xc3\xa9", &options), Err(FormatError::Mixed)));
    assert!(matches!(format_bytes("a", b"surface s() { \xff }", &options), Err(FormatError::Wrong(..))));
    // A backslash and a space at the end of a line join no lines, and must not come to.
    assert_eq!(laid_out("surface s() { // a \\ \n}\n"), "surface s() { // a \\ \n}\n");
}

/// Pieces that, put together at random, sometimes parse.
const PIECES: &[&str] = &[
    "x",
    " ",
    "  ",
    "\n",
    "\n\n\n",
    "\t",
    "\r\n",
    ";",
    ",",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "=",
    "+",
    "-",
    "++",
    "!",
    "<",
    "?",
    ":",
    ".",
    "1",
    ".5",
    "2.",
    "if (x)",
    "else ",
    "for (;;)",
    "while (x)",
    "do ",
    "return ",
    "float ",
    "float a = x;",
    "color(1)",
    "f(x, 2);",
    "(float)",
    "// c\n",
    "/* c\n d */",
    "/**/",
    "#if 1\n",
    "\n#else\n",
    "\n#endif\n",
    "\n#define M(a) a + #a\n",
    "M(x - 1)",
    "\"s\"",
    "\"a\\\nb\"",
    "\\\n",
    "x = M(M(1)) ;",
    "{ x = 1; }",
    "[[ int a = 1 ]]",
];

#[test]
fn random_texts_are_laid_out_once_and_mean_the_same() {
    let long = std::env::var_os("VELOUR_LONG_TESTS").is_some();
    let mut state = 1u64;
    let mut below = |most: usize| {
        // Knuth's generator; its high bits.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % most
    };
    let (mut done, options) = (0, Options::default());
    for _ in 0..if long { 1_000_000 } else { 20_000 } {
        let body: String = (0..1 + below(12)).map(|_| PIECES[below(PIECES.len())]).collect();
        let text = format!("surface s() {{ {body}\n}}");
        let Ok(new) = format("a.osl", &text, &options) else { continue };
        assert_eq!(format("a.osl", &new, &options).as_deref().ok(), Some(new.as_str()), "{text:?}");
        assert!(parse("a.osl", &text, &options).file == parse("a.osl", &new, &options).file, "{text:?}");
        done += 1;
    }
    println!("{done} random texts were laid out");
    assert!(done > 300, "only {done} parse");
}
