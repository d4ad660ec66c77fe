//! A closure of one's own: a model, its declaration, and a picture made with both.
//!
//! `cargo run --release --example own_closure` writes `own_closure.png`, describes the closure, and verifies it.

use std::error::Error;
use std::f32::consts::TAU;
use velour::bsdf::{Eval, Params, Scatter, View};
use velour::closure::{ClosureDef, Color, Float, Library, LobeKind, Normal};
use velour::compile::Compiler;
use velour::glam::Vec3;
use velour::lang::closures::ParamSpec;
use velour::lang::describe::closure_text;
use velour::measure::verify::{ClosureSubject, Effort, verify};
use velour::render::{Settings, Silent, render};
use velour::scene::{Scene, ShaderFiles};

/// The model of Minnaert 1941: f = (k + 1) / (2 pi) (ci co)^(k - 1), darker toward the rim the larger k is. Its lane loops are made
/// by `LobeKind::of`, so these are the only formulas there are.
#[derive(Clone, Copy)]
struct Minnaert {
    k: f32,
}

impl Scatter for Minnaert {
    const PARAMS: usize = 1;

    fn prepare([k, ..]: Params) -> Self {
        Minnaert { k: k.clamp(1.0, 20.0) }
    }

    fn eval_from(&self, wo: Vec3, _view: View, wi: Vec3) -> Eval {
        let pdf = if wi.z > 0.0 { (self.k + 1.0) / TAU * wi.z.powf(self.k) } else { 0.0 };
        Eval { f_cos: self.albedo(wo.z) * pdf, pdf }
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

// The signature, and a struct to read a call's arguments by their names.
velour::arguments! {
    struct MinnaertArguments {
        N: Normal = ParamSpec::about("shading normal, unit length"),
        albedo: Color = ParamSpec::about("color of the reflection, 0..1"),
        k: Float = ParamSpec::about("how dark the rim is, 1 (not at all) to 20").tried(&[1.5, 1.0, 3.0, 20.0]),
    }
}

const SHADER: &str = "surface moon(color gray = 0.8, float k = 2.5) { Ci = minnaert(N, gray, k); }";
const SKY: &str = "surface sky() { Ci = 3 * pow(max(I[0], 0.0), 8.0) * background(); }";
const SCENE: &str = r#"<World>
  <Camera eye="0,0,4" dir="0,0,-1" fov="35"/>
  <ShaderGroup>shader sky l1;</ShaderGroup><Background resolution="128"/>
  <ShaderGroup>shader moon l1;</ShaderGroup><Sphere center="0,0,0" radius="1"/>
</World>"#;

fn main() -> Result<(), Box<dyn Error>> {
    let mut library = Library::standard();
    let minnaert =
        ClosureDef::new("minnaert", "darkens toward the rim (Minnaert 1941)", |a: MinnaertArguments, leaf| {
            leaf.tint(a.albedo);
            let frame = leaf.frame(a.N, None);
            leaf.lobe(LobeKind::of::<Minnaert>(), frame, &[a.k.0]);
        });
    let id = library.register(minnaert)?;
    print!("{}", closure_text(library.get(id)));

    let compiler = Compiler::new().with_closures(library);
    let subject = ClosureSubject::new(&compiler, id, false, Default::default())?;
    let report = verify(&[&subject], &Effort::quick(), &|_, _| {});
    println!("{} checks, {}", report.lines.len(), if report.passed() { "nothing fails" } else { "some FAIL" });

    let files = ShaderFiles::new(compiler).with_shader(SHADER)?.with_shader(SKY)?;
    let scene = Scene::load(SCENE, &[], &files)?;
    let image = render(&scene, &Settings { width: 256, height: 256, samples: 64, ..Settings::default() }, &Silent)?;
    velour::render::output::write(&image, std::path::Path::new("own_closure.png"))?;
    println!("own_closure.png");
    Ok(())
}
