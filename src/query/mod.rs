//! What editors ask of a shader's text: where a name is declared and used, what may be written here, what a word means.
//!
//! All places are bytes in the text; who speaks to an editor counts as that one does. Nothing here fails on a text that is being
//! written: what the checker could not make out has no answer.
//!
//! Decision (2026-11-30): names are those that the checker notes while it resolves them, so that an editor shows the very function
//! that runs, instead of a second reading of scopes and overloads beside it. What may be written at a place is asked of the tokens as they
//! stand, because there the tree is broken nearly always: a variable is offered from its declaration to the end of the brackets around it.
//!
//! Decision (2026-11-30): a new name is tried: the renamed text is checked, and every name must stand for the same as before, instead of
//! rules about what would collide with what, of which one is forgotten.

mod complete;
mod context;
mod hover;
mod messages;
mod outline;
mod rename;
mod signature;
mod study;

pub use complete::{Item, ItemKind};
pub use messages::{Level, Message};
pub use outline::{Outline, OutlineKind};
pub use rename::RenameError;
pub use signature::{CallHelp, Overload};
pub use study::{Found, Study, Symbol};
