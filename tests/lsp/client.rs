//! An editor for tests: it starts `velour lsp` and talks to it over its standard input and output.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The address of the text that most tests open.
pub const URI: &str = "file:///nowhere/a.osl";

/// An editor with its server.
pub struct Client {
    process: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    /// The number of the last request or change.
    count: i64,
    /// The number of the last change.
    version: i64,
    /// What the server has said besides answers.
    pub told: Vec<Value>,
}

impl Client {
    /// Starts a server and greets it.
    pub fn new() -> Self {
        let mut client = Self::silent();
        let answer = client.ask("initialize", json!({ "processId": null, "capabilities": {}, "rootUri": null }));
        assert_eq!(answer["result"]["capabilities"]["textDocumentSync"]["change"], 2);
        client.notify("initialized", json!({}));
        client
    }

    /// Starts a server.
    pub fn silent() -> Self {
        // Another build of the command may be asked for.
        let server = std::env::var_os("VELOUR_SERVER").unwrap_or_else(|| env!("CARGO_BIN_EXE_velour").into());
        let mut process = Command::new(server)
            .arg("lsp")
            .env("XDG_CACHE_HOME", std::env::temp_dir().join("velour-lsp-test"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (input, output) = (process.stdin.take(), BufReader::new(process.stdout.take().unwrap()));
        Client { process, input, output, count: 0, version: 0, told: Vec::new() }
    }

    /// Sends bytes as they are.
    pub fn send_bytes(&mut self, bytes: &[u8]) {
        let input = self.input.as_mut().unwrap();
        input.write_all(bytes).unwrap();
        input.flush().unwrap();
    }

    /// Sends a message.
    pub fn send(&mut self, message: &Value) {
        let text = message.to_string();
        self.send_bytes(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes());
    }

    /// Sends a notification.
    pub fn notify(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// Reads the next message.
    pub fn read(&mut self) -> Value {
        let mut size = 0;
        loop {
            let mut line = String::new();
            assert!(self.output.read_line(&mut line).unwrap() > 0, "the server has ended");
            match line.trim_end().split_once(": ") {
                Some(("Content-Length", value)) => size = value.parse().unwrap(),
                _ => break,
            }
        }
        let mut bytes = vec![0; size];
        self.output.read_exact(&mut bytes).unwrap();
        serde_json::from_slice(&bytes).unwrap()
    }

    /// Asks, and reads up to the answer.
    pub fn ask(&mut self, method: &str, params: Value) -> Value {
        self.count += 1;
        let id = self.count;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        loop {
            let message = self.read();
            if message["id"] == id {
                return message;
            }
            self.told.push(message);
        }
    }

    /// Opens a text and gives what the server finds in it.
    pub fn open(&mut self, uri: &str, text: &str) -> Vec<Value> {
        let document = json!({ "uri": uri, "languageId": "osl", "version": 1, "text": text });
        self.notify("textDocument/didOpen", json!({ "textDocument": document }));
        self.diagnostics(uri)
    }

    /// Changes a text, without waiting.
    pub fn change(&mut self, uri: &str, changes: Value) {
        self.count += 1;
        self.version = self.count;
        let document = json!({ "uri": uri, "version": self.count });
        self.notify("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    /// Reads up to the next list of what is wrong with a text.
    pub fn diagnostics(&mut self, uri: &str) -> Vec<Value> {
        loop {
            let message = self.read();
            if message["method"] == "textDocument/publishDiagnostics" && message["params"]["uri"] == uri {
                return message["params"]["diagnostics"].as_array().unwrap().clone();
            }
            self.told.push(message);
        }
    }

    /// Reads up to what is wrong with the version of a text that was sent last.
    pub fn last_diagnostics(&mut self, uri: &str) -> Value {
        let told = std::mem::take(&mut self.told);
        let version = self.version;
        let wanted = |m: &Value| {
            m["method"] == "textDocument/publishDiagnostics"
                && m["params"]["uri"] == uri
                && m["params"]["version"] == version
        };
        if let Some(message) = told.into_iter().rev().find(wanted) {
            return message["params"]["diagnostics"].clone();
        }
        loop {
            let message = self.read();
            if wanted(&message) {
                return message["params"]["diagnostics"].clone();
            }
        }
    }

    /// Asks about a place of the text at [`URI`].
    pub fn at(&mut self, method: &str, line: u32, column: u32) -> Value {
        self.at_with(method, line, column, json!({}))
    }

    /// The same with more to it.
    pub fn at_with(&mut self, method: &str, line: u32, column: u32, more: Value) -> Value {
        let mut params = json!({
            "textDocument": { "uri": URI },
            "position": { "line": line, "character": column },
        });
        for (name, value) in more.as_object().unwrap() {
            params[name] = value.clone();
        }
        self.ask(&format!("textDocument/{method}"), params)
    }

    /// Says good-bye and gives the status that the server ends with.
    pub fn end(mut self) -> i32 {
        assert_eq!(self.ask("shutdown", Value::Null)["result"], Value::Null);
        self.notify("exit", Value::Null);
        self.status()
    }

    /// Closes the server's input and waits for its status.
    pub fn status(mut self) -> i32 {
        self.input = None;
        self.process.wait().unwrap().code().unwrap()
    }
}

/// A range as `line:column-line:column`.
pub fn shown(range: &Value) -> String {
    let place = |p: &Value| format!("{}:{}", p["line"], p["character"]);
    format!("{}-{}", place(&range["start"]), place(&range["end"]))
}

/// The ranges of a list of places, each as [`shown`].
pub fn ranges(list: &Value) -> Vec<String> {
    list.as_array().unwrap().iter().map(|place| shown(&place["range"])).collect()
}

/// Diagnostics as `code range`.
pub fn codes(list: &[Value]) -> Vec<String> {
    list.iter().map(|d| format!("{} {}", d["code"].as_str().unwrap_or("-"), shown(&d["range"]))).collect()
}
