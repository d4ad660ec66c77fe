//! Displacement: surfaces that a shader moves, before anything else is made of them.
//!
//! A shader of a `type="displacement"` group runs at every corner of every triangle, and where it leaves `P` the corner goes. Spheres and
//! parallelograms become triangles first. Corners at one place, of one element, go to the mean of where they are sent, so that no crack
//! opens; smooth normals are those of the moved triangles around a corner, weighted by area, where they were one normal before.
//!
//! Source: what OSL's testrender does. Differs from it: it welds by the indices of a mesh, which cracks where a mesh names a place twice.
//!
//! Decision (2026-11-29): all of it happens once, when a renderer is made, as the hierarchy is; a camera that moves later does not run
//! displacement anew, though a shader could read `I`. Rays that such shaders trace meet nothing, because there is no hierarchy yet.

mod facets;

use super::host::host;
use super::plan::Needs;
use super::points::fill;
use super::probe::probe;
use super::segment::Segment;
use super::settings::Settings;
use crate::exec::{Group, Host, MAX_LANES, Machine, Points, Report, ReportPlace, Values};
use crate::scene::{Geometry, Material, Place, Primitive, Scene, Shape};
use facets::add_facets;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// The scene with its surfaces moved, where something moves them, and what shaders said meanwhile.
pub fn displaced(scene: &Scene, settings: &Settings) -> (Scene, Vec<Report>) {
    let mut scene = scene.clone();
    let moves = |material: &Material| material.displacement.is_some();
    let moved: Vec<bool> =
        scene.geometry.objects.iter().map(|object| moves(&scene.materials[object.material as usize])).collect();
    if !moved.contains(&true) {
        return (scene, Vec::new());
    }
    let mut geometry = in_facets(&scene.geometry, &moved);
    let host: Arc<dyn Host> = Arc::new(host(&scene.camera, settings, &scene.textures, None));
    let (targets, reports) = targets(&scene, &geometry, &moved, &host);
    move_corners(&mut geometry, &moved, &targets);
    scene.geometry = Arc::new(geometry);
    (scene, reports)
}

/// The same geometry, with triangles in place of the primitives of objects that are moved.
fn in_facets(from: &Geometry, moved: &[bool]) -> Geometry {
    let mut to = Geometry { objects: from.objects.clone(), ..Geometry::default() };
    for (number, primitive) in from.primitives.iter().enumerate() {
        if moved[primitive.object as usize] {
            add_facets(from, number, &mut to);
            continue;
        }
        let [mut normals, mut uvs] = [Primitive::NONE; 2];
        if let Some(three) = from.normals.get(primitive.normals as usize) {
            normals = to.normals.len() as u32;
            to.normals.push(*three);
        }
        if let Some(three) = from.uvs.get(primitive.uvs as usize) {
            uvs = to.uvs.len() as u32;
            to.uvs.push(*three);
        }
        to.primitives.push(Primitive { normals, uvs, ..*primitive });
    }
    to
}

/// Where shaders send the corners of each triangle that they move; nothing for other primitives.
fn targets(
    scene: &Scene,
    geometry: &Geometry,
    moved: &[bool],
    host: &Arc<dyn Host>,
) -> (Vec<Option<[Vec3; 3]>>, Vec<Report>) {
    let mut of_material: HashMap<u32, Vec<u32>> = HashMap::new();
    for (number, primitive) in geometry.primitives.iter().enumerate() {
        if moved[primitive.object as usize] {
            let material = geometry.objects[primitive.object as usize].material;
            of_material.entry(material).or_default().push(number as u32);
        }
    }
    let mut materials: Vec<_> = of_material.into_iter().collect();
    materials.sort_unstable_by_key(|(material, _)| *material);
    let (mut out, mut reports) = (vec![None; geometry.primitives.len()], Vec::new());
    for (material, primitives) in materials {
        let material = &scene.materials[material as usize];
        let Some(group) = &material.displacement else { continue };
        let batches: Vec<_> = primitives
            .par_chunks(MAX_LANES / 3)
            .map_init(
                || Batch { machine: Machine::with_host(host.clone()), points: Points::default() },
                |batch, primitives| batch.shade(group, geometry, primitives, scene.camera.eye),
            )
            .collect();
        let mut lost = 0;
        for (primitives, (corners, said)) in primitives.chunks(MAX_LANES / 3).zip(batches) {
            for (&number, sent) in primitives.iter().zip(corners) {
                let kept = corners_of(&geometry.primitives[number as usize].shape);
                lost += sent.iter().filter(|p| !p.is_finite()).count();
                out[number as usize] = Some([0, 1, 2].map(|k| if sent[k].is_finite() { sent[k] } else { kept[k] }));
            }
            reports.extend(said);
        }
        if lost > 0 {
            let text = format!("displacement group `{}` sends {lost} corners nowhere; they stay", material.name);
            let file = material.place.to_string();
            reports.push(Report::mistake(ReportPlace { file, ..ReportPlace::default() }, text));
        }
    }
    (out, reports)
}

