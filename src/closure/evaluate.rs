//! Evaluation: f cos and density of one direction a lane, summed over the lobes.

use super::batch::{LobeColumns, side_lanes};
use super::flat::Flat;
use super::source::Triples;
use crate::math::columns::Column3;

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
    for (index, &lobe) in flat.lobes.iter().enumerate() {
        let model = &flat.models.list[lobe.model as usize];
        let (Some(loops), Some(frame)) = (model.kind.loops(), flat.models.frame_of(model)) else { continue };
        let mut columns = LobeColumns {
            wo: Triples::of(&frame.wo),
            views: flat.models.views(model),
            wi: Triples::of(&frame.wi),
            side: &flat.side,
            weight: Triples::packed(&flat.weights[3 * n * index..], n),
            scale: flat.layers.scale_of(lobe.layer, &flat.ones),
            pick: &flat.picks[n * index..n * (index + 1)],
        };
        if let Some(coat) = flat.coats.get(flat.layers.coat(lobe.layer)) {
            coat.carry(&columns, model.kind.is_even(), &mut flat.within);
            columns.weight = Triples::packed(&flat.within, n);
            (columns.scale, columns.pick) = (&flat.within[3 * n..4 * n], &flat.within[4 * n..]);
        }
        let sums = [&mut *out.f_cos.x, &mut *out.f_cos.y, &mut *out.f_cos.z];
        (loops.evaluate)(flat.models.numbers(model), model.choice, columns, sums, &mut out.pdf);
    }
}
