//! The ellipses that pixels cover, and the probes along their long axes: worked out for several places at once, in SIMD.

use super::sample::Lookup;
use crate::math::elementary::{exp, floor_and_rest};

/// How much longer than wide an ellipse may be. A longer one is made shorter by half of what is too much and wider as needed, as OpenImageIO
/// does it: wider alone blurs all that is seen at a grazing angle, shorter alone aliases.
const MOST_ASPECT: f32 = 32.0;

/// A half axis of so many texels of the finest level needs one probe, whatever the shape: where OpenImageIO changes over (found by
/// bisection of its 3.2).
const ONE_PROBE: f32 = 0.75;

/// Places that are worked out together.
pub(super) const PLACES: usize = 8;

/// A number a place.
pub(super) type Row = [f32; PLACES];

/// What is looked up for ellipses.
#[derive(Default)]
pub(super) struct Probes {
    /// How many.
    pub count: [u32; PLACES],
    /// From the middle to where the outermost end, in s and t.
    pub step: [Row; 2],
    /// The half axis across, in texels of the finest level.
    pub short: Row,
    /// What a pixel covers of the picture along s and along t.
    pub pixel: [Row; 2],
    /// Their weights.
    bells: [Row; 3],
}

impl Probes {
    /// Those of places with slopes ds/dx, dt/dx, ds/dy, dt/dy, of which those that are not finite count as none.
    #[inline(always)]
    pub fn of(slopes: &[Row; 4], size: [usize; 2], how: &Lookup) -> Self {
        let size = [size[0] as f32, size[1] as f32];
        let mut out = Probes::default();
        for i in 0..PLACES {
            let sound = |x: f32| if x.is_finite() { x } else { 0.0 };
            let slopes = [sound(slopes[0][i]), sound(slopes[1][i]), sound(slopes[2][i]), sound(slopes[3][i])];
            out.pixel[0][i] = slopes[0].abs().max(slopes[2].abs());
            out.pixel[1][i] = slopes[1].abs().max(slopes[3].abs());
            let Ellipse { major, lengths: [given, thin] } = Ellipse::of(slopes, size, how);
            let long = if given > MOST_ASPECT * thin { 0.5 * (given + MOST_ASPECT * thin) } else { given };
            let short = thin.max(long / MOST_ASPECT);
            let most = 2.0 * long / short - 1.0;
            // One where the ellipse is a point, which is no number of times longer than wide.
            let count = if (most >= 1.0) & (long > ONE_PROBE) { most.min(2.0 * MOST_ASPECT) } else { 1.0 };
            // The outermost probes end where the ellipse does.
            let reach = 1.0 - short / long;
            out.count[i] = floor_and_rest(count).0;
            let cut = long / given;
            (out.step[0][i], out.step[1][i]) = (major[0] * reach * cut, major[1] * reach * cut);
            out.short[i] = short;
            let bell = Bell::new(0.5 / reach, out.count[i] as f32);
            (out.bells[0][i], out.bells[1][i], out.bells[2][i]) = (bell.weight, bell.ratio, bell.change);
        }
        out
    }

    /// The weights at a place.
    #[inline(always)]
    pub fn bell(&self, i: usize) -> Bell {
        Bell { weight: self.bells[0][i], ratio: self.bells[1][i], change: self.bells[2][i] }
    }
}

/// The ellipse that a pixel covers.
struct Ellipse {
    /// The long half axis as a step of s and t.
    major: [f32; 2],
    /// Half axes in texels of the finest level.
    lengths: [f32; 2],
}

impl Ellipse {
    /// The half axes of the ellipse: the singular values of the matrix of slopes, in texels. Blur adds to them as it does to the axes of a
    /// box that it is seen along.
    #[inline(always)]
    fn of([dsdx, dtdx, dsdy, dtdy]: [f32; 4], size: [f32; 2], how: &Lookup) -> Self {
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
}

/// exp(-2 (x scale)^2) at the middles of so many equal parts of -1..1, each from the one before.
pub(super) struct Bell {
    weight: f32,
    ratio: f32,
    change: f32,
}

impl Bell {
    /// Before the first part.
    #[inline(always)]
    fn new(scale: f32, parts: f32) -> Self {
        let step = 2.0 * scale / parts;
        let first = 0.5 * step - scale;
        Bell {
            weight: exp(-2.0 * first * first),
            ratio: exp(-2.0 * step * (2.0 * first + step)),
            change: exp(-4.0 * step * step),
        }
    }

    /// The weight of the next part.
    #[inline(always)]
    pub fn next(&mut self) -> f32 {
        let now = self.weight;
        (self.weight, self.ratio) = (self.weight * self.ratio, self.ratio * self.change);
        now
    }
}
