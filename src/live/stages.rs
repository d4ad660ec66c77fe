//! The renderers of one scene: the whole picture, and coarse ones that are there sooner.
//!
//! Decision (2026-11-30): the first picture after a change has fewer pixels where the whole one would take longer than [`PROMPT`], because
//! what a slider does is to be seen while it moves; all share one hierarchy, and a coarse renderer costs a world of its own, which has
//! neither geometry nor programs.

use crate::exec::Group;
use crate::render::{RenderError, Renderer, Settings};
use crate::scene::Scene;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Seconds that the first picture may take to trace.
const PROMPT: f64 = 0.025;

/// By how much coarse pictures are smaller a side.
const DIVISORS: [u32; 3] = [2, 4, 6];

/// Camera samples a second before any was timed.
const FIRST_RATE: f64 = 1e6;

/// Coarser pictures than this many pixels a side show nothing.
const LEAST_SIDE: u32 = 48;

struct Stage {
    divisor: u32,
    renderer: Renderer,
    /// The change that it knows.
    epoch: u64,
}

/// Renderers of one scene, of which one at a time is at work.
pub struct Stages {
    stages: Vec<Stage>,
    current: usize,
    epoch: u64,
    groups: BTreeMap<usize, (u64, Group)>,
    rate: f64,
}

impl Stages {
    /// The renderer of the whole picture. `rate` is the camera samples a second that are expected.
    ///
    /// # Errors
    /// The scene cannot be rendered.
    pub fn new(scene: &Scene, settings: &Settings, rate: Option<f64>) -> Result<Self, RenderError> {
        let renderer = Renderer::new(scene, settings)?;
        let whole = Stage { divisor: 1, renderer, epoch: 0 };
        let (rate, groups) = (rate.unwrap_or(FIRST_RATE), BTreeMap::new());
        Ok(Stages { stages: vec![whole], current: 0, epoch: 0, groups, rate })
    }

    /// What stops them.
    pub fn stops(&self) -> Vec<Arc<AtomicBool>> {
        self.stages.iter().map(|stage| stage.renderer.stop().clone()).collect()
    }

    /// Materials are given other groups.
    pub fn change(&mut self, groups: Vec<(usize, Group)>) {
        self.epoch += 1;
        for (material, group) in groups {
            self.groups.insert(material, (self.epoch, group));
        }
    }

    /// Begins the picture anew, with the size that is there in time.
    ///
    /// # Errors
    /// The scene cannot be rendered any more.
    pub fn begin(&mut self) -> Result<(), RenderError> {
        let Settings { width, height, .. } = *self.stages[0].renderer.settings();
        let seconds = f64::from(width) * f64::from(height) / self.rate;
        let fits = |divisor: u32| width.min(height) / divisor >= LEAST_SIDE;
        let in_time = |divisor: u32| seconds / f64::from(divisor * divisor) <= PROMPT;
        let mut divisor = 1;
        for next in DIVISORS.into_iter().filter(|&next| fits(next)) {
            if !in_time(divisor) {
                divisor = next;
            }
        }
        self.current = match self.stages.iter().position(|stage| stage.divisor == divisor) {
            Some(stage) => stage,
            None => {
                self.ready(0)?;
                let whole = &self.stages[0];
                let settings = whole.renderer.settings();
                let (width, height) = (settings.width.div_ceil(divisor), settings.height.div_ceil(divisor));
                let renderer = whole.renderer.beside(&Settings { width, height, ..settings.clone() })?;
                self.stages.push(Stage { divisor, renderer, epoch: self.epoch });
                self.stages.len() - 1
            }
        };
        self.ready(self.current)
    }

    /// Goes on to the whole picture; false when it is the one at work.
    ///
    /// # Errors
    /// The scene cannot be rendered any more.
    pub fn refine(&mut self) -> Result<bool, RenderError> {
        let coarse = self.current != 0;
        self.current = 0;
        if coarse {
            self.ready(0)?;
        }
        Ok(coarse)
    }

    /// Has a renderer know all changes, and begin anew.
    fn ready(&mut self, number: usize) -> Result<(), RenderError> {
        let stage = &mut self.stages[number];
        let new = self.groups.iter().filter(|(_, (epoch, _))| *epoch > stage.epoch);
        let new: Vec<(usize, Group)> = new.map(|(material, (_, group))| (*material, group.clone())).collect();
        // What a stop leaves undone of a change is made up for when the render goes on.
        match new.is_empty() {
            true => stage.renderer.restart(),
            false => stage.renderer.set_materials(new)?,
        }
        stage.epoch = self.epoch;
        Ok(())
    }

    /// The renderer at work.
    pub fn renderer(&mut self) -> &mut Renderer {
        &mut self.stages[self.current].renderer
    }

    /// By how much its picture is smaller a side.
    pub fn divisor(&self) -> u32 {
        self.stages[self.current].divisor
    }

    /// Width and height of the whole picture.
    pub fn size(&self) -> [u32; 2] {
        let Settings { width, height, .. } = *self.stages[0].renderer.settings();
        [width, height]
    }

    /// Notes how fast samples were made.
    pub fn timed(&mut self, samples: u64, seconds: f64) {
        if samples >= 1000 && seconds > 0.0 {
            self.rate = 0.5 * self.rate + 0.5 * samples as f64 / seconds;
        }
    }

    /// Camera samples a second.
    pub fn rate(&self) -> f64 {
        self.rate
    }
}
