//! The compiler of a scene's shader groups: finds shaders (in memory, in files, then among those that velour brings
//! along), compiles each once, binds and joins them.

use super::error::{SceneError, SceneProblem};
use super::group::{GroupCompiler, GroupSpec, Layer, ParamType, ParamValue, Usage, Values};
use super::nearest::nearest;
use super::shipped::shipped;
use super::source::within;
use crate::compile::{CompileError, Compiler, GroupBuilder, GroupError, GroupSubject, Recipe, Shader};
use crate::exec::Group;
use crate::ir::lower::Binding;
use crate::lang::path::root;
use crate::lang::types::{Base, Length, Type};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Compiles groups from `.osl` files, from shaders in memory and from those in the binary.
#[derive(Debug, Default)]
pub struct ShaderFiles {
    /// Include folders, macros, header and closures for all shaders.
    pub compiler: Compiler,
    lenient: bool,
    warnings: Mutex<Vec<String>>,
    memory: HashMap<String, Shader>,
    files: Mutex<HashMap<PathBuf, Shader>>,
}

impl ShaderFiles {
    /// Uses a compiler that has been set up by the host.
    pub fn new(compiler: Compiler) -> Self {
        ShaderFiles { compiler, ..Self::default() }
    }

    /// True takes a value for a parameter that the shader does not have as a warning, as OSL does; false, the default, as
    /// an error.
    pub fn lenient(mut self, lenient: bool) -> Self {
        self.lenient = lenient;
        self
    }

    /// Adds a shader that is not in a file; it is found before any file of its name.
    ///
    /// # Errors
    /// The text is wrong.
    pub fn with_shader(mut self, text: &str) -> Result<Self, CompileError> {
        let shader = self.compiler.compile("memory", text)?;
        self.memory.insert(shader.name().to_owned(), shader);
        Ok(self)
    }

    /// Warns of a value for a parameter that is not there.
    fn warn(&self, shader: &Shader, param: &ParamValue) {
        let variables = &shader.typed.variables;
        let names = shader.typed.params.iter().map(|param| variables[param.var.0 as usize].name.as_str());
        let names: Vec<&str> = names.collect();
        let hint = match nearest(&param.name, &names) {
            Some(near) => format!("; did you mean `{near}`?"),
            None => String::new(),
        };
        let (place, shader, name) = (&param.place, shader.name(), &param.name);
        let text =
            format!("{place}: warning: shader `{shader}` has no parameter `{name}`; its value is left out{hint}");
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).push(text);
    }

    fn shader(&self, layer: &Layer, search: &[PathBuf]) -> Result<Shader, SceneError> {
        if let Some(shader) = self.memory.get(&layer.shader) {
            return Ok(shader.clone());
        }
        let compiled = if let Some(path) = find_shader(&layer.shader, search) {
            self.once(&path, || self.compiler.compile_file(&path))
        } else if let Some((file, text)) = shipped(&layer.shader) {
            self.once(Path::new(file), || self.compiler.compile(file, text))
        } else {
            let folders: Vec<String> = search.iter().map(|folder| folder.display().to_string()).collect();
            let problem = SceneProblem::ShaderNotFound { shader: layer.shader.clone() };
            let code = search.iter().map(|folder| within(folder, &format!("{}.oso", layer.shader)));
            let help = match code.into_iter().find(|path| path.is_file()) {
                Some(code) => {
                    format!("{} is code for OSL's tools; velour needs the text, `{}.osl`", code.display(), layer.shader)
                }
                None => format!("no `{}.osl` in {}; add folders with --path", layer.shader, folders.join(", ")),
            };
            return Err(SceneError::at(layer.place.clone(), problem).with_help(help));
        };
        compiled.map_err(|error| {
            let problem = SceneProblem::Shader { shader: layer.shader.clone(), error: Arc::new(error) };
            SceneError::at(layer.place.clone(), problem)
        })
    }

    /// The shader of a file, compiled when it is asked for first.
    fn once(
        &self,
        path: &Path,
        compile: impl FnOnce() -> Result<Shader, CompileError>,
    ) -> Result<Shader, CompileError> {
        let mut files = self.files.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(shader) = files.get(path) {
            return Ok(shader.clone());
        }
        let shader = compile()?;
        files.insert(path.to_owned(), shader.clone());
        Ok(shader)
    }
}

/// The file of a shader: in one of the folders `name.oso`, where velour has written it, `name.osl` or `name`, or `name` as a path; else a
/// file of one of the folders that declares a shader of this name, the first by its own.
pub fn find_shader(name: &str, search: &[PathBuf]) -> Option<PathBuf> {
    let name = name.strip_suffix(".oso").unwrap_or(name);
    let with_extension = if name.ends_with(".osl") { name.to_owned() } else { format!("{name}.osl") };
    let made = if name.ends_with(".osl") { String::new() } else { format!("{name}.oso") };
    // Who has compiled a shader has said how: with these macros.
    let there = |path: &PathBuf| {
        Recipe::of_file(path).is_some() || path.extension().is_none_or(|e| e != "oso") && path.is_file()
    };
    let candidates = search.iter().flat_map(|folder| [within(folder, &made), within(folder, &with_extension)]);
    let named = candidates.chain([PathBuf::from(&made), PathBuf::from(&with_extension)]).find(there);
    named.or_else(|| search.iter().find_map(|folder| declares_in(folder, name)))
}

