//! The closure room.
