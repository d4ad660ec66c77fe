//! Kinds of lobes: one static table a model, of its constants and its lane loops.
//!
//! [`LobeKind::of`] makes the table of any [`Scatter`], of this crate or another, when the program is compiled. A lobe keeps
//! a reference to it, and each stage of a batch calls one function of it: one indirect call a lobe, stage and batch.
//!
//! Decision (2026-11-29): tables of functions instead of an enum of models with a macro that matched it at each use, because
//! a new model then touched the enum, the macro and three lists beside it, and none could come from outside the crate.

use super::batch::{
    LobeColumns, albedo_lanes, average_lanes, evaluate_lanes, sample_lanes, top_albedo_lanes, turned_lanes, view_lanes,
};
use super::event;
use super::source::{Each, Numbers, Same, Source, Triples, Views};
use crate::bsdf::specular::{Single, Specular};
use crate::bsdf::{ARRIVALS, Choice, Params, Scatter, Side, Spread};
use glam::Vec3;

/// What a lobe does with light: a model's table.
#[derive(Clone, Copy)]
pub struct LobeKind(&'static Table);

/// The constants of a kind, and how it scatters.
struct Table {
    name: fn() -> &'static str,
    event: u8,
    even: bool,
    flat: bool,
    way: Way,
}

/// In how many directions a kind scatters.
#[derive(Clone, Copy)]
pub(super) enum Way {
    /// Into many, with a density.
    Many(&'static Loops),
    /// Into one that the viewer and the parameters decide.
    One(&'static Meeting),
    /// Straight on.
    Straight,
}

/// A lobe of one direction.
pub(super) struct Meeting {
    /// Where light comes from for a local direction to the viewer, and how much.
    pub meet: fn(Vec3, Params) -> Specular,
    /// On which side of the surface.
    pub side: Side,
}

/// The lane loops of a model, which read its numbers and its choice.
pub(super) struct Loops {
    /// How many parameters it reads.
    pub params: usize,
    /// How many columns [`Loops::view`] fills.
    pub views: usize,
    /// See [`Scatter::SHEEN`].
    pub sheen: Option<bool>,
    /// See [`Scatter::TOP`].
    pub top: bool,
    /// Whether light comes through the surface.
    pub crosses: bool,
    /// True when some of its light leaves on the viewer's side.
    pub reflects: bool,
    /// What the viewer decides.
    pub view: fn(Numbers, Choice, Triples, &mut [f32]),
    /// f cos and density, added to three columns and one.
    #[allow(clippy::type_complexity)] // three columns and one, as the line above says
    pub evaluate: fn(Numbers, Choice, LobeColumns, [&mut [f32]; 3], &mut [f32]),
    /// Directions for the lanes that chose the lobe.
    pub sample: fn(Numbers, Choice, SampleColumns, [&mut [f32]; 3]),
    /// The albedo at cosines.
    pub albedo: fn(Numbers, Choice, &[f32], &mut [f32]),
    /// The albedo of local directions as a layer's top.
    pub top_albedo: fn(Numbers, Choice, Triples, &mut [f32]),
    /// Its mean.
    pub average: fn(Numbers, Choice, &mut [f32]),
    /// From where light comes, see [`Scatter::arrivals`]: cosines, and the parts they stand for.
    #[allow(clippy::type_complexity)] // four columns of each, as the line above says
    pub arrivals: Option<fn(Numbers, Choice, &[f32], [&mut [f32]; ARRIVALS], [&mut [f32]; ARRIVALS])>,
    /// f between a cosine and those of the lanes, see [`Scatter::turned`].
    pub turned: fn(Numbers, Choice, f32, &[f32], &mut [f32]),
}

/// What sampling a lobe reads beside its model.
#[derive(Clone, Copy)]
pub(super) struct SampleColumns<'a> {
    /// Local direction to the viewer, and what the model derives from it.
    pub viewer: (Triples<'a>, Views<'a>),
    /// The axes of the local frames.
    pub axes: [Triples<'a>; 3],
    /// Three numbers in [0, 1).
    pub xi: Triples<'a>,
    /// The lobe that each lane chose, and the number of this one.
    pub chosen: (&'a [u32], u32),
}

impl LobeKind {
    /// Light that passes straight on, whatever the normal.
    pub const STRAIGHT: LobeKind = LobeKind(&Table {
        name: || "straight on",
        event: event::STRAIGHT,
        even: false,
        flat: false,
        way: Way::Straight,
    });

    /// The kind of a model.
    pub const fn of<M: Scatter>() -> LobeKind {
        LobeKind(OfModel::<M>::TABLE)
    }

    /// The kind of a model of one direction.
    pub const fn single<S: Single>() -> LobeKind {
        LobeKind(OfSingle::<S>::TABLE)
    }

    /// True for lobes of one direction, which have no density.
    pub fn is_delta(self) -> bool {
        !matches!(self.0.way, Way::Many(_))
    }

    /// True for lobes with a density that see light behind the surface.
    pub(super) fn crosses(self) -> bool {
        matches!(self.0.way, Way::Many(loops) if loops.crosses)
    }

    /// True for lobes that scatter light about evenly, whatever the directions: what a coat throws back at them comes out
    /// in the end. Sheens, and the light under a highlight, prefer directions, and take the rule that is safe for all.
    pub(super) fn is_even(self) -> bool {
        self.0.even
    }

    /// True for lobes that scatter about evenly, but are not Lambertian.
    pub(super) fn leans(self) -> bool {
        self.0.even && !self.0.flat
    }

    /// True for rough lobes that know from where their light arrives.
    pub(super) fn is_rough(self) -> bool {
        self.loops().is_some_and(|loops| loops.arrivals.is_some())
    }

    /// What sampling it counts as, see [`event`].
    pub(super) fn event(self) -> u8 {
        self.0.event
    }

    /// In how many directions it scatters, and by which functions.
    pub(super) fn way(self) -> Way {
        self.0.way
    }

    /// The lane loops of a kind that has a density.
    pub(super) fn loops(self) -> Option<&'static Loops> {
        if let Way::Many(loops) = self.0.way { Some(loops) } else { None }
    }
}

impl std::fmt::Debug for LobeKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "LobeKind({})", (self.0.name)())
    }
}

