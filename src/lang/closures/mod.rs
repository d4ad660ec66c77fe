//! The closure table: every closure is declared in this folder once, and all other rooms read it.
//!
//! The checker takes signatures from it, the tree printer names and argument order, the flattener the model, and
//! `velour info` the documentation. A host adds its own closures to a copy of [`ClosureTable::standard`].

mod boundaries;
mod classic;
mod cloth;
mod historic;
mod materialx;

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

/// A parameter of a closure, positional or by keyword.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamSpec {
    /// Its name; for a keyword parameter also the token written in the shader.
    pub name: &'static str,
    /// Its type.
    pub kind: ParamKind,
    /// What it means, with unit and range.
    pub doc: &'static str,
    /// The strings it may be, where only some mean something; empty for any value.
    pub choices: &'static [&'static str],
    /// The values that `velour verify` tries (of every component of a color), the usual one first; empty when it decides
    /// nothing that could be verified, and for normals and directions.
    pub sweep: &'static [f32],
    /// For what velour does not model: the value that asks for nothing, and what is left out at any other.
    pub left_out: Option<(f32, &'static str)>,
}

impl ParamSpec {
    /// The same parameter with the values that `velour verify` tries.
    const fn tried(mut self, sweep: &'static [f32]) -> Self {
        self.sweep = sweep;
        self
    }

    /// The same parameter, taken and not modelled: every value but this one earns a warning that names what is left out.
    const fn left_out(mut self, value: f32, what: &'static str) -> Self {
        self.left_out = Some((value, what));
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

/// Which built-in scattering model a closure stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Model {
    /// `emission()`, `uniform_edf(emittance)`
    Emission,
    /// `background()`
    Background,
    /// `diffuse(N)`, `subsurface_bssrdf(N, albedo, radius, anisotropy)`
    Diffuse,
    /// `oren_nayar(N, sigma)`
    OrenNayar,
    /// `ashikhmin_velvet(N, sigma)`
    Velvet,
    /// `translucent(N)`, `translucent_bsdf(N, albedo)`
    Translucent,
    /// `transparent()`, `transparent_bsdf()`
    Transparent,
    /// `reflection(N, eta)`
    Reflection,
    /// `refraction(N, eta)`
    Refraction,
    /// `microfacet(distribution, N, U, xalpha, yalpha, eta, refract)`
    Microfacet,
    /// `dielectric_bsdf(N, U, reflection_tint, transmission_tint, roughness_x, roughness_y, ior, distribution)`
    DielectricBsdf,
    /// `conductor_bsdf(N, U, roughness_x, roughness_y, ior, extinction, distribution)`
    ConductorBsdf,
    /// `generalized_schlick_bsdf(N, U, reflection_tint, transmission_tint, roughness_x, roughness_y, f0, f90, exponent, distribution)`
    GeneralizedSchlickBsdf,
    /// `holdout()`
    Holdout,
    /// `debug(tag)`
    Debug,
    /// `sheen(base, N, tint, roughness)`
    Sheen,
    /// `sheen_bsdf(N, albedo, roughness)`
    SheenBsdf,
    /// `oren_nayar_diffuse_bsdf(N, albedo, roughness)`
    OrenNayarDiffuse,
    /// `burley_diffuse_bsdf(N, albedo, roughness)`
    BurleyDiffuse,
    /// `chiang_hair_bsdf(N, curve_direction, …)`
    Hair,
    /// `phong(N, exponent)`
    Phong,
    /// `ward(N, T, ax, ay)`
    Ward,
    /// `ashikhmin_shirley(N, U, exponent_x, exponent_y, specular, diffuse)`
    AshikhminShirley,
    /// `lafortune(N, U, coefficients, exponent)`
    Lafortune,
    /// `subsurface(eta, g, mfp, albedo)`
    Subsurface,
    /// `layer(top, base)`
    Layer,
    /// `coat(base, N, roughness, eta, absorption, thickness)`
    Coat,
    /// A closure of the host, numbered by the host; velour carries it in trees and gives it no meaning.
    Host(u32),
}

/// The declaration of one closure.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosureSpec {
    /// The name in the language.
    pub name: &'static str,
    /// What it scatters like.
    pub model: Model,
    /// The positional parameters.
    pub params: Vec<ParamSpec>,
    /// The keyword parameters: optional `"name", value` pairs after the positional ones.
    pub keywords: Vec<ParamSpec>,
    /// One line of documentation.
    pub doc: &'static str,
    /// The promises it does not make.
    pub waivers: &'static [Waiver],
    /// True when its albedo is 1 for white parameters: it loses nothing.
    pub lossless: bool,
}

