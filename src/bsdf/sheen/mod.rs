//! The cloth sheen of Estevez and Kulla 2017, with its shadowing terms, albedo evaluators and samplers.
//!
//! Decision (2026-11-22): the exact shadowing term is the default, because it errs by at most 0.5 % of Lambda instead of
//! 34 %, costs less and never reflects more than arrives, instead of the published fit, which stays selectable.
//!
//! Decision (2026-11-22): roughness is clamped to 0.01..1, because below it the exponent of D passes 50 and single
//! floats lose D, instead of OSL's 0.06. `Differs from OSL:` its renderers clamp at 0.06. Albedo evaluators and samplers are
//! fitted on the same range. The published fit gains energy below r = 0.07; its albedo is cut at 1 there, as everywhere.
//!
//! Decision (2026-11-22): the constants of the exact Lambda are fitted for the least error of the albedo (6.6e-5, Lambda within
//! 0.57 %), because energy is what layering needs, instead of for the least error of Lambda alone (0.51 %, albedo 1.0e-4).
//!
//! Decision (2026-11-22): who wants Lambda to 1e-6 gets a Chebyshev series of 10 x 9 numbers, because it costs 2.8 ns a direction
//! (a whole lobe 9.9 instead of 8.2 ns), instead of the closed form summed term by term (128 terms: 212 ns, error 1.9e-6).
//! Eight of its terms err by 4.6e-4 and cost 0.84 ns, little more than the default (5.0e-3, 0.73 ns), but only from r = 0.06 up:
//! below it they cancel, and roughness goes down to 0.01, so they are no default.

pub mod albedo;
pub mod albedo_table;
pub mod charlie;
pub mod fibers;
pub mod fits;
pub mod normals;
pub mod proposals;
pub mod reference;
pub mod sampling;
pub mod shadowing;
pub mod term;

use super::{Choice, Eval, Params, Scatter, View, select};
use albedo::AlbedoCurve;
use glam::Vec3;
use sampling::{Aim, Proposal};
use shadowing::{Exact, Published, Series, soften};
use term::Shadowing;

/// Index of [`Shadowing::Exact`] as a constant parameter.
pub const EXACT: u8 = 0;
/// Index of [`Shadowing::Published`] as a constant parameter.
pub const PUBLISHED: u8 = 1;
/// Index of [`Shadowing::Ashikhmin`] as a constant parameter.
pub const ASHIKHMIN: u8 = 2;
/// Index of [`Shadowing::Series`] as a constant parameter.
pub const SERIES: u8 = 3;

/// The sheen lobe with F = 1, for one shadowing term and with or without the softened terminator.
///
/// Source: Estevez and Kulla 2017, eq. 1 to 4: f = D G / (4 cos_o cos_i).
/// Parameter: roughness. Choice: [`sampling::SheenSampling`].
/// Domain: roughness, clamped to 0.01..1; both directions above the horizon, else 0. Gives: f cos in 1/sr.
/// Degenerate cases: grazing light gives 0, grazing view a finite f cos (exact term); opposite directions in the horizon 0.
/// Reciprocal without softening. The visibility of Ashikhmin has no Lambda, so softening does not change it.
#[derive(Clone, Copy, Debug)]
pub struct Sheen<const SHADOWING: u8, const SOFT: bool> {
    n: f32,
    exact: Exact,
    published: Published,
    series: Series,
    albedo: AlbedoCurve,
    proposal: Proposal,
}

impl<const SHADOWING: u8, const SOFT: bool> Sheen<SHADOWING, SOFT> {
    /// Which shadowing term the constant parameter stands for.
    pub const TERM: Shadowing = match SHADOWING {
        EXACT => Shadowing::Exact,
        PUBLISHED => Shadowing::Published,
        SERIES => Shadowing::Series,
        _ => Shadowing::Ashikhmin,
    };

    /// f without the cosine, 1/sr. Zero below the horizon and at a grazing light.
    #[inline(always)]
    pub fn f(&self, wo: Vec3, wi: Vec3) -> f32 {
        select(wi.z > 0.0, self.f_cos(wo, self.masking(wo), wi) / wi.z.max(f32::MIN_POSITIVE), 0.0)
    }

