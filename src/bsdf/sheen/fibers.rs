//! Sheen of a layer of fibers, as a linearly transformed cosine: `sheen_bsdf` in mode 1.

use crate::bsdf::bivariate::{collapse, horner};
use crate::bsdf::{Eval, Params, Scatter, View, limited, select};
use crate::math::elementary::{exp, ln};
use crate::math::warp::cosine_hemisphere;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// The least roughness.
pub const MIN_ROUGHNESS: f32 = 0.02;

/// Below this roughness the shape of the lobe, then almost black, no longer changes.
const MIN_SHAPED: f32 = 1.0 / 31.0;

/// Sheen of a layer of fibers.
///
/// Source: Zeltner, Burley and Chiang 2022, "Practical Multiple-Scattering Sheen Using Linearly Transformed Cosines", eq. 1 and 2:
/// f cos_i = R D(wi) with D the density of a linearly transformed cosine: w ~ (a x + b z, a y, z) of wi in the frame whose x axis
/// points along the viewer's projection. R, a and b are an own fit to the published table of 32 x 32 nodes.
/// Domain: roughness, limited to 0.02..1. Gives: f in 1/sr. Not reciprocal: a, b and R follow the viewer alone.
/// Albedo: R, exactly what the lobe reflects, at most 0.751; sampling is perfect, each weight is R.
/// Error of R against the table's nodes: 0.005, mean 0.0005; of the whole lobe 0.021, mean 0.0024 of its light.
/// Degenerate cases: a viewer along the normal needs no azimuth, because b is 0 there.
/// `Differs from OSL:` roughness is the table's own, as in MaterialX's shader code; OSL's renderers take its square root first.
#[derive(Clone, Copy, Debug)]
pub struct Fibers {
    albedo: [f32; 7],
    a: [f32; 7],
    b: [f32; 7],
    /// 1 - roughness
    smooth: f32,
}

/// The logit of R as a polynomial in t = 2 c - 1 and v = 1 + 2 ln(r) / ln 50, turned from the fitted Chebyshev form.
const ALBEDO: [[f32; 7]; 7] = [
    [-10.728_274, 26.754_665, -30.545_19, 26.443_914, -25.536_886, 20.535_381, -6.929_813],
    [-5.898_750_3, -7.392_763, 50.207_005, -59.287_12, 10.121_734, 21.212_814, -9.820_42],
    [13.712_546, -68.792_81, 124.535_03, -88.7382, 7.298_729_4, 15.610_331, -3.357_993],
    [5.148_394, -7.526_044, -28.154_243, 73.220_22, -56.363_678, 13.654_881, 0.0],
    [-9.901_099, 52.655_06, -103.882_66, 89.188_675, -28.123_161, 0.0, 0.0],
    [-6.834_083, 24.676_836, -29.920_185, 12.076_993, 0.0, 0.0, 0.0],
    [-0.051_442_467, 0.610_161_4, -0.533_792_85, 0.0, 0.0, 0.0, 0.0],
];
/// The logarithm of a, likewise.
const WIDTH: [[f32; 7]; 7] = [
    [-2.045_988, 1.118_787_5, 5.980_319, -9.884_433, -1.814_73, 14.751_59, -8.262_891],
    [1.145_64, -2.920_140_3, -3.561_644, 18.026_598, -10.677_277, -10.966_481, 9.010_107],
    [0.712_093_1, 0.999_301_14, -17.230_658, 27.941_551, 5.857_945_4, -36.785_995, 18.430_334],
    [1.385_014_5, -4.277_595_5, 7.508_573, -13.313_083, 15.604_117, -6.959_668, 0.0],
    [1.830_362_8, -6.460_767_7, 7.855_423, -5.723_341, 2.649_909_3, 0.0, 0.0],
    [-1.092_403_9, 6.574_285, -10.461_275, 5.087_01, 0.0, 0.0, 0.0],
    [-2.149_774_6, 5.485_566_6, -3.477_120_4, 0.0, 0.0, 0.0, 0.0],
];
/// The logarithm of -b over sin_o (1 - r), likewise.
const TILT: [[f32; 7]; 7] = [
    [-2.260_297, 2.228_224_3, -38.068_634, 87.341_63, -38.383_972, -37.155_605, 25.781_277],
    [-6.385_343, 72.632_774, -205.4428, 170.564_07, 82.631_21, -181.705_28, 67.598_07],
    [-29.517_645, 127.048_195, -122.223_39, -142.007_54, 338.162, -217.376_07, 45.110_718],
    [16.751_362, -93.378_685, 215.284_36, -275.690_58, 197.715_91, -60.278_984, 0.0],
    [42.527_634, -114.772_95, 71.980_92, 14.011_895, -10.180_510_5, 0.0, 0.0],
    [-34.540_627, 128.712_86, -152.925_06, 58.008_133, 0.0, 0.0, 0.0],
    [-36.798_45, 96.830_21, -63.281_006, 0.0, 0.0, 0.0, 0.0],
];

