//! The wavefront's memory: thousands of paths of one tile and all that the stages leave for each other.
//!
//! The stages are in `stages`, their order in `trace`. A path only ever adds to its own radiance, in the order of its own
//! bounces, so the sums do not depend on how paths were batched.

use super::accel::Hit;
use super::crossing::Crossing;
use super::lanes::{Draws, Lanes};
use super::light::LightLanes;
use super::path::{Dropped, Path, ShadowRay};
use super::segment::Segment;
use super::shading::Shading;
use super::world::World;
use crate::math::columns::Column3;
use glam::Vec3;
use std::ops::Range;

/// The paths of a tile and all scratch to advance them; nothing is allocated once it has grown.
pub struct Wave {
    /// The paths.
    pub paths: Vec<Path>,
    /// What the paths remember of clear surfaces, where the scene has any.
    pub crossings: Vec<Crossing>,
    /// From where light reached the point that each path has left, where lights are chosen by it.
    pub facings: Vec<Vec3>,
    /// Where in its pixel each path began, both in [0, 1].
    pub positions: Vec<[f32; 2]>,
    /// Paths still on their way.
    pub active: Vec<u32>,
    /// Those that go on to the next bounce.
    pub next: Vec<u32>,
    /// Of the active ones, those that hit nothing.
    pub missed: Vec<u32>,
    /// The others, by material.
    pub sorted: Sorted,
    /// The batch in work.
    pub lanes: Lanes,
    /// Its shaders and lobes.
    pub shading: Shading,
    /// Its samples of lights.
    pub lit: LightLanes,
    /// What a unit of their radiance adds, or what the batch's surfaces let through.
    pub weights: Column3,
    /// Shadow rays to lights.
    pub light_shadows: ShadowQueue,
    /// Shadow rays to the background.
    pub sky_shadows: ShadowQueue,
    /// What the camera's rays are made from.
    pub camera: CameraLanes,
    /// What had to be dropped.
    pub dropped: Dropped,
    /// Rays traced, of all kinds.
    pub traced: u64,
}

/// The hits of a bounce, by material.
#[derive(Debug, Default)]
pub struct Sorted {
    /// The paths, those of one material side by side.
    pub paths: Vec<u32>,
    /// The batches they are shaded in.
    pub batches: Vec<Batch>,
    /// The paths to be sorted.
    pub unsorted: Vec<u32>,
    /// Their materials.
    pub materials: Vec<u32>,
    /// By material, where its paths start.
    pub starts: Vec<u32>,
}

/// Paths that are shaded together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Batch {
    /// The material that all have hit.
    pub material: usize,
    /// Which of the sorted paths.
    pub lanes: Range<usize>,
}

/// Camera rays of one pixel, a sample a lane.
#[derive(Debug, Default)]
pub struct CameraLanes {
    /// The samples' random numbers.
    pub draws: Draws,
    /// The rays' unit directions.
    pub directions: Column3,
}

/// Shadow rays waiting to be traced, and what becomes of them.
#[derive(Debug, Default)]
pub struct ShadowQueue {
    /// The rays.
    pub rays: Vec<ShadowRay>,
    /// Those that nothing is in the way of.
    pub clear: Vec<u32>,
    /// Material and number of those that got through to a light that must be shaded.
    pub reached: Vec<(u32, u32)>,
    /// Of a batch of those, the segments.
    pub segments: Vec<Segment>,
    /// Those that are still on their way through clear surfaces.
    pub pending: Vec<u32>,
    /// Material, number and hit of those that have met a clear surface.
    pub crossed: Vec<(u32, u32, Hit)>,
}

impl ShadowQueue {
    /// Forgets all rays.
    fn clear(&mut self) {
        self.rays.clear();
        self.clear.clear();
        self.reached.clear();
        self.pending.clear();
        self.crossed.clear();
    }
}

impl Wave {
    /// Empty scratch.
    pub fn new(world: &World) -> Self {
        Wave {
            paths: Vec::new(),
            crossings: Vec::new(),
            facings: Vec::new(),
            positions: Vec::new(),
            active: Vec::new(),
            next: Vec::new(),
            missed: Vec::new(),
            sorted: Sorted::default(),
            lanes: Lanes::default(),
            shading: Shading::new(world.settings.closure, world.host.clone()),
            lit: LightLanes::default(),
            weights: Column3::default(),
            light_shadows: ShadowQueue::default(),
            sky_shadows: ShadowQueue::default(),
            camera: CameraLanes::default(),
            dropped: Dropped::default(),
            traced: 0,
        }
    }

    /// Forgets all paths.
    pub fn clear(&mut self) {
        self.paths.clear();
        self.crossings.clear();
        self.facings.clear();
        self.positions.clear();
        self.active.clear();
        self.next.clear();
        // Rays of a wave that was stopped in the middle would light paths of this one.
        self.light_shadows.clear();
        self.sky_shadows.clear();
    }

    /// Takes a batch of the sorted paths into work.
    pub fn take(&mut self, batch: usize, bounce: u32) {
        let Batch { material, lanes } = &self.sorted.batches[batch];
        (self.lanes.material, self.lanes.bounce) = (*material, bounce);
        self.lanes.paths.clear();
        self.lanes.paths.extend_from_slice(&self.sorted.paths[lanes.clone()]);
    }

    /// Goes on to the next bounce.
    pub fn advance(&mut self) {
        std::mem::swap(&mut self.active, &mut self.next);
        self.next.clear();
    }
}
