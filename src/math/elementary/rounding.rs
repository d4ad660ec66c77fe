//! Rounding to whole numbers without the SSE4.1 instruction that the baseline target lacks.
//!
//! `f32::floor` and its siblings become calls into the C library when the target has no rounding instruction, and a
//! call keeps a loop from being vectorised. Adding and subtracting 2^23 rounds to a whole number on any machine.

/// Every `f32` of at least this magnitude is a whole number.
const WHOLE: f32 = 8_388_608.0;

/// The nearest whole number, ties to even, of a magnitude below 2^23; others pass through.
#[inline(always)]
fn nearest_magnitude(a: f32) -> f32 {
    let rounded = (a + WHOLE) - WHOLE;
    // The comparison is false for NaN and infinity, which pass through as well.
    if a < WHOLE { rounded } else { a }
}

/// The whole part, towards zero.
///
/// Source: round the magnitude to nearest, step back where that went up. Domain: all. Gives: exact, sign of zero kept.
/// Degenerate cases: infinities and NaN pass through.
#[inline(always)]
pub fn trunc(x: f32) -> f32 {
    let a = x.abs();
    let n = nearest_magnitude(a);
    let n = if n > a { n - 1.0 } else { n };
    n.copysign(x)
}

/// The greatest whole number not above `x`.
///
/// Source: round the magnitude to nearest, step back where that went up. Domain: all. Gives: exact, sign of zero kept.
/// Degenerate cases: infinities and NaN pass through.
#[inline(always)]
pub fn floor(x: f32) -> f32 {
    let n = nearest_magnitude(x.abs()).copysign(x);
    let down = n - 1.0;
    if n > x { down } else { n }
}

/// The least whole number not below `x`.
///
/// Source: round the magnitude to nearest, step on where that went down. Domain: all. Gives: exact, sign of zero kept.
/// Degenerate cases: infinities and NaN pass through.
#[inline(always)]
pub fn ceil(x: f32) -> f32 {
    let n = nearest_magnitude(x.abs()).copysign(x);
    let up = n + 1.0;
    // The sign is put back because -1 + 1 would give +0 where ceil(-0.5) is -0.
    if n < x { up.copysign(x) } else { n }
}

/// The nearest whole number, halves away from zero.
///
/// Source: C `roundf`. Domain: all. Gives: exact, sign of zero kept. Degenerate cases: infinities and NaN pass through.
#[inline(always)]
pub fn round(x: f32) -> f32 {
    let a = x.abs();
    let n = nearest_magnitude(a);
    // `a - n` is exact; ties to even went down on exactly the halves that have to go up.
    let n = if a - n >= 0.5 { n + 1.0 } else { n };
    n.copysign(x)
}

/// The whole part as an integer.
///
/// Domain: all. Gives: `x` towards zero. Degenerate cases: beyond the range of `i32` the nearest end of the range, NaN 0.
#[inline(always)]
pub fn trunc_to_int(x: f32) -> i32 {
    x as i32
}

/// The greatest integer not above `x`, as lattice noise needs it.
///
/// Domain: all. Gives: floor of `x`. Degenerate cases: beyond the range of `i32` the nearest end of the range, NaN 0.
#[inline(always)]
pub fn floor_to_int(x: f32) -> i32 {
    let n = x as i32;
    n.saturating_sub((x < n as f32) as i32)
}

/// The greatest whole number not above `x`, modulo 2^32, and the rest, in [0, 1].
///
/// Source: two roundings to nearest by adding 1.5 * 2^23, one for multiples of 2^16 and one for the remainder, whose sums hold
/// the integers in their low bits. Domain: |x| < 2^38; beyond it the integer means nothing. Gives: exact; the rest rounds to 1
/// just below a whole number. Degenerate cases: a rest of NaN at infinities and for NaN.
///
/// `as i32` would saturate, which takes more steps than all the others of a lattice noise's axis: three-dimensional Perlin
/// noise took 9.0 ns a lane with it and takes 6.8 so.
#[inline(always)]
pub fn floor_and_rest(x: f32) -> (u32, f32) {
    const ROUND: f32 = 12_582_912.0;
    const ROUND_BITS: u32 = ROUND.to_bits();
    let high = x * (1.0 / 65_536.0) + ROUND;
    let remainder = x - (high - ROUND) * 65_536.0;
    let low = remainder + ROUND;
    let rest = remainder - (low - ROUND);
    let below = rest < 0.0;
    let nearest = (high.to_bits() << 16).wrapping_add(low.to_bits());
    let nearest = nearest.wrapping_sub((ROUND_BITS << 16).wrapping_add(ROUND_BITS));
    (nearest.wrapping_sub(below as u32), rest + if below { 1.0 } else { 0.0 })
}
