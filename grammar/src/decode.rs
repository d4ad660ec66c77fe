//! Bytes to text: UTF-8, or Latin-1 bytes in the strings and comments of old shaders.

use crate::preprocessor::scan::{Kind, scan};

/// The text of a file, or `None` when it is no text: it has NUL bytes, or bytes that are not UTF-8 outside strings
/// and comments.
pub(crate) fn decode(bytes: &[u8]) -> Option<String> {
    if bytes.contains(&0) || u32::try_from(bytes.len()).is_err() {
        return None;
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        return Some(text.to_string());
    }
    let mut text = String::with_capacity(bytes.len() + 64);
    let mut foreign = Vec::new();
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        for byte in chunk.invalid() {
            foreign.push(text.len() as u32);
            text.push(char::from(*byte));
        }
    }
    in_strings_or_comments(&text, &foreign).then_some(text)
}

/// True when no byte of the list lies in a token other than a string. Outside of all tokens is a comment, since a
/// byte that is not ASCII is no white space.
fn in_strings_or_comments(text: &str, bytes: &[u32]) -> bool {
    let tokens = scan(text, 0);
    bytes.iter().all(|byte| {
        let after = tokens.partition_point(|t| t.place.start <= *byte);
        match after.checked_sub(1).map(|i| tokens[i]) {
            Some(t) if t.place.end > *byte => {
                matches!(t.kind, Kind::Text | Kind::UnclosedText | Kind::UnclosedComment)
            }
            _ => true,
        }
    })
}
