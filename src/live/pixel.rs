//! What is told of the pixel under the mouse: tree, lobes and curves.

use crate::render::Look;
use serde_json::{Value, json};

/// Directions of the plane of incidence that lobes are drawn at: one a degree.
pub const DIRECTIONS: usize = 360;

/// Lobes whose curves are told.
const MOST_LOBES: usize = 12;

/// Bytes of a tree's text.
const MOST_TEXT: usize = 20_000;

/// The look at a pixel as the page takes it; `group` is the number of the group it belongs to and its name.
pub fn pixel(look: &Look, [x, y]: [u32; 2], group: Option<(usize, String)>) -> Value {
    let short = |x: f32| json!((f64::from(x) * 1e5).round() / 1e5);
    let color = |c: glam::Vec3| json!([short(c.x), short(c.y), short(c.z)]);
    let column =
        |part: fn(&glam::Vec3) -> f32| Value::from(look.total.iter().map(|c| short(part(c))).collect::<Vec<_>>());
    let lobes = look.lobes.iter().enumerate().map(|(k, (lobe, curve))| {
        let flat = curve.iter().all(|f| *f == 0.0);
        let curve = (k < MOST_LOBES && !flat).then(|| curve.iter().map(|&f| short(f)).collect::<Vec<_>>());
        json!({
            "closure": lobe.closure,
            "weight": lobe.weight.map(short),
            "albedo": short(lobe.albedo),
            "depth": lobe.depth,
            "through": short(lobe.through),
            "pick": short(lobe.pick),
            "curve": curve,
        })
    });
    let reports = look.reports.iter().take(20).map(ToString::to_string);
    let (number, name) = group.unzip();
    json!({
        "x": x,
        "y": y,
        "group": number,
        "name": name,
        "position": color(look.position),
        "uv": look.uv.map(short),
        "tree": look.tree.chars().take(MOST_TEXT).collect::<String>(),
        "lobes": lobes.collect::<Vec<_>>(),
        "total": [column(|c| c.x), column(|c| c.y), column(|c| c.z)],
        "emission": color(look.emission),
        "viewer": short(look.viewer),
        "reports": reports.collect::<Vec<_>>(),
    })
}
