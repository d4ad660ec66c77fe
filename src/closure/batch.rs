//! The lane loops: each runs one model over all lanes of a batch, compiled for several instruction sets.
//!
//! Outputs are separate slices and inputs are borrowed apart from them, which lets the compiler prove that no store changes
//! an input, and turn the loops into SIMD. No target enables fused multiply-add, so every target gives the same bits.

use super::settings::Layering;
use crate::bsdf::{Scatter, select};
use crate::math::frame::Frame;
use glam::Vec3;
use multiversion::multiversion;

/// Where a loop takes a model's constants from.
pub trait Source<M>: Copy {
    /// The same source, cut to the lanes of the loop.
    fn narrow(self, lanes: usize) -> Self;
    /// The model of a lane.
    fn at(&self, lane: usize) -> M;
}

/// One model for all lanes: its constants are computed outside the loop.
#[derive(Clone, Copy)]
pub struct Same<M>(pub M);

/// A model a lane, from columns of parameters. Models with fewer than four parameters ignore the last columns.
#[derive(Clone, Copy)]
pub struct Each<'a>(pub [&'a [f32]; 4]);

impl<M: Copy> Source<M> for Same<M> {
    #[inline(always)]
    fn narrow(self, _lanes: usize) -> Self {
        self
    }

    #[inline(always)]
    fn at(&self, _lane: usize) -> M {
        self.0
    }
}

impl<M: Scatter> Source<M> for Each<'_> {
    #[inline(always)]
    fn narrow(self, lanes: usize) -> Self {
        let [a, b, c, d] = self.0;
        Each([&a[..lanes], &b[..lanes], &c[..lanes], &d[..lanes]])
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> M {
        let [a, b, c, d] = self.0;
        M::prepare([a[lane], b[lane], c[lane], d[lane]])
    }
}

/// Three columns borrowed as slices.
#[derive(Clone, Copy)]
pub struct Triples<'a> {
    /// First components.
    pub x: &'a [f32],
    /// Second components.
    pub y: &'a [f32],
    /// Third components.
    pub z: &'a [f32],
}

impl<'a> Triples<'a> {
    /// Borrows a column of triples.
    pub fn of(column: &'a crate::math::columns::Column3) -> Self {
        Triples { x: &column.x, y: &column.y, z: &column.z }
    }

    /// Three columns that lie one after the other.
    pub fn packed(data: &'a [f32], lanes: usize) -> Self {
        Triples { x: &data[..lanes], y: &data[lanes..2 * lanes], z: &data[2 * lanes..3 * lanes] }
    }

    #[inline(always)]
    fn narrow(self, lanes: usize) -> Self {
        Triples { x: &self.x[..lanes], y: &self.y[..lanes], z: &self.z[..lanes] }
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }
}

/// What [`evaluate_lanes`] reads beside the model.
#[derive(Clone, Copy)]
pub struct LobeColumns<'a> {
    /// Local direction to the viewer.
    pub wo: Triples<'a>,
    /// Local direction to the light.
    pub wi: Triples<'a>,
    /// Positive where both lie on one side of the geometric surface.
    pub side: &'a [f32],
    /// Weight of the lobe.
    pub weight: Triples<'a>,
    /// Scale of the layers over the lobe.
    pub scale: &'a [f32],
    /// Probability to pick the lobe.
    pub pick: &'a [f32],
}

/// Adds one lobe's f cos and density to the sums of all lanes.
///
/// Reflecting lobes give no light from below the geometric surface and transmitting ones none from above: shading normals
/// leak there. The density keeps what sampling does.
#[multiversion(targets("x86_64+avx2"))]
pub fn evaluate_lanes<M: Scatter, S: Source<M>>(
    source: S,
    from: LobeColumns<'_>,
    x: &mut [f32],
    y: &mut [f32],
    z: &mut [f32],
    pdf: &mut [f32],
) {
    let n = pdf.len();
    let (x, y, z) = (&mut x[..n], &mut y[..n], &mut z[..n]);
    let (wo, wi, weight) = (from.wo.narrow(n), from.wi.narrow(n), from.weight.narrow(n));
    let (side, scale, pick) = (&from.side[..n], &from.scale[..n], &from.pick[..n]);
    let source = source.narrow(n);
    for i in 0..n {
        let value = source.at(i).eval(wo.at(i), wi.at(i));
        let visible = if M::TRANSMITS { side[i] < 0.0 } else { side[i] > 0.0 };
        let f_cos = select(visible, value.f_cos, 0.0) * scale[i];
        x[i] += weight.x[i] * f_cos;
        y[i] += weight.y[i] * f_cos;
        z[i] += weight.z[i] * f_cos;
        pdf[i] += pick[i] * value.pdf;
    }
}

