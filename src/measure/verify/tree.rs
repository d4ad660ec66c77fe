//! A compiled shader as a scatterer: its closure tree at one point of a surface is what scatters.

use super::subject::Scatterer;
use crate::closure::{Evaluation, Lobes, Samples, Settings};
use crate::exec::{Group, Machine, Points, ReportKind};
use crate::math::columns::Column3;
use glam::Vec3;

/// Where on the surface the tree is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Surface coordinates.
    pub uv: [f32; 2],
    /// True when the surface is seen from its back.
    pub back: bool,
}

impl Spot {
    /// The middle of the front.
    pub const MIDDLE: Spot = Spot { uv: [0.5, 0.5], back: false };

    /// Points of this place, one a viewer.
    pub fn points(&self, wo: &Column3, points: &mut Points) {
        let n = wo.len();
        points.resize(n);
        points.u.fill(self.uv[0]);
        points.v.fill(self.uv[1]);
        points.surface_area.fill(1.0);
        points.ray_type.fill(1);
        // Hosts turn the normals to the viewer, so the back looks like the front but for this mark.
        points.backfacing.fill(i32::from(self.back));
        for lane in 0..n {
            points.p.set(lane, Vec3::new(self.uv[0], self.uv[1], 0.0));
            points.i.set(lane, -wo.get(lane));
            points.n.set(lane, Vec3::Z);
            points.ng.set(lane, Vec3::Z);
            points.dpdu.set(lane, Vec3::X);
            points.dpdv.set(lane, Vec3::Y);
        }
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
        TreeScatterer { group, spot, machine, points, lobes, complaint: None }
    }
}

impl Scatterer for TreeScatterer {
    fn look(&mut self, wo: &Column3) {
        self.spot.points(wo, &mut self.points);
        let tree = self.machine.shade(&self.group, &self.points);
        self.lobes.flatten(self.group.library(), tree, wo, &self.points.ng);
        if let (Some(dropped), None) = (self.lobes.dropped().first(), &self.complaint) {
            let place = tree.site(dropped.node).map_or(String::new(), |site| format!("{}: ", self.group.place(site)));
            self.complaint = Some(format!("{place}`{}` has a parameter or weight that is no number", dropped.closure));
        }
        for report in self.machine.take_reports() {
            let wrong = match report.kind {
                ReportKind::Error | ReportKind::Mistake | ReportKind::Fatal => true,
                ReportKind::Output | ReportKind::File(_) | ReportKind::Warning => false,
            };
            if wrong && self.complaint.is_none() {
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
