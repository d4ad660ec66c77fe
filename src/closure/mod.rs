//! The closure tree: print it, flatten it to weighted lobes, scale bases by albedo, evaluate and sample.

pub mod print;
pub mod tree;
