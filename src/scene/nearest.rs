//! The nearest known name to a mistyped one.

/// The name of `known` that `word` most likely meant, when one is near enough to be worth saying.
pub fn nearest<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    let word = word.to_lowercase();
    let (name, distance) =
        known.iter().map(|name| (*name, edits(&word, &name.to_lowercase()))).min_by_key(|(_, distance)| *distance)?;
    // Two edits, or a third of a long word: beyond that a guess confuses more than it helps.
    (distance <= 2.max(word.chars().count() / 3)).then_some(name)
}

/// Levenshtein's distance, counting characters.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let replace = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = replace.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn a_small_slip_finds_its_name_and_a_stranger_finds_none() {
        let known = ["Camera", "Sphere", "Quad", "Model"];
        assert_eq!(nearest("Spere", &known), Some("Sphere"));
        assert_eq!(nearest("camera", &known), Some("Camera"));
        assert_eq!(nearest("Teapot", &known), None);
    }
}
