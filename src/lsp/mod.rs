//! The language server: an editor's messages in, what [`crate::query`] knows out.
//!
//! ```text
//! bytes ──wire──▶ messages ──server──▶ documents ──▶ query::Study
//!                     ▲                                  │
//!                     └───────────── answers ◀───────────┘
//! ```
//!
//! [`serve`] speaks to one editor until that says `exit`. Every change is checked anew: a whole check takes a millisecond or two, and of
//! changes that arrive together only the last is. Positions are lines and UTF-16 units, as the protocol has them.
//!
//! Decision (2026-11-30): messages are read by a reader of our own, with the types of `lsp-server`, instead of by that crate's, which ends
//! at the first message that is no JSON and takes whatever length a header states. What is broken here is answered, and the next message
//! is read.
//!
//! Decision (2026-11-30): headers that come with velour are written to a folder for such things when somebody goes to what they declare,
//! since an editor opens files and nothing else; instead of an address of our own that only one editor could be taught.

mod answers;
mod documents;
mod look;
mod server;
mod text;
mod uri;
mod wire;

pub use server::{Settings, serve};
pub use text::{Position, Text};
