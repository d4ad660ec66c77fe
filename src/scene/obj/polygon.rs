//! Polygons to triangles: fans where they are convex, else ear by ear.
//!
//! Source: Meisters 1975, "Polygons have ears", for the method; Newell's formula (Sutherland, Sproull and Schumacker 1974)
//! for the normal of a polygon that need not be flat. The corners are looked at along the axis nearest to it, which
//! rounds nothing. Corners that lie on each other, as of a hole that is joined to the rim by a seam, do not stand in the
//! way of an ear.

use glam::{DVec2, DVec3, Vec3};

/// Appends the triangles of the polygon `points`, as indices of three corners in the polygon's order.
///
/// A polygon that crosses itself gives some triangles, at most two less than corners; those without area are left out
/// unless the polygon is a fan. Looking for corners to cut takes steps; when none are left, the rest is cut anyhow.
pub fn triangulate(points: &[Vec3], steps: &mut u64, out: &mut Vec<[u32; 3]>) {
    if points.len() > 3
        && let Some(flat) = flatten(points)
        && !is_convex(&flat)
    {
        return Ears::new(&flat).cut(steps, out);
    }
    out.extend((2..points.len() as u32).map(|k| [0, k - 1, k]));
}

/// The corners in the plane they face, turning to the left; nothing when they span no area.
fn flatten(points: &[Vec3]) -> Option<Vec<DVec2>> {
    let origin = points[0].as_dvec3();
    let relative = |i: usize| points[i % points.len()].as_dvec3() - origin;
    let normal: DVec3 = (0..points.len()).map(|i| relative(i).cross(relative(i + 1))).sum();
    let across = normal.abs();
    if across.max_element() <= 0.0 {
        return None;
    }
    let (x, y, turn) = match across.max_position() {
        0 => (1, 2, normal.x),
        1 => (2, 0, normal.y),
        _ => (0, 1, normal.z),
    };
    let place = |i: usize| {
        let p = points[i];
        let (x, y) = (f64::from(p[x]), f64::from(p[y]));
        if turn > 0.0 { DVec2::new(x, y) } else { DVec2::new(y, x) }
    };
    Some((0..points.len()).map(place).collect())
}

/// Twice the area of a triangle, above zero when it turns to the left.
#[inline]
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// True when every corner turns to the left, and all of them once around.
fn is_convex(flat: &[DVec2]) -> bool {
    let n = flat.len();
    let at = |i: usize| flat[i % n];
    let forth = |i: usize| {
        let edge = at(i + 1) - at(i);
        edge.x > 0.0 || (edge.x == 0.0 && edge.y > 0.0)
    };
    // A star turns to the left too, but goes back and forth more than once.
    (0..n).all(|i| turn(at(i), at(i + 1), at(i + 2)) > 0.0) && (0..n).filter(|&i| forth(i) != forth(i + 1)).count() == 2
}

/// A polygon that loses one corner after another.
struct Ears<'a> {
    flat: &'a [DVec2],
    before: Vec<u32>,
    after: Vec<u32>,
    /// The corners that do not turn to the left: only they can be in the way of an ear.
    hollow: Vec<u32>,
}

impl<'a> Ears<'a> {
    fn new(flat: &'a [DVec2]) -> Self {
        let n = flat.len() as u32;
        let mut ears = Ears {
            flat,
            before: (0..n).map(|i| (i + n - 1) % n).collect(),
            after: (0..n).map(|i| (i + 1) % n).collect(),
            hollow: Vec::new(),
        };
        ears.hollow = (0..n).filter(|&i| ears.turn_at(i) <= 0.0).collect();
        ears
    }

    fn point(&self, corner: u32) -> DVec2 {
        self.flat[corner as usize]
    }

    fn neighbours(&self, corner: u32) -> (u32, u32) {
        (self.before[corner as usize], self.after[corner as usize])
    }

    fn turn_at(&self, corner: u32) -> f64 {
        let (before, after) = self.neighbours(corner);
        turn(self.point(before), self.point(corner), self.point(after))
    }

    /// True when the triangle of a corner and its neighbours lies in the polygon and holds no other corner.
    fn is_ear(&self, corner: u32) -> bool {
        if self.turn_at(corner) <= 0.0 {
            return false;
        }
        let (before, after) = self.neighbours(corner);
        let (a, b, c) = (self.point(before), self.point(corner), self.point(after));
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        !self.hollow.iter().any(|&other| {
            let p = self.point(other);
            p.cmpge(low).all()
                && p.cmple(high).all()
                && ![a, b, c].contains(&p)
                && turn(a, b, p) > 0.0
                && turn(b, c, p) > 0.0
                // Where the cut would go: a corner on it would be left without area.
                && turn(c, a, p) >= 0.0
        })
    }

