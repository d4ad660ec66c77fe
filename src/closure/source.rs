//! What lane loops read: columns of triples, what a model derives from the viewer, and where its constants come from.

use crate::bsdf::{Choice, MAX_PARAMS, Params, Scatter, View};
use glam::Vec3;

/// An array of twelve values of a function of the index, written out: the array functions of the standard library are not
/// inlined in the lane loops, which would lose the lengths and with them their SIMD form.
macro_rules! twelve {
    ($f:ident) => {
        [$f(0), $f(1), $f(2), $f(3), $f(4), $f(5), $f(6), $f(7), $f(8), $f(9), $f(10), $f(11)]
    };
}

/// The parameters of a model, as a lobe keeps them.
#[derive(Clone, Copy, Debug)]
pub enum Numbers<'a> {
    /// The same in every lane.
    Same(Params),
    /// A column each; those that the model does not read may be anything of at least as many lanes.
    Each([&'a [f32]; MAX_PARAMS]),
}

/// Where a loop takes a model's constants from.
pub trait Source<M>: Copy {
    /// The same source, cut to the lanes of the loop.
    fn narrow(self, lanes: usize) -> Self;
    /// The model of a lane.
    fn at(&self, lane: usize) -> M;
    /// Multiplies by the adjustments of all lanes.
    fn adjust(&self, w: Triples<'_>, out: &mut [f32]);
    /// The top albedos of all lanes.
    fn top_albedos(&self, w: Triples<'_>, out: &mut [f32]);
}

/// One model for all lanes: its constants are computed outside the loop.
#[derive(Clone, Copy)]
pub struct Same<M>(pub M);

/// A model a lane, from columns of parameters; those that the model does not read may have any length.
#[derive(Clone, Copy)]
pub struct Each<'a> {
    /// The parameters.
    pub columns: [&'a [f32]; MAX_PARAMS],
    /// The way that all lanes go.
    pub choice: Choice,
}

impl<M: Scatter> Source<M> for Same<M> {
    #[inline(always)]
    fn narrow(self, _lanes: usize) -> Self {
        self
    }

    #[inline(always)]
    fn at(&self, _lane: usize) -> M {
        self.0
    }

    fn adjust(&self, w: Triples<'_>, out: &mut [f32]) {
        M::adjust(|_| self.0, [w.x, w.y, w.z], out);
    }

    #[inline(always)]
    fn top_albedos(&self, w: Triples<'_>, out: &mut [f32]) {
        self.0.top_albedos([w.x, w.y, w.z], out);
    }
}

impl<M: Scatter> Source<M> for Each<'_> {
    #[inline(always)]
    fn narrow(self, lanes: usize) -> Self {
        let cut = |k: usize| if k < M::PARAMS { &self.columns[k][..lanes] } else { &self.columns[k][..0] };
        Each { columns: twelve!(cut), choice: self.choice }
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> M {
        let value = |k: usize| if k < M::PARAMS { self.columns[k][lane] } else { 0.0 };
        M::prepare(twelve!(value)).choose(self.choice)
    }

    fn adjust(&self, w: Triples<'_>, out: &mut [f32]) {
        M::adjust(|lane| self.at(lane), [w.x, w.y, w.z], out);
    }

    #[inline(always)]
    fn top_albedos(&self, w: Triples<'_>, out: &mut [f32]) {
        for (i, value) in out.iter_mut().enumerate() {
            let model: M = self.at(i);
            *value = model.top_albedo(w.at(i));
        }
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

    /// The same columns, cut to the lanes of a loop.
    #[inline(always)]
    pub fn narrow(self, lanes: usize) -> Self {
        Triples { x: &self.x[..lanes], y: &self.y[..lanes], z: &self.z[..lanes] }
    }

    /// The triple of a lane.
    #[inline(always)]
    pub fn at(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }
}

/// The columns of what a model derives from the viewer; fewer than five for most models.
#[derive(Clone, Copy)]
pub struct Views<'a>(pub &'a [f32]);

impl<'a> Views<'a> {
    /// Five columns, of which those beyond the model's are never read.
    #[inline(always)]
    pub fn narrow<M: Scatter>(self, lanes: usize) -> [&'a [f32]; 5] {
        // Written out for the reason given at `twelve!`.
        let used = M::VIEW;
        [
            cut(self.0, 0, used, lanes),
            cut(self.0, 1, used, lanes),
            cut(self.0, 2, used, lanes),
            cut(self.0, 3, used, lanes),
            cut(self.0, 4, used, lanes),
        ]
    }
}

/// The column `k` of packed ones, empty when it is not used.
#[inline(always)]
fn cut(data: &[f32], k: usize, used: usize, lanes: usize) -> &[f32] {
    if k < used { &data[k * lanes..][..lanes] } else { &data[..0] }
}

/// One lane of the views.
#[inline(always)]
pub fn view_at<M: Scatter>(columns: &[&[f32]; 5], lane: usize) -> View {
    [
        if M::VIEW > 0 { columns[0][lane] } else { 0.0 },
        if M::VIEW > 1 { columns[1][lane] } else { 0.0 },
        if M::VIEW > 2 { columns[2][lane] } else { 0.0 },
        if M::VIEW > 3 { columns[3][lane] } else { 0.0 },
        if M::VIEW > 4 { columns[4][lane] } else { 0.0 },
    ]
}
