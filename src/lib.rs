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
//! A file uses its own room or one above it in this list, never one below; `tests/architecture.rs` holds that.
//!
//! | room | what it is |
//! |---|---|
//! | `grammar/` | text to syntax tree: preprocessor, lexer, grammar, diagnostics (a crate of its own) |
//! | [`lang`] | nouns: types, symbols, tables of builtins, globals and closures |
//! | [`math`] | columns, elementary functions, noise, frames, warps, quadrature; knows no language |
//! | [`ops`] | the one meaning of every builtin |
//! | [`check`] | syntax tree to typed shader; every mistake a user can make ends here |
//! | [`ir`] | typed shaders to a program; print; verify |
//! | [`optimize`] | program to program: derivatives, dead code, uniform values, operations in pairs |
//! | [`bsdf`] | one file a scattering model, in its local frame |
//! | [`closure`] | what each closure is, one file a family; the tree: print, flatten to lobes, albedo scaling, evaluate, sample |
//! | [`exec`] | program and points to closure tree |
//! | [`compile`] | the pipeline in one place |
//! | [`scene`] | scene XML, meshes, shader groups |
//! | [`render`] | wavefront path tracer, film, image files |
//! | [`measure`] | furnace, statistics, quadrature: what tests and charts run on |
//! | [`cli`] | arguments and subcommands; the only room that prints or exits |
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
pub mod ir;
pub mod lang;
pub mod math;
// Its truths are f64, and no picture depends on it.
#[cfg(feature = "measure")]
#[allow(clippy::disallowed_methods)]
pub mod measure;
pub mod ops;
pub mod optimize;
#[cfg(feature = "render")]
pub mod render;
#[cfg(feature = "render")]
pub mod scene;

/// The blocks of the README, as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
