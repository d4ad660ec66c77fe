//! The ir room.
