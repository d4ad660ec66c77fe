//! Rough boundaries: microfacets of a distribution and a Fresnel term, reflecting or refracting.
//!
//! A closure that does both becomes one reflecting and one refracting lobe. The index is transmitted over incident as seen
//! from the side of the normal; radiance is not scaled by 1 / eta², as in OSL's renderers, so white stays white.
//!
//! Decision (2026-11-22): all distributions sample visible normals of GGX (spherical caps), because Beckmann's and
//! Blinn's D are at most 4/e = 1.47 times GGX's of the same width, so their weights stay bounded without the iteration
//! that visible normals of their own need, instead of sampling D cos, whose weights (o . m) / ((n . o) (n . m)) are
//! unbounded at grazing views. The latter is kept as [`Sampling::Normals`], to be compared with.
//!
//! Decision (2026-11-22): the shadowing term and the way of sampling are one [`Choice`], because the three terms share the
//! two Lambdas and the lane loop blends them, instead of types, of which there are fifteen already. Measured on a thousand
//! lanes, AVX2: GGX is evaluated in 5.6 ns as before and sampled in 20.4 instead of 19.5 ns, Beckmann in 13.9 instead of
//! 12.2 and 25.8 instead of 24.6 ns; Blinn takes 10.7 and 26.0 ns, a GGX metal 9.0 and 23.5 ns.
//!
//! Decision (2026-11-29): where a boundary has both halves, they are sampled as one: a facet is drawn, and reflects or passes by
//! its own Fresnel term, because then the weight of a sample is a ratio of shadowing terms, at most about 1. Picking a half by
//! an albedo for the whole lobe instead weighed a facet that reflects much by what a mean one reflects: relative variance 1.17
//! outside at cosine .05, 2.75 and 1.53 inside at .3 and .7 (width .3, index 1.5), with weights up to 32.

pub mod albedo;
pub mod arrivals;
pub mod beckmann;
pub mod between;
pub mod blinn;
pub mod distribution;
pub mod geometry;
pub mod ggx;
pub mod glass;
pub mod white;

pub use beckmann::Beckmann;
pub use between::Between;
pub use blinn::Blinn;
pub use distribution::MIN_ALPHA;
pub use geometry::{Facets, Geometry, Method, Sampling, Scattering};
pub use ggx::Ggx;

use super::fresnel::{Fresnel, limited, refracted};
use super::{Arrivals, Choice, Eval, Params, Scatter, Side, Spread, View, select, unknown_arrivals};
use albedo::{BLOCK, FacetTable};
use distribution::{Distribution, Widths};
use glam::Vec3;
use glass::{Glass, Rows};

/// The least |eta - 1| that refracts visibly; nearer to 1 light goes straight on.
pub const MIN_ETA_DIFFERENCE: f32 = 1e-3;

/// One side of a rough boundary: what it reflects (`REFRACT` false) or what it lets through.
///
/// Parameters: widths along x and y, those of the Fresnel term, and how much a unit of passed light counts against one of
/// reflected light where both halves are sampled as one; 0 for a half that is alone. Choice: [`Method`].
/// Source: Walter, Marschner, Li and Torrance 2007, eq. 20, 21, 38 with a shadowing term of [`Geometry`].
/// Domain: widths clamped to 1e-3..1, any index. Gives: f cos in 1/sr, of a colored Fresnel term without it.
/// Degenerate cases: light on the wrong side gives 0, an index <= 0 and total reflection refract nothing.
/// Albedo: for picking, Fresnel's part at three angles; what a layer's top takes is a matter of tables.
#[derive(Clone, Copy, Debug)]
pub struct Microfacet<D, F, const REFRACT: bool> {
    distribution: D,
    visible: Ggx,
    fresnel: F,
    /// 1 when the product of both Lambdas counts.
    separable: f32,
    groove: bool,
    normals: bool,
    /// What the other half counts when both are sampled as one, or 0.
    passing: f32,
    /// Is light that bounces between the facets to be given back?
    multiple: bool,
}

/// A facet between two directions, with the cosine to the viewer.
struct Facet {
    m: Vec3,
    om: f32,
    /// Squared length of the vector that was normalised.
    length2: f32,
}

