//! Orthonormal frames: from world space to the local space where the shading normal is z, and back.

use glam::Vec3;

/// Three orthonormal axes; `normal` is the local z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Local x axis in world space.
    pub tangent: Vec3,
    /// Local y axis in world space.
    pub bitangent: Vec3,
    /// Local z axis in world space.
    pub normal: Vec3,
}

impl Frame {
    /// A frame around a unit normal.
    ///
    /// Source: Duff, Burgess, Christensen, Hery, Kensler, Liani and Villemin 2017, "Building an Orthonormal Basis, Revisited",
    /// listing 3.
    /// Domain: unit normal. Gives: a right-handed frame. Degenerate cases: none, the sign of -0 decides at z = 0.
    /// Departs from source: no.
    #[inline(always)]
    pub fn from_normal(n: Vec3) -> Frame {
        let sign = 1f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Frame {
            tangent: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            bitangent: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            normal: n,
        }
    }

    /// A frame around a unit normal whose x axis lies as near as possible to `u`.
    ///
    /// Source: Gram and Schmidt, twice. Domain: any `u`. Gives: a right-handed frame, orthonormal to a few ulps.
    /// Degenerate cases: `u` zero, not finite or along the normal gives [`Frame::from_normal`].
    #[inline(always)]
    pub fn from_normal_and_tangent(n: Vec3, u: Vec3) -> Frame {
        let any = Frame::from_normal(n);
        let scale = u.x.abs().max(u.y.abs()).max(u.z.abs());
        let unit = u * (1.0 / scale.max(f32::MIN_POSITIVE));
        let along = unit - n * unit.dot(n);
        let length2 = along.dot(along);
        let usable = length2 > 1e-10 && length2 < 4.0;
        let tangent = along * (1.0 / length2.max(1e-10).sqrt());
        // Along the normal the difference has lost digits, and the tangent leans; a second step sets it upright.
        let upright = tangent - n * tangent.dot(n);
        let tangent = upright * (1.0 / upright.dot(upright).max(1e-10).sqrt());
        let pick = |a: f32, b: f32| if usable { a } else { b };
        let tangent =
            Vec3::new(pick(tangent.x, any.tangent.x), pick(tangent.y, any.tangent.y), pick(tangent.z, any.tangent.z));
        Frame { tangent, bitangent: n.cross(tangent), normal: n }
    }

    /// A world direction in local coordinates.
    #[inline(always)]
    pub fn to_local(&self, w: Vec3) -> Vec3 {
        Vec3::new(w.dot(self.tangent), w.dot(self.bitangent), w.dot(self.normal))
    }

    /// A local direction in world coordinates.
    #[inline(always)]
    pub fn to_world(&self, w: Vec3) -> Vec3 {
        self.tangent * w.x + self.bitangent * w.y + self.normal * w.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for i in 0..2000 {
            let angle = i as f32 * 2.399_963;
            let z = 1.0 - (i as f32 + 0.5) / 1000.0;
            let s = (1.0 - z * z).max(0.0).sqrt();
            let n = Vec3::new(s * angle.cos(), s * angle.sin(), z);
            for frame in [Frame::from_normal(n), Frame::from_normal_and_tangent(n, Vec3::new(3.0, -1.0, 0.5))] {
                assert!(frame.tangent.dot(frame.bitangent).abs() < 1e-5);
                assert!((frame.tangent.cross(frame.bitangent) - n).length() < 1e-5);
                assert!((frame.tangent.length() - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn tangents_close_to_the_normal_stand_upright() {
        for i in 0..20_000 {
            let angle = i as f32 * 2.399_963;
            let z = 1.0 - (i as f32 + 0.5) / 10_000.0;
            let s = (1.0 - z * z).max(0.0).sqrt();
            let n = Vec3::new(s * angle.cos(), s * angle.sin(), z);
            let n = n * (1.0 / n.dot(n).sqrt());
            let off = 10f32.powf(-6.0 * (i % 100) as f32 / 100.0);
            let frame = Frame::from_normal_and_tangent(n, n + Vec3::new(-0.3, 0.9, 0.4) * off);
            let w = frame.to_world(Vec3::new(0.6, 0.0, 0.8));
            assert!((w.length() - 1.0).abs() < 1e-6, "{n} {off}: {w} of length {}", w.length());
        }
    }

    #[test]
    fn useless_tangents_are_replaced() {
        let n = Vec3::Z;
        for u in [Vec3::ZERO, Vec3::Z, Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY)] {
            assert_eq!(Frame::from_normal_and_tangent(n, u), Frame::from_normal(n));
        }
    }
}
