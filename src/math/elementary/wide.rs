//! The `f64` insides that several functions share: base-two exponential and logarithm, circular reduction, polynomials.
//!
//! All coefficients are fitted: Chebyshev interpolation computed with 60 digits, on the range and with the relative
//! error that stand beside them. A result rounded to `f32` has 2^-24, so 2^-30 and better costs no visible ulp.

/// 1.5 * 2^52. Adding it leaves the nearest whole number in the low bits of an `f64`.
const ROUND: f64 = 6_755_399_441_055_744.0;
const ONE_BITS: u64 = 0x3ff0_0000_0000_0000;
const SQRT_HALF_BITS: u64 = 0x3fe6_a09e_667f_3bcd;
const MANTISSA: u64 = 0x000f_ffff_ffff_ffff;

/// A polynomial, constant term first, by Horner's rule.
#[inline(always)]
pub(super) fn polynomial<const N: usize>(x: f64, coefficients: [f64; N]) -> f64 {
    let mut sum = coefficients[N - 1];
    for k in (0..N - 1).rev() {
        sum = sum * x + coefficients[k];
    }
    sum
}

/// Limits `x` to `[low, high]`; NaN passes through, which `f64::min` would not let it do.
#[inline(always)]
pub(super) fn limit(x: f64, low: f64, high: f64) -> f64 {
    let x = if x < low { low } else { x };
    if x > high { high } else { x }
}

/// Splits `x` in the nearest whole number and its power of two.
#[inline(always)]
fn nearest_and_power(x: f64) -> (f64, f64) {
    let shifted = x + ROUND;
    let power = f64::from_bits((shifted.to_bits() << 52).wrapping_add(ONE_BITS));
    (shifted - ROUND, power)
}

/// 2^x with relative error below 2^-33, for any `x`; beyond `f32` range it saturates far outside of it.
#[inline(always)]
pub(super) fn exp2(x: f64) -> f64 {
    let x = limit(x, -300.0, 300.0);
    let (n, power) = nearest_and_power(x);
    let f = x - n;
    // (2^f - 1) / f on [-0.501, 0.501], relative error of 2^f: 2^-33.1.
    let p = polynomial(
        f,
        [
            6.931_471_805_599_453e-1,
            2.402_265_092_502_106e-1,
            5.550_410_884_119_931e-2,
            9.618_056_096_717_177e-3,
            1.333_350_193_834_123_7e-3,
            1.546_167_697_597_332_5e-4,
            1.529_750_254_363_543_8e-5,
        ],
    );
    power * (1.0 + f * p)
}

/// e^x - 1 with relative error below 2^-36, for |x| of at most 200; beyond that it saturates.
#[inline(always)]
pub(super) fn expm1(x: f64) -> f64 {
    // ln 2 in two parts, so that n times the first is exact.
    const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
    const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let x = limit(x, -200.0, 200.0);
    let (n, power) = nearest_and_power(x * std::f64::consts::LOG2_E);
    let r = (x - n * LN_2_HIGH) - n * LN_2_LOW;
    // (e^r - 1) / r on |r| <= 0.347, relative error 2^-37.5.
    let p = polynomial(
        r,
        [
            9.999_999_999_954_73e-1,
            4.999_999_999_995_475e-1,
            1.666_666_678_702_875_3e-1,
            4.166_666_678_698_556e-2,
            8.333_283_339_034_426e-3,
            1.388_883_891_099_605_6e-3,
            1.990_770_217_573_503_4e-4,
            2.486_800_297_805_696_2e-5,
        ],
    );
    power * (r * p) + (power - 1.0)
}

/// The base-two logarithm of a non-negative `x` that came from an `f32`, with relative error below 2^-37.
///
/// Gives -inf at 0, inf at inf, NaN below 0 and for NaN.
#[inline(always)]
pub(super) fn log2(x: f64) -> f64 {
    // 2/ln 2 * atanh(s)/s in s^2 on [0, 0.0297], relative error 2^-37.7.
    log2_with(
        x,
        [
            2.885_390_081_790_610_4,
            9.617_966_726_067_577e-1,
            5.770_837_376_230_704e-1,
            4.116_629_247_711_17e-1,
            3.409_216_364_458_894e-1,
        ],
    )
}

/// As [`log2`], with relative error below 2^-30 and one term less.
#[inline(always)]
pub(super) fn log2_short(x: f64) -> f64 {
    // 2/ln 2 * atanh(s)/s in s^2 on [0, 0.0297], relative error 2^-30.4.
    log2_with(
        x,
        [2.885_390_079_722_149_5, 9.617_989_048_643_183e-1, 5.767_077_290_232_114e-1, 4.319_195_918_208_319e-1],
    )
}

#[inline(always)]
fn log2_with<const N: usize>(x: f64, coefficients: [f64; N]) -> f64 {
    // The mantissa is brought to [sqrt 1/2, sqrt 2), so that the logarithm keeps its relative precision around 1.
    let shifted = x.to_bits().wrapping_add(ONE_BITS - SQRT_HALF_BITS);
    // An integer below 2^52 becomes an f64 by putting it in the mantissa of 2^52: AVX2 has no conversion for it.
    let exponent = f64::from_bits((shifted >> 52) | 0x4330_0000_0000_0000) - (4_503_599_627_370_496.0 + 1023.0);
    let m = f64::from_bits((shifted & MANTISSA) + SQRT_HALF_BITS);
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let finite = exponent + s * polynomial(s * s, coefficients);
    let result = if x == 0.0 { f64::NEG_INFINITY } else { finite };
    let result = if x == f64::INFINITY { x } else { result };
    if x >= 0.0 { result } else { f64::NAN }
}

/// Takes whole quarter turns off `x`: the rest, within [-pi/4, pi/4], and the count of turns modulo 2^32.
///
/// The rest is good to 2^-53 for |x| up to 1e6 and to about 1e-7 for |x| up to 1e9; beyond that it means nothing but
/// stays within [-1, 1]. Infinities and NaN give NaN.
#[inline(always)]
pub(super) fn quarter_turns(x: f32) -> (f64, i32) {
    // pi/2 in two parts; the first has 33 bits, so that n times it is exact for n up to 2^20.
    const HALF_PI_HIGH: f64 = 1.570_796_326_734_125_6;
    const HALF_PI_LOW: f64 = 6.077_100_506_506_192e-11;
    let x = x as f64;
    let shifted = x * std::f64::consts::FRAC_2_PI + ROUND;
    let n = shifted - ROUND;
    let rest = (x - n * HALF_PI_HIGH) - n * HALF_PI_LOW;
    (limit(rest, -1.0, 1.0), shifted.to_bits() as i32)
}
