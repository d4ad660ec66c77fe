//! The server: pages out, wishes in.
//!
//! | request | answer |
//! |---|---|
//! | `GET /`, `/page.css`, `/page.js`, … | the page |
//! | `GET /next?after=V` | the news since version V, once there are any: four bytes of a length (the least first), so many bytes of JSON, then the picture's bytes if it is new |
//! | `GET /pixel?x=X&y=Y` | what a pixel of the whole picture is made of |
//! | `POST /set` | `{"group", "layer", "name", "value"}`: a list of numbers, of one text, or null for what the text says |
//! | `POST /reset` | all parameters are what their texts say |
//! | `POST /screen` | `{"stops", "view"}`: exposure, and `soft`, `srgb`, `agx` or `linear` |
//! | `POST /verify` | `{"group"}` |

use super::board::Board;
use super::guard::{Claims, refused};
use super::inbox::{Inbox, Knob, Wish};
use super::page::{FILES, HEADERS};
use super::values::Given;
use crate::render::Screen;
use serde_json::{Value, json};
use std::io::Read;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::time::Duration;
use tiny_http::{Header, Method, Request, Response, Server};

/// How long a request for news waits for some.
const PATIENCE: Duration = Duration::from_secs(20);

/// How long a request for a pixel waits for its turn.
const TURN: Duration = Duration::from_secs(4);

/// Bytes that a request may carry.
const MOST_BYTES: u64 = 1 << 16;

/// Requests that are answered at the same time.
const MOST_AT_ONCE: usize = 64;

/// What requests are answered from.
#[derive(Clone, Debug)]
pub struct Desk {
    /// The news.
    pub board: Arc<Board>,
    /// The wishes.
    pub inbox: Arc<Inbox>,
    /// The port of the address that is served.
    pub port: u16,
}

type Answer = Response<std::io::Cursor<Vec<u8>>>;

/// Answers requests, each in a thread of its own, until the server is unblocked.
pub fn serve(server: &Server, desk: &Desk) {
    let busy = Arc::new(AtomicUsize::new(0));
    while let Ok(mut request) = server.recv() {
        if busy.load(Ordering::Relaxed) >= MOST_AT_ONCE {
            let _ = request.respond(text(503, "too many at once"));
            continue;
        }
        busy.fetch_add(1, Ordering::Relaxed);
        let (desk, gone) = (desk.clone(), busy.clone());
        std::thread::spawn(move || {
            let answer = desk.answer(&mut request);
            // Whoever has asked may have gone.
            let _ = request.respond(answer);
            gone.fetch_sub(1, Ordering::Relaxed);
        });
    }
}

fn dressed(status: u16, kind: &str, bytes: Vec<u8>) -> Answer {
    // Chunks would be a copy more.
    let mut response = Response::from_data(bytes).with_status_code(status).with_chunked_threshold(usize::MAX);
    let headers = HEADERS.iter().copied().chain([("Content-Type", kind)]);
    for header in headers.filter_map(|(name, value)| Header::from_bytes(name, value).ok()) {
        response.add_header(header);
    }
    response
}

fn text(status: u16, text: &str) -> Answer {
    dressed(status, "text/plain; charset=utf-8", format!("{text}\n").into_bytes())
}

fn told(value: &Value) -> Answer {
    dressed(200, "application/json", value.to_string().into_bytes())
}

fn header<'r>(request: &'r Request, name: &'static str) -> Option<&'r str> {
    let mut all = request.headers().iter().filter(|header| header.field.equiv(name));
    let first = all.next().map(|header| header.value.as_str());
    // Of two that differ nobody knows which one counts.
    if all.next().is_some() { Some("") } else { first }
}

