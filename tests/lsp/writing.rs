//! What may be written: completion, the parameters of a call, and the layout.

use crate::client::{Client, URI};
use serde_json::{Value, json};

/// Opens a text in which `¦` stands for the cursor, and gives the cursor's place.
fn opened(client: &mut Client, text: &str) -> (u32, u32) {
    let at = text.find('¦').unwrap();
    client.change(URI, json!([{ "text": text.replace('¦', "") }]));
    let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
    (text[..at].matches('\n').count() as u32, text[start..at].encode_utf16().count() as u32)
}

fn started() -> Client {
    let mut client = Client::new();
    client.open(URI, "");
    client
}

/// The items offered at the cursor.
fn items(client: &mut Client, text: &str) -> Vec<Value> {
    let (line, column) = opened(client, text);
    client.at("completion", line, column)["result"].as_array().unwrap().clone()
}

fn labels(items: &[Value]) -> Vec<&str> {
    items.iter().map(|item| item["label"].as_str().unwrap()).collect()
}

#[test]
fn names_are_offered_where_they_may_stand() {
    let mut client = started();
    let text = "struct Yarn { float twist; };\nfloat near(float inner) { return inner; }\nsurface s(float rough = 0.1) {\n    float above = 1;\n    { float hidden = 2; }\n    for (int i = 0; i < 3; ++i) { float loop = i; }\n    Ci = ro¦\n    float below = 3;\n}\n";
    let found = items(&mut client, text);
    let found = labels(&found);
    for name in
        ["rough", "above", "near", "Yarn", "diffuse", "sheen", "noise", "N", "u", "M_PI", "float", "return", "radians"]
    {
        assert!(found.contains(&name), "{name}");
    }
    for name in ["hidden", "inner", "loop", "i", "below", "twist"] {
        assert!(!found.contains(&name), "{name}");
    }
    // Over what has been written of it, with an item's type and meaning.
    let found = items(&mut client, "surface s(float rough = 0.1) { Ci = rou¦ }");
    let rough = found.iter().find(|item| item["label"] == "rough").unwrap();
    assert_eq!(
        (rough["detail"].as_str(), crate::client::shown(&rough["textEdit"]["range"])),
        (Some("float"), "0:36-0:39".into())
    );
    let inside = items(&mut client, "float f(float inner) { for (int i = 0; i < 3; ++i) { float x = ¦; } }");
    assert!(["inner", "i", "f"].iter().all(|name| labels(&inside).contains(name)));
    assert_eq!(
        labels(&items(&mut client, "struct A { float x; color c; };\nsurface s() { A a[2]; a[1].¦ }")),
        ["c", "x"]
    );
    assert_eq!(
        labels(&items(&mut client, "struct A { float x; color c; };\nsurface s() { A a; a.c.¦; }")),
        ["b", "g", "r"]
    );
    assert_eq!(labels(&items(&mut client, "surface s() { P.¦ = 0; }")), ["x", "y", "z"]);
    assert!(items(&mut client, "surface s() { // no¦\n}").is_empty());
    assert!(items(&mut client, "/* no¦ */ surface s() { }").is_empty());
    assert!(labels(&items(&mut client, "#¦\nsurface s() { }")).contains(&"include"));
    assert!(labels(&items(&mut client, "#include \"¦\"\nsurface s() { }")).contains(&"oslutil.h"));
    // A bracket is missing, so that nothing of the shader parses: what was known before is still known.
    items(&mut client, "surface s(float rough = 0.1) { float above = 1; ¦}");
    assert!(labels(&items(&mut client, "surface s(float rough = 0.1 { float above = 1; Ci = ¦ }")).contains(&"rough"));
    assert_eq!(client.end(), 0);
}

#[test]
fn keywords_of_closures_and_their_values_are_offered() {
    let mut client = started();
    let call = "surface s() { Ci = sheen(diffuse(N), N, color(1), 0.5, ";
    let bare = items(&mut client, &format!("{call}¦); }}"));
    assert!(labels(&bare).contains(&"\"layering\"") && labels(&bare).contains(&"N"));
    let quoted = items(&mut client, &format!("{call}\"lay¦\"); }}"));
    assert!(labels(&quoted).contains(&"layering") && !labels(&quoted).contains(&"N"), "{quoted:?}");
    let layering = quoted.iter().find(|item| item["label"] == "layering").unwrap();
    let column = call.len() as u64 + 1;
    assert_eq!(layering["textEdit"]["range"]["start"]["character"], column);
    assert_eq!(layering["textEdit"]["range"]["end"]["character"], column + 3);
    let values = items(&mut client, &format!("{call}\"layering\", \"¦\"); }}"));
    assert!(labels(&values).contains(&"lossless") && !labels(&values).contains(&"layering"), "{values:?}");
    let facets = items(&mut client, "surface s() { Ci = microfacet(\"¦\", N, 0.1, 1.5, 0); }");
    assert!(labels(&facets).contains(&"ggx"), "{facets:?}");
    let options = items(&mut client, "surface s() { color c = texture(\"a.png\", u, v, \"¦\"); }");
    assert!(labels(&options).contains(&"swrap"), "{options:?}");
    let noises = items(&mut client, "surface s() { float f = noise(\"¦\", P); }");
    assert!(labels(&noises).contains(&"gabor"), "{noises:?}");
    assert!(items(&mut client, "surface s() { printf(\"¦\"); }").is_empty());
    assert_eq!(client.end(), 0);
}

