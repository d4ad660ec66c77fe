//! A program laid out flat, to follow values from node to node: each node with the block around it, and who reads and writes what.
//!
//! Passes that walk the program until nothing changes take a walk for every branch in a chain. With these lists a fact is
//! carried to those it concerns only, so that the work grows with the program.

use crate::ir::program::*;

/// Number lists, one a key, in two arrays.
#[derive(Default)]
pub(super) struct Lists {
    first: Vec<u32>,
    entries: Vec<(u32, u32)>,
}

const NONE: u32 = u32::MAX;

impl Lists {
    fn new(keys: usize) -> Self {
        Lists { first: vec![NONE; keys], entries: Vec::new() }
    }

    fn add(&mut self, key: u32, value: usize) {
        let first = &mut self.first[key as usize];
        self.entries.push((value as u32, *first));
        *first = self.entries.len() as u32 - 1;
    }

    /// The numbers of a key.
    pub(super) fn of(&self, key: u32) -> impl Iterator<Item = usize> {
        let mut at = self.first[key as usize];
        std::iter::from_fn(move || {
            let (value, next) = *self.entries.get(at as usize)?;
            at = next;
            Some(value as usize)
        })
    }
}

/// A node, and where it stands.
pub(super) struct Placed<'p> {
    pub node: &'p Node,
    /// The block around it.
    pub block: usize,
    /// Its place in that block.
    pub at: usize,
    /// The blocks inside it, in order.
    pub inside: [Option<usize>; 2],
}

/// A block: the node around it, and its nodes.
pub(super) struct Around {
    pub owner: Option<usize>,
    pub nodes: Vec<usize>,
}

/// The program laid out: nodes are numbered in the order of the text, a node before those inside it.
pub(super) struct Flow<'p> {
    pub nodes: Vec<Placed<'p>>,
    pub blocks: Vec<Around>,
    /// Nodes that read each register, as an operand or as a condition.
    pub readers: Lists,
    /// Instructions that write each register.
    pub writers: Lists,
    /// Instructions that read each array.
    pub getters: Lists,
    /// Instructions that write each array.
    pub setters: Lists,
}

impl<'p> Flow<'p> {
    pub(super) fn of(program: &'p Program) -> Self {
        let (regs, arrays) = (program.regs.len(), program.arrays.len());
        let mut flow = Flow {
            nodes: Vec::new(),
            blocks: Vec::new(),
            readers: Lists::new(regs),
            writers: Lists::new(regs),
            getters: Lists::new(arrays),
            setters: Lists::new(arrays),
        };
        flow.block(&program.body, None);
        flow
    }

    fn block(&mut self, block: &'p Block, owner: Option<usize>) -> usize {
        let number = self.blocks.len();
        self.blocks.push(Around { owner, nodes: Vec::with_capacity(block.len()) });
        for (at, node) in block.iter().enumerate() {
            let own = self.nodes.len();
            self.blocks[number].nodes.push(own);
            self.nodes.push(Placed { node, block: number, at, inside: [None; 2] });
            self.nodes[own].inside = match node {
                Node::Instr(instr) => {
                    self.instr(instr, own);
                    [None; 2]
                }
                Node::If(condition, a, b) => {
                    self.readers.add(condition.0, own);
                    [Some(self.block(a, Some(own))), Some(self.block(b, Some(own)))]
                }
                Node::Loop { head, condition, body, .. } => {
                    self.readers.add(condition.0, own);
                    [Some(self.block(head, Some(own))), Some(self.block(body, Some(own)))]
                }
                Node::Scope(_, body) => [Some(self.block(body, Some(own))), None],
                Node::Leave(_) => [None; 2],
            };
        }
        number
    }

    fn instr(&mut self, instr: &Instr, own: usize) {
        instr.reads(|reg| self.readers.add(reg.0, own));
        instr.writes(|reg| self.writers.add(reg.0, own));
        if let Instr::ArrayGet { array, .. } = instr {
            self.getters.add(array.0, own);
        }
        if let Instr::ArraySet { array, .. } = instr {
            self.setters.add(array.0, own);
        }
    }

    /// The node around a node.
    pub(super) fn owner(&self, node: usize) -> Option<usize> {
        self.blocks[self.nodes[node].block].owner
    }
}
