//! The renderer against answers known exactly, against itself, and against bad input.

mod adaptive;
mod asking;
mod clear;
mod cloth;
mod determinism;
mod displace;
mod emitters;
mod exact;
mod files;
mod filters;
mod furnace;
mod glass;
mod lights;
mod materials;
mod normals;
mod parts;
mod rays;
mod rounds;
mod shaders;
mod sky;
mod speed;
mod terminator;
