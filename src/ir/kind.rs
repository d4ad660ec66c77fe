//! What a register can hold.

/// What a register holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A float.
    Float,
    /// An int.
    Int,
    /// A symbol.
    String,
    /// A closure.
    Closure,
}
