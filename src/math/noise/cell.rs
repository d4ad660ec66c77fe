//! Cell noise, one random number a unit cell, and hash noise, one random number a position.
//!
//! Both hash integers: cell noise those of the cell, hash noise the bits of the coordinates. The vector variants hash the
//! component number along. Their derivatives are zero wherever they exist. Periodic variants: [`super::wrap`] first.

use super::lookup3::{hash1, hash2, hash3, hash4, hash5, to_unit};
use crate::math::elementary::floor_and_rest;

/// The three components that the last word of a hash selects.
#[inline(always)]
fn components(hash: impl Fn(u32) -> u32) -> [f32; 3] {
    [to_unit(hash(0)), to_unit(hash(1)), to_unit(hash(2))]
}

#[inline(always)]
fn cell(x: f32) -> u32 {
    floor_and_rest(x).0
}

/// Cell noise of one coordinate, in [0, 1].
#[inline(always)]
pub fn cell1(x: f32) -> f32 {
    to_unit(hash1(cell(x)))
}

/// Cell noise of two coordinates, in [0, 1].
#[inline(always)]
pub fn cell2(x: f32, y: f32) -> f32 {
    to_unit(hash2(cell(x), cell(y)))
}

/// Cell noise of three coordinates, in [0, 1].
#[inline(always)]
pub fn cell3(x: f32, y: f32, z: f32) -> f32 {
    to_unit(hash3(cell(x), cell(y), cell(z)))
}

/// Cell noise of four coordinates, in [0, 1].
#[inline(always)]
pub fn cell4(x: f32, y: f32, z: f32, w: f32) -> f32 {
    to_unit(hash4(cell(x), cell(y), cell(z), cell(w)))
}

/// Vector cell noise of one coordinate, each component in [0, 1].
#[inline(always)]
pub fn cell1_vector(x: f32) -> [f32; 3] {
    components(|c| hash2(cell(x), c))
}

/// Vector cell noise of two coordinates, each component in [0, 1].
#[inline(always)]
pub fn cell2_vector(x: f32, y: f32) -> [f32; 3] {
    components(|c| hash3(cell(x), cell(y), c))
}

/// Vector cell noise of three coordinates, each component in [0, 1].
#[inline(always)]
pub fn cell3_vector(x: f32, y: f32, z: f32) -> [f32; 3] {
    components(|c| hash4(cell(x), cell(y), cell(z), c))
}

/// Vector cell noise of four coordinates, each component in [0, 1].
#[inline(always)]
pub fn cell4_vector(x: f32, y: f32, z: f32, w: f32) -> [f32; 3] {
    components(|c| hash5(cell(x), cell(y), cell(z), cell(w), c))
}

/// Hash noise of one coordinate, in [0, 1]. The two zeros hash differently.
#[inline(always)]
pub fn hash1_noise(x: f32) -> f32 {
    to_unit(hash1(x.to_bits()))
}

/// Hash noise of two coordinates, in [0, 1].
#[inline(always)]
pub fn hash2_noise(x: f32, y: f32) -> f32 {
    to_unit(hash2(x.to_bits(), y.to_bits()))
}

/// Hash noise of three coordinates, in [0, 1].
#[inline(always)]
pub fn hash3_noise(x: f32, y: f32, z: f32) -> f32 {
    to_unit(hash3(x.to_bits(), y.to_bits(), z.to_bits()))
}

/// Hash noise of four coordinates, in [0, 1].
#[inline(always)]
pub fn hash4_noise(x: f32, y: f32, z: f32, w: f32) -> f32 {
    to_unit(hash4(x.to_bits(), y.to_bits(), z.to_bits(), w.to_bits()))
}

/// Vector hash noise of one coordinate, each component in [0, 1].
#[inline(always)]
pub fn hash1_vector(x: f32) -> [f32; 3] {
    components(|c| hash2(x.to_bits(), c))
}

/// Vector hash noise of two coordinates, each component in [0, 1].
#[inline(always)]
pub fn hash2_vector(x: f32, y: f32) -> [f32; 3] {
    components(|c| hash3(x.to_bits(), y.to_bits(), c))
}

/// Vector hash noise of three coordinates, each component in [0, 1].
#[inline(always)]
pub fn hash3_vector(x: f32, y: f32, z: f32) -> [f32; 3] {
    components(|c| hash4(x.to_bits(), y.to_bits(), z.to_bits(), c))
}

/// Vector hash noise of four coordinates, each component in [0, 1].
#[inline(always)]
pub fn hash4_vector(x: f32, y: f32, z: f32, w: f32) -> [f32; 3] {
    components(|c| hash5(x.to_bits(), y.to_bits(), z.to_bits(), w.to_bits(), c))
}
