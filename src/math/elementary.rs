//! Elementary functions on `f32`, written so that a loop over lanes turns into SIMD on every instruction set.
//!
//! The functions of the C library cannot be vectorised by the compiler and differ between platforms. These are plain
//! arithmetic: no calls, no branches, no fused multiply-add. So a lane loop becomes SIMD, and every width and every
//! instruction set gives the same bits. Where 24 bits do not suffice to stay within 2 ulp, the inside is `f64`.
//!
//! Time in ns a lane, in a loop over 1024 lanes compiled for AVX2, one core of an AMD EPYC (benches/elementary.rs), and the
//! greatest error found by the tests, in units in the last place:
//!
//! | function | ns | ulp | function | ns | ulp | function | ns | ulp |
//! |---|---|---|---|---|---|---|---|---|
//! TABLE

mod circular;
mod error_function;
mod exponential;
mod hyperbolic;
mod logarithm;
mod power;
mod rounding;
mod wide;

#[cfg(test)]
mod tests;

pub use circular::{acos, asin, atan, atan2, cos, sin, sincos, tan};
pub use error_function::{erf, erfc};
pub use exponential::{exp, exp2, expm1};
pub use hyperbolic::{cosh, sinh, tanh};
pub use logarithm::{ln, log2, log10, logb};
pub use power::{cbrt, pow, pow_positive, rsqrt};
pub use rounding::{ceil, floor, floor_to_int, round, trunc, trunc_to_int};