/// The first file of a folder, in the order of names, whose text declares the shader.
fn declares_in(folder: &Path, name: &str) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.filter_map(Result::ok).map(|entry| entry.path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == "osl")).collect();
    files.sort();
    files
        .into_iter()
        .find(|path| std::fs::read(path).is_ok_and(|bytes| declares(&String::from_utf8_lossy(&bytes), name)))
}

/// Does a text say `shader NAME`, or another kind of shader, in words that follow each other?
fn declares(text: &str, name: &str) -> bool {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let kinds = ["shader", "surface", "displacement", "volume"];
    text.match_indices(name).any(|(at, _)| {
        let (before, after) = (&text[..at], &text[at + name.len()..]);
        let kind = before.trim_end().rsplit(|c| !word(c)).next().unwrap_or_default();
        let apart = before.ends_with(char::is_whitespace) && !after.starts_with(word);
        apart && kinds.contains(&kind)
    })
}

/// True when a shader has the parameter that a path leads into.
fn has(shader: &Shader, path: &str) -> bool {
    let variables = &shader.typed.variables;
    shader.typed.params.iter().any(|param| variables[param.var.0 as usize].name == root(path))
}

impl GroupCompiler for ShaderFiles {
    fn take_warnings(&self) -> Vec<String> {
        std::mem::take(&mut self.warnings.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn compile(&self, spec: &GroupSpec) -> Result<Group, SceneError> {
        let builder = self.builder(spec)?;
        self.finish(if spec.usage == Usage::Displacement { builder.keep_position() } else { builder }, spec)
    }
}

impl ShaderFiles {
    /// The group as a builder, for a host that has more to say of it; [`ShaderFiles::finish`] makes the group.
    ///
    /// # Errors
    /// A shader that is not found or wrong.
    pub fn builder(&self, spec: &GroupSpec) -> Result<GroupBuilder, SceneError> {
        let mut builder = GroupBuilder::new(self.compiler.closures.clone());
        for layer in &spec.layers {
            let shader = self.shader(layer, &spec.search)?;
            builder = builder.layer(&layer.layer_name, &shader);
            for param in &layer.params {
                if self.lenient && !has(&shader, &param.name) {
                    self.warn(&shader, param);
                    continue;
                }
                let binding = match &param.values {
                    Values::Floats(values) => Binding::Numbers(values.iter().map(|&x| f64::from(x)).collect()),
                    Values::Ints(values) => Binding::Numbers(values.iter().map(|&x| f64::from(x)).collect()),
                    Values::Strings(values) => Binding::Strings(values.clone()),
                };
                builder = builder.bind_as(&param.name, binding, &written(param));
                if let Some(interpolated) = param.hints.interpolated {
                    builder = builder.interpolate(&param.name, interpolated);
                }
            }
        }
        for c in &spec.connections {
            builder = builder.connect((&c.source_layer, &c.source_param), (&c.target_layer, &c.target_param));
        }
        Ok(builder)
    }

    /// The shader of a layer of a group, for a host that wants to know what it declares.
    ///
    /// # Errors
    /// It is not found, or wrong.
    pub fn shader_of(&self, spec: &GroupSpec, layer: &Layer) -> Result<Shader, SceneError> {
        self.shader(layer, &spec.search)
    }

    /// The group of a builder.
    ///
    /// # Errors
    /// A parameter or a connection that does not fit, at its place in the text.
    pub fn finish(&self, builder: GroupBuilder, spec: &GroupSpec) -> Result<Group, SceneError> {
        builder.build().map_err(|error| placed(error, spec))
    }
}

/// The type that a value was written with.
fn written(param: &ParamValue) -> Type {
    let base = match param.kind {
        ParamType::Int => Base::Int,
        ParamType::Float => Base::Float,
        ParamType::Color => Base::Color,
        ParamType::Point => Base::Point,
        ParamType::Vector => Base::Vector,
        ParamType::Normal => Base::Normal,
        ParamType::Matrix => Base::Matrix,
        ParamType::String => Base::String,
    };
    Type::of(base).array(param.array.map_or(Length::Single, |count| Length::Fixed(count as u32)))
}

/// A group's error at the place in the scene that it is about.
fn placed(error: GroupError, spec: &GroupSpec) -> SceneError {
    let layer = |name: &str| spec.layers.iter().find(|layer| layer.layer_name == name);
    let place = match &error.subject {
        GroupSubject::Param { layer: at, name } => {
            let param = layer(at).and_then(|layer| layer.params.iter().find(|param| param.name == *name));
            let joined = spec.connections.iter().find(|c| {
                (c.target_layer == *at && c.target_param == *name) || (c.source_layer == *at && c.source_param == *name)
            });
            param.map(|param| &param.place).or(joined.map(|c| &c.place))
        }
        GroupSubject::Layer(name) => {
            let joined = spec.connections.iter().find(|c| c.target_layer == *name || c.source_layer == *name);
            joined.map(|c| &c.place).or(layer(name).map(|layer| &layer.place))
        }
    };
    let (place, help) = (place.unwrap_or(&spec.place).clone(), error.help.clone());
    SceneError::at(place, SceneProblem::Group(error)).with_help(help)
}
