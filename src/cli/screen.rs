//! The arguments of all commands that write a picture for screens.

use crate::render::{Screen, View};

/// How a PNG shows light.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct ScreenArgs {
    /// Raise the light of a .png by so many stops
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops)]
    exposure: f32,
    /// What a .png makes of light that a screen cannot show: soft (rolls off), srgb (clips), agx or linear
    #[arg(long, default_value = "soft")]
    view: View,
}

impl ScreenArgs {
    /// Is it another one than what nobody asks for?
    pub fn is_given(&self) -> bool {
        self.screen() != Screen::default()
    }

    /// The screen they ask for.
    pub fn screen(&self) -> Screen {
        Screen { exposure: self.exposure, view: self.view }
    }
}

fn stops(text: &str) -> Result<f32, String> {
    let value: f32 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value.abs() <= 64.0 { Ok(value) } else { Err("an exposure is between -64 and 64 stops".to_owned()) }
}
