//! Routines: work that is more than one arithmetic step. Each is declared once, in [`Routine::declaration`].
//!
//! Lowering takes the kinds of results from there, the passes of `optimize` how derivatives pass, what has an effect and
//! what differs from lane to lane, [`super::verify`] the arity and the kinds, and the machine which arguments are which.

use super::kind::Kind;
use smallvec::{SmallVec, smallvec};

pub use super::noise::{Noise, NoiseKind};
pub use super::queries::*;

/// A routine. Sources and results are lists of registers.
#[derive(Clone, Debug, PartialEq)]
pub enum Routine {
    /// Noise.
    Noise(Noise),
    /// A function with derivatives.
    Smooth(Smooth),
    /// How the results of a function change: its arguments, its float results and the changes of its float arguments, in
    /// this order, to the changes of its float results.
    Slope(Smooth),
    /// The matrix from one named space to another: two symbols to 16 floats and an int that is 1 when both are known.
    SpaceMatrix,
    /// The number of a component, kept inside `0..n`; one that is outside is reported.
    ClampIndex {
        /// How many components there are.
        len: u32,
        /// True where the component is written: a mistake there is told even if nobody reads what was written.
        written: bool,
    },
    /// Floats that are assigned, and reported where they are no finite numbers.
    CheckFinite(Box<Watch>),
    /// `hash` of an int.
    HashInt,
    /// `hash` of 1 to 4 floats.
    HashFloats(u32),
    /// `hash` of a string.
    HashString,
    /// `strlen`
    Strlen,
    /// `getchar`
    GetChar,
    /// `startswith`
    StartsWith,
    /// `endswith`
    EndsWith,
    /// `substr`
    Substr,
    /// `concat`
    Concat,
    /// `stof`
    Stof,
    /// `stoi`
    Stoi,
    /// `regex_search`, `regex_match`: text and pattern to 0 or 1 and the positions asked for.
    Regex {
        /// True when the whole text has to match.
        whole: bool,
        /// How many positions are asked for.
        positions: u32,
    },
    /// `split`: text, separators, most; gives the count, then so many parts.
    Split(u32),
    /// `format` to a symbol.
    Format(TextFormat),
    /// Writes text.
    Print(PrintTo, TextFormat),
    /// Does the ray have this type? Symbol to int.
    RayType,
    /// A named attribute: symbols of object and name to an int that is 1 when there is one, and the values.
    Attribute(AttributeQuery),
    /// `setmessage`: name and value.
    SetMessage(MessageShape),
    /// `getmessage`: name to an int that is 1 when there is such a message, and its value.
    GetMessage(MessageShape),
    /// `random`: so many floats.
    Random(u32),
    /// `trace`: origin, direction, least and most distance to an int that is 1 when something is hit.
    Trace,
    /// `dict_find`: text of a dictionary and query to a node.
    DictFind,
    /// `dict_find` below a node: node and query to a node.
    DictFindBelow,
    /// `dict_next`: node to node.
    DictNext,
    /// `dict_value`: node and attribute to an int that is 1 when there is one of this shape, and the values.
    DictValue(AttributeType),
    /// `texture` and `environment`.
    Texture(TextureCall),
    /// `gettextureinfo`: file and name of what is asked for, s and t, to an int that is 1 when it is known, and the values.
    TextureInfo(AttributeType),
}

/// The functions that have derivatives by a rule of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Smooth {
    /// `spline`: basis symbol, x, how many knots count, then so many knots of one component.
    Spline(u32),
    /// `splineinverse`: basis symbol, value, how many knots count, then so many knots.
    SplineInverse(u32),
    /// Inverse of a matrix: 16 to 16.
    MatrixInverse,
    /// Determinant of a matrix.
    Determinant,
    /// `blackbody`
    Blackbody,
    /// `wavelength_color`
    WavelengthColor,
    /// `transformc`: from, to, color.
    TransformColor,
    /// `transformu`: from, to, length.
    TransformUnit,
}

/// Where text goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrintTo {
    /// `printf`
    Output,
    /// `fprintf`: the first source is the file's symbol.
    File,
    /// `warning`
    Warning,
    /// `error`
    Error,
    /// Nothing of the shader's: there is no noise of the name that is the one argument.
    UnknownNoise,
}

/// A format string and how the sources that follow group into its arguments.
#[derive(Clone, Debug, PartialEq)]
pub struct TextFormat {
    /// The format.
    pub text: String,
    /// True where it is not `text` but the first source.
    pub computed: bool,
    /// What each argument is made of.
    pub args: Vec<TextArg>,
}

/// One argument of a format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextArg {
    /// So many ints.
    Ints(u32),
    /// So many floats.
    Floats(u32),
    /// So many strings.
    Strings(u32),
    /// A closure.
    Closure,
}

