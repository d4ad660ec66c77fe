//! Elementary functions on `f32`, written so that a loop over lanes turns into SIMD on every instruction set.
//!
//! The functions of the C library cannot be vectorised by the compiler and differ between platforms. These are plain
//! arithmetic: no calls, no branches, no fused multiply-add. So a lane loop becomes SIMD, and every width and every
//! instruction set gives the same bits. Where 24 bits do not suffice to stay within 2 ulp, the inside is `f64`.
//!
//! Time in ns a lane, in a loop over 1024 lanes compiled for AVX2, one core of an AMD EPYC (benches/elementary.rs), and the
//! greatest error found by the tests, in units in the last place:
//!
//! | function | ns | ulp | function | ns | ulp |
//! |---|---|---|---|---|---|
//! | exp | 0.65 | 1.01 | asin | 1.8 | 0.51 |
//! | exp2 | 0.54 | 1.13 | acos | 1.8 | 0.51 |
//! | expm1 | 1.6 | 0.5 | atan | 1.8 | 0.51 |
//! | ln | 0.88 | 0.79 | atan2 | 2.2 | 0.51 |
//! | log2 | 1.4 | 0.5 | sinh | 2.2 | 0.5 |
//! | log10 | 1.4 | 0.5 | cosh | 2.0 | 0.5 |
//! | logb | 0.16 | 0 | tanh | 2.4 | 0.5 |
//! | pow | 4.0 | 0.51 | cbrt | 2.0 | 0.5 |
//! | pow_positive | 2.9 | see there | erf | 3.5 | < 1 |
//! | sin | 1.1 | 1.47 | erfc | 3.7 | < 1 |
//! | cos | 1.0 | 1.49 | rsqrt | 0.37 | 1.28 |
//! | sincos | 1.2 | 1.49 | floor, ceil, trunc | 0.14 | 0 |
//! | tan | 2.0 | 0.51 | round | 0.17 | 0 |

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

#[cfg(test)]
mod lane_tests;

pub use circular::{acos, asin, atan, atan2, cos, sin, sincos, tan};
pub use error_function::{erf, erfc};
pub use exponential::{exp, exp2, expm1};
pub use hyperbolic::{cosh, sinh, tanh};
pub use logarithm::{ln, log2, log10, logb};
pub use power::{cbrt, pow, pow_positive, rsqrt};
pub use rounding::{ceil, floor, floor_and_rest, floor_to_int, round, trunc, trunc_to_int};
