//! How linear light becomes the bytes of a screen: exposure, then a view.
//!
//! Decision (2026-11-30): the default view of PNGs leaves what is below .6 as sRGB has it and rolls off above, because pictures then keep
//! their colors and lamps their form; instead of sRGB, in which all above 1 is one flat white, and of AgX, which changes every color.

use super::image::Image;
use crate::math::elementary::{exp2, log2, pow, pow_positive};
use rayon::prelude::*;
use std::str::FromStr;

/// What becomes of light that a screen cannot show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum View {
    /// sRGB, with a shoulder: what is above .6 nears 1 and, the brighter it is, white.
    #[default]
    Soft,
    /// sRGB (IEC 61966-2-1), clipped to 0 to 1.
    Srgb,
    /// AgX (Sobotka 2023), its base look: 10 stops below and 6.5 above middle grey.
    Agx,
    /// The numbers as they are, clipped to 0 to 1.
    Linear,
}

impl View {
    /// All variants with the word that selects them.
    pub const ALL: [(&'static str, View); 4] =
        [("soft", View::Soft), ("srgb", View::Srgb), ("agx", View::Agx), ("linear", View::Linear)];
}

impl FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(name, _)| *name == text);
        let unknown = || format!("unknown view \"{text}\"; take \"soft\", \"srgb\", \"agx\" or \"linear\"");
        found.map(|&(_, v)| v).ok_or_else(unknown)
    }
}

/// How a picture is shown in eight bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Screen {
    /// Stops by which light is raised (2 for each) before it is looked at.
    pub exposure: f32,
    /// The view.
    pub view: View,
}

impl Screen {
    /// A linear color as a screen shows it, encoded, each number in [0, 1].
    pub fn encode(&self, color: [f32; 3]) -> [f32; 3] {
        self.encode_scaled(color, exp2(self.exposure))
    }

    fn encode_scaled(&self, color: [f32; 3], scale: f32) -> [f32; 3] {
        // A picture may hold what overflows here.
        let color = color.map(|c| (c * scale).clamp(0.0, f32::MAX));
        match self.view {
            View::Soft => soft(color).map(srgb),
            View::Srgb => color.map(srgb),
            View::Agx => agx(color),
            View::Linear => color.map(|c| c.min(1.0)),
        }
    }

    /// The bytes of a picture, as many a pixel as it has channels; alpha is linear, and colors are no longer multiplied by it.
    pub fn bytes(&self, image: &Image) -> Vec<u8> {
        let (channels, scale) = (image.channels, exp2(self.exposure));
        let byte = |x: f32| (x * 255.0 + 0.5) as u8;
        let encode = |pixel: &[f32]| -> [u8; 4] {
            let alpha = pixel.get(3).map_or(1.0, |a| a.clamp(0.0, 1.0));
            let scale = if alpha > 0.0 { scale / alpha } else { 0.0 };
            let [r, g, b] = self.encode_scaled([pixel[0], pixel[1], pixel[2]], scale).map(byte);
            [r, g, b, byte(alpha)]
        };
        let mut bytes = vec![0; image.pixels.len()];
        let both = bytes.par_chunks_mut(channels << 12).zip(image.pixels.par_chunks(channels << 12));
        both.for_each(|(bytes, pixels)| {
            for (bytes, pixel) in bytes.chunks_exact_mut(channels).zip(pixels.chunks_exact(channels)) {
                bytes.copy_from_slice(&encode(pixel)[..channels]);
            }
        });
        bytes
    }
}

/// Where the shoulder begins: some .8 of the screen's range.
const KNEE: f32 = 0.6;

/// Light with a shoulder: the brightest channel nears 1 as x / (1 + x) does, smoothly from the knee on, the others keep their shares of it
/// and near it themselves by the square of how far the shoulder is gone up.
fn soft(color: [f32; 3]) -> [f32; 3] {
    let peak = color.into_iter().fold(0.0, f32::max);
    if peak <= KNEE {
        return color;
    }
    // Halves, because the brightest numbers would overflow.
    let up = (peak - KNEE) / (peak + (1.0 - 2.0 * KNEE));
    let bright = KNEE + (1.0 - KNEE) * up;
    let pale = up * up;
    color.map(|c| {
        let kept = bright * (c / peak);
        kept + (bright - kept) * pale
    })
}

/// The transfer curve of IEC 61966-2-1, clipped to [0, 1].
pub(crate) fn srgb(linear: f32) -> f32 {
    let x = linear.clamp(0.0, 1.0);
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * pow(x, 1.0 / 2.4) - 0.055 }
}

