//! Rays a second against the number of triangles, in ratios that one run can prove: `cargo bench --bench rays`.
//!
//! For woven cloth of 16 thousand to a million triangles: how fast the hierarchy is built, and how many rays a second
//! one thread answers, closest hit and any hit, for rays of a camera, rays that bounce off what those hit, and rays
//! from anywhere to anywhere. Beside it, in turns with it, the stock walk of `obvhs` over its own eight-wide tree with
//! one triangle test after the other. The last table says how much time a ray takes for each doubling of triangles.

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::RayHit;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use velour::render::accel::{Accel, Method, NOTHING, Ray};
use velour::render::random;
use velour::scene::{Geometry, Scene, ShaderFiles, Shape};

/// Rays of a kind.
const COUNT: u32 = 1 << 18;

/// Turns that each competitor gets; the best one counts, since others use the machine too.
const TURNS: usize = 5;

const KINDS: [&str; 3] = ["camera", "bounce", "random"];

fn main() {
    println!("triangles  kind    closest M/s  any M/s  obvhs closest M/s  ratio  ns a ray");
    let mut times: Vec<(usize, [f64; 3])> = Vec::new();
    for yarns in [9, 18, 37, 74] {
        let geometry = cloth(yarns);
        let triangles = geometry.primitives.len();
        let start = Instant::now();
        let accel = Accel::with(&geometry, Method::Wide);
        let seconds = start.elapsed().as_secs_f64();
        let stock = Stock::new(&geometry);
        println!(
            "{triangles:9}  built in {seconds:.3} s: {:.2} M triangles/s, {:.0} bytes each; obvhs {:.3} s",
            triangles as f64 / seconds * 1e-6,
            accel.bytes() as f64 / triangles as f64,
            stock.seconds
        );
        let mut row = [0.0; 3];
        for (kind, rays) in rays(&geometry, &accel).iter().enumerate() {
            let [closest, any, other] = measure(&accel, &stock, rays);
            let rate = |seconds: f64| rays.len() as f64 / seconds * 1e-6;
            row[kind] = closest / rays.len() as f64 * 1e9;
            println!(
                "{triangles:9}  {:6}  {:11.2}  {:7.2}  {:17.2}  {:5.2}  {:8.0}",
                KINDS[kind],
                rate(closest),
                rate(any),
                rate(other),
                other / closest,
                row[kind]
            );
        }
        times.push((triangles, row));
    }
    println!("\nnanoseconds that a doubling of triangles adds to a ray; the same in every row would be a logarithm");
    for pair in times.windows(2) {
        let doublings = (pair[1].0 as f64 / pair[0].0 as f64).log2();
        let added = |kind: usize| (pair[1].1[kind] - pair[0].1[kind]) / doublings;
        println!("{:7} to {:7}: {:5.0} {:5.0} {:5.0}", pair[0].0, pair[1].0, added(0), added(1), added(2));
    }
}

/// A twill of `yarns` in both directions, 192 triangles a crossing, with folds.
fn cloth(yarns: u32) -> Arc<Geometry> {
    let text = format!(
        r#"<World><ShaderGroup>shader any l1;</ShaderGroup>
        <Weave corner="-1,0,1" edge_x="2,0,0" edge_y="0,0,-2" warp="{yarns}" weft="{yarns}" segments="6" sides="8"
               pattern="twill" folds="2" depth="0.1"/></World>"#
    );
    let shaders = ShaderFiles::default().with_shader("surface any() { Ci = diffuse(N); }");
    let shaders = shaders.unwrap_or_else(|error| panic!("{error}"));
    let folders: Vec<PathBuf> = Vec::new();
    Scene::load(&text, &folders, &shaders).unwrap_or_else(|error| panic!("{error}")).geometry
}

/// A point in the cube from -1 to 1.
fn point(i: u32, set: u32) -> Vec3 {
    let r = random::sample(1, i, set);
    Vec3::new(r[0], r[1], r[2]) * 2.0 - 1.0
}

