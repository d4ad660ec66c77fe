//! `velour info`: what the language offers, one closure or builtin of it, or what a shader file declares.

use super::compile::CompileArgs;
use super::failure::Failure;
use super::info_file::{shader_json, shader_lines, shader_text};
use super::source_file::compile;
use super::speak::say;
use crate::lang::builtins;
use crate::lang::closures::ClosureTable;
use crate::lang::describe::{closure_head, closure_text, function_text, signature_text};
use crate::lang::nearest::nearest;
use crate::lang::sentences::sentence;
use crate::scene::{find_shader, is_shipped_shader};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use velour_grammar::ast::{FunctionDecl, Item};

/// Arguments of `velour info`.
#[derive(clap::Args)]
pub struct InfoArgs {
    /// A closure, a function or a shader file; nothing for a list of all closures and functions
    subject: Option<String>,
    /// Of a shader, print everything; this is what happens anyway
    #[arg(short)]
    verbose: bool,
    /// Of a shader, one line a parameter: `TYPE NAME DEFAULT`
    #[arg(long)]
    terse: bool,
    /// Of a shader, only this parameter
    #[arg(long, value_name = "NAME")]
    param: Option<String>,
    /// Of a shader, as JSON
    #[arg(long)]
    json: bool,
    /// Folders to look for shaders in
    #[arg(short, long, value_name = "DIRS", value_delimiter = ':')]
    path: Vec<PathBuf>,
    #[command(flatten)]
    compile: CompileArgs,
}

/// Prints what is known of the subject.
pub fn run(args: &InfoArgs) -> Result<(), Failure> {
    let closures = args.compile.compiler()?.closures;
    let table = closures.table();
    let header = header_functions(args)?;
    let Some(subject) = &args.subject else {
        say(&everything(table, &header));
        return Ok(());
    };
    let about_shader = args.verbose || args.terse || args.json || args.param.is_some() || !args.path.is_empty();
    if subject.ends_with(".osl") || Path::new(subject).is_file() {
        return file(args, Path::new(subject));
    }
    // A word of the language goes before a shader of that name, unless it is asked as of a shader.
    let text = one(table, &header, subject);
    let shader = if about_shader || text.is_empty() { shader_file(args, subject)? } else { None };
    match shader {
        Some(path) => file(args, &path),
        None if text.is_empty() => Err(Failure::Usage(unknown(table, &header, subject))),
        None => {
            say(&text);
            Ok(())
        }
    }
}

/// The file of a shader by its name: here, in the folders of `--path`, or in the binary.
fn shader_file(args: &InfoArgs, subject: &str) -> Result<Option<PathBuf>, Failure> {
    let mut folders = vec![PathBuf::from(".")];
    folders.extend(args.path.iter().cloned());
    let found = find_shader(subject, &folders, &args.compile.access()?);
    Ok(found.or_else(|| is_shipped_shader(subject).then(|| PathBuf::from(subject))))
}

fn file(args: &InfoArgs, path: &Path) -> Result<(), Failure> {
    let shader = compile(&args.compile.compiler()?, path)?;
    let mut shader = (*shader.typed).clone();
    if let Some(name) = &args.param {
        shader.params.retain(|param| shader.variables[param.var.0 as usize].name == name.as_str());
        if shader.params.is_empty() {
            return Err(Failure::Wrong(format!("error: shader `{}` has no parameter `{name}`", shader.name)));
        }
        shader.metadata.clear();
    }
    say(&match (args.json, args.terse) {
        (true, _) => shader_json(&shader),
        (_, true) => shader_lines(&shader),
        _ => shader_text(&shader),
    });
    Ok(())
}

/// The functions that the standard header, built in or given, writes in the language itself.
fn header_functions(args: &InfoArgs) -> Result<Vec<FunctionDecl>, Failure> {
    // The header is read before any text; here nothing follows it.
    let parsed = velour_grammar::parse("info", "", &args.compile.compiler()?.options);
    let function = |item| if let Item::Function(function) = item { Some(function) } else { None };
    Ok(parsed.file.items.into_iter().filter_map(function).collect())
}

fn everything(table: &ClosureTable, header: &[FunctionDecl]) -> String {
    let mut out = String::from("closures:\n");
    for spec in &table.specs {
        out += &format!("    {}\n        {}\n", wrapped(&closure_head(spec)), wrapped(spec.doc));
    }
    let names: Vec<&str> = function_names(header).into_iter().collect();
    out += &format!("\nfunctions:\n{}", columns(&names));
    out
}

/// The names of all functions, in order.
fn function_names(header: &[FunctionDecl]) -> BTreeSet<&str> {
    let mut names: BTreeSet<&str> = header.iter().map(|f| f.name.name.as_str()).collect();
    for name in builtins::names() {
        names.insert(name);
    }
    names
}

/// A text broken at spaces into lines of about a hundred characters, the later ones indented.
fn wrapped(text: &str) -> String {
    let (mut out, mut width) = (String::new(), 0);
    for word in text.split(' ') {
        if width + word.len() > 100 {
            out += "\n           ";
            width = 0;
        }
        out += if out.is_empty() { "" } else { " " };
        out += word;
        width += word.len() + 1;
    }
    out
}

/// Names in lines of at most a hundred characters.
fn columns(names: &[&str]) -> String {
    let (mut out, mut width) = (String::new(), 0);
    for name in names {
        if width + name.len() + 1 > 96 {
            out.push('\n');
            width = 0;
        }
        out += if width == 0 { "    " } else { " " };
        out += name;
        width += name.len() + 1;
    }
    out + "\n"
}

fn one(table: &ClosureTable, header: &[FunctionDecl], name: &str) -> String {
    let mut out = String::new();
    for (_, spec) in table.named(name) {
        out += &closure_text(spec);
    }
    for signature in builtins::signatures(name).unwrap_or_default() {
        out += &format!("{}\n", signature_text(name, signature));
    }
    for function in header.iter().filter(|f| f.name.name == name) {
        out += &format!("{}\n", function_text(function));
    }
    if let Some(sentence) = sentence(name) {
        out += &format!("    {sentence}\n");
    }
    out
}

fn unknown(table: &ClosureTable, header: &[FunctionDecl], name: &str) -> String {
    let mut names = function_names(header);
    for spec in &table.specs {
        names.insert(spec.name);
    }
    let names: Vec<&str> = names.into_iter().collect();
    let help = match nearest(name, &names) {
        Some(near) => format!("did you mean `{near}`?"),
        None => "`velour info` lists all closures and functions".to_owned(),
    };
    format!("error: `{name}` is no closure, function or shader file\n  help: {help}")
}
