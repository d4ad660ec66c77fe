//! Looking a texture up: the ellipse that a pixel covers, probes along its long axis, and two levels of the pyramid.
//!
//! Decision (2026-11-29): probes with the weights of a Gaussian along the long axis (McCormack, Perry, Farkas and Jouppi 1999,
//! and as OpenImageIO has them), each of them bilinear in two levels that follow the short axis, and bicubic in the finest,
//! because against a Gaussian over the ellipse summed in f64 the error of oblique stripes is a small part of that of one
//! trilinear probe, which blurs by the long axis, and a look-up that is not oblique costs one probe; instead of summing every
//! texel of the ellipse (Heckbert 1989), whose cost grows with the ellipse.
//!
//! Decision (2026-11-29): where levels are read whose texels are wider than two pixels, as `blur` and `width` ask for, those are joined
//! bicubically as the finest one is, because bilinear texels that large show as a plaid; as OpenImageIO's "smartcubic" has it, of whose
//! pictures ours then differ by .3/255 on average instead of 6.8/255 (a grid of 1024 texels under a width of 3 to 10 pixels).

use super::pyramid::Texture;
use super::texels::Level;
use super::wrap::Wrap;
use crate::lanes;
use crate::math::elementary::{exp, floor};
use glam::{BVec4A, Vec4};

/// How much longer than wide an ellipse may be. A longer one is made shorter by half of what is too much and wider as needed, as OpenImageIO
/// does it: wider alone blurs all that is seen at a grazing angle, shorter alone aliases.
const MOST_ASPECT: f32 = 32.0;

/// A half axis of so many texels of the finest level needs one probe, whatever the shape: where OpenImageIO changes over (found by
/// bisection of its 3.2).
const ONE_PROBE: f32 = 0.75;

/// How texels are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The nearest one.
    Closest,
    /// Bilinear.
    Linear,
    /// Bicubic, by uniform B-splines.
    Cubic,
    /// Bicubic in the finest level and in those that are magnified, else bilinear.
    #[default]
    Smart,
}

impl Interpolation {
    /// The one of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "closest" => Interpolation::Closest,
            "linear" | "bilinear" => Interpolation::Linear,
            "cubic" | "bicubic" => Interpolation::Cubic,
            "smartcubic" | "smartbicubic" => Interpolation::Smart,
            _ => return None,
        })
    }
}

/// How a texture is looked up.
#[derive(Clone, Copy, Debug)]
pub struct Lookup {
    /// What it is outside, along s and t; the file's own where that is nothing.
    pub wrap: [Option<Wrap>; 2],
    /// How texels are joined.
    pub interpolation: Interpolation,
    /// Factors of the ellipse along s and t.
    pub width: [f32; 2],
    /// What is added to the ellipse, in units of s and t.
    pub blur: [f32; 2],
    /// The first channel that is wanted.
    pub first: u32,
    /// What channels are that there are not.
    pub fill: f32,
}

impl Default for Lookup {
    fn default() -> Self {
        let interpolation = Interpolation::default();
        Lookup { wrap: [None; 2], interpolation, width: [1.0; 2], blur: [0.0; 2], first: 0, fill: 0.0 }
    }
}

/// Four channels and how they change along s and t.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// The channels.
    pub value: [f32; 4],
    /// Their change a unit of s.
    pub ds: [f32; 4],
    /// Their change a unit of t.
    pub dt: [f32; 4],
}

impl Sample {
    /// Adds a part of the difference of two samples; of equal ones nothing, to the last bit. `G` says whether slopes are wanted.
    #[inline(always)]
    fn add<const G: bool>(&mut self, part: f32, from: &Sample, to: &Sample) {
        for c in 0..4 {
            self.value[c] += part * (to.value[c] - from.value[c]);
        }
        if !G {
            return;
        }
        for c in 0..4 {
            self.ds[c] += part * (to.ds[c] - from.ds[c]);
            self.dt[c] += part * (to.dt[c] - from.dt[c]);
        }
    }
}

/// Which levels a look-up reads.
#[derive(Clone, Copy)]
struct Levels {
    /// The coarser of the two.
    coarse: usize,
    /// Its part.
    part: f32,
    /// From this level on texels are wider than two pixels.
    magnified: usize,
}

impl Levels {
    /// The finest alone.
    const FINEST: Levels = Levels { coarse: 0, part: 1.0, magnified: usize::MAX };
}

