//! Powers of ordinary numbers for the hot loops: shorter than the general functions, which also serve zeros and infinities.
//!
//! Decision (2026-11-22): the sheen takes its powers from here, because two of them are most of its cost and the general
//! `exp(y ln x)` spends a division and a third of its instructions on zeros, denormals and infinities that a clamp has
//! already ruled out, instead of from `math::elementary`.

/// Base-two logarithm.
///
/// Source: own fit, degree 8, on a mantissa in sqrt(1/2)..sqrt(2). Domain: positive normal numbers.
/// Gives: absolute error below 6e-8 plus half an ulp. Degenerate cases: none in the domain, nonsense outside it.
#[inline(always)]
pub fn log2(x: f32) -> f32 {
    const SQRT_HALF_BITS: i32 = 0x3f35_04f3;
    let bits = x.to_bits() as i32;
    let exponent = (bits - SQRT_HALF_BITS) >> 23;
    let f = f32::from_bits((bits - (exponent << 23)) as u32) - 1.0;
    let p = 0.122_805_28 * f - 0.205_705_6;
    let p = p * f + 0.216_119_13;
    let p = p * f - 0.239_194_9;
    let p = p * f + 0.287_901_76;
    let p = p * f - 0.360_692_1;
    let p = p * f + 0.480_910_78;
    let p = p * f - 0.721_347_5;
    let p = p * f + std::f32::consts::LOG2_E;
    p * f + exponent as f32
}

/// Two to a power.
///
/// Source: own fit, degree 6, on a fraction in -0.5..0.5. Domain: all numbers, limited to -126..127.
/// Gives: relative error below 2e-7, never zero, infinite or denormal.
#[inline(always)]
pub fn exp2(x: f32) -> f32 {
    /// 1.5 * 2^23: adding it leaves the nearest whole number in the low bits.
    const ROUND: f32 = 12_582_912.0;
    let x = x.clamp(-126.0, 127.0);
    let shifted = x + ROUND;
    let f = x - (shifted - ROUND);
    let p = 1.533_757_7e-4 * f + 1.339_986e-3;
    let p = p * f + 9.618_52e-3;
    let p = p * f + 5.550_329e-2;
    let p = p * f + 0.240_226_46;
    let p = p * f + std::f32::consts::LN_2;
    let p = p * f + 1.0;
    // The whole part goes straight into the exponent; the rounding constant's own bits shift out.
    f32::from_bits(p.to_bits().wrapping_add(shifted.to_bits() << 23))
}

/// x to the power y.
///
/// Domain: positive normal x. Gives: relative error below 2e-7 + 8e-8 |y log2 x|; limited to 2^-126..2^127.
#[inline(always)]
pub fn power(x: f32, y: f32) -> f32 {
    exp2(y * log2(x))
}

/// e to a power, with the limits of [`exp2`].
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    exp2(x * std::f32::consts::LOG2_E)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithm_and_exponential_are_as_good_as_stated() {
        let mut x = 1.2e-38f32;
        while x < 1e38 {
            let exact = f64::from(x).log2();
            assert!((f64::from(log2(x)) - exact).abs() < 6e-8 + 6e-8 * exact.abs(), "{x}");
            x *= 1.000_37;
        }
        for k in -126_000..=126_000 {
            let y = k as f32 / 1000.0;
            assert!((f64::from(exp2(y)) / f64::from(y).exp2() - 1.0).abs() < 2e-7, "{y}");
        }
        assert!(exp2(-1e30) > 0.0 && exp2(1e30).is_finite() && exp2(0.0) == 1.0);
    }
}
