//! `velour shade`: runs shaders on a grid of points, as OSL's testshade does.
//!
//! Decision (2026-11-29): the options are read by hand instead of by clap, because in testshade's command line the order of
//! shaders and parameters is the group, options carry modifiers after colons (`--param:type=int`), and each may begin with one
//! dash or two, none of which clap knows.
//!
//! Decision (2026-11-30): points are filled a column at a time and only where they differ from batch to batch, a thread keeps its machine from
//! batch to batch, and an output is read only when it is printed or saved, because a grid took 46 ns a point beside its shader and takes 1 ns;
//! instead of new machines and whole points for each batch.

mod grid;
mod group;
mod host;
mod job;
mod options;
mod rounds;
mod run;
mod save;
mod wording;

pub use rounds::Rounds;
pub use run::run;

/// Arguments of `velour shade`; see `--help`.
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub struct ShadeArgs {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    pub words: Vec<String>,
}
