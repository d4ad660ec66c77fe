//! The command line: arguments, subcommands, messages to people. All printing and all exit codes are here.
//!
//! Decision (2026-11-30): what the command line says goes before what a scene's `Option` does, because who types a number of samples means it;
//! instead of the scene before the command line, as testrender has it.

mod chart;
mod check;
mod command;
mod compile;
mod failure;
mod fmt;
mod info;
mod info_file;
mod keep;
mod label;
mod live;
mod lsp;
mod merge;
mod names;
mod new;
mod render;
mod said;
mod screen;
mod shade;
mod share;
mod sheet;
mod source_file;
mod speak;
mod subject;
mod threads;
mod tree;
mod verify;
mod viewer;
mod watch;

pub use command::run;
pub use shade::Rounds;
