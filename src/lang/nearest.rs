//! Which known name a mistyped one may stand for.

/// The known name that is closest to a word, when it is close enough to be meant: one slip in short words, one more for every five
/// letters. Two neighbouring letters that have changed places are one slip; capitals do not count.
pub fn nearest<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    let word: Vec<char> = word.to_lowercase().chars().collect();
    let off = |name: &&'k str| (slips(&word, &name.to_lowercase().chars().collect::<Vec<_>>()), *name);
    let (least, name) = known.iter().map(off).min()?;
    // Beyond that a guess confuses more than it helps.
    (least <= 1 + word.len() / 5).then_some(name)
}

/// Letters that are missing, too many, others, or in the place of their neighbours.
///
/// Source: the restricted distance of Damerau 1964 and Levenshtein 1966.
fn slips(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 0..a.len() {
        let mut row = vec![i + 1];
        for j in 0..b.len() {
            let other = last[j] + usize::from(a[i] != b[j]);
            let mut least = other.min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j] {
                least = least.min(before[j - 1] + 1);
            }
            row.push(least);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn a_small_slip_finds_its_name_and_a_stranger_finds_none() {
        let known = ["Camera", "Sphere", "Quad", "Model", "nap", "time"];
        for (word, meant) in [
            ("Spere", Some("Sphere")),
            ("camera", Some("Camera")),
            ("Camrea", Some("Camera")),
            ("npa", Some("nap")),
            ("anp", Some("nap")),
            ("Teapot", None),
            ("pile", None),
            ("", None),
        ] {
            assert_eq!(nearest(word, &known), meant, "{word}");
        }
        assert_eq!(nearest("x", &[]), None);
    }
}
