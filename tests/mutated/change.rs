//! Changes of bytes at random: some taken out, doubled, swapped, spliced from another text, or words of a dictionary put in.

/// A small generator of numbers (PCG, O'Neill 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// A number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (((self.0 >> 18) ^ self.0) >> 27) as u32;
        (u64::from(mixed.rotate_right((self.0 >> 59) as u32)) as usize) % n.max(1)
    }
}

/// A range of at most `most` of `len` bytes.
fn some(random: &mut Random, len: usize, most: usize) -> std::ops::Range<usize> {
    let start = random.below(len + 1);
    start..(start + random.below(most)).min(len)
}

/// Bytes of `corpus`, changed in one to six places.
pub fn changed(random: &mut Random, corpus: &[Vec<u8>], words: &[&str]) -> Vec<u8> {
    let mut bytes = corpus[random.below(corpus.len())].clone();
    for _ in 0..1 + random.below(6) {
        let most = 1 << random.below(9);
        let at = some(random, bytes.len(), most);
        match random.below(8) {
            0 => drop(bytes.drain(at)),
            1 => {
                let piece = bytes[at.clone()].to_vec();
                bytes.splice(at.end..at.end, piece);
            }
            2 => {
                let other = &corpus[random.below(corpus.len())];
                let piece = other[some(random, other.len(), 64)].to_vec();
                bytes.splice(at, piece);
            }
            3 | 4 => drop(bytes.splice(at.start..at.start, words[random.below(words.len())].bytes())),
            5 => drop(bytes.splice(some(random, bytes.len(), 8), words[random.below(words.len())].bytes())),
            6 => {
                if let Some(byte) = bytes.get_mut(at.start) {
                    *byte = random.below(256) as u8;
                }
            }
            _ => {
                // A number becomes another one, as counts and sizes do.
                let digit = bytes.iter().skip(at.start).position(u8::is_ascii_digit).map(|i| i + at.start);
                if let Some(digit) = digit {
                    let numbers = ["0", "-1", "1e30", "nan", "4294967296", "99999999999", "0.5", "2147483647", "1e-40"];
                    bytes.splice(digit..digit + 1, numbers[random.below(numbers.len())].bytes());
                }
            }
        }
    }
    bytes.truncate(1 << 16);
    bytes
}