impl<D: Distribution, F: Fresnel, const REFRACT: bool> Microfacet<D, F, REFRACT> {
    /// The facet that sends `wi` to `wo`.
    #[inline(always)]
    fn facet(&self, wo: Vec3, wi: Vec3) -> Facet {
        let h = if REFRACT { wi * self.fresnel.eta() + wo } else { wo + wi };
        let length2 = h.dot(h).max(1e-30);
        let up = if REFRACT { 1f32.copysign(h.z) } else { 1.0 };
        let m = h * (up / length2.sqrt());
        Facet { m, om: wo.dot(m), length2 }
    }

    fn geometry(&self) -> Geometry {
        match (self.groove, self.separable > 0.0) {
            (true, _) => Geometry::VGroove,
            (_, true) => Geometry::Separable,
            _ => Geometry::Smith,
        }
    }

    /// The width that the facets have in the azimuth of a direction.
    #[inline(always)]
    fn width_toward(&self, w: Vec3) -> f32 {
        self.visible.0.toward(w)
    }

    /// The boundary of round facets of a width.
    fn glass(&self, alpha: f32) -> Glass {
        let Microfacet { fresnel, .. } = self;
        Glass { facets: D::FACETS, geometry: self.geometry(), alpha, eta: fresnel.eta(), ends: fresnel.ends() }
    }

    /// What single scattering of both halves leaves of white light toward a direction: what each is divided by. `of` says what
    /// round facets leave at a cosine.
    fn left(&self, w: Vec3, mut of: impl FnMut(&Glass, f32) -> f32) -> f32 {
        let (widths, cos) = (self.visible.0, w.z.abs().min(1.0));
        let mut at = |width: f32| of(&self.glass(width), cos);
        if widths.x == widths.y {
            return at(widths.x);
        }
        let least = at(self.width_toward(w)).max(at((widths.x * widths.y).sqrt()));
        1.0 - widths.given_back() * (1.0 - least)
    }

    /// What this half takes from a base, given what the reflecting half does.
    #[inline(always)]
    fn taken(&self, reflected: Vec3) -> f32 {
        if !REFRACT {
            return reflected.max_element();
        }
        select(self.fresnel.eta() > 0.0, 1.0 - reflected.min_element(), 0.0)
    }

    /// The probability that a facet of this cosine to the viewer reflects when both halves are sampled as one.
    #[inline(always)]
    fn reflecting_chance(&self, om: f32) -> f32 {
        let reflected = self.fresnel.mean(om);
        // A facet always does one or the other, so one of the terms is not 0.
        reflected / (reflected + self.passing * (1.0 - reflected)).max(1e-30)
    }

    /// The probability that sampling takes this half of a facet.
    #[inline(always)]
    fn chance(&self, om: f32) -> f32 {
        let reflects = self.reflecting_chance(om);
        select(self.passing > 0.0, if REFRACT { 1.0 - reflects } else { reflects }, 1.0)
    }

    /// The part of Smith's term that both sides share.
    #[inline(always)]
    fn smith(&self, lambda_o: f32, lambda_i: f32) -> f32 {
        1.0 / (1.0 + lambda_o + lambda_i + self.separable * (lambda_o * lambda_i))
    }

    /// The shadowing of grooves: `least` is the smaller of the quotients of cosines to the normal and to the facet.
    #[inline(always)]
    fn shadowing(&self, view: View, wi: Vec3, m: Vec3, least: f32) -> f32 {
        let smith = self.smith(view[0], self.distribution.lambda(wi));
        select(self.groove, (2.0 * m.z * least).min(1.0), smith)
    }

    #[inline(always)]
    fn reflect(&self, wo: Vec3, view: View, wi: Vec3) -> Eval {
        let Facet { m, om, .. } = self.facet(wo, wi);
        let over_om = 1.0 / om.max(1e-20);
        let g = self.shadowing(view, wi, m, wo.z.min(wi.z) * over_om);
        let d = self.distribution.d(m);
        let part = if F::COLORED { 1.0 } else { self.fresnel.largest(om) };
        let density = select(self.normals, d * m.z * over_om, self.visible.d(m) * view[1]) * self.chance(om);
        let lit = wi.z > 0.0 && wo.z > 0.0;
        Eval { f_cos: select(lit, part * d * g * 0.25 * view[2], 0.0), pdf: select(lit, 0.25 * density, 0.0) }
    }

