//! The integer lattice that noise is built on: endless, or wrapping round after a period.

use crate::math::elementary::{floor, floor_to_int};

/// What happens to cell numbers before they are hashed.
pub trait Lattice<const N: usize>: Copy {
    /// The cell whose hash stands for `cell`.
    fn cell(self, cell: [i32; N]) -> [u32; N];
}

/// A lattice without end: every cell is its own.
#[derive(Clone, Copy, Debug)]
pub struct Endless;

impl<const N: usize> Lattice<N> for Endless {
    #[inline(always)]
    fn cell(self, cell: [i32; N]) -> [u32; N] {
        let mut same = [0; N];
        for axis in 0..N {
            same[axis] = cell[axis] as u32;
        }
        same
    }
}

/// A lattice that repeats after a whole number of cells along each axis.
#[derive(Clone, Copy, Debug)]
pub struct Periodic<const N: usize> {
    period: [i32; N],
}

impl<const N: usize> Periodic<N> {
    /// Periods are rounded down to whole numbers; those below one become one.
    #[inline(always)]
    pub fn new(period: [f32; N]) -> Self {
        let mut whole = [0; N];
        for axis in 0..N {
            whole[axis] = floor_to_int(period[axis]).max(1);
        }
        Periodic { period: whole }
    }
}

impl<const N: usize> Lattice<N> for Periodic<N> {
    #[inline(always)]
    fn cell(self, cell: [i32; N]) -> [u32; N] {
        let mut wrapped = [0; N];
        for axis in 0..N {
            wrapped[axis] = modulo(cell[axis], self.period[axis]);
        }
        wrapped
    }
}

/// `a` modulo a positive `b`, in [0, b).
///
/// There is no SIMD integer division. In `f64` every step is exact but the division, and its error cannot reach the next whole
/// number: the quotient is at least 2^-31 of its size away from one that it does not equal.
#[inline(always)]
fn modulo(a: i32, b: i32) -> u32 {
    // 1.5 * 2^52: adding it rounds to the nearest whole number and leaves it in the low bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let (a, b) = (a as f64, b as f64);
    let nearest = (a / b + ROUND) - ROUND;
    let rest = a - b * nearest;
    let rest = if rest < 0.0 { rest + b } else { rest };
    (rest + ROUND).to_bits() as u32
}

/// Wraps a coordinate into [0, period) for periodic cell and hash noise, which wrap positions and not cells.
///
/// Source: OSL. Domain: all. Gives: `s` less whole periods; the period is rounded down and at least 1.
#[inline(always)]
pub fn wrap(s: f32, period: f32) -> f32 {
    let period = floor(period);
    let period = if period < 1.0 { 1.0 } else { period };
    s - period * floor(s / period)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modulo_is_euclidean() {
        let numbers = [0, 1, -1, 2, 3, 5, 7, -7, 100, 12345, -12345, i32::MAX, i32::MIN, i32::MAX - 1, i32::MIN + 1];
        for a in numbers {
            for b in numbers.into_iter().filter(|b| *b > 0) {
                assert_eq!(modulo(a, b) as i32, a.rem_euclid(b), "{a} modulo {b}");
            }
        }
    }

    #[test]
    fn wrap_treats_small_periods_as_one() {
        assert_eq!(wrap(2.25, 0.0), 0.25);
        assert_eq!(wrap(-0.75, 2.9), 1.25);
        assert_eq!(wrap(5.5, 4.0), 1.5);
    }
}
