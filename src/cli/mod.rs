//! The command line: arguments, subcommands, messages to people. All printing and all exit codes are here.

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
