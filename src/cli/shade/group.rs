//! The group that a command line describes.

use super::options::{Options, Step, Value};
use crate::cli::failure::Failure;
use crate::cli::speak::say;
use crate::compile::Compiler;
use crate::limits::SCENE_BYTES;
use crate::scene::{
    Connection, GroupSpec, Hints, Layer, ParamType, ParamValue, Place, Places, ShaderFiles, Usage, Values, parse_group,
};
use std::path::PathBuf;
use velour_grammar::files::Access;

/// The group as written, and the compiler that knows its shaders.
pub fn group(options: &Options, compiler: Compiler) -> Result<(GroupSpec, ShaderFiles), Failure> {
    let mut files = ShaderFiles::new(compiler).lenient(true);
    // As OSL names groups without a name: one on the command line counts as begun before that of `--group`.
    let grouped = options.steps.iter().any(|step| matches!(step, Step::Group(_)));
    let default_name = format!("unnamed_group_{}", if grouped { 2 } else { 1 });
    let mut spec = GroupSpec {
        usage: Usage::Surface,
        name: if options.groupname.is_empty() { default_name } else { options.groupname.clone() },
        is_light: false,
        layers: Vec::new(),
        connections: Vec::new(),
        place: place(),
        search: search(options),
    };
    let (mut params, mut layer, mut expressions) = (Vec::new(), None, 0);
    for step in &options.steps {
        let shader = match step {
            Step::Layer(name) => {
                layer = Some(name.clone());
                continue;
            }
            Step::Param(value) => {
                params.push(param(value)?);
                continue;
            }
            Step::Connect([from, output, to, input]) => {
                spec.connections.push(connection(from, output, to, input));
                continue;
            }
            Step::Group(text) => {
                if options.verbose {
                    say(&format!("Processing group specification:\n---\n{text}\n---\n"));
                }
                add_text(text, &mut spec, &files.compiler.options.access)?;
                continue;
            }
            Step::Expr(code) => {
                let name = format!("expr_{expressions}");
                expressions += 1;
                let text = expression(&name, code);
                if options.verbose {
                    say(&format!("Expression-based shader text is:\n---\n{text}---\n"));
                }
                files = files.with_shader(&text).map_err(|error| Failure::Wrong(error.to_string()))?;
                name
            }
            Step::Shader(name) => name.clone(),
        };
        let name = layer.take().unwrap_or_else(|| unnamed(&shader, &spec));
        spec.layers.push(Layer { shader, layer_name: name, params: std::mem::take(&mut params), place: place() });
    }
    if let Some(param) = params.first() {
        let text =
            format!("error: there is no shader after --param {}\n  help: values come before their shader", param.name);
        return Err(Failure::Usage(text));
    }
    if spec.layers.is_empty() {
        let text = "error: there is no shader and no group\n  help: velour shade --help shows how to name one";
        return Err(Failure::Usage(text.to_owned()));
    }
    Ok((spec, files))
}

/// A value for a parameter, taken for what it looks like where no type is given.
pub fn param(value: &Value) -> Result<ParamValue, Failure> {
    let (kind, array) = match &value.ty {
        Some(text) => written_type(text)?,
        None => (guessed(&value.text), None),
    };
    let wrong = || Failure::Usage(format!("error: `{}` is no value of type {kind:?}", value.text));
    let size = kind.components() * array.unwrap_or(1);
    let parts = value.text.split(',').map(str::trim);
    let values = match kind {
        ParamType::String if array.is_none() => Values::Strings(vec![value.text.clone()]),
        ParamType::String => {
            let mut texts: Vec<String> = parts.map(str::to_owned).collect();
            texts.resize(size, String::new());
            Values::Strings(texts)
        }
        ParamType::Int => {
            let numbers: Result<Vec<i32>, _> = parts.map(str::parse).collect();
            let mut numbers = numbers.map_err(|_| wrong())?;
            numbers.resize(size, 0);
            Values::Ints(numbers)
        }
        ParamType::Float
        | ParamType::Color
        | ParamType::Point
        | ParamType::Vector
        | ParamType::Normal
        | ParamType::Matrix => {
            let numbers: Result<Vec<f32>, _> = parts.map(str::parse).collect();
            let mut numbers = numbers.map_err(|_| wrong())?;
            // One number for a color is all of its components.
            let fill = if numbers.len() == 1 && kind != ParamType::Matrix { numbers[0] } else { 0.0 };
            numbers.resize(size, fill);
            Values::Floats(numbers)
        }
    };
    let hints = Hints { interpolated: value.interpolated, interactive: value.interactive };
    Ok(ParamValue { kind, array, name: value.name.clone(), values, hints, place: place() })
}

