//! Displacement: surfaces that a shader moves, before anything else is made of them.
//!
//! A shader of a `type="displacement"` group runs at every corner of every triangle, and where it leaves `P` the corner goes. Spheres and
//! parallelograms become triangles first. Corners at one place, of one element, go to the mean of the different places that they are sent
//! to, so that no crack opens and the way a polygon is cut does not show; smooth normals are those of the triangles around a corner,
//! weighted by area, where they were one normal before. Such shaders see no derivatives.
//!
//! Source: what OSL's testrender does. Differs from it: it welds by the indices of a mesh, which cracks where a mesh names a place twice.
//!
//! Decision (2026-11-29): all of it happens once, when a renderer is made, as the hierarchy is; a camera that moves later does not run
//! displacement anew, though a shader could read `I`. Rays that such shaders trace meet nothing, because there is no hierarchy yet.

mod facets;

use super::error::RenderError;
use super::host::host;
use super::plan::Needs;
use super::points::fill;
use super::probe::probe;
use super::segment::{Segment, ray_type};
use super::settings::Settings;
use super::stop::Stop;
use super::told::Told;
use crate::exec::{Group, Host, MAX_LANES, Machine, Points, Report, ReportPlace, Values};
use crate::limits::MADE_TRIANGLES;
use crate::scene::{Geometry, Material, Place, Primitive, Scene, Shape};
use facets::{add_as_it_is, add_facets, facets_of};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The scene with its surfaces moved, where something moves them, and what shaders said meanwhile.
///
/// # Errors
/// The surfaces that are moved take more than [`MADE_TRIANGLES`] triangles.
pub fn displaced(scene: &Scene, settings: &Settings, stop: &Arc<Stop>) -> Result<(Scene, Vec<Report>), RenderError> {
    let mut scene = scene.clone();
    let moves = |material: &Material| material.displacement.is_some();
    let moved: Vec<bool> =
        scene.geometry.objects.iter().map(|object| moves(&scene.materials[object.material as usize])).collect();
    if !moved.contains(&true) {
        return Ok((scene, Vec::new()));
    }
    let primitives = scene.geometry.primitives.iter().enumerate();
    let facets = primitives.filter(|(_, p)| moved[p.object as usize]).map(|(at, _)| facets_of(&scene.geometry, at));
    let facets = facets.fold(0, u64::saturating_add);
    if facets > MADE_TRIANGLES {
        return Err(RenderError::Facets { facets, most: MADE_TRIANGLES });
    }
    let mut geometry = in_facets(&scene.geometry, &moved);
    let host: Arc<dyn Host> = Arc::new(host(&scene.camera, settings, &scene.textures, None).until(stop));
    let (targets, mut reports) = targets(&scene, &geometry, &moved, &host);
    let lost = move_corners(&mut geometry, &moved, &targets);
    if lost > 0 {
        reports.push(Report::warning(format!("displacement leaves {lost} triangles no area; they are left out")));
    }
    scene.geometry = Arc::new(geometry);
    Ok((scene, reports))
}