/// The ellipse that a pixel covers.
struct Ellipse {
    /// The long half axis as a step of s and t.
    major: [f32; 2],
    /// Half axes in texels of the finest level.
    lengths: [f32; 2],
}

lanes! {
    /// [`Texture::value`] of all lanes that are lit: columns of s, t and their slopes, each of all lanes or of one number for all; a column
    /// a channel.
    pub fn values(texture: &Texture, places: &[&[f32]; 6], how: &Lookup, lit: &[i32], out: &mut [Vec<f32>]) {
        for (lane, lit) in lit.iter().enumerate() {
            if *lit == 0 {
                continue;
            }
            let at = |k: usize| if places[k].len() == 1 { places[k][0] } else { places[k][lane] };
            let value = texture.look_up::<false>(at(0), at(1), [at(2), at(3), at(4), at(5)], how).value;
            for (out, value) in out.iter_mut().zip(value) {
                out[lane] = value;
            }
        }
    }
}

impl Texture {
    /// Looks up at (s, t), with t = 0 at the top; `slopes` are ds/dx, dt/dx, ds/dy, dt/dy of a pixel. Coordinates that are not finite give the
    /// fill.
    pub fn lookup(&self, s: f32, t: f32, slopes: [f32; 4], how: &Lookup) -> Sample {
        self.look_up::<true>(s, t, slopes, how)
    }

    /// The same without the changes along s and t, which are then zero.
    pub fn value(&self, s: f32, t: f32, slopes: [f32; 4], how: &Lookup) -> [f32; 4] {
        self.look_up::<false>(s, t, slopes, how).value
    }

    #[inline(always)]
    fn look_up<const G: bool>(&self, s: f32, t: f32, slopes: [f32; 4], how: &Lookup) -> Sample {
        let sound = |x: f32| if x.is_finite() { x } else { 0.0 };
        if !s.is_finite() || !t.is_finite() {
            return Sample { value: [how.fill; 4], ..Sample::default() };
        }
        if slopes == [0.0; 4] && how.blur == [0.0; 2] {
            return self.at_level::<G>(s, t, Levels::FINEST, how);
        }
        let [a, b, c, d] = slopes;
        let ellipse = self.ellipse([sound(a), sound(b), sound(c), sound(d)], how);
        let [given, thin] = ellipse.lengths;
        let long = if given > MOST_ASPECT * thin { 0.5 * (given + MOST_ASPECT * thin) } else { given };
        let short = thin.max(long / MOST_ASPECT);
        let probes = (2.0 * long / short - 1.0).clamp(1.0, 2.0 * MOST_ASPECT) as u32;
        let mut levels = self.level_of(short);
        if levels.coarse > 0 {
            levels.magnified = self.magnified(levels.coarse, slopes);
        }
        if probes <= 1 || long <= ONE_PROBE {
            return self.at_level::<G>(s, t, levels, how);
        }
        // The outermost probes end where the ellipse does.
        let reach = 1.0 - short / long;
        let step = ellipse.major.map(|axis| axis * reach * (long / given));
        let mut bell = Bell::new(0.5 / reach, probes);
        let (mut first, mut sum, mut total) = (Sample::default(), Sample::default(), 0.0);
        for i in 0..probes {
            let x = (2.0 * i as f32 + 1.0) / probes as f32 - 1.0;
            let probe = self.at_level::<G>(s + x * step[0], t + x * step[1], levels, how);
            // Sums of differences from one probe, so that a constant stays one to the last bit.
            first = if i == 0 { probe } else { first };
            let weight = bell.next();
            sum.add::<G>(weight, &first, &probe);
            total += weight;
        }
        let mut out = first;
        out.add::<G>(1.0 / total, &Sample::default(), &sum);
        out
    }

    /// The coarser of the two levels between whose texels a half axis lies, and its part: all of it where the half axis is a texel of it.
    #[inline(always)]
    fn level_of(&self, half_axis: f32) -> Levels {
        let last = self.level_count() - 1;
        let mut texels = half_axis;
        for coarse in 0..=last {
            if texels <= 1.0 {
                let part = (2.0 * texels - 1.0).clamp(0.0, 1.0);
                return if coarse == 0 { Levels::FINEST } else { Levels { coarse, part, ..Levels::FINEST } };
            }
            texels *= 0.5;
        }
        Levels { coarse: last, ..Levels::FINEST }
    }

