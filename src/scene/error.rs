//! What can be wrong with a scene: each kind with a stable code, and the place that it points to.

use super::camera::CameraFlaw;
use super::obj::LineFlaw;
use crate::compile::{CompileError, GroupError};
use std::fmt;
use std::sync::Arc;

/// A place in a text file; lines and columns count from one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file's name as the user would write it.
    pub file: Arc<str>,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// What is wrong with a scene, where, and what would help.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SceneError {
    /// Where, when a file is to blame.
    pub place: Option<Place>,
    /// What is wrong; its text is one clause.
    pub problem: Box<SceneProblem>,
    /// One clause that says what to do, when it is known.
    pub help: Option<String>,
}

/// What is wrong with a scene.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum SceneProblem {
    /// S0101: the scene file cannot be read.
    Unreadable {
        /// The file as given.
        scene: String,
        /// Why.
        error: Arc<std::io::Error>,
    },
    /// S0102: the text is not well-formed XML.
    NotXml {
        /// What the XML parser says.
        reason: String,
    },
    /// S0103: the root is not `<World>`.
    NotAWorld {
        /// What it is.
        tag: String,
    },
    /// S0104: there is neither geometry nor a background.
    NothingToSee,
    /// S0201: a tag that velour does not know, or not there.
    UnknownTag {
        /// The tag.
        tag: String,
    },
    /// S0202: text in an element that holds only elements.
    StrayText {
        /// The element.
        tag: String,
    },
    /// S0203: an attribute that the element does not have.
    UnknownAttribute {
        /// The element.
        tag: String,
        /// The attribute.
        attribute: String,
    },
    /// S0204: an attribute that the element must have is missing.
    MissingAttribute {
        /// The element.
        tag: String,
        /// The attribute.
        attribute: String,
    },
    /// S0205: an attribute's value is not what it should be.
    BadValue {
        /// The element.
        tag: String,
        /// The attribute.
        attribute: String,
        /// What is written.
        value: String,
        /// What should be.
        expected: String,
    },
    /// S0206: geometry or background before the first group.
    NoGroupAbove {
        /// The element.
        tag: String,
    },
    /// S0301: a camera that makes no picture.
    Camera(CameraFlaw),
    /// S0302: edges that span no area.
    NoArea {
        /// The element.
        tag: String,
    },
    /// S0303: a box whose low corner is above its high one.
    InsideOut {
        /// The element.
        tag: String,
    },
    /// S0304: more triangles than one element may make.
    TooManyTriangles {
        /// The element.
        tag: String,
        /// How many it would be.
        count: u64,
        /// The most there may be.
        most: u64,
    },
    /// S0305: a scene of too many triangles, spheres and quads.
    TooManyPrimitives {
        /// As many as are known of.
        count: u64,
        /// The most there may be.
        most: u64,
    },
    /// S0306: parameters with too many values together.
    TooManyValues {
        /// The most there may be.
        most: usize,
    },
    /// S0401: no file of that name in the folders.
    MeshNotFound {
        /// The file as written.
        file: String,
    },
    /// S0402: a mesh that cannot be used.
    Mesh {
        /// The file that was found.
        file: String,
        /// Why not.
        flaw: MeshFlaw,
    },
    /// S0501: a word that begins no statement of a group.
    UnknownStatement {
        /// The word.
        word: String,
    },
    /// S0502: something else where a statement should end.
    UnendedStatement {
        /// What stands there.
        found: String,
    },
    /// S0503: a name is missing in a statement.
    NameMissing {
        /// Whose, such as `a layer's name`.
        what: String,
    },
    /// S0504: a string without its closing quote.
    OpenString,
    /// S0505: a type that no parameter has.
    UnknownType {
        /// The word.
        word: String,
    },
    /// S0506: the length of an array is no number from 1 to 2^24.
    ArrayLength {
        /// What is written.
        text: String,
    },
    /// S0507: a hint that groups do not have.
    UnknownHint {
        /// Type and name as written.
        hint: String,
    },
    /// S0508: a hint without `= INTEGER`.
    HintWithoutValue {
        /// Its name.
        hint: String,
    },
    /// S0509: hints without `]]`.
    OpenHints,
    /// S0510: an end of a connection that names a layer and no parameter of it.
    NoParameter {
        /// The layer.
        layer: String,
    },
    /// S0601: a group without a shader.
    EmptyGroup,
    /// S0602: a parameter value after the last shader.
    StrayParameter {
        /// The parameter.
        name: String,
    },
    /// S0603: a connection of a layer that is not there.
    NoSuchLayer {
        /// Its name.
        layer: String,
    },
    /// S0604: a connection from a later layer to an earlier one, or to itself.
    LayerOrder {
        /// Where it begins.
        source: String,
        /// Where it ends.
        target: String,
    },
    /// S0605: no shader of that name, in no folder and not among those that velour brings along.
    ShaderNotFound {
        /// Its name.
        shader: String,
    },
    /// S0606: a shader that does not compile; the error has the messages with their places.
    Shader {
        /// Its name.
        shader: String,
        /// What is wrong with it.
        error: Arc<CompileError>,
    },
    /// S0607: a parameter or connection that does not fit.
    Group(GroupError),
    /// S0609: a value for a parameter that does not fit, and does not come from the scene.
    Value(GroupError),
    /// S0608: what a host's own [`super::GroupCompiler`] says.
    Host(String),
}