#[test]
fn the_parameters_of_a_call_are_shown() {
    let mut client = started();
    let mut help = |text: &str| {
        let (line, column) = opened(&mut client, text);
        let answer = client.at("signatureHelp", line, column)["result"].clone();
        let chosen = answer["signatures"].get(answer["activeSignature"].as_u64().unwrap_or(0) as usize).cloned();
        let Some(chosen) = chosen else { return "nothing".to_owned() };
        let label: Vec<u16> = chosen["label"].as_str().unwrap().encode_utf16().collect();
        let at = answer["activeParameter"].as_u64().unwrap() as usize;
        let part = chosen["parameters"].get(at).map_or(String::new(), |parameter| {
            let [from, to] = [0, 1].map(|i| parameter["label"][i].as_u64().unwrap() as usize);
            String::from_utf16(&label[from..to]).unwrap()
        });
        format!("{} | {part}", String::from_utf16(&label).unwrap())
    };
    let own = "float f(float first, output color second) { return first; }\nsurface s() { ";
    assert_eq!(help(&format!("{own} f(¦")), "float f(float first, output color second) | float first");
    assert_eq!(
        help(&format!("{own} f(sin(1, 2), ¦) }}")),
        "float f(float first, output color second) | output color second"
    );
    assert_eq!(help("surface s() { float x = smoothstep(0, 1, ¦); }"), "float smoothstep(float, float, float) | float");
    assert_eq!(
        help("surface s() { Ci = oren_nayar(N, ¦"),
        "closure color oren_nayar(normal N, float sigma, [\"label\", string]) | float sigma"
    );
    assert_eq!(
        help("struct A { float x; color c; };\nsurface s() { A a = A(1, ¦); }"),
        "struct A(float x, color c) | color c"
    );
    assert_eq!(
        help("surface s() { color c = texture(\"a\", u, v, \"wrap\", ¦); }"),
        "float texture(string, float, float, [\"name\", value]…) | [\"name\", value]…"
    );
    for text in ["surface s() { f(1); ¦ }", "surface s() { (1 + ¦) }", "¦", "surface s() { // sin(¦\n}"] {
        assert_eq!(help(text), "nothing", "{text}");
    }
    assert_eq!(client.end(), 0);
}

#[test]
fn a_text_is_laid_out() {
    let mut client = started();
    let mut laid_out = |text: &str| {
        client.change(URI, json!([{ "text": text }]));
        let options = json!({ "options": { "tabSize": 8, "insertSpaces": false } });
        let edits = client.at_with("formatting", 0, 0, options)["result"].clone();
        if edits.is_array() && !edits.as_array().unwrap().is_empty() {
            client.change(
                URI,
                edits
                    .as_array()
                    .unwrap()
                    .iter()
                    .map(|e| json!({ "range": e["range"], "text": e["newText"] }))
                    .collect(),
            );
        }
        let text = client.ask("velour/text", json!({ "textDocument": { "uri": URI } }));
        (edits, text["result"].as_str().unwrap().to_owned())
    };
    let (edits, text) = laid_out("surface s( )\r\n{\r\n  Ci=diffuse( N ) ; // \u{1f9f5}\r\n}\r\n");
    assert_eq!(text, "surface s()\r\n{\r\n    Ci = diffuse(N); // \u{1f9f5}\r\n}\r\n");
    assert_eq!(edits.as_array().unwrap().len(), 1);
    assert_eq!(laid_out(&text).0, json!([]));
    // One line is all that changes, so one line is all that is sent.
    let (edits, _) = laid_out("surface s()\n{\n    float a=1;\n    Ci = a * diffuse(N);\n}\n");
    assert_eq!(crate::client::ranges(&edits), ["2:0-3:0"]);
    assert_eq!(laid_out("surface s() {").0, Value::Null);
    assert_eq!(client.end(), 0);
}
