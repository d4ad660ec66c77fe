//! Woven cloth made of yarns: tubes that pass over and under each other, as triangles.

use super::error::{Place, SceneError, SceneProblem};
use super::geometry::{Geometry, Object, Primitive, Shape};
use super::xml::Element;
use crate::limits::MADE_TRIANGLES;
use crate::math::elementary::{cos, sin, sincos};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Which yarns lie on top where they cross.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// Over one, under one.
    Plain,
    /// Over two, under two, each row one further: diagonal ridges.
    Twill,
    /// Over four, under one: long floats that shine.
    Satin,
}

impl Pattern {
    const NAMES: &str = "`plain`, `twill` or `satin`";

    fn from_name(name: &str) -> Option<Self> {
        match name {
            "plain" => Some(Pattern::Plain),
            "twill" => Some(Pattern::Twill),
            "satin" => Some(Pattern::Satin),
            _ => None,
        }
    }

    /// True where the warp is on top; yarns ask one crossing beyond both their ends.
    fn warp_is_over(self, warp: i64, weft: i64) -> bool {
        match self {
            Pattern::Plain => (warp + weft).rem_euclid(2) == 0,
            Pattern::Twill => (warp + weft).rem_euclid(4) < 2,
            Pattern::Satin => (2 * warp + weft).rem_euclid(5) != 0,
        }
    }
}

/// What a `<Weave>` says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weave {
    corner: Vec3,
    edge_x: Vec3,
    edge_y: Vec3,
    /// Yarns along `edge_x` (warp) and along `edge_y` (weft).
    warp: u32,
    weft: u32,
    /// Rings of a yarn from one crossing to the next.
    segments: u32,
    /// Sides of a yarn.
    sides: u32,
    pattern: Pattern,
    /// A yarn's height, as a share of half the distance to the next yarn.
    thickness: f32,
    folds: f32,
    depth: f32,
}

impl Weave {
    /// The attributes it knows.
    pub const ATTRIBUTES: [&str; 12] = [
        "corner",
        "edge_x",
        "edge_y",
        "warp",
        "weft",
        "segments",
        "sides",
        "pattern",
        "thickness",
        "folds",
        "depth",
        "weft_group",
    ];

    /// Reads an element.
    ///
    /// # Errors
    /// An attribute is missing or out of range, the cloth has no area, or there would be too many triangles.
    pub fn read(e: &Element) -> Result<Self, SceneError> {
        let pattern = match e.node.attribute("pattern") {
            None => Pattern::Plain,
            Some(name) => Pattern::from_name(name).ok_or_else(|| e.bad_value("pattern", Pattern::NAMES))?,
        };
        let weave = Weave {
            corner: e.required_vector("corner")?,
            edge_x: e.required_vector("edge_x")?,
            edge_y: e.required_vector("edge_y")?,
            warp: e.whole("warp", 32, 1..=4096)?,
            weft: e.whole("weft", 32, 1..=4096)?,
            segments: e.whole("segments", 6, 2..=64)?,
            sides: e.whole("sides", 8, 3..=64)?,
            pattern,
            thickness: e.real("thickness", 0.6, 0.01..=1.0)?,
            folds: e.real("folds", 0.0, 0.0..=64.0)?,
            depth: e.real("depth", 0.0, 0.0..=1e6)?,
        };
        if weave.edge_x.cross(weave.edge_y).length() <= 1e-6 * weave.edge_x.length() * weave.edge_y.length() {
            return Err(SceneError::at(e.place(), SceneProblem::NoArea { tag: e.tag().to_owned() })
                .with_help("`edge_x` and `edge_y` must both have a length and not be parallel"));
        }
        let count = weave.triangles();
        if count > MADE_TRIANGLES {
            let problem = SceneProblem::TooManyTriangles { tag: e.tag().to_owned(), count, most: MADE_TRIANGLES };
            return Err(SceneError::at(e.place(), problem)
                .with_help("lower `warp`, `weft`, `segments` or `sides`; the count is 4 times their product"));
        }
        Ok(weave)
    }

    /// How many triangles it has: warp and weft each have two for every segment, side and crossing.
    pub fn triangles(&self) -> u64 {
        4 * u64::from(self.warp) * u64::from(self.weft) * u64::from(self.segments) * u64::from(self.sides)
    }

    /// Adds the yarns, as an object of the warp and one of the weft.
    pub fn add(&self, geometry: &mut Geometry, warp: u32, weft: u32, place: &Place) {
        let triangles = self.triangles() as usize;
        geometry.primitives.reserve_exact(triangles);
        geometry.normals.reserve_exact(triangles);
        geometry.uvs.reserve_exact(triangles);
        for (along_x, material) in [(true, warp), (false, weft)] {
            let count = if along_x { self.warp } else { self.weft };
            let before = geometry.primitives.len();
            let area: f64 = (0..count).map(|yarn| self.yarn(geometry, along_x, yarn)).sum();
            geometry.add_object(Object { material, surface_area: area as f32, place: place.clone() }, before);
        }
    }

