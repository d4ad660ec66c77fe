//! The RGB that shaders compute in: which primaries and which white 1, 1, 1 means.
//!
//! Decision (2026-11-29): the working space is a property of a group, chosen when it is built, and bears on what leads from light to RGB
//! and back (`blackbody`, `wavelength_color`, `luminance`, `transformc` to and from XYZ and xyY); instead of a conversion of results,
//! which cannot give back what was clipped at 0 in Rec. 709. Colors that shaders and textures state are taken as of the working space, as
//! in OSL.

use std::sync::LazyLock;

/// A 3 by 3 matrix that rows of three are multiplied with: `xyz = rgb M`.
pub type Rows = [[f32; 3]; 3];

/// The primaries and the white of RGB, by OSL's names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WorkingSpace {
    /// `Rec709`, `sRGB`: ITU-R BT.709, what OSL assumes unless told otherwise.
    #[default]
    Rec709,
    /// `NTSC`: of 1953, white C.
    Ntsc,
    /// `EBU`, `PAL`, `SECAM`.
    Ebu,
    /// `SMPTE`: SMPTE C.
    Smpte,
    /// `HDTV`: as OSL has it, with its own red.
    Hdtv,
    /// `CIE`: monochromatic primaries of 700, 546.1 and 435.8 nm, equal-energy white.
    Cie,
    /// `AdobeRGB`.
    AdobeRgb,
    /// `XYZ` itself.
    Xyz,
    /// `ACES2065-1`: the primaries AP0.
    Aces2065,
    /// `ACEScg`: the primaries AP1.
    AcesCg,
}

/// From a working space to CIE XYZ and back.
#[derive(Clone, Copy, Debug)]
pub struct Matrices {
    /// Rows X, Y, Z of red, green and blue.
    pub to_xyz: Rows,
    /// The inverse.
    pub from_xyz: Rows,
}

impl WorkingSpace {
    /// All, in the order of their numbers.
    pub const ALL: [WorkingSpace; 10] = {
        use WorkingSpace::*;
        [Rec709, Ntsc, Ebu, Smpte, Hdtv, Cie, AdobeRgb, Xyz, Aces2065, AcesCg]
    };

    /// The names that [`WorkingSpace::from_name`] knows.
    pub const NAMES: [&str; 13] = [
        "Rec709",
        "sRGB",
        "NTSC",
        "EBU",
        "PAL",
        "SECAM",
        "SMPTE",
        "HDTV",
        "CIE",
        "AdobeRGB",
        "XYZ",
        "ACES2065-1",
        "ACEScg",
    ];

    /// The space of this name.
    pub fn from_name(name: &str) -> Option<WorkingSpace> {
        use WorkingSpace::*;
        Some(match name {
            "Rec709" | "sRGB" => Rec709,
            "NTSC" => Ntsc,
            "EBU" | "PAL" | "SECAM" => Ebu,
            "SMPTE" => Smpte,
            "HDTV" => Hdtv,
            "CIE" => Cie,
            "AdobeRGB" => AdobeRgb,
            "XYZ" => Xyz,
            "ACES2065-1" => Aces2065,
            "ACEScg" => AcesCg,
            _ => return None,
        })
    }

