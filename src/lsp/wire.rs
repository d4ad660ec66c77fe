//! Messages as bytes: a header that states a length, and JSON.

use lsp_server::{ErrorCode, Message};
use serde_json::Value;
use std::io::{self, BufRead, Read, Write};

/// Bytes of a message: more is not read. The largest shader, written in escapes.
const MOST: u64 = 1 << 27;

/// Bytes of a line of a header.
const MOST_HEADER: u64 = 1 << 12;

/// Something that was read.
#[derive(Debug)]
pub(super) enum Incoming {
    /// A message.
    Message(Message),
    /// What is none: the answer to it.
    Broken(Value),
}

/// Reads the next message; nothing at the end.
pub(super) fn read(input: &mut impl BufRead) -> io::Result<Option<Incoming>> {
    let mut size = None;
    loop {
        let mut line = Vec::new();
        input.by_ref().take(MOST_HEADER).read_until(b'\n', &mut line)?;
        if line.is_empty() {
            return Ok(None);
        }
        let line = line.trim_ascii();
        // Lines that say something else, or nothing that can be understood, are passed over up to one that states a length.
        match size {
            Some(size) if line.is_empty() => return body(input, size).map(Some),
            _ => size = length(line).or(size),
        }
    }
}

fn length(line: &[u8]) -> Option<u64> {
    let (name, value) = std::str::from_utf8(line).ok()?.split_once(':')?;
    if !name.eq_ignore_ascii_case("Content-Length") {
        return None;
    }
    value.trim().parse().ok()
}

fn body(input: &mut impl BufRead, size: u64) -> io::Result<Incoming> {
    if size > MOST {
        io::copy(&mut input.take(size), &mut io::sink())?;
        return Ok(broken(None, ErrorCode::InvalidRequest, format!("a message of more than {} MB", MOST >> 20)));
    }
    let mut bytes = Vec::new();
    input.take(size).read_to_end(&mut bytes)?;
    let value: Value = match serde_json::from_slice(&bytes) {
        Ok(value) => value,
        Err(error) => return Ok(broken(None, ErrorCode::ParseError, error.to_string())),
    };
    let id = value.get("id").cloned();
    Ok(match serde_json::from_value(value) {
        Ok(message) => Incoming::Message(message),
        Err(_) => broken(id, ErrorCode::InvalidRequest, "this is no request, answer or notification".to_owned()),
    })
}

fn broken(id: Option<Value>, code: ErrorCode, message: String) -> Incoming {
    let error = serde_json::json!({ "code": code as i32, "message": message });
    Incoming::Broken(serde_json::json!({ "jsonrpc": "2.0", "id": id, "error": error }))
}

/// Writes a message.
pub(super) fn write(output: &mut impl Write, message: &Value) -> io::Result<()> {
    let text = message.to_string();
    write!(output, "Content-Length: {}\r\n\r\n{text}", text.len())?;
    output.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(bytes: &[u8]) -> Vec<String> {
        let mut input = bytes;
        let mut out = Vec::new();
        while let Some(read) = read(&mut input).unwrap() {
            out.push(match read {
                Incoming::Message(Message::Request(request)) => request.method,
                Incoming::Message(Message::Notification(notification)) => notification.method,
                Incoming::Message(Message::Response(_)) => "answer".to_owned(),
                Incoming::Broken(answer) => answer["error"]["code"].to_string(),
            });
        }
        out
    }

    #[test]
    fn broken_messages_are_answered_and_the_next_one_is_read() {
        let mut bytes = Vec::new();
        let mut add = |header: &str, body: &[u8]| {
            bytes.extend_from_slice(header.as_bytes());
            bytes.extend_from_slice(body);
        };
        let request = br#"{"jsonrpc":"2.0","id":1,"method":"a"}"#;
        let length = format!("Content-Length: {}\r\n\r\n", request.len());
        add(&length, request);
        add("Content-Length: 3\r\nContent-Type: x\r\n\r\n", b"{{{");
        add("nonsense\r\n\r\n\n\u{fffd}: 3\r\nCONTENT-LENGTH: 4\r\n\r\n", b"\xff\xfe\xfd\xfc");
        add("Content-Length: 2\n\n", b"[]");
        add("Content-Length: 8\r\n\r\n", br#"{"id":1}"#);
        add("Content-Length: 99999999999999999999999\r\n", b"");
        add(&length, request);
        add("Content-Length: 18446744073709551615\r\n\r\n", b"the rest");
        assert_eq!(kinds(&bytes), ["a", "-32700", "-32700", "-32600", "-32600", "a", "-32600"]);
    }
}
