//! Colour: luminance, black bodies, single wavelengths and the colour spaces of `transformc`.
//!
//! RGB means linear light with the primaries and the white of the working space, which is Rec. 709 unless told otherwise.

use super::arithmetic::{div, max, min, pow};
use super::matching::CIE_1931;
use super::working_space::WorkingSpace;
use crate::math::elementary::{cbrt, expm1, floor, pow_positive};
use std::sync::OnceLock;

/// NTSC's luma and chroma axes, as in Foley and van Dam: `yiq = rgb M`.
const RGB_TO_YIQ: [[f32; 3]; 3] = [[0.299, 0.596, 0.212], [0.587, -0.275, -0.523], [0.114, -0.321, 0.311]];

/// The inverse of [`RGB_TO_YIQ`] to four digits, as OSL has it.
const YIQ_TO_RGB: [[f32; 3]; 3] = [[1.0, 1.0, 1.0], [0.9557, -0.2716, -1.1082], [0.6199, -0.6469, 1.7051]];

#[inline(always)]
fn times(c: [f32; 3], m: &[[f32; 3]; 3]) -> [f32; 3] {
    [0, 1, 2].map(|k| c[0] * m[0][k] + c[1] * m[1][k] + c[2] * m[2][k])
}

fn without_negatives(rgb: [f32; 3]) -> [f32; 3] {
    rgb.map(|c| if c > 0.0 { c } else { 0.0 })
}

/// Below this temperature (kelvin) nothing is visible: the Draper point, rounded.
const COLDEST: f32 = 800.0;
/// Up to this temperature a table is used.
const HOTTEST: f32 = 12_000.0;
/// Entries so that the last lies beyond [`HOTTEST`]: 2 * 316^1.5 + 800 = 12034.
const ENTRIES: usize = 318;

/// Fifth roots of black-body colours at the temperatures 2 i^1.5 + 800, for each working space that is asked for.
static BLACKBODY: [OnceLock<[[f32; 3]; ENTRIES]>; WorkingSpace::ALL.len()] =
    [const { OnceLock::new() }; WorkingSpace::ALL.len()];

fn blackbody_table(space: WorkingSpace) -> &'static [[f32; 3]; ENTRIES] {
    BLACKBODY[space as usize].get_or_init(|| {
        std::array::from_fn(|i| {
            let i = i as f32;
            blackbody_by_integral(space, i * i.sqrt() * 2.0 + COLDEST).map(|c| pow(c, 0.2))
        })
    })
}

/// The colour of a black body by Planck's law, integrated over the visible range in steps of 5 nm.
fn blackbody_by_integral(space: WorkingSpace, kelvin: f32) -> [f32; 3] {
    without_negatives(times(planck(|c, x| c / expm1(x), kelvin), &space.matrices().from_xyz))
}

/// The change of [`blackbody_by_integral`] when the temperature changes by a kelvin.
fn blackbody_by_integral_slope(space: WorkingSpace, kelvin: f32) -> [f32; 3] {
    // The derivative of 1 / expm1(x) by T, where x is as 1 / T, is x / T times e^x / expm1(x)^2.
    let slope = |c: f32, x: f32| {
        let below = expm1(x);
        c * (1.0 + 1.0 / below) / below * x / kelvin
    };
    let (value, slope) =
        (blackbody_by_integral(space, kelvin), times(planck(slope, kelvin), &space.matrices().from_xyz));
    [0, 1, 2].map(|k| if value[k] > 0.0 { slope[k] } else { 0.0 })
}

/// The XYZ of what `part` makes of Planck's `c = C1 / metres⁵` and `x = C2 / (metres kelvin)`, in steps of 5 nm.
fn planck(part: impl Fn(f32, f32) -> f32, kelvin: f32) -> [f32; 3] {
    // 2 pi h c^2 in W m^2 and h c / k in m K, with the digits that OSL uses.
    const C1: f32 = 3.741_83e-16;
    const C2: f32 = 1.438_8e-2;
    let mut xyz = [0.0f32; 3];
    for (i, match_) in CIE_1931.iter().enumerate() {
        let metres = (380.0 + 5.0 * i as f32) * 1e-9;
        // The fifth power is below the least normal f32.
        let fifth = (metres as f64).powi(5);
        let exitance = part((C1 as f64 / fifth) as f32, C2 / (metres * kelvin)) * 5e-9;
        for k in 0..3 {
            xyz[k] += exitance * match_[k];
        }
    }
    xyz
}

