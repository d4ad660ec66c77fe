//! Rays against geometry: the hierarchy against every primitive alone, against double precision, and on hard cases.

use glam::{DVec3, Vec3};
use std::f32::consts::TAU;
use velour::render::accel::{Accel, Hit, Method, NOTHING, Ray};
use velour::render::random;
use velour::scene::{Geometry, Primitive, Shape};

const SEED: u32 = 11;

fn geometry(shapes: &[Shape]) -> Geometry {
    let (normals, uvs) = (Primitive::NONE, Primitive::NONE);
    let primitives = shapes.iter().map(|&shape| Primitive { shape, object: 0, normals, uvs }).collect();
    Geometry { primitives, ..Geometry::default() }
}

fn number(i: u32, set: u32) -> Vec3 {
    let r = random::sample(SEED, i, set);
    Vec3::new(r[0], r[1], r[2]) * 2.0 - 1.0
}

fn direction(i: u32, set: u32) -> Vec3 {
    number(i, set).try_normalize().unwrap_or(Vec3::X)
}

/// Triangles large and small, slivers, points, twins that lie on each other, and a few spheres and quads.
fn soup(count: u32, scale: f32) -> Vec<Shape> {
    let shape = |i: u32| {
        let (a, x, y) = (number(i, 0), number(i, 1), number(i, 2));
        let size = (random::sample(SEED, i, 3)[0] * 4.0 - 4.0).exp2();
        match i % 16 {
            0 => Shape::Sphere { center: a * scale, radius: 0.3 * size * scale },
            1 => Shape::Quad { corner: a * scale, edge_x: x * size * scale, edge_y: y * size * scale },
            2 => Shape::Triangle { a: a * scale, b: (a + x * size) * scale, c: (a + x * size * 1.001) * scale },
            3 => Shape::Triangle { a: a * scale, b: a * scale, c: a * scale },
            4 => Shape::Triangle { a: Vec3::ZERO, b: Vec3::X * scale, c: Vec3::Y * scale },
            _ => Shape::Triangle { a: a * scale, b: (a + x * size) * scale, c: (a + y * size) * scale },
        }
    };
    (0..count).map(shape).collect()
}

/// Random rays, rays along axes and in planes of axes, from points of a grid that many corners share.
fn rays(count: u32, scale: f32) -> Vec<Ray> {
    let ray = |i: u32| {
        let axis = Vec3::from_array([0, 1, 2].map(|k| if i / 4 % 3 == k { 1.0 } else { 0.0 }));
        let origin = number(i, 4) * 1.5 * scale;
        let (origin, direction) = match i % 4 {
            0 => (origin, axis),
            1 => (origin, (direction(i, 5) * (Vec3::ONE - axis)).normalize_or(Vec3::Y)),
            2 => ((origin * 2.0 / scale).round() * 0.5 * scale, -axis),
            _ => (origin, direction(i, 5)),
        };
        Ray::new(origin, direction)
    };
    (0..count).map(ray).collect()
}

fn closest(accel: &Accel, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = Vec::new();
    accel.closest(rays, &mut hits);
    hits
}

/// The nearest hit over all primitives, each asked alone; of equal ones the first.
fn one_by_one(shapes: &[Shape], rays: &[Ray]) -> Vec<Hit> {
    let mut best = vec![Hit::NONE; rays.len()];
    for (id, shape) in shapes.iter().enumerate() {
        let alone = Accel::with(&geometry(&[*shape]), Method::Wide);
        for (best, hit) in best.iter_mut().zip(closest(&alone, rays)) {
            if hit.t < best.t {
                *best = Hit { primitive: id as u32, ..hit };
            }
        }
    }
    best
}

#[test]
fn the_hierarchy_finds_what_asking_every_primitive_finds() {
    for scale in [1.0, 1e-9, 1e9] {
        let shapes = soup(400, scale);
        let rays = rays(4000, scale);
        let expected = one_by_one(&shapes, &rays);
        let found = closest(&Accel::with(&geometry(&shapes), Method::Wide), &rays);
        for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
            assert_eq!(found, expected, "scale {scale}, ray {i}: {:?}", rays[i]);
        }
        let hits = found.iter().filter(|hit| hit.primitive != NOTHING).count();
        assert!(hits > 1000, "scale {scale}: only {hits} hits, which proves little");
    }
}

