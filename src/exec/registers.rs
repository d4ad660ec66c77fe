//! The registers of a group: one column each, which stay between batches.

use super::group::Group;
use super::points::Points;
use crate::closure::tree::NodeId;
use crate::ir::op::Input;
use crate::ir::program::*;
use std::sync::{Arc, Weak};

/// The registers of one group.
#[derive(Default)]
pub(super) struct Registers {
    pub floats: Vec<Vec<f32>>,
    pub ints: Vec<Vec<i32>>,
    pub closures: Vec<Option<NodeId>>,
    pub float_arrays: Vec<Vec<f32>>,
    pub int_arrays: Vec<Vec<i32>>,
    pub closure_arrays: Vec<Vec<Option<NodeId>>>,
    /// Lanes that each register file has room for.
    pub lanes: usize,
    /// The program they are of; when it is gone, so is every group of it.
    owner: Weak<Program>,
}

impl Registers {
    /// No registers yet, for a group.
    pub fn of(group: &Group) -> Self {
        Registers { owner: Arc::downgrade(&group.program), ..Registers::default() }
    }

    /// Can there still be a group that they are of?
    pub fn wanted(&self) -> bool {
        self.owner.strong_count() > 0
    }

    /// Drops the closures of the batch before: their nodes are gone with its tree.
    pub fn forget_closures(&mut self) {
        self.closures.fill(None);
        self.closure_arrays.iter_mut().for_each(|array| array.fill(None));
    }

    /// Makes room for a batch and sets the constants; costs nothing when the width stays the same.
    pub fn prepare(&mut self, group: &Group, n: usize) {
        let program = &*group.program;
        let count = program.regs.len();
        if self.floats.len() == count && self.lanes == n {
            return;
        }
        self.floats.resize(count, Vec::new());
        self.ints.resize(count, Vec::new());
        self.closures.resize(count, None);
        self.lanes = n;
        for (at, info) in program.regs.iter().enumerate() {
            let lanes = if info.uniform { 1 } else { n };
            match info.kind {
                Kind::Float => self.floats[at].resize(lanes, 0.0),
                Kind::Int | Kind::String => self.ints[at].resize(lanes, 0),
                Kind::Closure => {}
            }
            match info.source {
                Source::Const(Const::Float(value)) => self.floats[at].fill(value),
                Source::Const(Const::Int(value) | Const::String(value)) => self.ints[at].fill(value),
                Source::Const(Const::NoClosure) | Source::Input(_) | Source::Code => {}
            }
        }
        let arrays = program.arrays.len();
        self.float_arrays.resize(arrays, Vec::new());
        self.int_arrays.resize(arrays, Vec::new());
        self.closure_arrays.resize(arrays, Vec::new());
        for (at, info) in program.arrays.iter().enumerate() {
            let size = (info.len * info.components) as usize;
            let lanes = if info.uniform { 1 } else { n };
            match info.kind {
                Kind::Float => self.float_arrays[at].resize(size * lanes, 0.0),
                Kind::Int | Kind::String => self.int_arrays[at].resize(size * lanes, 0),
                Kind::Closure => self.closure_arrays[at].resize(size, None),
            }
        }
    }

    /// Copies an input of the points.
    pub fn load(&mut self, reg: Reg, input: Input, points: &Points) {
        let n = points.len;
        if input == Input::Backfacing {
            self.ints[reg.0 as usize][..n].copy_from_slice(&points.backfacing[..n]);
            return;
        }
        let column = &mut self.floats[reg.0 as usize];
        match points.column(input) {
            Some(values) => column[..n].copy_from_slice(&values[..n]),
            None => column.fill(0.0),
        }
    }

    /// A float column.
    pub fn f(&self, reg: Reg) -> &[f32] {
        &self.floats[reg.0 as usize]
    }

    /// A column of ints or symbols.
    pub fn i(&self, reg: Reg) -> &[i32] {
        &self.ints[reg.0 as usize]
    }
}
