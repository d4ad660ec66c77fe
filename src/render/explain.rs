//! What a scene needs and what it does not, each saving with its cost.
//!
//! Times of hits, lights and background are measured on the spot. They are for the reader alone: nothing that is
//! rendered depends on them. The time of a facet table is a recorded one, of a 2-core AMD EPYC, for making one takes
//! longer than a reader wants to wait.

use super::accel::NOTHING;
use super::host::host;
use super::lanes::Draws;
use super::light::{LightLanes, Lights, Lookers};
use super::plan::{Needs, Plan, table_side};
use super::points::{fill, fill_sky};
use super::probe::probe;
use super::segment::Segment;
use super::settings::{LightStrategy, Settings};
use super::shading::Shading;
use crate::closure::settings::SheenAlbedo;
use crate::exec::{Group, MAX_LANES, Points};
use crate::lang::closures::TopAlbedo;
use crate::lang::globals::GLOBALS;
use crate::math::columns::Column3;
use crate::scene::{Geometry, Primitive, Scene, Shape};
use glam::Vec3;
use std::fmt;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// One thing that is not computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Saving {
    /// What it is.
    pub what: String,
    /// What it would cost, in words, with the time of this machine where it can be measured in a moment.
    pub cost: String,
}

/// What one material is made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialNeeds {
    /// The name of its shader group.
    pub name: String,
    /// The closures that can occur, by name.
    pub closures: Vec<&'static str>,
    /// The shader globals that are read.
    pub globals: Vec<&'static str>,
    /// Those whose derivatives are read.
    pub derivatives: Vec<&'static str>,
    /// Instructions of the optimised program.
    pub instructions: usize,
    /// How the albedo of its layers is found; empty when nothing is layered.
    pub albedo: Vec<&'static str>,
}

/// A plan in words.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// The plan.
    pub plan: Plan,
    /// The materials.
    pub materials: Vec<MaterialNeeds>,
    /// What is left out.
    pub savings: Vec<Saving>,
}

impl Explanation {
    /// Looks at what `scene` needs under `settings`, and times what it does not need; takes some milliseconds.
    pub fn new(scene: &Scene, settings: &Settings) -> Self {
        let plan = Plan::new(scene, settings);
        let materials: Vec<MaterialNeeds> =
            scene.materials.iter().map(|m| MaterialNeeds::of(&m.name, &m.surface, settings)).collect();
        let mut savings = Vec::new();
        geometry_savings(scene, &plan, &mut savings);
        light_savings(scene, &plan, settings, &mut savings);
        closure_savings(scene, &materials, &mut savings);
        Explanation { plan, materials, savings }
    }
}

impl MaterialNeeds {
    fn of(name: &str, group: &Group, settings: &Settings) -> Self {
        let table = group.table();
        let mut closures = Vec::new();
        let mut instructions = 0;
        crate::ir::program::visit_instrs(&group.program().body, &mut |instr| {
            instructions += 1;
            if let crate::ir::program::Instr::Leaf { closure, .. } = instr {
                let name = table.get(*closure).name;
                if !closures.contains(&name) {
                    closures.push(name);
                }
            }
        });
        let named = |reads: &dyn Fn(crate::lang::globals::Global) -> bool| -> Vec<&'static str> {
            GLOBALS.iter().filter(|entry| reads(entry.1)).map(|entry| entry.0).collect()
        };
        MaterialNeeds {
            name: name.to_owned(),
            closures,
            globals: named(&|g| group.reads(g)),
            derivatives: named(&|g| group.reads_derivative(g)),
            instructions,
            albedo: albedos(group, settings.closure.sheen_albedo),
        }
    }
}

/// The albedo evaluators that a group's layers may call for: those of closures that cover what they nest, and of all that can
/// lie in the top of one that nests a top.
fn albedos(group: &Group, method: SheenAlbedo) -> Vec<&'static str> {
    let any_top = group.closures().any(|spec| spec.nests_a_top());
    let needed = |by: TopAlbedo| group.closures().any(|spec| spec.top_albedo == by && (any_top || spec.nests()));
    let mut out = Vec::new();
    for by in [TopAlbedo::Formula, TopAlbedo::Sheen, TopAlbedo::Facets, TopAlbedo::Boundary] {
        let words = match by {
            TopAlbedo::Formula => continue,
            TopAlbedo::Sheen => match method {
                SheenAlbedo::Short => "short polynomial of the sheen's albedo (a roughness below 0.01 counts as 0.01)",
                SheenAlbedo::Fit => "polynomial of the sheen's albedo (a roughness below 0.01 counts as 0.01)",
                SheenAlbedo::Long => "long polynomial of the sheen's albedo (a roughness below 0.01 counts as 0.01)",
                SheenAlbedo::Table => "table of the sheen's albedo (a roughness below 0.01 counts as 0.01)",
            },
            TopAlbedo::Facets => FACET_TABLE,
            TopAlbedo::Boundary => "Fresnel's term of the coat",
        };
        if needed(by) {
            out.push(words);
        }
    }
    out
}

/// How a plan speaks of the table of facets.
const FACET_TABLE: &str = "table of the rough facets' albedo";

/// Nanoseconds a lane of `run`, which works on a full batch: the best of several rounds.
fn time(mut run: impl FnMut()) -> f64 {
    const ROUNDS: usize = 7;
    const REPEATS: usize = 20;
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        (0..REPEATS).for_each(|_| run());
        best = best.min(start.elapsed().as_secs_f64());
    }
    best * 1e9 / (REPEATS * MAX_LANES) as f64
}

