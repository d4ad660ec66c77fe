//! Fitted constants of the sheen: albedo polynomials and sampler parameters.
//!
//! All are fitted on r 0.06..1. Albedo: Chebyshev coefficients, degree 6 in the cube root of the cosine (rows) times
//! degree 4 in log r (columns), error at held-out points 6.6e-4 (exact) and 7.4e-4 (exact, softened) for cosines from 1e-4.
//! Sampler: polynomials of degree 2 in sin theta_o (slow index) and sqrt r (fast index).

use super::shadowing::Shadowing;

/// Coefficients of a sampler: of ln a, and of b over sin theta_o.
pub struct ProposalFit {
    /// Coefficients of ln a.
    pub log_a: &'static [f32; 9],
    /// Coefficients of b / sin theta_o.
    pub b: &'static [f32; 9],
}

/// The sampler fitted to a shadowing term. The visibility of Ashikhmin shares the sampler of the unsoftened exact term.
#[inline(always)]
pub fn proposal_fit(term: Shadowing, soft: bool) -> ProposalFit {
    match (term, soft) {
        (Shadowing::Exact, true) => ProposalFit { log_a: &LOG_A_EXACT_SOFT, b: &B_EXACT_SOFT },
        (Shadowing::Published, true) => ProposalFit { log_a: &LOG_A_PUBLISHED_SOFT, b: &B_PUBLISHED_SOFT },
        _ => ProposalFit { log_a: &LOG_A_EXACT, b: &B_EXACT },
    }
}

/// Albedo of the exact term.
pub const ALBEDO_EXACT: [[f32; 5]; 7] = [
    [0.539_306, 0.087_344_5, -0.000_846_953_5, -0.002_130_273_3, -0.000_253_380_22],
    [-0.516_829_55, 0.064_316_064, 0.011_206_872, -0.002_942_836_1, -0.000_762_884_33],
    [-0.004_495_435_4, -0.049_948_42, 0.017_087_711, 0.000_203_760_5, -0.000_981_839_8],
    [0.049_631_912, -0.024_348_244, 0.002_955_134_5, 0.002_191_014_8, -0.000_626_257_45],
    [-0.007_362_217_6, 0.004_990_678_3, -0.002_989_398_8, 0.001_364_673_3, -0.000_152_800_35],
    [-0.002_828_45, 0.001_751_829, -0.000_827_086_5, 0.000_371_021_01, 2.624_504_9e-5],
    [0.000_687_955_65, -0.000_362_458_1, 0.000_117_329_77, -3.680_740_3e-5, 5.737_956_6e-5],
];

/// Albedo of the exact term with softened terminator.
pub const ALBEDO_EXACT_SOFT: [[f32; 5]; 7] = [
    [0.482_506_63, 0.112_176_28, -0.005_699_909_3, -0.001_745_258_3, -0.000_241_907_92],
    [-0.468_012_93, 0.031_387_933, 0.018_998_65, -0.003_683_140_3, -0.000_770_935_4],
    [0.014_555_99, -0.056_776_844, 0.016_654_264, 0.000_959_844_04, -0.001_119_918_1],
    [0.027_224_492, -0.011_316_157, -0.000_452_005_83, 0.002_759_294_6, -0.000_631_485_6],
    [0.000_363_282_04, 0.000_956_180_04, -0.002_105_704_3, 0.001_120_832_9, -3.740_731_7e-5],
    [-0.003_987_962, 0.002_383_692_2, -0.000_878_244_8, 0.000_394_601_23, 1.774_974e-5],
    [0.000_675_459_86, -0.000_434_444_98, 0.000_159_690_77, -8.987_591e-5, 0.000_103_986_26],
];

const LOG_A_EXACT: [f32; 9] = [-2.914_499_8, 5.066_002, -2.721_818_4, 2.649_673, -2.374_892_7, 0.779_234_2, -1.442_373_4, -0.016_122_04, 0.438_692_3];
const B_EXACT: [f32; 9] = [-7.107_434, 13.837_607, -7.472_971, 10.252_216, -23.671_421, 13.745_698, -3.740_869, 10.733_824, -6.689_293];
const LOG_A_EXACT_SOFT: [f32; 9] = [-1.994_536_3, 2.973_489_8, -1.434_145_8, 3.228_708, -4.445_333, 2.147_984_7, -2.476_532_5, 3.352_447_3, -1.753_866_2];
const B_EXACT_SOFT: [f32; 9] = [-9.755_31, 20.734_31, -11.889_914_5, 14.145_183, -33.929_99, 20.358_002, -5.168_94, 14.489_175, -9.113_517];
const LOG_A_PUBLISHED_SOFT: [f32; 9] = [-2.035_048_7, 3.146_357_3, -1.575_273_6, 3.195_771_5, -4.293_43, 2.012_522_5, -2.427_579_6, 3.124_089, -1.553_211_2];
const B_PUBLISHED_SOFT: [f32; 9] = [-9.714_496, 20.544_077, -11.732_246, 14.083_788, -33.619_247, 20.099_678, -5.142_071_2, 14.344_907, -8.994_387];

use super::albedo::Surface;
pub const ALBEDO_PUBLISHED_SOFT: Surface = [[0.0; 9]; 13];
pub const ALBEDO_PUBLISHED: Surface = [[0.0; 9]; 13];
pub const ALBEDO_ASHIKHMIN: Surface = [[0.0; 9]; 13];
