//! Columns: the values of many shading points, one array a component.

use glam::Vec3;

/// One of two words, picked by bits.
///
/// An `if` whose losing side is what a column held before becomes a masked store, which is slow on AMD's
/// processors: sampling a diffuse lobe took 7.6 times what it takes by hand with them, and takes 5.5 times so.
#[inline(always)]
pub fn pick_bits(condition: bool, yes: u32, no: u32) -> u32 {
    let mask = (condition as u32).wrapping_neg();
    (yes & mask) | (no & !mask)
}

/// One of two floats, picked by bits as [`pick_bits`] does.
#[inline(always)]
pub fn pick(condition: bool, yes: f32, no: f32) -> f32 {
    f32::from_bits(pick_bits(condition, yes.to_bits(), no.to_bits()))
}

/// Copies the lanes of a block of at most `BLOCK`, which both slices have.
///
/// A whole block has a known length, so that it takes a few moves and no call.
#[inline(always)]
pub fn copy_block<const BLOCK: usize>(to: &mut [f32], from: &[f32]) {
    match (<&mut [f32; BLOCK]>::try_from(&mut *to), <&[f32; BLOCK]>::try_from(from)) {
        (Ok(to), Ok(from)) => *to = *from,
        _ => to.copy_from_slice(from),
    }
}

/// Three columns that hold one triple a lane.
#[derive(Debug, Default, PartialEq)]
pub struct Column3 {
    /// First components.
    pub x: Vec<f32>,
    /// Second components.
    pub y: Vec<f32>,
    /// Third components.
    pub z: Vec<f32>,
}

impl Clone for Column3 {
    fn clone(&self) -> Self {
        Column3 { x: self.x.clone(), y: self.y.clone(), z: self.z.clone() }
    }

    /// Keeps the memory, which the derived function would give back and ask for again.
    fn clone_from(&mut self, from: &Self) {
        self.x.clone_from(&from.x);
        self.y.clone_from(&from.y);
        self.z.clone_from(&from.z);
    }
}

impl Column3 {
    /// A column of `len` zero triples.
    pub fn zeros(len: usize) -> Self {
        Column3 { x: vec![0.0; len], y: vec![0.0; len], z: vec![0.0; len] }
    }

    /// A column of `len` equal triples.
    pub fn splat(value: Vec3, len: usize) -> Self {
        Column3 { x: vec![value.x; len], y: vec![value.y; len], z: vec![value.z; len] }
    }

    /// The number of lanes.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// True when there is no lane.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Makes room for exactly `len` lanes; new ones are zero.
    pub fn resize(&mut self, len: usize) {
        self.x.resize(len, 0.0);
        self.y.resize(len, 0.0);
        self.z.resize(len, 0.0);
    }

    /// The triple of one lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    /// Stores the triple of one lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, value: Vec3) {
        self.x[lane] = value.x;
        self.y[lane] = value.y;
        self.z[lane] = value.z;
    }
}
