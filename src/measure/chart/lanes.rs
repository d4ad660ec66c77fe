//! Lane loops for functions that the engine has only inside of others, compiled as its own loops are.

use crate::lanes;

/// A function of one number a lane.
pub trait Curve: Copy {
    /// Its value.
    fn at(&self, x: f32) -> f32;
}

lanes! {
    /// Runs a function over all lanes.
    pub fn curve_lanes<C: Curve>(curve: C, x: &[f32], out: &mut [f32]) {
        let x = &x[..out.len()];
        for i in 0..out.len() {
            out[i] = curve.at(x[i]);
        }
    }
}
