//! Evaluation: f cos and density of one direction a lane, summed over the lobes.

use super::batch::{LobeColumns, side_lanes};
use super::flat::{Flat, Lobe};
use super::lobe_kind::Way;
use super::source::Triples;
use super::store::NONE;
use crate::math::columns::Column3;
use glam::Vec3;
use std::ops::Range;

/// f cos and density of one direction a lane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluation {
    /// Sum over the lobes of weight * scale * f |cos|, 1/sr.
    pub f_cos: Column3,
    /// Density (solid angle, 1/sr) with which [`super::Lobes::sample`] chooses the direction.
    pub pdf: Vec<f32>,
}

/// See [`super::Lobes::evaluate`].
pub fn evaluate(flat: &mut Flat, wi: &Column3, out: &mut Evaluation) {
    evaluate_some(flat, 0..flat.lobes.len(), wi, out);
}

/// The same for lobes of these numbers alone.
pub fn evaluate_some(flat: &mut Flat, numbers: Range<usize>, wi: &Column3, out: &mut Evaluation) {
    let n = flat.lanes;
    for column in [&mut out.f_cos.x, &mut out.f_cos.y, &mut out.f_cos.z, &mut out.pdf] {
        column.clear();
        column.resize(n, 0.0);
    }
    flat.side.resize(n, 0.0);
    side_lanes(Triples::of(&flat.ng), Triples::of(&flat.wo), Triples::of(wi), &mut flat.side);
    flat.coats.light(flat.models.frames(), wi);
    flat.models.localise(&flat.coats, wi);
    flat.layers.scale(&flat.models, &flat.coats, &flat.ones);
    for index in numbers {
        let lobe = flat.lobes[index];
        let model = &flat.models.list[lobe.model as usize];
        let (Some(loops), Some(frame)) = (model.kind.loops(), flat.models.frame_of(model)) else { continue };
        let by_lobe = flat.layers.scales_by_lobe(lobe.layer);
        if by_lobe {
            let weight = &flat.weights[3 * n * index..];
            flat.layers.scale_lobe(&flat.models, index, lobe, weight, &mut flat.scaled);
        }
        let mut columns = LobeColumns {
            wo: Triples::of(&frame.wo),
            views: flat.models.views(model),
            wi: Triples::of(&frame.wi),
            side: &flat.side,
            weight: Triples::packed(&flat.weights[3 * n * index..], n),
            scale: flat.layers.scale_of(lobe.layer, &flat.ones),
            pick: &flat.picks[n * index..n * (index + 1)],
        };
        if by_lobe {
            (columns.weight, columns.scale) = (Triples::packed(&flat.scaled, n), &flat.ones);
        }
        if let Some(coat) = flat.coats.get(flat.layers.coat(lobe.layer)) {
            coat.carry(&columns, model.kind.is_even(), &mut flat.within);
            columns.weight = Triples::packed(&flat.within, n);
            (columns.scale, columns.pick) = (&flat.within[3 * n..4 * n], &flat.within[4 * n..]);
        }
        let sums = [&mut *out.f_cos.x, &mut *out.f_cos.y, &mut *out.f_cos.z];
        (loops.evaluate)(flat.models.numbers(model), model.choice, columns, sums, &mut out.pdf);
    }
}

/// See [`super::Lobes::straight`].
pub fn straight(flat: &mut Flat, scratch: &mut Evaluation, out: &mut Column3) {
    let n = flat.lanes;
    out.resize(n);
    for column in [&mut out.x, &mut out.y, &mut out.z] {
        column.fill(0.0);
    }
    let passes = |flat: &Flat, lobe: Lobe| matches!(flat.model(lobe).kind.way(), Way::Straight);
    if flat.lobes.iter().any(|&lobe| lobe.layer != NONE && passes(flat, lobe)) {
        // What layers and coats take depends on where light comes from.
        let mut behind = Column3::zeros(n);
        (0..n).for_each(|lane| behind.set(lane, -flat.wo.get(lane)));
        evaluate(flat, &behind, scratch);
    }
    for (index, &lobe) in flat.lobes.iter().enumerate().filter(|(_, lobe)| passes(flat, **lobe)) {
        let coat = flat.coats.get(flat.layers.coat(lobe.layer));
        for lane in 0..n {
            let tint = coat.map_or(Vec3::ONE, |coat| coat.tint(lane));
            out.set(lane, out.get(lane) + flat.scaled_weight(index, lane) * tint);
        }
    }
}
