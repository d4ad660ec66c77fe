//! MTL files. Materials come from shader groups, by name; so this only looks for what is odd and should be known.

use super::lines::{Lines, Words, shown};
use super::notes::Notes;
use super::number::number;

/// What is odd in the MTL file `text`.
///
/// A colour of one number is a grey. Statements that are not of the book are left alone: there are many dialects.
pub fn check_library(text: &[u8]) -> Notes {
    let mut notes = Notes::default();
    for (number, line) in Lines::new(text) {
        let mut words = Words::new(&line);
        let Some(statement) = words.next() else { continue };
        if let Some(oddity) = oddity(statement, words) {
            notes.add(number, || oddity);
        }
    }
    notes
}

/// What is odd in one statement, if anything.
fn oddity(statement: &[u8], words: Words) -> Option<String> {
    match statement {
        b"newmtl" => words.name().is_empty().then(|| "`newmtl` has no name".to_owned()),
        b"Ka" | b"Kd" | b"Ks" | b"Ke" | b"Tf" => color(&shown(statement), words),
        b"illum" | b"Ns" | b"Ni" | b"d" | b"Tr" | b"sharpness" => single(&shown(statement), words),
        _ => None,
    }
}

/// What is odd in a colour: one number or three are right.
fn color(statement: &str, words: Words) -> Option<String> {
    let words: Vec<&[u8]> = words.take(4).collect();
    if let Some(kind @ (b"spectral" | b"xyz")) = words.first().copied() {
        return Some(format!("`{statement} {}` is not read as a colour", shown(kind)));
    }
    match words.iter().find_map(|word| number(word).err()) {
        Some(flaw) => Some(format!("`{statement}`: {flaw}")),
        None if matches!(words.len(), 1 | 3 | 4) => None,
        None => Some(format!("`{statement}` has {} numbers, one (a grey) or three are needed", words.len())),
    }
}

/// What is odd in a statement of one number, which may have an option before it.
fn single(statement: &str, mut words: Words) -> Option<String> {
    let first = words.next();
    match first.map(|word| (word, number(word))) {
        None => Some(format!("`{statement}` has no number")),
        Some((_, Ok(_))) => None,
        Some((option @ [b'-', b'a'..=b'z', ..], Err(_))) => {
            Some(format!("option `{}` of `{statement}` is left out", shown(option)))
        }
        Some((_, Err(flaw))) => Some(format!("`{statement}`: {flaw}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_lines_are_named_and_greys_are_not_odd() {
        let text = b"newmtl a\nKd 1\nKa 1 2 3\nKs .5 # c\nillum foo\nKd spectral f.rfl\nd -halo .5\nNs\nKe 1 2\nmap_Kd a b.png\nPr x\n";
        let notes = check_library(text);
        let lines: Vec<u32> = notes.list.iter().map(|note| note.line).collect();
        assert_eq!(lines, [5, 6, 7, 8, 9]);
        assert_eq!(notes.list[0].text, "`illum`: `foo` is not a number");
        assert_eq!(notes.list[3].text, "`Ns` has no number");
        assert_eq!(notes.list[4].text, "`Ke` has 2 numbers, one (a grey) or three are needed");
        assert_eq!(notes.more, 0);
    }

    #[test]
    fn a_file_that_is_odd_all_over_is_named_in_a_few_lines() {
        let notes = check_library(&b"Ns x\r".repeat(1000));
        assert_eq!((notes.list.len(), notes.more), (5, 995));
        let warnings: Vec<String> = notes.warnings("m.mtl").collect();
        assert_eq!(warnings[4], "m.mtl:5: warning: `Ns`: `x` is not a number");
        assert_eq!(warnings[5], "m.mtl: warning: 995 more lines like these");
    }
}
