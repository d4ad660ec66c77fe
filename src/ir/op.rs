//! The operations of a program. Every one works on single numbers: a triple is three registers, a matrix sixteen.

use crate::lang::globals::Global;

/// Float to float.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is the function of its name in `ops`")]
pub enum Unary {
    Neg,
    Abs,
    Sqrt,
    InverseSqrt,
    Cbrt,
    Exp,
    Exp2,
    Expm1,
    Log,
    Log2,
    Log10,
    Logb,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Erf,
    Erfc,
    Floor,
    Ceil,
    Round,
    Trunc,
    Sign,
}

/// Two floats to a float.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is the function of its name in `ops`")]
pub enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Mod,
    Pow,
    Atan2,
    Min,
    Max,
    Step,
}

/// Two operations in one: `t = a first b`, then `t second c`. The result is rounded after each, as if they were apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Pair {
    /// Makes `t` of `a` and `b`.
    pub first: Binary,
    /// Makes the result of `t` and `c`.
    pub second: Binary,
    /// True for `c second t`.
    pub swapped: bool,
}

impl Pair {
    /// The operations that may come first.
    pub const FIRST: [Binary; 4] = [Binary::Add, Binary::Sub, Binary::Mul, Binary::Div];
    /// The operations that may come second.
    pub const SECOND: [Binary; 6] = [Binary::Add, Binary::Sub, Binary::Mul, Binary::Div, Binary::Min, Binary::Max];

    /// Is it one of the pairs that run as one loop over lanes? Sums and products are the same either way, and have one for both.
    pub fn has_loop(self) -> bool {
        let either = matches!(self.second, Binary::Add | Binary::Mul);
        Pair::FIRST.contains(&self.first) && Pair::SECOND.contains(&self.second) && !(self.swapped && either)
    }
}

/// Two floats to an int, 1 for true.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is the comparison of its name")]
pub enum Compare {
    Lt,
    Le,
    Gt,
    Ge,
    Eq,
    Ne,
}

/// Int to int.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is the function of its name")]
pub enum IntUnary {
    Neg,
    Abs,
    BitNot,
    /// 1 for 0, else 0.
    Not,
}

/// Two ints (or symbols) to an int.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "each is the function of its name")]
pub enum IntBinary {
    Add,
    Sub,
    Mul,
    Div,
    Mod,
    Shl,
    Shr,
    BitAnd,
    BitOr,
    BitXor,
    Min,
    Max,
    Lt,
    Le,
    Gt,
    Ge,
    Eq,
    Ne,
    /// 1 when both are not zero.
    And,
    /// 1 when one is not zero.
    Or,
}

/// What a float is tested for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Test {
    /// Is it not a number?
    Nan,
    /// Is it infinite?
    Inf,
    /// Is it neither?
    Finite,
}

/// The kinds of noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NoiseKind {
    /// Perlin's gradient noise, -1..1.
    Perlin,
    /// The same, 0..1.
    UPerlin,
    /// Simplex noise, -1..1.
    Simplex,
    /// The same, 0..1.
    USimplex,
    /// One random number a unit cell.
    Cell,
    /// One random number a point.
    Hash,
}

impl NoiseKind {
    /// All kinds.
    pub const ALL: &[NoiseKind] = {
        use NoiseKind::*;
        &[Perlin, UPerlin, Simplex, USimplex, Cell, Hash]
    };

    /// The names that `noise` and `pnoise` know it by.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            NoiseKind::Perlin => &["perlin", "snoise"],
            NoiseKind::UPerlin => &["uperlin", "noise"],
            NoiseKind::Simplex => &["simplex"],
            NoiseKind::USimplex => &["usimplex"],
            NoiseKind::Cell => &["cell"],
            NoiseKind::Hash => &["hash"],
        }
    }

    /// The kind of a name.
    pub fn from_name(name: &str) -> Option<NoiseKind> {
        NoiseKind::ALL.iter().copied().find(|kind| kind.names().contains(&name))
    }

    /// Is there a periodic form of it?
    pub fn repeats(self) -> bool {
        !matches!(self, NoiseKind::Simplex | NoiseKind::USimplex)
    }
}

/// A noise function: its kind, its shape, and whether it repeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Noise {
    /// The kind.
    pub kind: NoiseKind,
    /// How many coordinates it takes: 1 to 4. Periods, when it repeats, follow the coordinates.
    pub dims: u8,
    /// How many numbers it gives: 1 or 3.
    pub outputs: u8,
    /// True when it repeats.
    pub periodic: bool,
    /// True when the partial derivatives follow the values, coordinate by coordinate.
    pub gradient: bool,
}

/// Work that is more than one arithmetic step. Sources and results are lists of registers.
#[derive(Clone, Debug, PartialEq)]
pub enum Routine {
    /// Noise.
    Noise(Noise),
    /// `spline`: basis symbol, x, how many knots count, then knots of one component; gives the value, and its slope in x.
    Spline,
    /// `splineinverse`: basis symbol, value, knots; gives the place, and its slope in the value.
    SplineInverse,
    /// Inverse of a matrix: 16 to 16.
    MatrixInverse,
    /// Determinant of a matrix.
    Determinant,
    /// The matrix from one named space to another: two symbols to 16 and an int that is 1 when both are known.
    SpaceMatrix,
    /// The number of a component, kept inside `0..n`; one that is outside is reported.
    ClampIndex(u32),
    /// `blackbody`
    Blackbody,
    /// `wavelength_color`
    WavelengthColor,
    /// `transformc`: from, to, color.
    TransformColor,
    /// The change of `transformc`: from, to, color, its change.
    TransformColorSlope,
    /// `transformu`: from, to, length.
    TransformUnit,
    /// `hash` of an int.
    HashInt,
    /// `hash` of 1 to 4 floats.
    HashFloats,
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
    /// `regex_search` (false) or `regex_match` (true), with as many positions as there are further results.
    Regex(bool),
    /// `split`: text, separators, most; gives the count, then the parts.
    Split,
    /// `format` to a symbol.
    Format(TextFormat),
    /// Writes text.
    Print(PrintTo, TextFormat),
    /// Does the ray have this type? Symbol to int.
    RayType,
    /// A named attribute of the renderer: symbols of object and name to an int and the values.
    Attribute(AttributeType),
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
}

/// A format string and how the sources that follow group into its arguments.
#[derive(Clone, Debug, PartialEq)]
pub struct TextFormat {
    /// The format.
    pub text: String,
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

/// What a shading point gives besides the globals of the language, and the derivatives of those.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Input {
    /// A component of a shader global.
    Global(Global, u8),
    /// Its derivative along the screen's x.
    GlobalDx(Global, u8),
    /// Its derivative along the screen's y.
    GlobalDy(Global, u8),
    /// `surfacearea()`
    SurfaceArea,
    /// `backfacing()`
    Backfacing,
}
