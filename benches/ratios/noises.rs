//! Every kind of noise as a shader of one call, against the function alone in a loop over lanes.

use super::Table;
use super::hand::{Batch, Columns, N, columns, cut};
use std::hint::black_box;
use velour::lanes;
use velour::math::columns::Column3;
use velour::math::noise::{Endless, Periodic, cell, perlin, simplex};

/// Defines a loop over lanes for each noise, in blocks of a fixed length, without which it would not become SIMD.
macro_rules! loops {
    ($($name:ident |$x:ident, $y:ident, $z:ident| $value:expr;)*) => {$(
        lanes! {
            fn $name(p: Columns<'_>, out: &mut [f32]) {
                let p = cut(p, N);
                for block in 0..N / 16 {
                    let mut values = [0.0; 16];
                    for i in 0..16 {
                        let ($x, $y, $z) = (8.0 * p[0][16 * block + i], 8.0 * p[1][16 * block + i], 8.0 * p[2][16 * block + i]);
                        let _ = ($y, $z);
                        values[i] = $value;
                    }
                    out[16 * block..16 * block + 16].copy_from_slice(&values);
                }
            }
        }
    )*};
}

loops! {
    perlin1 |x, y, z| perlin::perlin1::<0>(Endless, x).value;
    perlin2 |x, y, z| perlin::perlin2::<0>(Endless, x, y).value;
    perlin3 |x, y, z| perlin::perlin3::<0>(Endless, x, y, z).value;
    perlin4 |x, y, z| perlin::perlin4::<0>(Endless, x, y, z, 8.0 * x).value;
    periodic3 |x, y, z| perlin::perlin3::<0>(Periodic::new([4.0, 4.0, 4.0]), x, y, z).value;
    vector3 |x, y, z| { let [a, b, c] = perlin::perlin3_vector::<0>(Endless, x, y, z); a.value + b.value + c.value };
    simplex3 |x, y, z| simplex::simplex3::<0>(0, x, y, z).value;
    cell3 |x, y, z| cell::cell3(x, y, z);
    hash3 |x, y, z| cell::hash3_noise(x, y, z);
}

type Loop = fn(Columns<'_>, &mut [f32]);

/// Prints the rows.
pub fn rows(table: &Table) {
    let cases: [(&str, &str, Loop, &str); 9] = [
        ("perlin, 1 coordinate", "noise(\"perlin\", P[0] * 8)", perlin1, ""),
        ("perlin, 2 coordinates", "noise(\"perlin\", P[0] * 8, P[1] * 8)", perlin2, ""),
        ("perlin, 3 coordinates", "noise(\"perlin\", P * 8)", perlin3, "<= 9 ns (a tenth of OSL)"),
        ("perlin, 4 coordinates", "noise(\"perlin\", P * 8, P[0] * 64)", perlin4, ""),
        ("perlin, periodic", "pnoise(\"perlin\", P * 8, point(4))", periodic3, ""),
        ("perlin, a vector", "vector w = noise(\"perlin\", P * 8); result = w[0] + w[1] + w[2]", vector3, ""),
        ("simplex, 3 coordinates", "noise(\"simplex\", P * 8)", simplex3, ""),
        ("cell, 3 coordinates", "noise(\"cell\", P * 8)", cell3, ""),
        ("hash, 3 coordinates", "noise(\"hash\", P * 8)", hash3, ""),
    ];
    table.head("noise, with 3 multiplications", "in a loop");
    for (name, call, alone, bar) in cases {
        let body = if call.contains('=') { call.to_owned() } else { format!("result = {call}") };
        let text = format!("shader s(output float result = 0) {{ {body}; }}");
        let mut batch = Batch::new(&text);
        let (p, mut out): (Column3, Vec<f32>) = (batch.points.p.clone(), vec![0.0; N]);
        table.time(
            &format!("noise {name}"),
            (&mut || batch.shade(), N),
            (&mut || alone(columns(&p), black_box(&mut out)), N),
            bar,
        );
    }
}
