//! Solid glass through the whole renderer, against Snell's and Fresnel's laws followed ray by ray in f64.

use super::materials::picture_with;
use glam::DVec3;

const GLASS: &str = "Ci = dielectric_bsdf(N, vector(1,0,0), color(1), color(1), 0, 0, ETA, \"ggx\");";
const SCHLICK: &str = "Ci = generalized_schlick_bsdf(N, vector(1,0,0), color(1), color(1), 0, 0, color(pow((ETA-1)/(ETA+1), 2)), color(1), 5, \"ggx\");";
const BY_HAND: &str = "float e = backfacing() ? 1 / ETA : ETA; Ci = reflection(N, e) + refraction(N, e);";
const SKY: &str = "surface heaven() { Ci = (.5 + .5 * normalize(I)[1]) * background(); }";

/// A unit sphere before a sky whose radiance tells the direction.
fn scene(body: &str) -> String {
    format!(
        r#"<World><Camera eye="0,0,6" dir="0,0,-1" fov="44"/>
        <ShaderGroup>shader heaven l1;</ShaderGroup><Background resolution="64"/>
        <ShaderGroup>shader it l1;</ShaderGroup>{body}</World>"#
    )
}

fn fresnel(cos: f64, eta: f64) -> f64 {
    let t2 = 1.0 - (1.0 - cos * cos) / (eta * eta);
    if t2 <= 0.0 {
        return 1.0;
    }
    let t = t2.sqrt();
    let (s, p) = ((cos - eta * t) / (cos + eta * t), (eta * cos - t) / (eta * cos + t));
    0.5 * (s * s + p * p)
}

/// Snell's direction of a ray along `d` at a facet whose normal faces it.
fn refract(d: DVec3, n: DVec3, eta: f64) -> DVec3 {
    let cos = -d.dot(n);
    let t = (1.0 - (1.0 - cos * cos) / (eta * eta)).max(0.0).sqrt();
    d / eta + n * (cos / eta - t)
}

fn heaven(d: DVec3) -> f64 {
    0.5 + 0.5 * d.y
}

/// What a ray sees of the sky through the sphere, after all its inner reflections.
fn through_sphere(origin: DVec3, d: DVec3, eta: f64) -> f64 {
    let (b, c) = (origin.dot(d), origin.length_squared() - 1.0);
    let inside = b * b - c;
    if inside <= 0.0 {
        return heaven(d);
    }
    let mut p = origin + d * (-b - inside.sqrt());
    let cos = -d.dot(p);
    let reflected = fresnel(cos, eta);
    let mut sum = reflected * heaven(d + p * (2.0 * cos));
    let (mut left, mut d) = (1.0 - reflected, refract(d, p, eta));
    while left > 1e-12 {
        p = (p - d * (2.0 * p.dot(d))).normalize();
        let (n, cos) = (-p, d.dot(p));
        let reflected = fresnel(cos, 1.0 / eta);
        if reflected < 1.0 {
            sum += left * (1.0 - reflected) * heaven(refract(d, n, 1.0 / eta));
        }
        left *= reflected;
        d = (d - p * (2.0 * cos)).normalize();
    }
    sum
}

/// The direction of a pixel's centre, as testrender's camera has it: the whole picture is as high as the tangent of half the angle.
fn ray(x: usize, y: usize, side: usize) -> DVec3 {
    let height = 22f64.to_radians().tan();
    let at = |i: usize| ((i as f64 + 0.5) / side as f64 - 0.5) * height;
    DVec3::new(at(x), -at(y), -1.0).normalize()
}

