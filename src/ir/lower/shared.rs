//! What the layers of a group hand to each other while they are lowered.

use super::spec::{Layer, LowerOptions};
use super::value::Value;
use crate::ir::program::Output;
use crate::lang::globals::Global;
use crate::lang::types::Type;
use std::collections::HashMap;
use std::rc::Rc;

/// The parameters of a layer that has run.
pub(super) type Params = HashMap<String, (Value, Type)>;

/// What the layers of a group share while it is lowered.
#[derive(Default)]
pub(super) struct Shared<'a> {
    pub(super) layers: &'a [Layer],
    pub(super) group_name: String,
    pub(super) options: LowerOptions,
    /// The parameters of layers that have run.
    pub(super) finished: Vec<Option<Rc<Params>>>,
    /// The values of globals that a layer has assigned.
    pub(super) globals: Vec<(Global, Value)>,
    pub(super) outputs: Vec<Output>,
}
