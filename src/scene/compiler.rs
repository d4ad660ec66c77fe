//! The compiler of a scene's shader groups: finds shaders (in memory, in files, then among those that velour brings
//! along), compiles each once, binds and joins them.

use super::error::{SceneError, SceneProblem};
use super::group::{GroupCompiler, GroupSpec, Layer, ParamType, ParamValue, Usage, Values};
use super::overrides::{Overrides, overlap};
use super::shipped::{BINARY, shipped};
use super::source::within;
use crate::compile::{CompileError, Compiler, GroupBuilder, GroupError, GroupSubject, Recipe, Shader};
use crate::exec::Group;
use crate::ir::lower::{Binding, Lazy};
use crate::lang::nearest::nearest;
use crate::lang::types::{Base, Length, Type};
use crate::limits::SHADER_BYTES;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use velour_grammar::files::Access;

/// Compiles groups from `.osl` files, from shaders in memory and from those in the binary.
#[derive(Debug, Default)]
pub struct ShaderFiles {
    /// Include folders, macros, header and closures for all shaders.
    pub compiler: Compiler,
    lenient: bool,
    overrides: Overrides,
    warnings: Mutex<Vec<String>>,
    memory: HashMap<String, Shader>,
    files: Mutex<HashMap<PathBuf, Shader>>,
    /// The shaders that the files of each folder declare, by name, once a folder was searched.
    declared: Mutex<HashMap<PathBuf, Declared>>,
}

