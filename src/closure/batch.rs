//! The lane loops: each runs one model over all lanes of a batch, compiled for several instruction sets.
//!
//! Outputs are separate slices and inputs are borrowed apart from them, which lets the compiler prove that no store changes
//! an input, and turn the loops into SIMD. No target enables fused multiply-add, so every target gives the same bits.

use super::settings::Layering;
use super::source::{Source, Triples, Views, view_at};
use crate::bsdf::sheen::albedo::AlbedoCurve;
use crate::bsdf::{Scatter, Side, select};
use crate::lanes;
use crate::math::columns::{pick, pick_bits};
use crate::math::frame::Frame;

lanes! {
    /// Computes what a model derives from the viewer, one column after the other.
    pub fn view_lanes<M: Scatter, S: Source<M>>(source: S, wo: Triples<'_>, out: &mut [f32]) {
        let n = wo.x.len();
        let (wo, source) = (wo.narrow(n), source.narrow(n));
        let (a, rest) = out.split_at_mut(if M::VIEW > 0 { n } else { 0 });
        let (b, rest) = rest.split_at_mut(if M::VIEW > 1 { n } else { 0 });
        let (c, rest) = rest.split_at_mut(if M::VIEW > 2 { n } else { 0 });
        let (d, rest) = rest.split_at_mut(if M::VIEW > 3 { n } else { 0 });
        let e = &mut rest[..if M::VIEW > 4 { n } else { 0 }];
        for i in 0..n {
            let view = source.at(i).view(wo.at(i));
            for (k, column) in [&mut *a, &mut *b, &mut *c, &mut *d, &mut *e].into_iter().enumerate() {
                if k < M::VIEW {
                    column[i] = view[k];
                }
            }
        }
    }
}

/// What [`evaluate_lanes`] reads beside the model.
#[derive(Clone, Copy)]
pub struct LobeColumns<'a> {
    /// Local direction to the viewer.
    pub wo: Triples<'a>,
    /// What the model derives from the viewer.
    pub views: Views<'a>,
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

lanes! {
    /// Adds one lobe's f cos and density to the sums of all lanes.
    ///
    /// Reflecting lobes give no light from below the geometric surface and transmitting ones none from above: shading normals
    /// leak there. The density keeps what sampling does.
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
        let views = from.views.narrow::<M>(n);
        let (side, scale, pick) = (&from.side[..n], &from.scale[..n], &from.pick[..n]);
        let source = source.narrow(n);
        for i in 0..n {
            let (model, view) = (source.at(i), view_at::<M>(&views, i));
            let value = model.eval_from(wo.at(i), view, wi.at(i));
            let visible = match M::SIDE {
                Side::Same => side[i] > 0.0,
                Side::Other => side[i] < 0.0,
                Side::Both => true,
            };
            let f_cos = select(visible, value.f_cos, 0.0) * scale[i];
            if M::COLORED {
                let color = model.color_from(wo.at(i), view, wi.at(i));
                x[i] += weight.x[i] * (f_cos * color.x);
                y[i] += weight.y[i] * (f_cos * color.y);
                z[i] += weight.z[i] * (f_cos * color.z);
            } else {
                x[i] += weight.x[i] * f_cos;
                y[i] += weight.y[i] * f_cos;
                z[i] += weight.z[i] * f_cos;
            }
            pdf[i] += pick[i] * value.pdf;
        }
    }
}

