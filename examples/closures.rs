//! The page of the closures: what each means, its formula and source, and what it looks like.
//!
//! `cargo run --release --example closures -- shaders/closures 256` makes the page and its pictures as they are stored; without numbers
//! the pictures are sketches.

#[path = "shared/jpeg.rs"]
mod jpeg;

use jpeg::jpeg;
use std::path::{Path, PathBuf};
use velour::closure::Library;
use velour::lang::describe::closure_markdown;
use velour::render::{Settings, Silent, render};
use velour::scene::{Scene, ShaderFiles};

/// A family: its title, and its closures, each with what `Ci` is in its picture; nothing for those without one.
type Family = (&'static str, &'static [(&'static str, &'static str)]);

const FAMILIES: [Family; 7] = [
    (
        "Cloth and layers",
        &[
            ("sheen", "sheen(color(0.35, 0.03, 0.05) * diffuse(N), N, color(0.9, 0.75, 0.75), 0.3)"),
            ("sheen_bsdf", "sheen_bsdf(N, color(0.8, 0.75, 1), 0.25)"),
            ("ashikhmin_velvet", "color(0.6, 0.55, 0.9) * ashikhmin_velvet(N, 0.3)"),
            (
                "layer",
                "layer(dielectric_bsdf(N, U, color(1), color(0), 0.1, 0.1, 1.5, \"ggx\"), color(0.05, 0.25, 0.2) * diffuse(N))",
            ),
            ("coat", "coat(color(0.5, 0.2, 0.05) * diffuse(N), N, 0.05, 1.5, color(0.1, 0.6, 2), 0.5)"),
        ],
    ),
    (
        "Diffuse",
        &[
            ("diffuse", "color(0.6) * diffuse(N)"),
            ("oren_nayar", "color(0.6) * oren_nayar(N, 0.5)"),
            ("oren_nayar_diffuse_bsdf", "oren_nayar_diffuse_bsdf(N, color(0.6), 1, \"energy_compensation\", 1)"),
            ("burley_diffuse_bsdf", "burley_diffuse_bsdf(N, color(0.6), 1)"),
            ("translucent", "color(0.7, 0.5, 0.3) * translucent(N)"),
            ("translucent_bsdf", ""),
            ("diffuse_toon", "color(0.6) * diffuse_toon(N, 0.4, 0.1)"),
            ("subsurface", ""),
            ("subsurface_bssrdf", ""),
        ],
    ),
    (
        "Boundaries",
        &[
            ("reflection", "color(0.9) * reflection(N, 0)"),
            ("refraction", ""),
            ("microfacet", "color(0.9) * microfacet(\"ggx\", N, U, 0.3, 0.3, 0.0, 0)"),
            ("dielectric_bsdf", "dielectric_bsdf(N, U, color(1), color(0.9, 0.97, 0.95), 0.05, 0.05, 1.5, \"ggx\")"),
            (
                "conductor_bsdf",
                "conductor_bsdf(N, U, 0.3, 0.1, color(0.18, 0.42, 1.37), color(3.42, 2.35, 1.77), \"ggx\")",
            ),
            (
                "generalized_schlick_bsdf",
                "generalized_schlick_bsdf(N, U, color(1), color(0), 0.2, 0.2, color(0.1, 0.3, 0.6), color(1), 5, \"ggx\")",
            ),
            ("transparent", "color(0.3, 0.5, 0.7) * transparent()"),
            ("transparent_bsdf", ""),
        ],
    ),
    (
        "Highlights",
        &[
            ("phong", "color(0.8) * phong(N, 60)"),
            ("ward", "color(0.8) * ward(N, U, 0.4, 0.1, \"bounded\", 1)"),
            ("ashikhmin_shirley", "ashikhmin_shirley(N, U, 30, 300, color(0.1), color(0.3, 0.1, 0.1))"),
            ("lafortune", "color(0.6, 0.5, 0.3) * lafortune(N, U, vector(1, 1, 1), 8)"),
            ("glossy_toon", "color(0.8) * glossy_toon(N, 0.2, 0.1)"),
            (
                "chiang_hair_bsdf",
                "chiang_hair_bsdf(N, U, color(1), color(1), color(1), 1.55, 0.1, 0.05, 0.2, 0.4, 0.3, 0.5, 0.5, color(0.1, 0.25, 0.5))",
            ),
        ],
    ),
    (
        "Light",
        &[
            ("emission", "color(0.6, 0.35, 0.1) * emission()"),
            ("background", ""),
            ("uniform_edf", ""),
            ("holdout", ""),
            ("debug", ""),
        ],
    ),
    (
        "Of Cycles",
        &[
            ("microfacet_f82_tint", ""),
            ("microfacet_multi_ggx_glass", ""),
            ("microfacet_multi_ggx_aniso", ""),
            ("microfacet_ggx", ""),
            ("microfacet_beckmann", ""),
            ("microfacet_ggx_refraction", ""),
            ("microfacet_beckmann_refraction", ""),
            ("thin_glass", ""),
            ("thin_subsurface", ""),
            ("bssrdf", ""),
            ("hair_reflection", ""),
            ("hair_transmission", ""),
            ("hair_chiang", ""),
            ("hair_huang", ""),
            ("ambient_occlusion", ""),
            ("ray_portal_bsdf", ""),
        ],
    ),
    (
        "Media, which are not rendered",
        &[
            ("anisotropic_vdf", ""),
            ("medium_vdf", ""),
            ("henyey_greenstein", ""),
            ("fournier_forand", ""),
            ("draine", ""),
            ("rayleigh", ""),
            ("absorption", ""),
        ],
    ),
];