/// The same geometry, with triangles in place of the primitives of objects that are moved.
fn in_facets(from: &Geometry, moved: &[bool]) -> Geometry {
    let mut to = Geometry { objects: from.objects.clone(), ..Geometry::default() };
    for (number, primitive) in from.primitives.iter().enumerate() {
        match moved[primitive.object as usize] {
            true => add_facets(from, number, &mut to),
            false => add_as_it_is(from, number, &mut to),
        }
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
    let (mut out, mut reports, mut told) = (vec![None; geometry.primitives.len()], Vec::new(), Told::default());
    for (material, primitives) in materials {
        let material = &scene.materials[material as usize];
        let Some(group) = &material.displacement else { continue };
        let (needs, mut lost) = (Needs::of(group), 0);
        for wave in primitives.chunks(WAVE * (MAX_LANES / 3)) {
            let batches = wave.par_chunks(MAX_LANES / 3).map_init(
                || Batch { machine: Machine::with_host(host.clone()), points: Points::default() },
                |batch, primitives| batch.shade(group, &needs, geometry, primitives, scene.camera.eye),
            );
            let batches: Vec<_> = batches.collect();
            for (primitives, (corners, said)) in wave.chunks(MAX_LANES / 3).zip(batches) {
                for (&number, sent) in primitives.iter().zip(corners) {
                    let kept = corners_of(&geometry.primitives[number as usize].shape);
                    lost += sent.iter().filter(|p| !p.is_finite()).count();
                    out[number as usize] = Some([0, 1, 2].map(|k| if sent[k].is_finite() { sent[k] } else { kept[k] }));
                }
                reports.extend(said.into_iter().filter(|report| told.is_new(report)));
            }
        }
        if lost > 0 {
            let text = format!("displacement group `{}` sends {lost} corners nowhere; they stay", material.name);
            let file = material.place.to_string();
            reports.push(Report::mistake(ReportPlace { file, ..ReportPlace::default() }, text));
        }
    }
    (out, reports)
}

/// Batches that are shaded before what they say is looked through.
const WAVE: usize = 256;

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
        needs: &Needs,
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
        fill(points, geometry, segments.iter(), needs);
        for (lane, &number) in primitives.iter().flat_map(|number| [number; 3]).enumerate() {
            let p = corners_of(&geometry.primitives[number as usize].shape)[lane % 3];
            points.p.set(lane, p);
            points.i.set(lane, (p - eye).normalize_or(Vec3::NEG_Z));
        }
        points.ray_type.fill(ray_type::DISPLACEMENT);
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

/// Moves the corners, also those of triangles of the same element that no shader moves but which share them; then makes smooth normals
/// and areas anew. Gives how many triangles have lost their area.
fn move_corners(geometry: &mut Geometry, moved: &[bool], targets: &[Option<[Vec3; 3]>]) -> usize {
    let elements = elements(geometry);
    let before = areas(geometry);
    let element = |primitive: &Primitive| elements[primitive.object as usize];
    // The sum of the different places that a corner is sent to, and how many they are.
    let mut sent: HashMap<At, (DVec3, f64)> = HashMap::new();
    let mut seen: HashSet<(At, [u32; 3])> = HashSet::new();
    let mut send = |at: At, to: Vec3, only_known: bool| {
        if (!only_known || sent.contains_key(&at)) && seen.insert((at, bits(to))) {
            let (sum, count) = sent.entry(at).or_default();
            (*sum, *count) = (*sum + to.as_dvec3(), *count + 1.0);
        }
    };
    let still = |primitive: &Primitive| matches!(primitive.shape, Shape::Triangle { .. });
    for only_known in [false, true] {
        for (primitive, target) in geometry.primitives.iter().zip(targets) {
            let from = corners_of(&primitive.shape);
            let to = match (only_known, target) {
                (false, Some(target)) => *target,
                (true, None) if still(primitive) => from,
                _ => continue,
            };
            from.into_iter().zip(to).for_each(|(from, to)| send((element(primitive), bits(from)), to, only_known));
        }
    }
    let mean = |(sum, count): &(DVec3, f64)| (*sum / *count).as_vec3();
    let moved_to = |primitive: &Primitive| {
        corners_of(&primitive.shape).map(|p| sent.get(&(element(primitive), bits(p))).map_or(p, mean))
    };
    let shapes: Vec<Option<[Vec3; 3]>> =
        geometry.primitives.iter().map(|primitive| still(primitive).then(|| moved_to(primitive))).collect();
    smooth(geometry, &elements, &shapes);
    let (mut touched, mut lost) = (moved.to_vec(), 0);
    let mut shapes = shapes.into_iter();
    geometry.primitives.retain_mut(|primitive| {
        let Some([a, b, c]) = shapes.next().flatten() else { return true };
        if [a, b, c] == corners_of(&primitive.shape) {
            return true;
        }
        primitive.shape = Shape::Triangle { a, b, c };
        touched[primitive.object as usize] = true;
        let (area, before) = (primitive.shape.area(), lost);
        lost += usize::from(!(area > 0.0 && area.is_finite()));
        lost == before
    });
    measure(geometry, &elements, &before, &touched);
    lost
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

/// A corner of an element and the normal that it has.
type Bend = (At, [u32; 3]);

/// Gives corners whose neighbourhood has moved the normals of the new one.
fn smooth(geometry: &mut Geometry, elements: &[u32], moved_to: &[Option<[Vec3; 3]>]) {
    let Geometry { primitives, normals, .. } = geometry;
    let bends = |primitive: &Primitive, three: &[Vec3; 3]| -> [Bend; 3] {
        let (element, corners) = (elements[primitive.object as usize], corners_of(&primitive.shape));
        [0, 1, 2].map(|k| ((element, bits(corners[k])), bits(three[k])))
    };
    let mut sums: HashMap<Bend, DVec3> = HashMap::new();
    for (primitive, to) in primitives.iter().zip(moved_to) {
        let three = normals.get(primitive.normals as usize);
        if let (Some(three), Some(to)) = (three, to)
            && *to != corners_of(&primitive.shape)
        {
            sums.extend(bends(primitive, three).map(|bend| (bend, DVec3::ZERO)));
        }
    }
    for (primitive, to) in primitives.iter().zip(moved_to) {
        let (Some(three), Some(to)) = (normals.get(primitive.normals as usize), to) else { continue };
        let normal = |[a, b, c]: [Vec3; 3]| (b.as_dvec3() - a.as_dvec3()).cross(c.as_dvec3() - a.as_dvec3());
        // Normals may point to the other side of their triangles, and then go on to.
        let against = normal(corners_of(&primitive.shape)).dot((three[0] + three[1] + three[2]).as_dvec3()) < 0.0;
        let normal = if against { -normal(*to) } else { normal(*to) };
        for bend in bends(primitive, three) {
            sums.entry(bend).and_modify(|sum| *sum += normal);
        }
    }
    for (primitive, _) in primitives.iter().zip(moved_to).filter(|(_, to)| to.is_some()) {
        let Some(three) = normals.get_mut(primitive.normals as usize) else { continue };
        for (k, bend) in bends(primitive, three).into_iter().enumerate() {
            if let Some(sum) = sums.get(&bend) {
                three[k] = sum.normalize_or(three[k].as_dvec3()).as_vec3();
            }
        }
    }
}

/// The area of each object's own primitives.
fn areas(geometry: &Geometry) -> Vec<f64> {
    let mut areas = vec![0.0; geometry.objects.len()];
    for primitive in &geometry.primitives {
        areas[primitive.object as usize] += f64::from(primitive.shape.area());
    }
    areas
}

/// Makes the areas of `touched` objects anew, of which `before` are those of their own primitives; objects that shared one, as the parts
/// of a mesh do, share the new one.
fn measure(geometry: &mut Geometry, elements: &[u32], before: &[f64], touched: &[bool]) {
    let now = areas(geometry);
    let key = |number: usize, stated: f32| (elements[number], stated.to_bits());
    let mut together: HashMap<(u32, u32), (f64, f64, bool)> = HashMap::new();
    for (number, object) in geometry.objects.iter().enumerate() {
        let (old, new, any) = together.entry(key(number, object.surface_area)).or_default();
        (*old, *new, *any) = (*old + before[number], *new + now[number], *any || touched[number]);
    }
    for (number, object) in geometry.objects.iter_mut().enumerate() {
        let (old, new, any) = together.get(&key(number, object.surface_area)).copied().unwrap_or_default();
        // Others of one element may have the same area by chance.
        let shares = (old / f64::from(object.surface_area) - 1.0).abs() < 1e-4;
        match (shares, any, touched[number]) {
            (true, true, _) => object.surface_area = new as f32,
            (false, _, true) => object.surface_area = now[number] as f32,
            _ => {}
        }
    }
}
