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
    [
        -10.72827434539795,
        26.75466537475586,
        -30.545190811157227,
        26.44391441345215,
        -25.53688621520996,
        20.535381317138672,
        -6.929812908172607,
    ],
    [
        -5.898750305175781,
        -7.392763137817383,
        50.20700454711914,
        -59.2871208190918,
        10.121733665466309,
        21.212814331054688,
        -9.820420265197754,
    ],
    [
        13.712546348571777,
        -68.79280853271484,
        124.53502655029297,
        -88.73819732666016,
        7.298729419708252,
        15.610330581665039,
        -3.3579928874969482,
    ],
    [
        5.1483941078186035,
        -7.526043891906738,
        -28.15424346923828,
        73.22022247314453,
        -56.363677978515625,
        13.65488052368164,
        0.0,
    ],
    [-9.90109920501709, 52.655059814453125, -103.88265991210938, 89.18867492675781, -28.12316131591797, 0.0, 0.0],
    [-6.834083080291748, 24.676836013793945, -29.920185089111328, 12.076992988586426, 0.0, 0.0, 0.0],
    [-0.0514424666762352, 0.6101614236831665, -0.5337928533554077, 0.0, 0.0, 0.0, 0.0],
];
/// The logarithm of a, likewise.
const WIDTH: [[f32; 7]; 7] = [
    [
        -2.045988082885742,
        1.1187875270843506,
        5.980319023132324,
        -9.884432792663574,
        -1.8147300481796265,
        14.75158977508545,
        -8.262890815734863,
    ],
    [
        1.1456400156021118,
        -2.920140266418457,
        -3.5616440773010254,
        18.02659797668457,
        -10.677276611328125,
        -10.96648120880127,
        9.010107040405273,
    ],
    [
        0.7120931148529053,
        0.9993011355400085,
        -17.23065757751465,
        27.941551208496094,
        5.857945442199707,
        -36.78599548339844,
        18.430334091186523,
    ],
    [
        1.385014533996582,
        -4.277595520019531,
        7.508573055267334,
        -13.313082695007324,
        15.604117393493652,
        -6.959668159484863,
        0.0,
    ],
    [1.8303627967834473, -6.46076774597168, 7.8554229736328125, -5.72334098815918, 2.649909257888794, 0.0, 0.0],
    [-1.0924038887023926, 6.57428503036499, -10.461275100708008, 5.087009906768799, 0.0, 0.0, 0.0],
    [-2.1497745513916016, 5.48556661605835, -3.4771203994750977, 0.0, 0.0, 0.0, 0.0],
];
/// The logarithm of -b over sin_o (1 - r), likewise.
const TILT: [[f32; 7]; 7] = [
    [
        -2.2602970600128174,
        2.228224277496338,
        -38.068634033203125,
        87.34162902832031,
        -38.38397216796875,
        -37.15560531616211,
        25.78127670288086,
    ],
    [
        -6.385343074798584,
        72.63277435302734,
        -205.4427947998047,
        170.56407165527344,
        82.63121032714844,
        -181.7052764892578,
        67.59806823730469,
    ],
    [
        -29.51764488220215,
        127.0481948852539,
        -122.223388671875,
        -142.00753784179688,
        338.1619873046875,
        -217.37606811523438,
        45.1107177734375,
    ],
    [
        16.751361846923828,
        -93.3786849975586,
        215.28436279296875,
        -275.6905822753906,
        197.71591186523438,
        -60.27898406982422,
        0.0,
    ],
    [42.52763366699219, -114.77294921875, 71.98091888427734, 14.011895179748535, -10.180510520935059, 0.0, 0.0],
    [-34.540626525878906, 128.71286010742188, -152.92506408691406, 58.00813293457031, 0.0, 0.0, 0.0],
    [-36.7984504699707, 96.83020782470703, -63.281005859375, 0.0, 0.0, 0.0, 0.0],
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
