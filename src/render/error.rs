//! Why a scene cannot be rendered, or its picture not written; what a user may get wrong has a stable code.

use crate::limits::FRAME_SIDE;
use crate::scene::CameraFlaw;
use std::fmt;
use std::path::PathBuf;

/// What cannot be in the settings of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SettingsError {
    /// R0101: no pixels, or more than 2^27.
    Size {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// R0102: no samples.
    NoSamples,
    /// R0103: a noise to stop at that is not above 0.
    Noise,
    /// R0104: a time to stop at that is not above 0.
    Seconds,
    /// R0105: tiles, waves or batches of nothing.
    Batches,
    /// R0106: a render that stops by noise or time and does not begin with its first sample.
    First,
    /// R0107: a picture that is not inside of its frame, or a frame that is too large.
    Frame {
        /// One behind the picture's last pixel, x and y.
        end: [u64; 2],
        /// Width and height of the frame.
        size: [u32; 2],
    },
}

/// What keeps a scene from being rendered.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RenderError {
    /// The settings ask for what cannot be.
    Settings(SettingsError),
    /// The camera cannot make a picture.
    Camera(CameraFlaw),
    /// There is no such material.
    Material {
        /// The index that was asked for.
        index: usize,
        /// How many materials the scene has.
        count: usize,
    },
    /// Shaders move surfaces of too many triangles.
    Facets {
        /// How many there would be.
        facets: u64,
        /// How many there may be.
        most: u64,
    },
    /// The threads could not be started, for this reason.
    Threads(String),
    /// The time was up before the picture had a first sample.
    Late,
    /// A thread has failed, which is a mistake in this crate.
    ThreadFailed,
    /// A shader cannot be run, for this reason, which begins with a place where there is one.
    Shader(String),
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RenderError::Settings(error) => error.fmt(f),
            RenderError::Shader(message) => f.write_str(message),
            RenderError::Camera(flaw) => write!(f, "{flaw}"),
            RenderError::Material { index, count } => {
                write!(f, "there is no material {index}; the scene has {count}, counted from 0")
            }
            RenderError::Facets { facets, most } => write!(
                f,
                "displacement takes {facets} triangles, and {most} are the most: give spheres and quads a smaller `resolution`, meshes fewer faces"
            ),
            RenderError::Threads(reason) => write!(f, "the threads could not be started: {reason}"),
            RenderError::ThreadFailed => f.write_str("a thread has failed"),
            RenderError::Late => f.write_str("the time was up before the picture had a first sample"),
        }
    }
}

impl std::error::Error for RenderError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            RenderError::Settings(error) => Some(error),
            RenderError::Camera(flaw) => Some(flaw),
            RenderError::Facets { .. }
            | RenderError::Material { .. }
            | RenderError::Threads(_)
            | RenderError::ThreadFailed
            | RenderError::Late
            | RenderError::Shader(_) => None,
        }
    }
}

impl RenderError {
    /// The message for people: "error:" goes before it, unless it is a shader's own, which begins with its place.
    pub fn told(&self) -> String {
        match self {
            RenderError::Shader(message) => message.clone(),
            other => format!("error: {other}"),
        }
    }
}

impl SettingsError {
    /// A stable code, for programs.
    pub fn code(&self) -> &'static str {
        match self {
            SettingsError::Size { .. } => "R0101",
            SettingsError::NoSamples => "R0102",
            SettingsError::Noise => "R0103",
            SettingsError::Seconds => "R0104",
            SettingsError::Batches => "R0105",
            SettingsError::First => "R0106",
            SettingsError::Frame { .. } => "R0107",
        }
    }
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SettingsError::Size { width, height } => {
                write!(f, "an image of {width} x {height} pixels cannot be rendered")
            }
            SettingsError::NoSamples => f.write_str("at least one sample a pixel is needed"),
            SettingsError::Noise => f.write_str("the noise to stop at must be a number above 0, such as 0.01"),
            SettingsError::Seconds => f.write_str("the time to stop at must be a number of seconds above 0"),
            SettingsError::Batches => f.write_str("tile size, wave size and batch width must be above 0"),
            SettingsError::First => f.write_str("a render that stops by noise or time begins with sample 0"),
            SettingsError::Frame { end, size } if size.iter().all(|side| *side <= FRAME_SIDE) => {
                let ([right, low], [width, height]) = (end, size);
                write!(f, "the part of the picture ends at pixel {right} {low}, outside of its {width} x {height}")
            }
            SettingsError::Frame { .. } => write!(f, "a picture has {FRAME_SIDE} pixels a side at most"),
        }
    }
}

impl std::error::Error for SettingsError {}

/// Why a picture cannot be written.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OutputError {
    /// R0201: the file's extension is none of those that can be written.
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// R0202: the file's folder is not there.
    NoFolder {
        /// The folder.
        folder: PathBuf,
    },
    /// R0203: a folder has that name.
    IsFolder {
        /// The folder.
        path: PathBuf,
    },
    /// R0205: the disk has too little room.
    NoRoom {
        /// The file.
        path: PathBuf,
        /// Bytes that it may take.
        bytes: u64,
    },
    /// R0204: the file cannot be written.
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system or the encoder says.
        reason: String,
    },
}

impl OutputError {
    /// The extensions of the formats that can be written.
    pub const EXTENSIONS: [&str; 3] = ["exr", "png", "hdr"];

    /// A stable code, for programs.
    pub fn code(&self) -> &'static str {
        match self {
            OutputError::UnknownFormat { .. } => "R0201",
            OutputError::NoFolder { .. } => "R0202",
            OutputError::IsFolder { .. } => "R0203",
            OutputError::Unwritable { .. } => "R0204",
            OutputError::NoRoom { .. } => "R0205",
        }
    }
}

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OutputError::UnknownFormat { path } => {
                let (shown, known) = (path.display(), Self::EXTENSIONS.join(", "));
                write!(f, "cannot tell the image format of `{shown}`; known extensions: {known}")
            }
            OutputError::NoFolder { folder } => write!(f, "the folder `{}` is not there", folder.display()),
            OutputError::IsFolder { path } => write!(f, "`{}` is a folder", path.display()),
            OutputError::NoRoom { path, bytes } => {
                let (megabytes, shown) = (bytes.div_ceil(1 << 20), path.display());
                write!(f, "the disk has no room for `{shown}`, which may take {megabytes} MB")
            }
            OutputError::Unwritable { path, reason } => write!(f, "cannot write `{}`: {reason}", path.display()),
        }
    }
}

impl std::error::Error for OutputError {}
