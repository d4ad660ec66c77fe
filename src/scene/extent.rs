//! How large a scene is and where it lies: what positions of single precision cannot hold well.

use super::geometry::{Geometry, Shape};
use glam::Vec3;

/// The farthest that a scene may lie from the origin, in sizes of its own. A ray starts 2^-20 of its largest coordinate off
/// a surface: at this distance, 1/2000 of the scene.
const MOST_SIZES: f32 = 512.0;

/// The largest coordinate of a scene. Measured: a scene of a lamp, a ball and a floor keeps its picture from 1e-9 to 1e8 times
/// its size; at 1e9 the lamp is lost, since products of three lengths and squares of areas overflow.
const MOST_UNITS: f32 = 1e8;

/// The smallest size of a scene; squares of areas vanish below.
const LEAST_UNITS: f32 = 1e-9;

/// What is to be said of a scene's place and size, if anything.
pub fn oddity(geometry: &Geometry) -> Option<String> {
    let (low, high) = bounds(geometry)?;
    let (size, farthest) = ((high - low).max_element(), low.abs().max(high.abs()).max_element());
    let singles = "positions are single precision";
    if farthest > MOST_UNITS {
        return Some(format!(
            "the scene reaches to {farthest:e} units; above {MOST_UNITS:e} areas overflow; scale it down"
        ));
    }
    if size < LEAST_UNITS {
        return Some(format!("the scene is {size:e} units large; below {LEAST_UNITS:e} areas vanish; scale it up"));
    }
    if farthest > MOST_SIZES * size {
        let sizes = farthest / size;
        return Some(format!(
            "the scene lies {sizes:.0} of its own sizes from the origin; beyond {MOST_SIZES} it is drawn coarsely, since \
             {singles}; move it to the origin"
        ));
    }
    None
}

/// The corners of the box around all primitives.
fn bounds(geometry: &Geometry) -> Option<(Vec3, Vec3)> {
    let around = |shape: &Shape| match *shape {
        Shape::Sphere { center, radius } => (center - radius, center + radius),
        Shape::Quad { corner: a, edge_x: x, edge_y: y } => {
            (a + Vec3::ZERO.min(x) + Vec3::ZERO.min(y), a + Vec3::ZERO.max(x) + Vec3::ZERO.max(y))
        }
        Shape::Triangle { a, b, c } => (a.min(b).min(c), a.max(b).max(c)),
    };
    let boxes = geometry.primitives.iter().map(|primitive| around(&primitive.shape));
    boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}
