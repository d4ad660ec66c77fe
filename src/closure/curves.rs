//! Albedo curves of sheens whose roughness differs between lanes, kept from the viewer's side for the light's.
//!
//! Decision (2026-11-22): the coefficients of a covering sheen's curve are kept a lane, because they take a logarithm and 28 steps of
//! a recurrence, and each evaluation asks for them again (a weave and one evaluation take 78 ns a point instead of 84, with the
//! shorter way of `normals`); instead of making the curve anew from the roughness.

use super::lobe_models::{LobeModel, LobeModels};
use super::settings::SheenAlbedo;
use super::store::Store;
use crate::bsdf::sheen::albedo::{AlbedoCurve, SHORT};
use crate::bsdf::sheen::charlie::clamp_roughness;
use crate::bsdf::sheen::shadowing::Shadowing;
use crate::lanes;
use crate::math::columns::copy_block;

/// How many lanes lie together: a few vectors of the widest kind.
const BLOCK: usize = 16;

/// The coefficients of a block of lanes.
pub type Curves = [[f32; BLOCK]; SHORT];

/// Adds the curves of a model, where it is a sheen that has one a lane; says how many blocks there were before, or nothing.
pub fn push_curves(models: &LobeModels, model: &LobeModel, curves: &mut Store<Curves>) -> Option<u32> {
    let soft = model.kind.loops()?.sheen?;
    let roughness = models.first_param(model)?;
    if models.sheen_albedo != SheenAlbedo::Fit {
        return None;
    }
    let at = curves.take(models.lanes.div_ceil(BLOCK));
    if soft {
        curve_lanes::<true>(roughness, &mut curves[at..]);
    } else {
        curve_lanes::<false>(roughness, &mut curves[at..]);
    }
    Some(at as u32)
}

lanes! {
    fn curve_lanes<const SOFT: bool>(roughness: &[f32], out: &mut [Curves]) {
        for (from, out) in roughness.chunks(BLOCK).zip(out) {
            let mut r = [1.0; BLOCK];
            copy_block::<BLOCK>(&mut r[..from.len()], from);
            for l in 0..BLOCK {
                let terms = AlbedoCurve::new(Shadowing::Exact, SOFT, clamp_roughness(r[l])).terms();
                for k in 0..SHORT {
                    out[k][l] = terms[k];
                }
            }
        }
    }
}

lanes! {
    /// The albedos of kept curves at the given cosines, whose sign is ignored: the same bits as from the roughness.
    pub fn curve_albedo_lanes(curves: &[Curves], cos: &[f32], out: &mut [f32]) {
        for ((curves, from), out) in curves.iter().zip(cos.chunks(BLOCK)).zip(out.chunks_mut(BLOCK)) {
            let (mut c, mut albedo) = ([1.0; BLOCK], [0.0; BLOCK]);
            copy_block::<BLOCK>(&mut c[..from.len()], from);
            for l in 0..BLOCK {
                let mut terms = [0.0; SHORT];
                for k in 0..SHORT {
                    terms[k] = curves[k][l];
                }
                albedo[l] = AlbedoCurve::of(terms).at::<false>(c[l].abs().min(1.0));
            }
            copy_block::<BLOCK>(out, &albedo[..from.len()]);
        }
    }
}