    #[inline(always)]
    fn refract(&self, wo: Vec3, view: View, wi: Vec3) -> Eval {
        let Facet { m, om, length2 } = self.facet(wo, wi);
        let (im, eta) = (wi.dot(m), self.fresnel.eta());
        // The change from facets to light directions: eta² |wi . m| / (wo . m + eta wi . m)².
        let jacobian = eta * eta * im.abs() / length2;
        let least = (wo.z / om.max(1e-20)).min(-wi.z / im.abs().max(1e-20));
        let g = self.shadowing(view, wi, m, least);
        let d = self.distribution.d(m);
        let part = if F::COLORED { 1.0 } else { self.fresnel.passed(om) };
        let density = select(self.normals, d * m.z, self.visible.d(m) * view[1] * om) * self.chance(om);
        let lit = wi.z < 0.0 && wo.z > 0.0 && om > 0.0 && im < 0.0 && eta > 0.0;
        let f_cos = part * d * g * om * jacobian * view[2];
        Eval { f_cos: select(lit, f_cos, 0.0), pdf: select(lit, density * jacobian, 0.0) }
    }
}

impl<D: Distribution, F: Fresnel, const REFRACT: bool> Scatter for Microfacet<D, F, REFRACT> {
    const PARAMS: usize = 2 + F::PARAMS + 1;
    const SIDE: Side = if REFRACT { Side::Other } else { Side::Same };
    const SPREAD: Spread = Spread::Narrow;
    const TOP: bool = true;
    const COLORED: bool = F::COLORED;
    const VIEW: usize = 3;

    #[inline(always)]
    fn prepare(params: Params) -> Self {
        let widths = Widths { x: limited(params[0], MIN_ALPHA, 1.0), y: limited(params[1], MIN_ALPHA, 1.0) };
        let distribution = D::new(widths);
        Microfacet {
            distribution,
            visible: Ggx(distribution.widths()),
            fresnel: F::prepare(params, 2),
            separable: 0.0,
            groove: false,
            normals: false,
            passing: limited(params[2 + F::PARAMS], 0.0, 1e6),
            multiple: false,
        }
    }

    #[inline(always)]
    fn choose(self, choice: Choice) -> Self {
        let Method { geometry, sampling, scattering } = choice.into();
        Microfacet {
            separable: select(geometry == Geometry::Separable, 1.0, 0.0),
            groove: geometry == Geometry::VGroove,
            normals: sampling == Sampling::Normals,
            multiple: scattering == Scattering::Multiple,
            ..self
        }
    }

    #[inline(always)]
    fn view(&self, wo: Vec3) -> View {
        let over_cos = 1.0 / wo.z.max(1e-30);
        [self.distribution.lambda(wo), over_cos / (1.0 + self.visible.lambda(wo)), over_cos, 0.0, 0.0]
    }

    const ADJUSTED: Option<usize> = Some(2);

    fn adjusts(choice: Choice) -> bool {
        Method::from(choice).scattering == Scattering::Multiple
    }

    fn adjust(model: impl Fn(usize) -> Self, [x, y, z]: [&[f32]; 3], out: &mut [f32]) {
        let mut rows = Rows::default();
        for (i, value) in out.iter_mut().enumerate() {
            *value /= model(i).left(Vec3::new(x[i], y[i], z[i]), |glass, cos| rows.left(glass, cos));
        }
    }

    #[inline(always)]
    fn eval_from(&self, wo: Vec3, view: View, wi: Vec3) -> Eval {
        if REFRACT { self.refract(wo, view, wi) } else { self.reflect(wo, view, wi) }
    }

    #[inline(always)]
    fn color_from(&self, wo: Vec3, _view: View, wi: Vec3) -> Vec3 {
        if !F::COLORED {
            return Vec3::ONE;
        }
        let reflected = self.fresnel.color(self.facet(wo, wi).om);
        if REFRACT { Vec3::ONE - reflected } else { reflected }
    }

    #[inline(always)]
    fn sample_from(&self, wo: Vec3, _view: View, xi: Vec3) -> Vec3 {
        let seen = ggx::sample_visible(wo, self.visible.0, xi.x, xi.y);
        let any = self.distribution.sample_normal(xi.x, xi.y);
        let m = if self.normals { any } else { seen };
        let om = wo.dot(m);
        let both = self.passing > 0.0;
        let refracts = if both { xi.z >= self.reflecting_chance(om) } else { REFRACT };
        let bent = if both || REFRACT { refracted(wo, m, self.fresnel.eta()) } else { Vec3::ZERO };
        let wi = if refracts { bent } else { m * (2.0 * om) - wo };
        // A direction on the wrong side is lost. It must not be kept for the other half of the boundary, which finds it from
        // another facet with another density: that would weigh it far too much. So is a facet that faces away.
        let lost = if refracts { wi.z >= 0.0 } else { wi.z <= 0.0 };
        if lost || om <= 0.0 { Vec3::ZERO } else { wi }
    }

