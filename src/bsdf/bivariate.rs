//! Polynomials in two variables, of which a material fixes one: how the albedos of wide lobes are fitted.

/// The coefficients in the first variable once the second is known; rows are powers of the first.
#[inline(always)]
pub fn collapse<const I: usize, const J: usize>(rows: &[[f32; J]; I], second: f32) -> [f32; I] {
    let mut out = [0.0; I];
    for i in 0..I {
        out[i] = horner(&rows[i], second);
    }
    out
}

/// A polynomial, lowest power first.
#[inline(always)]
pub fn horner<const I: usize>(coefficients: &[f32; I], x: f32) -> f32 {
    let mut sum = coefficients[I - 1];
    for i in (0..I - 1).rev() {
        sum = sum * x + coefficients[i];
    }
    sum
}
