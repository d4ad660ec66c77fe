//! The background: a constant, or a shader with an importance table over directions of equal area.

use crate::math::elementary::{atan2, sincos};
use glam::Vec3;
use std::f32::consts::PI;

/// What rays see that hit nothing.
#[derive(Clone, Debug)]
pub enum Sky {
    /// One radiance for all directions; zero when there is no background.
    Constant(Vec3),
    /// A shader, and a table when it is to be sampled.
    Shader {
        /// Index of the material.
        material: usize,
        /// The table.
        table: Option<SkyTable>,
    },
}

/// A table that samples directions by the brightness of the background.
///
/// Cell (x, y) holds the directions with azimuth 2 pi (x..x+1)/n around z and z = 1 - 2 (y..y+1)/n, all cells of one
/// solid angle. Only the density comes from the table; radiance comes from the shader itself at each direction.
///
/// Differs from OSL: testrender lights indirect rays by the table's cells, so its picture depends on their number.
#[derive(Clone, Debug, Default)]
pub struct SkyTable {
    side: usize,
    rows: Vec<f32>,
    columns: Vec<f32>,
    density: Vec<f32>,
}

impl SkyTable {
    /// The direction of a point of the table, in cells.
    pub fn direction(side: usize, x: f32, y: f32) -> Vec3 {
        let (sin, cos) = sincos(2.0 * PI * x / side as f32);
        let z = 1.0 - 2.0 * y / side as f32;
        let ring = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(ring * cos, ring * sin, z)
    }

    /// A table from the brightness of each cell, rows first; `None` when all of it is black.
    pub fn new(side: usize, brightness: &[f32]) -> Option<Self> {
        let clean = |b: f32| if b.is_finite() && b > 0.0 { f64::from(b) } else { 0.0 };
        let total: f64 = brightness.iter().map(|b| clean(*b)).sum();
        if total <= 0.0 {
            return None;
        }
        // A cell is judged by its centre alone, so a hundredth of the mean is added: no direction is left out.
        let floor = 0.01 * total / brightness.len() as f64;
        let sum = total + floor * brightness.len() as f64;
        let mut table = SkyTable { side, ..Self::default() };
        let mut above = 0.0f64;
        for row in brightness.chunks_exact(side) {
            let weight: f64 = row.iter().map(|b| clean(*b) + floor).sum();
            let mut left = 0.0f64;
            for b in row {
                left += clean(*b) + floor;
                table.columns.push((left / weight) as f32);
            }
            above += weight;
            table.rows.push((above / sum) as f32);
        }
        let per_cell = (side * side) as f32 / (4.0 * PI);
        for y in 0..side {
            let of_row = step(&table.rows, y);
            let row = &table.columns[y * side..(y + 1) * side];
            table.density.extend((0..side).map(|x| of_row * step(row, x) * per_cell));
        }
        Some(table)
    }

    /// A direction and its density over solid angle.
    #[inline]
    pub fn sample(&self, x: f32, y: f32) -> (Vec3, f32) {
        let (row, fy) = search(&self.rows, y);
        let (column, fx) = search(&self.columns[row * self.side..(row + 1) * self.side], x);
        let direction = Self::direction(self.side, column as f32 + fx, row as f32 + fy);
        (direction, self.density[row * self.side + column])
    }

    /// The density with which `sample` gives `direction`.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let turn = atan2(direction.y, direction.x) / (2.0 * PI);
        let turn = if turn < 0.0 { turn + 1.0 } else { turn };
        let cell = |x: f32| ((x * self.side as f32) as usize).min(self.side - 1);
        self.density[cell((1.0 - direction.z) * 0.5) * self.side + cell(turn)]
    }
}

/// The probability of entry `i` of running sums.
fn step(sums: &[f32], i: usize) -> f32 {
    sums[i] - if i > 0 { sums[i - 1] } else { 0.0 }
}

/// The entry that `x` falls into, and how far into it.
fn search(sums: &[f32], x: f32) -> (usize, f32) {
    let i = sums.partition_point(|s| *s <= x).min(sums.len() - 1);
    let before = if i > 0 { sums[i - 1] } else { 0.0 };
    (i, ((x - before) / step(sums, i)).clamp(0.0, 1.0 - f32::EPSILON / 2.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_fall_where_the_density_says() {
        let brightness: Vec<f32> = (0..32 * 32).map(|i| if i % 7 == 0 { 5.0 } else { (i % 5) as f32 }).collect();
        let table = SkyTable::new(32, &brightness).unwrap();
        let (mut inverse, n) = (0.0f64, 1 << 16);
        for i in 0..n {
            let r = crate::render::random::sample(9, i, 0);
            let (direction, pdf) = table.sample(r[0], r[1]);
            assert!((direction.length() - 1.0).abs() < 1e-5);
            // A direction on a cell's edge may round into its neighbour, so agreement is asked of the mean.
            inverse += 1.0
                / f64::from(if (table.pdf(direction) - pdf).abs() < 1e-3 * pdf { pdf } else { table.pdf(direction) });
        }
        // The mean of 1/pdf is the solid angle of all directions.
        assert!((inverse / f64::from(n) / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.02);
    }
}
