//! Labels: a line of text as a picture.

use crate::measure::chart::draw::register_fonts;
use crate::render::Image;
use plotters::backend::BitMapBackend;
use plotters::drawing::IntoDrawingArea;
use plotters::element::Text;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{IntoFont, WHITE};

/// Linear light of the letters, and of what they stand on.
const INK: f32 = 0.75;
const GROUND: f32 = 0.012;
/// Widths of a letter's height that a letter takes, about.
const WIDE: f64 = 0.55;
/// Letters of a label; a cell has no room for more.
const LETTERS: usize = 80;

/// How high the label below a picture of a width is, in pixels.
pub fn label_height(width: u32) -> u32 {
    (width / 11).clamp(14, 48)
}

/// How many dots of each side are averaged to a pixel, because `plotters` puts letters onto whole dots.
const FINE: u32 = 4;

/// The text in the middle of a picture of a size; smaller where it is long.
pub fn label(text: &str, [width, height]: [u32; 2], channels: usize) -> Result<Image, String> {
    let covered =
        coverage(text, [width, height]).map_err(|error| format!("error: a label cannot be drawn: {error}"))?;
    let pixel = |covered: f32| {
        let light = GROUND + (INK - GROUND) * covered;
        [light, light, light, 1.0].into_iter().take(channels)
    };
    let pixels = covered.into_iter().flat_map(pixel).collect();
    Ok(Image { width, height, channels, pixels, about: Default::default() })
}

/// How much of each pixel the text covers.
fn coverage(text: &str, [width, height]: [u32; 2]) -> Result<Vec<f32>, String> {
    let text: String = text.chars().take(LETTERS).collect();
    let (wide, high) = (width * FINE, height * FINE);
    let mut bytes = vec![0u8; 3 * wide as usize * high as usize];
    {
        register_fonts()?;
        let root = BitMapBackend::with_buffer(&mut bytes, (wide, high)).into_drawing_area();
        let fits = f64::from(wide) / (WIDE * text.chars().count().max(1) as f64);
        let size = fits.min(0.72 * f64::from(high));
        let style = ("sans-serif", size).into_font().color(&WHITE).pos(Pos::new(HPos::Center, VPos::Center));
        root.draw(&Text::new(text, (wide as i32 / 2, high as i32 / 2), style)).map_err(|error| error.to_string())?;
        root.present().map_err(|error| error.to_string())?;
    }
    let mut covered = vec![0.0; width as usize * height as usize];
    for (dot, bytes) in bytes.chunks_exact(3).enumerate() {
        let [x, y] = [dot % wide as usize, dot / wide as usize].map(|n| n / FINE as usize);
        covered[y * width as usize + x] += f32::from(bytes[0]) / (255 * FINE * FINE) as f32;
    }
    Ok(covered)
}
