//! Typed shaders to a program: the layers of a group one after the other, functions expanded in place.
//!
//! A variable is a name for registers. Where every lane that matters runs the same code, an assignment just binds the
//! name to the registers of the new value and costs nothing. Inside a *region* (a branch, a loop, a body that lanes can
//! leave early) lanes may differ, so on entry every variable assigned in it gets mutable registers of its own, and
//! assignments there become masked moves.

mod asking;
mod assigned;
mod builtin;
mod call;
mod expr;
mod group;
mod layers;
mod moving;
mod noise;
mod operand;
mod operator;
mod place;
mod shared;
mod space;
mod spec;
mod state;
mod statement;
mod storage;
mod text;
mod texture;
mod value;
mod watch;
mod writing;

pub use layers::lower;
pub use spec::{Binding, Layer, Lazy, LowerOptions};
pub use state::SPANS_PER_LAYER;