    /// The first of a level and the one before it whose texels are wider than two pixels, along s or t.
    #[inline(always)]
    fn magnified(&self, coarse: usize, [dsdx, dtdx, dsdy, dtdy]: [f32; 4]) -> usize {
        // Pixels that the picture has room for; those that cover nothing are as many as you like.
        let s = (1.0 / dsdx.abs().max(dsdy.abs()).max(1e-8)) as usize / 2;
        let t = (1.0 / dtdx.abs().max(dtdy.abs()).max(1e-8)) as usize / 2;
        let [width, height] = self.size();
        let (fine, own) = (coarse - 1, coarse);
        if (width >> fine).max(1) < s || (height >> fine).max(1) < t {
            fine
        } else if (width >> own).max(1) < s || (height >> own).max(1) < t {
            own
        } else {
            usize::MAX
        }
    }

    /// The half axes of the ellipse: the singular values of the matrix of slopes, in texels. Blur adds to them as it does to the axes of a
    /// box that it is seen along.
    #[inline(always)]
    fn ellipse(&self, slopes: [f32; 4], how: &Lookup) -> Ellipse {
        let size = self.size().map(|side| side as f32);
        let [dsdx, dtdx, dsdy, dtdy] = slopes;
        let (ws, wt) = (how.width[0] * size[0], how.width[1] * size[1]);
        let (a, b, c, d) = (dsdx * ws, dtdx * wt, dsdy * ws, dtdy * wt);
        let (p, q, r) = (a * a + c * c, a * b + c * d, b * b + d * d);
        let (mean, half) = (0.5 * (p + r), 0.5 * (p - r));
        let root = (half * half + q * q).sqrt();
        // Along the axes no digit may be lost: the number of probes is cut to a whole one.
        let (large, small) = if q == 0.0 { (p.max(r), p.min(r)) } else { (mean + root, (mean - root).max(0.0)) };
        // The eigenvector of the larger value, from whichever row is the longer.
        let axis = if half >= 0.0 { [half + root, q] } else { [q, root - half] };
        let length = (axis[0] * axis[0] + axis[1] * axis[1]).sqrt();
        let mut unit = if length > 0.0 { [axis[0] / length, axis[1] / length] } else { [1.0, 0.0] };
        let blur = [how.blur[0] * size[0], how.blur[1] * size[1]];
        let (x, y) = (unit[0].abs(), unit[1].abs());
        let mut long = large.sqrt() + blur[0] * x + blur[1] * y;
        let mut short = small.sqrt() + blur[0] * y + blur[1] * x;
        if short > long {
            (long, short, unit) = (short, long, [-unit[1], unit[0]]);
        }
        Ellipse { major: [unit[0] * long / size[0], unit[1] * long / size[1]], lengths: [long, short] }
    }

    /// One probe between a level and the one before it.
    #[inline(always)]
    fn at_level<const G: bool>(&self, s: f32, t: f32, levels: Levels, how: &Lookup) -> Sample {
        // Then all but the last texels lie within the picture.
        let folded = |x: f32, axis: usize| if self.wrap_of(axis, how) == Wrap::Periodic { x - floor(x) } else { x };
        let (s, t) = (folded(s, 0), folded(t, 1));
        // No closures: they would not be compiled for the instruction set of their caller.
        let Levels { coarse, part, magnified } = levels;
        if part >= 1.0 || coarse == 0 {
            return self.in_level::<G>(coarse, s, t, magnified, how);
        }
        let fine = self.in_level::<G>(coarse - 1, s, t, magnified, how);
        let coarse = self.in_level::<G>(coarse, s, t, magnified, how);
        let mut out = fine;
        out.add::<G>(part, &fine, &coarse);
        out
    }

    /// One level, bicubic in the finest one and where it is magnified, if that is wanted.
    #[inline(always)]
    fn in_level<const G: bool>(&self, number: usize, s: f32, t: f32, magnified: usize, how: &Lookup) -> Sample {
        let cubic = match how.interpolation {
            Interpolation::Cubic => true,
            Interpolation::Smart => number == 0 || number >= magnified,
            Interpolation::Closest | Interpolation::Linear => false,
        };
        self.join::<G>(self.level(number), s, t, cubic, how)
    }

