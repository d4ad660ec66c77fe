//! Scattering models: one file a model, plain scalar functions in the local frame where the shading normal is z.
//!
//! A model is a small `Copy` struct of constants made once from its parameters. Its functions are branch-free and
//! `#[inline(always)]`, so that a loop over lanes becomes SIMD code of whatever width the machine has, with equal bits
//! on every width.
//!
//! The room knows no closure and no tree; [`crate::closure`] turns closures into these models.
//!
//! Decision (2026-11-22): what depends on the viewer alone ([`Scatter::view`]) is computed once a batch and kept in columns,
//! because a direction is evaluated twice for one viewer at least (a light and a sample), which with the short powers took
//! cloth from 21 to 12 ns a direction, instead of computing it with every direction.
//!
//! Decision (2026-11-22): [`Eval`] holds one float for f |cos|, not a triple, because most models are achromatic and color
//! is a weight of the lobe, instead of three equal floats that the lane loops would multiply and keep. A model whose color
//! depends on the directions (a conductor) gives it apart, in [`Scatter::color_from`], which the others never run.

pub mod ashikhmin_shirley;
pub mod bivariate;
pub mod burley;
pub mod cosine_power;
pub mod eon;
pub mod fresnel;
pub mod hair;
pub mod lafortune;
pub mod lambert;
pub mod microfacet;
pub mod oren_nayar;
pub mod phong;
pub mod power;
pub mod sheen;
pub mod specular;
pub mod velvet;
pub mod ward;

use crate::math::quadrature::GAUSS_8;
use glam::Vec3;

/// What a model says about one pair of directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Eval {
    /// f * |cos_i|, 1/sr.
    pub f_cos: f32,
    /// Density (solid angle, 1/sr) with which [`Scatter::sample`] chooses `wi`.
    pub pdf: f32,
}

/// The most parameters that a model can have.
pub const MAX_PARAMS: usize = 12;

/// The parameters of a model; those beyond [`Scatter::PARAMS`] are never read.
pub type Params = [f32; MAX_PARAMS];

/// Fills up parameters with zeros.
#[inline(always)]
pub fn params<const N: usize>(values: [f32; N]) -> Params {
    let mut out = [0.0; MAX_PARAMS];
    out[..N].copy_from_slice(&values);
    out
}

/// On which side of the surface a model scatters, as seen from the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// On the viewer's side: it reflects.
    Same,
    /// On the other side: it transmits.
    Other,
    /// On both.
    Both,
}

/// How wide a model scatters, whatever the parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    /// About evenly in every direction, so that light which is thrown back at it from above comes out in the end: diffuse.
    Even,
    /// Widely, with a preference for some directions: sheen.
    Broad,
    /// About one direction: glossy.
    Narrow,
}

/// Which of several ways a model goes, the same in all lanes of a lobe: a choice of the model's own, as a number. 0 is the default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Choice(pub u8);

/// How many cosines stand for the light that a model sends to a direction.
pub const ARRIVALS: usize = 4;

/// Cosines at which light arrives, each with the part of all light that it stands for: together 1.
pub type Arrivals = [(f32, f32); ARRIVALS];

/// Of a model of which nothing is known: all arrives where it leaves, the last to be taken for lower than that.
#[inline(always)]
pub(crate) fn unknown_arrivals(cos: f32) -> Arrivals {
    let mut all = [(cos, 0.0); ARRIVALS];
    all[ARRIVALS - 1].1 = 1.0;
    all
}

/// Up to five numbers that a model derives from the viewer's direction.
pub type View = [f32; 5];

