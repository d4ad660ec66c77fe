//! How a talk begins and ends, what broken messages do, and how soon mistakes are shown.

use crate::client::{Client, URI, codes};
use serde_json::{Value, json};
use std::fmt::Write;
use std::time::{Duration, Instant};

#[test]
fn a_talk_begins_and_ends_in_order() {
    let mut client = Client::silent();
    assert_eq!(client.ask("shutdown", Value::Null)["error"]["code"], -32002);
    assert_eq!(client.ask("textDocument/hover", json!({}))["error"]["code"], -32002);
    client.notify("textDocument/didOpen", json!({}));
    assert!(client.ask("initialize", json!({ "capabilities": {} }))["error"].is_null());
    assert_eq!(client.ask("initialize", json!({}))["error"]["code"], -32600);
    assert_eq!(client.ask("nothing/such", json!({}))["error"]["code"], -32601);
    assert_eq!(client.ask("textDocument/hover", json!([1]))["error"]["code"], -32602);
    assert_eq!(client.ask("shutdown", Value::Null)["result"], Value::Null);
    assert_eq!(client.ask("textDocument/hover", json!({}))["error"]["code"], -32600);
    client.notify("exit", Value::Null);
    assert_eq!(client.status(), 0);
    let mut hurried = Client::new();
    hurried.notify("exit", Value::Null);
    assert_eq!(hurried.status(), 1);
    // An editor that dies closes its end.
    assert_eq!(Client::new().status(), 1);
}

#[test]
fn broken_messages_are_answered_and_the_talk_goes_on() {
    let mut client = Client::new();
    client.send_bytes(b"Content-Length: 9\r\n\r\nnonsense!");
    assert_eq!(client.read()["error"]["code"], -32700);
    client.send_bytes(b"Content-Length: 4\r\n\r\n\xff\xfe\xfd\xfc");
    assert_eq!(client.read()["error"]["code"], -32700);
    client.send(&json!({ "jsonrpc": "2.0", "id": { "a": 1 }, "method": 3 }));
    assert_eq!(client.read()["error"]["code"], -32600);
    client.send_bytes(b"garbage\r\nContent-Length: x\r\n\r\n\r\n\0\0\0\r\n");
    for params in [json!({}), json!([]), json!({ "textDocument": { "uri": "a b", "version": "x" } }), Value::Null] {
        for method in ["didOpen", "didChange", "didClose", "didSave"] {
            client.notify(&format!("textDocument/{method}"), params.clone());
        }
    }
    // A change of a text that is not open, a place that is not there, a name that is no address of a file.
    client.change(URI, json!([{ "text": "x" }]));
    assert_eq!(client.at("hover", 4_000_000_000, 7)["result"], Value::Null);
    client.open("untitled:Untitled-1", "surface s() { Ci = diffuse(N); }");
    let hover = json!({ "textDocument": { "uri": "untitled:Untitled-1" }, "position": { "line": 0, "character": 21 } });
    assert!(
        client.ask("textDocument/hover", hover)["result"]["contents"]["value"].as_str().unwrap().contains("Lambert")
    );
    assert_eq!(client.end(), 0);
}

#[test]
fn what_means_something_is_checked_beside_a_syntax_error() {
    let mut client = Client::new();
    let text = "surface s()\n{\n    float lost = 3 3;\n    float b = lost;\n    color c = roughnes;\n    Ci = diffuse(\"x\");\n}\n";
    let found = codes(&client.open(URI, text));
    // The declaration that did not parse is no second mistake.
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found[0].starts_with("E03") && found[0].contains("2:19"), "{found:?}");
    assert_eq!(found[1], "E0403 4:14-4:22");
    assert_eq!(found[2], "E0406 5:9-5:21");
    client.change(URI, json!([{ "range": { "start": { "line": 2, "character": 18 }, "end": { "line": 2, "character": 20 } }, "text": "" }]));
    let found = codes(&client.diagnostics(URI));
    assert_eq!(found, ["E0403 4:14-4:22", "E0406 5:9-5:21"]);
    // A `;` is missing right before a brace, which would take the whole shader along.
    client.change(
        URI,
        json!([{ "text": "surface s(float rough = 0.1)\n{\n    color c = roughnes;\n    Ci = rough\n}\n" }]),
    );
    assert_eq!(codes(&client.diagnostics(URI)), ["E0302 3:9-3:14", "E0403 2:14-2:22", "E0501 3:9-3:14"]);
    assert_eq!(client.end(), 0);
}

