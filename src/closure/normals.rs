//! Frames to shade in: unit normals that the viewer sees, and tangents around them.
//!
//! Decision (2026-11-22): a normal whose length lies between 1/2 and 2 is divided by its length alone, and normals are bent in a
//! pass that is left out when none needs it, because nearly all normals are of that kind, and two of three divisions and one
//! of two roots go; instead of one loop that does all of it for every lane.

use super::source::Triples;
use crate::bsdf::select;
use crate::lanes;
use crate::math::frame::Frame;
use glam::Vec3;

/// Below this the cosine of the viewer counts as negative.
const LEAST: f32 = 1e-6;

/// What [`normal_lanes`] reads.
#[derive(Clone, Copy)]
pub struct NormalColumns<'a> {
    /// Normals as the shader gave them.
    pub given: Triples<'a>,
    /// Directions to the viewer.
    pub wo: Triples<'a>,
    /// Geometric normals.
    pub ng: Triples<'a>,
}

/// Is the square of a normal's length in a range where neither it nor its inverse loses digits?
#[inline(always)]
fn near_unit(length2: f32) -> bool {
    (length2 > 0.25) & (length2 < 4.0)
}

/// A normal of any length as a unit one, and whether it is made of numbers.
#[inline(always)]
fn unit_of(g: Vec3, fallback: Vec3) -> (Vec3, bool) {
    let scale = g.x.abs().max(g.y.abs()).max(g.z.abs());
    // The sum is finite only when all three are; max() alone would pass over a NaN.
    let finite = (g.x.abs() + g.y.abs() + g.z.abs()) * 0.0 == 0.0;
    let usable = finite & (scale > 1e-18);
    // Dividing by the largest component first keeps the square of tiny and huge normals in range.
    let small = choose(near_unit(g.dot(g)), g, g * (1.0 / select(usable, scale, 1.0)));
    (choose(usable, small * (1.0 / small.dot(small).max(1e-30).sqrt()), fallback), finite)
}

lanes! {
    /// Unit normals to shade with; `inside` is 1 where the viewer is on the inner side, `broken` where the normal is no number.
    pub fn normal_lanes(
        from: NormalColumns<'_>,
        x: &mut [f32],
        y: &mut [f32],
        z: &mut [f32],
        inside: &mut [f32],
        broken: &mut [f32],
    ) {
        let n = x.len();
        let (y, z, inside, broken) = (&mut y[..n], &mut z[..n], &mut inside[..n], &mut broken[..n]);
        let (given, wo, ng) = (from.given.narrow(n), from.wo.narrow(n), from.ng.narrow(n));
        let mut odd = 0;
        for i in 0..n {
            odd |= !near_unit(given.at(i).dot(given.at(i))) as u32;
        }
        let mut averted = 0;
        // Both loops give a lane the same bits.
        if odd == 0 {
            for i in 0..n {
                let g = given.at(i);
                let unit = g * (1.0 / g.dot(g).sqrt());
                let (unit, behind) = faced(unit, wo.at(i), ng.at(i));
                averted |= (unit.dot(wo.at(i)) < LEAST) as u32;
                (x[i], y[i], z[i]) = (unit.x, unit.y, unit.z);
                (inside[i], broken[i]) = (select(behind, 1.0, 0.0), 0.0);
            }
        } else {
            for i in 0..n {
                let (o, geometric) = (wo.at(i), ng.at(i));
                let fallback = choose(geometric.dot(geometric) > 0.5, geometric, o);
                let (unit, finite) = unit_of(given.at(i), fallback);
                let (unit, behind) = faced(unit, o, geometric);
                averted |= (unit.dot(o) < LEAST) as u32;
                (x[i], y[i], z[i]) = (unit.x, unit.y, unit.z);
                (inside[i], broken[i]) = (select(behind, 1.0, 0.0), select(finite, 0.0, 1.0));
            }
        }
        if averted == 0 {
            return;
        }
        for i in 0..n {
            let normal = bent(Vec3::new(x[i], y[i], z[i]), wo.at(i));
            (x[i], y[i], z[i]) = (normal.x, normal.y, normal.z);
        }
    }
}

/// A normal turned to the viewer's side when the viewer is inside, and whether that is so.
#[inline(always)]
fn faced(unit: Vec3, o: Vec3, geometric: Vec3) -> (Vec3, bool) {
    let behind = unit.dot(geometric) * o.dot(geometric) < 0.0;
    (unit * select(behind, -1.0, 1.0), behind)
}

/// A normal that faces away, bent until the viewer sees it.
#[inline(always)]
fn bent(unit: Vec3, o: Vec3) -> Vec3 {
    let cos = unit.dot(o);
    let bent = unit + o * (LEAST - cos).max(0.0);
    let length2 = bent.dot(bent);
    let bent = choose(length2 > 1e-12, bent * (1.0 / length2.max(1e-12).sqrt()), o);
    choose(cos < LEAST, bent, unit)
}

