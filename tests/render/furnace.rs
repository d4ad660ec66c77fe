//! White furnaces: every closure under a sky of one, where the answer is 1 or a bound.

use super::materials::picture_with;
use velour::closure::Layering;
use velour::closure::Library;
use velour::lang::closures::{ParamKind, ParamSpec};
use velour::render::{Image, Settings};

/// The five roughnesses of figure 1 and one at the sharp end of the fits.
const ROUGHNESSES: [f32; 6] = [0.06, 0.15, 0.25, 0.4, 0.65, 1.0];

/// A sphere of a shader `it` in a white sky; all of it is in view, grazing angles included.
fn furnace(shader: &str, change: impl FnOnce(&mut Settings)) -> Image {
    let scene = r#"<World>
      <Camera eye="0,0,3" look_at="0,0,0" fov="80"/>
      <ShaderGroup>color c 1 1 1; shader sky l1;</ShaderGroup><Background resolution="64"/>
      <ShaderGroup>shader it l1;</ShaderGroup><Sphere center="0,0,0" radius="1"/></World>"#;
    picture_with(scene, &[shader], |s| {
        (s.width, s.height, s.samples, s.alpha) = (48, 48, 64, true);
        change(s);
    })
}

/// The mean over what the sphere covers: with alpha, the sky beside it is left out.
fn over_sphere(image: &Image) -> f64 {
    let (mut light, mut cover) = (0.0, 0.0);
    for pixel in image.pixels.chunks_exact(4) {
        let alpha = f64::from(pixel[3]);
        light += f64::from(pixel[0]);
        cover += alpha;
    }
    light / cover
}

fn sheen_over_white(roughness: f32, layering: Layering) -> f64 {
    let shader = format!("surface it() {{ Ci = sheen(diffuse(N), N, color(1), {roughness:?}); }}");
    over_sphere(&furnace(&shader, |s| s.closure.layering = layering))
}

#[test]
fn sheen_over_white_loses_little_and_gains_nothing() {
    for roughness in ROUGHNESSES {
        let mean = sheen_over_white(roughness, Layering::Min);
        assert!((0.85..=1.0 + 1e-3).contains(&mean), "r = {roughness}: {mean}");
    }
}

#[test]
fn sheen_scaled_by_the_view_alone_is_white() {
    for roughness in ROUGHNESSES {
        let mean = sheen_over_white(roughness, Layering::View);
        assert!((mean - 1.0).abs() <= 2e-3, "r = {roughness}: {mean}");
    }
}

/// Negative controls: a base that is not scaled gains light, and one that is 2 % too dark loses it.
#[test]
fn a_wrong_scale_would_be_found() {
    for roughness in ROUGHNESSES {
        let unscaled = format!("surface it() {{ Ci = diffuse(N) + sheen_bsdf(N, color(1), {roughness:?}); }}");
        let mean = over_sphere(&furnace(&unscaled, |_| ()));
        assert!(mean > 1.0 + 1e-3, "r = {roughness}: {mean}");
        let dark = format!("surface it() {{ Ci = sheen(0.98 * diffuse(N), N, color(1), {roughness:?}); }}");
        let mean = over_sphere(&furnace(&dark, |s| s.closure.layering = Layering::View));
        assert!((mean - 1.0).abs() > 2e-3, "r = {roughness}: {mean}");
    }
}

