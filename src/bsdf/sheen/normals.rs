//! The sheen sampled by its half vector, to compare with: the textbook scheme, and a poor one here.

use super::Sheen;
use super::charlie::{distribution, sin2_half};
use crate::bsdf::power::power;
use crate::bsdf::{Eval, Params, Scatter, View, above_horizon, select};
use crate::math::warp::turn;
use glam::Vec3;

/// [`Sheen`] with micronormals m of density D cos(theta_m): sin(theta_m) = xi^(1 / (2 + n)).
///
/// Source: own inversion; the change to light directions is Torrance and Sparrow's 1 / (4 wo . m).
/// Domain: as [`Sheen`]. Gives: directions of which most fall below the horizon (at r = 0.15 and a view along the
/// normal 95 %), which are given up. Degenerate cases: the viewer exactly along m's
/// horizon gives density 0.
#[derive(Clone, Copy, Debug)]
pub struct ByNormals<const SHADOWING: u8, const SOFT: bool>(Sheen<SHADOWING, SOFT>);

impl<const SHADOWING: u8, const SOFT: bool> Scatter for ByNormals<SHADOWING, SOFT> {
    const PARAMS: usize = 1;
    const SHEEN: Option<bool> = Sheen::<SHADOWING, SOFT>::SHEEN;
    const VIEW: usize = 5;

    #[inline(always)]
    fn prepare(params: Params) -> Self {
        ByNormals(Sheen::prepare(params))
    }

    #[inline(always)]
    fn view(&self, wo: Vec3) -> View {
        self.0.view(wo)
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, view: View, wi: Vec3) -> Eval {
        let Eval { f_cos, .. } = self.0.eval_from(wo, view, wi);
        let h = wo + wi;
        let length2 = h.dot(h).max(f32::MIN_POSITIVE);
        // cos(theta_m) / (4 wo . m) with m = h / |h|; wo . h is half of |h|² for unit directions.
        let jacobian = h.z / (2.0 * length2);
        let pdf = distribution(sin2_half(wo, wi), self.0.n) * jacobian;
        Eval { f_cos, pdf: select(wo.z > 0.0 && wi.z > 0.0, pdf, 0.0) }
    }

    #[inline(always)]
    fn sample_from(&self, wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        let sin = power(xi.x.max(1e-12), 1.0 / (2.0 + self.0.n)).min(1.0);
        let cos = ((1.0 - sin) * (1.0 + sin)).sqrt();
        let (x, y) = turn(xi.y);
        let m = Vec3::new(sin * x, sin * y, cos);
        above_horizon(m * (2.0 * wo.dot(m)) - wo)
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        self.0.albedo(cos)
    }
}