    /// The chromaticities of red, green, blue and white. Source: OSL 1.16, whose digits these are, so that the same shaders give the same
    /// numbers; ITU-R BT.709 has the white at (0.3127, 0.3290).
    fn chromaticities(self) -> [[f64; 2]; 4] {
        const C: [f64; 2] = [0.3101, 0.3162];
        const D65: [f64; 2] = [0.3127, 0.3291];
        const E: [f64; 2] = [1.0 / 3.0, 1.0 / 3.0];
        const ACES: [f64; 2] = [0.321_68, 0.337_67];
        match self {
            WorkingSpace::Rec709 => [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], D65],
            WorkingSpace::Ntsc => [[0.67, 0.33], [0.21, 0.71], [0.14, 0.08], C],
            WorkingSpace::Ebu => [[0.64, 0.33], [0.29, 0.60], [0.15, 0.06], D65],
            WorkingSpace::Smpte => [[0.630, 0.340], [0.310, 0.595], [0.155, 0.070], D65],
            WorkingSpace::Hdtv => [[0.670, 0.330], [0.210, 0.710], [0.150, 0.060], D65],
            WorkingSpace::Cie => [[0.7355, 0.2645], [0.2658, 0.7243], [0.1669, 0.0085], E],
            WorkingSpace::AdobeRgb => [[0.64, 0.33], [0.21, 0.71], [0.15, 0.06], D65],
            WorkingSpace::Xyz => [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], E],
            WorkingSpace::Aces2065 => [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], ACES],
            WorkingSpace::AcesCg => [[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], ACES],
        }
    }

    /// The matrices, scaled so that white has luminance 1.
    #[inline]
    pub fn matrices(self) -> &'static Matrices {
        match self {
            WorkingSpace::Rec709 => &REC_709,
            other => &OTHERS[other as usize],
        }
    }

    /// The weights of luminance: Y of red, green and blue.
    pub fn luminance_weights(self) -> [f32; 3] {
        self.matrices().to_xyz.map(|row| row[1])
    }
}

/// Those of Rec. 709, derived in `f64` from its chromaticities.
const REC_709: Matrices = Matrices {
    to_xyz: [
        [0.412_135_33, 0.212_507_28, 0.019_318_843],
        [0.357_675, 0.715_35, 0.119_225],
        [0.180_356_8, 0.072_142_72, 0.949_879_1],
    ],
    from_xyz: [
        [3.242_979, -0.968_998, 0.055_668_324],
        [-1.538_336_2, 1.875_492, -0.204_117_2],
        [-0.498_919_84, 0.041_544_524, 1.057_698_2],
    ],
};

static OTHERS: LazyLock<[Matrices; 10]> = LazyLock::new(|| WorkingSpace::ALL.map(derived));

/// Primaries scaled so that together they are the white. Source: SMPTE RP 177-1993, section 3.
fn derived(space: WorkingSpace) -> Matrices {
    use glam::{DMat3, DVec3};
    let xyz = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y);
    let [red, green, blue, white] = space.chromaticities().map(xyz);
    let primaries = DMat3::from_cols(red, green, blue);
    let scale = primaries.inverse() * (white / white.y);
    let to_xyz = primaries * DMat3::from_diagonal(scale);
    let rows = |m: DMat3| m.to_cols_array_2d().map(|column| column.map(|x| x as f32));
    Matrices { to_xyz: rows(to_xyz), from_xyz: rows(to_xyz.inverse()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_constants_of_rec_709_are_those_of_its_chromaticities() {
        let derived = derived(WorkingSpace::Rec709);
        let given = WorkingSpace::Rec709.matrices();
        for (a, b) in [(derived.to_xyz, given.to_xyz), (derived.from_xyz, given.from_xyz)] {
            for (a, b) in a.as_flattened().iter().zip(b.as_flattened()) {
                assert!((a - b).abs() < 1e-6, "{a} {b}");
            }
        }
    }

    #[test]
    fn white_is_white_and_back_again() {
        for (at, space) in WorkingSpace::ALL.into_iter().enumerate() {
            assert_eq!(space as usize, at);
            let m = space.matrices();
            let times = |c: [f32; 3], m: &Rows| [0, 1, 2].map(|k| c[0] * m[0][k] + c[1] * m[1][k] + c[2] * m[2][k]);
            let white = times([1.0; 3], &m.to_xyz);
            let [x, y] = space.chromaticities()[3].map(|c| c as f32);
            let sum: f32 = white.iter().sum();
            assert!((white[1] - 1.0).abs() < 1e-5 && (white[0] / sum - x).abs() < 1e-5, "{space:?} {white:?}");
            assert!((white[1] / sum - y).abs() < 1e-5);
            assert!((space.luminance_weights().iter().sum::<f32>() - 1.0).abs() < 1e-5);
            for (c, want) in times(white, &m.from_xyz).iter().zip([1.0f32; 3]) {
                assert!((c - want).abs() < 1e-4, "{space:?}");
            }
        }
        for name in WorkingSpace::NAMES {
            assert!(WorkingSpace::from_name(name).is_some());
        }
        assert_eq!(WorkingSpace::from_name("acescg"), None);
    }
}