/// One thread's scratch.
struct Batch {
    machine: Machine,
    points: Points,
}

impl Batch {
    /// Where the corners of some triangles are sent.
    fn shade(
        &mut self,
        group: &Group,
        geometry: &Geometry,
        primitives: &[u32],
        eye: Vec3,
    ) -> (Vec<[Vec3; 3]>, Vec<Report>) {
        let corner = |number: u32, k: usize| {
            let mut segment = probe(geometry, number, 0.0, 0.0);
            (segment.hit.u, segment.hit.v) = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)][k];
            segment
        };
        let segments: Vec<Segment> =
            primitives.iter().flat_map(|&number| [0, 1, 2].map(|k| corner(number, k))).collect();
        let points = &mut self.points;
        points.resize(segments.len());
        fill(points, geometry, segments.iter(), &Needs::of(group));
        for (lane, &number) in primitives.iter().flat_map(|number| [number; 3]).enumerate() {
            let p = corners_of(&geometry.primitives[number as usize].shape)[lane % 3];
            points.p.set(lane, p);
            points.i.set(lane, (p - eye).normalize_or(Vec3::NEG_Z));
        }
        self.machine.shade(group, points);
        let sent = self.machine.output(group, "P");
        let sent = |lane: usize| match sent.map(|view| view.lane(lane)) {
            Some(Values::Floats(p)) if p.len() == 3 => Vec3::new(p[0], p[1], p[2]),
            _ => self.points.p.get(lane),
        };
        let corners = (0..primitives.len()).map(|i| [0, 1, 2].map(|k| sent(3 * i + k))).collect();
        (corners, self.machine.take_reports())
    }
}

fn corners_of(shape: &Shape) -> [Vec3; 3] {
    match *shape {
        Shape::Triangle { a, b, c } => [a, b, c],
        // Only triangles are moved.
        Shape::Sphere { center, .. } => [center; 3],
        Shape::Quad { corner, .. } => [corner; 3],
    }
}

/// The bits of a place or direction, 0 for -0.
fn bits(v: Vec3) -> [u32; 3] {
    v.to_array().map(|x| (x + 0.0).to_bits())
}

/// What lies at one place of one element.
type At = (u32, [u32; 3]);

/// A sum and how many parts it has.
#[derive(Clone, Copy, Default)]
struct Mean {
    sum: glam::DVec3,
    count: f64,
}

/// Moves the corners, also those of triangles of the same element that no shader moves but which share them; then makes smooth normals
/// and areas anew.
fn move_corners(geometry: &mut Geometry, moved: &[bool], targets: &[Option<[Vec3; 3]>]) {
    let elements = elements(geometry);
    let element = |primitive: &Primitive| elements[primitive.object as usize];
    let mut means: HashMap<At, Mean> = HashMap::new();
    let mut add = |primitive: &Primitive, sent: [Vec3; 3], only_known: bool| {
        for (from, to) in corners_of(&primitive.shape).into_iter().zip(sent) {
            let at = (element(primitive), bits(from));
            if only_known && !means.contains_key(&at) {
                continue;
            }
            let mean = means.entry(at).or_default();
            (mean.sum, mean.count) = (mean.sum + to.as_dvec3(), mean.count + 1.0);
        }
    };
    for (primitive, sent) in geometry.primitives.iter().zip(targets) {
        if let Some(sent) = sent {
            add(primitive, *sent, false);
        }
    }
    let still = |primitive: &Primitive| matches!(primitive.shape, Shape::Triangle { .. });
    for (primitive, _) in geometry.primitives.iter().zip(targets).filter(|(p, sent)| sent.is_none() && still(p)) {
        add(primitive, corners_of(&primitive.shape), true);
    }
    let sent = |primitive: &Primitive| {
        corners_of(&primitive.shape).map(|p| match means.get(&(element(primitive), bits(p))) {
            Some(mean) => (mean.sum / mean.count).as_vec3(),
            None => p,
        })
    };
    let shapes: Vec<Option<[Vec3; 3]>> =
        geometry.primitives.iter().map(|primitive| still(primitive).then(|| sent(primitive))).collect();
    smooth(geometry, &elements, &shapes);
    for (primitive, sent) in geometry.primitives.iter_mut().zip(&shapes) {
        if let Some([a, b, c]) = *sent {
            primitive.shape = Shape::Triangle { a, b, c };
        }
    }
    let sound = |p: &Primitive| p.shape.area() > 0.0 && p.shape.area().is_finite();
    geometry.primitives.retain(|p| !moved[p.object as usize] || sound(p));
    measure(geometry, moved);
}

