//! A shader group as written: layers, parameter values and connections, each with its place. Not yet compiled.

use super::error::{Place, SceneError};
use crate::exec;
use std::path::PathBuf;
use velour_grammar::files::Access;

/// What a group is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Usage {
    /// The usual one: colour and light of a surface.
    Surface,
    /// Moves points.
    Displacement,
    /// Accepted, as OSL does; nothing of it differs from `Surface` here.
    Volume,
    /// A generic shader.
    Shader,
}

impl Usage {
    /// The names a scene may write.
    pub const NAMES: [&'static str; 4] = ["surface", "displacement", "volume", "shader"];

    /// The usage of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "surface" => Usage::Surface,
            "displacement" => Usage::Displacement,
            "volume" => Usage::Volume,
            "shader" => Usage::Shader,
            _ => return None,
        })
    }
}

/// The type that a parameter value was written with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// The variants are the language's own types.
#[allow(missing_docs)]
#[non_exhaustive]
pub enum ParamType {
    Int,
    Float,
    Color,
    Point,
    Vector,
    Normal,
    Matrix,
    String,
}

impl ParamType {
    /// The names a group's text may write.
    pub const NAMES: [&'static str; 8] = ["int", "float", "color", "point", "vector", "normal", "matrix", "string"];

    /// The type of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        use ParamType::*;
        let all = [Int, Float, Color, Point, Vector, Normal, Matrix, String];
        Self::NAMES.iter().position(|n| *n == name).map(|i| all[i])
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// How many numbers (or strings) one value of this type has.
    pub fn components(self) -> usize {
        match self {
            ParamType::Int | ParamType::Float | ParamType::String => 1,
            ParamType::Color | ParamType::Point | ParamType::Vector | ParamType::Normal => 3,
            ParamType::Matrix => 16,
        }
    }
}

/// The numbers or strings of a parameter, padded with zeros or empty strings to the declared size.
#[derive(Clone, Debug, PartialEq)]
// The variants say all there is to say.
#[allow(missing_docs)]
pub enum Values {
    Floats(Vec<f32>),
    Ints(Vec<i32>),
    Strings(Vec<String>),
}

impl Values {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Values::Floats(values) => values.len(),
            Values::Ints(values) => values.len(),
            Values::Strings(values) => values.len(),
        }
    }

    /// True when there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// What is written after a value: `[[int lockgeom=0]]`, `interpolated`, `interactive`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hints {
    /// Whether userdata of the parameter's name goes before the value, where that is said.
    pub interpolated: Option<bool>,
    /// The value may change after the group is built; nothing depends on it here, as groups are compiled anew.
    pub interactive: bool,
}

/// One parameter value of a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamValue {
    /// The type as written.
    pub kind: ParamType,
    /// `None` for a plain value, else the array's length.
    pub array: Option<usize>,
    /// The parameter's name, `.field` included.
    pub name: String,
    /// The values.
    pub values: Values,
    /// What is written after them.
    pub hints: Hints,
    /// Where the name is written.
    pub place: Place,
}

/// One shader of a group.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The shader's name, to be looked for as `NAME.osl`.
    pub shader: String,
    /// The name that connections use.
    pub layer_name: String,
    /// The values that precede the shader in the text.
    pub params: Vec<ParamValue>,
    /// Where the shader's name is written.
    pub place: Place,
}

/// An output of one layer that feeds an input of a later one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Connection {
    /// Name of the earlier layer.
    pub source_layer: String,
    /// Its output, `.field` or `[i]` included.
    pub source_param: String,
    /// Name of the later layer.
    pub target_layer: String,
    /// Its input, `.field` or `[i]` included.
    pub target_param: String,
    /// Where the connection is written.
    pub place: Place,
}

/// A whole group.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupSpec {
    /// What it is for.
    pub usage: Usage,
    /// Its name; `group` when the scene gives none.
    pub name: String,
    /// True when the scene asks for its primitives to be sampled as lights.
    pub is_light: bool,
    /// The layers, first to last; the last one makes the closure.
    pub layers: Vec<Layer>,
    /// The connections.
    pub connections: Vec<Connection>,
    /// Where the group begins.
    pub place: Place,
    /// Folders to look for shaders in: that of the scene first.
    pub search: Vec<PathBuf>,
}

/// Turns a group as written into one that runs. Outside the tests this is the compiler.
pub trait GroupCompiler {
    /// Compiles one group, or says what is wrong with it and where.
    fn compile(&self, spec: &GroupSpec) -> Result<exec::Group, SceneError>;

    /// Which files the scene may name.
    fn access(&self) -> Access {
        Access::default()
    }

    /// What was odd in the groups since the last call, as lines that begin with a place; asked after each group.
    fn take_warnings(&self) -> Vec<String> {
        Vec::new()
    }
}

impl GroupSpec {
    /// The group as text that [`super::parse_group`] reads: parameters, shaders and connections, in the form of OSL's serialised
    /// groups.
    pub fn text(&self) -> String {
        let mut out = String::new();
        for layer in &self.layers {
            layer.params.iter().for_each(|param| out += &param.text());
            out += &format!("shader {} {} ;\n", layer.shader, layer.layer_name);
        }
        for c in &self.connections {
            out += &format!("connect {}.{} {}.{} ;\n", c.source_layer, c.source_param, c.target_layer, c.target_param);
        }
        out
    }
}

impl ParamValue {
    fn text(&self) -> String {
        let array = self.array.map_or(String::new(), |length| format!("[{length}]"));
        let values: Vec<String> = match &self.values {
            Values::Floats(values) => values.iter().map(f32::to_string).collect(),
            Values::Ints(values) => values.iter().map(i32::to_string).collect(),
            Values::Strings(values) => values.iter().map(|text| quoted(text)).collect(),
        };
        let mut hints = Vec::new();
        hints.extend(self.hints.interpolated.map(|yes| format!("int interpolated={}", i32::from(yes))));
        hints.extend(self.hints.interactive.then(|| "int interactive=1".to_owned()));
        let hints = if hints.is_empty() { String::new() } else { format!(" [[{}]]", hints.join(", ")) };
        format!("param {}{array} {} {}{hints} ;\n", self.kind.name(), self.name, values.join(" "))
    }
}

fn quoted(text: &str) -> String {
    let escaped =
        text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n").replace('\t', "\\t").replace('\r', "\\r");
    format!("\"{escaped}\"")
}