impl Desk {
    fn answer(&self, request: &mut Request) -> Answer {
        let url = request.url().to_owned();
        let (path, query) = url.split_once('?').unwrap_or((&url, ""));
        let changes = *request.method() != Method::Get;
        let claims = Claims {
            changes,
            page: path == "/" && !changes,
            host: header(request, "Host"),
            origin: header(request, "Origin"),
            site: header(request, "Sec-Fetch-Site"),
            content: header(request, "Content-Type"),
        };
        if let Some(reason) = refused(&claims, self.port) {
            return text(403, reason);
        }
        match *request.method() {
            Method::Get => self.get(path, query),
            Method::Post => self.post(path, request),
            _ => text(405, "GET and POST are all there is"),
        }
    }

    fn get(&self, path: &str, query: &str) -> Answer {
        if let Some(file) = FILES.iter().find(|file| file.path == path) {
            return dressed(200, file.kind, file.text.as_bytes().to_vec());
        }
        let number = |name: &str| {
            let mut pairs = query.split('&').filter_map(|pair| pair.split_once('='));
            pairs.find(|(key, _)| *key == name).and_then(|(_, value)| value.parse::<u64>().ok())
        };
        match path {
            "/next" => self.news(number("after").unwrap_or(0)),
            "/pixel" => {
                let side = |name| number(name).and_then(|n| u32::try_from(n).ok());
                let (Some(x), Some(y)) = (side("x"), side("y")) else { return text(400, "x and y are whole numbers") };
                let (sender, receiver) = channel();
                self.inbox.push(Wish::Look([x, y], sender));
                let answer = receiver.recv_timeout(TURN);
                answer.map_or_else(|_| told(&json!({"x": x, "y": y, "late": true})), |value| told(&value))
            }
            _ => text(404, "there is no such page"),
        }
    }

    fn news(&self, after: u64) -> Answer {
        // Who sleeps because nobody looks is woken; else this would be in the way of the round.
        if !self.board.watched() {
            self.inbox.push(Wish::Watch);
        }
        let news = self.board.wait(after, PATIENCE);
        let json = json!({"version": news.version, "news": news.pieces}).to_string();
        let picture = news.frame.as_ref().map_or(0, |frame| frame.bytes.len());
        let mut bytes = Vec::with_capacity(4 + json.len() + picture);
        bytes.extend_from_slice(&(json.len() as u32).to_le_bytes());
        bytes.extend_from_slice(json.as_bytes());
        if let Some(frame) = &news.frame {
            bytes.extend_from_slice(&frame.bytes);
        }
        dressed(200, "application/octet-stream", bytes)
    }

    fn post(&self, path: &str, request: &mut Request) -> Answer {
        let mut body = String::new();
        let read = request.as_reader().take(MOST_BYTES).read_to_string(&mut body);
        let Some(value) = read.ok().and_then(|_| serde_json::from_str::<Value>(&body).ok()) else {
            return text(400, "a request carries JSON, of at most 64 kB");
        };
        let Some(wish) = wish(path, &value) else { return text(400, "that is nothing that can be wished for") };
        self.inbox.push(wish);
        told(&json!({}))
    }
}

/// What a request asks for.
fn wish(path: &str, value: &Value) -> Option<Wish> {
    let number = |name: &str| value.get(name)?.as_u64().and_then(|n| usize::try_from(n).ok());
    match path {
        "/set" => {
            let name = value.get("name")?.as_str()?.to_owned();
            let knob = Knob { group: number("group")?, layer: number("layer")?, name };
            match value.get("value")? {
                Value::Null => Some(Wish::Set(knob, None)),
                given => Given::of_json(given).map(|given| Wish::Set(knob, Some(given))),
            }
        }
        "/reset" => Some(Wish::Reset),
        "/screen" => {
            let stops = value.get("stops")?.as_f64().filter(|stops| stops.abs() <= 20.0)?;
            let view = value.get("view")?.as_str()?.parse().ok()?;
            Some(Wish::Screen(Screen { exposure: stops as f32, view }))
        }
        "/verify" => number("group").map(Wish::Verify),
        _ => None,
    }
}
