//! Which samples of each pixel there are: numbers, as half-open ranges.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// Numbers of samples: ranges that are sorted, not empty, and do not touch.
///
/// As text, `0..64` or `0..16,32..64`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Ranges(Vec<Range<u32>>);

impl Ranges {
    /// The numbers of one range.
    pub fn of(range: Range<u32>) -> Self {
        Ranges(if range.is_empty() { Vec::new() } else { vec![range] })
    }

    /// True when there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// How many numbers there are.
    pub fn count(&self) -> u32 {
        self.0.iter().map(|range| range.end - range.start).sum()
    }

    /// The ranges.
    pub fn iter(&self) -> impl Iterator<Item = &Range<u32>> {
        self.0.iter()
    }

    /// One behind the largest number; 0 when there is none.
    pub fn end(&self) -> u32 {
        self.0.last().map_or(0, |range| range.end)
    }

    /// Adds the numbers of a range.
    pub fn insert(&mut self, range: Range<u32>) {
        if range.is_empty() {
            return;
        }
        let mut all = std::mem::take(&mut self.0);
        all.push(range);
        all.sort_unstable_by_key(|range| range.start);
        for range in all {
            match self.0.last_mut() {
                Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
                _ => self.0.push(range),
            }
        }
    }

    /// The numbers of either.
    pub fn union(&self, other: &Ranges) -> Ranges {
        let mut all = self.clone();
        other.iter().for_each(|range| all.insert(range.clone()));
        all
    }

    /// The numbers that are in both.
    pub fn shared(&self, other: &Ranges) -> Ranges {
        let mut shared = Ranges::default();
        for a in self.iter() {
            other.iter().for_each(|b| shared.insert(a.start.max(b.start)..a.end.min(b.end)));
        }
        shared
    }

    /// The numbers of `other` that are not here.
    pub fn lacking(&self, other: &Ranges) -> Ranges {
        let mut lacking = Ranges::default();
        other.iter().for_each(|range| self.missing(range.clone()).iter().for_each(|gap| lacking.insert(gap.clone())));
        lacking
    }

    /// The numbers of `whole` that are not here.
    pub fn missing(&self, whole: Range<u32>) -> Ranges {
        let mut missing = Ranges::default();
        let mut next = whole.start;
        for range in self.iter() {
            missing.insert(next..range.start.min(whole.end));
            next = next.max(range.end);
        }
        missing.insert(next..whole.end);
        missing
    }
}

/// The fewest and the most numbers of any of these.
pub fn counts(of: &[Ranges]) -> [u32; 2] {
    let counts = || of.iter().map(Ranges::count);
    [counts().min().unwrap_or(0), counts().max().unwrap_or(0)]
}

impl fmt::Display for Ranges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, range) in self.iter().enumerate() {
            let comma = if i == 0 { "" } else { "," };
            write!(f, "{comma}{}..{}", range.start, range.end)?;
        }
        Ok(())
    }
}

impl FromStr for Ranges {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut ranges = Ranges::default();
        for part in text.split(',') {
            let wrong = || format!("`{part}` is no range of samples; write it as 0..64");
            let (start, end) = part.split_once("..").ok_or_else(wrong)?;
            let number = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
            let range = number(start)?..number(end)?;
            if range.is_empty() {
                return Err(format!("`{part}` holds no sample: its end must be above its start"));
            }
            ranges.insert(range);
        }
        Ok(ranges)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_join_and_leave_gaps() {
        let ranges: Ranges = "32..64,0..16,64..70,10..20".parse().unwrap();
        assert_eq!(ranges.to_string(), "0..20,32..70");
        assert_eq!((ranges.count(), ranges.end()), (58, 70));
        assert_eq!(ranges.missing(5..80).to_string(), "20..32,70..80");
        assert_eq!(ranges.missing(40..50).to_string(), "");
        assert_eq!(ranges.shared(&Ranges::of(15..33)).to_string(), "15..20,32..33");
        for wrong in ["", "5", "5..5", "6..5", "a..b", "0..8,,", "-1..3", "0..5000000000"] {
            assert!(wrong.parse::<Ranges>().is_err(), "{wrong}");
        }
    }
}
