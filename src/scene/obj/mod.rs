//! Reads OBJ meshes and the MTL files that they name: a reader for the text that people have, not only for the text of
//! the book. Never panics; whatever it refuses or leaves out has its line.
//!
//! Source: Wavefront, "Object Files (.obj)", Advanced Visualizer Manual, appendix B1 (1995), and "MTL material format",
//! Ramey, Rose and Tyerman 1995. What is read beyond it: colours after a vertex, comments at the end of a line, Latin-1,
//! a byte order mark, line ends of all systems. Curves, surfaces, points and lines are left out.
//!
//! Decision (2026-11-29): a reader of our own instead of the crate `tobj`, because that one panics on `Kd 1` of an MTL and
//! on an index far below the first, gives errors without lines, drops all material names when one MTL line is odd, and
//! refuses colours on only some of the vertices; and because concave polygons must be known as such before they are cut.

mod flaw;
mod lines;
mod mesh;
mod mtl;
mod notes;
mod number;
mod polygon;
mod read;

pub use flaw::{Attribute, LineFlaw, ObjFlaw};
pub use mesh::{Corner, ObjMesh};
pub use mtl::check_library;
pub use notes::Note;
pub use polygon::triangulate;
pub use read::read;
