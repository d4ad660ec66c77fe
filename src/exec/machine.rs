//! The machine: runs a program over a batch of points. One machine a thread; it keeps its scratch between batches.

use super::group::Group;
use super::host::{Host, PlainHost};
use super::output::OutputView;
use super::points::Points;
use super::registers::Registers;
use super::report::Report;
use super::run::{Run, Scratch};
use crate::closure::tree::Tree;
use std::cell::Cell;
use std::collections::HashMap;
use std::sync::Arc;

/// The work that one batch may do before its shader counts as endless, in simple instructions over a whole batch: a second or two.
/// What costs more counts for more, by its lanes and by the bytes of its texts.
pub const DEFAULT_BUDGET: u64 = crate::limits::WORK;

/// Runs shader groups over batches of points.
pub struct Machine {
    files: HashMap<u64, Registers>,
    /// The group of the batch before.
    latest: Option<u64>,
    tree: Tree,
    host: Arc<dyn Host>,
    reports: Vec<Report>,
    scratch: Scratch,
    given_up: bool,
    /// The work that a batch may do, by default [`DEFAULT_BUDGET`].
    pub budget: u64,
}

impl std::fmt::Debug for Machine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Machine").field("budget", &self.budget).finish_non_exhaustive()
    }
}

impl Default for Machine {
    fn default() -> Self {
        Self::new()
    }
}

impl Machine {
    /// A machine with a host that knows nothing of its own: no named spaces beside the built-in ones and no attributes.
    pub fn new() -> Self {
        Self::with_host(Arc::new(PlainHost::default()))
    }

    /// A machine whose shaders ask a host.
    pub fn with_host(host: Arc<dyn Host>) -> Self {
        let (files, tree, reports) = (HashMap::new(), Tree::default(), Vec::new());
        Machine {
            files,
            latest: None,
            tree,
            host,
            reports,
            scratch: Scratch::default(),
            given_up: false,
            budget: DEFAULT_BUDGET,
        }
    }

    /// Runs a group over points and gives the closure tree of the batch. Its strings and the outputs ([`Machine::output`]) stay
    /// readable until the next batch.
    pub fn shade(&mut self, group: &Group, points: &Points) -> &Tree {
        let n = points.len;
        self.tree.clear(n);
        self.given_up = false;
        if n == 0 {
            return &self.tree;
        }
        // One look is enough for the group of the batch before.
        if self.latest != Some(group.id) && !self.files.contains_key(&group.id) {
            // A group that is new here is a good moment to give back what dropped ones had.
            self.files.retain(|_, regs| regs.wanted());
        }
        self.latest = Some(group.id);
        let regs = self.files.entry(group.id).or_insert_with(|| Registers::of(group));
        regs.prepare(group, n);
        regs.forget_closures();
        for &(reg, input) in group.inputs() {
            regs.load(reg, input, points);
        }
        let mut run = Run {
            group,
            points,
            regs,
            tree: &mut self.tree,
            host: &*self.host,
            reports: &mut self.reports,
            s: &mut self.scratch,
            n,
            active: n,
            budget: self.budget,
            stopped: false,
            ask_below: self.budget.saturating_sub(1),
            given_up: false,
            read: Cell::new(0),
        };
        run.s.begin(n, group.program.scopes as usize);
        run.block(&group.program.body);
        run.flush();
        self.given_up = run.given_up;
        self.tree.root = group.program.result.and_then(|reg| regs.closures[reg.0 as usize]);
        &self.tree
    }

    /// True when the last batch was left unfinished because the host had given up: its results mean nothing.
    pub fn given_up(&self) -> bool {
        self.given_up
    }

    /// The tree of the last batch.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// What shaders printed and what went wrong since the last call, batch by batch and in each lane by lane, as far as the
    /// host has left it.
    pub fn take_reports(&mut self) -> Vec<Report> {
        std::mem::take(&mut self.reports)
    }

    /// An output of the last batch of a group by its name, `name` or `layer.name`; of several layers' the last one's. A group has
    /// those that it was built to keep.
    pub fn output<'m>(&'m self, group: &'m Group, name: &str) -> Option<OutputView<'m>> {
        let regs = self.files.get(&group.id)?;
        let output = group.program.output(name)?;
        Some(OutputView { output, program: &group.program, regs, tree: &self.tree })
    }

    /// How many groups it keeps registers for; those of dropped groups go when it meets a new one.
    pub fn groups_held(&self) -> usize {
        self.files.len()
    }
}
