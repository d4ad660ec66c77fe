//! Closures: what each is, the tree they make, and its lobes, which are weighted, layered, evaluated and sampled.
//!
//! A closure is a [`ClosureDef`]: its declaration, and the function that makes lobes of a call. velour's own are in
//! `families`, a file a family; a host registers more with [`Library::register`]. What scatters light is a
//! [`Scatter`](crate::bsdf::Scatter), whose lane loops [`LobeKind::of`] makes.
//!
//! ```text
//! call in a tree ──Arguments──▶ ClosureDef ──LeafMaker──▶ lobes ──flatten──▶ Flat ──evaluate, sample──▶ light
//! ```
//!
//! The way of one argument, the `roughness` of `sheen(base, N, tint, roughness)`, from the text to the lobe:
//!
//! 1. `check/call.rs::call_closure` finds the spec's fourth parameter and converts the expression to its type,
//! 2. `ir/lower/expr.rs::closure` puts its register fourth in the leaf's instruction,
//! 3. `exec/closures.rs::leaf` makes the register's column the fourth parameter of a leaf of the tree,
//! 4. `closure/flatten.rs::make_ready` asks the library for the leaf's lobes,
//! 5. `closure/arguments.rs::param` fills the field `roughness` of the closure's arguments,
//! 6. `closure/families/cloth.rs::lobes` gives it to the lobe as the model's first parameter,
//! 7. `closure/lobe_models.rs::push` keeps it as a number, or as a column of the batch,
//! 8. `closure/lobe_kind.rs::evaluate` hands it to the lane loop of the model,
//! 9. `bsdf/sheen/mod.rs::prepare` clamps it and makes the model's constants.

pub mod arguments;
mod batch;
mod coats;
mod curves;
mod definition;
mod evaluate;
pub mod event;
mod families;
mod flat;
mod flatten;
mod frames;
mod layering;
mod leaf;
mod library;
mod lobe_kind;
mod lobe_models;
pub mod lobes;
mod normals;
pub mod print;
pub mod reading;
mod sampling;
pub mod settings;
mod source;
mod store;
mod tops;
pub mod tree;
mod weights;
pub mod words;

pub use arguments::{Argument, Arguments, Color, Float, Int, Nested, Normal, ReadArguments, Text, Vector, Word};
pub use definition::ClosureDef;
pub use evaluate::Evaluation;
pub use flat::Dropped;
pub use leaf::{FrameId, Gate, LeafMaker, LobeRequest, PartId};
pub use library::{Library, RegisterError};
pub use lobe_kind::LobeKind;
pub use lobes::{LobeInfo, Lobes};
pub use sampling::Samples;
pub use settings::{Layering, Settings};
