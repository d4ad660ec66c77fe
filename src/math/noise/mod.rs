//! Noise: functions of position that look random and are the same for everybody who evaluates them.
//!
//! All follow the numbers of Open Shading Language: same hash, same gradients, same scale factors, so that a shader
//! looks the same in another renderer. Everything is branch-free on one point, and a loop over points turns into SIMD.
//!
//! | kind | module | range | continuous |
//! |---|---|---|---|
//! | Perlin | [`perlin`] | [-1, 1] | value, gradient and second derivative |
//! | simplex | [`simplex`] | [-1, 1] | value and gradient |
//! | cell | [`cell`] | [0, 1] | constant in a cell |
//! | hash | [`cell`] | [0, 1] | nowhere |
//! | Gabor | [`gabor`] | nearly [-1, 1] | but for 2 % at the edges of bells; its numbers are not OSL's |
//!
//! Time in ns a lane under AVX2, one core of an AMD EPYC (benches/ratios): perlin1 2.1, perlin2 4.0, perlin3 6.6, its vector
//! variant 15, periodic 9.4, perlin4 17, simplex3 10, cell3 1.6, hash3 0.7.
//!
//! Continuous kinds give a [`Jet`]: the value and, when asked for, its gradient. `Jet<0>` has no gradient and costs
//! none. Periodic variants take a [`Lattice`] that wraps cells; [`unsigned`] moves a signed noise to [0, 1].

pub mod cell;
pub mod gabor;
mod lattice;
pub mod lookup3;
pub mod perlin;
pub mod simplex;

pub use lattice::{Endless, Lattice, Periodic, wrap};

#[cfg(test)]
mod tests;

/// A value with its gradient in `D` directions: all of the domain's, or none (`D` = 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<const D: usize> {
    /// The value.
    pub value: f32,
    /// Its partial derivatives.
    pub gradient: [f32; D],
}

impl<const D: usize> Jet<D> {
    /// The jet times a constant.
    #[inline(always)]
    pub fn scaled(self, factor: f32) -> Self {
        // Loops and not `map`, which is inlined at the linker's pleasure only.
        let mut gradient = [0.0; D];
        for axis in 0..D {
            gradient[axis] = factor * self.gradient[axis];
        }
        Jet { value: factor * self.value, gradient }
    }

    /// The partial derivative along `axis`, 0 where no gradient is kept.
    #[inline(always)]
    fn slope(&self, axis: usize) -> f32 {
        if axis < D { self.gradient[axis] } else { 0.0 }
    }
}

/// Moves signed noise in [-1, 1] to [0, 1], as OSL's `noise` relates to `snoise`.
#[inline(always)]
pub fn unsigned<const D: usize>(signed: Jet<D>) -> Jet<D> {
    Jet { value: 0.5 * (signed.value + 1.0), ..signed.scaled(0.5) }
}

/// The same for the three components of a vector noise.
#[inline(always)]
pub fn unsigned_vector<const D: usize>(signed: [Jet<D>; 3]) -> [Jet<D>; 3] {
    let [a, b, c] = signed;
    [unsigned(a), unsigned(b), unsigned(c)]
}
