//! What a scene needs: decided once, before rendering, so that nothing else is computed.

use super::light::by_tree;
use super::settings::{LightPoints, LightStrategy, Settings, Terminator};
use super::sky::{LEAST_SIDE, MOST_SIDE};
use super::smooth::is_smooth;
use crate::exec::Group;
use crate::lang::globals::Global;
use crate::scene::{Material, Primitive, Scene};
use std::fmt;

/// Which columns of a shading point a material reads beside `I`, `N` and `Ng`, which lobes always need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// P.
    pub position: bool,
    /// u and v.
    pub uv: bool,
    /// dPdu and dPdv.
    pub tangents: bool,
    /// The derivatives of P.
    pub position_derivatives: bool,
    /// The derivatives of u and v.
    pub uv_derivatives: bool,
    /// The derivatives of I.
    pub direction_derivatives: bool,
}

impl Needs {
    /// What `group` reads.
    pub fn of(group: &Group) -> Self {
        let reads = |globals: &[Global]| globals.iter().any(|g| group.reads(*g));
        let derives = |globals: &[Global]| globals.iter().any(|g| group.reads_derivative(*g));
        let (carried, carried_slopes) = (group.asks_for(&["s", "t"], false), group.asks_for(&["s", "t"], true));
        Needs {
            position: reads(&[Global::P, Global::Ps]) || group.draws(),
            uv: reads(&[Global::U, Global::V]) || carried,
            tangents: reads(&[Global::DPdu, Global::DPdv]),
            position_derivatives: derives(&[Global::P, Global::Ps]),
            uv_derivatives: derives(&[Global::U, Global::V]) || carried_slopes,
            direction_derivatives: derives(&[Global::I]),
        }
    }

    /// True when the width of the ray's cone matters.
    pub fn any_derivative(&self) -> bool {
        self.position_derivatives || self.uv_derivatives || self.direction_derivatives
    }
}

/// True when nothing that changes from point to point of one object reaches the group's result.
pub fn same_all_over(group: &Group) -> bool {
    // What a layer lets through depends on the direction of view, though no shader reads it.
    !group.nests() && !group.varies_on_object()
}

/// Directions a side in which a background is looked at, where the scene asks for `resolution`.
pub fn table_side(resolution: u32) -> u32 {
    resolution.clamp(LEAST_SIDE, MOST_SIDE).next_power_of_two()
}

/// What one material takes part in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MaterialPlan {
    /// It may emit.
    pub emits: bool,
    /// It may scatter.
    pub scatters: bool,
    /// It may be a hole in the alpha channel.
    pub holds_out: bool,
    /// Light may pass it straight on.
    pub clear: bool,
    /// It scatters on meshes with smooth normals, whose terminator has a remedy.
    pub smooth: bool,
    /// A shader moves its surfaces.
    pub moves: bool,
    /// What it reads.
    pub needs: Needs,
}

/// What a whole scene needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// One entry a material.
    pub materials: Vec<MaterialPlan>,
    /// Any material reads derivatives, so paths carry the width of their cone.
    pub cones: bool,
    /// Light may pass some material straight on, so shadow rays look for their closest hits, and paths count their bounces
    /// and remember where they last scattered.
    pub clear: bool,
    /// Primitives that are sampled as lights.
    pub lights: usize,
    /// Whether lights are chosen by a hierarchy, and how points of them are; see [`LightPoints`].
    pub light_tree: bool,
    /// How points of lights are chosen.
    pub light_points: LightPoints,
    /// What is done for those materials that are smooth.
    pub terminator: Terminator,
    /// The background's radiance is one constant.
    pub constant_background: bool,
    /// Directions a side in which the background is looked at for its importance table, a power of two; 0 when none is needed.
    pub background_table: u32,
}

impl Plan {
    /// Can anything in the scene give light?
    pub fn gives_light(&self) -> bool {
        self.materials.iter().any(|material| material.emits)
    }