/// Why a mesh cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFlaw {
    /// It cannot be opened.
    Unopened {
        /// What the system says.
        reason: String,
    },
    /// It is too large to be read.
    TooLarge {
        /// The most bytes there may be.
        most: u64,
    },
    /// It is not text.
    NotText,
    /// A line is wrong.
    Line {
        /// The line, from 1.
        line: u32,
        /// What is wrong with it.
        flaw: LineFlaw,
    },
    /// The element's own placement puts a vertex where no single reaches.
    NotFinite,
    /// There is no face in it.
    NoFaces,
}

impl SceneProblem {
    /// A stable code, for programs.
    pub fn code(&self) -> &'static str {
        match self {
            SceneProblem::Unreadable { .. } => "S0101",
            SceneProblem::NotXml { .. } => "S0102",
            SceneProblem::NotAWorld { .. } => "S0103",
            SceneProblem::NothingToSee => "S0104",
            SceneProblem::UnknownTag { .. } => "S0201",
            SceneProblem::StrayText { .. } => "S0202",
            SceneProblem::UnknownAttribute { .. } => "S0203",
            SceneProblem::MissingAttribute { .. } => "S0204",
            SceneProblem::BadValue { .. } => "S0205",
            SceneProblem::NoGroupAbove { .. } => "S0206",
            SceneProblem::Camera(_) => "S0301",
            SceneProblem::NoArea { .. } => "S0302",
            SceneProblem::InsideOut { .. } => "S0303",
            SceneProblem::TooManyTriangles { .. } => "S0304",
            SceneProblem::TooManyPrimitives { .. } => "S0305",
            SceneProblem::TooManyValues { .. } => "S0306",
            SceneProblem::MeshNotFound { .. } => "S0401",
            SceneProblem::Mesh { .. } => "S0402",
            SceneProblem::UnknownStatement { .. } => "S0501",
            SceneProblem::UnendedStatement { .. } => "S0502",
            SceneProblem::NameMissing { .. } => "S0503",
            SceneProblem::OpenString => "S0504",
            SceneProblem::UnknownType { .. } => "S0505",
            SceneProblem::ArrayLength { .. } => "S0506",
            SceneProblem::UnknownHint { .. } => "S0507",
            SceneProblem::HintWithoutValue { .. } => "S0508",
            SceneProblem::OpenHints => "S0509",
            SceneProblem::NoParameter { .. } => "S0510",
            SceneProblem::EmptyGroup => "S0601",
            SceneProblem::StrayParameter { .. } => "S0602",
            SceneProblem::NoSuchLayer { .. } => "S0603",
            SceneProblem::LayerOrder { .. } => "S0604",
            SceneProblem::ShaderNotFound { .. } => "S0605",
            SceneProblem::Shader { .. } => "S0606",
            SceneProblem::Group(_) => "S0607",
            SceneProblem::Value(_) => "S0609",
            SceneProblem::Host(_) => "S0608",
        }
    }
}

