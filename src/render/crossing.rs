//! What a path remembers while it passes clear surfaces, in scenes that have some.
//!
//! Light that passes straight on has not been scattered: its direction keeps the density that it was chosen with, seen from
//! where it was chosen, so that light found behind a pane and light sampled through it count once together.

use super::accel::NOTHING;
use super::path::Path;
use super::segment::Segment;

/// Of each path, one: which bounce it is on, and where it last scattered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Bounces behind it; passing straight on is none.
    pub bounces: u32,
    /// Clear surfaces behind it.
    pub passed: u32,
    /// The primitive that it last scattered at, or `NOTHING`.
    pub last: u32,
    /// How far from there the ray starts that it is on.
    pub since: f32,
}

/// A path that has passed so many clear surfaces ends, with a warning.
pub const MOST_PASSED: u32 = 1024;

impl Crossing {
    /// A path that leaves the camera.
    pub const START: Crossing = Crossing { bounces: 0, passed: 0, last: NOTHING, since: 0.0 };

    /// The segment from the place where the path last scattered to its hit, and the primitive it began on.
    pub fn whole(&self, path: &Path) -> (Segment, u32) {
        let mut segment = path.segment;
        segment.origin -= segment.direction * self.since;
        segment.hit.t += self.since;
        (segment, self.last)
    }
}
