//! Texels of one level joined to what lies between them. Where places lie among texels is found for several at once, in SIMD; texels
//! are then fetched a place at a time, four channels together.

use super::ellipse::{PLACES, Row};
use super::sample::{Interpolation, Lookup, Sample};
use super::texels::Level;
use super::wrap::Wrap;
use crate::math::elementary::{floor, floor_and_rest};
use glam::{BVec4A, Vec4};

/// A sample under way.
#[derive(Clone, Copy, Default)]
pub(super) struct Joined {
    value: Vec4,
    ds: Vec4,
    dt: Vec4,
}

impl Joined {
    /// Adds a part of the difference of two samples; of equal ones nothing, to the last bit. `G` says whether slopes are wanted.
    #[inline(always)]
    pub fn add<const G: bool>(&mut self, part: f32, from: &Joined, to: &Joined) {
        self.value += part * (to.value - from.value);
        if G {
            self.ds += part * (to.ds - from.ds);
            self.dt += part * (to.dt - from.dt);
        }
    }

    /// As it is handed out.
    #[inline(always)]
    pub fn sample(&self) -> Sample {
        Sample { value: self.value.to_array(), ds: self.ds.to_array(), dt: self.dt.to_array() }
    }
}

/// A level as a look-up sees it.
#[derive(Clone, Copy)]
pub(super) struct Plane<'a> {
    level: &'a Level,
    how: &'a Lookup,
    wrap: [Wrap; 2],
    cubic: bool,
    /// Bilinear.
    plain: bool,
    /// Channels from the first wanted one on.
    count: usize,
    /// Which of four there are.
    there: BVec4A,
    /// What the others are, in the numbers of the level.
    fill: Vec4,
    /// The number of the level that stands for 1.
    unit: f32,
}

/// Where places lie among the texels of a level.
#[derive(Default)]
pub(super) struct Corners {
    /// The upper left one of the four texels around.
    left: [i32; PLACES],
    top: [i32; PLACES],
    /// How far from it, in texels.
    fx: Row,
    fy: Row,
    /// Are all four in the level? Then these are their places.
    inside: [u32; PLACES],
    columns: [[u32; PLACES]; 2],
    rows: [[u32; PLACES]; 2],
}

impl<'a> Plane<'a> {
    /// A level, of these ways outside; `large` where its texels are the finest or magnified.
    #[inline(always)]
    pub fn new(level: &'a Level, large: bool, wrap: [Wrap; 2], how: &'a Lookup) -> Self {
        let cubic = match how.interpolation {
            Interpolation::Cubic => true,
            Interpolation::Smart => large,
            Interpolation::Closest | Interpolation::Linear => false,
        };
        let plain = !cubic && how.interpolation != Interpolation::Closest;
        let unit = level.unit();
        let count = level.channels().saturating_sub(how.first as usize);
        let there = BVec4A::new(count > 0, count > 1, count > 2, count > 3);
        Plane { level, how, wrap, cubic, plain, count, there, fill: Vec4::splat(how.fill * unit), unit }
    }

    /// Where places lie that have been [`folded`].
    #[inline(always)]
    pub fn corners(&self, s: &Row, t: &Row) -> Corners {
        let half = if self.how.interpolation == Interpolation::Closest { 0.0 } else { 0.5 };
        let (left, fx) = along(s, self.level.width() as f32, half);
        let (top, fy) = along(t, self.level.height() as f32, half);
        let mut out = Corners { left, top, fx, fy, ..Corners::default() };
        let near = self.level.near(self.how.first);
        for i in 0..PLACES {
            let (x, y) = (left[i] as u32, top[i] as u32);
            // Numbers below 0 are large ones.
            out.inside[i] = u32::from((x < near.columns) & (y < near.rows));
            for k in 0..2 {
                out.columns[k][i] = near.column(x.wrapping_add(k as u32));
                out.rows[k][i] = near.row(y.wrapping_add(k as u32));
            }
        }
        out
    }

    /// The sample at a place.
    #[inline(always)]
    pub fn join<const G: bool>(&self, corners: &Corners, i: usize) -> Joined {
        let (fx, fy) = (corners.fx[i], corners.fy[i]);
        let corner = [corners.left[i], corners.top[i]];
        let [mut value, mut ds, mut dt];
        if self.plain && corners.inside[i] != 0 {
            let columns = [corners.columns[0][i], corners.columns[1][i]];
            let texels = self.level.near_fours([corners.rows[0][i], corners.rows[1][i]], columns);
            [value, ds, dt] = joined_linear::<G>(texels, fx, fy);
            value = Vec4::select(self.there, value, self.fill);
            if G {
                ds = Vec4::select(self.there, ds, Vec4::ZERO);
                dt = Vec4::select(self.there, dt, Vec4::ZERO);
            }
        } else {
            [value, ds, dt] = self.joined_otherwise(corner, [fx, fy]);
        }
        value /= self.unit;
        if G {
            ds *= self.level.width() as f32 / self.unit;
            dt *= self.level.height() as f32 / self.unit;
        }
        Joined { value, ds, dt }
    }

