//! The wavefront: thousands of paths of one tile, advanced together, one bounce at a time.
//!
//! A bounce is: intersect all, add the background to what missed, sort the hits by material (stable, so that the order
//! of paths is kept), shade each material's hits in batches, trace the shadow rays that gave rise to. A path only ever
//! adds to its own radiance, in the order of its own bounces, so the sums do not depend on how paths were batched.

use super::accel::NOTHING;
use super::camera::directions;
use super::film::HALVES;
use super::lanes::Lanes;
use super::light::{LightLanes, power_heuristic};
use super::random;
use super::settings::LightStrategy;
use super::shading::{Shading, ray_type};
use super::shadow::ShadowQueue;
use super::surface::RayHitPoint;
use super::world::{Sky, World, fill_sky};
use crate::math::columns::Column3;
use glam::Vec3;

/// One path: its ray, what it carries, what it has gathered, and its last hit.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// The ray and its hit.
    pub hit: RayHitPoint,
    /// The primitive that the ray starts on.
    pub from: u32,
    /// What a unit of radiance met now adds to the sample.
    pub throughput: Vec3,
    /// Density of the ray's direction; infinite when there was no choice.
    pub pdf_solid_angle: f32,
    /// The sample so far.
    pub radiance: Vec3,
    /// The part of the sample that is not background; a clear surface may weigh more than 1, so only the mean of many
    /// samples is a share.
    pub alpha: f32,
    /// True while nothing but clear surfaces has been met.
    pub clear: bool,
    /// The pixel's scramble.
    pub seed: u32,
    /// The sample's number.
    pub index: u32,
}

impl Path {
    /// A path that leaves the camera.
    #[inline]
    fn new(world: &World, direction: Vec3, seed: u32, index: u32) -> Self {
        Path {
            hit: RayHitPoint {
                origin: world.camera.eye(),
                direction,
                t: f32::INFINITY,
                primitive: NOTHING,
                u: 0.0,
                v: 0.0,
                radius: 0.0,
                spread: if world.plan.cones { world.camera.spread(direction) } else { 0.0 },
                ray_type: ray_type::CAMERA,
            },
            from: NOTHING,
            throughput: Vec3::ONE,
            pdf_solid_angle: f32::INFINITY,
            radiance: Vec3::ZERO,
            alpha: 0.0,
            clear: true,
            seed,
            index,
        }
    }
}

/// Contributions that were not finite and therefore dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// How many.
    pub count: u64,
    /// The lowest material index that one came from, plus one; 0 when there is none.
    pub material: usize,
}

impl Dropped {
    /// Counts one more.
    pub fn add(&mut self, material: usize) {
        self.merge(&Dropped { count: 1, material: material + 1 });
    }

    /// Takes in another count. The lowest material is kept, so that the result does not depend on the order.
    pub fn merge(&mut self, other: &Dropped) {
        self.count += other.count;
        self.material = match (self.material, other.material) {
            (0, m) | (m, 0) => m,
            (a, b) => a.min(b),
        };
    }
}

/// The paths of a tile and all scratch to advance them; nothing is allocated once it has grown.
pub struct Wave {
    /// The paths.
    pub paths: Vec<Path>,
    /// Where in its pixel each path began.
    pub places: Vec<[f32; 2]>,
    /// Paths still on their way.
    pub active: Vec<u32>,
    /// Those that go on to the next bounce.
    pub next: Vec<u32>,
    missed: Vec<u32>,
    materials: Vec<u32>,
    sorted: Vec<u32>,
    starts: Vec<u32>,
    /// Shadow rays to lights.
    pub shadows: ShadowQueue,
    /// Shadow rays to the background.
    pub sky_shadows: ShadowQueue,
    /// Shaders and lobes.
    pub shading: Shading,
    /// The paths of the batch in work.
    pub lanes: Lanes,
    /// Samples of lights.
    pub lit: LightLanes,
    /// What a unit of their radiance adds.
    pub weights: Column3,
    /// What had to be dropped.
    pub dropped: Dropped,
    /// Rays traced, of all kinds.
    pub rays: u64,
}

impl Wave {
    /// Empty scratch.
    pub fn new(world: &World) -> Self {
        Wave {
            paths: Vec::new(),
            places: Vec::new(),
            active: Vec::new(),
            next: Vec::new(),
            missed: Vec::new(),
            materials: Vec::new(),
            sorted: Vec::new(),
            starts: Vec::new(),
            shadows: ShadowQueue::default(),
            sky_shadows: ShadowQueue::default(),
            shading: Shading::new(world.settings.closure, world.host.clone()),
            lanes: Lanes::default(),
            lit: LightLanes::default(),
            weights: Column3::default(),
            dropped: Dropped::default(),
            rays: 0,
        }
    }

    /// Starts `samples` of a pixel; call `clear` first.
    pub fn start(&mut self, world: &World, x: u32, y: u32, samples: std::ops::Range<u32>) {
        let settings = world.settings;
        let halves = settings.halves() as u32;
        let seeds: [u32; HALVES] = std::array::from_fn(|half| random::pixel_seed(settings.seed, x, y, half as u32));
        let lanes = &mut self.lanes;
        lanes.resize(samples.len());
        for (lane, sample) in samples.enumerate() {
            lanes.seeds[lane] = seeds[(sample % halves) as usize];
            lanes.indices[lane] = sample / halves;
        }
        match settings.jitter {
            true => lanes.draw(random::CAMERA, 2),
            false => lanes.numbers.iter_mut().for_each(|column| column.fill(0.5)),
        }
        let places = [lanes.numbers[0].as_slice(), lanes.numbers[1].as_slice()];
        directions(&world.camera, x as f32, y as f32, places, &mut lanes.throughput);
        for lane in 0..lanes.seeds.len() {
            self.places.push([places[0][lane], places[1][lane]]);
            self.active.push(self.paths.len() as u32);
            let direction = lanes.throughput.get(lane);
            self.paths.push(Path::new(world, direction, lanes.seeds[lane], lanes.indices[lane]));
        }
    }