    /// An estimate: the Fresnel term averaged over facets tilted by the width. Where there are two halves it never reaches 0
    /// or 1, because facets far from the normal always send some light either way, and a part that is never picked would be lost.
    #[inline(always)]
    fn albedo(&self, cos: f32) -> f32 {
        let widths = self.visible.0;
        let width = widths.x.max(widths.y);
        let at = |c: f32| if REFRACT { self.fresnel.passed(c) } else { self.fresnel.largest(c) };
        let tilted = |by: f32| at((cos + by * width).clamp(1e-3, 1.0));
        // One angle must do for colors, which cost three times as much.
        let part = if F::COLORED { tilted(0.3) } else { 0.25 * (tilted(-1.0) + tilted(1.0)) + 0.5 * at(cos) };
        if REFRACT {
            select(self.fresnel.eta() > 0.0, part.clamp(0.03, 0.98), 0.0)
        } else {
            select(self.fresnel.eta() > 0.0, part.clamp(0.02, 0.97), part.clamp(0.02, 1.0))
        }
    }

    /// From the table of the distribution and its shadowing term: of the reflecting half, for the width that the facets have
    /// in the direction's azimuth. Of the transmitting half all that is not reflected, which is more than passes by what
    /// rough facets lose.
    ///
    /// Error, measured over widths 1e-3..1 and cosines 1e-4..1: reflecting, from outside 9e-4 (indices 1.02 to 2.5, metals,
    /// Schlick), from inside glass near total reflection 0.11; grooves 2e-3; widths of ratio 2, 4 and 10 up to 0.02, 0.045 and
    /// 0.07 for an index of 1.5, and 0.075, 0.175 and 0.37 for a mirror, because one width cannot stand for two.
    /// Transmitting: up to 0.33 too much at width 1.
    #[inline(always)]
    fn top_albedo(&self, w: Vec3) -> f32 {
        let table = FacetTable::of::<D>(self.geometry());
        let reflected = table.color(&self.fresnel, self.width_toward(w), w.z.abs().min(1.0));
        let left = if self.multiple { self.left(w, Glass::left) } else { 1.0 };
        self.taken((reflected * (1.0 / left)).min(Vec3::ONE))
    }

    const ARRIVALS: bool = !REFRACT;

    /// Those of a full mirror, which are safe for all: a Fresnel term that rises toward grazing light sends more of it from below.
    /// Of stretched facets nothing is known.
    fn arrivals(&self, cos: f32) -> Arrivals {
        let widths = self.visible.0;
        if widths.x != widths.y {
            return unknown_arrivals(cos);
        }
        arrivals::ArrivalTable::of::<D>(self.geometry()).at(widths.x, cos)
    }

    /// Where both widths are equal, the table is looked up in one of its axes only.
    #[inline(always)]
    fn top_albedos(&self, [x, y, z]: [&[f32]; 3], out: &mut [f32]) {
        let n = out.len();
        let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
        let table = FacetTable::of::<D>(self.geometry());
        let widths = self.visible.0;
        if widths.x == widths.y {
            let row = table.row(self.width_toward(Vec3::Z));
            let left = self.multiple.then(|| self.glass(widths.x).row());
            let mut cos = [0.0; BLOCK];
            for first in (0..n).step_by(BLOCK) {
                let count = BLOCK.min(n - first);
                cos[..count].copy_from_slice(&z[first..first + count]);
                for c in &mut cos {
                    *c = c.abs().min(1.0);
                }
                let [x, y, z] = row.colors(&self.fresnel, &cos);
                for l in 0..count {
                    let color = if F::COLORED { Vec3::new(x[l], y[l], z[l]) } else { Vec3::splat(x[l]) };
                    let color = color.clamp(Vec3::ZERO, Vec3::ONE);
                    let left = left.as_ref().map_or(1.0, |row| row.at(cos[l]));
                    out[first + l] = self.taken((color * (1.0 / left)).min(Vec3::ONE));
                }
            }
            return;
        }
        for i in 0..n {
            out[i] = self.top_albedo(Vec3::new(x[i], y[i], z[i]));
        }
    }
}
