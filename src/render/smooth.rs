//! The smooth surface that a mesh with vertex normals stands for, and how light reaches its facets on behalf of it.
//!
//! A facet turns its back to light at once, where the smooth normal still sees it: steps as large as facets at the terminator.
//! [`Terminator`] has the remedies. Neither can gain energy: `factor` multiplies light by at most 1, and `origin` asks for
//! light from the half space of the smooth normal, over which no lobe sends back more than it gets.
//!
//! Degenerate cases: vertex normals that are turned against their facet's winding are taken the other way round; points whose
//! smooth normal the viewer does not see, and those of facets that lie on or above the smooth surface (it is hollow there, or flat),
//! are left as they are.

use super::accel::{Accel, NOTHING};
use super::segment::Segment;
use super::settings::Terminator;
use crate::closure::event;
use crate::exec::Points;
use crate::lanes;
use crate::math::columns::{Column3, pick};
use crate::scene::{Geometry, Primitive, Shape};
use glam::Vec3;

/// Vertex normals that lean by less than this sine from their facet are no smooth surface.
const LEAST_LEAN: f32 = 1e-3;

/// Below this the cosine of the viewer to the smooth normal counts as averted.
const LEAST_VIEWED: f32 = 1e-3;

/// What a batch knows of the smooth surface over its facets.
#[derive(Debug, Default)]
pub struct Smooth {
    method: Terminator,
    /// 1 in lanes on facets of a smooth surface.
    bent: Vec<f32>,
    /// Where light arrives and the normal it arrives at, for the shaders' P and Ng; the other way round after `swap`.
    p: Column3,
    ng: Column3,
}

impl Smooth {
    /// A batch that has nothing to do with smooth surfaces.
    pub fn clear(&mut self) {
        self.method = Terminator::None;
    }

    /// Finds the smooth surface over the filled `points`, which the rays of `segments` have met.
    pub fn find<'s>(
        &mut self,
        method: Terminator,
        points: &Points,
        geometry: &Geometry,
        segments: impl Iterator<Item = &'s Segment>,
    ) {
        self.method = method;
        self.bent.clear();
        self.bent.resize(points.len, 0.0);
        let moves = method == Terminator::Origin;
        if moves {
            self.p.clone_from(&points.p);
            self.ng.clone_from(&points.ng);
        }
        for (lane, segment) in segments.enumerate() {
            let primitive = &geometry.primitives[segment.hit.primitive as usize];
            let Some((lift, normal)) = lift(points, lane, geometry, segment, primitive) else { continue };
            if moves && lift != Vec3::ZERO && normal.dot(segment.direction) < -LEAST_VIEWED {
                self.p.set(lane, points.p.get(lane) + lift);
                self.ng.set(lane, normal);
                self.bent[lane] = 1.0;
            } else if !moves {
                self.bent[lane] = 1.0;
            }
        }
    }

    /// Puts points and normals where light arrives in the place of those that shaders are told, once those have run.
    pub fn swap(&mut self, points: &mut Points) {
        if self.method == Terminator::Origin {
            std::mem::swap(&mut points.p, &mut self.p);
            std::mem::swap(&mut points.ng, &mut self.ng);
        }
    }

    /// Where a ray toward `direction` starts that leaves a lane's point on `primitive`, and the primitive that it cannot meet;
    /// `MOVES` in batches where light arrives elsewhere in any lane.
    #[inline(always)]
    pub fn leave<const MOVES: bool>(
        &self,
        points: &Points,
        accel: &Accel,
        lane: usize,
        direction: Vec3,
        primitive: u32,
    ) -> (Vec3, u32) {
        let (p, ng) = (points.p.get(lane), points.ng.get(lane));
        if !(MOVES && self.moves(lane)) {
            return (accel.leave(p, ng, direction, primitive), primitive);
        }
        let facet = self.ng.get(lane);
        if ng.dot(direction) <= 0.0 {
            return (accel.leave(self.p.get(lane), facet, direction, primitive), primitive);
        }
        // From above its own facet a ray may come down on it.
        let skip = if facet.dot(direction) < 0.0 { NOTHING } else { primitive };
        (accel.leave(p, ng, direction, primitive), skip)
    }

    /// Does light arrive elsewhere than on facets in any lane?
    pub fn moves_any(&self) -> bool {
        self.method == Terminator::Origin
    }

    /// Does light arrive elsewhere than on the lane's facet?
    #[inline(always)]
    pub fn moves(&self, lane: usize) -> bool {
        self.moves_any() && self.bent[lane] != 0.0
    }

    /// Takes its part of light that arrives from `toward`.
    pub fn dim(&self, points: &Points, toward: &Column3, light: &mut Column3) {
        if self.method == Terminator::Factor {
            dim_lanes(&self.bent, [&points.n, &points.ng, toward], &mut light.x, &mut light.y, &mut light.z);
        }
    }

    /// Takes its part of what was scattered toward `toward`, but of lobes of one direction.
    pub fn dim_scattered(&mut self, points: &Points, toward: &Column3, events: &[u8], weight: &mut Column3) {
        if self.method == Terminator::Factor {
            for (bent, &event) in self.bent.iter_mut().zip(events) {
                *bent *= f32::from(u8::from(matches!(event, event::DIFFUSE | event::GLOSSY)));
            }
            dim_lanes(&self.bent, [&points.n, &points.ng, toward], &mut weight.x, &mut weight.y, &mut weight.z);
        }
    }
}