    /// Forgets all paths.
    pub fn clear(&mut self) {
        self.paths.clear();
        self.places.clear();
        self.active.clear();
    }

    /// Follows all paths to their end.
    pub fn run(&mut self, world: &World) {
        let mut bounce = 0;
        while !self.active.is_empty() {
            self.intersect(world);
            self.background(world);
            self.sort(world, bounce);
            self.next.clear();
            let batch_width = world.settings.batch_width.clamp(1, crate::exec::MAX_LANES);
            for material in 0..self.starts.len() - 1 {
                let (mut from, end) = (self.starts[material] as usize, self.starts[material + 1] as usize);
                while from < end {
                    let to = end.min(from + batch_width);
                    // Lent out and given back, so that the batch can use all of the wave.
                    let sorted = std::mem::take(&mut self.sorted);
                    self.shade_batch(world, material, &sorted[from..to], bounce);
                    self.sorted = sorted;
                    from = to;
                }
            }
            self.trace_shadows(world);
            std::mem::swap(&mut self.active, &mut self.next);
            bounce += 1;
        }
    }

    fn intersect(&mut self, world: &World) {
        self.missed.clear();
        self.rays += self.active.len() as u64;
        world.accel.intersect(&mut self.paths, &self.active);
        for &i in &self.active {
            if self.paths[i as usize].hit.primitive == NOTHING {
                self.missed.push(i);
            }
        }
    }

    /// Adds the background to the paths that hit nothing.
    fn background(&mut self, world: &World) {
        let (material, table) = match &world.sky {
            Sky::Constant(radiance) => {
                // There is a background, and thus a material, where there is light.
                let material = world.scene.background.map_or(0, |b| b.material as usize);
                for &i in &self.missed {
                    let path = &mut self.paths[i as usize];
                    gather(path, path.throughput * *radiance, material, &mut self.dropped);
                }
                return;
            }
            Sky::Shader { material, table } => (*material, table),
        };
        for batch in self.missed.chunks(world.settings.batch_width.clamp(1, crate::exec::MAX_LANES)) {
            self.shading.resize(batch.len());
            for (lane, &i) in batch.iter().enumerate() {
                let hit = &self.paths[i as usize].hit;
                fill_sky(&mut self.shading, lane, hit.direction, hit.ray_type);
            }
            self.shading.shade(&world.scene.materials[material].surface);
            for (lane, &i) in batch.iter().enumerate() {
                let path = &mut self.paths[i as usize];
                let other = table.as_ref().map_or(0.0, |t| t.pdf(path.hit.direction));
                let weight = weight_of_found(world.settings.lights, path.pdf_solid_angle, other);
                let emission = self.shading.emission().get(lane);
                gather(path, path.throughput * emission * weight, material, &mut self.dropped);
            }
        }
    }

    /// Sorts the hits by material; those that end here without any shading are settled and left out.
    fn sort(&mut self, world: &World, bounce: u32) {
        let last = bounce >= world.settings.max_bounces;
        self.starts.clear();
        self.starts.resize(world.scene.materials.len() + 1, 0);
        self.next.clear();
        self.materials.clear();
        for &i in &self.active {
            let path = &mut self.paths[i as usize];
            if path.hit.primitive == NOTHING {
                continue;
            }
            let material = world.material_of(path.hit.primitive);
            let constant = world.emission_of(path.hit.primitive);
            if path.clear {
                path.alpha = 1.0;
            }
            if let Some(emission) = constant.filter(|_| world.settings.show_globals == 0) {
                if emission != Vec3::ZERO {
                    let weight = emission_weight(world, path);
                    gather(path, path.throughput * emission * weight, material, &mut self.dropped);
                }
                let plan = &world.plan.materials[material];
                if (last || !plan.scatters) && !(plan.holds_out && path.clear) {
                    continue;
                }
            }
            self.starts[material + 1] += 1;
            self.next.push(i);
            self.materials.push(material as u32);
        }
        for m in 1..self.starts.len() {
            self.starts[m] += self.starts[m - 1];
        }
        self.sorted.resize(self.next.len(), 0);
        for (&i, &material) in self.next.iter().zip(&self.materials) {
            let slot = &mut self.starts[material as usize];
            self.sorted[*slot as usize] = i;
            *slot += 1;
        }
        // Each start has moved to its end, which is the next one's start.
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }
}

/// The weight of emission that a scattered ray has found, where a light sample would have had density `other`.
#[inline]
pub fn weight_of_found(strategy: LightStrategy, own: f32, other: f32) -> f32 {
    if other <= 0.0 || own == f32::INFINITY {
        return 1.0;
    }
    match strategy {
        LightStrategy::Combined => power_heuristic(own, other),
        LightStrategy::ScatteringOnly => 1.0,
        LightStrategy::LightsOnly => 0.0,
    }
}

/// The weight of the emission at a path's hit.
#[inline]
pub fn emission_weight(world: &World, path: &Path) -> f32 {
    let other = world.lights.pdf(&world.scene.geometry, &path.hit, path.from);
    weight_of_found(world.settings.lights, path.pdf_solid_angle, other)
}

/// Adds to a path what leaves it finite and drops what does not.
#[inline]
pub fn gather(path: &mut Path, contribution: Vec3, material: usize, dropped: &mut Dropped) {
    let sum = path.radiance + contribution;
    if sum.is_finite() {
        path.radiance = sum;
    } else {
        dropped.add(material);
    }
}