/// A number for each object, the same for those of one element of the scene.
fn elements(geometry: &Geometry) -> Vec<u32> {
    let mut known: HashMap<String, u32> = HashMap::new();
    let number = |place: &Place| {
        let next = known.len() as u32;
        *known.entry(place.to_string()).or_insert(next)
    };
    geometry.objects.iter().map(|object| &object.place).map(number).collect()
}

/// Gives triangles whose corners have moved the normals of their new neighbourhood.
fn smooth(geometry: &mut Geometry, elements: &[u32], moved_to: &[Option<[Vec3; 3]>]) {
    let mut sums: HashMap<(At, [u32; 3]), glam::DVec3> = HashMap::new();
    let Geometry { primitives, normals, .. } = geometry;
    let changed = |primitive: &Primitive, sent: &Option<[Vec3; 3]>| {
        sent.filter(|sent| *sent != corners_of(&primitive.shape) && normals.len() > primitive.normals as usize)
    };
    let triangles: Vec<(usize, [Vec3; 3])> = primitives
        .iter()
        .zip(moved_to)
        .enumerate()
        .filter_map(|(number, (primitive, sent))| changed(primitive, sent).map(|sent| (number, sent)))
        .collect();
    let key = |primitive: &Primitive, k: usize, normal: Vec3| {
        let at = (elements[primitive.object as usize], bits(corners_of(&primitive.shape)[k]));
        (at, bits(normal))
    };
    for (number, [a, b, c]) in &triangles {
        let primitive = &primitives[*number];
        let three = normals[primitive.normals as usize];
        let [p, q, r] = corners_of(&primitive.shape);
        // Normals may point to the other side of their triangles, and then go on to.
        let side = if (q - p).cross(r - p).dot(three[0] + three[1] + three[2]) < 0.0 { -1.0 } else { 1.0 };
        let normal = side * (b.as_dvec3() - a.as_dvec3()).cross(c.as_dvec3() - a.as_dvec3());
        for (k, old) in three.into_iter().enumerate() {
            *sums.entry(key(primitive, k, old)).or_default() += normal;
        }
    }
    for (number, _) in &triangles {
        let primitive = &primitives[*number];
        let three = &mut normals[primitive.normals as usize];
        let old = *three;
        for k in 0..3 {
            let sum = sums.get(&key(primitive, k, old[k])).copied().unwrap_or_default();
            three[k] = sum.normalize_or(old[k].as_dvec3()).as_vec3();
        }
    }
}

/// Makes the areas of moved objects anew; objects that shared one, as the parts of a mesh do, share the new one.
fn measure(geometry: &mut Geometry, moved: &[bool]) {
    let mut areas = vec![0.0f64; geometry.objects.len()];
    for primitive in &geometry.primitives {
        areas[primitive.object as usize] += f64::from(primitive.shape.area());
    }
    let key = |number: usize, geometry: &Geometry| {
        let object = &geometry.objects[number];
        (object.place.to_string(), object.surface_area.to_bits())
    };
    let mut together: HashMap<(String, u32), f64> = HashMap::new();
    for (number, area) in areas.iter().enumerate() {
        *together.entry(key(number, geometry)).or_default() += area;
    }
    for number in 0..areas.len() {
        let whole = together.get(&key(number, geometry)).copied().unwrap_or_default();
        if moved[number] {
            geometry.objects[number].surface_area = whole as f32;
        }
    }
}
