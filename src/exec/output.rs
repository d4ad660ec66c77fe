//! Outputs of a group after a batch, by name and lane.

use super::registers::Registers;
use crate::closure::tree::{NodeId, Tree};
use crate::ir::program::{ArrayInfo, Kind, Output, OutputValue, Program, Reg};
use crate::lang::symbols::Symbol;
use crate::lang::types::Type;

/// An output of the last batch.
#[derive(Clone, Copy)]
pub struct OutputView<'m> {
    pub(super) output: &'m Output,
    pub(super) program: &'m Program,
    pub(super) regs: &'m Registers,
    pub(super) tree: &'m Tree,
}

/// The values of an output in one lane: the components of its elements in order.
#[derive(Clone, Debug, PartialEq)]
pub enum Values<'m> {
    /// Of a float, color, point, vector, normal or matrix.
    Floats(Vec<f32>),
    /// Of an int.
    Ints(Vec<i32>),
    /// Of a string.
    Strings(Vec<&'m str>),
    /// Of a closure: nodes of the batch's tree, nothing for no closure.
    Closures(Vec<Option<NodeId>>),
}

impl std::fmt::Debug for OutputView<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("OutputView").field("output", self.output).finish_non_exhaustive()
    }
}

impl<'m> OutputView<'m> {
    /// The output's type.
    pub fn ty(&self) -> &'m Type {
        &self.output.ty
    }

    /// The name of its layer.
    pub fn layer(&self) -> &'m str {
        &self.output.layer
    }

    /// Its values in one lane of the batch, below the number of its points.
    pub fn lane(&self, lane: usize) -> Values<'m> {
        match &self.output.value {
            OutputValue::Regs(regs) => self.registers(regs, lane),
            OutputValue::Array(array) => self.array(array.0 as usize, lane),
        }
    }

    /// Writes the numbers of as many lanes as there is room for, lane after lane as [`OutputView::lane`] has them; ints as floats, and nothing
    /// of strings and closures.
    pub fn copy_numbers(&self, out: &mut [f32]) {
        match &self.output.value {
            OutputValue::Regs(regs) => {
                let kind = |reg: &Reg| self.program.kind(*reg);
                for (c, reg) in regs.iter().enumerate() {
                    let to = out.iter_mut().skip(c).step_by(regs.len());
                    match kind(reg) {
                        Kind::Float => copy_column(&self.regs.floats[reg.0 as usize], to, |x| x),
                        Kind::Int => copy_column(&self.regs.ints[reg.0 as usize], to, |x| x as f32),
                        Kind::String | Kind::Closure => {}
                    }
                }
            }
            OutputValue::Array(array) => {
                let at = array.0 as usize;
                let info = &self.program.arrays[at];
                let numbers = (info.len * info.components) as usize;
                for (lane, out) in out.chunks_exact_mut(numbers.max(1)).enumerate() {
                    match info.kind {
                        Kind::Float => copy_all(self.elements(info, &self.regs.float_arrays[at], lane), out),
                        Kind::Int => {
                            copy_all(self.elements(info, &self.regs.int_arrays[at], lane).map(|x| x as f32), out);
                        }
                        Kind::String | Kind::Closure => {}
                    }
                }
            }
        }
    }

    fn registers(&self, regs: &[Reg], lane: usize) -> Values<'m> {
        let kind = regs.first().map_or(Kind::Float, |&reg| self.program.kind(reg));
        let numbers = regs.iter().map(|reg| reg.0 as usize);
        match kind {
            Kind::Float => Values::Floats(numbers.map(|at| at_lane(&self.regs.floats[at], lane)).collect()),
            Kind::Int => Values::Ints(numbers.map(|at| at_lane(&self.regs.ints[at], lane)).collect()),
            Kind::String => Values::Strings(numbers.map(|at| self.text(at_lane(&self.regs.ints[at], lane))).collect()),
            Kind::Closure => Values::Closures(numbers.map(|at| self.regs.closures[at]).collect()),
        }
    }

    fn array(&self, at: usize, lane: usize) -> Values<'m> {
        let info = self.program.arrays[at];
        match info.kind {
            Kind::Float => Values::Floats(self.elements(&info, &self.regs.float_arrays[at], lane).collect()),
            Kind::Int => Values::Ints(self.elements(&info, &self.regs.int_arrays[at], lane).collect()),
            Kind::String => {
                let symbols = self.elements(&info, &self.regs.int_arrays[at], lane);
                Values::Strings(symbols.map(|symbol| self.text(symbol)).collect())
            }
            Kind::Closure => Values::Closures(self.regs.closure_arrays[at].clone()),
        }
    }

    fn text(&self, symbol: i32) -> &'m str {
        self.tree.strings.text(Symbol(symbol))
    }

    /// The numbers of an array in one lane: number after number, each a column.
    fn elements<T: Copy + 'm>(
        &self,
        info: &ArrayInfo,
        columns: &'m [T],
        lane: usize,
    ) -> impl Iterator<Item = T> + use<'m, T> {
        let lanes = if info.uniform { 1 } else { self.regs.lanes };
        columns.chunks(lanes.max(1)).map(move |column| at_lane(column, lane))
    }
}

/// A column, or the one number of all lanes, to places a lane.
fn copy_column<'o, T: Copy>(column: &[T], to: impl Iterator<Item = &'o mut f32>, number: impl Fn(T) -> f32) {
    match column {
        [one] => to.for_each(|to| *to = number(*one)),
        _ => to.zip(column).for_each(|(to, x)| *to = number(*x)),
    }
}

fn copy_all(from: impl Iterator<Item = f32>, to: &mut [f32]) {
    to.iter_mut().zip(from).for_each(|(to, x)| *to = x);
}

/// The number of one lane, or the one of all lanes.
fn at_lane<T: Copy>(column: &[T], lane: usize) -> T {
    if column.len() == 1 { column[0] } else { column[lane] }
}
