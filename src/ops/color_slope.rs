//! Derivatives of [`super::color::transformc`]: how the result moves when the colour moves.
//!
//! Each function gives the change of its namesake in [`super::color`] at a place and for a direction there. At the
//! edges where formulas meet, it is the change on the side that the value is computed on.

use super::arithmetic::{div, max, min};
use super::color::*;
use super::working_space::WorkingSpace;
use crate::math::elementary::{floor, pow_positive};

/// The change of `transformc(space, from, to, c)` when `c` moves by `d`.
pub fn transformc_slope(space: WorkingSpace, from: ColorSpace, to: ColorSpace, c: [f32; 3], d: [f32; 3]) -> [f32; 3] {
    let linear = |d: [f32; 3]| transformc(space, from, ColorSpace::Rgb, d);
    let to_rgb = match from {
        ColorSpace::Rgb => d,
        ColorSpace::Hsv => hsv_to_rgb_slope(c, d),
        ColorSpace::Hsl => hsl_to_rgb_slope(c, d),
        ColorSpace::Yiq | ColorSpace::Xyz => linear(d),
        ColorSpace::XyY => transformc(space, ColorSpace::Xyz, ColorSpace::Rgb, xyy_to_xyz_slope(c, d)),
        ColorSpace::Srgb => [0, 1, 2].map(|k| d[k] * srgb_slope(c[k])),
    };
    let rgb = transformc(space, from, ColorSpace::Rgb, c);
    match to {
        ColorSpace::Rgb => to_rgb,
        ColorSpace::Hsv => rgb_to_hsv_slope(rgb, to_rgb),
        ColorSpace::Hsl => rgb_to_hsl_slope(rgb, to_rgb),
        ColorSpace::Yiq | ColorSpace::Xyz => transformc(space, ColorSpace::Rgb, to, to_rgb),
        ColorSpace::XyY => {
            let xyz = |c| transformc(space, ColorSpace::Rgb, ColorSpace::Xyz, c);
            xyz_to_xyy_slope(xyz(rgb), xyz(to_rgb))
        }
        ColorSpace::Srgb => [0, 1, 2].map(|k| div(to_rgb[k], srgb_slope(linear_to_srgb(rgb[k])))),
    }
}

/// The slope of the curve from sRGB to linear light.
fn srgb_slope(x: f32) -> f32 {
    let curve = 2.4 / 1.055 * pow_positive((x + 0.055) * (1.0 / 1.055), 1.4);
    if x > 0.04045 { curve } else { 1.0 / 12.92 }
}

fn hsv_to_rgb_slope([h, s, v]: [f32; 3], [dh, ds, dv]: [f32; 3]) -> [f32; 3] {
    if s < 0.0001 {
        return [dv; 3];
    }
    let sixth = 6.0 * (h - floor(h));
    let sector = floor(sixth);
    let (f, df) = (sixth - sector, 6.0 * dh);
    let dp = dv * (1.0 - s) - v * ds;
    let dq = dv * (1.0 - s * f) - v * (ds * f + s * df);
    let dt = dv * (1.0 - s * (1.0 - f)) - v * (ds * (1.0 - f) - s * df);
    match sector as i32 {
        0 => [dv, dt, dp],
        1 => [dq, dv, dp],
        2 => [dp, dv, dt],
        3 => [dp, dq, dv],
        4 => [dt, dp, dv],
        _ => [dv, dp, dq],
    }
}

fn hsl_to_rgb_slope([h, s, l]: [f32; 3], [dh, ds, dl]: [f32; 3]) -> [f32; 3] {
    let (value, dvalue) = if l <= 0.5 {
        (l * (1.0 + s), dl * (1.0 + s) + l * ds)
    } else {
        (l * (1.0 - s) + s, dl * (1.0 - s) + ds * (1.0 - l))
    };
    if value <= 0.0 {
        return [0.0; 3];
    }
    let (range, drange) = (2.0 * (value - l), 2.0 * (dvalue - dl));
    let dsaturation = (drange - range / value * dvalue) / value;
    hsv_to_rgb_slope([h, range / value, value], [dh, dsaturation, dvalue])
}

