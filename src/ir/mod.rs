//! The intermediate program: structured code over registers of single numbers, and the way a typed shader becomes one.
//!
//! [`lower::lower`] writes the layers of a group one after the other into one [`program::Program`], with parameters bound and
//! functions expanded. [`mod@print`] shows it, [`verify`] states what a program promises: a verified program cannot fail.
//!
//! Decision (2026-11-22): instructions work on single numbers, not on triples, because folding, uniform values,
//! derivatives and dead code then work a component at a time with one set of rules, and a column loop over one number
//! is what the machine vectorises best. The price is a longer listing.
//!
//! Decision (2026-11-22): parameters are bound and layers joined while lowering, instead of by a pass over a finished
//! program, because the builder folds constants as it goes: a bound parameter then disappears with everything that
//! hangs on it, and no second constant propagation through variables and branches is needed.

pub mod build;
pub mod fold;
pub mod kind;
pub mod lower;
pub mod noise;
pub mod op;
pub mod print;
pub mod program;
mod queries;
pub mod routine;
pub mod verify;
