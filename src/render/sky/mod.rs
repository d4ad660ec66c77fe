//! The background: a constant, or a shader with a table that samples directions by its brightness.
//!
//! `square` unrolls the sphere, `brightness` looks at the shader, `table` samples what was seen. Only the density comes from the
//! table; radiance comes from the shader itself at each direction.
//!
//! Decision (2026-11-29): the sphere is unrolled to a square by a map that keeps areas and has no poles, because any cell is then
//! met by a sun of half a degree wherever it stands; instead of azimuth and height, whose rows at the poles are four
//! degrees high in a table of 1024 x 1024.
//!
//! Decision (2026-11-29): the background is looked at in 1024 x 1024 directions whatever the scene says, and eight times finer
//! each way where neighbours differ by more than a ten-thousandth of all light; what differs little is joined again. A
//! quadtree holds the outcome, because a gradient then costs five steps a sample, a sun thirteen, and each is met as
//! sharply as it is; instead of rows and columns, which are as long as the sharpest edge asks.
//!
//! Differs from OSL: testrender lights indirect rays by the table's cells, so its picture depends on their number, and takes
//! that number from the scene. Here the scene's number can only make the table finer, and 0 does without one.

mod brightness;
mod square;
mod table;

pub use brightness::Brightness;
pub use square::direction;
pub use table::SkyTable;

use glam::Vec3;

/// Cells a side in which a background is looked at, at the least. Any disc of half a degree holds the centre of one.
pub const LEAST_SIDE: u32 = 1024;

/// Cells a side, at the most: at edges there are finer ones anyway.
pub const MOST_SIDE: u32 = 4096;

/// What rays see that hit nothing.
#[derive(Clone, Debug)]
pub enum Sky {
    /// One radiance for all directions; zero when there is no background.
    Constant(Vec3),
    /// A shader, and a table when it is to be sampled.
    Shader {
        /// Index of the material.
        material: usize,
        /// The table.
        table: Option<SkyTable>,
    },
}
