//! Budgets for text that nobody vouches for: how much of it is read, expanded, nested and told of.

/// Bytes of one file.
pub const FILE_BYTES: u64 = 64 << 20;

/// Bytes of all files that a shader includes, each as often as it is read.
pub const ALL_BYTES: u64 = 256 << 20;

/// Tokens that files and macros may produce together.
pub const TOKENS: usize = 4_000_000;

/// Tokens that an `#include` counts as, besides those of its file: it has to be looked for in every folder.
pub const INCLUDE_TOKENS: usize = 1000;

/// How deep includes may be nested.
pub const INCLUDE_DEPTH: usize = 64;

/// Messages that are kept of one text; the others are counted.
pub const MESSAGES: usize = 10_000;

/// Messages that are shown of one text; then "and N more".
pub const SHOWN: usize = 100;