/// Do the vertex normals of a primitive stand for anything but its own plane?
pub fn is_smooth(geometry: &Geometry, primitive: &Primitive) -> bool {
    let (Some(normals), Shape::Triangle { a, b, c }) =
        (geometry.normals.get(primitive.normals as usize), primitive.shape)
    else {
        return false;
    };
    let ng = (b - a).cross(c - a).normalize_or_zero();
    normals.iter().any(|n| leans(*n, ng))
}

/// Does a normal of any length lean from a unit one?
#[inline(always)]
fn leans(n: Vec3, ng: Vec3) -> bool {
    n.cross(ng).length_squared() > LEAST_LEAN * LEAST_LEAN * n.length_squared()
}

/// From a lane's point to the smooth surface, and the smooth normal on the side of the facet's; nothing where there is no such
/// surface.
///
/// Source: Hanika 2021, "Hacking the Shadow Terminator": the point's projections onto the tangent planes of the three vertices,
/// where those lie above it, mixed by its barycentric coordinates.
#[inline]
fn lift(
    points: &Points,
    lane: usize,
    geometry: &Geometry,
    segment: &Segment,
    primitive: &Primitive,
) -> Option<(Vec3, Vec3)> {
    let normals = geometry.normals.get(primitive.normals as usize)?;
    let Shape::Triangle { a, b, c } = primitive.shape else { return None };
    let (p, ng, n) = (points.p.get(lane), points.ng.get(lane), points.n.get(lane));
    if !normals.iter().any(|n| leans(*n, ng)) {
        return None;
    }
    let against = n.dot(ng) < 0.0;
    let side = if against != (points.backfacing[lane] != 0) { -1.0 } else { 1.0 };
    let (u, v) = (segment.hit.u, segment.hit.v);
    let mut lift = Vec3::ZERO;
    for ((corner, normal), part) in [a, b, c].into_iter().zip(normals).zip([1.0 - u - v, u, v]) {
        let height = ((corner - p).dot(*normal) * side).max(0.0);
        lift += *normal * (side * part.max(0.0) * height / normal.length_squared());
    }
    Some((lift, if against { -n } else { n }))
}

lanes! {
    /// Multiplies the light of bent lanes by what [`shadowing`] leaves of it.
    fn dim_lanes(bent: &[f32], directions: [&Column3; 3], x: &mut [f32], y: &mut [f32], z: &mut [f32]) {
        let n = x.len();
        let [normal, ng, toward] = directions;
        let (bent, y, z) = (&bent[..n], &mut y[..n], &mut z[..n]);
        for i in 0..n {
            let wi = toward.get(i);
            let left = shadowing(ng.get(i).dot(wi), normal.get(i).dot(wi), normal.get(i).dot(ng.get(i)));
            let left = pick(bent[i] > 0.0, left, 1.0);
            x[i] *= left;
            y[i] *= left;
            z[i] *= left;
        }
    }
}

