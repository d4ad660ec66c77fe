//! OSL's tools by their names: a link to velour that is called `oslc`, `oslinfo`, `testshade` or `testrender` is that tool.
//!
//! Decision (2026-11-29): by the name that the binary is called by, as busybox does it, so that build files and scripts that call OSL's
//! tools run as they are; instead of four further binaries, which are the same program and as large.

use std::ffi::OsString;
use std::path::Path;

/// The words of a command line with what the binary's name stands for put in.
pub fn named(words: Vec<OsString>) -> Vec<OsString> {
    let name = words.first().and_then(|word| Path::new(word).file_stem()?.to_str());
    let meant: &[&str] = match name {
        Some("oslc") => &["compile", "--message-format", "short"],
        Some("oslinfo") => &["info"],
        Some("testshade") => &["shade"],
        Some("testrender") => &["render"],
        _ => return words,
    };
    let (first, rest) = words.split_at(1);
    first.iter().cloned().chain(meant.iter().map(OsString::from)).chain(rest.iter().cloned()).collect()
}

#[cfg(test)]
mod tests {
    use super::named;
    use std::ffi::OsString;

    #[test]
    fn names_of_tools_stand_for_commands() {
        let words = |text: &str| text.split(' ').map(OsString::from).collect::<Vec<_>>();
        assert_eq!(named(words("/usr/bin/testshade -g 1 1 a")), words("/usr/bin/testshade shade -g 1 1 a"));
        assert_eq!(named(words("oslinfo.exe -v a")), words("oslinfo.exe info -v a"));
        assert_eq!(named(words("velour check a")), words("velour check a"));
        assert_eq!(named(Vec::new()), Vec::<OsString>::new());
    }
}
