//! How a session is shown.

use super::tev::Tev;
use crate::render::Screen;

/// How a session is shown.
#[derive(Debug, Default)]
pub struct Showing {
    /// Width and height, which go before what the scene states.
    pub resolution: Option<[u32; 2]>,
    /// How light becomes colors, until the page says otherwise.
    pub screen: Screen,
    /// The port of the page; [`PORT`](super::PORT), or any if that is taken, where there is none.
    pub port: Option<u16>,
    /// A viewer that gets the whole pictures besides.
    pub tev: Option<Tev>,
}
