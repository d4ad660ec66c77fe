//! `velour lsp`, as an editor talks to it.

mod client;
mod colors;
mod edits;
mod life;
mod names;
mod writing;
