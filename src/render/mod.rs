//! Renders scenes: a wavefront path tracer over tiles.
//!
//! A [`Renderer`] makes a `World` of a scene (hierarchy, lights, background, plan) and fills a `Film` round after round;
//! [`render`] is that in one go. Threads take tile after tile. Each has one `Wave` of memory, in which the tile's paths advance
//! together through the stages. Shaders and closures are met in one file, `shading`.
//!
//! The way of a camera ray, stage by stage, is in the documentation of the crate.
//!
//! A file uses only files that do not use it, from the ground up: `accel` and `segment` know rays, `path` knows what a
//! path carries, `wave` is the memory that the stages share, and a stage knows no other one.
//!
//! Where the time goes (perf, figure 1, one thread): ray tests 15 %, choosing points of lights and weighing them 11 %,
//! random numbers 7 %, camera rays 4 %, sorting 4 %, the film 4 %, scattering's bookkeeping 4 %; shaders and closures are
//! some 30 %, spread thin. There is no hot spot left.
//!
//! Decision (2026-11-22): what is done for every lane (random numbers, camera rays, positions and normals of hits, points
//! of lights, their weights) is done for a block of sixteen lanes by loops that become SIMD, instead of path by path,
//! because path by path it was two thirds of the time: with the early way out for spheres that a whole block misses,
//! figure 1 went from 2.8 to 4.4 million camera samples a second on one thread of a 2-core AMD EPYC with AVX2
//! (`velour render shaders/scenes/spheres.xml -o x.exr --res 640 256 --spp 64 -t 1`).
//!
//! Decision (2026-11-22): a wave has 8192 paths, because the batches of late bounces are fuller then: user seconds for 5.2
//! million samples of figure 1, best of three, 2.02, 1.75, 1.63, 1.57 with 1024, 2048, 4096, 8192.
//!
//! Decision (2026-11-29): a stage is a function of the world and the wave, and what it leaves for the next is a field of the
//! wave, because then stages know no other stage and one screen names them in order; instead of methods that call each
//! other through the wave, which made a circle of thirteen files.
//!
//! Decision (2026-11-29): a [`Renderer`] owns a copy of the scene, which shares geometry and programs, because whoever drives
//! it swaps materials and cameras between rounds; instead of borrowing the scene, which then could not change. A change
//! makes the world anew but for the hierarchy, whose making is what takes long.
//!
//! Decision (2026-11-29): on meshes with smooth normals light arrives at the smooth surface (Hanika 2021) and not at the facets, which
//! bends every use of the point: sampling of lights, densities, shadow and scattered rays, the side that lobes ask for. Figure
//! `terminator` of `velour chart`, against a ball of 256 x 128 patches, for one of 16 x 8: squared error .024 of the squared mean,
//! for 355 ns a camera ray; with nothing .168 and 352 ns; with the factor of Chiang, Li and Burley 2019, which darkens what is too
//! bright and too dark alike, .32 and 375 ns. (For 32 x 16 patches: .0007, .67 and .98.) A white ball in a white furnace has 1.0000,
//! .9953 and .9722 of its light. On woven tubes of 8 sides, against 48, .0020, .0044 and .0094. Lifting points by part of the way is
//! worse: .079 for half, .047 for three quarters. What is given up: a point may come to lie in something that touches
//! its facet, and light that passes through a facet starts on it, so that strategies differ there (1.3 % for a ball of 8 x 4
//! patches close to its lamp, .4 % for 16 x 8). Batches without such meshes take loops that know nothing of it.
//!
//! An image depends on scene, seed and sample count. It does not depend on thread count, batch width, wave size, rounds or
//! tile order: a path draws its numbers by pixel, sample and bounce, adds up its own light in order, and a pixel adds up its
//! samples in order. The size of a tile shows as good as never, see `film`. A render that stops at a noise depends on
//! the tile size as well, one that stops at a time on the machine.

pub mod accel;
mod block;
mod camera;
#[cfg(test)]
mod counts;
mod crossing;
mod debug;
mod displace;
mod emission;
mod error;
mod exact;
mod explain;
mod film;
mod form;
mod gathered;
mod host;
mod image;
mod lanes;
mod light;
mod look;
pub mod output;
pub mod part;
mod path;
mod plan;
mod points;
mod pool;
mod probe;
mod progress;
mod radiance;
pub mod random;
mod renderer;
mod rounds;
mod segment;
mod settings;
mod shading;
mod sky;
mod smooth;
mod stages;
mod stop;
mod through;
mod tile;
mod told;
mod trace;
mod view;
mod wave;
mod window;
mod world;

pub use error::{OutputError, RenderError, SettingsError};
pub use explain::{Explanation, MaterialNeeds, Saving};
pub use host::camera_attributes;
pub use image::{About, Image};
pub use look::Look;
pub use plan::{MaterialPlan, Needs, Plan};
pub use progress::{Progress, Silent};
pub use renderer::{Renderer, render};
pub use settings::{Filter, Frame, LightChoice, LightPoints, LightStrategy, Settings, Terminator};
#[cfg(feature = "cli")]
pub(crate) use view::srgb;
pub use view::{Screen, View};
