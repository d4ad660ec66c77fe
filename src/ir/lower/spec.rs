//! What a group is made of: layers, what their parameters get, and how they are lowered.

use crate::check::typed::Shader;
use crate::ops::working_space::WorkingSpace;
use std::sync::Arc;

/// What a parameter of a layer gets instead of its default.
#[derive(Clone, Debug, PartialEq)]
pub enum Binding {
    /// Numbers in order, as many as the parameter has components; too few are filled with zero.
    Numbers(Vec<f64>),
    /// Strings in order.
    Strings(Vec<String>),
    /// The output of an earlier layer: its index, the parameter's name (with `.field` or `[i]`), of the source.
    Connection(usize, String),
}

/// A layer of a group.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Its name.
    pub name: String,
    /// Its shader.
    pub shader: Arc<Shader>,
    /// Parameters that are given, by name (with `.field` or `[i]` for a part).
    pub bindings: Vec<(String, Binding)>,
    /// Parameters by name of which it is said whether userdata of their name goes first; of others their shader says it.
    pub interpolated: Vec<(String, bool)>,
}

/// What to lower for.
#[derive(Clone, Copy, Debug, Default)]
pub struct LowerOptions {
    /// Fold constants and share equal values while building.
    pub simplify: bool,
    /// Keep the output parameters of every layer as results.
    pub outputs: bool,
    /// Keep `P`, where it is assigned, as a result of that name.
    pub position: bool,
    /// Which layers wait until somebody reads what they put out.
    pub lazy: Lazy,
    /// Count parameters that userdata may fill as connected.
    pub userdata_connects: bool,
    /// Report what is assigned and is no finite number.
    pub watch: bool,
    /// What RGB means.
    pub working_space: WorkingSpace,
}

/// Which layers wait until somebody reads what they put out; any other runs in its turn. OSL has options of these names, all on at
/// first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lazy {
    /// Any: without, all layers run in order.
    pub layers: bool,
    /// Those that assign globals.
    pub globals: bool,
    /// Those that feed nobody, which then never run.
    pub unconnected: bool,
    /// Those that trace rays.
    pub traces: bool,
    /// Those that call `error`.
    pub errors: bool,
}

impl Default for Lazy {
    fn default() -> Self {
        Lazy { layers: true, globals: true, unconnected: true, traces: true, errors: true }
    }
}
