//! The optimize room.
