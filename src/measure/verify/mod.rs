//! Verification: is this a material? Furnace, reciprocity, chi-square, total density, weights, finite numbers.
//!
//! A [`Subject`] is a closure by name ([`ClosureSubject`]), a user's shader ([`ShaderSubject`]), or anything that a test
//! dresses up as one. Each of its variants is looked at from several directions ([`view`]), the laws ([`laws`],
//! [`reciprocity`], [`finite`]) give a [`Finding`] each, and [`verify`] makes a [`Report`] of them. Random numbers are seeded by the
//! names of subject and variant, so a report depends on neither time nor threads.

mod choices;
mod closure;
mod direction;
pub mod draws;
mod effort;
mod examine;
pub mod finding;
pub mod finite;
pub mod laws;
mod nothing;
pub mod reciprocity;
mod shader;
pub mod subject;
mod survey;
mod tree;
pub mod view;

pub use closure::ClosureSubject;
pub use effort::Effort;
pub use examine::{examine, verify};
pub use finding::{Check, Finding, Line, Report, Verdict};
pub use shader::ShaderSubject;
pub use subject::{Promise, Promises, Scatterer, Subject};
pub use survey::cannot_run;
pub use tree::{Spot, TreeScatterer};