/// The linear RGB radiant exitance (W/m^2, weighted by the matching functions) of a black body.
///
/// Source: OSL, with its table of fifth roots, interpolated, good to 0.1 %; the integral itself above 12000 K.
/// Domain: kelvin. Gives: non-negative. Degenerate cases: a trace of red below 800 K and for NaN.
pub fn blackbody(space: WorkingSpace, kelvin: f32) -> [f32; 3] {
    if kelvin >= HOTTEST {
        return blackbody_by_integral(space, kelvin);
    }
    if kelvin >= COLDEST {
        let (a, b, t, _) = table_place(space, kelvin);
        return [0, 1, 2].map(|k| {
            let fifth_root = a[k] * (1.0 - t) + b[k] * t;
            let square = fifth_root * fifth_root;
            square * square * fifth_root
        });
    }
    [1e-6, 0.0, 0.0]
}

/// Between which two entries of the table a temperature falls, where, and the cube root that its place is the square of.
fn table_place(space: WorkingSpace, kelvin: f32) -> ([f32; 3], [f32; 3], f32, f32) {
    let root = cbrt((kelvin - COLDEST) / 2.0);
    let place = root * root;
    let first = (place as usize).min(ENTRIES - 2);
    let table = blackbody_table(space);
    (table[first], table[first + 1], place - first as f32, root)
}

/// The change of [`blackbody`] when the temperature changes by a kelvin; 0 where it is constant.
pub fn blackbody_slope(space: WorkingSpace, kelvin: f32) -> [f32; 3] {
    if kelvin >= HOTTEST {
        return blackbody_by_integral_slope(space, kelvin);
    }
    if kelvin >= COLDEST {
        let (a, b, t, root) = table_place(space, kelvin);
        // The place is ((T - coldest) / 2)^(2/3).
        let step = div(1.0, 3.0 * root);
        return [0, 1, 2].map(|k| {
            let fifth_root = a[k] * (1.0 - t) + b[k] * t;
            let square = fifth_root * fifth_root;
            5.0 * square * square * (b[k] - a[k]) * step
        });
    }
    [0.0; 3]
}

/// The linear RGB of light of a single wavelength, brought to at most about 1.
///
/// Source: CIE 1931 colour matching, interpolated, over 2.52 as in OSL. Domain: nanometres. Gives: non-negative.
/// Degenerate cases: black outside [380, 780) and for NaN.
pub fn wavelength_color(space: WorkingSpace, nanometres: f32) -> [f32; 3] {
    let place = (nanometres - 380.0) / 5.0;
    // Truncation towards zero lets the 5 nm below 380 extrapolate, as in OSL.
    if !(place > -1.0 && place < 80.0) {
        return [0.0; 3];
    }
    let first = place as usize;
    let t = place - first as f32;
    let xyz = [0, 1, 2].map(|k| CIE_1931[first][k] * (1.0 - t) + CIE_1931[first + 1][k] * t);
    without_negatives(times(xyz, &space.matrices().from_xyz).map(|c| c * (1.0 / 2.52)))
}

/// The change of [`wavelength_color`] when the wavelength changes by a nanometre; 0 where a channel is.
pub fn wavelength_color_slope(space: WorkingSpace, nanometres: f32) -> [f32; 3] {
    let place = (nanometres - 380.0) / 5.0;
    if !(place > -1.0 && place < 80.0) {
        return [0.0; 3];
    }
    let first = place as usize;
    let xyz = [0, 1, 2].map(|k| (CIE_1931[first + 1][k] - CIE_1931[first][k]) / 5.0);
    let (value, slope) = (wavelength_color(space, nanometres), times(xyz, &space.matrices().from_xyz));
    [0, 1, 2].map(|k| if value[k] > 0.0 { slope[k] * (1.0 / 2.52) } else { 0.0 })
}

/// A colour space that [`transformc`] knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorSpace {
    /// Linear RGB: `rgb`, `RGB`, `linear`, `Rec709`.
    Rgb,
    /// Hue, saturation, value.
    Hsv,
    /// Hue, saturation, lightness.
    Hsl,
    /// NTSC luma and chroma.
    Yiq,
    /// CIE XYZ.
    Xyz,
    /// CIE chromaticity and luminance.
    XyY,
    /// RGB with the transfer curve of sRGB.
    Srgb,
}

