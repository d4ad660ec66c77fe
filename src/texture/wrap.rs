//! What a texture is outside of [0, 1].

/// How coordinates outside are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// There is nothing: zero in all channels.
    #[default]
    Black,
    /// The edge goes on.
    Clamp,
    /// The texture comes again.
    Periodic,
    /// The texture comes again, every other time mirrored.
    Mirror,
}

impl Wrap {
    /// The way of a name; `default` and what is no name are those of the file.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "black" => Wrap::Black,
            "clamp" => Wrap::Clamp,
            // OIIO has a faster one for sizes that are powers of two, of the same meaning.
            "periodic" | "periodic_pow2" => Wrap::Periodic,
            "mirror" => Wrap::Mirror,
            _ => return None,
        })
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Wrap::Black => "black",
            Wrap::Clamp => "clamp",
            Wrap::Periodic => "periodic",
            Wrap::Mirror => "mirror",
        }
    }

    /// The texel of a number, of `size` there are; nothing where it is black.
    #[inline(always)]
    pub fn texel(self, at: i32, size: usize) -> Option<usize> {
        if (at as u32 as usize) < size {
            return Some(at as usize);
        }
        let n = size as i32;
        match self {
            Wrap::Black => None,
            Wrap::Clamp => Some(at.clamp(0, n - 1) as usize),
            Wrap::Periodic => Some(at.rem_euclid(n) as usize),
            Wrap::Mirror => {
                let there = i64::from(at).rem_euclid(2 * i64::from(n));
                Some(there.min(2 * i64::from(n) - 1 - there) as usize)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_outside_are_taken_as_named() {
        let along = |wrap: Wrap| (-4..7).map(|at| wrap.texel(at, 3).map_or(9, |x| x as u8)).collect::<Vec<u8>>();
        assert_eq!(along(Wrap::Black), [9, 9, 9, 9, 0, 1, 2, 9, 9, 9, 9]);
        assert_eq!(along(Wrap::Clamp), [0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2]);
        assert_eq!(along(Wrap::Periodic), [2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0]);
        assert_eq!(along(Wrap::Mirror), [2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0]);
    }
}
