//! Textures: pictures that shaders look up, as pyramids of levels. This room knows no language.

mod about;
mod ellipse;
mod environment;
#[cfg(feature = "render")]
mod file;
#[cfg(feature = "render")]
mod files;
mod join;
mod lookup;
mod pyramid;
mod sample;
mod texels;
mod udim;
mod wrap;

pub use about::About;
pub use environment::{Up, latitude_longitude};
#[cfg(feature = "render")]
pub use file::{TextureError, read};
#[cfg(feature = "render")]
pub use files::TextureFiles;
pub use lookup::values;
pub use pyramid::Texture;
pub use sample::{Interpolation, Lookup, Sample};
pub use texels::{Level, Texels};
pub use udim::{is_tiled, tile_name};
pub use wrap::Wrap;