/// A scattering model with its constants, as the lane loops see it.
///
/// Directions are unit, local (z = shading normal) and point away from the surface; `wo.z` is positive.
pub trait Scatter: Copy + 'static {
    /// How many of the parameters it reads, at most [`MAX_PARAMS`].
    const PARAMS: usize;
    /// Where light leaves the surface.
    const SIDE: Side = Side::Same;
    /// True when f is one number for all pairs of directions.
    const FLAT: bool = false;
    /// How wide it scatters.
    const SPREAD: Spread = Spread::Broad;
    /// True when [`Scatter::top_albedo`] is more exact than [`Scatter::albedo`], and dearer.
    const TOP: bool = false;
    /// For sheens whose albedo is [`sheen::albedo::AlbedoCurve::exact`] of their first parameter: whether they are softened. Such an
    /// albedo may be found by several methods, and be kept from one direction for others.
    const SHEEN: Option<bool> = None;
    /// True when [`Scatter::color_from`] is not white everywhere.
    const COLORED: bool = false;
    /// Makes the constants from parameters, which are clamped to what the model supports.
    fn prepare(params: Params) -> Self;
    /// The same model, going another way than by default; models with one way only go it.
    #[inline(always)]
    fn choose(self, _choice: Choice) -> Self {
        self
    }
    /// How many of the numbers of [`Scatter::view`] it uses.
    const VIEW: usize = 0;
    /// What depends on the viewer alone, computed once for all directions that are evaluated.
    #[inline(always)]
    fn view(&self, _wo: Vec3) -> View {
        View::default()
    }
    /// The number of [`Scatter::view`] that is multiplied by [`Scatter::adjust`] for choices that ask for it.
    const ADJUSTED: Option<usize> = None;
    /// Does a choice ask for an adjustment?
    fn adjusts(_choice: Choice) -> bool {
        false
    }
    /// Multiplies the numbers of lanes, each of its own model, by what depends on the viewer alone and takes too long, or too many
    /// branches, for the lane loops; viewers are one column a component.
    fn adjust(_model: impl Fn(usize) -> Self, _wo: [&[f32]; 3], _out: &mut [f32]) {}
    /// f |cos_i| and density of one direction; zero where the model scatters nothing, never NaN.
    fn eval_from(&self, wo: Vec3, view: View, wi: Vec3) -> Eval;
    /// What f |cos_i| is multiplied with to give its color, >= 0.
    #[inline(always)]
    fn color_from(&self, _wo: Vec3, _view: View, _wi: Vec3) -> Vec3 {
        Vec3::ONE
    }
    /// A direction for three numbers in [0, 1); it may lie where `eval` gives zero, and is zero when there is none.
    fn sample_from(&self, wo: Vec3, view: View, xi: Vec3) -> Vec3;
    /// [`Scatter::eval_from`] without a view at hand, for a choice that asks for no adjustment.
    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> Eval {
        self.eval_from(wo, self.view(wo), wi)
    }
    /// f |cos_i| with its color, 1/sr, without a view at hand.
    #[inline(always)]
    fn colored(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        let view = self.view(wo);
        self.color_from(wo, view, wi) * self.eval_from(wo, view, wi).f_cos
    }
    /// [`Scatter::sample_from`] without a view at hand.
    #[inline(always)]
    fn sample(&self, wo: Vec3, xi: Vec3) -> Vec3 {
        self.sample_from(wo, self.view(wo), xi)
    }
    /// Directional albedo at this cosine (of its largest component), an estimate that each model documents.
    fn albedo(&self, cos: f32) -> f32;
    /// The albedo of a unit local direction as exact as the model knows it: what a layer's top takes from its base.
    #[inline(always)]
    fn top_albedo(&self, w: Vec3) -> f32 {
        self.albedo(w.z.abs().min(1.0))
    }
    /// [`Scatter::top_albedo`] of many directions, one column a component, with the same bits.
    #[inline(always)]
    fn top_albedos(&self, [x, y, z]: [&[f32]; 3], out: &mut [f32]) {
        let n = out.len();
        let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
        for i in 0..n {
            out[i] = self.top_albedo(Vec3::new(x[i], y[i], z[i]));
        }
    }
    /// pi f of two cosines 0..1 on the mean over the azimuth between them; read for models of [`Spread::Even`].
    ///
    /// Source: the mean of eight azimuths, where a model has no closed form.
    #[inline(always)]
    fn turned(&self, cos_i: f32, cos_o: f32) -> f32 {
        let sine = |cos: f32| ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
        let wo = Vec3::new(sine(cos_o), 0.0, cos_o);
        let (view, mut sum) = (self.view(wo), 0.0);
        for (x, y) in [(0.980_785_3, 0.195_090_32), (0.831_469_6, 0.555_570_2)] {
            for (x, y) in [(x, y), (y, x), (-x, y), (-y, x)] {
                let wi = Vec3::new(x * sine(cos_i), y * sine(cos_i), cos_i);
                sum += self.eval_from(wo, view, wi).f_cos;
            }
        }
        sum * (std::f32::consts::PI / 8.0) / cos_i.max(1e-6)
    }
    /// True when [`Scatter::arrivals`] says something.
    const ARRIVALS: bool = false;
    /// From where light comes that leaves at a cosine 0..1: a rule for its integral, which is good for what arrives lower, and right
    /// to first order for the rest.
    fn arrivals(&self, cos: f32) -> Arrivals {
        unknown_arrivals(cos)
    }
    /// Mean of [`Scatter::top_albedo`] over the hemisphere, weighted by the cosine, at an azimuth between x and y.
    ///
    /// Source: Gauss-Legendre of 8 nodes in the cube root of the cosine, exact for albedos of degree 10 in it.
    #[inline(always)]
    fn average_albedo(&self) -> f32 {
        let mut sum = 0.0;
        for (x, weight) in GAUSS_8 {
            for t in [0.5 - 0.5 * x, 0.5 + 0.5 * x] {
                let t2 = t * t;
                sum += 3.0 * weight * t2 * t2 * t * self.top_albedo(between(t2 * t));
            }
        }
        sum
    }
}

/// The direction of a cosine halfway between the x and the y axis.
#[inline(always)]
pub(crate) fn between(cos: f32) -> Vec3 {
    let side = (0.5 * (1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    Vec3::new(side, side, cos)
}

/// One lane's choice between two numbers, which compiles to a blend.
#[inline(always)]
pub(crate) fn select(condition: bool, yes: f32, no: f32) -> f32 {
    if condition { yes } else { no }
}

/// A parameter limited to its domain; what is not a number becomes the lower end, which `clamp` would let through.
#[inline(always)]
pub(crate) fn limited(value: f32, least: f32, most: f32) -> f32 {
    value.max(least).min(most)
}

/// A sampled direction, or none when it lies below the horizon: kept, it would count for a transmitting lobe beside this
/// one, which could have found it with another density.
#[inline(always)]
pub(crate) fn above_horizon(w: Vec3) -> Vec3 {
    w * select(w.z > 0.0, 1.0, 0.0)
}
