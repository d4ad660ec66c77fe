//! A host with a closure of its own: the model of Minnaert, which darkens toward the rim like the moon seen through dust.

use std::f32::consts::TAU;
use velour::bsdf::{Eval, Params, Scatter, Spread, View};
use velour::closure::{Argument, Layering, LeafMaker, LobeRequest};
use velour::closure::{ClosureDef, Color, Float, Library, LobeKind, Nested, Normal, RegisterError, Word};
use velour::glam::Vec3;
use velour::lang::closures::{Claim, ParamSpec, TopAlbedo, Waiver};

/// f = (k + 1) / (2 pi) (ci co)^(k - 1).
///
/// Source: Minnaert 1941, normalised to keep energy. Domain: k 1..20; 1 is Lambert's law. Gives: f cos in 1/sr, reciprocal.
/// Albedo: exact, co^(k - 1).
#[derive(Clone, Copy, Debug)]
pub struct Minnaert {
    k: f32,
}

impl Scatter for Minnaert {
    const PARAMS: usize = 1;
    const SPREAD: Spread = Spread::Even;
    const VIEW: usize = 1;

    fn prepare([k, ..]: Params) -> Self {
        Minnaert { k: k.clamp(1.0, 20.0) }
    }

    fn view(&self, wo: Vec3) -> View {
        [self.albedo(wo.z), 0.0, 0.0, 0.0, 0.0]
    }

    fn eval_from(&self, _wo: Vec3, [albedo, ..]: View, wi: Vec3) -> Eval {
        let pdf = if wi.z > 0.0 { (self.k + 1.0) / TAU * wi.z.powf(self.k) } else { 0.0 };
        Eval { f_cos: albedo * pdf, pdf }
    }

    fn sample_from(&self, _wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        let z = (1.0 - xi.x).powf(1.0 / (self.k + 1.0)).min(1.0);
        let r = ((1.0 - z) * (1.0 + z)).sqrt();
        let (sin, cos) = (TAU * xi.y).sin_cos();
        Vec3::new(r * cos, r * sin, z)
    }

    fn albedo(&self, cos: f32) -> f32 {
        cos.clamp(0.0, 1.0).powf(self.k - 1.0)
    }
}

velour::arguments! {
    /// The arguments of `minnaert`.
    pub struct MinnaertArguments {
        N: Normal = ParamSpec::about("shading normal, unit length"),
        albedo: Color = ParamSpec::about("color of the reflection, 0..1"),
        k: Float = ParamSpec::about("how dark the rim is, 1 (not at all) to 20").tried(&[1.5, 1.0, 3.0, 20.0]),
    }
}

/// `minnaert(N, albedo, k)`.
pub fn minnaert() -> ClosureDef {
    ClosureDef::new("minnaert", "darkens toward the rim (Minnaert 1941)", |a: MinnaertArguments, leaf| {
        leaf.tint(a.albedo);
        let frame = leaf.frame(a.N, None);
        leaf.lobe(LobeKind::of::<Minnaert>(), frame, &[a.k.0]);
    })
}

velour::arguments! {
    /// The arguments of `dusted`.
    pub struct DustedArguments {
        base: Nested = ParamSpec::about("what lies under the dust"),
        N: Normal = ParamSpec::about("shading normal, unit length"),
        dust: Color = ParamSpec::about("color of the dust, 0..1"),
        k: Float = ParamSpec::about("how dark the dust's rim is, 1 to 20").tried(&[3.0, 1.5]),
    }
    keywords {
        layering: Word<Layering> = ParamSpec::about("how the base is scaled"),
    }
}

/// `dusted(base, N, dust, k)`: a closure that nests.
pub fn dusted() -> ClosureDef {
    ClosureDef::new("dusted", "a layer of dust over any closure", |a: DustedArguments, leaf| {
        leaf.tint(a.dust);
        leaf.nest(a.base);
        let frame = leaf.frame(a.N, None);
        let rule = |leaf: &LeafMaker<'_>, lane: usize| {
            let rule = leaf.word(&a.layering, lane).unwrap_or(leaf.settings().layering);
            Layering::ALL.iter().position(|(_, known)| *known == rule)
        };
        for (rule, gate) in leaf.variants(a.layering.varies(), rule) {
            let lobe = LobeRequest::new(LobeKind::of::<Minnaert>(), frame, std::slice::from_ref(&a.k.0));
            let part = leaf.add(LobeRequest { gate, ..lobe });
            leaf.cover(part, a.dust, Layering::ALL[rule].1);
        }
    })
    .top_albedo(TopAlbedo::Formula)
    .without(DUSTED_WAIVERS)
}

const DUSTED_WAIVERS: &[Waiver] = &[
    Waiver {
        claim: Claim::Reciprocity,
        only: Some(("layering", "view")),
        why: "the base is scaled by what the layer lets through to the viewer alone",
    },
    Waiver {
        claim: Claim::Energy,
        only: Some(("layering", "kelemen")),
        why: "the rule is lossless over diffuse bases alone",
    },
];

velour::arguments! {
    /// The arguments of `glimmer`.
    pub struct GlimmerArguments {
        color: Color = ParamSpec::about("radiance"),
    }
}

/// `glimmer(color)`: a light.
pub fn glimmer() -> ClosureDef {
    ClosureDef::new("glimmer", "sends out light", |a: GlimmerArguments, leaf| leaf.tint(a.color)).emitting()
}

/// velour's closures and the host's.
///
/// # Errors
/// None, as the names are new.
pub fn library() -> Result<Library, RegisterError> {
    let mut library = Library::standard();
    for definition in [minnaert(), dusted(), glimmer()] {
        library.register(definition)?;
    }
    Ok(library)
}
