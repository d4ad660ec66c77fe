//! velour turns Open Shading Language text into closure trees and renders with them.
//!
//! ```
//! use velour::closure::print::tree_text;
//! use velour::exec::{Machine, Points};
//!
//! let shader = velour::compile::compile("surface s(float r = 0.3) { Ci = sheen(diffuse(N), N, color(1), r); }")?;
//! let group = shader.group().param("r", &[0.5]).build()?;
//! let mut machine = Machine::new();
//! let tree = machine.shade(&group, &Points::single(glam::Vec3::Z));
//! let text = tree_text(group.table(), tree, 0);
//! assert_eq!(text, "(1, 1, 1) * sheen ((1, 1, 1) * diffuse ((0, 0, 1)), (0, 0, 1), (1, 1, 1), 0.5)");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Testing a shader
//!
//! What a shader is made of is read lane by lane: the leaves of its tree with names, weights and arguments, and its
//! outputs by name, as far as the group keeps them.
//!
//! ```
//! use velour::closure::reading::Value;
//! use velour::exec::{Machine, Points, Values};
//!
//! let shader = velour::compile::compile("surface s(output float f = 0) { f = 1 - u; Ci = f * sheen(diffuse(N), N, color(1), .5); }")?;
//! let (group, mut machine) = (shader.group().keep_outputs().build()?, Machine::new());
//! let leaf = machine.shade(&group, &Points::single(glam::Vec3::Z)).lane(group.table(), 0).next().unwrap();
//! assert_eq!((leaf.name(), leaf.weight(), leaf.get("roughness")), ("sheen", [1.0; 3], Some(Value::Float(0.5))));
//! assert_eq!(machine.output(&group, "f").unwrap().lane(0), Values::Floats(vec![1.0]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The way of a shader
//!
//! ```text
//! text ──parse──▶ syntax tree ──check──▶ typed shader ──lower──▶ program ──optimize──▶ program
//!       grammar/               check/                  ir/                 optimize/      │
//!                                                                                        ▼
//! picture ◀──render── lobes ◀──flatten── closure tree ◀──shade── exec::Group + exec::Points
//!          render/           closure/                  exec/
//! ```
//!
//! [`compile`] is the first line of the picture, in one place. The rest works on *batches*: up to
//! [`exec::MAX_LANES`] points at once, a column a quantity, so that an instruction or a lobe is decoded once and then
//! loops over lanes in SIMD. A closure tree belongs to a batch too.
//!
//! # Rooms
//!
//! A file uses its own room or one above it in this list, never one below, and no two files of a room use each other;
//! `tests/architecture` holds that. A room with a feature is compiled with it; all features are on by default.
//!
//! | room | feature | what it is |
//! |---|---|---|
//! | `grammar/` | | text to syntax tree: preprocessor, lexer, grammar, diagnostics (a crate of its own) |
//! | [`limits`] | | budgets for input that nobody vouches for |
//! | `files` | `render` | finished files: whole or not at all, through links, pipes and devices |
//! | [`lang`] | | nouns: types, symbols, tables of builtins and globals, what a closure declares |
//! | [`math`] | | columns, elementary functions, noise, frames, warps, quadrature; knows no language |
//! | [`texture`] | | pictures that shaders look up: pyramids, filters; files with `render` |
//! | [`ops`] | | the one meaning of every builtin |
//! | [`check`] | | syntax tree to typed shader; every mistake a user can make ends here |
//! | [`ir`] | | typed shaders to a program; print; verify |
//! | [`optimize`] | | program to program: derivatives, dead code, uniform values, operations in pairs |
//! | [`bsdf`] | | one file a scattering model, in its local frame |
//! | [`closure`] | | each closure in one place; the tree: print, read, flatten to lobes, evaluate, sample |
//! | [`exec`] | | program and points to closure tree |
//! | [`compile`] | | the pipeline in one place |
//! | `query` | `lsp` | what editors ask: names, meanings, what may be written |
//! | `lsp` | `lsp` | the language server that answers them |
//! | `scene` | `render` | scene XML, meshes, shader groups |
//! | `render` | `render` | wavefront path tracer, film, image files |
//! | `measure` | `measure`, `chart` | furnace, statistics, quadrature: what tests and charts run on |
//! | `live` | `live` | a page that shows a picture while its text is edited |
//! | `cli` | `cli` | arguments and subcommands; the only room that prints or exits |
//!
//! # Two ways through the house
//!
//! The `roughness` of `sheen(Ci, N, tint, roughness)`, from text to lobe:
//!
//! 1. `grammar/src/lib.rs::parse` makes it the fourth argument of a call
//! 2. `check/call.rs::call_closure` finds the fourth parameter and converts the expression to its type
//! 3. `ir/lower/expr.rs::closure` puts its register fourth in the leaf's instruction
//! 4. `exec/closures.rs::leaf` makes the register's column the fourth parameter of a leaf of the tree
//! 5. `closure/flatten.rs::make_ready` asks the library for the leaf's lobes
//! 6. `closure/arguments.rs::param` fills the field `roughness` of the closure's arguments
//! 7. `closure/families/cloth.rs::lobes` gives it to the lobe as the model's first parameter
//! 8. `closure/lobe_models.rs::push` keeps it as a number, or as a column of the batch
//! 9. `closure/lobe_kind.rs::evaluate` hands it to the lane loop of the model
//! 10. `bsdf/sheen/mod.rs::prepare` clamps it and makes the model's constants
//!
//! A camera ray, from the renderer to the film:
//!
//! 1. `render/renderer.rs::round` cuts the round into tasks, of which threads take one at a time
//! 2. `render/trace.rs::render_tile` fills a wave with paths, and names the stages of a bounce in order
//! 3. `render/stages/camera.rs::start` draws a place in the pixel and makes the ray
//! 4. `render/stages/intersect.rs::intersect` asks the hierarchy for the hits
//! 5. `render/stages/background.rs::background` adds the sky to what missed
//! 6. `render/stages/sort.rs::sort` sorts the hits by material
//! 7. `render/stages/shade.rs::shade` takes a batch of one material, and adds what it emits
//! 8. `render/points.rs::fill` makes shading points of its hits
//! 9. `render/shading.rs::shade` runs the shader and flattens its closures
//! 10. `render/stages/light.rs::sample_light` queues rays to lights
//! 11. `render/stages/scatter.rs::scatter` sends the paths on, to 4
//! 12. `render/stages/shadow.rs::trace_shadows` adds what the queued rays bring
//! 13. `render/film.rs::add` weighs the sample into the pixels around it
//! 14. `render/film.rs::picture` divides sums by weights
//!
//! # Invariants
//!
//! - The library never prints, never exits, and never panics on input.
//! - Past [`check`] a shader cannot fail. What can go wrong at run time is data, reported as [`exec::Report`].
//! - A verified program cannot fail: [`ir::verify`] says what that means.
//! - No width of a batch, no thread count and no instruction set changes a bit of a result.
//! - A closure is one [`closure::ClosureDef`]: name, arguments, documentation, promises and lobes. All else reads that, for
//!   those of hosts as well.
//!
//! Decision (2026-11-22): `bsdf` and `closure` stand above `exec`, because the machine fills the tree that `closure`
//! owns, and `closure` evaluates models of `bsdf`, instead of `exec` owning a tree that others read.

// A unit test may hold our functions against those of the platform.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

/// The vectors of the interface, in the version that it is made for.
pub use glam;

pub mod bsdf;
pub mod check;
#[cfg(feature = "cli")]
pub mod cli;
pub mod closure;
pub mod compile;
pub mod exec;
#[cfg(feature = "render")]
pub mod files;
pub mod ir;
pub mod lang;
pub mod limits;
#[cfg(feature = "live")]
pub mod live;
#[cfg(feature = "lsp")]
pub mod lsp;
pub mod math;
// Its truths are f64, and no picture depends on it.
#[cfg(feature = "measure")]
#[allow(clippy::disallowed_methods)]
pub mod measure;
pub mod ops;
pub mod optimize;
#[cfg(feature = "lsp")]
pub mod query;
#[cfg(feature = "render")]
pub mod render;
#[cfg(feature = "render")]
pub mod scene;
pub mod texture;

/// The blocks of the README, as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