#[test]
fn something_is_in_the_way_exactly_when_the_closest_hit_is() {
    let shapes = soup(400, 1.0);
    let accel = Accel::with(&geometry(&shapes), Method::Wide);
    let mut rays = rays(4000, 1.0);
    let found = closest(&accel, &rays);
    for (i, ray) in rays.iter_mut().enumerate() {
        // A third each: just short of the hit, just beyond it, and anywhere.
        let share = [1.0 - 1e-6, 1.0 + 1e-6, 2.0 * random::sample(SEED, i as u32, 6)[0]][i % 3];
        ray.reach = if found[i].t < 1e9 { found[i].t * share } else { 10.0 };
    }
    let mut blocked = Vec::new();
    accel.any(&rays, &mut blocked);
    let expected: Vec<bool> = rays.iter().zip(&found).map(|(ray, hit)| hit.t < ray.reach).collect();
    assert_eq!(blocked, expected);
    assert!(blocked.iter().filter(|b| **b).count() > 500);
    // What a ray starts on and what it goes to are not in its way.
    let alone = Accel::with(&geometry(&shapes[5..6]), Method::Wide);
    for ray in &mut rays {
        *ray = if ray.reach > 5.0 { Ray { skip: 0, ..*ray } } else { Ray { target: 0, ..*ray } };
    }
    alone.any(&rays, &mut blocked);
    assert!(blocked.iter().all(|b| !b));
}

#[test]
fn a_few_primitives_are_met_alike_with_and_without_a_hierarchy() {
    let flat = |s: &Shape| !matches!(s, Shape::Triangle { .. });
    let mut hits = 0;
    for count in [1, 7, 24] {
        let shapes: Vec<Shape> = soup(400, 1.0).into_iter().filter(flat).take(count).collect();
        let (few, wide) = (Accel::new(&geometry(&shapes)), Accel::with(&geometry(&shapes), Method::Wide));
        assert!(few.bytes() == 0 && wide.bytes() > 0, "both are by one method");
        let mut rays = rays(20_003, 1.0);
        let found = closest(&wide, &rays);
        for (i, ray) in rays.iter_mut().enumerate() {
            // Up to the first hit or about there; from what is met, or to it; and as they are.
            match i % 5 {
                0 => ray.reach = found[i].t,
                1 => ray.reach = found[i].t * [1.0 - 1e-6, 1.0 + 1e-6, 0.5, 2.0][i / 5 % 4],
                2 => ray.skip = found[i].primitive,
                3 => ray.target = found[i].primitive,
                _ => (),
            }
        }
        let found = closest(&few, &rays);
        assert_eq!(found, closest(&wide, &rays));
        hits += found.iter().filter(|hit| hit.primitive != NOTHING).count();
        assert!(rays.iter().zip(&found).all(|(ray, hit)| hit.primitive == NOTHING || hit.primitive != ray.target));
        let (mut by_few, mut by_wide) = (Vec::new(), Vec::new());
        few.any(&rays, &mut by_few);
        wide.any(&rays, &mut by_wide);
        assert_eq!(by_few, by_wide);
        let expected: Vec<bool> = rays.iter().zip(&found).map(|(ray, hit)| hit.t < ray.reach).collect();
        assert_eq!(by_few, expected);
    }
    assert!(hits > 500, "only {hits} hits, which prove little");
}

#[test]
fn what_a_ray_goes_to_is_not_its_closest_hit_whatever_its_form() {
    let ahead = |z: f32| Vec3::new(-1.0, -1.0, z);
    let forms = |z: f32| {
        [
            Shape::Sphere { center: Vec3::new(0.0, 0.0, z), radius: 0.5 },
            Shape::Quad { corner: ahead(z), edge_x: Vec3::X * 2.0, edge_y: Vec3::Y * 2.0 },
            Shape::Triangle { a: ahead(z), b: ahead(z) + Vec3::X * 4.0, c: ahead(z) + Vec3::Y * 4.0 },
        ]
    };
    for (near, far) in forms(2.0).into_iter().zip(forms(4.0)) {
        for method in [Method::Few, Method::Wide] {
            let accel = Accel::with(&geometry(&[near, far]), method);
            let ray = Ray::new(Vec3::new(0.01, 0.02, 0.0), Vec3::Z);
            let to = |target: u32| closest(&accel, &[Ray { target, ..ray }])[0].primitive;
            assert_eq!((to(NOTHING), to(0), to(1)), (0, 1, 0), "{near:?} by {method:?}");
        }
    }
}

