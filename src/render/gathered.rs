//! What the threads of a renderer put together.

use super::error::RenderError;
use super::film::Film;
use super::path::Dropped;
use super::rounds::{Rounds, Task};
use super::settings::Settings;
use super::tile::Tile;
use super::wave::Wave;
use super::world::World;
use crate::exec::Report;

/// What the threads put together.
pub struct Gathered {
    /// Sums of light.
    pub film: Film,
    /// How far each tile has come.
    pub rounds: Rounds,
    /// What was no light.
    pub dropped: Dropped,
    /// Camera samples that were traced here.
    pub paths: u64,
    /// Rays that were traced here.
    pub rays: u64,
    /// What shaders have said.
    pub reports: Vec<Report>,
    /// Seconds of all rounds.
    pub seconds_tracing: f64,
}

impl Gathered {
    /// Nothing yet, but what was said while the world was made.
    pub fn new(world: &World) -> Self {
        Gathered {
            film: Film::new(&world.settings),
            rounds: Rounds::new(&world.settings, world.stop.clone()),
            dropped: Dropped::default(),
            paths: 0,
            rays: 0,
            reports: world.reports.clone(),
            seconds_tracing: 0.0,
        }
    }

    /// Takes in what a thread has found out of one tile.
    pub fn keep(&mut self, settings: &Settings, task: &Task, wave: &mut Wave) {
        self.rounds.done(task);
        let pixels = Tile::number(settings, task.tile).pixels();
        self.paths += u64::from(pixels) * u64::from(task.end - task.first);
        self.dropped.merge(&std::mem::take(&mut wave.dropped));
        self.rays += std::mem::take(&mut wave.traced);
        self.reports.extend(wave.shading.take_reports());
    }

    /// Is there anything at all when the time is up?
    pub fn check_time(&self) -> Result<(), RenderError> {
        let nothing = self.rounds.late() && self.rounds.taken().all(|samples| samples == 0);
        if nothing { Err(RenderError::Late) } else { Ok(()) }
    }

    /// The first report that a shader cannot be run.
    pub fn check(&self) -> Result<(), RenderError> {
        let fatal = |report: &Report| report.is_fatal().then(|| RenderError::Shader(report.to_string()));
        self.reports.iter().find_map(fatal).map_or(Ok(()), Err)
    }
}