/// `color`, `float[4]`.
fn written_type(text: &str) -> Result<(ParamType, Option<usize>), Failure> {
    let (name, array) = match text.strip_suffix(']').and_then(|text| text.split_once('[')) {
        Some((name, length)) => (name, length.parse().ok().filter(|n| (1..=1 << 20).contains(n)).map(Some)),
        None => (text, Some(None)),
    };
    match (ParamType::from_name(name), array) {
        (Some(kind), Some(array)) => Ok((kind, array)),
        _ => {
            let names = ParamType::NAMES.join(", ");
            Err(Failure::Usage(format!(
                "error: `{text}` is no type\n  help: the types are {names}, and arrays such as float[3]"
            )))
        }
    }
}

/// Sixteen numbers are a matrix, three a vector, one an int or a float; anything else is text.
fn guessed(text: &str) -> ParamType {
    let numbers = || text.split(',').map(|part| part.trim().parse::<f32>());
    let (count, all) = (numbers().count(), numbers().all(|number| number.is_ok()));
    match count {
        16 if all => ParamType::Matrix,
        3 if all => ParamType::Vector,
        1 if text.parse::<i32>().is_ok() => ParamType::Int,
        1 if all => ParamType::Float,
        _ => ParamType::String,
    }
}

/// The shader around the statements of `--expr`.
fn expression(name: &str, code: &str) -> String {
    format!(
        "shader {name} (\n    float s = u [[ int interpolated=1 ]],\n    float t = v [[ int interpolated=1 ]],\n    \
         output color result = 0,\n    output float alpha = 1,\n  )\n{{\n    {code}\n    ;\n}}\n"
    )
}

fn unnamed(shader: &str, spec: &GroupSpec) -> String {
    // As OSL names layers without a name.
    format!("{shader}_{}", spec.layers.len())
}

fn connection(from: &str, output: &str, to: &str, input: &str) -> Connection {
    Connection {
        source_layer: from.to_owned(),
        source_param: output.to_owned(),
        target_layer: to.to_owned(),
        target_param: input.to_owned(),
        place: place(),
    }
}

/// Adds the layers and connections of a text, or of a file that has it.
fn add_text(text: &str, spec: &mut GroupSpec, access: &Access) -> Result<(), Failure> {
    let file = std::path::Path::new(text);
    // A text of several statements is no name, however it may look.
    let named = !text.contains([';', '\n']) && file.exists();
    let (name, text) = match named {
        true => {
            let unread = |error: String| Failure::Usage(format!("{text}: error: cannot be read: {error}"));
            let bytes = access.read(file, SCENE_BYTES).map_err(|error| unread(error.to_string()))?;
            (text.to_owned(), String::from_utf8(bytes).map_err(|_| unread("it is not UTF-8 text".to_owned()))?)
        }
        false => ("--group".to_owned(), text.to_owned()),
    };
    let places = Places::new(&name.as_str().into(), &text);
    let statements =
        parse_group(&text, &|offset| places.at(offset)).map_err(|error| Failure::Wrong(error.to_string()))?;
    spec.layers.extend(statements.layers);
    spec.connections.extend(statements.connections);
    Ok(())
}

/// Here, then the folders of `--path` and of OSL's own setting for them.
fn search(options: &Options) -> Vec<PathBuf> {
    let mut folders = vec![PathBuf::from(".")];
    folders.extend(options.path.iter().cloned());
    let named = options.settings.iter().filter(|(name, _)| name == "searchpath:shader");
    folders.extend(named.flat_map(|(_, list)| list.split(':').map(PathBuf::from)));
    folders
}

fn place() -> Place {
    Place { file: "command line".into(), line: 1, column: 1 }
}