/// Which components are the least and the greatest, in the order in which the conversions look.
fn extremes(rgb: [f32; 3]) -> (usize, usize) {
    let least = min(rgb[0], min(rgb[1], rgb[2]));
    let greatest = max(rgb[0], max(rgb[1], rgb[2]));
    let at = |value: f32| rgb.iter().position(|&c| c == value).unwrap_or(0);
    (at(least), at(greatest))
}

fn rgb_to_hsv_slope(rgb: [f32; 3], d: [f32; 3]) -> [f32; 3] {
    let (low, high) = extremes(rgb);
    let (chroma, dchroma) = (rgb[high] - rgb[low], d[high] - d[low]);
    let dsaturation = div(dchroma - div(chroma, rgb[high]) * d[high], rgb[high]);
    if chroma <= 0.0 || rgb[high] <= 0.0 {
        return [0.0, dsaturation, d[high]];
    }
    let (x, y) = ((high + 1) % 3, (high + 2) % 3);
    let dhue = (d[x] - d[y] - (rgb[x] - rgb[y]) / chroma * dchroma) / (6.0 * chroma);
    [dhue, dsaturation, d[high]]
}

fn rgb_to_hsl_slope(rgb: [f32; 3], d: [f32; 3]) -> [f32; 3] {
    let (low, high) = extremes(rgb);
    let (sum, dsum) = (rgb[high] + rgb[low], d[high] + d[low]);
    let (range, drange) = if sum <= 1.0 { (sum, dsum) } else { (2.0 - sum, -dsum) };
    let (chroma, dchroma) = (rgb[high] - rgb[low], d[high] - d[low]);
    let dsaturation = if low == high { 0.0 } else { div(dchroma - div(chroma, range) * drange, range) };
    [rgb_to_hsv_slope(rgb, d)[0], dsaturation, dsum / 2.0]
}

fn xyz_to_xyy_slope([x, y, z]: [f32; 3], [dx, dy, dz]: [f32; 3]) -> [f32; 3] {
    let (sum, dsum) = (x + y + z, dx + dy + dz);
    let scale = if sum >= 1e-6 { 1.0 / sum } else { 0.0 };
    [(dx - x * scale * dsum) * scale, (dy - y * scale * dsum) * scale, dy]
}

fn xyy_to_xyz_slope([x, y, l]: [f32; 3], [dx, dy, dl]: [f32; 3]) -> [f32; 3] {
    if y <= 1e-6 {
        return [0.0, dl, 0.0];
    }
    let (scale, dscale) = (l / y, (dl - l / y * dy) / y);
    let (z, dz) = (1.0 - x - y, -dx - dy);
    [scale * dx + dscale * x, dl, scale * dz + dscale * z]
}

#[cfg(test)]
mod tests {
    use super::*;

    const REC: WorkingSpace = WorkingSpace::Rec709;

    #[test]
    fn slopes_agree_with_differences() {
        let names = ["rgb", "hsv", "hsl", "YIQ", "XYZ", "xyY", "sRGB"];
        let places = [[0.3, 0.6, 0.45], [0.7, 0.2, 0.55], [0.15, 0.35, 0.3]];
        for (from, to) in names.iter().flat_map(|a| names.iter().map(move |b| (*a, *b))) {
            let (from, to) = (ColorSpace::from_name(from).unwrap(), ColorSpace::from_name(to).unwrap());
            for (c, d) in places.into_iter().flat_map(|c| [[1.0, 0.0, 0.0], [0.3, -0.7, 0.2]].map(|d| (c, d))) {
                // Beyond the gamut some formulas have poles that no difference can follow.
                if transformc(REC, from, ColorSpace::Rgb, c).iter().any(|&x| !(0.02..0.98).contains(&x)) {
                    continue;
                }
                let h = 1e-3;
                let at = |s: f32| transformc(REC, from, to, [0, 1, 2].map(|k| c[k] + s * d[k]));
                let (left, right, slope) = (at(-h), at(h), transformc_slope(REC, from, to, c, d));
                for k in 0..3 {
                    let want = (right[k] - left[k]) / (2.0 * h);
                    assert!(
                        (slope[k] - want).abs() < 3e-3 * (1.0 + want.abs()),
                        "{from:?} {to:?} {c:?} {d:?}: {slope:?}"
                    );
                }
            }
        }
    }
}