/// One lane's choice between two triples.
#[inline(always)]
fn choose(condition: bool, yes: Vec3, no: Vec3) -> Vec3 {
    Vec3::new(select(condition, yes.x, no.x), select(condition, yes.y, no.y), select(condition, yes.z, no.z))
}

/// The least cosine to the geometric normal that a mirror direction may have, and the most of the viewer's that it must have.
const LOW: f32 = 0.01;
const LOW_PART: f32 = 0.9;

/// How high above the surface a mirror direction has to be for a viewer of this cosine.
#[inline(always)]
fn least_height(viewer: f32) -> f32 {
    (LOW_PART * viewer).min(LOW)
}

/// The cosine to the geometric normal of the direction that a normal mirrors the viewer to.
#[inline(always)]
fn mirror_height(n: Vec3, wo: Vec3, ng: Vec3) -> f32 {
    2.0 * n.dot(wo) * n.dot(ng) - wo.dot(ng)
}

/// Does any normal mirror a viewer in front of the surface to below it?
pub fn any_low(normal: Triples<'_>, wo: Triples<'_>, ng: Triples<'_>) -> bool {
    let low = |i: usize| {
        let (n, o, g) = (normal.at(i), wo.at(i), ng.at(i));
        let viewer = o.dot(g);
        viewer > 0.0 && mirror_height(n, o, g) < least_height(viewer)
    };
    (0..normal.x.len()).any(low)
}

/// A normal turned toward the geometric one, no further than that the mirror direction of the viewer stays above the surface.
///
/// In the plane of both normals let the viewer have the coordinates (u, v), v along the geometric normal; a normal at the angle t
/// from that mirrors it to the height u sin 2t + v cos 2t = a cos(2t - p), with a the length of (u, v) and p its angle. Heights
/// of at least h are those of 2t <= p + acos(h / a), which bounds t; what the viewer has across the plane changes nothing.
#[inline(always)]
pub fn raised(n: Vec3, wo: Vec3, ng: Vec3) -> Vec3 {
    let v = wo.dot(ng);
    let height = least_height(v);
    if !(v > 0.0 && mirror_height(n, wo, ng) < height) {
        return n;
    }
    let across = n - ng * n.dot(ng);
    let length2 = across.dot(across);
    if length2 < 1e-12 {
        return ng;
    }
    let axis = across * (1.0 / length2.sqrt());
    let u = wo.dot(axis);
    let a = (u * u + v * v).sqrt();
    let (cos_p, sin_p, cos_h) = (v / a, u / a, (height / a).min(1.0));
    let sin_h = ((1.0 - cos_h) * (1.0 + cos_h)).max(0.0).sqrt();
    let cos_2t = cos_p * cos_h - sin_p * sin_h;
    let cos_t = (0.5 * (1.0 + cos_2t)).max(0.0).sqrt();
    let sin_t = (0.5 * (1.0 - cos_2t)).max(0.0).sqrt();
    ng * cos_t + axis * sin_t
}

lanes! {
    /// Tangents and bitangents of normals, of any azimuth.
    pub fn tangent_lanes(
        normal: Triples<'_>,
        tx: &mut [f32],
        ty: &mut [f32],
        tz: &mut [f32],
        bx: &mut [f32],
        by: &mut [f32],
        bz: &mut [f32],
    ) {
        let n = tx.len();
        let (ty, tz, bx, by, bz) = (&mut ty[..n], &mut tz[..n], &mut bx[..n], &mut by[..n], &mut bz[..n]);
        let normal = normal.narrow(n);
        for i in 0..n {
            let frame = Frame::from_normal(normal.at(i));
            (tx[i], ty[i], tz[i]) = (frame.tangent.x, frame.tangent.y, frame.tangent.z);
            (bx[i], by[i], bz[i]) = (frame.bitangent.x, frame.bitangent.y, frame.bitangent.z);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mirror direction comes to lie as high as it must and no higher, and normals that are fit to mirror stay.
    #[test]
    fn mirror_directions_are_raised_above_the_surface() {
        let mut raised_ones = 0;
        for k in 0..20_000 {
            let at = |step: f64| ((0.5 + f64::from(k) * step).fract() * 2.0 - 1.0) as f32;
            let n = Vec3::new(at(0.754_877_666), at(0.569_840_29), at(0.438_579_1)).normalize_or(Vec3::Z);
            let wo = Vec3::new(at(0.819_172_513), at(0.671_043_607), at(0.549_700_478).abs() + 1e-3).normalize();
            if n.dot(wo) <= 0.0 {
                continue;
            }
            let turned = raised(n, wo, Vec3::Z);
            let (before, after) = (mirror_height(n, wo, Vec3::Z), mirror_height(turned, wo, Vec3::Z));
            let least = least_height(wo.z);
            assert!((turned.length() - 1.0).abs() < 1e-5 && turned.dot(wo) > 0.0, "{n} {wo} {turned}");
            if before >= least {
                assert_eq!(turned, n);
            } else {
                assert!((after - least).abs() < 1e-4, "{n} {wo}: {after} for {least}");
                raised_ones += 1;
            }
        }
        assert!(raised_ones > 1000);
    }
}