    /// The viewer's part of the shadowing term, in the form that [`Sheen::f_cos`] takes.
    #[inline(always)]
    fn masking(&self, wo: Vec3) -> f32 {
        let co = wo.z.clamp(0.0, 1.0);
        match (SHADOWING, SOFT) {
            (EXACT, true) => 2.0 * (co + self.exact.f(co)),
            (EXACT, false) => 2.0 * self.exact.f(co),
            (PUBLISHED, _) => 4.0 * co * (1.0 + self.published.lambda(co)),
            (SERIES, true) => 2.0 * (co + self.series.f(co)),
            (SERIES, false) => 2.0 * self.series.f(co),
            _ => 4.0,
        }
    }

    /// f times the cosine of the light, 1/sr.
    #[inline(always)]
    fn f_cos(&self, wo: Vec3, masking: f32, wi: Vec3) -> f32 {
        let (co, ci) = (wo.z.clamp(0.0, 1.0), wi.z.clamp(0.0, 1.0));
        let d = charlie::distribution(charlie::sin2_half(wo, wi), self.n);
        // D over this denominator is f cos_i; each form stays finite as a cosine goes to zero.
        let denominator = match (SHADOWING, SOFT) {
            (EXACT, true) => masking + 4.0 * co * soften(self.exact.lambda(ci), ci),
            (EXACT, false) => masking + 2.0 * self.exact.f(ci) * co / ci.max(f32::MIN_POSITIVE),
            (PUBLISHED, true) => masking + 4.0 * co * soften(self.published.lambda(ci), ci),
            (PUBLISHED, false) => masking + 4.0 * co * self.published.lambda(ci),
            (SERIES, true) => masking + 4.0 * co * soften(self.series.lambda(ci), ci),
            (SERIES, false) => masking + 2.0 * self.series.f(ci) * co / ci.max(f32::MIN_POSITIVE),
            _ => masking * (1.0 + co * (1.0 - ci) / ci.max(f32::MIN_POSITIVE)),
        };
        let value = d / denominator.max(1e-30);
        select(co > 0.0 && ci > 0.0, value, 0.0)
    }
}

impl<const SHADOWING: u8, const SOFT: bool> Scatter for Sheen<SHADOWING, SOFT> {
    const PARAMS: usize = 1;
    const SHEEN: Option<bool> = if Self::TERM.is_exact() { Some(SOFT) } else { None };
    const VIEW: usize = 5;

    #[inline(always)]
    fn prepare([roughness, ..]: Params) -> Self {
        let r = charlie::clamp_roughness(roughness);
        let n = 1.0 / r;
        Sheen {
            n,
            exact: Exact::new(n),
            published: if SHADOWING == PUBLISHED { Published::new(r) } else { Published::NONE },
            series: if SHADOWING == SERIES { Series::new(n) } else { Series::NONE },
            albedo: AlbedoCurve::new(Self::TERM, SOFT, r),
            proposal: Proposal::new(Self::TERM, SOFT, r),
        }
    }

    #[inline(always)]
    fn choose(self, choice: Choice) -> Self {
        Sheen { proposal: self.proposal.by(choice.into()), ..self }
    }

    #[inline(always)]
    fn view(&self, wo: Vec3) -> View {
        let Aim { tilt, across, x, y } = self.proposal.view(wo);
        [self.masking(wo), tilt, across, x, y]
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, [masking, tilt, across, x, y]: View, wi: Vec3) -> Eval {
        Eval { f_cos: self.f_cos(wo, masking, wi), pdf: self.proposal.pdf(Aim { tilt, across, x, y }, wi) }
    }

    #[inline(always)]
    fn sample_from(&self, _wo: Vec3, [_, tilt, across, x, y]: View, xi: Vec3) -> Vec3 {
        self.proposal.sample(Aim { tilt, across, x, y }, xi)
    }

    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        if Self::TERM.is_exact() { self.albedo.at::<false>(cos) } else { self.albedo.at::<true>(cos) }
    }
}
