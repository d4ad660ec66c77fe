//! Where an element puts its mesh: turned, scaled and moved.

use super::error::SceneError;
use super::xml::Element;
use crate::math::elementary::sincos;
use glam::{DMat3, DVec3, Vec3};

/// An affine map from the coordinates of a mesh to those of the scene.
///
/// Decision (2026-11-29): the map is baked into the triangles of each element, instead of sharing one hierarchy among
/// elements of one file, because a hit is a primitive's index everywhere (lights, objects, margins, derivatives) and would
/// have to become a pair. A file is read once however many elements name it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    linear: DMat3,
    offset: DVec3,
}

impl Placement {
    /// The attributes it knows.
    pub const ATTRIBUTES: [&str; 4] = ["scale", "rotate", "translate", "transform"];

    /// Reads `scale`, `rotate` and `translate`, which are done in this order, or `transform`; nothing where there are none.
    ///
    /// # Errors
    /// A value is no number, the matrix is not affine, or it leaves the mesh no volume.
    pub fn read(e: &Element) -> Result<Option<Self>, SceneError> {
        let has = |name: &str| e.node.attribute(name).is_some();
        if !Self::ATTRIBUTES.iter().any(|name| has(name)) {
            return Ok(None);
        }
        if !has("transform") {
            return Self::of_steps(e).map(Some);
        }
        if let Some(other) = Self::ATTRIBUTES[..3].iter().find(|name| has(name)) {
            let error = e.bad_value("transform", &format!("either `transform` or `{other}`, not both,"));
            return Err(error.with_help("put all of it into the 16 numbers"));
        }
        Self::of_matrix(e).map(Some)
    }

    fn of_steps(e: &Element) -> Result<Self, SceneError> {
        let what = "one number or three, none of them 0,";
        let scale = match e.numbers("scale", what)?.as_deref() {
            None => DVec3::ONE,
            Some(&[s]) => DVec3::splat(f64::from(s)),
            Some(&[x, y, z]) => Vec3::new(x, y, z).as_dvec3(),
            Some(_) => return Err(e.bad_value("scale", what)),
        };
        if scale.cmpeq(DVec3::ZERO).any() {
            return Err(e.bad_value("scale", what));
        }
        let turned = e.vector("rotate")?.unwrap_or(Vec3::ZERO);
        let linear = turn(2, turned.z) * turn(1, turned.y) * turn(0, turned.x) * DMat3::from_diagonal(scale);
        let offset = e.vector("translate")?.unwrap_or(Vec3::ZERO).as_dvec3();
        Ok(Placement { linear, offset })
    }

    /// A matrix as OSL writes it: points are rows, so that the last row moves them.
    fn of_matrix(e: &Element) -> Result<Self, SceneError> {
        let what = "16 numbers of an invertible matrix that end in the row `x y z 1`";
        let Some(m) = e.numbers("transform", what)?.filter(|m| m.len() == 16) else {
            return Err(e.bad_value("transform", what));
        };
        let row = |i: usize| Vec3::from_slice(&m[4 * i..]).as_dvec3();
        let placement = Placement { linear: DMat3::from_cols(row(0), row(1), row(2)), offset: row(3) };
        let affine = [m[3], m[7], m[11], m[15]] == [0.0, 0.0, 0.0, 1.0];
        let determinant = placement.linear.determinant();
        if !affine || determinant == 0.0 || !determinant.is_finite() {
            return Err(e.bad_value("transform", what));
        }
        Ok(placement)
    }

    /// Where a point goes; infinite where a single does not reach.
    pub fn point(&self, p: Vec3) -> Vec3 {
        (self.linear * p.as_dvec3() + self.offset).as_vec3()
    }

    /// The map of normals, whose length means nothing.
    pub fn normals(&self) -> impl Fn(Vec3) -> Vec3 + use<> {
        // Up to a positive factor the inverse transposed, without a division.
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = self.linear;
        let sign = self.linear.determinant().signum();
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        move |n| (sign * (cofactors * n.as_dvec3())).normalize_or_zero().as_vec3()
    }

    /// True when it makes a left hand of a right one.
    pub fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}

/// A turn about an axis by degrees, from x to y, y to z or z to x. A quarter is exact.
fn turn(axis: usize, degrees: f32) -> DMat3 {
    let quarters = (degrees / 90.0).round();
    let (s, c) = sincos((degrees - 90.0 * quarters).to_radians());
    let (s, c) = (f64::from(s), f64::from(c));
    let (sin, cos) = match quarters.rem_euclid(4.0) as u32 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    };
    let mut matrix = DMat3::IDENTITY;
    let (from, to) = ((axis + 1) % 3, (axis + 2) % 3);
    matrix.col_mut(from)[from] = cos;
    matrix.col_mut(from)[to] = sin;
    matrix.col_mut(to)[from] = -sin;
    matrix.col_mut(to)[to] = cos;
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarters_are_exact_and_turn_right_handed() {
        for (axis, from, to) in [(0, Vec3::Y, Vec3::Z), (1, Vec3::Z, Vec3::X), (2, Vec3::X, Vec3::Y)] {
            for (degrees, expected) in [(90.0, to), (180.0, -from), (-90.0, -to), (450.0, to), (0.0, from)] {
                let placement = Placement { linear: turn(axis, degrees), offset: DVec3::ZERO };
                assert_eq!(placement.point(from), expected, "{axis} {degrees}");
            }
            let placement = Placement { linear: turn(axis, 30.0), offset: DVec3::ONE };
            let expected = from * 0.75f32.sqrt() + to * 0.5 + Vec3::ONE;
            assert!(placement.point(from).distance(expected) < 1e-6);
        }
    }

    #[test]
    fn normals_stay_upright_on_what_is_stretched_or_mirrored() {
        let stretch = DMat3::from_diagonal(DVec3::new(1.0, 4.0, -1.0));
        let placement = Placement { linear: stretch, offset: DVec3::ZERO };
        // A plane through (1, -1, 0) and z: its normal is (1, 1, 0), and (4, 1, 0) after the stretch.
        let normal = placement.normals()(Vec3::new(1.0, 1.0, 0.0));
        assert!(normal.distance(Vec3::new(4.0, 1.0, 0.0).normalize()) < 1e-6, "{normal}");
        assert_eq!(placement.normals()(Vec3::Z), -Vec3::Z);
        assert!(placement.mirrors());
    }
}
