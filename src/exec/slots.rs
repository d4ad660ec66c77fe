//! What a machine keeps of the messages of a batch.

use crate::closure::tree::NodeId;
use crate::ir::op::MessageShape;
use crate::ir::program::Kind;
use velour_grammar::Span;

/// What is known of a message in one lane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum State {
    #[default]
    Nothing,
    /// It was asked for when it was not there.
    Asked,
    Set,
}

/// The messages of one name and type, lane by lane.
#[derive(Debug, Default)]
pub(super) struct Slot {
    pub name: i32,
    pub shape: Option<MessageShape>,
    pub states: Vec<State>,
    /// Where each lane has set it or asked for it.
    pub spans: Vec<Span>,
    pub floats: Vec<Vec<f32>>,
    pub ints: Vec<Vec<i32>>,
    pub closures: Vec<Option<NodeId>>,
}

impl Slot {
    pub fn new(name: i32, shape: &MessageShape, lanes: usize) -> Self {
        let count = shape.count as usize;
        let mut slot = Slot {
            name,
            shape: Some(shape.clone()),
            states: vec![State::Nothing; lanes],
            spans: vec![Span::NONE; lanes],
            ..Slot::default()
        };
        match shape.kind {
            Kind::Float => slot.floats.resize(count, vec![0.0; lanes]),
            Kind::Int | Kind::String => slot.ints.resize(count, vec![0; lanes]),
            Kind::Closure => slot.closures.resize(count, None),
        }
        slot
    }
}