#[test]
fn what_is_odd_is_shown_more_softly() {
    let mut client = Client::new();
    let found = client.open(URI, "surface s(float a = 0)\n{\n    float b = 1;\n    float c;\n    Ci = c * emission();\n    int d[2] = {1, 2};\n    d[7] = 0;\n}\n");
    let told: Vec<String> =
        found.iter().map(|d| format!("{} {} {}", d["severity"], d["code"].as_str().unwrap(), d["tags"])).collect();
    assert_eq!(told, ["2 W0503 null", "4 W0507 [1]", "4 W0507 [1]", "4 W0508 [1]", "4 W0507 [1]"]);
    assert_eq!(client.end(), 0);
}

#[test]
fn included_texts_are_those_that_are_open() {
    let folder = tempfile::tempdir().unwrap();
    let address = |name: &str| format!("file://{}/{name}", folder.path().display());
    std::fs::write(folder.path().join("h.h"), "float twice(float x) { return 2 * x; }\n").unwrap();
    let (shader, header) = (address("s.osl"), address("h.h"));
    let mut client = Client::new();
    let text = "#include \"h.h\"\nsurface s(output float f = 0) { f = twice(u); f = thrice(f); }\n";
    assert_eq!(codes(&client.open(&shader, text)), ["E0405 1:50-1:56"]);
    let open = "float twice(float x) { return 2 * x; }\nfloat thrice(float x) { return 3 * x; }\n";
    // A header has no shader, and need not have one.
    assert!(client.open(&header, open).is_empty());
    assert!(client.diagnostics(&shader).is_empty());
    client.change(&header, json!([{ "text": "float twice(float x) { return 2 * y; }\n" }]));
    let found = client.diagnostics(&shader);
    assert_eq!(codes(&found), ["E0403 0:9-0:14", "E0405 1:50-1:56"]);
    assert!(found[0]["message"].as_str().unwrap().contains("h.h:1: `y` is not declared"), "{found:?}");
    client.notify("textDocument/didClose", json!({ "textDocument": { "uri": header } }));
    assert_eq!(codes(&client.diagnostics(&shader)), ["E0405 1:50-1:56"]);
    let place = json!({ "textDocument": { "uri": shader }, "position": { "line": 1, "character": 38 } });
    let there = client.ask("textDocument/definition", place)["result"].clone();
    assert_eq!(
        (there["uri"].as_str(), crate::client::shown(&there["range"])),
        (Some(header.as_str()), "0:6-0:11".into())
    );
    assert_eq!(client.end(), 0);
}

/// A shader of so many lines.
fn long(lines: usize) -> String {
    let mut text =
        String::from("// Many lines.\nsurface knit(float scale = 1, color tint = 1)\n{\n    float sum = 0;\n");
    for line in 0..lines - 6 {
        let _ = match line % 4 {
            0 => writeln!(text, "    float a{line} = noise(P * scale + {line});"),
            1 => writeln!(text, "    if (a{} > 0.5) sum += a{} * sin(u * {line});", line - 1, line - 1),
            2 => writeln!(text, "    color c{line} = mix(tint, color(u, v, sum), clamp(a{}, 0, 1));", line - 2),
            _ => writeln!(text, "    sum += luminance(c{}); // {line}", line - 1),
        };
    }
    text + "    Ci = sum * diffuse(N);\n}\n"
}

#[test]
fn mistakes_in_a_thousand_lines_are_shown_at_once() {
    let text = long(1000);
    assert_eq!(text.lines().count(), 1000);
    let mut client = Client::new();
    assert!(client.open(URI, &text).is_empty());
    let mut times: Vec<Duration> = Vec::new();
    for round in 0..40 {
        let (from, to, new) = if round % 2 == 0 { (4, 4, "zz") } else { (4, 6, "") };
        let range = json!({ "start": { "line": 503, "character": from }, "end": { "line": 503, "character": to } });
        let start = Instant::now();
        client.change(URI, json!([{ "range": range, "text": new }]));
        let found = client.diagnostics(URI);
        times.push(start.elapsed());
        assert_eq!(found.is_empty(), round % 2 == 1, "{found:?}");
    }
    times.sort();
    println!("diagnostics of 1,000 lines: median {:?}, worst {:?}", times[20], times[39]);
    // The best of many: a build that is not optimised, on a machine that has other things to do.
    assert!(times[0] < Duration::from_millis(if cfg!(debug_assertions) { 600 } else { 40 }), "{times:?}");
    assert_eq!(client.end(), 0);
}