impl ClosureSpec {
    /// Does it lay something over closures, or take them up in another way? It does when it has a closure parameter.
    pub fn nests(&self) -> bool {
        self.params.iter().any(|param| param.kind == ParamKind::Closure)
    }

    /// The same closure without some promises.
    fn without(mut self, waivers: &'static [Waiver]) -> Self {
        self.waivers = waivers;
        self
    }

    /// The same closure, promising to lose nothing.
    fn lossless(mut self) -> Self {
        self.lossless = true;
        self
    }
}

/// All closures a compilation knows.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosureTable {
    /// The declarations; a [`ClosureId`] is an index into them.
    pub specs: Vec<ClosureSpec>,
}

/// Index of a closure in its table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClosureId(pub u32);

impl ClosureTable {
    /// The closures velour renders.
    pub fn standard() -> Self {
        ClosureTable { specs: standard_specs() }
    }

    /// The declaration of a closure.
    pub fn get(&self, id: ClosureId) -> &ClosureSpec {
        &self.specs[id.0 as usize]
    }

    /// All closures of a name (overloads stand side by side).
    pub fn named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = (ClosureId, &'a ClosureSpec)> + 'a {
        let ids = self.specs.iter().enumerate().map(|(i, spec)| (ClosureId(i as u32), spec));
        ids.filter(move |(_, spec)| spec.name == name)
    }

    /// Adds a closure of the host and gives its id.
    pub fn register(&mut self, spec: ClosureSpec) -> ClosureId {
        self.specs.push(spec);
        ClosureId(self.specs.len() as u32 - 1)
    }
}

const fn param(name: &'static str, kind: ParamKind, doc: &'static str) -> ParamSpec {
    ParamSpec { name, kind, doc, choices: &[], sweep: &[], left_out: None }
}

const fn choice(name: &'static str, choices: &'static [&'static str], doc: &'static str) -> ParamSpec {
    ParamSpec { name, kind: ParamKind::String, doc, choices, sweep: &[], left_out: None }
}

const NORMAL: ParamSpec = param("N", ParamKind::Normal, "shading normal, unit length");
const TANGENT: ParamSpec = param("U", ParamKind::Vector, "direction of xalpha; zero for any");
const ETA: ParamSpec =
    param("eta", ParamKind::Float, "index of refraction inside over outside, > 0").tried(&[1.5, 1.05, 0.7, 2.5, 0.0]);

/// Closures of the OSL header that velour has no scattering model for; a call is an error that names it.
pub const NOT_YET: &[&str] = &["anisotropic_vdf", "medium_vdf"];

const LABEL: ParamSpec =
    param("label", ParamKind::String, "a name for the host; velour carries it and gives it no meaning");

fn spec(
    name: &'static str,
    model: Model,
    params: &[ParamSpec],
    keywords: &[ParamSpec],
    doc: &'static str,
) -> ClosureSpec {
    // Every closure takes a label, after the keywords that its model reads.
    let keywords = keywords.iter().cloned().chain([LABEL]).collect();
    ClosureSpec { name, model, params: params.to_vec(), keywords, doc, waivers: &[], lossless: false }
}

fn standard_specs() -> Vec<ClosureSpec> {
    let mut specs = classic::specs();
    specs.extend(boundaries::specs());
    specs.extend(cloth::specs());
    specs.extend(historic::specs());
    specs.extend(materialx::specs());
    specs
}