const HEAD: &str = "# Closures

What a shader can put into `Ci`, by families; `velour info NAME` prints the same. Pictures are of `velour render`'s built-in scene, in `soft`
view. This page and its pictures are made by `examples/closures.rs`.

In formulas `f` is the BSDF in 1/sr; `wo` and `wi` point to the viewer and to the light, with the cosines `co` and `ci` to `N`; `h` is their half
vector, `m` the normal of a facet, and trigonometric functions without an argument are of the angle between `N` and `h`. `a(w)` is a directional
albedo, `F` a Fresnel term. \"May reflect more than arrives\" and \"is not reciprocal\" are what `velour verify` does not ask of a closure; all
else it does.
";

/// The page as text.
pub fn page() -> String {
    let library = Library::standard();
    let mut out = HEAD.to_owned();
    for (title, closures) in FAMILIES {
        out += &format!("\n## {title}\n");
        for (name, shown) in closures {
            out += &format!("\n### `{name}`\n");
            if !shown.is_empty() {
                out += &format!("\n![{name}]({name}.jpg)\n\n`Ci = {shown};`\n");
            }
            library.named(name).for_each(|(_, spec)| out += &format!("\n{}", closure_markdown(spec)));
        }
    }
    out
}

/// The names on the page.
pub fn names() -> impl Iterator<Item = &'static str> {
    FAMILIES.iter().flat_map(|(_, closures)| closures.iter().map(|(name, _)| *name))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = PathBuf::from(arguments.first().map_or("closures", String::as_str));
    let samples: Option<u32> = arguments.get(1).map(|text| text.parse()).transpose()?;
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join("README.md"), page())?;
    for (name, shown) in FAMILIES.iter().flat_map(|(_, closures)| *closures).filter(|(_, shown)| !shown.is_empty()) {
        std::fs::write(folder.join(format!("{name}.jpg")), picture(shown, samples)?)?;
        println!("{}", folder.join(format!("{name}.jpg")).display());
    }
    Ok(())
}

/// What `Ci` looks like; a sketch has one sample of few pixels.
fn picture(shown: &str, samples: Option<u32>) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let text = format!("surface shows() {{ vector U = normalize(dPdu); Ci = {shown}; }}");
    let shaders = ShaderFiles::default().with_shader(&text)?;
    let scene = Scene::of_shader(Path::new("shows"), &[], &shaders)?;
    let scale = if samples.is_some() { 1 } else { 4 };
    let settings =
        Settings { width: 240 / scale, height: 180 / scale, samples: samples.unwrap_or(1), ..Settings::default() };
    let image = render(&scene, &settings, &Silent)?;
    Ok(jpeg(&image, 85)?)
}