    /// What is not between four texels of the level, in its numbers: a call's worth.
    #[inline(never)]
    fn joined_otherwise(&self, corner: [i32; 2], [fx, fy]: [f32; 2]) -> [Vec4; 3] {
        if self.how.interpolation == Interpolation::Closest {
            let [[texel]] = self.texels(corner);
            return [texel, Vec4::ZERO, Vec4::ZERO];
        }
        if self.cubic {
            joined_cubic(self, corner, [fx, fy])
        } else {
            joined_linear::<true>(self.texels(corner), fx, fy)
        }
    }

    /// Rows of texels from a corner on, in the numbers of the level.
    #[inline(always)]
    fn texels<const N: usize>(&self, [left, top]: [i32; 2]) -> [[Vec4; N]; N] {
        let (width, height) = (self.level.width(), self.level.height());
        let range = |from: i32, size: usize| from >= 0 && from as usize + N <= size;
        if range(left, width) && range(top, height) && self.count > 0 {
            let (mut columns, mut rows) = ([0; N], [0; N]);
            for i in 0..N {
                columns[i] = self.level.column(left as usize + i) + self.how.first as usize;
                rows[i] = self.level.row(top as usize + i);
            }
            let mut out = self.level.fours(rows, columns);
            if self.count < 4 {
                for texel in out.as_flattened_mut() {
                    *texel = Vec4::select(self.there, *texel, self.fill);
                }
            }
            return out;
        }
        let mut out = [[Vec4::ZERO; N]; N];
        for (y, out) in out.iter_mut().enumerate() {
            let row = self.wrap[1].texel(top.saturating_add(y as i32), height);
            for (x, out) in out.iter_mut().enumerate() {
                let column = self.wrap[0].texel(left.saturating_add(x as i32), width);
                *out = self.texel(row, column);
            }
        }
        out
    }

    /// A texel of a column and row that there may be.
    #[inline(always)]
    fn texel(&self, row: Option<usize>, column: Option<usize>) -> Vec4 {
        match (row, column) {
            (Some(_), Some(_)) if self.count == 0 => self.fill,
            (Some(row), Some(column)) => {
                let column = self.level.column(column) + self.how.first as usize;
                let [[texel]] = self.level.fours([self.level.row(row)], [column]);
                Vec4::select(self.there, texel, self.fill)
            }
            _ => Vec4::ZERO,
        }
    }
}

/// Places along s or t, brought to where all but the last texels lie within the picture.
#[inline(always)]
pub(super) fn folded(mut places: Row, wrap: Wrap) -> Row {
    if wrap == Wrap::Periodic {
        for x in &mut places {
            *x -= floor(*x);
        }
    }
    places
}

/// The texel before each place along an axis, and the rest.
#[inline(always)]
fn along(places: &Row, size: f32, half: f32) -> ([i32; PLACES], Row) {
    let (mut texels, mut rests) = ([0; PLACES], [0.0; PLACES]);
    for i in 0..PLACES {
        // Beyond this a float has no fraction, and a texel no number.
        let x = (places[i] * size).clamp(-1e9, 1e9) - half;
        let (before, rest) = floor_and_rest(x);
        (texels[i], rests[i]) = (before as i32, rest);
    }
    (texels, rests)
}

/// The value between four texels and its slopes a texel.
#[inline(always)]
fn joined_linear<const G: bool>([[a, b], [c, d]]: [[Vec4; 2]; 2], fx: f32, fy: f32) -> [Vec4; 3] {
    let (top, bottom) = (a + fx * (b - a), c + fx * (d - c));
    let value = top + fy * (bottom - top);
    if !G {
        return [value, Vec4::ZERO, Vec4::ZERO];
    }
    [value, (b - a) + fy * ((d - c) - (b - a)), bottom - top]
}

/// The weights of a uniform cubic B-spline and their slopes.
#[inline(always)]
fn spline(f: f32) -> [[f32; 4]; 2] {
    let g = 1.0 - f;
    let (f2, g2) = (f * f, g * g);
    let weights = [g2 * g / 6.0, 2.0 / 3.0 - f2 * (1.0 - 0.5 * f), 2.0 / 3.0 - g2 * (1.0 - 0.5 * g), f2 * f / 6.0];
    let slopes = [-0.5 * g2, f * (1.5 * f - 2.0), g * (2.0 - 1.5 * g), 0.5 * f2];
    [weights, slopes]
}

fn joined_cubic(of: &Plane, [left, top]: [i32; 2], [fx, fy]: [f32; 2]) -> [Vec4; 3] {
    let ([wx, sx], [wy, sy]) = (spline(fx), spline(fy));
    let texels: [[Vec4; 4]; 4] = of.texels([left - 1, top - 1]);
    // Sums of differences from one texel, so that a constant stays one to the last bit.
    let base = texels[1][1];
    let [mut value, mut ds, mut dt] = [base, Vec4::ZERO, Vec4::ZERO];
    for (row, texels) in texels.iter().enumerate() {
        let (mut along, mut change) = (Vec4::ZERO, Vec4::ZERO);
        for (column, texel) in texels.iter().enumerate() {
            along += wx[column] * (*texel - base);
            change += sx[column] * (*texel - base);
        }
        value += wy[row] * along;
        ds += wy[row] * change;
        dt += sy[row] * along;
    }
    [value, ds, dt]
}
