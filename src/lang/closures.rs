//! The closure table: every closure is declared here once, and all other rooms read it.
//!
//! The checker takes signatures from it, the tree printer names and argument order, the flattener the model, and
//! `velour info` the documentation. A host adds its own closures to a copy of [`ClosureTable::standard`].

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
}

/// Which built-in scattering model a closure stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Model {
    /// `emission()`
    Emission,
    /// `background()`
    Background,
    /// `diffuse(N)`
    Diffuse,
    /// `oren_nayar(N, sigma)`
    OrenNayar,
    /// `ashikhmin_velvet(N, sigma)`
    Velvet,
    /// `translucent(N)`
    Translucent,
    /// `transparent()`
    Transparent,
    /// `reflection(N, eta)`
    Reflection,
    /// `refraction(N, eta)`
    Refraction,
    /// `microfacet(distribution, N, U, xalpha, yalpha, eta, refract)`
    Microfacet,
    /// `holdout()`
    Holdout,
    /// `debug(tag)`
    Debug,
    /// `sheen(base, N, tint, roughness)`
    Sheen,
    /// `sheen_bsdf(N, albedo, roughness)`
    SheenBsdf,
    /// `layer(top, base)`
    Layer,
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
    ParamSpec { name, kind, doc, choices: &[] }
}

const fn choice(name: &'static str, choices: &'static [&'static str], doc: &'static str) -> ParamSpec {
    ParamSpec { name, kind: ParamKind::String, doc, choices }
}

const NORMAL: ParamSpec = param("N", ParamKind::Normal, "shading normal, unit length");
const TANGENT: ParamSpec = param("U", ParamKind::Vector, "direction of xalpha; zero for any");
const ETA: ParamSpec = param("eta", ParamKind::Float, "index of refraction inside over outside, > 0");
const SHEEN_ROUGHNESS: ParamSpec = param("roughness", ParamKind::Float, "Charlie roughness r, clamped to 0.01..1");
const LAYERING: ParamSpec = choice(
    "layering",
    &["min", "view", "kelemen"],
    "how the base is scaled: \"min\" (default), \"view\" or \"kelemen\"",
);
const SHADOWING: ParamSpec = choice(
    "shadowing",
    &["exact", "published", "ashikhmin"],
    "shadowing term: \"exact\" (default), \"published\" (fit of the paper) or \"ashikhmin\" (real-time visibility)",
);
const SOFTENING: ParamSpec =
    param("softening", ParamKind::Int, "1 (default) softens the terminator by eq. 4, 0 does not");
const MODE: ParamSpec = param("mode", ParamKind::Int, "0: this model (the default); other values are not run");

/// Closures of the OSL header that velour has no scattering model for; a call is an error that names it.
pub const NOT_YET: &[&str] = &[
    "phong",
    "ward",
    "subsurface",
    "oren_nayar_diffuse_bsdf",
    "burley_diffuse_bsdf",
    "dielectric_bsdf",
    "conductor_bsdf",
    "generalized_schlick_bsdf",
    "translucent_bsdf",
    "transparent_bsdf",
    "subsurface_bssrdf",
    "chiang_hair_bsdf",
    "uniform_edf",
    "anisotropic_vdf",
    "medium_vdf",
];

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
    ClosureSpec { name, model, params: params.to_vec(), keywords, doc }
}

fn standard_specs() -> Vec<ClosureSpec> {
    let mut specs = plain_specs();
    specs.extend(cloth_specs());
    specs
}

/// The closures that OSL has had from the start.
fn plain_specs() -> Vec<ClosureSpec> {
    use ParamKind::*;
    let microfacet = [
        choice(
            "distribution",
            &["ggx", "beckmann", "default", "sharp", ""],
            "\"ggx\", \"beckmann\" or \"default\" (ggx)",
        ),
        NORMAL,
        TANGENT,
        param("xalpha", Float, "GGX width along U, 0..1; 0 is a mirror"),
        param("yalpha", Float, "GGX width across U, 0..1"),
        ETA,
        param("refract", Int, "0 reflects, 1 refracts, 2 does both"),
    ];
    vec![
        spec(
            "emission",
            Model::Emission,
            &[],
            &[],
            "emits its weight as radiance, both sides of the normal's hemisphere",
        ),
        spec("background", Model::Background, &[], &[], "radiance of the sky"),
        spec("diffuse", Model::Diffuse, &[NORMAL], &[], "Lambert's reflection"),
        spec(
            "oren_nayar",
            Model::OrenNayar,
            &[NORMAL, param("sigma", Float, "standard deviation of the facet slope, radians, >= 0")],
            &[],
            "rough diffuse reflection of Oren and Nayar 1994",
        ),
        spec(
            "ashikhmin_velvet",
            Model::Velvet,
            &[NORMAL, param("sigma", Float, "width of the inverted Gaussian, clamped to 0.06..1")],
            &[],
            "velvet of Ashikhmin and Premoze 2007, to compare sheen with",
        ),
        spec("translucent", Model::Translucent, &[NORMAL], &[], "Lambert's transmission"),
        spec("transparent", Model::Transparent, &[], &[], "lets light pass straight through"),
        spec(
            "reflection",
            Model::Reflection,
            &[NORMAL, ETA],
            &[],
            "mirror with dielectric Fresnel; eta 0 reflects all",
        ),
        spec("refraction", Model::Refraction, &[NORMAL, ETA], &[], "smooth refraction with dielectric Fresnel"),
        spec("microfacet", Model::Microfacet, &microfacet, &[], "rough dielectric reflection and refraction"),
        spec("holdout", Model::Holdout, &[], &[], "a hole in the alpha channel"),
        spec(
            "debug",
            Model::Debug,
            &[param("tag", String, "name of the output")],
            &[],
            "a tagged value; scatters nothing",
        ),
    ]
}

/// Sheen, and the layering it needs.
fn cloth_specs() -> Vec<ClosureSpec> {
    use ParamKind::*;
    let sheen_tint =
        param("tint", Color, "color of the sheen; its largest component scales the albedo taken from the base");
    vec![
        spec(
            "sheen",
            Model::Sheen,
            &[param("base", Closure, "what lies under the sheen"), NORMAL, sheen_tint, SHEEN_ROUGHNESS],
            &[SHADOWING, SOFTENING, LAYERING],
            "cloth sheen laid over any closure (Estevez and Kulla 2017)",
        ),
        spec(
            "sheen_bsdf",
            Model::SheenBsdf,
            &[NORMAL, param("albedo", Color, "color of the sheen"), SHEEN_ROUGHNESS],
            &[SHADOWING, SOFTENING, MODE],
            "the sheen lobe alone, to be laid over a base by layer()",
        ),
        spec(
            "layer",
            Model::Layer,
            &[param("top", Closure, "the layer on top"), param("base", Closure, "what lies under it")],
            &[LAYERING],
            "lays one closure over another by albedo scaling",
        ),
    ]
}
