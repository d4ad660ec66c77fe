//! Where names are declared and used, what they mean, and what they may be called instead.

use crate::client::{Client, URI, ranges, shown};
use serde_json::{Value, json};

/// A text in which most kinds of name stand, some after characters of two UTF-16 units.
const TEXT: &str = "// \u{1f9f5}\r\n\
#include \"oslutil.h\"\r\n\
#define GAIN 2.0\r\n\
#define SCALED(x) ((x) * amount)\r\n\
#define DECLARE(n) float n = 1\r\n\
struct Yarn { float twist; color tint; };\r\n\
// Doubles a number.\r\n\
// \u{1f9f5} twice\r\n\
float twice(float x) { return 2 * x; }\r\n\
color twice(color x) { return 2 * x; }\r\n\
surface cloth(float amount = 0.5 [[ string help = \"how much of it\" ]], output color result = 0)\r\n\
{\r\n\
    /* \u{1f9f5}\u{1f9f5} */ Yarn yarn = { 1, color(1) };\r\n\
    yarn.twist = twice(amount);\r\n\
    float x = SCALED(yarn.twist) + GAIN;\r\n\
    for (int i = 0; i < 3; ++i) { float x = i; result += x * (yarn.tint); }\r\n\
    DECLARE(made);\r\n\
    result = twice(result) + made + radians(x);\r\n\
    Ci = sheen(diffuse(N), N, color(1), 0.5, \"layering\", \"lossless\");\r\n\
}\r\n";

fn client() -> Client {
    let mut client = Client::new();
    let found = client.open(URI, TEXT);
    assert!(found.iter().all(|d| d["severity"] == 4), "{found:?}");
    client
}

/// The line and UTF-16 column of the n-th place of a word, from 1.
fn place(word: &str, nth: usize) -> (u32, u32) {
    let at = TEXT.match_indices(word).nth(nth - 1).unwrap().0;
    let line = TEXT[..at].matches('\n').count();
    let start = TEXT[..at].rfind('\n').map_or(0, |end| end + 1);
    (line as u32, TEXT[start..at].encode_utf16().count() as u32)
}

/// The range of that word as the server writes it.
fn range(word: &str, nth: usize) -> String {
    let (line, column) = place(word, nth);
    format!("{line}:{column}-{line}:{}", column + word.encode_utf16().count() as u32)
}

#[test]
fn definitions_are_where_names_are_declared() {
    let mut client = client();
    let cases = [
        (("amount", 3), range("amount", 2)),
        (("amount", 1), range("amount", 2)),
        (("twice(amount", 1), range("twice", 2)),
        (("twice(result", 1), range("twice", 3)),
        (("Yarn yarn", 1), range("Yarn", 1)),
        (("twist)", 1), range("twist", 1)),
        (("tint)", 1), range("tint", 1)),
        (("x * (", 1), String::new()),
        (("GAIN;", 1), range("GAIN", 1)),
        (("SCALED(y", 1), range("SCALED", 1)),
        (("made +", 1), range("made", 1)),
        (("result)", 1), range("result", 1)),
    ];
    for ((word, nth), wanted) in cases {
        let (line, column) = place(word, nth);
        let answer = client.at("definition", line, column);
        assert_eq!(answer["result"]["uri"], URI, "{word}: {answer}");
        if word == "x * (" {
            // The inner of two variables of a name.
            assert!(shown(&answer["result"]["range"]).starts_with("15:"), "{answer}");
            continue;
        }
        assert_eq!(shown(&answer["result"]["range"]), wanted, "{word} {nth}");
    }
    // What comes with velour stands in a file that an editor can open.
    let (line, column) = place("radians", 1);
    let there = client.at("definition", line, column)["result"].clone();
    let path = there["uri"].as_str().unwrap().strip_prefix("file://").unwrap().to_owned();
    let text = std::fs::read_to_string(&path).unwrap();
    let found = text.lines().nth(there["range"]["start"]["line"].as_u64().unwrap() as usize).unwrap();
    assert!(
        path.ends_with("/stdosl.osl") && found.starts_with("float  radians") || found.starts_with("float radians"),
        "{found}"
    );
    assert!(client.open(there["uri"].as_str().unwrap(), &text).is_empty());
    let (line, column) = place("oslutil", 1);
    let there = client.at("definition", line, column)["result"].clone();
    assert!(there["uri"].as_str().unwrap().ends_with("/oslutil.h") && shown(&there["range"]) == "0:0-0:0", "{there}");
    for (word, nth) in [("diffuse", 1), ("N)", 1), ("return", 1), ("// Doubles", 1)] {
        let (line, column) = place(word, nth);
        assert_eq!(client.at("definition", line, column)["result"], Value::Null, "{word}");
    }
    assert_eq!(client.end(), 0);
}