    /// The materials of surfaces and of the background whose shaders give no closure at all, so that they can only be black.
    pub fn black<'s>(&self, scene: &'s Scene) -> impl Iterator<Item = &'s Material> {
        let mut seen = vec![false; scene.materials.len()];
        scene.geometry.objects.iter().for_each(|object| seen[object.material as usize] = true);
        scene.background.iter().for_each(|background| seen[background.material as usize] = true);
        let materials = scene.materials.iter().zip(seen);
        materials.filter(|(m, seen)| *seen && m.surface.closures().next().is_none()).map(|(material, _)| material)
    }

    /// Makes the plan of `scene`.
    pub fn new(scene: &Scene, settings: &Settings) -> Self {
        let mut materials: Vec<MaterialPlan> = scene
            .materials
            .iter()
            .map(|m| MaterialPlan {
                emits: m.surface.can_emit(),
                scatters: m.surface.can_scatter(),
                holds_out: m.surface.can_hold_out(),
                clear: m.surface.can_pass(),
                smooth: false,
                moves: m.displacement.is_some(),
                needs: Needs::of(&m.surface),
            })
            .collect();
        if settings.terminator != Terminator::None {
            find_smooth(scene, &mut materials);
        }
        // `is_light` only asks; what cannot emit is no light whatever the scene says.
        let is_light = |material: u32| materials[material as usize].emits;
        let sampling = settings.lights != LightStrategy::ScatteringOnly;
        let objects = &scene.geometry.objects;
        let lit = |p: &&Primitive| is_light(objects[p.object as usize].material);
        let lights = if sampling { scene.geometry.primitives.iter().filter(lit).count() } else { 0 };
        let background = scene.background.map(|b| (b, &scene.materials[b.material as usize].surface));
        let constant = background.is_none_or(|(_, g)| same_all_over(g) || !g.can_emit());
        let background_table = match background {
            // A constant sky is what scattering samples already reach best; sampling it as well only adds noise.
            Some((b, _)) if sampling && !constant && b.resolution > 0 => table_side(b.resolution),
            _ => 0,
        };
        let cones = materials.iter().any(|m| m.needs.any_derivative());
        let clear = materials.iter().any(|m| m.clear);
        Plan {
            cones,
            clear,
            materials,
            lights,
            light_tree: by_tree(lights, settings.light_choice),
            light_points: settings.light_points,
            terminator: settings.terminator,
            constant_background: constant,
            background_table,
        }
    }
}

/// Marks the materials that scatter on smooth facets; looks no further than to the first one of each.
fn find_smooth(scene: &Scene, materials: &mut [MaterialPlan]) {
    let geometry = &scene.geometry;
    for primitive in geometry.primitives.iter().filter(|p| p.normals != Primitive::NONE) {
        let material = &mut materials[geometry.objects[primitive.object as usize].material as usize];
        if material.scatters && !material.smooth {
            material.smooth = is_smooth(geometry, primitive);
        }
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let or = |yes: bool, a: &'static str, b: &'static str| if yes { a } else { b };
        writeln!(
            f,
            "lights: {}",
            match self.lights {
                0 => "none, so no light sampling and no shadow rays to lights".to_owned(),
                n => format!(
                    "{n} primitives are sampled, one a bounce{}{}",
                    or(self.light_tree, ", chosen by place from a hierarchy", or(n > 1, ", chosen by power", "")),
                    match self.light_points {
                        LightPoints::Area => "; their points by area",
                        LightPoints::Solid => "; wide flat ones by solid angle",
                    }
                ),
            }
        )?;
        writeln!(
            f,
            "background: {}",
            match self.background_table {
                0 => or(
                    self.constant_background,
                    "constant or absent, known exactly, not sampled",
                    "reached by scattering alone"
                )
                .to_owned(),
                n => format!("varies, sampled by its brightness in {n} x {n} directions and closer at edges"),
            }
        )?;
        writeln!(
            f,
            "ray cones: {}",
            or(self.cones, "carried, derivatives are read", "not carried, no derivative is read")
        )?;
        let numbers = |has: fn(&MaterialPlan) -> bool| {
            let having = self.materials.iter().enumerate().filter(|(_, material)| has(material));
            having.map(|(i, _)| i.to_string()).collect::<Vec<_>>().join(", ")
        };
        if self.clear {
            writeln!(f, "clear surfaces: material {}, which shadow rays pass with their color", numbers(|m| m.clear))?;
        }
        let moved = numbers(|m| m.moves);
        if !moved.is_empty() {
            writeln!(f, "moved surfaces: material {moved}, as triangles, once before anything else")?;
        }
        let smooth = numbers(|m| m.smooth);
        match (self.terminator, smooth.is_empty()) {
            (Terminator::None, _) => {}
            (_, true) => writeln!(f, "smooth meshes: none that scatters, so no remedy for terminators")?,
            (method, false) => writeln!(
                f,
                "smooth meshes: material {smooth}, {}",
                or(
                    method == Terminator::Factor,
                    "where light fades before a facet turns away",
                    "where light arrives at the smooth surface"
                )
            )?,
        }
        for (i, m) in self.materials.iter().enumerate() {
            let uv = or(m.needs.uv, "uv", "no uv");
            writeln!(
                f,
                "material {i}: {}, {}, {uv}",
                or(m.emits, "emits", "dark"),
                or(m.scatters, "scatters", "ends paths")
            )?;
        }
        Ok(())
    }
}
