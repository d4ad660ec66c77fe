//! Program and points to closure tree: the machine that runs shaders over batches.
//!
//! A register is a column, one number a lane, or one number for all lanes when the optimizer found it uniform. Each
//! instruction, one operation or a pair of them, is decoded once and then loops over the lanes (`kernels`). Control flow
//! narrows a mask; what only some lanes do is blended in by masked moves.
//!
//! Decision (2026-11-22): a move takes the column of a register that nothing else reads, and a block's instructions are taken
//! from the budget at once, because a loop of 110 operations then takes 32 ns a point instead of 33 to 34; instead of a copy, and of
//! a count with each instruction.
//!
//! Decision (2026-11-29): what OSL calls userdata, the values that a mesh carries to its points, is asked for as an attribute of the
//! object being shaded, by `getattribute` and by parameters that are not locked (`lockgeom = 0`), because both want the same value; a
//! parameter that is locked, as all are by default, is known when a group is built, and folded into its program.
//!
//! Decision (2026-11-29): an attribute counts as different from lane to lane, whatever the host answers, because the batch of a
//! material holds points of many objects and what an object carries differs from point to point, and no compiled program can know; the price
//! is a column where one number would do; instead of a promise of the host before compiling.
//!
//! Decision (2026-11-29): the machine knows a group's registers by the program they are of, which it holds weakly, and gives back
//! those of dropped groups when it meets a new one, because 4,000 groups built, shaded and dropped kept 223 MB; instead of a call
//! that a host would have to make.
//!
//! Decision (2026-11-29): the budget of a batch counts work, not instructions: what costs more than a simple instruction takes more, by
//! lanes and by bytes of text (`cost`), because 20 million instructions were a third of a second of sums, 17 s of noise, and no
//! end of formats of 4000 digits; instead of a clock, by which a shader would run on one machine and not on another.

mod arrays;
mod closures;
mod code;
mod cost;
mod dictionaries;
mod found;
mod group;
mod host;
mod kernels;
mod lane;
mod machine;
mod messages;
mod noise;
mod output;
mod points;
mod questions;
mod registers;
mod report;
mod routines;
mod run;
mod slots;
mod smooth;
mod text;
mod textures;

pub use group::{Group, Locate};
pub use host::{Attribute, AttributeAnswer, AttributeRequest, Host, PlainHost, TraceRequest, built_in_space};
pub use machine::{DEFAULT_BUDGET, Machine};
pub use output::{OutputView, Values};
pub use points::{MAX_LANES, Points, RAY_TYPES};
pub use report::{MessageFault, Mistake, Report, ReportKind, ReportPlace};
