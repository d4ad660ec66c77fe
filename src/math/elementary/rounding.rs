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
