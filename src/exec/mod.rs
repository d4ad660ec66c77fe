//! Program and points to closure tree: the machine that runs shaders over batches.
//!
//! A register is a column, one number a lane, or one number for all lanes when the optimizer found it uniform. Each
//! instruction, one operation or a pair of them, is decoded once and then loops over the lanes (`kernels`). Control flow
//! narrows a mask; what only some lanes do is blended in by masked moves.
//!
//! Decision (2026-11-22): a move takes the column of a register that nothing else reads, and a block's instructions are taken
//! from the budget at once, because a loop of 110 operations then takes 32 ns a point instead of 33 to 34; instead of a copy, and of
//! a count with each instruction.

mod arrays;
mod closures;
mod code;
mod group;
mod host;
mod kernels;
mod lane;
mod machine;
mod noise;
mod output;
mod points;
mod questions;
mod registers;
mod report;
mod routines;
mod run;
mod smooth;
mod text;

pub use group::{Group, Locate};
pub use host::{Attribute, AttributeAnswer, AttributeRequest, Host, PlainHost, built_in_space};
pub use machine::{DEFAULT_BUDGET, Machine};
pub use output::{OutputView, Values};
pub use points::{MAX_LANES, Points, RAY_TYPES};
pub use report::{Report, ReportKind, ReportPlace};