/// Rays of the camera, of a diffuse bounce where those hit, and from anywhere to anywhere near the cloth.
fn rays(geometry: &Geometry, accel: &Accel) -> [Vec<Ray>; 3] {
    let eye = Vec3::new(0.3, 1.4, 1.7);
    let side = COUNT.isqrt();
    let camera = |i: u32| {
        let on = Vec3::new((i % side) as f32, 0.0, (i / side) as f32) / side as f32 * 2.4 - Vec3::new(1.2, 0.0, 1.2);
        Ray::new(eye, (on - eye).normalize())
    };
    let camera: Vec<Ray> = (0..COUNT).map(camera).collect();
    let mut hits = Vec::new();
    accel.closest(&camera, &mut hits);
    let mut bounce = Vec::new();
    for (i, (ray, hit)) in camera.iter().zip(&hits).enumerate().filter(|(_, (_, hit))| hit.primitive != NOTHING) {
        let Shape::Triangle { a, b, c } = geometry.primitives[hit.primitive as usize].shape else { continue };
        let p = a + (b - a) * hit.u + (c - a) * hit.v;
        let n = (b - a).cross(c - a).normalize();
        let n = if n.dot(ray.direction) > 0.0 { -n } else { n };
        let d = (n + point(i as u32, 0).normalize()).normalize_or(n);
        bounce.push(Ray { skip: hit.primitive, ..Ray::new(accel.leave(p, n, d, hit.primitive), d) });
    }
    let anywhere = |i: u32| Ray::new(point(i, 1) * Vec3::new(1.0, 0.15, 1.0), point(i, 2).normalize_or(Vec3::X));
    [camera, bounce, (0..COUNT).map(anywhere).collect()]
}

/// The best times for all of `rays`: our closest hit, our any hit, the stock closest hit.
fn measure(accel: &Accel, stock: &Stock, rays: &[Ray]) -> [f64; 3] {
    let (mut best, mut hits, mut blocked) = ([f64::INFINITY; 3], Vec::new(), Vec::new());
    for _ in 0..TURNS {
        let mut time = |which: usize, work: &mut dyn FnMut()| {
            let start = Instant::now();
            work();
            best[which] = best[which].min(start.elapsed().as_secs_f64());
        };
        time(0, &mut || accel.closest(rays, &mut hits));
        time(1, &mut || accel.any(rays, &mut blocked));
        time(2, &mut || {
            std::hint::black_box(rays.iter().filter(|ray| stock.closest(ray) != NOTHING).count());
        });
    }
    best
}

/// The tree and walk of `obvhs` as they come.
struct Stock {
    tree: CwBvh,
    /// Corner and two edges.
    triangles: Vec<[Vec3A; 3]>,
    ids: Vec<u32>,
    seconds: f64,
}

impl Stock {
    fn new(geometry: &Geometry) -> Self {
        let corners = |shape: &Shape| match *shape {
            Shape::Triangle { a, b, c } => [a.into(), b.into(), c.into()],
            _ => [Vec3A::ZERO; 3],
        };
        let corners: Vec<[Vec3A; 3]> = geometry.primitives.iter().map(|p| corners(&p.shape)).collect();
        let bounds: Vec<Aabb> = corners.iter().map(|c| Aabb::from_points(c)).collect();
        let start = Instant::now();
        let mut tree = build_cwbvh(&bounds, BvhBuildParams::medium_build(), &mut Duration::default());
        let seconds = start.elapsed().as_secs_f64();
        let ids = std::mem::take(&mut tree.primitive_indices);
        let triangles = ids.iter().map(|&i| corners[i as usize]).map(|[a, b, c]| [a, b - a, c - a]).collect();
        Stock { tree, triangles, ids, seconds }
    }

    fn closest(&self, ray: &Ray) -> u32 {
        let from = obvhs::ray::Ray::new(ray.origin.into(), ray.direction.into(), 0.0, ray.reach);
        let mut hit = RayHit::none();
        self.tree.ray_traverse(from, &mut hit, |walk, index| {
            let [a, x, y] = self.triangles[index];
            if self.ids[index] == ray.skip {
                return f32::INFINITY;
            }
            // Möller and Trumbore 1997.
            let p = walk.direction.cross(y);
            let inverse = 1.0 / x.dot(p);
            let from = walk.origin - a;
            let u = from.dot(p) * inverse;
            let q = from.cross(x);
            let v = walk.direction.dot(q) * inverse;
            let t = y.dot(q) * inverse;
            if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 { t } else { f32::INFINITY }
        });
        self.ids.get(hit.primitive_id as usize).copied().unwrap_or(NOTHING)
    }
}
