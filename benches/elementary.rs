//! Time of the elementary functions and of noise, in a loop over lanes compiled for the SIMD of the machine.
//!
//! `cargo bench --bench elementary` prints the time of 1024 lanes; items per second are lanes.

use divan::{Bencher, black_box, counter::ItemsCount};
use velour::lanes;
use velour::math::elementary as e;
use velour::math::noise::{Endless, cell, perlin, simplex};

const LANES: usize = 1024;

fn main() {
    divan::main();
}

/// Defines a benchmark that applies an expression to lanes between two bounds.
macro_rules! timed {
    ($($name:ident: $low:expr, $high:expr, |$x:ident| $value:expr;)*) => {$(
        #[divan::bench]
        fn $name(bencher: Bencher) {
            lanes! {
                fn run(input: &[f32], output: &mut [f32]) {
                    for (o, i) in output.iter_mut().zip(input) {
                        let $x = *i;
                        *o = $value;
                    }
                }
            }
            let step = ($high - $low) / LANES as f32;
            let input: Vec<f32> = (0..LANES).map(|i| $low + step * i as f32).collect();
            let mut output = vec![0.0f32; LANES];
            bencher.counter(ItemsCount::new(LANES)).bench_local(|| {
                run(black_box(&input), black_box(&mut output));
            });
        }
    )*};
}

timed! {
    exp: -80.0, 80.0, |x| e::exp(x);
    exp2: -120.0, 120.0, |x| e::exp2(x);
    expm1: -80.0, 80.0, |x| e::expm1(x);
    ln: 0.0, 100.0, |x| e::ln(x);
    log2: 0.0, 100.0, |x| e::log2(x);
    log10: 0.0, 100.0, |x| e::log10(x);
    logb: 0.0, 100.0, |x| e::logb(x);
    pow: -1.0, 10.0, |x| e::pow(x, 2.2);
    pow_positive: 0.0, 10.0, |x| e::pow_positive(x, 2.2);
    sin: -100.0, 100.0, |x| e::sin(x);
    cos: -100.0, 100.0, |x| e::cos(x);
    sincos: -100.0, 100.0, |x| { let (s, c) = e::sincos(x); s + c };
    tan: -100.0, 100.0, |x| e::tan(x);
    asin: -1.0, 1.0, |x| e::asin(x);
    acos: -1.0, 1.0, |x| e::acos(x);
    atan: -9.0, 9.0, |x| e::atan(x);
    atan2: -9.0, 9.0, |x| e::atan2(x, 1.0 - x);
    sinh: -80.0, 80.0, |x| e::sinh(x);
    cosh: -80.0, 80.0, |x| e::cosh(x);
    tanh: -9.0, 9.0, |x| e::tanh(x);
    cbrt: -100.0, 100.0, |x| e::cbrt(x);
    erf: -4.0, 4.0, |x| e::erf(x);
    erfc: -4.0, 9.0, |x| e::erfc(x);
    rsqrt: 0.0, 100.0, |x| e::rsqrt(x);
    floor: -100.0, 100.0, |x| e::floor(x);
    round: -100.0, 100.0, |x| e::round(x);
    perlin1: -100.0, 100.0, |x| perlin::perlin1::<0>(Endless, x).value;
    perlin2: -100.0, 100.0, |x| perlin::perlin2::<0>(Endless, x, 1.7 * x).value;
    perlin3: -100.0, 100.0, |x| perlin::perlin3::<0>(Endless, x, 1.7 * x, 0.3 * x).value;
    perlin3_gradient: -100.0, 100.0, |x| {
        let jet = perlin::perlin3::<3>(Endless, x, 1.7 * x, 0.3 * x);
        jet.value + jet.gradient[0] + jet.gradient[1] + jet.gradient[2]
    };
    perlin3_vector: -100.0, 100.0, |x| {
        let [a, b, c] = perlin::perlin3_vector::<0>(Endless, x, 1.7 * x, 0.3 * x);
        a.value + b.value + c.value
    };
    perlin4: -100.0, 100.0, |x| perlin::perlin4::<0>(Endless, x, 1.7 * x, 0.3 * x, 0.9 * x).value;
    simplex3: -100.0, 100.0, |x| simplex::simplex3::<0>(0, x, 1.7 * x, 0.3 * x).value;
    cell3: -100.0, 100.0, |x| cell::cell3(x, 1.7 * x, 0.3 * x);
}
