//! The closures velour renders: one file a family, each closure declared in one place with all that it stands for.
//!
//! To add one: a function here in the file of its family, its line in [`all`], and its formula and source in `formulas`.

mod boundaries;
mod cloth;
mod coat;
mod cycles;
mod diffuse;
mod formulas;
mod hair;
mod highlights;
mod lights;
mod straight;
mod toon;
mod usual;
mod volumes;

use super::definition::ClosureDef;

/// All of them, in the order that `velour info` lists.
pub(super) fn all() -> Vec<ClosureDef> {
    let mut all = vec![
        lights::emission(),
        lights::background(),
        diffuse::diffuse(),
        diffuse::oren_nayar(),
        cloth::ashikhmin_velvet(),
        diffuse::translucent(),
        straight::transparent("transparent"),
        lights::holdout(),
        lights::debug(),
        boundaries::reflection(),
        boundaries::refraction(),
        boundaries::microfacet(),
        boundaries::dielectric(),
        boundaries::conductor(),
        boundaries::generalized_schlick(),
        cloth::sheen(),
        cloth::sheen_bsdf(),
        cloth::layer(),
        coat::coat(),
        highlights::phong(),
        highlights::ward(),
        highlights::ashikhmin_shirley(),
        highlights::lafortune(),
        diffuse::subsurface(),
        diffuse::oren_nayar_diffuse(),
        diffuse::burley(),
        diffuse::translucent_bsdf(),
        straight::transparent("transparent_bsdf"),
        diffuse::subsurface_bssrdf(),
        hair::chiang(),
        lights::uniform_edf(),
        toon::diffuse_toon(),
        toon::glossy_toon(),
        volumes::anisotropic(),
        volumes::medium(),
        cloth::sheen_alone(),
    ];
    all.extend(cycles::all());
    // An overload that says its own formula keeps it.
    let told = |def: ClosureDef| match formulas::of(def.spec().name).filter(|_| def.spec().formula.is_empty()) {
        Some((formula, source)) => def.formula(formula, source),
        None => def,
    };
    all.into_iter().map(told).collect()
}
