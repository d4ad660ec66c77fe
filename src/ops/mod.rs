//! The one meaning of every builtin that is more than one arithmetic step, as plain functions on single lanes.
//!
//! Constant folding and execution call the same functions, so a folded program and a run one agree to the bit. Functions on
//! numbers have no branches where both sides are cheap, so that a loop over lanes turns into SIMD. None of them panics.
//!
//! | subject | module |
//! |---|---|
//! | division, rounding, roots and logarithms with OSL's limits, steps and mixes | [`arithmetic`] |
//! | derivatives of colour conversions | [`color_slope`] |
//! | luminance, black bodies, wavelengths, colour spaces | [`color`] |
//! | reflection, refraction, Fresnel's formula | [`fresnel`] |
//! | the `hash` overloads | [`hash`] |
//! | matrices and what they do to points, vectors and normals | [`matrix`] |
//! | `format` and its checks | [`mod@format`] |
//! | regular expressions | [`pattern`] |
//! | splines and their inverse | [`spline`] |
//! | strings | [`string`] |
//! | the primaries and the white of RGB | [`working_space`] |

pub mod arithmetic;
pub mod color;
pub mod color_slope;
pub mod decimal;
pub mod dictionary;
pub mod format;
pub mod fresnel;
pub mod hash;
mod matching;
pub mod matrix;
pub mod pattern;
pub mod spline;
pub mod string;
pub mod working_space;
