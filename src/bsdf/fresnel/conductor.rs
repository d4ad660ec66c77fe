//! Fresnel reflection of metals.

use super::{Fresnel, Params, limited};
use glam::Vec3;

/// The largest index and extinction that count; beyond, single floats would overflow in the fourth powers.
const MOST: f32 = 1e4;

/// Reflected part of unpolarised light at a conductor, one wavelength.
///
/// Source: Fresnel with a complex index; with a² - b² = eta² - k² - sin², a b = eta k (Born and Wolf 1959, section 13.2),
/// Rs = ((a - c)² + b²) / ((a + c)² + b²), Rp / Rs = ((a c - sin²)² + (b c)²) / ((a c + sin²)² + (b c)²).
/// Domain: cosine of incidence, its sign is ignored; index over that outside 0..1e4; extinction 0..1e4. Gives: 0..1.
/// Degenerate cases: k = 0 is [`super::dielectric()`], eta = 0 reflects all, a cosine of 0 reflects all.
/// Departs from source: every difference is taken before squaring, because the usual expanded form loses all its digits
/// where little is reflected.
#[inline(always)]
pub fn conductor(cos: f32, eta: f32, k: f32) -> f32 {
    let c = cos.abs().min(1.0);
    let (c2, s2) = (c * c, (1.0 - c) * (1.0 + c));
    let (difference, product) = ((eta - k) * (eta + k) - s2, eta * k);
    // The larger of a² and b² is a sum, the other follows from their product.
    let larger = 0.5 * ((difference * difference + 4.0 * product * product).sqrt() + difference.abs());
    let smaller = product * product / larger.max(1e-30);
    let (a2, b2) = if difference > 0.0 { (larger, smaller) } else { (smaller, larger) };
    let a = a2.sqrt();
    let (near, far) = (a - c, a + c);
    let (minus, plus) = (a * c - s2, a * c + s2);
    let s = ratio(near * near + b2, far * far + b2);
    let p = s * ratio(minus * minus + b2 * c2, plus * plus + b2 * c2);
    0.5 * (s + p)
}

/// A quotient that is 1 where both parts vanish.
#[inline(always)]
fn ratio(part: f32, whole: f32) -> f32 {
    (part + 1e-30) / (whole + 1e-30)
}

/// A metal with an index and an extinction for each of red, green and blue.
///
/// Parameters: eta (3), k (3), both over the index outside. It lets nothing through.
#[derive(Clone, Copy, Debug)]
pub struct Conductor {
    eta: Vec3,
    k: Vec3,
}

impl Fresnel for Conductor {
    const PARAMS: usize = 6;
    const COLORED: bool = true;

    #[inline(always)]
    fn prepare(p: Params, from: usize) -> Self {
        let at = |i: usize| limited(p[from + i], 0.0, MOST);
        Conductor { eta: Vec3::new(at(0), at(1), at(2)), k: Vec3::new(at(3), at(4), at(5)) }
    }

    #[inline(always)]
    fn eta(&self) -> f32 {
        0.0
    }

    #[inline(always)]
    fn color(&self, cos: f32) -> Vec3 {
        let (eta, k) = (self.eta, self.k);
        Vec3::new(conductor(cos, eta.x, k.x), conductor(cos, eta.y, k.y), conductor(cos, eta.z, k.z))
    }
}
