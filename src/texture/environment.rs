//! Directions in a picture of all directions, in latitude and longitude.

use crate::math::elementary::atan2;

/// Which axis points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// y, as in OpenEXR's environment maps and by default.
    #[default]
    Y,
    /// z.
    Z,
}

/// The s and t of a direction, of any length: t = 0 is up, s = 1/2 is +z where y is up (and -x lies at 3/4), and +x where z is up. As
/// OpenImageIO has it.
pub fn latitude_longitude(direction: [f32; 3], up: Up) -> [f32; 2] {
    let [x, y, z] = direction;
    const PI: f32 = std::f32::consts::PI;
    let (longitude, height, across) = match up {
        Up::Y => (atan2(-x, z), y, (z * z + x * x).sqrt()),
        Up::Z => (atan2(y, x), z, (x * x + y * y).sqrt()),
    };
    [longitude / (2.0 * PI) + 0.5, 0.5 - atan2(height, across) / PI]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_where_they_belong() {
        let near = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).abs() < 1e-6 && (a[1] - b[1]).abs() < 1e-6;
        for (direction, up, place) in [
            ([0.0, 0.0, 1.0], Up::Y, [0.5, 0.5]),
            ([-1.0, 0.0, 0.0], Up::Y, [0.75, 0.5]),
            ([1.0, 0.0, 0.0], Up::Y, [0.25, 0.5]),
            ([0.0, 3.0, 0.0], Up::Y, [0.5, 0.0]),
            ([0.0, -2.0, 0.0], Up::Y, [0.5, 1.0]),
            ([0.0, 1.0, 1.0], Up::Y, [0.5, 0.25]),
            ([1.0, 0.0, 0.0], Up::Z, [0.5, 0.5]),
            ([0.0, 1.0, 0.0], Up::Z, [0.75, 0.5]),
            ([0.0, 0.0, 1.0], Up::Z, [0.5, 0.0]),
        ] {
            assert!(near(latitude_longitude(direction, up), place), "{direction:?} {up:?}");
        }
    }
}