lanes! {
    /// Samples one lobe in the lanes that chose it; other lanes keep their direction.
    pub fn sample_lanes<M: Scatter, S: Source<M>>(
        source: S,
        viewer: (Triples<'_>, Views<'_>),
        axes: [Triples<'_>; 3],
        xi: Triples<'_>,
        chosen: (&[u32], u32),
        x: &mut [f32],
        y: &mut [f32],
        z: &mut [f32],
    ) {
        let n = x.len();
        let (y, z) = (&mut y[..n], &mut z[..n]);
        let (wo, views) = (viewer.0.narrow(n), viewer.1.narrow::<M>(n));
        let (xi, source) = (xi.narrow(n), source.narrow(n));
        let (tangent, bitangent, normal) = (axes[0].narrow(n), axes[1].narrow(n), axes[2].narrow(n));
        let (chosen, lobe) = (&chosen.0[..n], chosen.1);
        for i in 0..n {
            let local = source.at(i).sample_from(wo.at(i), view_at::<M>(&views, i), xi.at(i));
            let frame = Frame { tangent: tangent.at(i), bitangent: bitangent.at(i), normal: normal.at(i) };
            let wi = frame.to_world(local);
            let mine = chosen[i] == lobe;
            x[i] = pick(mine, wi.x, x[i]);
            y[i] = pick(mine, wi.y, y[i]);
            z[i] = pick(mine, wi.z, z[i]);
        }
    }
}

lanes! {
    /// The albedo of one model at the given cosines, whose sign is ignored.
    pub fn albedo_lanes<M: Scatter, S: Source<M>>(source: S, cos: &[f32], out: &mut [f32]) {
        let n = out.len();
        let (cos, source) = (&cos[..n], source.narrow(n));
        for i in 0..n {
            out[i] = source.at(i).albedo(cos[i].abs().min(1.0));
        }
    }
}

lanes! {
    /// The albedo of a sheen of one roughness by a method that is not the default.
    pub fn sheen_albedo_lanes<const METHOD: u8>(curve: AlbedoCurve, cos: &[f32], out: &mut [f32]) {
        let cos = &cos[..out.len()];
        for i in 0..out.len() {
            out[i] = curve.by::<METHOD>(cos[i].abs().min(1.0));
        }
    }
}

lanes! {
    /// The albedo of what lies on top of something for local directions, as exact as the model knows it.
    pub fn top_albedo_lanes<M: Scatter, S: Source<M>>(source: S, w: Triples<'_>, out: &mut [f32]) {
        source.narrow(out.len()).top_albedos(w.narrow(out.len()), out);
    }
}

lanes! {
    /// f between a cosine and those of the lanes, over that of a white Lambertian surface, on the mean over the azimuth.
    pub fn turned_lanes<M: Scatter, S: Source<M>>(source: S, node: f32, cos: &[f32], out: &mut [f32]) {
        let n = out.len();
        let (cos, source) = (&cos[..n], source.narrow(n));
        for i in 0..n {
            out[i] = source.at(i).turned(node, cos[i].abs().min(1.0));
        }
    }
}

/// The mean albedo of one model.
pub fn average_lanes<M: Scatter, S: Source<M>>(source: S, out: &mut [f32]) {
    let source = source.narrow(out.len());
    for (i, value) in out.iter_mut().enumerate() {
        *value = source.at(i).average_albedo();
    }
}

lanes! {
    /// Weights of samples from f cos and density: zero, with density zero, where nothing finite comes.
    pub fn weigh_lanes(f_cos: Triples<'_>, density: &[f32], x: &mut [f32], y: &mut [f32], z: &mut [f32], pdf: &mut [f32]) {
        let n = pdf.len();
        let (x, y, z) = (&mut x[..n], &mut y[..n], &mut z[..n]);
        let (f_cos, density) = (f_cos.narrow(n), &density[..n]);
        for i in 0..n {
            let w = f_cos.at(i) * (1.0 / density[i].max(f32::MIN_POSITIVE));
            let sum = w.x.abs() + w.y.abs() + w.z.abs();
            let good = (sum > 0.0) & (sum < f32::INFINITY) & (density[i] > 0.0) & (density[i] < f32::INFINITY);
            x[i] = select(good, w.x, 0.0);
            y[i] = select(good, w.y, 0.0);
            z[i] = select(good, w.z, 0.0);
            pdf[i] = select(good, density[i], 0.0);
        }
    }
}

lanes! {
    /// World directions in the local frames of the lanes.
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
}

lanes! {
    /// The sign that tells on which sides of the geometric surface two directions lie: positive when on the same.
    pub fn side_lanes(ng: Triples<'_>, wo: Triples<'_>, wi: Triples<'_>, out: &mut [f32]) {
        let n = out.len();
        let (ng, wo, wi) = (ng.narrow(n), wo.narrow(n), wi.narrow(n));
        for i in 0..n {
            // A missing geometric normal hides nothing: the shading normal decides alone.
            let (o, i_side) = (ng.at(i).dot(wo.at(i)), ng.at(i).dot(wi.at(i)));
            out[i] = select(o >= 0.0, i_side, -i_side);
        }
    }
}

/// The largest scale that Kelemen's rule may come to: it divides by what a layer lets through on the mean, once for each of any
/// number of layers.
pub const MOST_SCALE: f32 = 1e3;

/// What [`layer_lanes`] reads.
#[derive(Clone, Copy)]
pub struct LayerColumns<'a> {
    /// Albedo of the top at the light direction.
    pub top_i: &'a [f32],
    /// How much of the base is covered: the largest component of the tint.
    pub coverage: &'a [f32],
    /// alpha_o.
    pub alpha_o: &'a [f32],
    /// 1 / (1 - coverage mean a), for Kelemen's rule.
    pub inverse_mean: &'a [f32],
    /// Scale of the layer around this one.
    pub parent: &'a [f32],
}