/// Closures that lose nothing: the sphere cannot be seen.
#[test]
fn what_loses_nothing_is_white() {
    let cases = [
        ("mirror", "Ci = reflection(N);"),
        ("translucent", "Ci = translucent(N);"),
        ("half and half", "Ci = 0.5 * diffuse(N) + 0.5 * translucent(N);"),
        ("glass", "float e = backfacing() ? 1 / 1.5 : 1.5; Ci = reflection(N, e) + refraction(N, e);"),
        ("smooth microfacets", "float e = backfacing() ? 1 / 1.5 : 1.5; Ci = microfacet(\"ggx\", N, 0.0, e, 2);"),
        (
            "smooth glass of MaterialX",
            "float e = backfacing() ? 1 / 1.5 : 1.5;
             Ci = dielectric_bsdf(N, vector(0), color(1), color(1), 0.0, 0.0, e, \"ggx\");",
        ),
        ("rough diffuse", "Ci = oren_nayar_diffuse_bsdf(N, color(1), 0.7, \"energy_compensation\", 1);"),
        ("a coat of air", "Ci = coat(diffuse(N), N, 0.0, 1.0, color(0), 1.0);"),
        ("a silver coat", "Ci = coat(diffuse(N), N, 0.0, 0.0, color(0), 1.0);"),
        ("a white sheen by the view", "Ci = sheen(diffuse(N), N, color(1), 0.4, \"layering\", \"view\");"),
    ];
    for (name, body) in cases {
        let mean = over_sphere(&furnace(&format!("surface it() {{ {body} }}"), |_| ()));
        assert!((mean - 1.0).abs() <= 2e-3, "{name}: {mean}");
    }
}

/// Every closure that promises to lose nothing vanishes in the white sky, whatever its other parameters.
#[test]
fn every_lossless_closure_is_white() {
    let table = Library::standard();
    let lossless: Vec<_> = table.specs().iter().filter(|spec| spec.lossless).collect();
    assert!(lossless.len() >= 7, "{}", lossless.len());
    for spec in lossless {
        let argument = |param: &ParamSpec| match param.kind {
            ParamKind::Normal => "N".to_owned(),
            ParamKind::Color => "color(1)".to_owned(),
            ParamKind::Vector => "vector(1, 0, 0)".to_owned(),
            _ => format!("{:?}", param.sweep.first().copied().unwrap_or(0.5)),
        };
        let arguments: Vec<String> = spec.params.iter().map(argument).collect();
        let shader = format!("surface it() {{ Ci = {}({}); }}", spec.name, arguments.join(", "));
        let mean = over_sphere(&furnace(&shader, |_| ()));
        // What passes straight through leaves no cover to take the mean over.
        let clear = spec.name.starts_with("transparent");
        assert!(if clear { mean.is_nan() } else { (mean - 1.0).abs() <= 2e-3 }, "{shader}: {mean}");
    }
}

/// Closures that may lose but must not gain, with the least they may keep.
#[test]
fn what_loses_light_gains_none() {
    let cases = [
        ("oren_nayar 0.3", "Ci = oren_nayar(N, 0.3);", 0.85),
        ("oren_nayar 1", "Ci = oren_nayar(N, 1.0);", 0.6),
        ("gloss", "Ci = microfacet(\"ggx\", N, 0.2, 1.5, 0);", 0.03),
        ("sheen alone", "Ci = sheen_bsdf(N, color(1), 0.4);", 0.05),
        ("gloss over white", "Ci = layer(microfacet(\"ggx\", N, 0.2, 1.5, 0), diffuse(N));", 0.85),
    ];
    for (name, body, least) in cases {
        let image = furnace(&format!("surface it() {{ {body} }}"), |_| ());
        let mean = over_sphere(&image);
        assert!((least..=1.0 + 1e-3).contains(&mean), "{name}: {mean}");
    }
}

/// Single scattering loses what is reflected below the horizon or into other facets. Means over the sphere's disc, by
/// a separate Monte Carlo integration of GGX with the height-correlated Smith term (2e5 samples at 50 cosines).
#[test]
fn rough_mirrors_lose_what_single_scattering_loses() {
    for (alpha, expected) in [(0.2, 0.9156), (0.4, 0.7731)] {
        let shader = format!("surface it() {{ Ci = microfacet(\"ggx\", N, {alpha:?}, 0.0, 0); }}");
        let mean = over_sphere(&furnace(&shader, |_| ()));
        assert!((mean - expected).abs() < 3e-3, "width {alpha}: {mean} in place of {expected}");
    }
}

/// What one boundary scatters twice is lost, most of it inside, close to the critical angle. Means over the sphere's disc
/// by a separate Monte Carlo walk that draws facets, not lobes: GGX by visible normals, Beckmann by its distribution.
#[test]
fn rough_glass_loses_what_single_scattering_loses() {
    for (distribution, expected) in [("ggx", 0.7220), ("beckmann", 0.8972)] {
        let eta = "float e = backfacing() ? 1 / 1.5 : 1.5;";
        let shader = format!("surface it() {{ {eta} Ci = microfacet(\"{distribution}\", N, 0.3, e, 2); }}");
        // Without Russian roulette, whose few heavy paths would need four times the samples. Means of eight seeds at 256
        // samples lie 7e-3 around their own mean, which leaves 2.5e-3 here.
        let mean = over_sphere(&furnace(&shader, |s| (s.samples, s.rr_depth) = (2048, 1000)));
        assert!((mean - expected).abs() < 5e-3, "{distribution}: {mean} in place of {expected}");
    }
}

#[test]
fn a_clear_sphere_leaves_no_trace() {
    let image = furnace("surface it() { Ci = transparent(); }", |_| ());
    assert!(image.pixels.iter().all(|p| *p == 0.0));
    let opaque = furnace("surface it() { Ci = transparent(); }", |s| s.alpha = false);
    assert!(opaque.pixels.iter().all(|p| *p == 1.0));
    // What amplifies is no less than nothing.
    let image = furnace("surface it() { Ci = 2 * transparent(); }", |_| ());
    assert!(image.pixels.iter().all(|p| *p == 0.0));
}

#[test]
fn a_holdout_takes_its_part_of_alpha() {
    let image = furnace("surface it() { Ci = 0.25 * holdout() + 0.75 * diffuse(N); }", |_| ());
    let middle = image.pixel(24, 24);
    assert!((middle[3] - 0.75).abs() < 1e-6 && (middle[0] - 0.75).abs() < 1e-3, "{middle:?}");
    let image = furnace("surface it() { Ci = holdout(); }", |_| ());
    assert_eq!(image.pixel(24, 24), [0.0; 4]);
}