/// AgX: colors drawn together, then stops around middle grey through a curve of slope 2 at its pivot, then apart again.
///
/// Source: Sobotka 2023, <https://github.com/sobotka/AgX>: its matrix, and its curve in closed form instead of the table of 4096.
fn agx(color: [f32; 3]) -> [f32; 3] {
    /// Stops of middle grey, .18, and below and above it.
    const GREY: f32 = -2.473_931_2;
    const RANGE: [f32; 2] = [-10.0, 6.5];
    const INSET: [[f32; 3]; 3] = [
        [0.842_401, 0.078_436_5, 0.079_162_43],
        [0.042_401_07, 0.878_436_5, 0.079_162_43],
        [0.042_401_07, 0.078_436_5, 0.879_162_43],
    ];
    const OUTSET: [[f32; 3]; 3] = [
        [1.196_998_7, -0.098_045_63, -0.098_953_03],
        [-0.053_001_34, 1.151_954_4, -0.098_953_03],
        [-0.053_001_34, -0.098_045_63, 1.151_047],
    ];
    let by = |m: &[[f32; 3]; 3], c: [f32; 3]| m.map(|row| row[0] * c[0] + row[1] * c[1] + row[2] * c[2]);
    let seen = by(&INSET, color).map(|c| {
        let stops = log2(c.clamp(f32::MIN_POSITIVE, f32::MAX)) - GREY;
        agx_curve(((stops - RANGE[0]) / (RANGE[1] - RANGE[0])).clamp(0.0, 1.0))
    });
    by(&OUTSET, seen).map(|c| c.clamp(0.0, 1.0))
}

/// From 0 to 1, through (20/33, 1/2) with slope 2, with a toe of power 3 and a shoulder of power 3.25 that end where the range does.
fn agx_curve(x: f32) -> f32 {
    const PIVOT: f32 = 20.0 / 33.0;
    let (power, end) = if x < PIVOT { (3.0, PIVOT) } else { (3.25, 1.0 - PIVOT) };
    let bend = (pow_positive(4.0 * end, power) - 1.0) / pow_positive(end, power);
    let from = x - PIVOT;
    0.5 + 2.0 * from * pow(1.0 + bend * pow(from.abs(), power), -1.0 / power)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SRGB: Screen = Screen { exposure: 0.0, view: View::Srgb };

    #[test]
    fn below_the_knee_soft_is_srgb_and_above_it_never_clips() {
        for i in 0..=600 {
            let c = [i as f32 / 1000.0, 0.3 * i as f32 / 1000.0, 0.0];
            assert_eq!(Screen::default().encode(c), SRGB.encode(c));
        }
        let mut before = [0.0; 3];
        for i in 0..400 {
            let x = 0.59 * exp2(i as f32 / 40.0);
            let now = Screen::default().encode([x, 0.5 * x, 0.1 * x]);
            // No step, no way back, no clipping below ten stops.
            assert!(
                (0..3).all(|k| now[k] >= before[k] && (i == 0 || now[k] - before[k] < 0.02) && now[k] < 1.0),
                "{x} {now:?}"
            );
            before = now;
        }
        assert!(before.iter().all(|c| *c > 0.97), "a lamp is white: {before:?}");
        assert!(Screen::default().encode([f32::MAX; 3]).iter().all(|c| *c > 0.9999 && *c <= 1.0));
        assert_eq!(Screen::default().encode([-1.0, 0.0, 0.0]), [0.0; 3]);
    }

    #[test]
    fn exposure_doubles_light_a_stop() {
        for view in View::ALL.map(|(_, view)| view) {
            let stops = |exposure| Screen { exposure, view };
            assert_eq!(stops(1.0).encode([0.1, 0.2, 0.3]), stops(0.0).encode([0.2, 0.4, 0.6]));
            assert_eq!(stops(-3.0).encode([0.8, 2.0, 8.0]), stops(0.0).encode([0.1, 0.25, 1.0]));
        }
    }

    #[test]
    fn agx_is_that_of_its_table() {
        // From the closed form in f64: middle grey is at the pivot, and the ends of the range are black and white.
        let agx = |x: f32| Screen { exposure: 0.0, view: View::Agx }.encode([x; 3]);
        for (x, expected) in [(0.18, 0.5), (0.18 / 1024.0, 0.0), (0.18 * 90.51, 1.0), (1.0, 0.787_52), (0.01, 0.096_15)]
        {
            let found = agx(x);
            assert!(found.iter().all(|c| (c - expected).abs() < 1e-4), "{x}: {found:?}, not {expected}");
        }
        let [r, g, b] = Screen { exposure: 0.0, view: View::Agx }.encode([20.0, 0.0, 0.0]);
        assert!(r > g && g > 0.3 && b > 0.3, "a bright red pales: {r} {g} {b}");
    }

    #[test]
    fn alpha_is_kept_apart_from_color() {
        let image =
            Image { width: 1, height: 1, channels: 4, pixels: vec![0.1, 0.2, 0.25, 0.5], about: Default::default() };
        let [r, g, b] = SRGB.encode([0.2, 0.4, 0.5]).map(|x| (x * 255.0 + 0.5) as u8);
        assert_eq!(SRGB.bytes(&image), [r, g, b, 128]);
    }
}
