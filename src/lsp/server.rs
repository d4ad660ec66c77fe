//! The life of a server: what is asked in which order, and when an editor is told of mistakes.

use super::answers::{Refusal, answer};
use super::documents::Documents;
use super::wire::{self, Incoming};
use super::{look, text::Text};
use crate::compile::Compiler;
use lsp_server::{ErrorCode, Message, Notification, Request};
use lsp_types::{DidChangeTextDocumentParams, DidCloseTextDocumentParams, DidOpenTextDocumentParams};
use serde_json::{Value, json};
use std::io::{self, BufReader, Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

/// What a server works with.
#[derive(Clone, Debug)]
pub struct Settings {
    /// What compiles the shaders.
    pub compiler: Compiler,
    /// Where headers that come with velour are written when somebody goes to what they declare; nothing for nowhere.
    pub headers: Option<PathBuf>,
}

/// Messages that wait to be looked at.
const WAITING: usize = 1024;

/// How far the talk has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Before,
    Running,
    ShutDown,
}

/// Serves one editor until it says `exit` or its messages end; true when it has asked for that by `shutdown` before.
///
/// # Errors
/// The editor cannot be written to any more.
pub fn serve(input: impl Read + Send + 'static, output: impl Write, settings: Settings) -> io::Result<bool> {
    let (sender, receiver) = sync_channel(WAITING);
    // It ends with the input, or at the first message after there is nobody to take it.
    std::thread::spawn(move || {
        let mut input = BufReader::new(input);
        while let Ok(Some(message)) = wire::read(&mut input) {
            if sender.send(message).is_err() {
                break;
            }
        }
    });
    let Settings { compiler, headers } = settings;
    let documents = Documents::new(compiler);
    Server { documents, headers, output, stage: Stage::Before }.run(&receiver)
}

struct Server<W> {
    documents: Documents,
    headers: Option<PathBuf>,
    output: W,
    stage: Stage,
}

impl<W: Write> Server<W> {
    fn run(mut self, receiver: &Receiver<Incoming>) -> io::Result<bool> {
        loop {
            let incoming = match receiver.try_recv() {
                Ok(incoming) => incoming,
                Err(TryRecvError::Disconnected) => return Ok(false),
                // Nothing waits: now there is time to say what is wrong.
                Err(TryRecvError::Empty) => {
                    self.tell_all()?;
                    match receiver.recv() {
                        Ok(incoming) => incoming,
                        Err(_) => return Ok(false),
                    }
                }
            };
            match incoming {
                Incoming::Broken(answer) => wire::write(&mut self.output, &answer)?,
                Incoming::Message(Message::Request(request)) => self.request(request)?,
                Incoming::Message(Message::Notification(notification)) if notification.method == "exit" => {
                    return Ok(self.stage == Stage::ShutDown);
                }
                Incoming::Message(Message::Notification(notification)) => self.notified(notification),
                // Nothing is asked of editors.
                Incoming::Message(Message::Response(_)) => {}
            }
        }
    }

    fn request(&mut self, request: Request) -> io::Result<()> {
        let Request { id, method, params } = request;
        // Whatever should go wrong in an answer, the texts are as they were, and the next one may be right.
        let answered = catch_unwind(AssertUnwindSafe(|| self.answered(&method, params)));
        let answered = answered.unwrap_or_else(|_| Err((ErrorCode::InternalError, format!("{method} has failed"))));
        let message = match answered {
            Ok(result) => json!({ "jsonrpc": "2.0", "id": id, "result": result }),
            Err((code, message)) => {
                json!({ "jsonrpc": "2.0", "id": id, "error": { "code": code as i32, "message": message } })
            }
        };
        wire::write(&mut self.output, &message)
    }

    fn answered(&mut self, method: &str, params: Value) -> Result<Value, Refusal> {
        match (self.stage, method) {
            (Stage::Before, "initialize") => {
                self.stage = Stage::Running;
                self.set(&params["initializationOptions"]);
                Ok(json!({
                    "capabilities": capabilities(),
                    "serverInfo": { "name": "velour", "version": env!("CARGO_PKG_VERSION") },
                }))
            }
            (Stage::Before, _) => Err((ErrorCode::ServerNotInitialized, "`initialize` comes first".to_owned())),
            (Stage::Running, "shutdown") => {
                self.stage = Stage::ShutDown;
                Ok(Value::Null)
            }
            (_, "initialize") => Err((ErrorCode::InvalidRequest, "`initialize` comes once".to_owned())),
            (Stage::ShutDown, _) => Err((ErrorCode::InvalidRequest, "after `shutdown` comes `exit`".to_owned())),
            (Stage::Running, _) => answer(&mut self.documents, self.headers.as_deref(), method, params),
        }
    }

