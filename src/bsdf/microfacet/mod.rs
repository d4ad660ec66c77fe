//! Rough dielectric boundaries: microfacets of Trowbridge and Reitz (GGX) or Beckmann, reflecting or refracting.
//!
//! `microfacet(..., refract 2)` becomes one reflecting and one refracting lobe. `eta` is transmitted over incident as seen
//! from the side of the normal; radiance is not scaled by 1 / eta², as in OSL's renderers, so white stays white.
//!
//! Decision (2026-11-22): both distributions sample visible normals of GGX (spherical caps), because
//! Beckmann's D is at most 4/e = 1.47 times GGX's of the same width, so its weights stay bounded without the iteration
//! that its own visible normals need, instead of sampling D cos, whose weights are unbounded at grazing views.

pub mod distributions;

use super::fresnel::{dielectric, refracted};
use super::{Eval, Params, Scatter, Side, View, select};
use distributions::{Widths, beckmann_d, beckmann_lambda, ggx_d, ggx_lambda};
use glam::Vec3;

/// Below this width in both directions a boundary counts as smooth.
pub const MIN_ALPHA: f32 = 1e-3;

/// The least |eta - 1| that refracts visibly; nearer to 1 light goes straight on.
pub const MIN_ETA_DIFFERENCE: f32 = 1e-3;

/// One side of a rough boundary: what it reflects (`REFRACT` false) or what it lets through.
///
/// Source: Walter, Marschner, Li and Torrance 2007, eq. 20, 21, 38 with the height-correlated Smith term (Heitz 2014,
/// eq. 99). Domain: widths clamped to 1e-3..1, any eta; eta <= 0 reflects all. Gives: f cos in 1/sr.
/// Degenerate cases: light on the wrong side gives 0, total reflection refracts nothing.
/// Albedo: Fresnel's part at the angle to the shading normal; light lost between facets is not subtracted, so as
/// the top of a layer a wide lobe takes too much from its base.
#[derive(Clone, Copy, Debug)]
pub struct Microfacet<const BECKMANN: bool, const REFRACT: bool> {
    widths: Widths,
    eta: f32,
}

impl<const BECKMANN: bool, const REFRACT: bool> Microfacet<BECKMANN, REFRACT> {
    #[inline(always)]
    fn d(&self, m: Vec3) -> f32 {
        if BECKMANN { beckmann_d(m, self.widths) } else { ggx_d(m, self.widths) }
    }

    #[inline(always)]
    fn lambda(&self, w: Vec3) -> f32 {
        if BECKMANN { beckmann_lambda(w, self.widths) } else { ggx_lambda(w, self.widths) }
    }

    /// Density of visible normals of GGX over (wo . m), from G1 over the viewer's cosine: what both distributions sample.
    #[inline(always)]
    fn visible(&self, over_cos: f32, m: Vec3) -> f32 {
        ggx_d(m, self.widths) * over_cos
    }

    #[inline(always)]
    fn reflect(&self, wo: Vec3, view: View, wi: Vec3) -> Eval {
        let h = wo + wi;
        let m = h * (1.0 / h.dot(h).max(1e-30).sqrt());
        let g2 = 1.0 / (1.0 + view[0] + self.lambda(wi));
        let f_cos = dielectric(wo.dot(m), self.eta) * self.d(m) * g2 * 0.25 * view[2];
        let lit = wi.z > 0.0 && wo.z > 0.0;
        Eval { f_cos: select(lit, f_cos, 0.0), pdf: select(lit, 0.25 * self.visible(view[1], m), 0.0) }
    }

    #[inline(always)]
    fn refract(&self, wo: Vec3, view: View, wi: Vec3) -> Eval {
        let h = wi * self.eta + wo;
        let length2 = h.dot(h).max(1e-30);
        let m = h * (1f32.copysign(h.z) / length2.sqrt());
        let (om, im) = (wo.dot(m), wi.dot(m));
        // The change from facets to light directions: eta² |wi . m| / (wo . m + eta wi . m)².
        let jacobian = self.eta * self.eta * im.abs() / length2;
        let g2 = 1.0 / (1.0 + view[0] + self.lambda(wi));
        let through = 1.0 - dielectric(om, self.eta);
        let f_cos = through * self.d(m) * g2 * om * jacobian * view[2];
        let lit = wi.z < 0.0 && wo.z > 0.0 && om > 0.0 && im < 0.0 && self.eta > 0.0;
        Eval { f_cos: select(lit, f_cos, 0.0), pdf: select(lit, self.visible(view[1], m) * om * jacobian, 0.0) }
    }
}

impl<const BECKMANN: bool, const REFRACT: bool> Scatter for Microfacet<BECKMANN, REFRACT> {
    const PARAMS: usize = 3;
    const SIDE: Side = if REFRACT { Side::Other } else { Side::Same };
    const VIEW: usize = 3;

    #[inline(always)]
    fn prepare([x, y, eta, ..]: Params) -> Self {
        Microfacet { widths: Widths { x: x.clamp(MIN_ALPHA, 1.0), y: y.clamp(MIN_ALPHA, 1.0) }, eta: eta.min(1e3) }
    }

    #[inline(always)]
    fn view(&self, wo: Vec3) -> View {
        let over_cos = 1.0 / wo.z.max(1e-30);
        [self.lambda(wo), over_cos / (1.0 + ggx_lambda(wo, self.widths)), over_cos, 0.0, 0.0]
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, view: View, wi: Vec3) -> Eval {
        if REFRACT { self.refract(wo, view, wi) } else { self.reflect(wo, view, wi) }
    }

    #[inline(always)]
    fn sample_from(&self, wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        let m = distributions::sample_visible(wo, self.widths, xi.x, xi.y);
        let wi = if REFRACT { refracted(wo, m, self.eta) } else { m * (2.0 * wo.dot(m)) - wo };
        // A direction on the wrong side is lost. It must not be kept for the other half of the boundary, which could
        // have found it with some other density: that would weigh it far too much.
        let lost = if REFRACT { wi.z >= 0.0 } else { wi.z <= 0.0 };
        if lost { Vec3::ZERO } else { wi }
    }

    /// An estimate: the Fresnel term averaged over facets tilted by the width. It never reaches 0 or 1, because facets far
    /// from the normal always send some light either way, and a part that is never picked would be lost.
    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        let width = self.widths.x.max(self.widths.y);
        let tilted = |by: f32| dielectric((cos + by * width).clamp(1e-3, 1.0), self.eta);
        let reflected = 0.25 * (tilted(-1.0) + tilted(1.0)) + 0.5 * dielectric(cos, self.eta);
        let limited = select(self.eta > 0.0, reflected.clamp(0.02, 0.97), 1.0);
        if REFRACT { 1.0 - limited } else { limited }
    }
}