impl ColorSpace {
    /// The space of this name.
    pub fn from_name(name: &str) -> Option<ColorSpace> {
        Some(match name {
            "rgb" | "RGB" | "linear" | "Rec709" => ColorSpace::Rgb,
            "hsv" => ColorSpace::Hsv,
            "hsl" => ColorSpace::Hsl,
            "YIQ" => ColorSpace::Yiq,
            "XYZ" => ColorSpace::Xyz,
            "xyY" => ColorSpace::XyY,
            "sRGB" => ColorSpace::Srgb,
            _ => return None,
        })
    }
}

/// A colour in another space, where RGB is that of the working space.
pub fn transformc(space: WorkingSpace, from: ColorSpace, to: ColorSpace, c: [f32; 3]) -> [f32; 3] {
    let rgb = match from {
        ColorSpace::Rgb => c,
        ColorSpace::Hsv => hsv_to_rgb(c),
        ColorSpace::Hsl => hsl_to_rgb(c),
        ColorSpace::Yiq => times(c, &YIQ_TO_RGB),
        ColorSpace::Xyz => times(c, &space.matrices().from_xyz),
        ColorSpace::XyY => times(xyy_to_xyz(c), &space.matrices().from_xyz),
        ColorSpace::Srgb => c.map(srgb_to_linear),
    };
    match to {
        ColorSpace::Rgb => rgb,
        ColorSpace::Hsv => rgb_to_hsv(rgb),
        ColorSpace::Hsl => rgb_to_hsl(rgb),
        ColorSpace::Yiq => times(rgb, &RGB_TO_YIQ),
        ColorSpace::Xyz => times(rgb, &space.matrices().to_xyz),
        ColorSpace::XyY => xyz_to_xyy(times(rgb, &space.matrices().to_xyz)),
        ColorSpace::Srgb => rgb.map(linear_to_srgb),
    }
}

/// One channel of sRGB in linear light (IEC 61966-2-1).
#[inline(always)]
pub fn srgb_to_linear(x: f32) -> f32 {
    let curve = pow_positive((x + 0.055) * (1.0 / 1.055), 2.4);
    if x > 0.04045 { curve } else { x * (1.0 / 12.92) }
}

/// One linear channel with the transfer curve of sRGB (IEC 61966-2-1).
#[inline(always)]
pub fn linear_to_srgb(x: f32) -> f32 {
    let curve = 1.055 * pow_positive(x, 1.0 / 2.4) - 0.055;
    if x > 0.003_130_8 { curve } else { 12.92 * x }
}

/// Hue, saturation, value to RGB (Smith 1978); hues repeat after 1.
pub fn hsv_to_rgb([h, s, v]: [f32; 3]) -> [f32; 3] {
    if s < 0.0001 {
        return [v; 3];
    }
    let sixth = 6.0 * (h - floor(h));
    let sector = floor(sixth);
    let f = sixth - sector;
    let (p, q, t) = (v * (1.0 - s), v * (1.0 - s * f), v * (1.0 - s * (1.0 - f)));
    match sector as i32 {
        0 => [v, t, p],
        1 => [q, v, p],
        2 => [p, v, t],
        3 => [p, q, v],
        4 => [t, p, v],
        _ => [v, p, q],
    }
}

/// RGB to hue, saturation, value (Smith 1978); greys have hue 0.
pub fn rgb_to_hsv([r, g, b]: [f32; 3]) -> [f32; 3] {
    let least = min(r, min(g, b));
    let value = max(r, max(g, b));
    let chroma = value - least;
    let saturation = if value > 0.0 { chroma / value } else { 0.0 };
    if saturation <= 0.0 {
        return [0.0, saturation, value];
    }
    let (start, x, y) = if r >= value {
        (0.0, g, b)
    } else if g >= value {
        (1.0 / 3.0, b, r)
    } else {
        (2.0 / 3.0, r, g)
    };
    let hue = start + (x - y) / (6.0 * chroma);
    [if hue < 0.0 { hue + 1.0 } else { hue }, saturation, value]
}

/// Hue, saturation, lightness to RGB, by way of value.
pub fn hsl_to_rgb([h, s, l]: [f32; 3]) -> [f32; 3] {
    let value = if l <= 0.5 { l * (1.0 + s) } else { l * (1.0 - s) + s };
    if value <= 0.0 {
        return [0.0; 3];
    }
    let least = 2.0 * l - value;
    hsv_to_rgb([h, (value - least) / value, value])
}

