//! Texture look-ups of shaders, against the same texels read and weighed by a loop written by hand.

use super::Table;
use super::hand::{N, group, points};
use std::hint::black_box;
use std::sync::Arc;
use velour::exec::{Host, Machine};
use velour::lanes;
use velour::texture::{Texels, Texture};

/// Columns and rows of the picture.
const SIDE: usize = 1024;

const BILINEAR: &str = r#"shader s(output color c = 0) {
    c = (color)texture("t", 0.97 * u, 0.97 * v, 0, 0, 0, 0, "interp", "linear", "wrap", "periodic"); }"#;

/// An ellipse of 9.22 by 2.04 texels, which takes eight probes in two levels.
const FILTERED: &str = r#"shader s(output color c = 0) {
    float a = 6 * u;
    float x = cos(a), y = sin(a);
    c = (color)texture("t", 0.97 * u, 0.97 * v, 0.009 * x, 0.009 * y, -0.00199 * y, 0.00199 * x,
        "interp", "linear", "wrap", "periodic"); }"#;

/// Texels of three bytes, row by row, of a level.
#[derive(Clone, Debug)]
struct Rows {
    side: usize,
    bytes: Vec<u8>,
}

/// A host of one texture.
#[derive(Debug)]
struct Picture(Arc<Texture>);

impl Host for Picture {
    fn texture(&self, _name: &str) -> Result<Arc<Texture>, String> {
        Ok(self.0.clone())
    }
}

/// Numbers without a pattern.
fn bytes(count: usize) -> Vec<u8> {
    (0..count as u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect()
}

impl Rows {
    fn of(level: &velour::texture::Level) -> Self {
        let side = level.width();
        let mut out = Rows { side, bytes: Vec::new() };
        for at in 0..side * side {
            let mut texel = [0.0; 4];
            level.read(at % side, at / side, 0, &mut texel);
            out.bytes.extend(texel[..3].iter().map(|x| (x * 255.0).round() as u8));
        }
        out
    }

    /// One bilinear value of a picture that comes again.
    #[inline(always)]
    fn bilinear(&self, s: f32, t: f32) -> [f32; 3] {
        let (x, y) = ((s - s.floor()) * self.side as f32 - 0.5, (t - t.floor()) * self.side as f32 - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (fx, fy) = (x - left, y - top);
        let mask = self.side - 1;
        let place = |x: i32, y: i32| ((y as usize & mask) * self.side + (x as usize & mask)) * 3;
        let (x, y) = (left as i32, top as i32);
        let [a, b] = [place(x, y), place(x + 1, y)].map(|at| &self.bytes[at..at + 3]);
        let [c, d] = [place(x, y + 1), place(x + 1, y + 1)].map(|at| &self.bytes[at..at + 3]);
        let mut out = [0.0; 3];
        for i in 0..3 {
            let [a, b, c, d] = [a[i], b[i], c[i], d[i]].map(f32::from);
            let (top, bottom) = (a + fx * (b - a), c + fx * (d - c));
            out[i] = (top + fy * (bottom - top)) * (1.0 / 255.0);
        }
        out
    }
}

lanes! {
    /// One look-up a lane.
    fn points_by_hand(rows: &Rows, u: &[f32], v: &[f32], out: &mut [[f32; 3]]) {
        for ((u, v), out) in u.iter().zip(v).zip(out) {
            *out = rows.bilinear(0.97 * u, 0.97 * v);
        }
    }
}

lanes! {
    /// Eight look-ups a lane in each of two levels, of known weights.
    fn probes_by_hand(levels: &[Rows; 2], bell: &[f32; 8], u: &[f32], v: &[f32], out: &mut [[f32; 3]]) {
        for ((u, v), out) in u.iter().zip(v).zip(out) {
            let (sin, cos) = (velour::math::elementary::sin(6.0 * u), velour::math::elementary::cos(6.0 * u));
            let mut sum = [0.0; 3];
            for (i, weight) in bell.iter().enumerate() {
                let x = 0.007 * ((2 * i + 1) as f32 / 8.0 - 1.0);
                let (s, t) = (0.97 * u + x * cos, 0.97 * v + x * sin);
                let (fine, coarse) = (levels[0].bilinear(s, t), levels[1].bilinear(s, t));
                (0..3).for_each(|c| sum[c] += weight * (fine[c] + 0.02 * (coarse[c] - fine[c])));
            }
            *out = sum;
        }
    }
}

/// Prints the rows.
pub fn rows(table: &Table) {
    let (bilinear, filtered) = ("texture, bilinear", "texture, 8 probes in 2 levels");
    table.head("texture look-ups of three bytes", "by hand");
    if !table.wants(bilinear) && !table.wants(filtered) {
        return;
    }
    let texture = Arc::new(Texture::of_rows(SIDE, SIDE, 3, &Texels::Bytes(bytes(SIDE * SIDE * 3))));
    let [rows, finer, coarser] = [0, 1, 2].map(|level| Rows::of(texture.level(level)));
    let (points, mut out) = (points(), vec![[0.0; 3]; N]);
    let mut machine = Machine::with_host(Arc::new(Picture(texture)));
    let (one, many) = (group(BILINEAR), group(FILTERED));
    points_by_hand(&rows, &points.u, &points.v, &mut out);
    machine.shade(&one, &points);
    for (lane, by_hand) in out.iter().enumerate() {
        let here = machine.output(&one, "c").map(|c| c.lane(lane));
        let near = matches!(&here, Some(velour::exec::Values::Floats(c)) if (c[0] - by_hand[0]).abs() < 1e-4);
        assert!(near, "another texture: {here:?} and {by_hand:?} in {lane}");
    }
    let (u, v) = (&points.u, &points.v);
    table.time(
        bilinear,
        (&mut || _ = black_box(machine.shade(&one, black_box(&points))), N),
        (&mut || points_by_hand(&rows, black_box(u), black_box(v), &mut out), N),
        "<= 2; <= 50 ns",
    );
    let (levels, bell) = ([finer, coarser], [0.02, 0.08, 0.16, 0.24, 0.24, 0.16, 0.08, 0.02]);
    table.time(
        filtered,
        (&mut || _ = black_box(machine.shade(&many, black_box(&points))), N),
        (&mut || probes_by_hand(&levels, &bell, black_box(u), black_box(v), &mut out), N),
        "<= 2; <= 250 ns",
    );
}
