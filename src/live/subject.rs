//! What is being looked at: a scene, or a shader on a built-in one; how it is loaded, and compiled anew when a text or a value changes.

use super::inbox::Knob;
use super::paths::key;
use super::source::Source;
use super::values::Given;
use crate::check::constants;
use crate::compile::Shader;
use crate::exec::Group;
use crate::lang::types::Type;
use crate::scene::{
    GroupCompiler, GroupSpec, Layer, PREVIEW_LAYER, Scene, SceneError, SceneProblem, SceneSource, ShaderFiles, Usage,
};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use velour_grammar::Format;
use velour_grammar::files::{Access, Noted};

/// Values that the page has given.
pub type Overrides = BTreeMap<Knob, Given>;

/// A group of the scene.
#[derive(Debug)]
pub struct Part {
    /// As the scene has it.
    pub spec: GroupSpec,
    /// The index of its material.
    pub material: usize,
    /// The shader of each layer.
    pub shaders: Vec<Shader>,
    /// The files of their texts.
    files: BTreeSet<PathBuf>,
}

/// A subject that is loaded.
#[derive(Debug)]
pub struct Subject {
    /// The scene, with the groups as they were compiled last.
    pub scene: Scene,
    /// Its groups, in the order of its text.
    pub parts: Vec<Part>,
    /// The number of the group that the user is likely to care about.
    pub first: usize,
    /// The text of the built-in scene, if it is that one.
    preview: Option<String>,
    /// What compilers remark on a shader's own text.
    pub remarks: String,
    noted: Noted,
}

/// A group that was compiled anew.
#[derive(Debug)]
pub struct Renewed {
    part: usize,
    shaders: Vec<Shader>,
    group: Group,
}

impl Source {
    fn scene_source(&self, files: &ShaderFiles) -> Result<SceneSource, SceneError> {
        match self.is_shader() {
            true => SceneSource::of_shader(self.path(), &self.search, files),
            false => SceneSource::read(&self.argument, &files.access()),
        }
    }

    /// A compiler that knows no file yet.
    ///
    /// Decision (2026-11-30): a fresh one for every change, instead of one that forgets what has changed: compiling a shader takes 1 to
    /// 2 ms, and what is stale (texts by path, names that folders declare) is then nobody's to find out.
    fn files(&self, noted: &Noted) -> ShaderFiles {
        let mut compiler = self.compiler.clone();
        compiler.options.access = compiler.options.access.noting(noted);
        ShaderFiles::new(compiler).lenient(!self.strict)
    }

    /// What there is to say about the text of a bare shader although it compiles.
    fn remarks(&self) -> String {
        let bytes = self
            .is_shader()
            .then(|| self.compiler.options.access.read(self.path(), crate::limits::SHADER_BYTES).unwrap_or_default());
        bytes.map_or_else(String::new, |bytes| {
            let checked = self.compiler.check_bytes(&self.argument, &bytes);
            checked.sources.render(&checked.diagnostics, Format::Full, false).trim_end().to_owned()
        })
    }

    /// Loads everything. Values that no longer fit are taken out of `overrides`, also those of parameters that `before` gave another
    /// value in its text.
    ///
    /// # Errors
    /// What is wrong, for people to read, and which files it may depend on.
    pub(super) fn load(&self, before: Option<&Subject>, overrides: &mut Overrides) -> Result<Subject, (String, Noted)> {
        let noted = Noted::default();
        match self.try_load(before, overrides, &noted) {
            Ok(subject) => Ok(subject),
            Err(error) => Err((told(&error), noted)),
        }
    }

    fn try_load(
        &self,
        before: Option<&Subject>,
        overrides: &mut Overrides,
        noted: &Noted,
    ) -> Result<Subject, SceneError> {
        let files = self.files(noted);
        let source = self.scene_source(&files)?;
        let old = before.map_or(&[][..], |before| &before.parts);
        let recorder = Recorder { files: &files, old, overrides: Mutex::new(overrides), groups: Mutex::default() };
        let scene = Scene::from_source(&source, &self.search, &recorder)?;
        let groups = recorder.groups.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut parts = Vec::new();
        for (spec, shaders) in groups {
            let same = scene.materials.iter().position(|material| material.place == spec.place);
            // A second group of a name belongs to the material of the first.
            let named = || scene.materials.iter().position(|material| material.name == spec.name);
            let material = same.or_else(named).unwrap_or(0);
            parts.push(Part { files: files_of(&shaders), spec, material, shaders });
        }
        overrides.retain(|knob, _| knob.group < parts.len());
        let own = self.is_shader().then(|| parts.iter().position(|part| part.own_layer().is_some())).flatten();
        let first = own.or_else(|| parts.iter().position(is_interesting)).unwrap_or(0);
        let preview = self.is_shader().then_some(source.text);
        Ok(Subject { scene, parts, first, preview, remarks: self.remarks(), noted: noted.clone() })
    }
}