/// RGB to hue, saturation, lightness; greys have hue and saturation 0.
pub fn rgb_to_hsl(rgb: [f32; 3]) -> [f32; 3] {
    let least = min(rgb[0], min(rgb[1], rgb[2]));
    let [hue, _, value] = rgb_to_hsv(rgb);
    let lightness = (least + value) / 2.0;
    let range = if lightness <= 0.5 { value + least } else { 2.0 - value - least };
    let saturation = if least == value { 0.0 } else { (value - least) / range };
    [hue, saturation, lightness]
}

/// XYZ to chromaticity and luminance; black has chromaticity (0, 0).
pub fn xyz_to_xyy([x, y, z]: [f32; 3]) -> [f32; 3] {
    let sum = x + y + z;
    let scale = if sum >= 1e-6 { 1.0 / sum } else { 0.0 };
    [x * scale, y * scale, y]
}

/// Chromaticity and luminance to XYZ; a chromaticity with y = 0 has only its luminance.
pub fn xyy_to_xyz([x, y, luminance]: [f32; 3]) -> [f32; 3] {
    let scale = if y > 1e-6 { luminance / y } else { 0.0 };
    [scale * x, luminance, scale * (1.0 - x - y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const REC: WorkingSpace = WorkingSpace::Rec709;

    const SPACES: [&str; 7] = ["rgb", "hsv", "hsl", "YIQ", "XYZ", "xyY", "sRGB"];

    #[track_caller]
    fn near(got: [f32; 3], want: [f32; 3], tolerance: f32) {
        for k in 0..3 {
            assert!((got[k] - want[k]).abs() <= tolerance * want[k].abs().max(1.0), "{got:?} but {want:?}");
        }
    }

    #[test]
    fn spaces_go_there_and_back() {
        for c in [[0.2, 0.5, 0.7], [0.9, 0.1, 0.3], [0.4, 0.4, 0.4], [0.02, 0.9, 0.6], [0.001, 0.002, 0.003]] {
            for name in SPACES {
                let space = ColorSpace::from_name(name).expect("all seven are known");
                let back = transformc(REC, space, ColorSpace::Rgb, transformc(REC, ColorSpace::Rgb, space, c));
                // The inverse of YIQ has four digits.
                near(back, c, if name == "YIQ" { 1e-3 } else { 2e-6 });
            }
        }
        assert_eq!(ColorSpace::from_name("ACEScg"), None);
    }

    #[test]
    fn known_colours() {
        near(hsv_to_rgb([1.0 / 3.0, 1.0, 1.0]), [0.0, 1.0, 0.0], 1e-6);
        near(rgb_to_hsv([0.0, 0.0, 0.5]), [2.0 / 3.0, 1.0, 0.5], 1e-6);
        near(rgb_to_hsl([1.0, 0.0, 0.0]), [0.0, 1.0, 0.5], 1e-6);
        near(transformc(REC, ColorSpace::Rgb, ColorSpace::XyY, [1.0; 3]), [0.3127, 0.3291, 1.0], 1e-5);
        near([srgb_to_linear(0.5); 3], [0.214_041_14; 3], 1e-6);
        near([linear_to_srgb(0.214_041_14); 3], [0.5; 3], 1e-6);
    }

    #[test]
    fn black_bodies_glow() {
        assert_eq!(blackbody(REC, 300.0), [1e-6, 0.0, 0.0]);
        for kelvin in [1000.0, 2700.0, 5000.0, 6504.0, 11_999.0] {
            near(blackbody(REC, kelvin), blackbody_by_integral(REC, kelvin), 1e-3);
        }
        let white = blackbody(REC, 6504.0);
        assert!((white[0] / white[2] - 1.0).abs() < 0.05, "6504 K is nearly the white of Rec. 709: {white:?}");
        for kelvin in [f32::NAN, f32::INFINITY, -1.0, 800.0, 12_000.0, 1e30] {
            let _ = blackbody(REC, kelvin);
        }
    }

    #[test]
    fn wavelengths_have_their_colours() {
        let [red, green, blue] = [650.0, 530.0, 450.0].map(|x| wavelength_color(REC, x));
        assert!(red[0] > 5.0 * red[1] && green[1] > green[0] && blue[2] > blue[0]);
        for nanometres in [379.0, 100.0, 780.0, f32::NAN, f32::INFINITY] {
            assert!(wavelength_color(REC, nanometres)[0] < 1e-3);
        }
    }
}
