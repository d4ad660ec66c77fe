//! What one pixel is made of: the closure tree of the surface it shows, its lobes, and how they scatter in one plane.

use super::renderer::Renderer;
use crate::closure::print::tree_text;
use crate::closure::{Evaluation, LobeInfo, Lobes};
use crate::exec::Report;
use crate::math::columns::Column3;
use crate::math::elementary::{atan2, cos, sin};
use crate::math::frame::Frame;
use glam::Vec3;
use std::f32::consts::PI;

/// The surface under a pixel.
#[derive(Clone, Debug)]
pub struct Look {
    /// The index of its material.
    pub material: usize,
    /// Where it is; the origin for the background.
    pub position: Vec3,
    /// Surface coordinates.
    pub uv: [f32; 2],
    /// Its closure tree, as OSL prints closures; empty for none.
    pub tree: String,
    /// Its lobes, each with its curve.
    pub lobes: Vec<(LobeInfo, Vec<f32>)>,
    /// f |cos| of all lobes with a density, a color for each direction of the plane, 1/sr.
    pub total: Vec<Vec3>,
    /// Radiance that it emits toward the viewer.
    pub emission: Vec3,
    /// The angle of the viewer from the shading normal in radians, 0..pi.
    pub viewer: f32,
    /// What its shaders said, and why they cannot be run if they cannot.
    pub reports: Vec<Report>,
}

impl Renderer {
    /// Shades what the center of a pixel shows, and evaluates its lobes at `directions` directions of the plane of incidence, which
    /// holds the shading normal and the viewer. Direction k is k / directions of a turn away from the normal, on the side opposite to the
    /// viewer first. Curves of single lobes are the mean of their color. Nothing where the pixel shows nothing.
    pub fn look(&self, x: u32, y: u32, directions: usize) -> Option<Look> {
        let world = self.world();
        let (material, points) = self.point_of(x, y);
        let material = material?;
        let group = &world.scene.materials[material].surface;
        let mut machine = self.machine_of_one();
        machine.shade(group, &points);
        let (tree, viewer) = (machine.tree(), Column3::splat(-points.i.get(0), 1));
        let mut lobes = Lobes::new(world.settings.closure);
        lobes.flatten_sides(group.library(), tree, &viewer, &points.ng, &points.backfacing);
        let text = tree_text(group.table(), tree, 0);
        let (wo, normal) = (viewer.get(0), points.n.get(0));
        let plane = Plane::new(normal, wo);
        let mut found: Vec<(LobeInfo, Vec<f32>)> =
            lobes.describe(0).into_iter().map(|info| (info, Vec::with_capacity(directions))).collect();
        let mut total = Vec::with_capacity(directions);
        let mut out = Evaluation::default();
        for k in 0..directions {
            let wi = Column3::splat(plane.direction(2.0 * PI * k as f32 / directions as f32), 1);
            lobes.evaluate(&wi, &mut out);
            total.push(out.f_cos.get(0));
            for (info, curve) in &mut found {
                lobes.evaluate_one(info.number, &wi, &mut out);
                curve.push(out.f_cos.get(0).element_sum() / 3.0);
            }
        }
        Some(Look {
            material,
            position: points.p.get(0),
            uv: [points.u[0], points.v[0]],
            tree: text,
            lobes: found,
            total,
            emission: lobes.emission().get(0),
            viewer: plane.viewer,
            reports: machine.take_reports(),
        })
    }
}

/// The plane of a normal and a viewer.
struct Plane {
    normal: Vec3,
    /// Across the normal, away from the viewer.
    across: Vec3,
    viewer: f32,
}

impl Plane {
    fn new(normal: Vec3, wo: Vec3) -> Self {
        let normal = normal.normalize_or(Vec3::Z);
        let along = wo.dot(normal);
        let side = wo - normal * along;
        // A viewer on the normal sees every plane through it alike.
        let across = (-side).try_normalize().unwrap_or_else(|| Frame::from_normal(normal).tangent);
        Plane { normal, across, viewer: atan2(side.length(), along) }
    }

    fn direction(&self, angle: f32) -> Vec3 {
        (self.normal * cos(angle) + self.across * sin(angle)).normalize_or(self.normal)
    }
}
