//! Rays against geometry: one hierarchy over all primitives, closest hit and any hit.
//!
//! **No self-hits, no leaks.** A hit point is rebuilt from its primitive (corner and edges, vertices and weights, or
//! centre and radius), never as origin + t * direction, so its error is a few roundings of the primitive's largest
//! coordinate M. A new ray starts 2^-20 M off the surface (16 roundings), on the side it goes to, which clears its own
//! neighbourhood; and it skips the very primitive it starts on, which a ray from a flat primitive cannot meet again. A
//! ray that starts on a sphere can meet it on the far side: there the root t = 0 is divided out of the quadratic, so
//! no tolerance is needed. Triangles are tested by the signs of three edge functions; two triangles compute the same
//! number for the edge they share, up to its sign, and no rounding turns a sign around: no ray slips between them.
//!
//! Decision (2026-11-22): the tree of `obvhs` is put together to our own nodes of eight boxes in full precision and blocks
//! of four triangles, and walked by our own kernels, instead of by the stock walk of `obvhs` over its compressed
//! eight-wide nodes, because that answers more rays. One run of `cargo bench --bench rays`, one thread of a quiet 2-core
//! AMD EPYC, woven cloth of 1,051,392 triangles, million rays a second:
//!
//! | rays | closest hit | stock walk | any hit |
//! |---|---|---|---|
//! | camera | 3.27 | 1.54 | 4.24 |
//! | bounce | 2.92 | 1.34 | 3.13 |
//! | random | 2.17 | 0.98 | 2.49 |
//!
//! At 15,552 triangles the closest hits are 5.39, 4.68 and 3.57; a doubling of triangles adds 4 to 65 ns a ray. The
//! price is the build: 3.2 s for the million then, where the stock tree takes 1.0 s. Since 2026-11-29 a mesh of a million
//! triangles is read as OBJ, built and sampled once in 1.7 to 2.1 s on two threads, 2.1 to 2.5 s of processor time, where it
//! took 6.8 s of that.
//!
//! What each part brings, on woven cloth of 1.03 million triangles and a bumpy ball of 1.04 million:
//!
//! - Boxes in search distance 24 of the Morton curve and a tenth of the nodes reinserted, where 14 (with 1 in the first
//!   three rounds) and a twentieth were: a bounce visits 10.8 nodes and 3.3 blocks of the cloth, not 12.5 and 4.4.
//!   Twice as many reinsertions would make it 10.1 and 3.1, and take more than twice the time. Since 2026-11-29 the
//!   distance is 40 in lanes of our own (see `cluster`) and one run of reinsertions is left out: half the time for a build.
//! - Large pages and asking ahead (see `pages` and `prefetch`): random rays in the ball 1.15 to 1.3 million a second
//!   before asking ahead, 1.6 after it; large pages before that, a quarter on random rays in the cloth.
//! - The walk is compiled for AVX2 and for the baseline from the same source. Nothing is contracted and no order depends
//!   on the width, so both give the same bits.
//!
//! **One answer.** The closest hit does not depend on the instruction set or on what else is in a batch of rays; of
//! hits at the same distance the primitive that comes first in the scene is taken.

mod cluster;
mod few;
mod hierarchy;
mod pages;
mod prefetch;
mod ray;
mod shape;
mod tree;
mod walk;

pub use hierarchy::{Accel, Method};
pub use ray::{Hit, Lists, NOTHING, Questions, Ray};
