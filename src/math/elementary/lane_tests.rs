//! Every instruction set gives the same bits: loops compiled for wide SIMD against single calls.

use super::*;
use crate::lanes;
use crate::math::instruction_set::InstructionSet;
use crate::math::noise::{Endless, Periodic, perlin, simplex};

/// Numbers of all sizes and both signs, and the special ones.
fn inputs() -> Vec<f32> {
    let spread = (0..=u32::MAX).step_by(104_729).map(f32::from_bits);
    spread.chain((-2000..2000).map(|i| i as f32 * 0.0371)).collect()
}

macro_rules! same_bits {
    ($($name:ident: |$x:ident| $value:expr;)*) => {$(
        #[test]
        fn $name() {
            lanes! {
                fn wide(input: &[f32], output: &mut [f32]) {
                    for (o, i) in output.iter_mut().zip(input) {
                        let $x = *i;
                        *o = $value;
                    }
                }
            }
            let input = inputs();
            for set in InstructionSet::ALL {
                let set = InstructionSet::most(set);
                let mut output = vec![0.0; input.len()];
                wide(&input, &mut output);
                for (got, &$x) in output.into_iter().zip(&input) {
                    let want: f32 = std::hint::black_box($value);
                    let same = got.to_bits() == want.to_bits() || (got.is_nan() && want.is_nan());
                    assert!(same, "{set:?} at {}: {got} but {want}", $x);
                }
            }
        }
    )*};
}

same_bits! {
    exponentials: |x| exp(x) + exp2(x) + expm1(x);
    logarithms: |x| ln(x) + log2(x) + log10(x) + logb(x);
    powers: |x| pow(x, 2.2) + pow(x, -3.0) + pow_positive(x.abs(), 0.7) + cbrt(x) + rsqrt(x.abs());
    circular: |x| sin(x) + cos(x) + tan(x);
    arcs: |x| asin(x) + acos(x) + atan(x) + atan2(x, 2.0 - x);
    arc_tangents: |x| atan(x) + atan2(x, 2.0 - x);
    hyperbolic: |x| tanh(x) + sinh(x) + cosh(x);
    error_functions: |x| erf(x) + erfc(x);
    roundings: |x| floor(x) + ceil(x) + trunc(x) + round(x);
    perlin_noise: |x| perlin::perlin3::<3>(Endless, x, 1.7 * x, 0.3 * x).gradient[1];
    periodic_noise: |x| perlin::perlin2::<0>(Periodic::new([7.0, 3.0]), x, 1.7 * x).value;
    simplex_noise: |x| simplex::simplex4::<4>(0, x, 1.7 * x, 0.3 * x, 0.9 * x).gradient[3];
}