/// Names of shaders and the file of each.
type Declared = Arc<HashMap<String, PathBuf>>;

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

    /// Gives parameters values that go before what scenes say, and before connections. A path is `NAME`, for all layers that have the
    /// parameter, `LAYER.NAME`, `GROUP.NAME` or `GROUP.LAYER.NAME`; texts are as [`GroupBuilder::text`] takes them. They take the place of those
    /// that were given before; what was compiled stays compiled.
    pub fn set_params(&mut self, values: Vec<(String, String)>) {
        self.overrides = Overrides::new(values);
    }

    /// The paths of [`ShaderFiles::set_params`] that no group compiled since has, each with the path that may be meant.
    pub fn unused_params(&self) -> Vec<(&str, Option<String>)> {
        self.overrides.unused()
    }

    /// Do values of [`ShaderFiles::set_params`] go to this group?
    pub fn sets(&self, spec: &GroupSpec) -> bool {
        spec.layers.iter().any(|layer| {
            let shader = self.shader(layer, &spec.search);
            shader.is_ok_and(|shader| !self.overrides.of(&spec.name, &layer.layer_name, &shader).is_empty())
        })
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
        let names: Vec<&str> = shader.params().collect();
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
        let name = &layer.shader;
        match self.named(name, search) {
            Some(Ok(shader)) => Ok(shader),
            Some(Err(error)) => {
                let problem = SceneProblem::Shader { shader: name.clone(), error: Arc::new(error) };
                Err(SceneError::at(layer.place.clone(), problem))
            }
            None => {
                let problem = SceneProblem::ShaderNotFound { shader: name.clone() };
                Err(SceneError::at(layer.place.clone(), problem).with_help(self.help_to_find(name, search)))
            }
        }
    }

    /// The shader of a name: in memory, in a file, or in the binary, or there alone for `velour:NAME`; `None` when there is none.
    pub(super) fn named(&self, name: &str, search: &[PathBuf]) -> Option<Result<Shader, CompileError>> {
        let of_binary = |name| {
            shipped(name).map(|(file, text)| {
                self.once(Path::new(&format!("{BINARY}{file}")), || self.compiler.compile(file, text))
            })
        };
        if let Some(name) = name.strip_prefix(BINARY) {
            return of_binary(name);
        }
        if let Some(shader) = self.memory.get(name) {
            return Some(Ok(shader.clone()));
        }
        if let Some(path) = self.find(name, search) {
            return Some(self.once(&path, || self.compiler.compile_file(&path)));
        }
        of_binary(name)
    }

    /// What helps when a shader is not found.
    pub(super) fn help_to_find(&self, name: &str, search: &[PathBuf]) -> String {
        let bare = name.strip_suffix(".osl").unwrap_or(name);
        let folders: Vec<String> = search.iter().map(|folder| folder.display().to_string()).collect();
        let code = search.iter().map(|folder| within(folder, &format!("{bare}.oso")));
        match code.into_iter().find(|path| self.compiler.options.access.is_file(path)) {
            Some(code) => format!("{} is code for OSL's tools; velour needs the text, `{bare}.osl`", code.display()),
            None => format!("no `{bare}.osl` in {}; add folders with --path", folders.join(", ")),
        }
    }

    /// The file of a shader, see [`find_shader`]; a folder is searched for what its files declare once.
    fn find(&self, name: &str, search: &[PathBuf]) -> Option<PathBuf> {
        let access = &self.compiler.options.access;
        find_named(name, search, access).or_else(|| {
            let mut folders = self.declared.lock().unwrap_or_else(PoisonError::into_inner);
            let name = name.strip_suffix(".oso").unwrap_or(name);
            search.iter().find_map(|folder| {
                let declared = folders.entry(folder.clone()).or_insert_with(|| Arc::new(declared_in(folder, access)));
                declared.get(name).cloned()
            })
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
pub fn find_shader(name: &str, search: &[PathBuf], access: &Access) -> Option<PathBuf> {
    let bare = name.strip_suffix(".oso").unwrap_or(name);
    let declared = || search.iter().find_map(|folder| declared_in(folder, access).remove(bare));
    find_named(name, search, access).or_else(declared)
}

fn find_named(name: &str, search: &[PathBuf], access: &Access) -> Option<PathBuf> {
    let name = name.strip_suffix(".oso").unwrap_or(name);
    let text = name.ends_with(".osl");
    let with_extension = if text { name.to_owned() } else { format!("{name}.osl") };
    let made = (!text).then(|| format!("{name}.oso"));
    // Who has compiled a shader has said how: with these macros.
    let recipe = |path: &PathBuf| Recipe::of_file(path, access).is_some();
    let pair = |of: &dyn Fn(&str) -> PathBuf| {
        let made = made.as_deref().map(of).filter(recipe);
        made.or_else(|| Some(of(&with_extension)).filter(|path| access.is_file(path)))
    };
    search.iter().find_map(|folder| pair(&|name| within(folder, name))).or_else(|| pair(&|name| PathBuf::from(name)))
}

/// The shaders that the files of a folder declare; of several of one name the first, in the order of the files' names.
fn declared_in(folder: &Path, access: &Access) -> HashMap<String, PathBuf> {
    let mut all = HashMap::new();
    let (mut files, mut bytes) = (access.list(folder), 0);
    files.retain(|path| path.extension().is_some_and(|e| e == "osl"));
    for path in files {
        let Ok(text) = access.read(&path, SHADER_BYTES) else { continue };
        bytes += text.len() as u64;
        if bytes > velour_grammar::limits::ALL_BYTES {
            break;
        }
        for name in declared(&String::from_utf8_lossy(&text)) {
            all.entry(name.to_owned()).or_insert_with(|| path.clone());
        }
    }
    all
}

/// The names that follow `shader`, or another kind of shader, in a text.
fn declared(text: &str) -> impl Iterator<Item = &str> {
    let mut kind = false;
    let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|word| !word.is_empty());
    words.filter(move |word| {
        let after = std::mem::replace(&mut kind, ["shader", "surface", "displacement", "volume"].contains(word));
        after && !kind
    })
}

impl GroupCompiler for ShaderFiles {
    fn access(&self) -> Access {
        self.compiler.options.access.clone()
    }

    fn take_warnings(&self) -> Vec<String> {
        std::mem::take(&mut self.warnings.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn compile(&self, spec: &GroupSpec) -> Result<Group, SceneError> {
        let builder = self.builder(spec)?;
        match spec.usage {
            // What a layer of a displacement puts out is `P`, so all that move it run, each from where the one before has left it.
            Usage::Displacement => {
                let lazy = Lazy { globals: false, ..Lazy::default() };
                self.finish(builder.keep_position().lazy(lazy), spec)
            }
            Usage::Surface | Usage::Volume | Usage::Shader => self.finish(builder, spec),
        }
    }
}

impl ShaderFiles {
    /// The group as a builder, for a host that has more to say of it; [`ShaderFiles::finish`] makes the group.
    ///
    /// # Errors
    /// A shader that is not found or wrong.
    pub fn builder(&self, spec: &GroupSpec) -> Result<GroupBuilder, SceneError> {
        let mut builder = GroupBuilder::new(self.compiler.closures.clone());
        let mut given = Vec::new();
        for layer in &spec.layers {
            let shader = self.shader(layer, &spec.search)?;
            builder = builder.layer(&layer.layer_name, &shader);
            for param in &layer.params {
                if self.lenient && !shader.has(&param.name) {
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
            for (path, text) in self.overrides.of(&spec.name, &layer.layer_name, &shader) {
                builder = builder.text(path, text);
                given.push((layer.layer_name.as_str(), path));
            }
        }
        for c in &spec.connections {
            let taken = |(layer, path): &(&str, &str)| *layer == c.target_layer && overlap(path, &c.target_param);
            if !given.iter().any(taken) {
                builder = builder.connect((&c.source_layer, &c.source_param), (&c.target_layer, &c.target_param));
            }
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
        builder.build().map_err(|error| match &error.subject {
            // It is not the scene that says so.
            GroupSubject::Param { layer, name } if self.overrides.gives(&spec.name, layer, name) => {
                let help = error.help.clone();
                SceneError::nowhere(SceneProblem::Value(error)).with_help(help)
            }
            _ => placed(error, spec),
        })
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