    /// The cloth's middle at x and y, which are 0 to 1 from edge to edge, folds and all.
    fn ground(&self, x: f32, y: f32) -> Vec3 {
        let normal = self.edge_x.cross(self.edge_y).normalize();
        // Folds run toward one corner and fade, so that they look laid, not milled.
        let wave = sin(TAU * self.folds * (x + 0.15 * sin(PI * y))) * (0.55 + 0.45 * cos(PI * (y + 0.3 * x)));
        self.corner + x * self.edge_x + y * self.edge_y + self.depth * wave * normal
    }

    /// How far above the middle a yarn is at `crossing`, which counts crossings and is a half in their midst: -1 to 1.
    fn rise(&self, along_x: bool, yarn: u32, crossing: f32) -> f32 {
        let before = (crossing - 0.5).floor();
        let part = crossing - 0.5 - before;
        let height = |other: i64| {
            let (warp, weft) = if along_x { (i64::from(yarn), other) } else { (other, i64::from(yarn)) };
            if self.pattern.warp_is_over(warp, weft) == along_x { 1.0 } else { -1.0 }
        };
        let (a, b) = (height(before as i64), height(before as i64 + 1));
        a + (b - a) * part * part * (3.0 - 2.0 * part)
    }

    /// Half a yarn's width, and half its height: both kinds have the same height, or they would not fit.
    fn size(&self, along_x: bool) -> (f32, f32) {
        let across_warp = self.edge_y.length() / self.warp as f32;
        let across_weft = self.edge_x.length() / self.weft as f32;
        let width = if along_x { across_warp } else { across_weft };
        (0.46 * width, 0.5 * self.thickness * across_warp.min(across_weft) * 0.5)
    }

    /// Adds one yarn; gives its area.
    fn yarn(&self, geometry: &mut Geometry, along_x: bool, yarn: u32) -> f64 {
        let (count, crossings) = if along_x { (self.warp, self.weft) } else { (self.weft, self.warp) };
        let (steps, sides) = (crossings * self.segments, self.sides as usize);
        let object = geometry.objects.len() as u32;
        let across = (yarn as f32 + 0.5) / count as f32;
        let (mut last, mut area) = (Vec::new(), 0.0);
        for step in 0..=steps {
            let ring = self.ring(along_x, yarn, step as f32 / steps as f32, crossings as f32);
            for side in 0..sides.min(last.len()) {
                let next = (side + 1) % sides;
                let uv = |step: u32| {
                    let along = step as f32 / steps as f32;
                    if along_x { Vec2::new(along, across) } else { Vec2::new(across, along) }
                };
                let (from, to) = (uv(step - 1), uv(step));
                let corners = [(last[side], from), (last[next], from), (ring[next], to), (ring[side], to)];
                for [i, j, k] in [[0, 1, 2], [0, 2, 3]] {
                    area += push(geometry, object, [corners[i], corners[j], corners[k]]);
                }
            }
            last = ring;
        }
        area
    }

    /// Points and normals around a yarn at `along` in [0, 1].
    fn ring(&self, along_x: bool, yarn: u32, along: f32, crossings: f32) -> Vec<(Vec3, Vec3)> {
        let (half_width, half_height) = self.size(along_x);
        let count = if along_x { self.warp } else { self.weft };
        let across = (yarn as f32 + 0.5) / count as f32;
        let ground = |a: f32, b: f32| if along_x { self.ground(a, b) } else { self.ground(b, a) };
        // A step of a hundredth of a crossing: small beside a bend, large beside rounding.
        let e = 1e-2 / crossings.max(count as f32);
        let lengthwise = ground(along + e, across) - ground(along - e, across);
        let sidewise = ground(along, across + e) - ground(along, across - e);
        let turn = if along_x { 1.0 } else { -1.0 };
        let up = lengthwise.cross(sidewise).normalize_or(Vec3::Y) * turn;
        let center = |a: f32| ground(a, across) + up * half_height * self.rise(along_x, yarn, a * crossings);
        let tangent = (center(along + e) - center(along - e)).normalize_or(Vec3::X);
        let side = (sidewise - tangent * sidewise.dot(tangent)).normalize_or(Vec3::Z);
        let top = tangent.cross(side) * turn;
        let at = |i: u32| {
            let (sin, cos) = sincos(TAU * i as f32 / self.sides as f32);
            let point = center(along) + side * (half_width * cos) + top * (half_height * sin);
            let normal = side * (half_height * cos) + top * (half_width * sin);
            (point, normal.normalize_or(top))
        };
        (0..self.sides).map(at).collect()
    }
}

/// Adds a triangle with normals and texture coordinates, unless it has no area; gives its area.
fn push(geometry: &mut Geometry, object: u32, corners: [((Vec3, Vec3), Vec2); 3]) -> f64 {
    let [a, mut b, mut c] = corners;
    // The normal of its corners' order should agree with the yarn's.
    if (b.0.0 - a.0.0).cross(c.0.0 - a.0.0).dot(a.0.1) < 0.0 {
        (b, c) = (c, b);
    }
    let shape = Shape::Triangle { a: a.0.0, b: b.0.0, c: c.0.0 };
    let area = shape.area();
    if area > 0.0 {
        geometry.normals.push([a.0.1, b.0.1, c.0.1]);
        geometry.uvs.push([a.1, b.1, c.1]);
        let (normals, uvs) = (geometry.normals.len() as u32 - 1, geometry.uvs.len() as u32 - 1);
        geometry.primitives.push(Primitive { shape, object, normals, uvs });
    }
    f64::from(area)
}
