//! The types of the language.

use std::fmt;
use std::sync::Arc;

/// What a single value is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Base {
    /// No value.
    Void,
    /// A 32-bit signed integer; also the boolean.
    Int,
    /// A 32-bit float.
    Float,
    /// Three floats: red, green, blue.
    Color,
    /// Three floats: a position.
    Point,
    /// Three floats: a direction with length.
    Vector,
    /// Three floats: a surface normal.
    Normal,
    /// Sixteen floats, row vectors on the left (`p * M`), row by row.
    Matrix,
    /// An interned string.
    String,
    /// A closure: a handle to a tree of scattering lobes.
    Closure,
}

impl Base {
    /// How many float columns hold one value (0 for those that are not floats).
    pub fn floats(self) -> usize {
        match self {
            Base::Float => 1,
            Base::Color | Base::Point | Base::Vector | Base::Normal => 3,
            Base::Matrix => 16,
            _ => 0,
        }
    }

    /// How many registers hold one value of any kind.
    pub fn components(self) -> usize {
        match self {
            Base::Void => 0,
            Base::Int | Base::String | Base::Closure => 1,
            other => other.floats(),
        }
    }

    /// True for color, point, vector and normal.
    pub fn is_triple(self) -> bool {
        matches!(self, Base::Color | Base::Point | Base::Vector | Base::Normal)
    }

    /// True for int and float.
    pub fn is_number(self) -> bool {
        matches!(self, Base::Int | Base::Float)
    }

    /// The name in the language.
    pub fn name(self) -> &'static str {
        match self {
            Base::Void => "void",
            Base::Int => "int",
            Base::Float => "float",
            Base::Color => "color",
            Base::Point => "point",
            Base::Vector => "vector",
            Base::Normal => "normal",
            Base::Matrix => "matrix",
            Base::String => "string",
            Base::Closure => "closure color",
        }
    }
}

/// A struct type: its name and its fields.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct Struct {
    /// The name it was declared with.
    pub name: String,
    /// Names and types of the fields, in order.
    pub fields: Vec<(String, Type)>,
}

/// What one element of a value is: a base type or a struct.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Element {
    /// A built-in type.
    Base(Base),
    /// A struct.
    Struct(Arc<Struct>),
}

/// The length of an array type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Length {
    /// Not an array.
    Single,
    /// An array whose length is not known here.
    Unsized,
    /// An array of so many elements.
    Fixed(u32),
}

/// A type: an element and an array length.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Type {
    /// What each element is.
    pub element: Element,
    /// How many there are.
    pub length: Length,
}

impl Default for Type {
    /// No value.
    fn default() -> Self {
        Type::VOID
    }
}

impl Type {
    /// A single value of a base type.
    pub const fn of(base: Base) -> Type {
        Type { element: Element::Base(base), length: Length::Single }
    }

    /// An `int`.
    pub const INT: Type = Type::of(Base::Int);
    /// A `float`.
    pub const FLOAT: Type = Type::of(Base::Float);
    /// A `string`.
    pub const STRING: Type = Type::of(Base::String);
    /// No value.
    pub const VOID: Type = Type::of(Base::Void);
    /// A `closure color`.
    pub const CLOSURE: Type = Type::of(Base::Closure);

    /// The base type when this is a single value of one.
    pub fn base(&self) -> Option<Base> {
        match (&self.element, self.length) {
            (Element::Base(base), Length::Single) => Some(*base),
            _ => None,
        }
    }

    /// True when this is an array.
    pub fn is_array(&self) -> bool {
        self.length != Length::Single
    }

    /// The type of one element of an array (of itself for a single value).
    pub fn element_type(&self) -> Type {
        Type { element: self.element.clone(), length: Length::Single }
    }

    /// The same element as an array of `length`.
    pub fn array(&self, length: Length) -> Type {
        Type { element: self.element.clone(), length }
    }

    /// How many elements there are (1 for a single value, 0 when unknown).
    pub fn count(&self) -> usize {
        match self.length {
            Length::Single => 1,
            Length::Unsized => 0,
            Length::Fixed(n) => n as usize,
        }
    }

    /// How many numbers or texts a value has at one point, as far as a limit; arrays of unknown length have none.
    pub fn numbers(&self, most: u64) -> u64 {
        let one = match &self.element {
            Element::Base(base) => base.components() as u64,
            Element::Struct(structure) => structure
                .fields
                .iter()
                .try_fold(0u64, |sum, (_, ty)| {
                    let sum = sum.saturating_add(ty.numbers(most));
                    if sum > most { Err(sum) } else { Ok(sum) }
                })
                .unwrap_or_else(|sum| sum),
        };
        one.saturating_mul(self.count() as u64)
    }

    /// The type with its article: `an int`, `a float[3]`.
    pub fn named(&self) -> String {
        let article = if self.element == Element::Base(Base::Int) { "an" } else { "a" };
        format!("{article} {self}")
    }

    /// The struct when the element is one.
    pub fn structure(&self) -> Option<&Arc<Struct>> {
        match &self.element {
            Element::Struct(s) => Some(s),
            Element::Base(_) => None,
        }
    }
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.element {
            Element::Base(base) => f.write_str(base.name())?,
            Element::Struct(s) => write!(f, "struct {}", s.name)?,
        }
        match self.length {
            Length::Single => Ok(()),
            Length::Unsized => f.write_str("[]"),
            Length::Fixed(n) => write!(f, "[{n}]"),
        }
    }
}
