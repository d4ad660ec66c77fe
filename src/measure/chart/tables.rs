//! Tables of the albedo, to compare polynomials with: by resolution, axes and interpolation.

use super::truth::albedos;
use crate::bsdf::sheen::albedo::cube_root;
use crate::bsdf::sheen::reference::Model;
use crate::math::quadrature::gauss_legendre;

/// How a table is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The nearest node.
    Nearest,
    /// Linear in both axes.
    Bilinear,
    /// Catmull and Rom's cubic in both axes, linear at the edges.
    Bicubic,
}

/// How the axes of a table run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// Cube root of the cosine from 1e-4, logarithm of the roughness from 0.06.
    Bent,
    /// Cosine and roughness themselves.
    Plain,
}

/// Albedos at the nodes of a grid.
#[derive(Clone, Debug)]
pub struct Table {
    across: usize,
    down: usize,
    axes: Axes,
    values: Vec<f32>,
}

const LEAST_COS: f64 = 1e-4;
const LEAST_R: f64 = 0.06;

impl Table {
    /// Fills a table of cells by quadrature; it has half as many in roughness.
    pub fn new(cells: usize, axes: Axes, steps: usize) -> Self {
        let (across, down) = (cells + 1, cells / 2 + 1);
        let at = |k: usize, count: usize| k as f64 / (count - 1) as f64;
        let cosines: Vec<f64> = (0..across).map(|k| cosine(axes, at(k, across))).collect();
        let rs: Vec<f64> = (0..down).map(|k| roughness(axes, at(k, down))).collect();
        let rows = albedos(Model::ExactFit, true, &rs, &cosines, steps);
        Table { across, down, axes, values: rows.into_iter().flatten().map(|v| v as f32).collect() }
    }

    /// Every second node.
    pub fn halved(&self) -> Self {
        let (across, down) = (self.across / 2 + 1, self.down / 2 + 1);
        let at = |k: usize| self.values[2 * (k / across) * self.across + 2 * (k % across)];
        Table { across, down, axes: self.axes, values: (0..across * down).map(at).collect() }
    }

    /// Where a roughness lies in the table, in nodes.
    pub fn row(&self, r: f32) -> f32 {
        let place = match self.axes {
            Axes::Bent => 1.0 - r.max(LEAST_R as f32).ln() / LEAST_R.ln() as f32,
            Axes::Plain => (r - LEAST_R as f32) / (1.0 - LEAST_R as f32),
        };
        place.clamp(0.0, 1.0) * (self.down - 1) as f32
    }

    /// The albedo at a cosine and a place from [`Table::row`].
    #[inline(always)]
    pub fn at(&self, cos: f32, row: f32, interpolation: Interpolation) -> f32 {
        const LEAST_T: f32 = 0.046_415_888;
        let place = match self.axes {
            Axes::Bent => (cube_root(cos.max(LEAST_COS as f32)) - LEAST_T) / (1.0 - LEAST_T),
            Axes::Plain => cos,
        };
        let x = place.clamp(0.0, 1.0) * (self.across - 1) as f32;
        match interpolation {
            Interpolation::Nearest => self.node((x + 0.5) as usize, (row + 0.5) as usize),
            Interpolation::Bilinear => {
                let (i, j) = ((x as usize).min(self.across - 2), (row as usize).min(self.down - 2));
                let (a, b) = (x - i as f32, row - j as f32);
                let low = self.node(i, j) * (1.0 - a) + self.node(i + 1, j) * a;
                let high = self.node(i, j + 1) * (1.0 - a) + self.node(i + 1, j + 1) * a;
                low * (1.0 - b) + high * b
            }
            Interpolation::Bicubic => self.cubic(x, row),
        }
    }

    #[inline(always)]
    fn node(&self, i: usize, j: usize) -> f32 {
        self.values[j.min(self.down - 1) * self.across + i.min(self.across - 1)]
    }

    #[inline(always)]
    fn cubic(&self, x: f32, row: f32) -> f32 {
        let (i, j) = ((x as usize).min(self.across - 2), (row as usize).min(self.down - 2));
        let (wx, wy) = (catmull_rom(x - i as f32), catmull_rom(row - j as f32));
        let mut sum = 0.0;
        for (b, wy) in wy.iter().enumerate() {
            for (a, wx) in wx.iter().enumerate() {
                sum += wx * wy * self.beyond(i as i32 + a as i32 - 1, j as i32 + b as i32 - 1);
            }
        }
        sum
    }

    /// A node, or beyond an edge the line through the last two nodes.
    #[inline(always)]
    fn beyond(&self, i: i32, j: i32) -> f32 {
        let (across, down) = (self.across as i32, self.down as i32);
        let inner = |i: i32| {
            let j0 = j.clamp(0, down - 1);
            let here = self.node(i as usize, j0 as usize);
            let back = if j < 0 { 1 } else { down - 2 };
            if j == j0 { here } else { 2.0 * here - self.node(i as usize, back as usize) }
        };
        let i0 = i.clamp(0, across - 1);
        let back = if i < 0 { 1 } else { across - 2 };
        if i == i0 { inner(i) } else { 2.0 * inner(i0) - inner(back) }
    }
}

#[inline(always)]
fn catmull_rom(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [-0.5 * t + t2 - 0.5 * t3, 1.0 - 2.5 * t2 + 1.5 * t3, 0.5 * t + 2.0 * t2 - 1.5 * t3, 0.5 * (t3 - t2)]
}

fn cosine(axes: Axes, place: f64) -> f64 {
    let least = LEAST_COS.cbrt();
    match axes {
        Axes::Bent => (least + (1.0 - least) * place).powi(3),
        // At cosine 0 the integral is not defined; what a table would hold there is the limit.
        Axes::Plain => place.max(LEAST_COS),
    }
}

fn roughness(axes: Axes, place: f64) -> f64 {
    match axes {
        Axes::Bent => ((1.0 - place) * LEAST_R.ln()).exp(),
        Axes::Plain => LEAST_R + (1.0 - LEAST_R) * place,
    }
}

/// Nodes of a direct integral over light directions: cosines in their cube root, and azimuths of the half space.
pub fn nodes(count: usize) -> Vec<(glam::Vec3, f32)> {
    let mut out = Vec::with_capacity(count * count);
    for ring in gauss_legendre(count, 0.0, 1.0) {
        let cos = ring.x.powi(3);
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        for turn in gauss_legendre(count, 0.0, std::f64::consts::PI) {
            let w = glam::Vec3::new((sin * turn.x.cos()) as f32, (sin * turn.x.sin()) as f32, cos as f32);
            out.push((w, (2.0 * turn.weight * ring.weight * 3.0 * ring.x * ring.x) as f32));
        }
    }
    out
}
