//! The only door from the renderer to shaders and closures: a batch of points in, emission, light and directions out.

use super::smooth::Smooth;
use super::told::Told;
use crate::closure::tree::Tree;
use crate::closure::{Evaluation, Lobes, Samples, Settings};
use crate::exec::{Group, Host, Machine, Points, Report};
use crate::limits;
use crate::math::columns::Column3;
use glam::Vec3;
use std::sync::Arc;

/// One thread's shader, lobes and columns.
pub struct Shading {
    /// The batch to shade: fill it, then call `shade`.
    pub points: Points,
    /// The smooth surface over the points, where that matters; `resize` forgets it.
    pub smooth: Smooth,
    /// Toward the lights, one direction a lane.
    pub toward: Column3,
    /// Random numbers, three a lane.
    pub random: Column3,
    /// What `evaluate` gave.
    pub evaluation: Evaluation,
    /// What `sample` gave.
    pub samples: Samples,
    machine: Machine,
    lobes: Lobes,
    viewer: Column3,
    reports: Vec<Report>,
    /// True once a shader cannot be run; from then on nothing is shaded.
    failed: bool,
    /// The time was up in the middle of the work.
    given_up: bool,
    nothing: Tree,
    /// All reports so far, as text.
    told: Told,
}

impl Shading {
    /// Fresh scratch, for shaders that ask `host`.
    pub fn new(settings: Settings, host: Arc<dyn Host>) -> Self {
        Shading {
            points: Points::default(),
            smooth: Smooth::default(),
            toward: Column3::default(),
            random: Column3::default(),
            evaluation: Evaluation::default(),
            samples: Samples::default(),
            machine: Machine::with_host(host),
            lobes: Lobes::new(settings),
            viewer: Column3::default(),
            reports: Vec::new(),
            failed: false,
            given_up: false,
            nothing: Tree::default(),
            told: Told::default(),
        }
    }

    /// Makes room for a batch of `len` lanes.
    pub fn resize(&mut self, len: usize) {
        self.points.resize(len);
        self.smooth.clear();
        self.toward.resize(len);
        self.random.resize(len);
        self.viewer.resize(len);
    }

    /// Runs the group over the points and lays its closures out as lobes.
    pub fn shade(&mut self, group: &Group) {
        let i = &self.points.i;
        for lane in 0..self.points.len {
            self.viewer.x[lane] = -i.x[lane];
            self.viewer.y[lane] = -i.y[lane];
            self.viewer.z[lane] = -i.z[lane];
        }
        if self.failed || self.given_up {
            self.nothing.clear(self.points.len);
            self.lobes.flatten(group.library(), &self.nothing, &self.viewer, &self.points.ng);
            return;
        }
        self.machine.shade(group, &self.points);
        self.given_up |= self.machine.given_up();
        let tree = self.machine.tree();
        self.smooth.swap(&mut self.points);
        let Points { ng, backfacing, .. } = &self.points;
        self.lobes.flatten_sides(group.library(), tree, &self.viewer, ng, backfacing);
        let mut news = Vec::new();
        if let Some(node) = self.lobes.crowded() {
            let place = tree.site_near(node).map(|site| group.place(site)).unwrap_or_default();
            let most = limits::lobes(tree.lanes);
            news.push(Report::fatal(place, format!("a batch has more than {most} lobes, or layers over them")));
        }
        if !self.lobes.dropped().is_empty() {
            report_dropped(group, tree, &self.lobes, &mut news);
        }
        for left_out in self.lobes.left_out() {
            let place = tree.site(left_out.node).map(|site| group.place(site)).unwrap_or_default();
            news.push(Report::warning_at(place, format!("`{}` {}", left_out.closure, left_out.what)));
        }
        news.extend(self.machine.take_reports());
        for report in news {
            let fatal = report.is_fatal();
            self.failed |= fatal;
            if self.told.is_new(&report) {
                self.reports.push(report);
            }
        }
    }

    /// Begins work that is wanted, after such that was given up.
    pub fn go_on(&mut self) {
        self.given_up = false;
    }

    /// True once the time was up in the middle of the work.
    pub fn given_up(&self) -> bool {
        self.given_up
    }

    /// True once a shader cannot be run.
    pub fn failed(&self) -> bool {
        self.failed
    }

    /// Radiance emitted toward the viewer.
    pub fn emission(&self) -> &Column3 {
        self.lobes.emission()
    }

    /// Alpha that `holdout()` takes away.
    pub fn holdout(&self) -> &[f32] {
        self.lobes.holdout()
    }

    /// True when light samples can reach a lobe.
    pub fn takes_light_samples(&self) -> bool {
        self.lobes.has_non_delta()
    }

    /// The sides from which light reaches the points: their normals, or nothing where it comes from both.
    pub fn facing(&self, out: &mut Column3) {
        out.clone_from(&self.points.ng);
        self.lobes.crossing(|lane| out.set(lane, Vec3::ZERO));
    }

    /// Evaluates all lobes toward `toward`.
    pub fn evaluate(&mut self) {
        self.lobes.evaluate(&self.toward, &mut self.evaluation);
        self.smooth.dim(&self.points, &self.toward, &mut self.evaluation.f_cos);
    }

    /// Samples a direction a lane by `random`.
    pub fn sample(&mut self) {
        self.lobes.sample(&self.random, &mut self.samples);
        let Samples { wi, weight, event, .. } = &mut self.samples;
        self.smooth.dim_scattered(&self.points, wi, event, weight);
    }

    /// What passes the surfaces straight on toward the viewer, a color a lane.
    pub fn straight(&mut self, out: &mut Column3) {
        self.lobes.straight(out);
    }

    /// Reports something about the render itself, once.
    pub fn warn(&mut self, text: String) {
        let report = Report::warning(text);
        if self.told.is_new(&report) {
            self.reports.push(report);
        }
    }

    /// Forgets what was said, so that it is said again, and whether a shader could be run.
    pub fn start_over(&mut self) {
        self.reports.clear();
        self.told.clear();
        (self.failed, self.given_up) = (false, false);
    }

    /// What shaders printed and complained of since the last call.
    pub fn take_reports(&mut self) -> Vec<Report> {
        std::mem::take(&mut self.reports)
    }
}

/// Names each closure that was dropped in some lane, with the place where it is written, once.
fn report_dropped(group: &Group, tree: &Tree, lobes: &Lobes, reports: &mut Vec<Report>) {
    let mut last = None;
    for dropped in lobes.dropped() {
        // A batch lists every lane; one line for all of them is enough.
        if last.replace(dropped.node) == Some(dropped.node) {
            continue;
        }
        let place = tree.site(dropped.node).map(|site| group.place(site)).unwrap_or_default();
        let what = "is dropped where a parameter or weight of it is not a number";
        let report = Report::mistake(place, format!("`{}` {what}", dropped.closure));
        if !reports.contains(&report) {
            reports.push(report);
        }
    }
}