/// Kinds of registers in order, each with how many there are in a row.
pub type Kinds = SmallVec<[(Kind, u32); 4]>;

/// What a routine takes, gives and does.
#[derive(Clone, Debug, PartialEq)]
pub struct Declaration {
    /// The kinds of its sources.
    pub takes: Kinds,
    /// The kinds of its results.
    pub gives: Kinds,
    /// How its results change when its sources do.
    pub slopes: Slopes,
    /// What it does besides giving results.
    pub effect: Effect,
    /// What its results depend on besides its sources.
    pub reach: Reach,
}

/// How derivatives pass through a routine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slopes {
    /// They do not: its results are steps, ints or strings, and their derivatives zero.
    None,
    /// [`Routine::Slope`] of this function gives the changes of its results.
    Rule(Smooth),
    /// It gives its gradient when asked: value by value, coordinate by coordinate.
    Gradient,
    /// It gives the derivatives of its values when asked, as it is no function of its sources alone.
    Given,
}

/// An assignment that is watched.
#[derive(Clone, Debug, PartialEq)]
pub struct Watch {
    /// The variable that is assigned.
    pub variable: String,
    /// What computes its value, by OSL's name.
    pub operation: &'static str,
    /// How many floats it is given.
    pub count: u32,
}

/// What a routine does besides giving results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Nothing: where nobody reads its results it need not run.
    None,
    /// It says something that somebody may hear.
    Prints,
    /// It changes what is answered later.
    Changes,
}

/// What the results of a routine depend on besides its sources.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reach {
    /// On nothing else.
    Sources,
    /// On the host, which answers once for a batch.
    Host,
    /// On the point of each lane, and maybe on the host.
    Lane,
}

/// How many registers a list of kinds stands for.
pub fn width(kinds: &Kinds) -> usize {
    kinds.iter().map(|&(_, count)| count as usize).sum()
}

/// The kinds of a list one by one.
pub fn each(kinds: &Kinds) -> impl Iterator<Item = Kind> + '_ {
    kinds.iter().flat_map(|&(kind, count)| std::iter::repeat_n(kind, count as usize))
}

fn floats_of(kinds: &Kinds) -> u32 {
    let counts = kinds.iter().filter(|(kind, _)| *kind == Kind::Float).map(|&(_, count)| count);
    counts.fold(0, u32::saturating_add)
}

impl Routine {
    /// What it takes, gives and does: the one place that says it.
    pub fn declaration(&self) -> Declaration {
        use Kind::{Float, Int, String};
        let one = |kind| smallvec![(kind, 1)];
        let pure = |takes: Kinds, gives: Kinds| Declaration {
            takes,
            gives,
            slopes: Slopes::None,
            effect: Effect::None,
            reach: Reach::Sources,
        };
        match self {
            Routine::Noise(noise) => {
                let slopes = if noise.kind.has_gradient() { Slopes::Gradient } else { Slopes::None };
                let (reads, writes) = (smallvec![(Float, noise.reads())], smallvec![(Float, noise.writes())]);
                Declaration { slopes, ..pure(reads, writes) }
            }
            Routine::Smooth(function) => {
                let slopes = Slopes::Rule(*function);
                Declaration { slopes, ..pure(function.takes(), function.gives()) }
            }
            Routine::Slope(function) => {
                let (mut takes, results) = (function.takes(), floats_of(&function.gives()));
                let changes = floats_of(&takes);
                takes.extend([(Float, results), (Float, changes)]);
                pure(takes, smallvec![(Float, results)])
            }
            Routine::SpaceMatrix => {
                Declaration { reach: Reach::Host, ..pure(smallvec![(String, 2)], smallvec![(Float, 16), (Int, 1)]) }
            }
            Routine::ClampIndex { written: true, .. } => {
                Declaration { effect: Effect::Prints, ..pure(one(Int), one(Int)) }
            }
            Routine::ClampIndex { .. } | Routine::HashInt => pure(one(Int), one(Int)),
            Routine::CheckFinite(watch) => {
                Declaration { effect: Effect::Prints, ..pure(smallvec![(Float, watch.count)], Kinds::new()) }
            }
            Routine::HashFloats(count) => pure(smallvec![(Float, *count)], one(Int)),
            Routine::HashString | Routine::Strlen | Routine::Stoi => pure(one(String), one(Int)),
            Routine::GetChar => pure(smallvec![(String, 1), (Int, 1)], one(Int)),
            Routine::StartsWith | Routine::EndsWith => pure(smallvec![(String, 2)], one(Int)),
            Routine::Substr => pure(smallvec![(String, 1), (Int, 2)], one(String)),
            Routine::Concat => pure(smallvec![(String, 2)], one(String)),
            Routine::Stof => pure(one(String), one(Float)),
            Routine::Regex { positions, .. } => {
                pure(smallvec![(String, 2)], smallvec![(Int, positions.saturating_add(1))])
            }
            Routine::Split(parts) => pure(smallvec![(String, 2), (Int, 1)], smallvec![(Int, 1), (String, *parts)]),
            Routine::Format(format) => pure(format.takes().collect(), one(String)),
            Routine::Print(to, format) => {
                let file = (*to == PrintTo::File).then_some((String, 1));
                let takes = file.into_iter().chain(format.takes()).collect();
                Declaration { effect: Effect::Prints, ..pure(takes, Kinds::new()) }
            }
            Routine::RayType => Declaration { reach: Reach::Lane, ..pure(one(String), one(Int)) },
            Routine::Attribute(attribute) => {
                let (kind, count) = attribute.ty.kind();
                let rows = if attribute.slopes { 3 } else { 1 };
                let slopes = if kind == Float { Slopes::Given } else { Slopes::None };
                let gives = smallvec![(Int, 1), (kind, count.saturating_mul(rows))];
                let takes = if attribute.indexed { smallvec![(String, 2), (Int, 1)] } else { smallvec![(String, 2)] };
                Declaration { slopes, reach: Reach::Lane, ..pure(takes, gives) }
            }
            Routine::Texture(call) => {
                let values = (call.channels + 1) * if call.slopes { 3 } else { 1 };
                let takes = smallvec![(String, 1), (Float, call.coordinates() + 9), (Int, 3), (String, 5)];
                let gives = smallvec![(Float, values), (Int, 1), (String, 1)];
                Declaration { slopes: Slopes::Given, reach: Reach::Lane, ..pure(takes, gives) }
            }
            Routine::TextureInfo(ty) => {
                let takes = smallvec![(String, 2), (Float, 2)];
                Declaration { reach: Reach::Lane, ..pure(takes, smallvec![(Int, 1), ty.kind()]) }
            }
            Routine::SetMessage(_) | Routine::GetMessage(_) | Routine::Random(_) | Routine::Trace => {
                self.state_declaration()
            }
            Routine::DictFind | Routine::DictFindBelow | Routine::DictNext | Routine::DictValue(_) => {
                self.state_declaration()
            }
        }
    }