    /// Takes the editor's settings: `includeFolders`, and `defines` as `NAME` or `NAME=VALUE`.
    fn set(&mut self, options: &Value) {
        let texts = |name: &str| -> Option<Vec<String>> {
            let list = options.get(name)?.as_array()?;
            Some(list.iter().filter_map(|text| text.as_str().map(str::to_owned)).collect())
        };
        let compiler = self.documents.compiler_mut();
        compiler
            .options
            .include_dirs
            .extend(texts("includeFolders").unwrap_or_default().into_iter().map(PathBuf::from));
        compiler.options.defines.extend(texts("defines").unwrap_or_default().into_iter().map(|text| {
            match text.split_once('=') {
                Some((name, value)) => (name.to_owned(), value.to_owned()),
                None => (text, "1".to_owned()),
            }
        }));
    }

    /// Notifications have no answer: what is wrong in one is passed over.
    fn notified(&mut self, notification: Notification) {
        let Notification { method, params } = notification;
        if self.stage != Stage::Running {
            return;
        }
        match method.as_str() {
            "textDocument/didOpen" => {
                if let Ok(DidOpenTextDocumentParams { text_document: opened }) = serde_json::from_value(params) {
                    self.documents.open(opened.uri.as_str(), opened.version.into(), opened.text);
                }
            }
            "textDocument/didChange" => {
                if let Ok(params) = serde_json::from_value::<DidChangeTextDocumentParams>(params) {
                    let document = params.text_document;
                    let changes = params.content_changes;
                    self.documents.change(document.uri.as_str(), document.version.into(), |text| {
                        for change in changes {
                            match change.range {
                                Some(range) => {
                                    text.replace(look::position(range.start), look::position(range.end), &change.text);
                                }
                                None => *text = Text::new(change.text),
                            }
                        }
                    });
                }
            }
            "textDocument/didClose" => {
                if let Ok(params) = serde_json::from_value::<DidCloseTextDocumentParams>(params) {
                    let uri = params.text_document.uri.as_str();
                    self.documents.close(uri);
                    let _ = self.tell(uri, None, &[]);
                }
            }
            "textDocument/didSave" | "workspace/didChangeWatchedFiles" => self.documents.forget(),
            _ => {}
        }
    }

    /// Tells the editor what is wrong with each text that it has not been told of.
    fn tell_all(&mut self) -> io::Result<()> {
        let stale = self.documents.open.iter().filter(|(_, document)| document.stale).map(|(uri, _)| uri.clone());
        let stale: Vec<String> = stale.collect();
        for uri in stale {
            let study = catch_unwind(AssertUnwindSafe(|| self.documents.study(&uri))).unwrap_or(None);
            let Some(document) = self.documents.open.get_mut(&uri) else { continue };
            document.stale = false;
            let header =
                self.headers.as_ref().is_some_and(|folder| std::path::Path::new(&document.name).starts_with(folder));
            let list: Vec<Value> = match study {
                // A header that comes with velour is no shader by itself.
                _ if header => Vec::new(),
                Some(study) => {
                    study.messages().iter().map(|message| look::diagnostic(&uri, &document.text, message)).collect()
                }
                None => vec![json!({
                    "range": look::range(&document.text, &(0..0)),
                    "severity": lsp_types::DiagnosticSeverity::ERROR,
                    "source": "velour",
                    "message": "this text is too long for a shader, or cannot be looked at",
                })],
            };
            let version = document.version;
            self.tell(&uri, Some(version), &list)?;
        }
        self.documents.clear();
        Ok(())
    }

    fn tell(&mut self, uri: &str, version: Option<i64>, list: &[Value]) -> io::Result<()> {
        let mut params = json!({ "uri": uri, "diagnostics": list });
        if let Some(version) = version {
            params["version"] = json!(version);
        }
        let method = "textDocument/publishDiagnostics";
        wire::write(&mut self.output, &json!({ "jsonrpc": "2.0", "method": method, "params": params }))
    }
}

fn capabilities() -> Value {
    json!({
        "positionEncoding": "utf-16",
        "textDocumentSync": { "openClose": true, "change": 2, "save": true },
        "hoverProvider": true,
        "completionProvider": { "triggerCharacters": ["\"", ".", "#"] },
        "signatureHelpProvider": { "triggerCharacters": ["(", ","] },
        "definitionProvider": true,
        "referencesProvider": true,
        "documentHighlightProvider": true,
        "documentSymbolProvider": true,
        "documentFormattingProvider": true,
        "renameProvider": { "prepareProvider": true },
    })
}