impl Fibers {
    /// The sheen of a roughness.
    #[inline(always)]
    pub fn new(roughness: f32) -> Self {
        const TWO_OVER_LN_50: f32 = 0.511_244_4;
        let r = limited(roughness, MIN_ROUGHNESS, 1.0);
        let v = 1.0 + TWO_OVER_LN_50 * ln(r);
        let shaped = 1.0 + TWO_OVER_LN_50 * ln(r.max(MIN_SHAPED));
        Fibers {
            albedo: collapse(&ALBEDO, v),
            a: collapse(&WIDTH, shaped),
            b: collapse(&TILT, shaped),
            smooth: 1.0 - r,
        }
    }

    /// The density of a direction, 1/sr.
    #[inline(always)]
    fn density(view: View, wi: Vec3) -> f32 {
        let [_, a, b, cos, sin] = view;
        let (x, y) = (wi.x * cos + wi.y * sin, wi.y * cos - wi.x * sin);
        let (wx, wy) = (a * x + b * wi.z, a * y);
        let ratio = a / (wx * wx + wy * wy + wi.z * wi.z).max(1e-20);
        FRAC_1_PI * wi.z.max(0.0) * ratio * ratio
    }
}

impl Scatter for Fibers {
    const PARAMS: usize = 1;
    const VIEW: usize = 5;

    #[inline(always)]
    fn prepare([roughness, ..]: Params) -> Self {
        Fibers::new(roughness)
    }

    #[inline(always)]
    fn view(&self, wo: Vec3) -> View {
        let t = 2.0 * wo.z.clamp(0.0, 1.0) - 1.0;
        let sin2 = wo.x * wo.x + wo.y * wo.y;
        let inverse = select(sin2 > 1e-20, 1.0 / sin2.max(1e-20).sqrt(), 0.0);
        let a = limited(exp(horner(&self.a, t)), 0.01, 1.0);
        let b = -sin2.sqrt().min(1.0) * self.smooth * exp(horner(&self.b, t).min(1.0));
        [self.albedo(wo.z), a, b, select(sin2 > 1e-20, wo.x * inverse, 1.0), wo.y * inverse]
    }

    #[inline(always)]
    fn eval_from(&self, _wo: Vec3, view: View, wi: Vec3) -> Eval {
        let pdf = Self::density(view, wi);
        Eval { f_cos: view[0] * pdf, pdf }
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, [_, a, b, cos, sin]: View, xi: Vec3) -> Vec3 {
        let w = cosine_hemisphere(xi.x, xi.y);
        let (x, y, z) = (w.x - b * w.z, w.y, a * w.z);
        let scale = 1.0 / (x * x + y * y + z * z).max(1e-30).sqrt();
        Vec3::new(x * cos - y * sin, y * cos + x * sin, z) * scale
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        let t = 2.0 * cos.clamp(0.0, 1.0) - 1.0;
        1.0 / (1.0 + exp(-horner(&self.albedo, t)))
    }
}