/// What is left of light of the cosine `flat` to the facet's normal and `smooth` to the smooth one, where these lean by `lean`.
///
/// Source: Chiang, Li and Burley 2019, "Taming the Shadow Terminator": -G^3 + G^2 + G of G = flat / (smooth lean).
/// Domain: cosines. Gives: 0 to 1. Degenerate cases: 1 for light from behind either surface, which does not reflect.
#[inline(always)]
fn shadowing(flat: f32, smooth: f32, lean: f32) -> f32 {
    let over = smooth * lean;
    let g = (flat / over.max(1e-20)).clamp(0.0, 1.0);
    let left = (((1.0 - g) * g + 1.0) * g).min(1.0);
    pick((flat > 0.0) & (over > 0.0), left, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::accel::Hit;

    /// In the middle between two vertices of a ball that are 2 delta apart, light arrives at cos(delta) (1 + sin^2 delta) from the centre,
    /// outside of the ball but by delta^2 / 2; at a vertex it arrives there.
    #[test]
    fn light_arrives_just_outside_of_a_ball() {
        for delta in [0.05f32, 0.2, 0.5] {
            let at = |x: f32, y: f32| Vec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt());
            let corners = [at(delta.sin(), 0.0), at(0.0, delta.sin()), at(-delta.sin(), 0.0)];
            let [a, b, c] = corners;
            let ng = (b - a).cross(c - a).normalize();
            let shape = Shape::Triangle { a, b, c };
            let primitive = Primitive { shape, object: 0, normals: 0, uvs: Primitive::NONE };
            let geometry = Geometry {
                primitives: vec![primitive],
                normals: vec![corners.map(|n| 3.0 * n)],
                ..Geometry::default()
            };
            for (u, v, radius) in
                [(0.0, 0.5, delta.cos() * (1.0 + delta.sin().powi(2))), (0.0, 0.0, 1.0), (1.0, 0.0, 1.0)]
            {
                let p = (1.0 - u - v) * a + u * b + v * c;
                for inside in [false, true] {
                    let side = if inside { -1.0 } else { 1.0 };
                    let hit = Hit { t: 1.0, primitive: 0, u, v };
                    let (origin, direction, ray_type) = (p + side * ng, -side * ng, 1);
                    let segment = Segment { origin, direction, hit, width: 0.0, spread: 0.0, ray_type };
                    let mut points = Points::new(1);
                    points.p.set(0, p);
                    points.ng.set(0, side * ng);
                    points.n.set(0, side * ((1.0 - u - v) * a + u * b + v * c).normalize());
                    points.backfacing[0] = i32::from(inside);
                    let mut smooth = Smooth::default();
                    smooth.find(Terminator::Origin, &points, &geometry, std::iter::once(&segment));
                    smooth.swap(&mut points);
                    let arrives = points.p.get(0);
                    // From inside the ball is hollow, and its facets lie before it.
                    let expected = if inside { p.length() } else { radius };
                    assert!((arrives.length() - expected).abs() < 1e-5, "{delta} {u} {v} {inside}: {arrives}");
                }
            }
        }
    }

    /// The factor never adds light, falls to nothing where the facet turns away, and does nothing where both normals are one.
    #[test]
    fn the_factor_only_takes() {
        let mut taken = 0;
        for k in 0..40_000 {
            let at = |step: f64| ((0.5 + f64::from(k) * step).fract() * 2.0 - 1.0) as f32;
            let n = Vec3::new(at(0.754_877_666), at(0.569_840_29), 1.2).normalize();
            let wi = Vec3::new(at(0.819_172_513), at(0.671_043_607), at(0.549_700_478)).normalize_or(Vec3::Z);
            let left = shadowing(wi.z, n.dot(wi), n.z);
            assert!((0.0..=1.0).contains(&left), "{n} {wi}: {left}");
            taken += u32::from(left < 0.9);
            assert!((shadowing(wi.z, wi.z, 1.0) - 1.0).abs() < 1e-6);
        }
        assert!(taken > 1000);
        assert!(shadowing(1e-6, 0.3, 0.9) < 1e-4);
    }
}
