//! What a command ends with when it does not do what it was asked for.

use crate::compile::CompileError;
use crate::render::RenderError;
use crate::scene::{SceneError, SceneProblem};

/// What a command ends with.
#[derive(Debug)]
pub enum Failure {
    /// A shader or a scene is wrong: status 1.
    Wrong(String),
    /// The command was used wrongly, or a file cannot be read or written: status 2.
    Usage(String),
    /// Somebody has asked the render to stop, and what there was is kept: the status that goes with the signal.
    Stopped(u8),
}

impl Failure {
    /// A scene that cannot be loaded.
    pub fn of_scene(error: SceneError) -> Self {
        let wrong = match &*error.problem {
            SceneProblem::Shader { error: said, .. } => {
                error.place.is_some() || !matches!(**said, CompileError::File { .. })
            }
            // Without a place the scene file itself could not be read.
            _ => error.place.is_some(),
        };
        if wrong { Failure::Wrong(error.to_string()) } else { Failure::Usage(error.to_string()) }
    }

    /// A scene that cannot be rendered.
    pub fn of_render(error: RenderError) -> Self {
        Failure::Wrong(error.told())
    }
}
