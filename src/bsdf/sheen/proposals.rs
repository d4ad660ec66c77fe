//! Fitted constants of the sampler of the sheen, for every shadowing term, and of the velvet.

use super::term::Shadowing;

/// Coefficients in y = ln r / ln 0.01 (0 at r = 1, 1 at 0.01) of what the sampler makes of a roughness.
///
/// The first three are numbers of the view: sums over its terms 1, t, sqrt(cos), cos with t = sin / sqrt(sin² + 0.2 r), of
/// quadratics in y. The others are straight lines in y.
#[derive(Clone, Copy, Debug)]
pub struct ProposalFit {
    /// ln a: how wide the lobe is along the viewer's azimuth.
    pub log_width: [[f32; 3]; 4],
    /// b / t: how far it leans toward the viewer.
    pub tilt: [[f32; 3]; 4],
    /// ln q / t: how much narrower it is across.
    pub log_across: [[f32; 3]; 4],
    /// The share of directions that keep a density at the horizon.
    pub flat: [f32; 2],
    /// How much of that share turns to the viewer.
    pub lean: [f32; 2],
    /// The share of directions by the cube of the cosine.
    pub cube: [f32; 2],
}

/// The sampler fitted to a shadowing term. Without softening one fit serves all terms: their lobes differ in height only.
#[inline(always)]
pub fn proposal_fit(term: Shadowing, soft: bool) -> &'static ProposalFit {
    match (term, soft) {
        (Shadowing::Exact | Shadowing::Series, true) => &EXACT_SOFT,
        (Shadowing::Published, true) => &PUBLISHED_SOFT,
        (Shadowing::Exact | Shadowing::Series | Shadowing::Published, false) | (Shadowing::Ashikhmin, _) => &EXACT,
    }
}

const EXACT: ProposalFit = ProposalFit {
    log_width: [
        [-0.800_732_1, -1.482_271_4, -0.531_696_9],
        [0.238_136_54, 1.049_246_5, -0.569_717_65],
        [1.107_081_7, 2.018_634_8, -0.210_442_9],
        [-0.645_958_5, -1.901_433_8, -0.990_964_35],
    ],
    tilt: [
        [-0.229_033_54, 3.223_504_3, -3.519_804],
        [0.143_851_3, -3.782_434_2, 4.033_854_5],
        [-0.158_170_03, -0.320_261_96, -1.825_961_5],
        [-0.077_582_43, -1.162_671_4, 2.534_672_7],
    ],
    log_across: [
        [-0.125_046_7, 1.500_829_1, -3.445_988],
        [0.081_548_54, -1.764_438_3, 3.663_018_2],
        [-0.297_707_95, -0.983_481_47, -0.053_489_123],
        [0.237_865_08, 0.269_238_65, 1.493_715_3],
    ],
    flat: [0.191_552_61, 0.351_094],
    lean: [0.0, 0.815_714_7],
    cube: [0.0, 0.159_159_42],
};

const EXACT_SOFT: ProposalFit = ProposalFit {
    log_width: [
        [-0.909_292_16, -2.142_877, -0.080_910_996],
        [0.198_478_15, 0.925_715_8, -0.239_218_5],
        [1.292_711, 1.903_310_4, 1.409_537_3],
        [-0.894_174_4, -1.317_831, -1.898_367_5],
    ],
    tilt: [
        [-0.134_759_68, 1.930_043_9, -1.790_256_5],
        [0.053_914_223, -2.278_332_2, 1.984_185_3],
        [-0.111_780_57, -0.384_879, -2.129_698_3],
        [-0.105_592_64, -0.576_865, 2.044_731],
    ],
    log_across: [
        [-0.240_279_6, 2.037_845_4, -3.279_989_5],
        [0.184_298_38, -2.161_303, 3.231_907_1],
        [-0.288_982_2, -1.257_089_4, 0.477_344_9],
        [0.276_607_36, 0.309_454_26, 0.774_592_04],
    ],
    flat: [0.083_862_84, -0.043_862_842],
    lean: [0.0, 0.0],
    cube: [0.344_197_75, 0.466_008_84],
};

const PUBLISHED_SOFT: ProposalFit = ProposalFit {
    log_width: [
        [-0.891_570_87, -2.076_986_3, -0.217_096_08],
        [0.148_020_94, 1.245_260_2, -0.494_825_15],
        [1.454_689_1, 1.298_257_8, 1.454_306_2],
        [-1.044_405_8, -0.726_804_14, -1.980_369_2],
    ],
    tilt: [
        [-0.188_517_06, 2.397_853, -2.327_596_4],
        [0.113_193_35, -2.803_127_8, 2.577_399_3],
        [-0.155_319_97, -0.289_882_36, -2.025_858_4],
        [-0.039_078_33, -0.906_236_8, 2.142_573_8],
    ],
    log_across: [
        [-0.184_516_37, 2.083_501, -3.632_079_8],
        [0.134_132_15, -2.286_969_4, 3.674_741_5],
        [-0.331_987_6, -0.806_191_15, -0.006_236_679],
        [0.314_014_55, -0.188_904_57, 1.337_309_2],
    ],
    flat: [0.063_752_78, -0.023_752_777],
    lean: [0.0, 0.111_361_43],
    cube: [0.293_541_85, 0.434_982_2],
};

/// The sampler of Ashikhmin's velvet in its form of 2000, of width 0.06..1: relative variance at most 1.4 at grazing views, 0.54 in
/// the mean over views.
pub const VELVET: ProposalFit = ProposalFit {
    log_width: [
        [-2.403_497_2, -2.390_638_6, -0.124_649_05],
        [1.398_427_8, -0.579_662_9, -1.168_575_6],
        [1.700_408_7, 10.730_947, -13.078_008],
        [-0.369_111_5, -14.013_792, 9.740_749],
    ],
    tilt: [
        [0.558_246_1, -10.010_461, 7.676_920_4],
        [-0.367_330_82, 9.514_361, -7.145_491_6],
        [1.135_803_3, -7.456_676_5, 0.665_621_4],
        [-2.267_766_2, 6.473_299, 1.777_948],
    ],
    log_across: [
        [1.607_513_7, -9.814_293, 17.787_176],
        [-0.481_457_14, 8.027_984, -16.711_582],
        [-2.366_435_5, -11.080_247, 17.147_532],
        [0.387_335_48, 16.815_472, -17.560_133],
    ],
    flat: [0.45, 0.15],
    lean: [0.0, 0.0],
    cube: [0.4, 0.140_993_34],
};
