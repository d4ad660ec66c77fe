//! The directional albedo of the sheen from a look-up table, as the paper has it: to compare with, and for who wants it.
//!
//! Nodes lie evenly in the cube root of the cosine and in log r, on which the albedo is nearly straight; a table on even axes of
//! the cosine and of r of this size errs by 0.1. It is filled at its first use, from the long polynomials.

use super::fits::{ALBEDO_EXACT_LONG, ALBEDO_EXACT_SOFT_LONG, CURVE, CURVE_COLUMNS, CurveFit};
use crate::math::polynomial::chebyshev;
use std::sync::LazyLock;

/// Cells in the cube root of the cosine.
const ACROSS: usize = 32;
/// Cells in log r.
const DOWN: usize = 24;

type Table = [[f32; ACROSS + 1]; DOWN + 1];

/// Without and with a softened terminator.
static TABLES: LazyLock<[Table; 2]> = LazyLock::new(|| [filled(&ALBEDO_EXACT_LONG), filled(&ALBEDO_EXACT_SOFT_LONG)]);

fn filled(fit: &CurveFit) -> Table {
    // Both axes of the fits run from -1 to 1.
    let place = |k: usize, cells: usize| 2.0 * k as f32 / cells as f32 - 1.0;
    std::array::from_fn(|row| {
        let curve: [f32; CURVE] = std::array::from_fn(|k| chebyshev::<CURVE_COLUMNS>(&fit[k], place(row, DOWN)));
        std::array::from_fn(|column| chebyshev::<CURVE>(&curve, place(column, ACROSS)).clamp(0.0, 1.0))
    })
}

/// The albedo at places -1..1 of both axes, as the polynomials take them.
///
/// Gives: linear interpolation in both; error at most 2.9e-3 (softened, at r = 0.01 and cosines of 2e-4) and 1.4e-3 (not).
#[inline(always)]
pub fn look_up(soft: bool, cosine: f32, roughness: f32) -> f32 {
    let table = &TABLES[usize::from(soft)];
    let x = (0.5 + 0.5 * cosine).clamp(0.0, 1.0) * ACROSS as f32;
    let y = (0.5 + 0.5 * roughness).clamp(0.0, 1.0) * DOWN as f32;
    let (i, j) = ((x as usize).min(ACROSS - 1), (y as usize).min(DOWN - 1));
    let (a, b) = (x - i as f32, y - j as f32);
    let low = table[j][i] * (1.0 - a) + table[j][i + 1] * a;
    let high = table[j + 1][i] * (1.0 - a) + table[j + 1][i + 1] * a;
    low * (1.0 - b) + high * b
}
