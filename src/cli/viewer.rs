//! A viewer that sees pictures grow.

use super::failure::Failure;
use super::speak::tell;
use crate::live::Tev;

/// The tev at `address`, if one is named, that will show pictures as `name`.
///
/// # Errors
/// Nothing listens there.
pub fn viewer(address: Option<&str>, name: &str) -> Result<Option<Tev>, Failure> {
    let connected = address.map(|address| Tev::connect(address, name)).transpose();
    connected.map_err(|message| Failure::Usage(format!("error: {message}")))
}

/// Waits until it has the last picture, and says when it has not.
pub fn farewell(tev: Option<Tev>) {
    tev.and_then(Tev::finish).iter().for_each(|trouble| tell(&format!("warning: {trouble}\n")));
}
