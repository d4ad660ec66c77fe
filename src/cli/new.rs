//! `velour new`: a first shader, and a scene to put it in.

use super::failure::Failure;
use super::speak::say;
use crate::compile::compile;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The texts, in which the shader is called silk.
const SCENE: &str = include_str!("../../shaders/first/scene.xml");
const SHADER: &str = include_str!("../../shaders/first/silk.osl");

/// Arguments of `velour new`.
#[derive(clap::Args)]
pub struct NewArgs {
    /// The shader's name, or the file's; folders are made when they are not there
    #[arg(default_value = "silk", value_name = "NAME")]
    name: PathBuf,
}

/// Writes the files and says what to do with them; writes none when one is there already.
pub fn run(args: &NewArgs) -> Result<(), Failure> {
    let text = args.name.to_string_lossy();
    let path = Path::new(text.strip_suffix(".osl").unwrap_or(&text));
    let stem = path.file_name().map(|name| name.to_string_lossy().into_owned());
    // What a scene cannot write is no name for what it names.
    let Some(stem) = stem.filter(|stem| !stem.contains(['"', '<', '>', '&', '\\', ';', ','])) else {
        let text = format!("error: `{text}` is no name for a shader\n  help: take one such as `velour new silk`");
        return Err(Failure::Usage(text));
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let name = shader_name(&stem);
    // The scene finds the shader by its file.
    let quoted = if stem == name { stem.clone() } else { format!("\"{stem}\"") };
    let scene = SCENE.replace("shader silk", &format!("shader {quoted}")).replace("`silk`", &format!("`{stem}`"));
    let files = [("osl", SHADER.replace("surface silk", &format!("surface {name}"))), ("xml", scene)];
    let files = files.map(|(extension, text)| (folder.join(format!("{stem}.{extension}")), text));
    if let Some((path, _)) = files.iter().find(|(path, _)| path.symlink_metadata().is_ok()) {
        return Err(there_already(path));
    }
    if folder != Path::new("") {
        std::fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
    }
    files.iter().try_for_each(|(path, text)| write(path, text))?;
    let [shader, scene] = files.map(|(path, _)| path.display().to_string());
    say(&format!(
        "{shader} is a shader to change, {scene} a scene with it; see them with\n  velour render {shader} -o picture.png\n  velour render {scene} -o scene.png\n"
    ));
    Ok(())
}

/// A name that the language takes, like that of the file.
fn shader_name(stem: &str) -> String {
    let known = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = stem.chars().map(known).collect();
    let name = if name.starts_with(|c: char| c.is_ascii_digit()) { format!("_{name}") } else { name };
    // Words of the language are no names.
    let taken = compile(&format!("surface {name}() {{ }}")).is_err();
    if taken { format!("{name}_") } else { name }
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    // A file that has come into being since is left alone too.
    let mut file = OpenOptions::new().write(true).create_new(true).open(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::AlreadyExists => there_already(path),
        _ => unwritable(path, &error),
    })?;
    file.write_all(text.as_bytes()).map_err(|error| unwritable(path, &error))
}

fn there_already(path: &Path) -> Failure {
    Failure::Usage(format!(
        "error: `{}` is there already\n  help: nothing is written over; take another name",
        path.display()
    ))
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Usage(format!("error: cannot write `{}`: {error}", path.display()))
}