#[test]
fn a_ball_of_glass_bends_rays_as_snell_says() {
    let side = 12;
    for eta in [0.67, 1.33, 1.5, 2.4] {
        for shader in [GLASS, BY_HAND] {
            let shader = format!("surface it() {{ {} }}", shader.replace("ETA", &format!("{eta:?}")));
            let ball = scene(r#"<Sphere center="0,0,0" radius="1"/>"#);
            let image = picture_with(&ball, &[&shader, SKY], |s| {
                (s.width, s.height, s.samples, s.jitter, s.max_bounces) = (side as u32, side as u32, 4096, false, 200);
            });
            for y in 0..side {
                for x in 0..side {
                    let exact = through_sphere(DVec3::new(0.0, 0.0, 6.0), ray(x, y, side), eta);
                    let found = f64::from(image.pixels[3 * (y * side + x)]);
                    assert!((found / exact - 1.0).abs() < 0.02, "{eta}, {x} {y}: {found} against {exact}: {shader}");
                }
            }
        }
    }
}

/// Solid glass that absorbs nothing cannot be seen in a white furnace, whatever its index and however rough it is not.
#[test]
fn solid_glass_is_invisible_in_a_furnace() {
    for eta in [0.67, 1.33, 1.5, 2.4] {
        for body in [GLASS, SCHLICK] {
            let shader = format!("surface it() {{ {} }}", body.replace("ETA", &format!("{eta:?}")));
            let white = "surface heaven() { Ci = background(); }";
            let ball = scene(r#"<Sphere center="0,0,0" radius="1"/>"#);
            let image = picture_with(&ball, &[&shader, white], |s| {
                (s.width, s.height, s.samples, s.max_bounces) = (24, 24, 64, 400);
            });
            for (at, &pixel) in image.pixels.iter().enumerate() {
                assert!((pixel - 1.0).abs() < 2e-3, "{eta}, pixel {}: {pixel}: {body}", at / 3);
            }
        }
    }
}

/// A window is no lens: two parallel faces let rays go on as they came.
#[test]
fn a_parallel_plate_bends_nothing() {
    let plate = scene(
        r#"<Quad corner="-9,-9,.1" edge_x="18,0,0" edge_y="0,18,0"/><Quad corner="-9,-9,-.1" edge_x="0,18,0" edge_y="18,0,0"/>"#,
    );
    let shader = format!("surface it() {{ {} }}", GLASS.replace("ETA", "1.5"));
    let side = 8;
    let image = picture_with(&plate, &[&shader, SKY], |s| {
        (s.width, s.height, s.samples, s.jitter, s.max_bounces) = (side as u32, side as u32, 4096, false, 100);
    });
    for y in 0..side {
        for x in 0..side {
            let d = ray(x, y, side);
            let once = fresnel(-d.z, 1.5);
            let back = 2.0 * once / (1.0 + once);
            let exact = back * heaven(d * DVec3::new(1.0, 1.0, -1.0)) + (1.0 - back) * heaven(d);
            let found = f64::from(image.pixels[3 * (y * side + x)]);
            assert!((found / exact - 1.0).abs() < 0.01, "{x} {y}: {found} against {exact}");
        }
    }
}

/// Negative control: a ball whose index is not inverted inside fails the first test by far.
#[test]
fn an_index_that_is_not_inverted_would_be_found() {
    let shader = "surface it() { Ci = reflection(N, 1.5) + refraction(N, 1.5); }";
    let image = picture_with(&scene(r#"<Sphere center="0,0,0" radius="1"/>"#), &[shader, SKY], |s| {
        (s.width, s.height, s.samples, s.jitter) = (12, 12, 512, false);
    });
    let exact = through_sphere(DVec3::new(0.0, 0.0, 6.0), ray(6, 3, 12), 1.5);
    let found = f64::from(image.pixels[3 * (3 * 12 + 6)]);
    assert!((found / exact - 1.0).abs() > 0.2, "{found} against {exact}");
}

/// A ball is a lens of focal length eta / (2 (eta - 1)) radii from its centre: from there, light near the axis leaves it parallel.
#[test]
fn a_ball_focuses_at_its_paraxial_distance() {
    for eta in [1.33, 1.5, 1.9] {
        let formula = eta / (2.0 * (eta - 1.0));
        let (near, far) = (0.95 * formula, 1.05 * formula);
        let [a, b] = [near, far].map(|eye| slope_behind(eta, eye));
        let focus = near + (far - near) * a / (a - b);
        assert!(a * b < 0.0 && (focus / formula - 1.0).abs() < 0.01, "{eta}: {focus} against {formula}");
    }
}

/// How far rays lean that leave the ball where a camera at `eye` on its axis looks through it, a little beside the axis.
fn slope_behind(eta: f64, eye: f64) -> f64 {
    let scene = format!(
        r#"<World><Camera eye="0,0,{eye}" dir="0,0,-1" fov="1"/>
        <ShaderGroup>shader heaven l1;</ShaderGroup><Background resolution="64"/>
        <ShaderGroup>shader it l1;</ShaderGroup><Sphere center="0,0,0" radius="1"/></World>"#
    );
    // Without reflection there is one path.
    let glass = format!(
        "surface it() {{ Ci = dielectric_bsdf(N, vector(1,0,0), color(0), color(1), 0, 0, {eta:?}, \"ggx\"); }}"
    );
    let sky = "surface heaven() { Ci = (1 + 50 * normalize(I)[0]) * background(); }";
    let image = picture_with(&scene, &[&glass, sky], |s| {
        (s.width, s.height, s.samples, s.jitter) = (2, 2, 1, false);
    });
    let [left, right] = [0, 1].map(|x| f64::from(image.pixels[3 * x]));
    (right - left) / (right + left)
}
