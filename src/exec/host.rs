//! What a host gives to its shaders besides points, and what it hears from them.

use crate::ops::matrix::{IDENTITY, Matrix, inverse, multiply};
use std::collections::HashMap;

/// The value of a named attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// Ints.
    Ints(Vec<i32>),
    /// Floats.
    Floats(Vec<f32>),
    /// Strings.
    Strings(Vec<String>),
}

/// Named spaces and attributes of a renderer.
#[derive(Clone, Debug, Default)]
pub struct Host {
    /// The matrix from each named space to "common". "common", "world", "object" and "shader" are there without being
    /// named, and equal to common.
    pub spaces: HashMap<String, Matrix>,
    /// Attributes by name.
    pub attributes: HashMap<String, Attribute>,
}

impl Host {
    fn to_common(&self, name: &str) -> Option<Matrix> {
        let built_in = matches!(name, "" | "common" | "world" | "object" | "shader");
        self.spaces.get(name).copied().or(built_in.then_some(IDENTITY))
    }

    /// The matrix from one named space to another, when both are known.
    pub fn matrix(&self, from: &str, to: &str) -> Option<Matrix> {
        Some(multiply(&self.to_common(from)?, &inverse(&self.to_common(to)?)))
    }
}

/// Something a shader said, or that went wrong while it ran.
#[derive(Clone, Debug, PartialEq)]
pub enum Report {
    /// `printf`
    Output(String),
    /// `fprintf`: file name and text.
    File(String, String),
    /// `warning`
    Warning(String),
    /// `error`, or a mistake that shading survives, such as an index outside its array.
    Error(String),
    /// The shader cannot be run: the host should stop.
    Fatal(String),
}
