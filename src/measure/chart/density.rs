//! Figure 2 of Estevez and Kulla 2017: the distribution of micronormals over their angle, a line a roughness.

use super::figure::{Figure, Join, Point};
use super::race::Cost;
use crate::bsdf::sheen::charlie::distribution;

/// Roughnesses, from nearly upright fibers to the widest.
const ROUGHNESSES: [f32; 6] = [0.05, 0.1, 0.2, 0.4, 0.65, 1.0];

/// Degrees between points of a line.
const STEP: f64 = 1.0;

/// Draws D over theta. Nothing is measured; the figure shows the model.
pub fn density() -> Figure {
    let mut points = Vec::new();
    for r in ROUGHNESSES {
        for k in 0..=90 {
            let theta = STEP * f64::from(k);
            let sin = theta.to_radians().sin() as f32;
            let value = f64::from(distribution(sin * sin, 1.0 / r));
            points.push(Point::new(&format!("r = {r}"), "", Cost { median: theta, spread: [theta; 2] }, value));
        }
    }
    Figure {
        name: "density",
        title: "D of the sheen over the angle of the micronormal".to_owned(),
        cost: "theta, degrees from the normal".to_owned(),
        error: "D, 1/sr".to_owned(),
        meaning: "Estevez and Kulla 2017, eq. 2 and Figure 2: the smaller the roughness, the nearer to the horizon all micronormals lie."
            .to_owned(),
        join: Join::Curves,
        points,
    }
}