/// Distance and weights of b and c by Cramer's rule in double precision.
fn exact(shape: &Shape, ray: &Ray) -> Option<(f64, f64, f64)> {
    let Shape::Triangle { a, b, c } = *shape else { return None };
    let [a, b, c, o, d] =
        [a, b, c, ray.origin, ray.direction].map(|x: Vec3| DVec3::new(x.x.into(), x.y.into(), x.z.into()));
    let (x, y, from) = (b - a, c - a, o - a);
    let p = d.cross(y);
    let determinant = x.dot(p);
    let q = from.cross(x);
    let (u, v, t) = (from.dot(p) / determinant, d.dot(q) / determinant, y.dot(q) / determinant);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((t, u, v))
}

#[test]
fn triangles_are_hit_where_double_precision_has_it() {
    let shapes: Vec<Shape> = soup(600, 1.0).into_iter().filter(|s| matches!(s, Shape::Triangle { .. })).collect();
    let rays: Vec<Ray> = (0..4000).map(|i| Ray::new(number(i, 7) * 1.5, direction(i, 8))).collect();
    let found = closest(&Accel::with(&geometry(&shapes), Method::Wide), &rays);
    let (mut differ, mut hits) = (0, 0);
    for (ray, hit) in rays.iter().zip(&found) {
        let all = shapes.iter().enumerate().filter_map(|(id, s)| exact(s, ray).map(|e| (id as u32, e)));
        let expected = all.min_by(|a, b| a.1.0.total_cmp(&b.1.0));
        match expected {
            Some((id, (t, u, v))) if id == hit.primitive => {
                hits += 1;
                assert!((f64::from(hit.t) - t).abs() < 1e-5 * t.max(0.1), "{t} {hit:?}");
                // Slivers have weights that are worth little.
                let sure = shapes[id as usize].area() > 1e-4;
                assert!(!sure || (f64::from(hit.u) - u).abs() + (f64::from(hit.v) - v).abs() < 1e-3, "{u} {v} {hit:?}");
            }
            None if hit.primitive == NOTHING => {}
            // A ray along an edge may go either way.
            _ => differ += 1,
        }
    }
    assert!(hits > 500 && differ <= 4, "{hits} hits, {differ} rays differ");
}

/// A ball of triangles whose neighbours share corners to the last bit.
fn ball(n: u32, scale: f32) -> Vec<Shape> {
    let point = |i: u32, j: u32| {
        let z = (1.0 - 2.0 * i as f32 / n as f32).clamp(-1.0, 1.0);
        let (sin, cos) = (TAU * (j % n) as f32 / n as f32).sin_cos();
        let flat = if i.is_multiple_of(n) { 0.0 } else { (1.0 - z * z).sqrt() };
        Vec3::new(flat * cos, flat * sin, z) * scale + Vec3::splat(scale)
    };
    let mut shapes = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let (a, b, c, d) = (point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
            shapes.extend([Shape::Triangle { a, b, c }, Shape::Triangle { a, b: c, c: d }]);
        }
    }
    shapes
}

#[test]
fn no_ray_slips_out_of_a_closed_mesh() {
    for scale in [1.0, 1e-6, 1e6] {
        let shapes = ball(24, scale);
        let accel = Accel::with(&geometry(&shapes), Method::Wide);
        // Toward corners and points of edges, where a leak would be.
        let mut rays = Vec::new();
        for (i, shape) in shapes.iter().enumerate() {
            let Shape::Triangle { a, b, .. } = *shape else { continue };
            let origin = Vec3::splat(scale) + 0.4 * scale * number(i as u32, 9);
            for part in [0.0, 0.25, 0.5, random::sample(SEED, i as u32, 10)[0]] {
                rays.push(Ray::new(origin, (a + (b - a) * part - origin).normalize()));
            }
        }
        let lost = closest(&accel, &rays).iter().filter(|hit| hit.primitive == NOTHING).count();
        assert_eq!(lost, 0, "of {} rays at scale {scale}", rays.len());
    }
}