#[test]
fn references_are_all_places_of_one_thing() {
    let mut client = client();
    let mut all = |word: &str, nth: usize, declarations: bool| {
        let (line, column) = place(word, nth);
        let more = json!({ "context": { "includeDeclaration": declarations } });
        ranges(&client.at_with("references", line, column, more)["result"])
    };
    // The use inside of a macro's body counts where the macro is called.
    let amount = [range("amount", 2), range("amount", 3), range("SCALED", 2)];
    assert_eq!(all("amount", 3, true), amount);
    assert_eq!(all("amount", 3, false), amount[1..]);
    assert_eq!(all("twist", 1, true), [range("twist", 1), range("twist", 2), range("twist", 3)]);
    assert_eq!(all("twice", 3, true).len(), 2);
    assert_eq!(all("yarn", 1, true).len(), 4);
    assert_eq!(all("result", 1, true).len(), 4);
    assert_eq!(all("Yarn", 1, true), [range("Yarn", 1), range("Yarn", 2)]);
    assert_eq!(all("GAIN", 2, true), [range("GAIN", 1), range("GAIN", 2)]);
    assert_eq!(all("made", 1, true), [range("made", 1), range("made", 2)]);
    assert_eq!(client.end(), 0);
}

#[test]
fn a_new_name_goes_to_every_place_or_to_none() {
    let mut client = client();
    let mut renamed = |word: &str, nth: usize, new: &str| -> Result<Vec<String>, String> {
        let (line, column) = place(word, nth);
        let answer = client.at_with("rename", line, column, json!({ "newName": new }));
        match answer["error"]["message"].as_str() {
            Some(message) => Err(message.to_owned()),
            None => Ok(ranges(&answer["result"]["changes"][URI])),
        }
    };
    // The body of a macro is renamed with what it names.
    assert_eq!(renamed("amount", 2, "share").unwrap(), [range("amount", 1), range("amount", 2), range("amount", 3)]);
    assert_eq!(renamed("twist", 2, "turns").unwrap().len(), 3);
    assert_eq!(renamed("twice", 2, "doubled").unwrap(), [range("twice", 2), range("twice", 4)]);
    assert_eq!(renamed("Yarn", 2, "Thread").unwrap().len(), 2);
    assert_eq!(renamed("cloth", 1, "felt").unwrap(), [range("cloth", 1)]);
    assert_eq!(renamed("made", 2, "done").unwrap().len(), 2);
    // A name of an inner scope would catch the outer one, or the other way around.
    for (word, nth, new) in
        [("amount", 2, "result"), ("amount", 2, "x"), ("yarn", 1, "i"), ("result", 1, "u"), ("twist", 1, "tint")]
    {
        assert!(renamed(word, nth, new).unwrap_err().contains("means something else"), "{word} as {new}");
    }
    for new in ["diffuse", "noise"] {
        assert!(renamed("amount", 2, new).unwrap_err().contains("means something else"), "{new}");
    }
    for new in ["float", "static", "2x", "a b", "", "\u{1f9f5}", "a/**/"] {
        assert!(renamed("amount", 2, new).unwrap_err().contains("cannot be a name"), "{new:?}");
    }
    for (word, nth) in [("diffuse", 1), ("N)", 1), ("radians", 1)] {
        assert!(renamed(word, nth, "other").unwrap_err().contains("built in"), "{word}");
    }
    assert!(renamed("GAIN", 1, "other").unwrap_err().contains("no variable"));
    let (line, column) = place("twist)", 1);
    let prepared = client.at("prepareRename", line, column + 5)["result"].clone();
    assert_eq!((prepared["placeholder"].as_str(), shown(&prepared["range"])), (Some("twist"), range("twist", 3)));
    client.change(URI, json!([{ "text": "surface s(float a = 0) { float b = a a; }" }]));
    let answer = client.at_with("rename", 0, 16, json!({ "newName": "c" }));
    assert!(answer["error"]["message"].as_str().unwrap().contains("does not parse"), "{answer}");
    assert_eq!(client.end(), 0);
}

