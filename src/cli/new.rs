//! `velour new`: a first scene and shader to change.

use super::failure::Failure;
use super::speak::say;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

/// What is written: names and texts.
const FILES: [(&str, &str); 2] = [
    ("scene.xml", include_str!("../../shaders/first/scene.xml")),
    ("silk.osl", include_str!("../../shaders/first/silk.osl")),
];

/// Arguments of `velour new`.
#[derive(clap::Args)]
pub struct NewArgs {
    /// The folder to write to; made when it is not there
    #[arg(default_value = ".", value_name = "DIR")]
    folder: PathBuf,
}

/// Writes the files and says what to do with them; writes none when one is there already.
pub fn run(args: &NewArgs) -> Result<(), Failure> {
    let within = |name: &str| {
        if args.folder == Path::new(".") { PathBuf::from(name) } else { args.folder.join(name) }
    };
    let taken = FILES.iter().map(|(name, _)| within(name)).find(|path| path.symlink_metadata().is_ok());
    if let Some(path) = taken {
        return Err(there_already(&path));
    }
    std::fs::create_dir_all(&args.folder).map_err(|error| unwritable(&args.folder, &error))?;
    for (name, text) in FILES {
        let path = within(name);
        // A file that has come into being since is left alone too.
        let mut file =
            OpenOptions::new().write(true).create_new(true).open(&path).map_err(|error| match error.kind() {
                std::io::ErrorKind::AlreadyExists => there_already(&path),
                _ => unwritable(&path, &error),
            })?;
        file.write_all(text.as_bytes()).map_err(|error| unwritable(&path, &error))?;
    }
    let [scene, shader] = FILES.map(|(name, _)| within(name).display().to_string());
    say(&format!("{scene} and {shader} are written; see them with\n  velour render {scene} -o picture.png\n"));
    Ok(())
}

fn there_already(path: &Path) -> Failure {
    Failure::Usage(format!(
        "error: `{}` is there already\n  help: nothing is written over; name another folder",
        path.display()
    ))
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Usage(format!("error: cannot write `{}`: {error}", path.display()))
}
