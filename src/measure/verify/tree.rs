//! A compiled shader as a scatterer: its closure tree at one point of a surface is what scatters.

use super::subject::Scatterer;
use crate::closure::tree::Tree;
use crate::closure::{Evaluation, Lobes, Samples, Settings};
use crate::exec::{Group, Machine, Points};
use crate::limits;
use crate::math::columns::Column3;
use glam::Vec3;

/// Where on the surface the tree is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Surface coordinates.
    pub uv: [f32; 2],
    /// True when the surface is seen from its back.
    pub back: bool,
    /// The bit of `raytype()` of whoever looks.
    pub ray_type: i32,
    /// The derivative of P and of u and v along the screen, on the surface; 0 where there is none.
    pub width: f32,
}

impl Spot {
    /// The middle of the front.
    pub const MIDDLE: Spot = Spot { uv: [0.5, 0.5], back: false, ray_type: 1, width: 0.0 };

    /// Points of this place, one a viewer.
    pub fn points(&self, wo: &Column3, points: &mut Points) {
        points.resize(wo.len());
        for lane in 0..wo.len() {
            self.point(wo.get(lane), points, lane);
        }
    }

    /// One point of this place, seen from `wo`.
    pub fn point(&self, wo: Vec3, points: &mut Points, lane: usize) {
        let [u, v] = self.uv;
        (points.u[lane], points.v[lane]) = (u, v);
        points.surface_area[lane] = 1.0;
        points.ray_type[lane] = self.ray_type;
        // Hosts turn the normals to the viewer, so the back looks like the front but for this mark.
        points.backfacing[lane] = i32::from(self.back);
        points.p.set(lane, Vec3::new(u, v, 0.0));
        points.i.set(lane, -wo);
        points.n.set(lane, Vec3::Z);
        points.ng.set(lane, Vec3::Z);
        points.dpdu.set(lane, Vec3::X);
        points.dpdv.set(lane, Vec3::Y);
        points.dpdx.set(lane, Vec3::X * self.width);
        points.dpdy.set(lane, Vec3::Y * self.width);
        (points.dudx[lane], points.dvdy[lane]) = (self.width, self.width);
        (points.dudy[lane], points.dvdx[lane]) = (0.0, 0.0);
        // The eye is one away.
        points.didx.set(lane, (Vec3::X - wo * wo.x) * self.width);
        points.didy.set(lane, (Vec3::Y - wo * wo.y) * self.width);
    }
}

/// The closure tree of a group at a spot, flattened for each viewer.
pub struct TreeScatterer {
    group: Group,
    spot: Spot,
    machine: Machine,
    points: Points,
    lobes: Lobes,
    complaint: Option<String>,
    /// The shader cannot be run, so that it is not run again.
    failed: bool,
    /// What it has made then.
    nothing: Tree,
}

impl std::fmt::Debug for TreeScatterer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TreeScatterer").field("spot", &self.spot).finish_non_exhaustive()
    }
}

impl TreeScatterer {
    /// A scatterer of a group.
    pub fn new(group: Group, spot: Spot, settings: Settings) -> Self {
        let (machine, points, lobes) = (Machine::new(), Points::default(), Lobes::new(settings));
        TreeScatterer { group, spot, machine, points, lobes, complaint: None, failed: false, nothing: Tree::default() }
    }
}

impl Scatterer for TreeScatterer {
    fn look(&mut self, wo: &Column3) {
        self.spot.points(wo, &mut self.points);
        let tree = match self.failed {
            false => self.machine.shade(&self.group, &self.points),
            true => {
                self.nothing.clear(self.points.len);
                &self.nothing
            }
        };
        let Points { ng, backfacing, .. } = &self.points;
        self.lobes.flatten_sides(self.group.library(), tree, wo, ng, backfacing);
        if let (Some(dropped), None) = (self.lobes.dropped().first(), &self.complaint) {
            let place = tree.site(dropped.node).map_or(String::new(), |site| format!("{}: ", self.group.place(site)));
            self.complaint = Some(format!("{place}`{}` has a parameter or weight that is no number", dropped.closure));
        }
        if let (Some(_), None) = (self.lobes.crowded(), &self.complaint) {
            let most = limits::lobes(tree.lanes);
            self.complaint = Some(format!("a batch has more than {most} lobes, or layers over them"));
        }
        for report in self.machine.take_reports() {
            self.failed |= report.is_fatal();
            if report.is_wrong() && self.complaint.is_none() {
                self.complaint = Some(report.to_string());
            }
        }
    }

    fn evaluate(&mut self, wi: &Column3, out: &mut Evaluation) {
        self.lobes.evaluate(wi, out);
    }

    fn sample(&mut self, xi: &Column3, out: &mut Samples) {
        self.lobes.sample(xi, out);
    }

    fn stated_albedo(&self, lane: usize) -> f64 {
        let mut sum = [0.0f64; 3];
        for lobe in self.lobes.describe(lane) {
            for (s, w) in sum.iter_mut().zip(lobe.weight) {
                *s += f64::from(w) * f64::from(lobe.albedo) * f64::from(lobe.through);
            }
        }
        sum.into_iter().fold(0.0, f64::max)
    }

    fn complaint(&self) -> Option<String> {
        self.complaint.clone()
    }
}
