//! What programs ask the host and each other for: attributes, messages, textures.

use super::kind::Kind;

/// An attribute as it is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AttributeQuery {
    /// Its type.
    pub ty: AttributeType,
    /// True when the derivatives along x of all values follow them, then those along y; floats only.
    pub slopes: bool,
    /// Who is asked for what.
    pub of: AttributeOf,
    /// True when an element of an array is asked for, by its number after the name.
    pub indexed: bool,
}

/// What is asked for by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AttributeOf {
    /// `getattribute`: of an object, of what is shaded, or of the scene.
    Attribute,
    /// `getmessage` with a source, such as what the last ray has met: the source stands for the object.
    Message,
}

/// What a message is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct MessageShape {
    /// The kind of its registers.
    pub kind: Kind,
    /// How many there are.
    pub count: u32,
    /// The name of its type; a message is read as what it was written as.
    pub ty: String,
}

/// The type an attribute is asked as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AttributeType {
    /// So many ints.
    Ints(u32),
    /// So many floats.
    Floats(u32),
    /// So many strings.
    Strings(u32),
}

/// A look-up of a texture. Its sources are the file; the coordinates and their changes along x and y ([`TextureCall::coordinates`]);
/// widths, blurs, fill and what is taken where there is no file, nine floats; first channel, subimage and which of those are given, three
/// ints; wraps, interpolation, subimage and color space by name, five strings. Its results are channels and alpha, with `slopes` the
/// derivatives of these along x and along y, an int that is 1 when there was a file, and what went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureCall {
    /// Channels, 1 or 3.
    pub channels: u32,
    /// True for a direction instead of s and t.
    pub environment: bool,
    /// See above.
    pub slopes: bool,
    /// True where the shader takes what went wrong, so that nobody else need hear of it.
    pub asks: bool,
}

impl TextureCall {
    /// How many floats the coordinates and their changes are.
    pub fn coordinates(self) -> u32 {
        if self.environment { 9 } else { 6 }
    }
}

impl AttributeType {
    /// The kind of its values and how many there are.
    pub fn kind(self) -> (Kind, u32) {
        match self {
            AttributeType::Ints(count) => (Kind::Int, count),
            AttributeType::Floats(count) => (Kind::Float, count),
            AttributeType::Strings(count) => (Kind::String, count),
        }
    }
}