/// What is not found out about hits.
fn geometry_savings(scene: &Scene, plan: &Plan, savings: &mut Vec<Saving>) {
    let count = scene.geometry.primitives.len();
    if count == 0 {
        return;
    }
    let segment = |lane: usize| {
        let at = (lane as f32 + 0.5) / MAX_LANES as f32;
        probe(&scene.geometry, (lane * count / MAX_LANES) as u32, at, 1.0 - at)
    };
    let segments: Vec<Segment> = (0..MAX_LANES).map(segment).collect();
    let mut points = Points::new(MAX_LANES);
    let mut cost = |needs: Needs| time(|| fill(black_box(&mut points), &scene.geometry, segments.iter(), &needs));
    let nothing = cost(Needs::default());
    let any = |read: &dyn Fn(&Needs) -> bool| plan.materials.iter().any(|m| read(&m.needs));
    let parts = [
        ("u and v", any(&|n| n.uv), Needs { uv: true, ..Needs::default() }),
        ("dPdu and dPdv", any(&|n| n.tangents), Needs { tangents: true, ..Needs::default() }),
        (
            "derivatives and the cones of rays",
            any(&Needs::any_derivative),
            Needs { position_derivatives: true, direction_derivatives: true, ..Needs::default() },
        ),
    ];
    for (what, needed, needs) in parts {
        if !needed {
            let more = (cost(needs) - nothing).max(0.0);
            savings.push(Saving { what: what.into(), cost: format!("{more:.1} ns a hit") });
        }
    }
}

/// What is not asked of lights and background.
fn light_savings(scene: &Scene, plan: &Plan, settings: &Settings, savings: &mut Vec<Saving>) {
    if settings.lights == LightStrategy::ScatteringOnly {
        return;
    }
    if plan.lights == 0 {
        let ns = light_cost(settings);
        let cost = format!("{ns:.1} ns a hit for the choice, and one evaluation of the lobes and one shadow ray");
        savings.push(Saving { what: "sampling of lights".into(), cost });
    }
    if plan.background_table == 0 {
        let side = scene.background.map_or(0, |b| table_side(b.resolution));
        let cost = match background_cost(scene, settings) {
            Some(ns) => format!(
                "{:.1} ms for a look in {side} x {side} directions, and one evaluation of the lobes and one shadow ray a hit",
                ns * f64::from(side * side) * 1e-6
            ),
            None => "one evaluation of the lobes and one shadow ray a hit".into(),
        };
        savings.push(Saving { what: "sampling of the background".into(), cost });
    }
}

/// Nanoseconds to choose a point of a light.
fn light_cost(settings: &Settings) -> f64 {
    let shape = Shape::Quad { corner: Vec3::Y, edge_x: Vec3::X, edge_y: Vec3::Z };
    let primitive = Primitive { shape, object: 0, normals: Primitive::NONE, uvs: Primitive::NONE };
    let geometry = Geometry { primitives: vec![primitive], ..Geometry::default() };
    let lights = Lights::new(&geometry, &[(0, 1.0)], settings.light_choice, settings.light_points);
    let (p, from) = (Column3::zeros(MAX_LANES), vec![NOTHING; MAX_LANES]);
    let (mut draws, mut out) = (Draws::default(), LightLanes::default());
    draws.resize(MAX_LANES);
    time(|| {
        draws.draw(1, 2);
        lights.sample(Lookers { p: &p, normal: &p, from: &from }, &draws.numbers, black_box(&mut out));
    })
}

/// Nanoseconds to shade one direction of the background, if there is one.
fn background_cost(scene: &Scene, settings: &Settings) -> Option<f64> {
    let background = scene.background?;
    let host = Arc::new(host(&scene.camera, settings, &scene.textures, None));
    let mut shading = Shading::new(settings.closure, host);
    shading.resize(MAX_LANES);
    (0..MAX_LANES).for_each(|lane| fill_sky(&mut shading.points, lane, Vec3::Y, 0));
    Some(time(|| shading.shade(&scene.materials[background.material as usize].surface)))
}

/// Closures and tables that nothing can reach.
fn closure_savings(scene: &Scene, materials: &[MaterialNeeds], savings: &mut Vec<Saving>) {
    let Some(table) = scene.materials.first().map(|m| m.surface.table()) else { return };
    let used = |name: &str| materials.iter().any(|m| m.closures.contains(&name));
    let mut names: Vec<&str> = table.specs.iter().map(|spec| spec.name).collect();
    names.dedup();
    let unused = names.iter().filter(|name| !used(name)).count();
    savings.push(Saving {
        what: format!("{unused} of {} closures", names.len()),
        cost: "none: what no shader names is never called".into(),
    });
    if !materials.iter().any(|m| m.albedo.contains(&FACET_TABLE)) {
        savings.push(Saving {
            what: "tables of the rough facets' albedo".into(),
            cost: "41 to 78 ms a distribution, once, and a look-up a direction".into(),
        });
    }
    if materials.iter().all(|m| m.albedo.is_empty()) {
        savings.push(Saving { what: "layers".into(), cost: "an albedo a direction and layer".into() });
    }
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.plan)?;
        let list = |names: &[&'static str]| if names.is_empty() { "none".into() } else { names.join(", ") };
        for (i, material) in self.materials.iter().enumerate() {
            writeln!(f, "material {i} `{}`: closures {}", material.name, list(&material.closures))?;
            writeln!(
                f,
                "  {} instructions; globals {}; derivatives of {}",
                material.instructions,
                list(&material.globals),
                list(&material.derivatives)
            )?;
            if !material.albedo.is_empty() {
                writeln!(f, "  layers need {}", list(&material.albedo))?;
            }
        }
        writeln!(f, "not needed, and what it would cost:")?;
        for saving in &self.savings {
            writeln!(f, "  {}: {}", saving.what, saving.cost)?;
        }
        Ok(())
    }
}
