//! Declarations of closures: names, parameters, documentation and promises, without what they do.
//!
//! The checker takes signatures from a [`ClosureTable`], the tree printer names and argument order, and `velour info` and
//! `velour verify` the documentation. What a closure scatters is declared in the same place as its spec, one file a family:
//! see [`crate::closure::ClosureDef`].

/// The type of a closure parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParamKind {
    /// One float.
    Float,
    /// One integer.
    Int,
    /// A color.
    Color,
    /// A vector.
    Vector,
    /// A normal.
    Normal,
    /// A string.
    String,
    /// A nested closure.
    Closure,
}

/// The integers that mean something to a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Numbered {
    /// The least of them.
    pub least: i32,
    /// The greatest.
    pub most: i32,
    /// What each stands for, for a message.
    pub meaning: &'static str,
}

/// A parameter of a closure, positional or by keyword.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamSpec {
    /// Its name; for a keyword parameter also the token written in the shader.
    pub name: &'static str,
    /// Its type.
    pub kind: ParamKind,
    /// What it means, with unit and range.
    pub doc: &'static str,
    /// The strings it may be, the default first, where only some mean something; empty for any value.
    pub choices: Vec<&'static str>,
    /// The values that `velour verify` tries (of every component of a color), the usual one first; empty when it decides
    /// nothing that could be verified, and for normals and directions.
    pub sweep: &'static [f32],
    /// For what velour does not model: the value that asks for nothing, and what is left out at any other.
    pub left_out: Option<(f32, &'static str)>,
    /// For an integer that stands for a way: those there are.
    pub numbered: Option<Numbered>,
}

impl ParamSpec {
    /// A parameter with this documentation (meaning, unit, range); its place in a declaration gives name and type.
    pub const fn about(doc: &'static str) -> Self {
        ParamSpec {
            name: "",
            kind: ParamKind::Float,
            doc,
            choices: Vec::new(),
            sweep: &[],
            left_out: None,
            numbered: None,
        }
    }

    /// The same parameter with the values that `velour verify` tries, the usual one first.
    pub const fn tried(mut self, sweep: &'static [f32]) -> Self {
        self.sweep = sweep;
        self
    }

    /// The same parameter, taken and not modelled: every value but this one earns a warning that names what is left out.
    pub const fn left_out(mut self, value: f32, what: &'static str) -> Self {
        self.left_out = Some((value, what));
        self
    }

    /// The same parameter as an integer of a few meanings; another literal is an error with the text of `meaning`.
    pub const fn numbered(mut self, least: i32, most: i32, meaning: &'static str) -> Self {
        self.numbered = Some(Numbered { least, most, meaning });
        self
    }
}

/// What a scattering model may promise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Claim {
    /// It never reflects more than arrives: the directional albedo is at most 1.
    Energy,
    /// f of two directions on one side is the same when they are exchanged.
    Reciprocity,
}

/// A promise that a closure does not make: always, or where a parameter has a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waiver {
    /// The promise.
    pub claim: Claim,
    /// The parameter or keyword with the value (a number or a word) that spoils it; none: it is never promised.
    pub only: Option<(&'static str, &'static str)>,
    /// Why, with the figure.
    pub why: &'static str,
}

/// How the albedo of a closure is found where it lies on top of something.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TopAlbedo {
    /// By a formula that costs next to nothing, or never.
    #[default]
    Formula,
    /// By a polynomial of the sheen's albedo.
    Sheen,
    /// By a table of the rough facets' albedo.
    Facets,
    /// By Fresnel's term of the boundary.
    Boundary,
}

/// The declaration of one closure.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosureSpec {
    /// The name in the language.
    pub name: &'static str,
    /// The positional parameters.
    pub params: Vec<ParamSpec>,
    /// The keyword parameters: optional `"name", value` pairs after the positional ones.
    pub keywords: Vec<ParamSpec>,
    /// One line of documentation.
    pub doc: &'static str,
    /// What it is, in lines of plain text; empty where nobody has said it.
    pub formula: &'static str,
    /// Where that is from: author, year, equation.
    pub source: &'static str,
    /// The promises it does not make.
    pub waivers: &'static [Waiver],
    /// True when its albedo is 1 for white parameters: it loses nothing.
    pub lossless: bool,
    /// True when its weight is radiance.
    pub emits: bool,
    /// True when its weight is a hole in the alpha channel.
    pub holds_out: bool,
    /// False when it has no lobes at all.
    pub scatters: bool,
    /// True when light may pass straight on, so that shadow rays must ask what its surfaces let through.
    pub passes: bool,
    /// How its albedo is found as the top of a layer.
    pub top_albedo: TopAlbedo,
}

impl ClosureSpec {
    /// A closure that scatters and promises what every material promises.
    pub fn new(name: &'static str, doc: &'static str, params: Vec<ParamSpec>, keywords: Vec<ParamSpec>) -> Self {
        ClosureSpec {
            name,
            params,
            keywords,
            doc,
            formula: "",
            source: "",
            waivers: &[],
            lossless: false,
            emits: false,
            holds_out: false,
            scatters: true,
            passes: false,
            top_albedo: TopAlbedo::Formula,
        }
    }

    /// Does it lay something over closures, or take them up in another way? It does when it has a closure parameter.
    pub fn nests(&self) -> bool {
        self.params.iter().any(|param| param.kind == ParamKind::Closure)
    }

    /// Can one of the closures it nests be what covers another? It can when there are several.
    pub fn nests_a_top(&self) -> bool {
        self.params.iter().filter(|param| param.kind == ParamKind::Closure).count() > 1
    }
}

/// All closures a compilation knows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClosureTable {
    /// The declarations; a [`ClosureId`] is an index into them.
    pub specs: Vec<ClosureSpec>,
}

/// Index of a closure in its table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClosureId(pub u32);

impl ClosureTable {
    /// The declaration of a closure.
    pub fn get(&self, id: ClosureId) -> &ClosureSpec {
        &self.specs[id.0 as usize]
    }

    /// All closures of a name (overloads stand side by side).
    pub fn named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = (ClosureId, &'a ClosureSpec)> + 'a {
        let ids = self.specs.iter().enumerate().map(|(i, spec)| (ClosureId(i as u32), spec));
        ids.filter(move |(_, spec)| spec.name == name)
    }
}
