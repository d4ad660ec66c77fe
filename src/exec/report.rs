//! What shaders say and what goes wrong while they run, in parts, so that a host can show, count or sort it.

use std::fmt;
use std::sync::Arc;

/// Something a shader said, or that went wrong while it ran. `Display` writes it as the command line shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// What it is.
    pub kind: ReportKind,
    /// Where in which shader it was said; nothing is known of what concerns no shader.
    pub place: Arc<ReportPlace>,
    /// The lane of the batch that said it.
    pub lane: usize,
    /// What was said, without its place.
    pub text: String,
}

/// What a report is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReportKind {
    /// `printf`
    Output,
    /// `fprintf`, with the file's name.
    File(String),
    /// `warning`
    Warning,
    /// `error`
    Error,
    /// A mistake that shading survives, such as an index outside its array.
    Mistake(Mistake),
    /// The shader cannot be run: the host should stop.
    Fatal,
}

/// What a mistake is, in parts, for a host that words it itself.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mistake {
    /// An index outside an array or a value of components; the nearest element was taken.
    Index {
        /// The index.
        index: i32,
        /// How many elements there are.
        len: u32,
    },
    /// A space that the host does not know.
    Space {
        /// Its name.
        name: String,
    },
    /// A change of color spaces that there is not.
    ColorSpace {
        /// The space of the color.
        from: String,
        /// The space that was asked for.
        to: String,
    },
    /// A noise that there is not.
    Noise {
        /// Its name.
        name: String,
    },
    /// A texture that there is not.
    Texture {
        /// Why not.
        reason: String,
    },
    /// A variable that was given what is no finite number, in a group that watches for it.
    NotFinite {
        /// Is it no number at all?
        nan: bool,
        /// The variable.
        variable: String,
        /// What computed the value, by OSL's name.
        operation: String,
    },
    /// A texture that something is asked of and that there is not.
    TextureInfo {
        /// Why not.
        reason: String,
    },
    /// A dictionary that there is no file of.
    NoDictionary {
        /// Its name.
        name: String,
    },
    /// A message that could not be set or read.
    Message {
        /// Its name.
        name: String,
        /// Why not.
        fault: MessageFault,
        /// Where it was set, or asked for, before.
        first: Box<ReportPlace>,
    },
    /// Anything else; the text says it.
    Other,
}

/// What is wrong with a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MessageFault {
    /// It is set a second time.
    Twice,
    /// It is set after it was asked for.
    AskedBefore,
    /// It is asked for as another type than that of its value.
    Type {
        /// The type of its value.
        created: String,
        /// The type that was asked for.
        wanted: String,
    },
}

impl MessageFault {
    /// One clause that ends where the place of the first use belongs.
    pub(super) fn text(&self, name: &str) -> String {
        match self {
            MessageFault::Twice => format!("the message \"{name}\" is set already,"),
            MessageFault::AskedBefore => format!("the message \"{name}\" is set after it was asked for"),
            MessageFault::Type { created, wanted } => {
                format!("the message \"{name}\" is read as {wanted} and was made as {created}")
            }
        }
    }
}

/// A place in a shader's text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReportPlace {
    /// The shader's name.
    pub shader: String,
    /// The name of its layer in the group.
    pub layer: String,
    /// The number of the layer, from 0 on.
    pub layer_number: usize,
    /// The file, or the name that its text was given.
    pub file: String,
    /// The line, from 1 on; 0 where it is not known.
    pub line: u32,
    /// The column, from 1 on.
    pub column: u32,
    /// The word that stands there, such as the name of the array that is indexed.
    pub word: String,
}

impl Report {
    /// A mistake that no single lane has made, at a place.
    pub fn mistake(place: ReportPlace, text: String) -> Self {
        Report { kind: ReportKind::Mistake(Mistake::Other), place: Arc::new(place), lane: 0, text }
    }

    /// A reason to stop that no single lane gives, at a place.
    pub fn fatal(place: ReportPlace, text: String) -> Self {
        Report { kind: ReportKind::Fatal, place: Arc::new(place), lane: 0, text }
    }

    /// A warning that no single lane gives, at a place.
    pub fn warning_at(place: ReportPlace, text: String) -> Self {
        Report { kind: ReportKind::Warning, place: Arc::new(place), lane: 0, text }
    }

    /// A warning of the host's own, without a place.
    pub fn warning(text: String) -> Self {
        Report { kind: ReportKind::Warning, place: Arc::default(), lane: 0, text }
    }

    /// True when it says that something is wrong, not what a shader printed or warns of.
    pub fn is_wrong(&self) -> bool {
        match self.kind {
            ReportKind::Error | ReportKind::Mistake(_) | ReportKind::Fatal => true,
            ReportKind::Output | ReportKind::File(_) | ReportKind::Warning => false,
        }
    }

    /// True when the shader cannot be run.
    pub fn is_fatal(&self) -> bool {
        self.kind == ReportKind::Fatal
    }

    /// What it says and how, whichever lane says it: equal for what a user would read twice. Reports sorted by it come in the
    /// order of their kinds.
    pub fn key(&self) -> String {
        let kind = match &self.kind {
            ReportKind::Error | ReportKind::Mistake(_) => "Error",
            ReportKind::Fatal => "Fatal",
            ReportKind::File(_) => "File",
            ReportKind::Output => "Output",
            ReportKind::Warning => "Warning",
        };
        format!("{kind} {self}")
    }
}

impl fmt::Display for ReportPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => f.write_str(&self.file),
            line => write!(f, "{}:{line}:{}", self.file, self.column),
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Report { kind, place, text, .. } = self;
        let colon = if place.file.is_empty() { "" } else { ": " };
        match kind {
            ReportKind::Output => f.write_str(text),
            ReportKind::File(name) => write!(f, "{name}: {text}"),
            ReportKind::Warning | ReportKind::Error => write!(f, "{place}{colon}{text}"),
            ReportKind::Mistake(_) | ReportKind::Fatal => write!(f, "{place}{colon}error: {text}"),
        }
    }
}
