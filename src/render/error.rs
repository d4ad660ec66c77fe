//! Why a scene cannot be rendered.

use crate::scene::CameraFlaw;
use std::fmt;

/// What keeps a scene from being rendered.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RenderError {
    /// The settings ask for what cannot be.
    Settings(String),
    /// The camera cannot make a picture.
    Camera(CameraFlaw),
    /// There is no such material.
    Material {
        /// The index that was asked for.
        index: usize,
        /// How many materials the scene has.
        count: usize,
    },
    /// The threads could not be started, for this reason.
    Threads(String),
    /// A thread has failed, which is a mistake in this crate.
    ThreadFailed,
    /// A shader cannot be run, for this reason, which begins with a place where there is one.
    Shader(String),
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RenderError::Settings(message) | RenderError::Shader(message) => f.write_str(message),
            RenderError::Camera(flaw) => write!(f, "{flaw}"),
            RenderError::Material { index, count } => {
                write!(f, "there is no material {index}; the scene has {count}, counted from 0")
            }
            RenderError::Threads(reason) => write!(f, "the threads could not be started: {reason}"),
            RenderError::ThreadFailed => f.write_str("a thread has failed"),
        }
    }
}

impl std::error::Error for RenderError {}
