//! What leaves a rough boundary that reflects and transmits, as sums over the facets that a viewer sees.

use crate::bsdf::fresnel::{dielectric, refracted};
use crate::bsdf::microfacet::distribution::{Distribution, Widths};
use crate::bsdf::microfacet::geometry::Geometry;
use crate::bsdf::microfacet::ggx::{Ggx, visible_normal};
use crate::bsdf::select;
use crate::lanes;
use crate::math::warp::turn;
use glam::Vec3;

/// Exponents of Schlick's term whose sums are known; the last one stands for all that are larger.
pub const EXPONENTS: [f32; 6] = [1.0, 2.5, 5.0, 10.0, 30.0, f32::INFINITY];

/// How many sums there are: of a mirror, of a dielectric, of a boundary that reflects nothing, and of the rise of Schlick's term
/// with each exponent, times what a facet that reflects sends out more than one that transmits.
pub const SUMS: usize = 3 + EXPONENTS.len();

/// Facets side by side.
const BLOCK: usize = 16;

/// A number of each.
type Row = [f32; BLOCK];

/// Facets that are averaged, by the numbers that choose them.
#[derive(Debug, Default)]
pub struct Places {
    first: Vec<f32>,
    cos: Vec<f32>,
    sin: Vec<f32>,
    /// 1, and 0 for those that fill the last block.
    counts: Vec<f32>,
    len: usize,
}

impl Places {
    /// The facets of pairs of numbers in [0, 1).
    pub fn new(numbers: impl Iterator<Item = [f32; 2]>) -> Self {
        let mut places = Places::default();
        for [first, second] in numbers {
            places.push(first, second, 1.0);
        }
        places.len = places.first.len();
        while !places.first.len().is_multiple_of(BLOCK) {
            places.push(0.5, 0.5, 0.0);
        }
        places
    }

    fn push(&mut self, first: f32, second: f32, counts: f32) {
        let (cos, sin) = turn(second);
        self.first.push(first);
        self.cos.push(cos);
        self.sin.push(sin);
        self.counts.push(counts);
    }
}

/// A boundary and who looks at it.
#[derive(Clone, Copy, Debug)]
pub struct Looked {
    /// How its facets shadow each other.
    pub geometry: Geometry,
    /// The width of its facets.
    pub alpha: f32,
    /// The viewer's cosine.
    pub cos: f32,
    /// Transmitted over incident index.
    pub eta: f32,
}

/// The means over `places` of what leaves, in the order of [`SUMS`].
pub fn leaving<D: Distribution>(looked: Looked, places: &Places) -> [f64; SUMS] {
    let mut sums = [[0.0; BLOCK]; SUMS];
    add::<D>(looked, places, &mut sums);
    sums.map(|lanes| lanes.iter().map(|x| f64::from(*x)).sum::<f64>() / places.len as f64)
}

lanes! {
    fn add<D: Distribution>(looked: Looked, places: &Places, sums: &mut [Row; SUMS]) {
        let Looked { geometry, alpha, cos, eta } = looked;
        let widths = Widths { x: alpha, y: alpha };
        let (d, visible) = (D::new(widths), Ggx(widths));
        let wo = Vec3::new(((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt(), 0.0, cos);
        let (lambda_o, masking) = (d.lambda(wo), 1.0 + visible.lambda(wo));
        let separable = select(geometry == Geometry::Separable, 1.0, 0.0);
        let groove = geometry == Geometry::VGroove;
        let (inside, inverse2) = (eta < 1.0, 1.0 / (eta * eta));
        for start in (0..places.first.len()).step_by(BLOCK) {
            let row = |column: &[f32]| -> Row { std::array::from_fn(|k| column[start + k]) };
            let (first, cosines, sines) = (row(&places.first), row(&places.cos), row(&places.sin));
            let counts = row(&places.counts);
            let (mut up, mut down, mut reflected, mut x): (Row, Row, Row, Row) = Default::default();
            for k in 0..BLOCK {
                let m = visible_normal(wo, widths, first[k], (cosines[k], sines[k]));
                let om = wo.dot(m);
                let ratio = masking * d.d(m) / visible.d(m).max(1e-30);
                let ratio = select(om > 0.0, ratio * counts[k], 0.0);
                let part = |wi: Vec3| {
                    let lambda_i = d.lambda(wi);
                    let smith = 1.0 / (1.0 + lambda_o + lambda_i + separable * (lambda_o * lambda_i));
                    // A facet's cosine to the light stands to that to the viewer as grooves need it.
                    let least = cos.min(wi.z.abs() * om / wi.dot(m).abs().max(1e-20));
                    ratio * select(groove, (2.0 * m.z * least / om.max(1e-20)).min(1.0), smith)
                };
                let (above, below) = (m * (2.0 * om) - wo, refracted(wo, m, eta));
                up[k] = select(above.z > 0.0, part(above), 0.0);
                down[k] = select(below.z < 0.0, part(below), 0.0);
                reflected[k] = dielectric(om, eta);
                let outside = (1.0 - inverse2 * (1.0 - om) * (1.0 + om)).max(0.0).sqrt();
                x[k] = (1.0 - select(inside, outside, om)).clamp(0.0, 1.0);
            }
            add_block([&up, &down, &reflected, &x], sums);
        }
    }
}

/// Adds a block: of each facet what a reflecting and a transmitting one leaves, what a dielectric reflects, and what Schlick's term is
/// a power of.
#[inline(always)]
fn add_block([up, down, reflected, x]: [&Row; 4], sums: &mut [Row; SUMS]) {
    let [mirror, glass, clear, rises @ ..] = sums;
    for k in 0..BLOCK {
        mirror[k] += up[k];
        glass[k] += reflected[k] * up[k] + (1.0 - reflected[k]) * down[k];
        clear[k] += down[k];
    }
    let [a, b, c, d, e, f] = rises;
    for k in 0..BLOCK {
        let (x, more) = (x[k], up[k] - down[k]);
        let x2 = x * x;
        let x5 = x2 * x2 * x;
        let x10 = x5 * x5;
        a[k] += x * more;
        b[k] += x2 * x.sqrt() * more;
        c[k] += x5 * more;
        d[k] += x10 * more;
        e[k] += x10 * x10 * x10 * more;
        f[k] += select(x >= 1.0, more, 0.0);
    }
}
