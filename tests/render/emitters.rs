//! Light under layers: what a layer lets through depends on the view, so no such light is the same all over.

use super::materials::picture_with;
use velour::closure::{Library, Lobes, Settings};
use velour::compile::compile;
use velour::exec::{Machine, Points};
use velour::lang::closures::{ClosureSpec, ParamKind};
use velour::math::columns::Column3;

/// A call of a closure with these words for what it nests, and usual values for the rest.
fn call(spec: &ClosureSpec, nested: &str) -> String {
    let mut nests = spec.params.iter().filter(|p| p.kind == ParamKind::Closure).count();
    let mut argument = |kind: ParamKind| match kind {
        ParamKind::Closure => {
            nests -= 1;
            // The last one lies under the others.
            if nests == 0 { nested.to_owned() } else { "sheen_bsdf(normal(0, 0, 1), color(1), .3)".to_owned() }
        }
        ParamKind::Normal => "normal(0, 0, 1)".to_owned(),
        ParamKind::Vector => "vector(1, 0, 0)".to_owned(),
        ParamKind::Color => "color(1)".to_owned(),
        ParamKind::Float => "1.4".to_owned(),
        ParamKind::Int => "0".to_owned(),
        ParamKind::String => "\"\"".to_owned(),
    };
    let arguments: Vec<String> = spec.params.iter().map(|p| argument(p.kind)).collect();
    format!("{}({})", spec.name, arguments.join(", "))
}

/// Radiance toward a viewer at this cosine, or the hole there.
fn seen(ci: &str, cos: f32) -> [f32; 2] {
    let group = compile(&format!("surface it() {{ Ci = {ci}; }}")).unwrap().group().build().unwrap();
    let wo = glam::Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let (points, mut machine) = (Points::single(wo), Machine::new());
    let mut lobes = Lobes::new(Settings::default());
    lobes.flatten(group.library(), machine.shade(&group, &points), &Column3::splat(wo, 1), &points.ng);
    [lobes.emission().x[0], lobes.holdout()[0]]
}

/// What the plan of a scene takes for the same from everywhere must be so when it is flattened, for every closure that
/// nests and every emitter below it; and what it does not is not found once for all.
#[test]
fn the_plan_and_the_lobes_agree_on_light_under_layers() {
    let table = Library::standard();
    let emits = |spec: &&ClosureSpec| seen(&call(spec, "diffuse(N)"), 0.9)[0] > 0.0;
    let emitters: Vec<&ClosureSpec> = table.specs().iter().filter(emits).collect();
    let nests: Vec<&ClosureSpec> = table.specs().iter().filter(|spec| spec.nests()).collect();
    assert!(emitters.len() >= 3 && nests.len() >= 3);
    for emitter in emitters {
        let plain = call(emitter, "");
        assert_eq!(seen(&plain, 0.9), seen(&plain, 0.2), "{plain} needs no layer to depend on the view");
        for nest in &nests {
            let ci = call(nest, &plain);
            let (near, far) = (seen(&ci, 0.9)[0], seen(&ci, 0.2)[0]);
            assert!((near - far).abs() > 1e-3, "{ci}: {near} and {far}");
            let scene = r#"<World><Camera eye="0,0,1" dir="0,0,-1" fov="90"/><ShaderGroup>shader it l1;</ShaderGroup>
                <Quad corner="-2,-2,0" edge_x="4,0,0" edge_y="0,4,0"/></World>"#;
            let image = picture_with(scene, &[&format!("surface it() {{ Ci = {ci}; }}")], |s| {
                (s.width, s.height, s.samples) = (16, 16, 4);
            });
            let (middle, corner) = (image.pixel(8, 8)[0], image.pixel(0, 0)[0]);
            assert!((middle - corner).abs() > 1e-4, "{ci}: {middle} and {corner}");
        }
    }
}

/// Fault A5: .353 in every pixel.
#[test]
fn a_coat_over_light_is_darker_in_the_corner() {
    let scene = r#"<World><Camera eye="0,0,1" dir="0,0,-1" fov="90"/><ShaderGroup>shader it l1;</ShaderGroup>
        <Quad corner="-2,-2,0" edge_x="4,0,0" edge_y="0,4,0"/></World>"#;
    let picture = |factor: &str| {
        let shader = format!(
            "surface it(float one = 1) {{ Ci = {factor} * coat(emission(), normal(0, 0, 1), 0, 1.5, color(1), 1); }}"
        );
        picture_with(scene, &[&shader], |s| (s.width, s.height, s.samples) = (33, 33, 16))
    };
    let (constant, varying) = (picture("1"), picture("(u < 2 ? 1.0 : 0.5)"));
    for (x, y, expected) in [(16, 16, 0.353), (0, 0, 0.327)] {
        let (a, b) = (constant.pixel(x, y)[0], varying.pixel(x, y)[0]);
        assert!((a - expected).abs() < 2e-3 && (a - b).abs() < 2e-3, "{x} {y}: {a} and {b}");
    }
}
