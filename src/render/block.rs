//! A few lanes at a time, a row a number, so that all rows of a step fit the registers or the nearest cache.

use crate::math::columns::Column3;
use glam::Vec3;

/// Lanes that are worked on at a time.
pub const WIDTH: usize = 16;
/// A number a lane.
pub type Row = [f32; WIDTH];
/// A triple a lane.
pub type Row3 = [Row; 3];

/// Stores the triple of a lane.
#[inline(always)]
pub fn set(rows: &mut Row3, lane: usize, v: Vec3) {
    (rows[0][lane], rows[1][lane], rows[2][lane]) = (v.x, v.y, v.z);
}

/// The triple of a lane.
#[inline(always)]
pub fn get(rows: &Row3, lane: usize) -> Vec3 {
    Vec3::new(rows[0][lane], rows[1][lane], rows[2][lane])
}

/// Copies the first `len` lanes of the rows to where `start` is in a column.
#[inline(always)]
pub fn store(column: &mut Column3, start: usize, len: usize, rows: &Row3) {
    column.x[start..start + len].copy_from_slice(&rows[0][..len]);
    column.y[start..start + len].copy_from_slice(&rows[1][..len]);
    column.z[start..start + len].copy_from_slice(&rows[2][..len]);
}

/// Copies `len` lanes from where `start` is in a column to the first of the rows.
#[inline(always)]
pub fn load(rows: &mut Row3, start: usize, len: usize, column: &Column3) {
    rows[0][..len].copy_from_slice(&column.x[start..start + len]);
    rows[1][..len].copy_from_slice(&column.y[start..start + len]);
    rows[2][..len].copy_from_slice(&column.z[start..start + len]);
}
