//! Addresses of files: `file:///a/b%20c.osl`.

use std::path::{Path, PathBuf};

/// The path of a file's address; nothing for another kind of address.
pub(super) fn path_of(uri: &str) -> Option<PathBuf> {
    let rest = uri.strip_prefix("file://")?;
    // A host's name may stand before the path.
    let path = &rest[rest.find('/')?..];
    let path = String::from_utf8(decoded(path)).ok()?;
    if path.contains('\0') {
        return None;
    }
    // `/C:/shaders` of Windows.
    let drive = path.as_bytes().get(2) == Some(&b':') && path.as_bytes()[1].is_ascii_alphabetic();
    Some(PathBuf::from(if cfg!(windows) && drive { &path[1..] } else { &path }))
}

/// The address of a file.
pub(super) fn of_path(path: &Path) -> String {
    let mut out = String::from("file://");
    let text = path.to_string_lossy();
    let text = if cfg!(windows) { format!("/{}", text.replace('\\', "/")) } else { text.into_owned() };
    for byte in text.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' => out.push(char::from(byte)),
            other => out += &format!("%{other:02X}"),
        }
    }
    out
}

fn decoded(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let (mut out, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        let code = (bytes[at] == b'%').then(|| text.get(at + 1..at + 3)).flatten();
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => {
                out.push(byte);
                at += 3;
            }
            None => {
                out.push(bytes[at]);
                at += 1;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(not(windows))]
    fn addresses_lead_to_paths_and_back() {
        for path in ["/a/b c.osl", "/ü/%41/\u{1f9f5}#?.osl", "/"] {
            assert_eq!(path_of(&of_path(Path::new(path))), Some(PathBuf::from(path)));
        }
        assert_eq!(of_path(Path::new("/a b")), "file:///a%20b");
        assert_eq!(path_of("file://host/a%2Fb%"), Some(PathBuf::from("/a/b%")));
        for other in ["untitled:Untitled-1", "file:", "file://x", "file:///%00", ""] {
            assert_eq!(path_of(other), None, "{other}");
        }
    }
}