lanes! {
    /// The scale that a layer and all layers around it give to what lies under it.
    pub fn layer_lanes(rule: Layering, from: LayerColumns<'_>, out: &mut [f32]) {
        let n = out.len();
        let (top_i, coverage, alpha_o) = (&from.top_i[..n], &from.coverage[..n], &from.alpha_o[..n]);
        let (inverse_mean, parent) = (&from.inverse_mean[..n], &from.parent[..n]);
        match rule {
            // What is not diffuse has the smaller of both sides under the rule without loss too.
            Layering::Min | Layering::Lossless => {
                for i in 0..n {
                    let alpha_i = (1.0 - coverage[i] * top_i[i]).max(0.0);
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
                    let alpha_i = (1.0 - coverage[i] * top_i[i]).max(0.0);
                    out[i] = (parent[i] * alpha_i * alpha_o[i] * inverse_mean[i]).min(MOST_SCALE);
                }
            }
        }
    }
}

lanes! {
    /// One step of picking a lobe: lanes whose number falls into this lobe's part take it, others move on.
    pub fn pick_lanes(lobe: u32, part: &[f32], left: &mut [f32], rest: &mut [f32], chosen: &mut [u32]) {
        let n = left.len();
        let (part, rest, chosen) = (&part[..n], &mut rest[..n], &mut chosen[..n]);
        for i in 0..n {
            let open = left[i] >= 0.0;
            let mine = open & (left[i] < part[i]);
            // The number is used up to its place inside the part, and serves again as a fresh one.
            rest[i] = pick(mine, (left[i] / part[i].max(f32::MIN_POSITIVE)).min(0.999_999_94), rest[i]);
            chosen[i] = pick_bits(mine, lobe, chosen[i]);
            let after = (left[i] - part[i]).max(0.0);
            left[i] = pick(mine, -1.0, pick(open, after, left[i]));
        }
    }
}

lanes! {
    /// Gives lanes that rounding left just behind the last part to the last lobe that can be picked.
    pub fn rest_lanes(none: u32, last: &[u32], rest: &mut [f32], chosen: &mut [u32]) {
        let n = chosen.len();
        let (last, rest) = (&last[..n], &mut rest[..n]);
        for i in 0..n {
            let open = chosen[i] == none;
            rest[i] = pick(open, 0.999_999_94, rest[i]);
            chosen[i] = pick_bits(open, last[i], chosen[i]);
        }
    }
}
