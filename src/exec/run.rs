//! One batch under way: what every part of the machine works on.

use super::found::Dictionaries;
use super::group::Group;
use super::host::Host;
use super::points::Points;
use super::registers::Registers;
use super::report::Report;
use super::slots::Slot;
use crate::closure::tree::{Keyword, NodeId, Param, Tree};
use crate::ir::program::Reg;
use crate::ops::matrix::Matrix;
use crate::texture::Texture;
use std::cell::Cell;
use std::sync::Arc;
use velour_grammar::Span;

/// A texture as the host gave it, or why there is none.
pub(super) type TextureFound = Result<Arc<Texture>, String>;

/// Memory that is used anew by every batch, so that a warm machine allocates nothing.
#[derive(Default)]
pub(super) struct Scratch {
    pub mask: Vec<i32>,
    /// Lanes that have left each scope.
    pub left: Vec<Vec<i32>>,
    /// Masks that are not in use.
    pub spare: Vec<Vec<i32>>,
    /// What each lane has printed so far.
    pub texts: Vec<Vec<Report>>,
    /// How many texts and bytes that is, and how many texts were left out.
    pub said: Said,
    /// Mistakes that have been reported in this batch.
    pub mistakes: Vec<(Span, String)>,
    /// Spaces that the host was asked for in this batch, by symbol.
    pub spaces: Vec<(i32, Option<Matrix>)>,
    /// Ray types that the host was asked for in this batch, by symbol.
    pub ray_types: Vec<(i32, i32)>,
    /// The lanes that the host is asked for.
    pub asked: Vec<usize>,
    /// Offsets of input columns in the tree, once a closure has used them.
    pub shared: Vec<(Reg, u32)>,
    /// The parameters of the leaf that is being built.
    pub params: Vec<Param>,
    /// Its keyword parameters.
    pub keywords: Vec<Keyword>,
    /// Results of a routine in one lane.
    pub ints: Vec<i32>,
    /// Columns that a noise writes.
    pub columns: Vec<Vec<f32>>,
    /// Columns of ints that an attribute fills.
    pub int_columns: Vec<Vec<i32>>,
    /// The names that the host is asked about.
    pub names: [String; 2],
    /// The messages of this batch.
    pub messages: Vec<Slot>,
    /// Dictionaries, and what was found in them in this batch.
    pub dictionaries: Dictionaries,
    /// Textures that the host was asked for in this batch, by name and by symbol.
    pub textures: Vec<(String, TextureFound)>,
    /// See `textures`; those of many files are not here.
    pub texture_symbols: Vec<(i32, TextureFound)>,
    /// How many random numbers each lane has had; empty when none has had any.
    pub draws: Vec<u32>,
}

/// How much a batch has said.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Said {
    pub texts: usize,
    pub bytes: usize,
    pub left_out: u64,
}

/// One batch under way.
pub(super) struct Run<'a> {
    pub group: &'a Group,
    pub points: &'a Points,
    pub regs: &'a mut Registers,
    pub tree: &'a mut Tree,
    pub host: &'a dyn Host,
    pub reports: &'a mut Vec<Report>,
    pub s: &'a mut Scratch,
    pub n: usize,
    pub active: usize,
    pub budget: u64,
    /// True once the batch has been given up.
    pub stopped: bool,
    /// The host is asked whether it gives up when the budget has come down to this.
    pub ask_below: u64,
    /// True once the host has given up.
    pub given_up: bool,
    /// Bytes of strings that routines have read since that was charged.
    pub read: Cell<u64>,
}

/// How much of the budget is used between two questions to the host: some 50 microseconds of a whole batch.
const ASK_EVERY: u64 = 1000;

impl Scratch {
    /// Makes ready for a batch.
    pub fn begin(&mut self, n: usize, scopes: usize) {
        self.mask.clear();
        self.mask.resize(n, 1);
        self.left.resize_with(scopes.max(self.left.len()), Vec::new);
        self.mistakes.clear();
        self.said = Said::default();
        self.spaces.clear();
        self.ray_types.clear();
        self.shared.clear();
        self.messages.clear();
        self.dictionaries.begin();
        self.draws.clear();
        self.textures.clear();
        self.texture_symbols.clear();
    }
}

impl Run<'_> {
    /// Does a register keep one number for all lanes?
    pub fn uniform(&self, reg: Reg) -> bool {
        self.group.program.regs[reg.0 as usize].uniform
    }

    /// The lanes a result is computed in: one when all are the same.
    pub fn lanes_of(&self, dst: Reg) -> usize {
        if self.uniform(dst) { 1 } else { self.n }
    }

    /// Takes from the budget; the unit is a simple instruction over a whole batch, some 50 ns.
    pub fn charge(&mut self, cost: u64) {
        self.budget = self.budget.saturating_sub(cost);
    }

    /// Asks the host now and then whether it still waits for the batch.
    pub fn ask_host(&mut self) {
        if self.budget < self.ask_below {
            self.ask_below = self.budget.saturating_sub(ASK_EVERY);
            if self.host.gives_up() {
                (self.given_up, self.stopped) = (true, true);
            }
        }
    }

    /// Is there nothing to do in a lane? Lanes that are not here may hold anything, which costs time in the slow routines.
    pub fn idle(&self, lane: usize, lanes: usize) -> bool {
        self.s.mask[lane] == 0 && self.active < self.n && lanes > 1
    }

    /// A lane that is here, to report what concerns all of them.
    pub fn first_active(&self) -> usize {
        self.s.mask.iter().position(|&m| m != 0).unwrap_or(0)
    }

    /// The closure a register holds.
    pub fn closure(&self, reg: Reg) -> Option<NodeId> {
        self.regs.closures[reg.0 as usize]
    }
}