impl fmt::Display for SceneProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SceneProblem::Unreadable { scene, error } => write!(f, "cannot read the scene `{scene}`: {error}"),
            SceneProblem::NotXml { reason } => write!(f, "the scene is not well-formed XML: {reason}"),
            SceneProblem::NotAWorld { tag } => write!(f, "the scene's root is <{tag}>"),
            SceneProblem::NothingToSee => f.write_str("the scene has nothing to see"),
            SceneProblem::UnknownTag { tag } => write!(f, "unknown tag <{tag}>"),
            SceneProblem::StrayText { tag } => write!(f, "text in <{tag}>, which holds only elements"),
            SceneProblem::UnknownAttribute { tag, attribute } => write!(f, "<{tag}> has no attribute `{attribute}`"),
            SceneProblem::MissingAttribute { tag, attribute } => write!(f, "<{tag}> needs the attribute `{attribute}`"),
            SceneProblem::BadValue { tag, attribute, value, expected } => {
                write!(f, "`{attribute}` of <{tag}> is `{value}`: {expected} expected")
            }
            SceneProblem::NoGroupAbove { tag } => write!(f, "<{tag}> comes before any <ShaderGroup>"),
            SceneProblem::Camera(flaw) => f.write_str(flaw.message()),
            SceneProblem::NoArea { tag } => write!(f, "this <{tag}> has no area"),
            SceneProblem::InsideOut { tag } => write!(f, "`low` of this <{tag}> is above `high`"),
            SceneProblem::TooManyTriangles { tag, count, most } => {
                write!(f, "this <{tag}> would have {count} triangles, {most} are the most")
            }
            SceneProblem::TooManyPrimitives { count, most } => {
                write!(f, "the scene has {count} triangles, spheres and quads up to here, {most} are the most")
            }
            SceneProblem::TooManyValues { most } => {
                write!(f, "the parameters up to here have more than {most} values together")
            }
            SceneProblem::MeshNotFound { file } => write!(f, "mesh `{file}` is not found"),
            SceneProblem::Mesh { file, flaw } => write!(f, "mesh `{file}`: {flaw}"),
            SceneProblem::UnknownStatement { word } => write!(f, "unknown statement `{word}` in a shader group"),
            SceneProblem::UnendedStatement { found } => write!(f, "`;` expected, found `{found}`"),
            SceneProblem::NameMissing { what } => write!(f, "{what} expected"),
            SceneProblem::OpenString => f.write_str("this string has no closing quote"),
            SceneProblem::UnknownType { word } => write!(f, "unknown parameter type `{word}`"),
            SceneProblem::ArrayLength { text } => write!(f, "`{text}` is no array length"),
            SceneProblem::UnknownHint { hint } => write!(f, "unknown hint `{hint}`"),
            SceneProblem::HintWithoutValue { hint } => write!(f, "hint `{hint}` needs `= INTEGER`"),
            SceneProblem::OpenHints => f.write_str("`]]` expected at the end of the hints"),
            SceneProblem::NoParameter { layer } => write!(f, "`.` expected after layer `{layer}`"),
            SceneProblem::EmptyGroup => f.write_str("this <ShaderGroup> has no shader"),
            SceneProblem::StrayParameter { name } => write!(f, "parameter `{name}` has no shader after it"),
            SceneProblem::NoSuchLayer { layer } => write!(f, "no layer is named `{layer}`"),
            SceneProblem::LayerOrder { source, target } => {
                write!(f, "layer `{source}` does not come before layer `{target}`")
            }
            SceneProblem::ShaderNotFound { shader } => write!(f, "shader `{shader}` is not found"),
            SceneProblem::Shader { shader, error } => write!(f, "shader `{shader}` does not compile\n{error}"),
            SceneProblem::Group(error) | SceneProblem::Value(error) => error.problem.fmt(f),
            SceneProblem::Host(message) => f.write_str(message),
        }
    }
}

impl fmt::Display for MeshFlaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MeshFlaw::Unopened { reason } => write!(f, "it cannot be opened: {reason}"),
            MeshFlaw::TooLarge { most } => write!(f, "it is too large; {} MB are the most", most >> 20),
            MeshFlaw::NotText => f.write_str("it is not text, so it is no OBJ file"),
            MeshFlaw::Line { line, flaw } => write!(f, "line {line}: {flaw}"),
            MeshFlaw::NotFinite => f.write_str("it is placed so far away that a vertex is not a finite number"),
            MeshFlaw::NoFaces => f.write_str("it has no faces"),
        }
    }
}

impl SceneError {
    /// An error at a place.
    pub fn at(place: Place, problem: SceneProblem) -> Self {
        SceneError { place: Some(place), problem: Box::new(problem), help: None }
    }

    /// An error that no file is to blame for.
    pub fn nowhere(problem: SceneProblem) -> Self {
        SceneError { place: None, problem: Box::new(problem), help: None }
    }

    /// The same error with a line of help.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// The same error, at `place` unless it has one of its own, or is about nothing that a scene says.
    pub fn or_at(mut self, place: &Place) -> Self {
        if !matches!(*self.problem, SceneProblem::Value(_)) {
            self.place.get_or_insert_with(|| place.clone());
        }
        self
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.place, &*self.problem) {
            (Some(place), _) => write!(f, "{place}: ")?,
            // The shader alone was asked for, and its messages have their own places.
            (None, SceneProblem::Shader { error, .. }) => return error.fmt(f),
            (None, _) => {}
        }
        write!(f, "error: {}", self.problem)?;
        if let Some(help) = &self.help {
            write!(f, "\n  help: {help}")?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &*self.problem {
            SceneProblem::Unreadable { error, .. } => Some(error.as_ref()),
            SceneProblem::Shader { error, .. } => Some(error.as_ref()),
            SceneProblem::Group(error) | SceneProblem::Value(error) => Some(error),
            SceneProblem::Camera(flaw) => Some(flaw),
            _ => None,
        }
    }
}