    /// The same for those that depend on what was called before in the lane.
    fn state_declaration(&self) -> Declaration {
        use Kind::{Float, Int, String};
        let (takes, gives): (Kinds, Kinds) = match self {
            Routine::SetMessage(shape) => (smallvec![(String, 1), (shape.kind, shape.count)], Kinds::new()),
            Routine::GetMessage(shape) => (smallvec![(String, 1)], smallvec![(Int, 1), (shape.kind, shape.count)]),
            Routine::Random(count) => (Kinds::new(), smallvec![(Float, *count)]),
            Routine::Trace => (smallvec![(Float, 8)], smallvec![(Int, 1)]),
            Routine::DictFindBelow => (smallvec![(Int, 1), (String, 1)], smallvec![(Int, 1)]),
            Routine::DictNext => (smallvec![(Int, 1)], smallvec![(Int, 1)]),
            Routine::DictValue(ty) => (smallvec![(Int, 1), (String, 1)], smallvec![(Int, 1), ty.kind()]),
            Routine::DictFind => (smallvec![(String, 2)], smallvec![(Int, 1)]),
            other => unreachable!("`{}` has a declaration of its own", other.name()),
        };
        Declaration { takes, gives, slopes: Slopes::None, effect: Effect::Changes, reach: Reach::Lane }
    }

    /// Is there such a routine? Not every number that a variant can carry makes one.
    pub fn exists(&self) -> bool {
        match self {
            Routine::Noise(noise) => noise.exists(),
            Routine::HashFloats(count) => (1..=4).contains(count),
            Routine::ClampIndex { len, .. } => (1..=i32::MAX as u32).contains(len),
            Routine::Attribute(attribute) => !attribute.slopes || matches!(attribute.ty, AttributeType::Floats(_)),
            Routine::Smooth(_) | Routine::Slope(_) | Routine::SpaceMatrix | Routine::HashInt => true,
            Routine::CheckFinite(watch) => watch.count > 0,
            Routine::HashString | Routine::Strlen | Routine::GetChar | Routine::StartsWith => true,
            Routine::EndsWith | Routine::Substr | Routine::Concat | Routine::Stof | Routine::Stoi => true,
            Routine::Regex { .. } | Routine::Split(_) | Routine::Format(_) | Routine::Print(..) => true,
            Routine::RayType | Routine::SetMessage(_) | Routine::GetMessage(_) | Routine::Trace => true,
            Routine::DictFind | Routine::DictFindBelow | Routine::DictNext | Routine::DictValue(_) => true,
            Routine::Random(count) => (1..=3).contains(count),
            Routine::Texture(call) => matches!(call.channels, 1 | 3),
            Routine::TextureInfo(_) => true,
        }
    }