#[test]
fn a_word_is_explained() {
    let mut client = client();
    let mut told = |word: &str, nth: usize| {
        let (line, column) = place(word, nth);
        let answer = client.at("hover", line, column);
        answer["result"]["contents"]["value"].as_str().map(str::to_owned).unwrap_or_default()
    };
    let cases = [
        (
            "amount",
            3,
            "```osl\nfloat amount\n```\n\nparameter of the shader `cloth`, `0.5` by default\n\nhow much of it",
        ),
        ("twice(amount", 1, "```osl\nfloat twice(float x)\n```\n\nDoubles a number.\n\u{1f9f5} twice"),
        ("Yarn yarn", 1, "```osl\nstruct Yarn {\n    float twist;\n    color tint;\n};\n```"),
        ("tint)", 1, "```osl\ncolor tint\n```\n\nfield of `struct Yarn`"),
        ("N)", 1, "```osl\nnormal N\n```\n\nThe shading normal, of unit length and smooth over the faces of a mesh."),
        ("GAIN", 2, "```osl\n#define GAIN 2.0\n```"),
        ("radians", 1, "```osl\nfloat radians(float x)\n```\n\nAn angle in radians from one in degrees."),
        ("oslutil", 1, "the file `oslutil.h`, which comes with velour"),
    ];
    for (word, nth, wanted) in cases {
        assert_eq!(told(word, nth), wanted, "{word}");
    }
    let sheen = told("sheen", 1);
    for part in [
        "closure color sheen(",
        "- `roughness` (float): ",
        "Keywords:",
        "- `layering` (string): ",
        "Source: Estevez and Kulla 2017",
    ] {
        assert!(sheen.contains(part), "{part}: {sheen}");
    }
    client.change(URI, json!([{ "text": "surface s() { printf(\"%f\", smoothstep(0, 1, u)); }" }]));
    let step = client.at("hover", 0, 30)["result"]["contents"]["value"].clone();
    assert!(step.as_str().unwrap().contains("float smoothstep(float, float, float)"), "{step}");
    assert!(step.as_str().unwrap().contains("A smooth ramp from 0 at the first edge"), "{step}");
    assert_eq!(client.end(), 0);
}

#[test]
fn what_a_text_declares_is_listed() {
    let mut client = client();
    let list = client.at("documentSymbol", 0, 0)["result"].clone();
    let names = |list: &Value| -> Vec<String> {
        list.as_array()
            .unwrap()
            .iter()
            .map(|s| format!("{} {}", s["name"].as_str().unwrap(), shown(&s["range"])))
            .collect()
    };
    let wanted = [
        "GAIN 2:8-2:12",
        "SCALED 3:8-3:14",
        "DECLARE 4:8-4:15",
        "Yarn 5:0-5:40",
        "twice 8:0-8:38",
        "twice 9:0-9:38",
        "cloth 10:0-19:1",
    ];
    assert_eq!(names(&list), wanted);
    assert_eq!(names(&list[3]["children"]), ["twist 5:14-5:25", "tint 5:27-5:37"]);
    assert_eq!(names(&list[6]["children"]), ["amount 10:14-10:32", "result 10:78-10:94"]);
    assert_eq!(client.end(), 0);
}