    fn cut(mut self, steps: &mut u64, out: &mut Vec<[u32; 3]>) {
        let (mut corner, mut left, mut seen) = (0, self.flat.len(), 0);
        while left > 3 {
            // When no corner is an ear, the polygon crosses itself; then any that turns to the left, or any at all.
            *steps = steps.saturating_sub(1 + self.hollow.len() as u64);
            let taken =
                *steps == 0 || self.is_ear(corner) || (seen >= left && self.turn_at(corner) > 0.0) || seen >= 2 * left;
            let (before, after) = self.neighbours(corner);
            if !taken {
                corner = after;
                seen += 1;
                continue;
            }
            self.emit(corner, out);
            self.remove(corner);
            // Not the neighbour: a fan of slivers would grow from one corner.
            (corner, left, seen) = (self.after[after as usize], left - 1, 0);
            for neighbour in [before, after] {
                if self.turn_at(neighbour) > 0.0 {
                    self.hollow.retain(|&other| other != neighbour);
                }
            }
        }
        self.emit(corner, out);
    }

    fn emit(&self, corner: u32, out: &mut Vec<[u32; 3]>) {
        if self.turn_at(corner) != 0.0 {
            let (before, after) = self.neighbours(corner);
            out.push([before, corner, after]);
        }
    }

    fn remove(&mut self, corner: u32) {
        let (before, after) = self.neighbours(corner);
        self.after[before as usize] = after;
        self.before[after as usize] = before;
        self.hollow.retain(|&other| other != corner);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    /// Holds that the triangles of a polygon in the plane z = 0 turn as it does and add up to its area, turned anyhow.
    fn hold(flat: &[[f32; 2]], area: f64) {
        for turned in
            [Quat::IDENTITY, Quat::from_rotation_x(1.0), Quat::from_rotation_y(2.0), Quat::from_rotation_x(3.0)]
        {
            let points: Vec<Vec3> = flat.iter().map(|p| turned * Vec3::new(p[0], p[1], 0.0)).collect();
            let mut triangles = Vec::new();
            triangulate(&points, &mut { u64::MAX }, &mut triangles);
            let normal = (turned * Vec3::Z).as_dvec3();
            let one = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|i| points[i as usize].as_dvec3());
                0.5 * (b - a).cross(c - a).dot(normal)
            };
            assert!(triangles.iter().all(|t| one(t) > -1e-6), "turned round: {flat:?} {triangles:?}");
            let sum: f64 = triangles.iter().map(one).sum();
            assert!((sum - area).abs() < 1e-5 * area.max(1.0), "{sum} in place of {area}: {flat:?} {triangles:?}");
        }
    }

    fn area(flat: &[[f32; 2]]) -> f64 {
        let at = |i: usize| flat[i % flat.len()].map(f64::from);
        (0..flat.len()).map(|i| 0.5 * (at(i)[0] * at(i + 1)[1] - at(i)[1] * at(i + 1)[0])).sum()
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        let cup =
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.5, 1.0], [0.5, -0.5], [-0.5, -0.5], [-0.5, 1.0], [-1.0, 1.0]];
        hold(&cup, 2.5);
        hold(&[[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]], 4.0);
        // A corner in the middle of an edge, and several.
        hold(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 1.0]], 2.0);
        // A square with a square hole, joined by a seam that is walked both ways.
        let seam = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ];
        hold(&seam, 12.0);
    }

    #[test]
    fn random_polygons_around_a_point_are_covered_once() {
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        for corners in (4..120).chain([1000]) {
            let step = std::f32::consts::TAU / corners as f32;
            let polygon: Vec<[f32; 2]> = (0..corners)
                .map(|k| {
                    let (angle, r) = (step * (k as f32 + 0.9 * random()), 0.1 + random());
                    [r * angle.cos(), r * angle.sin()]
                })
                .collect();
            hold(&polygon, area(&polygon));
        }
    }

    #[test]
    fn a_convex_polygon_is_a_fan_and_nothing_hangs_on_a_bad_one() {
        let mut out = Vec::new();
        triangulate(&[Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y], &mut { u64::MAX }, &mut out);
        assert_eq!(out, [[0, 1, 2], [0, 2, 3]]);
        for points in [vec![Vec3::ZERO; 5], vec![Vec3::X, Vec3::Y, Vec3::X, Vec3::Y], vec![], vec![Vec3::X]] {
            out.clear();
            triangulate(&points, &mut { u64::MAX }, &mut out);
            assert!(out.len() <= points.len().saturating_sub(2));
        }
        // A star of five points, drawn in one stroke.
        let star: Vec<Vec3> = (0..5).map(|k| Quat::from_rotation_z(k as f32 * 2.513_274) * Vec3::X).collect();
        out.clear();
        triangulate(&star, &mut { u64::MAX }, &mut out);
        assert!((1..=3).contains(&out.len()));
    }
}