    /// Its name in listings.
    pub fn name(&self) -> &'static str {
        match self {
            Routine::Noise(_) => "noise",
            Routine::Smooth(function) => function.name(),
            Routine::Slope(function) => function.slope_name(),
            Routine::SpaceMatrix => "space_matrix",
            Routine::ClampIndex { .. } => "clamp_index",
            Routine::CheckFinite(_) => "check_finite",
            Routine::HashInt => "hash_int",
            Routine::HashFloats(_) => "hash_floats",
            Routine::HashString => "hash_string",
            Routine::Strlen => "strlen",
            Routine::GetChar => "get_char",
            Routine::StartsWith => "starts_with",
            Routine::EndsWith => "ends_with",
            Routine::Substr => "substr",
            Routine::Concat => "concat",
            Routine::Stof => "stof",
            Routine::Stoi => "stoi",
            Routine::Regex { whole: false, .. } => "regex_search",
            Routine::Regex { whole: true, .. } => "regex_match",
            Routine::Split(_) => "split",
            Routine::Format(_) => "format",
            Routine::Print(..) => "print",
            Routine::RayType => "ray_type",
            Routine::Attribute(_) => "attribute",
            Routine::SetMessage(_) => "set_message",
            Routine::GetMessage(_) => "get_message",
            Routine::Random(_) => "random",
            Routine::Trace => "trace",
            Routine::DictFind => "dict_find",
            Routine::DictFindBelow => "dict_find_below",
            Routine::DictNext => "dict_next",
            Routine::DictValue(_) => "dict_value",
            Routine::Texture(_) => "texture",
            Routine::TextureInfo(_) => "texture_info",
        }
    }
}

impl Smooth {
    /// The kinds of its sources.
    fn takes(self) -> Kinds {
        use Kind::{Float, Int, String};
        match self {
            Smooth::Spline(knots) | Smooth::SplineInverse(knots) => {
                smallvec![(String, 1), (Float, 1), (Int, 1), (Float, knots)]
            }
            Smooth::MatrixInverse | Smooth::Determinant => smallvec![(Float, 16)],
            Smooth::Blackbody | Smooth::WavelengthColor => smallvec![(Float, 1)],
            Smooth::TransformColor => smallvec![(String, 2), (Float, 3)],
            Smooth::TransformUnit => smallvec![(String, 2), (Float, 1)],
        }
    }

    /// The kinds of its results.
    fn gives(self) -> Kinds {
        let count = match self {
            Smooth::Spline(_) | Smooth::SplineInverse(_) | Smooth::Determinant | Smooth::TransformUnit => 1,
            Smooth::Blackbody | Smooth::WavelengthColor | Smooth::TransformColor => 3,
            Smooth::MatrixInverse => 16,
        };
        smallvec![(Kind::Float, count)]
    }

    fn name(self) -> &'static str {
        match self {
            Smooth::Spline(_) => "spline",
            Smooth::SplineInverse(_) => "spline_inverse",
            Smooth::MatrixInverse => "matrix_inverse",
            Smooth::Determinant => "determinant",
            Smooth::Blackbody => "blackbody",
            Smooth::WavelengthColor => "wavelength_color",
            Smooth::TransformColor => "transform_color",
            Smooth::TransformUnit => "transform_unit",
        }
    }

    fn slope_name(self) -> &'static str {
        match self {
            Smooth::Spline(_) => "spline_slope",
            Smooth::SplineInverse(_) => "spline_inverse_slope",
            Smooth::MatrixInverse => "matrix_inverse_slope",
            Smooth::Determinant => "determinant_slope",
            Smooth::Blackbody => "blackbody_slope",
            Smooth::WavelengthColor => "wavelength_color_slope",
            Smooth::TransformColor => "transform_color_slope",
            Smooth::TransformUnit => "transform_unit_slope",
        }
    }
}

impl TextArg {
    /// The kind of its registers and how many there are.
    pub fn kind(self) -> (Kind, u32) {
        match self {
            TextArg::Ints(count) => (Kind::Int, count),
            TextArg::Floats(count) => (Kind::Float, count),
            TextArg::Strings(count) => (Kind::String, count),
            TextArg::Closure => (Kind::Closure, 1),
        }
    }
}

impl TextFormat {
    /// The kinds of the registers that follow the format.
    fn takes(&self) -> impl Iterator<Item = (Kind, u32)> + '_ {
        let format = self.computed.then_some((Kind::String, 1));
        format.into_iter().chain(self.args.iter().map(|arg| arg.kind()))
    }
}
