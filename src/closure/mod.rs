//! The closure tree: print it, flatten it to weighted lobes, scale bases by albedo, evaluate and sample.

mod batch;
mod curves;
mod flatten;
mod kinds;
mod layering;
mod leaves;
pub mod lobes;
mod media;
mod normals;
pub mod print;
pub mod reading;
mod sampling;
pub mod settings;
mod store;
mod surfaces;
pub mod tree;
mod weights;

pub use lobes::{Dropped, Evaluation, LobeInfo, Lobes};
pub use sampling::{Samples, event};
pub use settings::{Layering, Settings};