    #[inline(always)]
    fn join<const G: bool>(&self, level: &Level, s: f32, t: f32, cubic: bool, how: &Lookup) -> Sample {
        let (width, height) = (level.width() as f32, level.height() as f32);
        // Beyond this a float has no fraction, and a texel no number.
        let inside = |x: f32| x.clamp(-1e9, 1e9);
        let (x, y) = (inside(s * width), inside(t * height));
        if how.interpolation == Interpolation::Closest {
            let [[texel]] = self.texels(level, [floor(x) as i32, floor(y) as i32], how);
            return Sample { value: (texel / level.unit()).to_array(), ..Sample::default() };
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (floor(x), floor(y));
        let (fx, fy) = (x - left, y - top);
        let (left, top) = (left as i32, top as i32);
        let [value, ds, dt] = match cubic {
            true => joined_cubic(self, level, [left - 1, top - 1], [fx, fy], how),
            false => joined_linear::<G>(self.texels(level, [left, top], how), fx, fy),
        };
        let unit = level.unit();
        let slopes = |slope: Vec4, texels: f32| if G { (slope * (texels / unit)).to_array() } else { [0.0; 4] };
        Sample { value: (value / unit).to_array(), ds: slopes(ds, width), dt: slopes(dt, height) }
    }

    #[inline(always)]
    fn wrap_of(&self, axis: usize, how: &Lookup) -> Wrap {
        how.wrap[axis].unwrap_or(self.wrap()[axis])
    }

    /// Rows of texels from a corner on, in the numbers of the level.
    #[inline(always)]
    fn texels<const N: usize>(&self, level: &Level, [left, top]: [i32; 2], how: &Lookup) -> [[Vec4; N]; N] {
        let (width, height, first) = (level.width(), level.height(), how.first as usize);
        let count = level.channels().saturating_sub(first);
        let (there, fill) = (known(count), Vec4::splat(how.fill * level.unit()));
        let range = |from: i32, size: usize| from >= 0 && from as usize + N <= size;
        if range(left, width) && range(top, height) && count > 0 {
            let (mut columns, mut rows) = ([0; N], [0; N]);
            for i in 0..N {
                columns[i] = level.column(left as usize + i) + first;
                rows[i] = level.row(top as usize + i);
            }
            let mut out = level.fours(rows, columns);
            if count < 4 {
                for texel in out.as_flattened_mut() {
                    *texel = Vec4::select(there, *texel, fill);
                }
            }
            return out;
        }
        let column = |i: usize| self.wrap_of(0, how).texel(left.saturating_add(i as i32), width);
        let row = |i: usize| self.wrap_of(1, how).texel(top.saturating_add(i as i32), height);
        let texel = |row: Option<usize>, column: Option<usize>| match (row, column) {
            (Some(_), Some(_)) if count == 0 => fill,
            (Some(row), Some(column)) => {
                let [[texel]] = level.fours([level.row(row)], [level.column(column) + first]);
                Vec4::select(there, texel, fill)
            }
            _ => Vec4::ZERO,
        };
        let mut out = [[Vec4::ZERO; N]; N];
        for (y, out) in out.iter_mut().enumerate() {
            for (x, out) in out.iter_mut().enumerate() {
                *out = texel(row(y), column(x));
            }
        }
        out
    }
}

/// Which of four channels there are.
#[inline(always)]
fn known(count: usize) -> BVec4A {
    BVec4A::new(count > 0, count > 1, count > 2, count > 3)
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

/// exp(-2 (x scale)^2) at the middles of so many equal parts of -1..1, each from the one before.
struct Bell {
    weight: f32,
    ratio: f32,
    change: f32,
}

impl Bell {
    #[inline(always)]
    fn new(scale: f32, parts: u32) -> Self {
        let step = 2.0 * scale / parts as f32;
        let first = 0.5 * step - scale;
        Bell {
            weight: exp(-2.0 * first * first),
            ratio: exp(-2.0 * step * (2.0 * first + step)),
            change: exp(-4.0 * step * step),
        }
    }

    #[inline(always)]
    fn next(&mut self) -> f32 {
        let now = self.weight;
        (self.weight, self.ratio) = (self.weight * self.ratio, self.ratio * self.change);
        now
    }
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

// Four by four texels are a call's worth.
#[inline(never)]
fn joined_cubic(of: &Texture, level: &Level, corner: [i32; 2], [fx, fy]: [f32; 2], how: &Lookup) -> [Vec4; 3] {
    let ([wx, sx], [wy, sy]) = (spline(fx), spline(fy));
    let texels: [[Vec4; 4]; 4] = of.texels(level, corner, how);
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