/// Samples one lobe in the lanes that chose it; other lanes keep their direction.
#[multiversion(targets("x86_64+avx2"))]
pub fn sample_lanes<M: Scatter, S: Source<M>>(
    source: S,
    wo: Triples<'_>,
    axes: [Triples<'_>; 3],
    xi: Triples<'_>,
    chosen: (&[u32], u32),
    x: &mut [f32],
    y: &mut [f32],
    z: &mut [f32],
) {
    let n = x.len();
    let (y, z) = (&mut y[..n], &mut z[..n]);
    let (wo, xi, source) = (wo.narrow(n), xi.narrow(n), source.narrow(n));
    let (tangent, bitangent, normal) = (axes[0].narrow(n), axes[1].narrow(n), axes[2].narrow(n));
    let (chosen, lobe) = (&chosen.0[..n], chosen.1);
    for i in 0..n {
        let local = source.at(i).sample(wo.at(i), xi.at(i));
        let frame = Frame { tangent: tangent.at(i), bitangent: bitangent.at(i), normal: normal.at(i) };
        let wi = frame.to_world(local);
        let mine = chosen[i] == lobe;
        x[i] = select(mine, wi.x, x[i]);
        y[i] = select(mine, wi.y, y[i]);
        z[i] = select(mine, wi.z, z[i]);
    }
}

/// The albedo of one model at the given cosines, whose sign is ignored.
#[multiversion(targets("x86_64+avx2"))]
pub fn albedo_lanes<M: Scatter, S: Source<M>>(source: S, cos: &[f32], out: &mut [f32]) {
    let n = out.len();
    let (cos, source) = (&cos[..n], source.narrow(n));
    for i in 0..n {
        out[i] = source.at(i).albedo(cos[i].abs().min(1.0));
    }
}

/// The mean albedo of one model.
pub fn average_lanes<M: Scatter, S: Source<M>>(source: S, out: &mut [f32]) {
    let source = source.narrow(out.len());
    for (i, value) in out.iter_mut().enumerate() {
        *value = source.at(i).average_albedo();
    }
}

/// World directions in the local frames of the lanes.
#[multiversion(targets("x86_64+avx2"))]
pub fn localise_lanes(axes: [Triples<'_>; 3], w: Triples<'_>, x: &mut [f32], y: &mut [f32], z: &mut [f32]) {
    let n = x.len();
    let (y, z, w) = (&mut y[..n], &mut z[..n], w.narrow(n));
    let (tangent, bitangent, normal) = (axes[0].narrow(n), axes[1].narrow(n), axes[2].narrow(n));
    for i in 0..n {
        let frame = Frame { tangent: tangent.at(i), bitangent: bitangent.at(i), normal: normal.at(i) };
        let local = frame.to_local(w.at(i));
        x[i] = local.x;
        y[i] = local.y;
        z[i] = local.z;
    }
}

/// The sign that tells on which sides of the geometric surface two directions lie: positive when on the same.
#[multiversion(targets("x86_64+avx2"))]
pub fn side_lanes(ng: Triples<'_>, wo: Triples<'_>, wi: Triples<'_>, out: &mut [f32]) {
    let n = out.len();
    let (ng, wo, wi) = (ng.narrow(n), wo.narrow(n), wi.narrow(n));
    for i in 0..n {
        // A missing geometric normal hides nothing: the shading normal decides alone.
        let (o, i_side) = (ng.at(i).dot(wo.at(i)), ng.at(i).dot(wi.at(i)));
        out[i] = select(o >= 0.0, i_side, -i_side);
    }
}

/// What [`layer_lanes`] reads.
#[derive(Clone, Copy)]
pub struct LayerColumns<'a> {
    /// Albedo of the top at the light direction, already times the coverage t.
    pub top_i: &'a [f32],
    /// Coverage t: the largest component of the tint.
    pub t: &'a [f32],
    /// alpha_o.
    pub alpha_o: &'a [f32],
    /// 1 / (1 - t mean a), for Kelemen's rule.
    pub inverse_mean: &'a [f32],
    /// Scale of the layer around this one.
    pub parent: &'a [f32],
}

/// The scale that a layer and all layers around it give to what lies under it.
#[multiversion(targets("x86_64+avx2"))]
pub fn layer_lanes(rule: Layering, from: LayerColumns<'_>, out: &mut [f32]) {
    let n = out.len();
    let (top_i, t, alpha_o) = (&from.top_i[..n], &from.t[..n], &from.alpha_o[..n]);
    let (inverse_mean, parent) = (&from.inverse_mean[..n], &from.parent[..n]);
    match rule {
        Layering::Min => {
            for i in 0..n {
                let alpha_i = (1.0 - t[i] * top_i[i]).max(0.0);
                out[i] = parent[i] * alpha_i.min(alpha_o[i]);
            }
        }
        Layering::View => {
            for i in 0..n {
                out[i] = parent[i] * alpha_o[i];
            }
        }
        Layering::Kelemen => {
            for i in 0..n {
                let alpha_i = (1.0 - t[i] * top_i[i]).max(0.0);
                out[i] = parent[i] * alpha_i * alpha_o[i] * inverse_mean[i];
            }
        }
    }
}

/// One step of picking a lobe: lanes whose number falls into this lobe's part take it, others move on.
#[multiversion(targets("x86_64+avx2"))]
pub fn pick_lanes(lobe: u32, pick: &[f32], left: &mut [f32], rest: &mut [f32], chosen: &mut [u32]) {
    let n = left.len();
    let (pick, rest, chosen) = (&pick[..n], &mut rest[..n], &mut chosen[..n]);
    for i in 0..n {
        let open = left[i] >= 0.0;
        let mine = open && left[i] < pick[i];
        // The number is used up to its place inside the part, and serves again as a fresh one.
        rest[i] = select(mine, (left[i] / pick[i].max(f32::MIN_POSITIVE)).min(0.999_999_94), rest[i]);
        chosen[i] = if mine { lobe } else { chosen[i] };
        left[i] = select(mine, -1.0, left[i] - select(open, pick[i], 0.0));
        left[i] = select(open && !mine, left[i].max(0.0), left[i]);
    }
}