#[test]
fn of_twins_the_first_is_hit_and_a_thousand_on_one_place_do_no_harm() {
    let one =
        Shape::Triangle { a: Vec3::new(-1.0, -1.0, 0.0), b: Vec3::new(1.0, -1.0, 0.0), c: Vec3::new(0.0, 1.0, 0.0) };
    let accel = Accel::with(&geometry(&vec![one; 1000]), Method::Wide);
    let ray = Ray::new(Vec3::new(0.0, 0.0, 3.0), Vec3::NEG_Z);
    assert_eq!(closest(&accel, &[ray])[0].primitive, 0);
    assert_eq!(closest(&accel, &[Ray { skip: 0, ..ray }])[0].primitive, 1);
    assert_eq!(closest(&Accel::with(&geometry(&[]), Method::Wide), &[ray])[0], Hit::NONE);
}

/// Numbers that a ray should not have, or only just.
const AWKWARD: [f32; 14] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1e-45,
    -1e-45,
    0.0,
    -0.0,
    1e30,
    -1e30,
    1e-20,
    1.0,
];

/// Rays of which any number may be awkward; every fourth has but one that is.
fn awkward_rays(count: u32) -> Vec<Ray> {
    let ray = |i: u32| {
        let dice: Vec<[f32; 4]> = (0..7).map(|k| random::sample(SEED, i, 20 + k)).collect();
        let mut numbers = [0.0; 7];
        numbers[..3].copy_from_slice(&(number(i, 4) * 1.5).to_array());
        numbers[3..6].copy_from_slice(&direction(i, 5).to_array());
        numbers[6] = 3.0;
        for (k, x) in numbers.iter_mut().enumerate() {
            let changed = if i.is_multiple_of(4) { k == (dice[0][0] * 7.0) as usize } else { dice[k][1] < 0.5 };
            if changed {
                *x = AWKWARD[(dice[k][2] * AWKWARD.len() as f32) as usize];
            }
        }
        let [ox, oy, oz, dx, dy, dz, reach] = numbers;
        let which = |x: f32| if x < 0.5 { NOTHING } else { (x * 40.0) as u32 };
        let (skip, target) = (which(dice[0][3]), which(dice[1][3]));
        Ray { origin: Vec3::new(ox, oy, oz), direction: Vec3::new(dx, dy, dz), reach, skip, target }
    };
    (0..count).map(ray).collect()
}

#[test]
fn no_ray_is_too_awkward() {
    let flat: Vec<Shape> =
        soup(400, 1.0).into_iter().filter(|s| !matches!(s, Shape::Triangle { .. })).take(24).collect();
    let rays = awkward_rays(20_000);
    let mut hits = 0;
    // A dozen triangles have nodes with empty places, which only a ray without a direction came into.
    for shapes in [flat, soup(400, 1.0), soup(400, 1e30), ball(2, 1.0), vec![soup(6, 1.0)[5]]] {
        let all = geometry(&shapes);
        for accel in [Accel::new(&all), Accel::with(&all, Method::Wide)] {
            let found = closest(&accel, &rays);
            let mut blocked = Vec::new();
            accel.any(&rays, &mut blocked);
            for ((ray, hit), blocked) in rays.iter().zip(&found).zip(blocked) {
                let whole = ray.origin.is_finite() && ray.direction.is_finite() && !ray.reach.is_nan();
                assert!(whole || *hit == Hit::NONE && !blocked, "{ray:?} meets {hit:?}");
                let met = (hit.primitive as usize) < shapes.len() && hit.t > 0.0 && hit.t <= ray.reach;
                assert!(met || *hit == Hit::NONE, "{ray:?} gives {hit:?}");
            }
            hits += found.iter().filter(|hit| hit.primitive != NOTHING).count();
        }
    }
    assert!(hits > 5000, "only {hits} hits, which prove little");
}
