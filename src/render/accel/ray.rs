//! Rays and hits, as whoever asks the hierarchy and whatever answers see them.

use glam::Vec3;

/// Stands for no primitive.
pub const NOTHING: u32 = u32::MAX;

/// A ray, and what it does not meet.
///
/// A ray whose origin or direction has a number that is not finite, or whose reach is NaN, meets nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes, of unit length.
    pub direction: Vec3,
    /// How far it goes; may be infinite.
    pub reach: f32,
    /// The primitive it starts on, or `NOTHING`.
    pub skip: u32,
    /// The primitive it goes to, which it does not meet, or `NOTHING`.
    pub target: u32,
}

impl Ray {
    /// A ray without end from a point in the open.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Ray { origin, direction, reach: f32::INFINITY, skip: NOTHING, target: NOTHING }
    }
}

/// The closest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance; infinite when nothing is hit.
    pub t: f32,
    /// The primitive, or `NOTHING`.
    pub primitive: u32,
    /// Quad: fraction of `edge_x`. Triangle: weight of b. Sphere: 0.
    pub u: f32,
    /// Quad: fraction of `edge_y`. Triangle: weight of c. Sphere: 0.
    pub v: f32,
}

impl Hit {
    /// Nothing is hit.
    pub const NONE: Hit = Hit { t: f32::INFINITY, primitive: NOTHING, u: 0.0, v: 0.0 };
}

/// Rays of somebody who wants an answer to each: the closest hit (`Hit`), or whether anything is in the way (`bool`).
///
/// Whoever asks keeps its rays in a form of its own, and they are read where they lie: to copy them into a list first, and
/// the answers out of one, took a tenth of the time of figure 1.
pub trait Questions<Answer> {
    /// How many rays there are.
    fn count(&self) -> usize;
    /// One of them.
    fn ray(&self, number: usize) -> Ray;
    /// Takes the answer to one. The surface coordinates of a sphere mean nothing.
    fn answer(&mut self, number: usize, answer: Answer);
}

/// Rays and answers in lists beside each other.
#[derive(Debug)]
pub struct Lists<'a, Answer> {
    /// The rays.
    pub rays: &'a [Ray],
    /// As many answers.
    pub answers: &'a mut [Answer],
}

impl<Answer> Questions<Answer> for Lists<'_, Answer> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.rays.len()
    }

    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        self.rays[number]
    }

    #[inline(always)]
    fn answer(&mut self, number: usize, answer: Answer) {
        self.answers[number] = answer;
    }
}
