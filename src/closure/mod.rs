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
//! The way of one argument, from the text to the lobe, is in the documentation of the crate.

pub mod arguments;
mod batch;
mod coats;
mod curves;
mod darkening;
mod definition;
mod evaluate;
pub mod event;
mod families;
mod flat;
mod flatten;
mod frames;
mod glossy;
mod layering;
mod leaf;
mod leaning;
mod library;
mod lobe_kind;
mod lobe_models;
pub mod lobes;
mod lossless;
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
pub use flat::{Dropped, LeftOut};
pub use leaf::{FrameId, Gate, LeafMaker, LobeRequest, PartId};
pub use library::{Library, RegisterError};
pub use lobe_kind::LobeKind;
pub use lobes::{LobeInfo, Lobes};
pub use sampling::Samples;
pub use settings::{Layering, Settings};
