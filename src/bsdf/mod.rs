//! The bsdf room.