impl Part {
    /// The layer of the shader that the built-in scene shows, if it is of that scene.
    fn own_layer(&self) -> Option<usize> {
        self.spec.layers.iter().position(|layer| layer.layer_name == PREVIEW_LAYER)
    }
}

/// Is it the surface of something, and neither sky nor lamp nor floor?
fn is_interesting(part: &Part) -> bool {
    let usual = ["sky", "emitter", "matte", "envmap"];
    !part.spec.is_light && part.shaders.last().is_some_and(|shader| !usual.contains(&shader.name()))
}

impl Subject {
    /// The paths that were looked for or read.
    pub fn paths(&self) -> BTreeSet<PathBuf> {
        self.noted.paths()
    }

    /// How many there are.
    pub fn path_count(&self) -> usize {
        self.noted.len()
    }

    /// The groups whose texts are in one of these files, by their keys; nothing when something else has changed, so that all is to be
    /// loaded anew.
    pub fn affected(&self, changed: &BTreeSet<PathBuf>) -> Option<BTreeSet<usize>> {
        let is_text = |path: &PathBuf| self.parts.iter().any(|part| part.files.contains(path));
        if !changed.iter().all(is_text) {
            return None;
        }
        let touched = |part: &Part| part.files.iter().any(|file| changed.contains(file));
        let groups = (0..self.parts.len()).filter(|&k| touched(&self.parts[k]));
        groups.map(|k| (self.parts[k].spec.usage != Usage::Displacement).then_some(k)).collect()
    }

    /// The layer of a group that is the shader which the built-in scene shows, if it is that scene.
    pub fn own_layer(&self, group: usize) -> Option<usize> {
        self.preview.as_ref().and_then(|_| self.parts.get(group)?.own_layer())
    }

    /// All parameters that a page means by one: a shader alone is shown on more than one thing.
    pub fn alike(&self, knob: &Knob) -> Vec<Knob> {
        if self.own_layer(knob.group) != Some(knob.layer) {
            return vec![knob.clone()];
        }
        let groups = (0..self.parts.len()).filter_map(|group| Some((group, self.own_layer(group)?)));
        groups.map(|(group, layer)| Knob { group, layer, name: knob.name.clone() }).collect()
    }

    /// The group whose controls stand for those of this one as well.
    pub fn stands_for(&self, group: usize) -> usize {
        if self.own_layer(group).is_some() { self.first } else { group }
    }

    /// Is there such a parameter, and does it take such a value?
    pub fn fits(&self, knob: &Knob, given: &Given) -> bool {
        let part = self.parts.get(knob.group);
        let pair = part.and_then(|part| Some((part.spec.layers.get(knob.layer)?, part.shaders.get(knob.layer)?)));
        pair.is_some_and(|(layer, shader)| {
            type_of(shader, &knob.name).and_then(|ty| given.param(&knob.name, ty, layer)).is_some()
        })
    }

    /// Does a change of the group move surfaces?
    pub fn moves(&self, group: usize) -> bool {
        self.parts.get(group).is_some_and(|part| part.spec.usage == Usage::Displacement)
    }

    /// Compiles these groups anew, with the values of `overrides`, from which those go that no longer fit. Nothing when the built-in scene
    /// shows the shader in another way now, so that all is to be loaded anew.
    ///
    /// # Errors
    /// What is wrong, for people to read.
    pub fn compile(
        &self,
        source: &Source,
        groups: &BTreeSet<usize>,
        overrides: &mut Overrides,
    ) -> Result<Option<Vec<Renewed>>, String> {
        let files = source.files(&self.noted);
        if self.preview.is_some() {
            let now = source.scene_source(&files).map_err(|error| told(&error))?;
            if self.preview.as_ref() != Some(&now.text) {
                return Ok(None);
            }
        }
        let mut all = Vec::new();
        for &k in groups {
            let Some(part) = self.parts.get(k) else { continue };
            let (group, shaders) =
                compiled(&files, k, &part.spec, Some(part), overrides).map_err(|error| told(&error))?;
            all.push(Renewed { part: k, shaders, group });
        }
        Ok(Some(all))
    }