/// Gives a static home to the table of a model.
struct OfModel<M>(std::marker::PhantomData<M>);

impl<M: Scatter> OfModel<M> {
    const TABLE: &'static Table = &Table {
        name: std::any::type_name::<M>,
        event: match M::SPREAD {
            Spread::Even | Spread::Broad => event::DIFFUSE,
            Spread::Narrow => event::GLOSSY,
        },
        even: matches!(M::SPREAD, Spread::Even),
        flat: M::FLAT,
        way: Way::Many(&Loops {
            params: M::PARAMS,
            views: M::VIEW,
            sheen: M::SHEEN,
            top: M::TOP,
            crosses: !matches!(M::SIDE, Side::Same),
            reflects: !matches!(M::SIDE, Side::Other),
            view: view::<M>,
            evaluate: evaluate::<M>,
            sample: sample::<M>,
            albedo: albedo::<M>,
            top_albedo: top_albedo::<M>,
            average: average::<M>,
            arrivals: if M::ARRIVALS { Some(arrivals::<M>) } else { None },
            turned: turned::<M>,
        }),
    };
}

/// Gives a static home to the table of a model of one direction.
struct OfSingle<S>(std::marker::PhantomData<S>);

impl<S: Single> OfSingle<S> {
    const TABLE: &'static Table = &Table {
        name: std::any::type_name::<S>,
        event: match S::SIDE {
            Side::Same => event::DELTA_REFLECT,
            Side::Other | Side::Both => event::DELTA_REFRACT,
        },
        even: false,
        flat: false,
        way: Way::One(&Meeting { meet: S::meet, side: S::SIDE }),
    };
}

/// Runs a lane loop with the source that a model's numbers ask for.
macro_rules! with_source {
    ($numbers:ident, $choice:ident, |$source:ident| $body:expr) => {
        match $numbers {
            Numbers::Same(params) => {
                let $source = Same(M::prepare(params).choose($choice));
                $body
            }
            Numbers::Each(columns) => {
                let $source = Each { columns, choice: $choice };
                $body
            }
        }
    };
}

fn view<M: Scatter>(numbers: Numbers, choice: Choice, wo: Triples, out: &mut [f32]) {
    with_source!(numbers, choice, |source| {
        view_lanes::<M, _>(source, wo, out);
        if let (Some(column), true) = (M::ADJUSTED, M::adjusts(choice)) {
            let n = wo.x.len();
            Source::<M>::adjust(&source, wo, &mut out[column * n..(column + 1) * n]);
        }
    });
}

fn evaluate<M: Scatter>(
    numbers: Numbers,
    choice: Choice,
    from: LobeColumns,
    [x, y, z]: [&mut [f32]; 3],
    pdf: &mut [f32],
) {
    with_source!(numbers, choice, |source| evaluate_lanes::<M, _>(source, from, x, y, z, pdf));
}

fn sample<M: Scatter>(numbers: Numbers, choice: Choice, from: SampleColumns, [x, y, z]: [&mut [f32]; 3]) {
    let SampleColumns { viewer, axes, xi, chosen } = from;
    with_source!(numbers, choice, |source| sample_lanes::<M, _>(source, viewer, axes, xi, chosen, x, y, z));
}

fn albedo<M: Scatter>(numbers: Numbers, choice: Choice, cos: &[f32], out: &mut [f32]) {
    with_source!(numbers, choice, |source| albedo_lanes::<M, _>(source, cos, out));
}

fn top_albedo<M: Scatter>(numbers: Numbers, choice: Choice, w: Triples, out: &mut [f32]) {
    with_source!(numbers, choice, |source| top_albedo_lanes::<M, _>(source, w, out));
}

fn average<M: Scatter>(numbers: Numbers, choice: Choice, out: &mut [f32]) {
    with_source!(numbers, choice, |source| average_lanes::<M, _>(source, out));
}

fn turned<M: Scatter>(numbers: Numbers, choice: Choice, node: f32, cos: &[f32], out: &mut [f32]) {
    with_source!(numbers, choice, |source| turned_lanes::<M, _>(source, node, cos, out));
}

fn arrivals<M: Scatter>(
    numbers: Numbers,
    choice: Choice,
    cos: &[f32],
    at: [&mut [f32]; ARRIVALS],
    parts: [&mut [f32]; ARRIVALS],
) {
    with_source!(numbers, choice, |source| {
        for (lane, cos) in cos.iter().enumerate() {
            let model: M = source.at(lane);
            for (k, (arrives, part)) in model.arrivals(cos.abs().min(1.0)).into_iter().enumerate() {
                (at[k][lane], parts[k][lane]) = (arrives, part);
            }
        }
    });
}
