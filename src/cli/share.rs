//! Shares of a picture's samples, for engines that run tasks.

use std::ops::Range;
use std::str::FromStr;

/// One of so many shares of all samples, counted from 1; shares differ by one sample at the most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    number: u32,
    of: u32,
}

impl Share {
    /// Its part of so many samples; nothing where there are more shares than samples and this one has none.
    pub fn range(self, samples: u32) -> Option<Range<u32>> {
        let end = |number: u32| (u64::from(samples) * u64::from(number) / u64::from(self.of)) as u32;
        let range = end(self.number - 1)..end(self.number);
        (!range.is_empty()).then_some(range)
    }
}

impl FromStr for Share {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is no share; write the third of eight as 3/8");
        let (number, of) = text.split_once('/').ok_or_else(wrong)?;
        let parsed = |text: &str| text.parse::<u32>().map_err(|_| wrong());
        let share = Share { number: parsed(number)?, of: parsed(of)? };
        if share.number == 0 || share.number > share.of { Err(wrong()) } else { Ok(share) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_all_samples() {
        for (samples, of) in [(64, 4), (10, 3), (7, 7), (u32::MAX, 1000), (3, 8)] {
            let shares: Vec<_> = (1..=of).filter_map(|number| Share { number, of }.range(samples)).collect();
            assert!(shares.windows(2).all(|pair| pair[0].end == pair[1].start));
            assert_eq!((shares[0].start, shares[shares.len() - 1].end), (0, samples));
            let sizes = || shares.iter().map(|range| range.end - range.start);
            assert!(sizes().max().unwrap() - sizes().min().unwrap() <= 1);
        }
        for wrong in ["", "3", "0/4", "5/4", "1/0", "a/b", "1/2/3", "-1/2"] {
            assert!(wrong.parse::<Share>().is_err(), "{wrong}");
        }
    }
}
