//! Random edits: the server's text is the editor's, and no position is wrong.
//!
//! `VELOUR_COUNT=100000 cargo test --release --test lsp edits` makes as many.

use crate::client::{Client, URI};
use serde_json::{Value, json};

/// Numbers that look random: the generator of Steele, Lea and Flood 2014.
struct Random(u64);

impl Random {
    fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % most as u64) as usize
    }
}

/// The editor's text: lines of UTF-16 units, each with its end.
struct Model(Vec<u16>);

impl Model {
    fn text(&self) -> String {
        String::from_utf16(&self.0).unwrap()
    }

    /// The places where lines start.
    fn starts(&self) -> Vec<usize> {
        let end = |i: usize| match self.0[i] {
            10 => true,
            13 => self.0.get(i + 1) != Some(&10),
            _ => false,
        };
        std::iter::once(0).chain((0..self.0.len()).filter(|i| end(*i)).map(|i| i + 1)).collect()
    }

    /// The line and column of a unit.
    fn position(&self, at: usize) -> Value {
        let starts = self.starts();
        let line = starts.iter().rposition(|start| *start <= at).unwrap();
        json!({ "line": line, "character": at - starts[line] })
    }

    /// The next place between characters that is not between the two halves of a line's end.
    fn whole(&self, mut at: usize) -> usize {
        let inside =
            |at: usize| (0xdc00..0xe000).contains(&self.0[at]) || at > 0 && self.0[at] == 10 && self.0[at - 1] == 13;
        while at < self.0.len() && inside(at) {
            at += 1;
        }
        at
    }

    fn place(&self, random: &mut Random) -> usize {
        self.whole(random.below(self.0.len() + 1))
    }

    /// A random change, as it is sent.
    fn change(&mut self, random: &mut Random) -> Value {
        const PIECES: &[&str] = &[
            "x",
            " ",
            "\n",
            "\r\n",
            "\r",
            "\t",
            "\u{1f9f5}",
            "é",
            "漢",
            "\"",
            "/*",
            "*/",
            "//",
            "{",
            "}",
            "(",
            ")",
            ";",
            "float a = 1;\n",
            "Ci = sheen(diffuse(N), N, color(1), 0.5);\r\n",
            "#define M(x) #x\n",
            "#if 1\n",
            "#endif\n",
            "surface s(float r = 0.5) {\n",
            "color \u{1f9f5} c;",
            "[[ string help = \"é\u{1f9f5}\" ]]",
            "a.b",
            "\\\n",
            "\u{feff}",
        ];
        let from = self.place(random);
        // Most deletions are short, some cross many lines.
        let to = self.whole((from + [0, 0, 1, 3, 12, 200][random.below(6)]).min(self.0.len()));
        let new: String = (0..random.below(4)).map(|_| PIECES[random.below(PIECES.len())]).collect();
        let range = json!({ "start": self.position(from), "end": self.position(to) });
        self.0.splice(from..to, new.encode_utf16());
        json!({ "range": range, "text": new })
    }
}

/// Is a range of the server's in the text, and no half of a character cut?
fn check_range(model: &Model, starts: &[usize], range: &Value) {
    for place in [&range["start"], &range["end"]] {
        let line = usize::try_from(place["line"].as_u64().unwrap()).unwrap();
        let at = starts[line] + usize::try_from(place["character"].as_u64().unwrap()).unwrap();
        let end = starts.get(line + 1).copied().unwrap_or(model.0.len() + 1);
        assert!(at < end, "{range} lies outside of its line");
        assert!(at == model.0.len() || !(0xdc00..0xe000).contains(&model.0[at]), "{range} cuts a character");
    }
}

fn check_ranges(model: &Model, starts: &[usize], value: &Value) {
    match value {
        Value::Object(object) => {
            for (name, inner) in object {
                if name == "range" || name == "selectionRange" {
                    check_range(model, starts, inner);
                }
                check_ranges(model, starts, inner);
            }
        }
        Value::Array(list) => list.iter().for_each(|inner| check_ranges(model, starts, inner)),
        _ => {}
    }
}

#[test]
fn random_edits_leave_the_same_text() {
    let count: usize = std::env::var("VELOUR_COUNT").ok().and_then(|text| text.parse().ok()).unwrap_or(2000);
    let first = include_str!("../../shaders/velvet.osl");
    let mut random = Random(14);
    let mut client = Client::new();
    let mut model = Model(first.encode_utf16().collect());
    client.open(URI, first);
    for round in 0..count {
        // Some changes come in one message, each about the text that the one before has left.
        let changes: Vec<Value> = (0..1 + random.below(2)).map(|_| model.change(&mut random)).collect();
        client.change(URI, Value::Array(changes));
        if model.0.len() > 6000 || round % 997 == 996 {
            model = Model(first.encode_utf16().collect());
            client.change(URI, json!([{ "text": first }]));
        }
        if round % 5 == 0 {
            let at = model.position(model.place(&mut random));
            let [line, column] = ["line", "character"].map(|name| at[name].as_u64().unwrap() as u32);
            let methods = ["hover", "definition", "completion", "signatureHelp", "documentHighlight", "prepareRename"];
            let answer = client.at(methods[random.below(methods.len())], line, column);
            assert_ne!(answer["error"]["code"], -32603, "{answer}");
            check_ranges(&model, &model.starts(), &answer["result"]);
        }
        if round % 20 == 0 {
            check_ranges(&model, &model.starts(), &client.last_diagnostics(URI));
            let text = client.ask("velour/text", json!({ "textDocument": { "uri": URI } }));
            assert_eq!(text["result"], model.text(), "after {round} changes");
            for method in ["documentSymbol", "formatting"] {
                let answer = client.at_with(method, 0, 0, json!({ "options": { "tabSize": 4, "insertSpaces": true } }));
                assert_ne!(answer["error"]["code"], -32603, "{answer}");
                check_ranges(&model, &model.starts(), &answer["result"]);
            }
            client.told.clear();
        }
    }
    // What is told last is about the text as it is.
    client.change(URI, json!([]));
    let last = client.last_diagnostics(URI);
    check_ranges(&model, &model.starts(), &last);
    let text = client.ask("velour/text", json!({ "textDocument": { "uri": URI } }));
    assert_eq!(text["result"], model.text());
    assert_eq!(client.end(), 0);
}