    /// Takes groups that were compiled; gives the materials that have changed with their groups.
    pub fn take(&mut self, source: &Source, renewed: Vec<Renewed>) -> Vec<(usize, Group)> {
        let mut out = Vec::new();
        for Renewed { part, shaders, group } in renewed {
            let part = &mut self.parts[part];
            part.files = files_of(&shaders);
            part.shaders = shaders;
            self.scene.materials[part.material].surface = group.clone();
            out.push((part.material, group));
        }
        self.remarks = source.remarks();
        out
    }

    /// The group that shades a material.
    pub fn group_of(&self, material: usize) -> Option<usize> {
        self.parts.iter().rposition(|part| part.material == material && part.spec.usage != Usage::Displacement)
    }
}

/// The value that a parameter has before the page gives it one: the scene's, or else its shader's default where that is a constant.
pub fn base(layer: &Layer, shader: &Shader, name: &str) -> Option<Given> {
    if let Some(param) = layer.params.iter().rev().find(|param| param.name == name) {
        return Given::of_values(&param.values);
    }
    let (param, _) = shader.typed.param(name)?;
    Given::of_constants(&constants(param.default.as_ref()?)?)
}

/// The type of a shader's parameter.
fn type_of<'s>(shader: &'s Shader, name: &str) -> Option<&'s Type> {
    shader.typed.param(name).map(|(_, variable)| &variable.ty)
}

/// The files of shaders' texts, by their keys.
fn files_of(shaders: &[Shader]) -> BTreeSet<PathBuf> {
    shaders.iter().flat_map(|shader| shader.sources.files()).map(|name| key(Path::new(name))).collect()
}

/// What is wrong: a shader's own messages, which have their places, or the scene's.
fn told(error: &SceneError) -> String {
    match &*error.problem {
        SceneProblem::Shader { error, .. } => error.to_string(),
        _ => error.to_string(),
    }
}

/// A group with the values of the page, and its shaders.
fn compiled(
    files: &ShaderFiles,
    number: usize,
    spec: &GroupSpec,
    before: Option<&Part>,
    overrides: &mut Overrides,
) -> Result<(Group, Vec<Shader>), SceneError> {
    let shaders: Vec<Shader> =
        spec.layers.iter().map(|layer| files.shader_of(spec, layer)).collect::<Result<_, _>>()?;
    let mut spec = spec.clone();
    overrides.retain(|knob, given| {
        if knob.group != number {
            return true;
        }
        let Some((layer, shader)) = spec.layers.get_mut(knob.layer).zip(shaders.get(knob.layer)) else { return false };
        // Who changes the text of a value wants to see that one.
        let was = before.and_then(|part| Some((part.spec.layers.get(knob.layer)?, part.shaders.get(knob.layer)?)));
        let now = base(layer, shader, &knob.name);
        if was.is_some_and(|(layer, shader)| base(layer, shader, &knob.name) != now) {
            return false;
        }
        let param = type_of(shader, &knob.name).and_then(|ty| given.param(&knob.name, ty, layer));
        let Some(param) = param else { return false };
        layer.params.retain(|other| other.name != param.name);
        layer.params.push(param);
        true
    });
    Ok((files.compile(&spec)?, shaders))
}

/// The compiler of a scene that is being loaded, which keeps what it compiles.
struct Recorder<'a> {
    files: &'a ShaderFiles,
    old: &'a [Part],
    overrides: Mutex<&'a mut Overrides>,
    groups: Mutex<Vec<(GroupSpec, Vec<Shader>)>>,
}

impl GroupCompiler for Recorder<'_> {
    fn compile(&self, spec: &GroupSpec) -> Result<Group, SceneError> {
        let mut groups = self.groups.lock().unwrap_or_else(PoisonError::into_inner);
        let mut overrides = self.overrides.lock().unwrap_or_else(PoisonError::into_inner);
        let number = groups.len();
        let (group, shaders) = compiled(self.files, number, spec, self.old.get(number), &mut overrides)?;
        groups.push((spec.clone(), shaders));
        Ok(group)
    }

    fn access(&self) -> Access {
        self.files.access()
    }

    fn take_warnings(&self) -> Vec<String> {
        self.files.take_warnings()
    }
}
