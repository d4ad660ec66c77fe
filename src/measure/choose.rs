//! Picks methods by a tolerance: of each place where methods compete, the cheapest whose measured error is below it.
//!
//! Errors are measured when asked for, in f64 and in about a second. Costs are the constants below.
//!
//! Decision (2026-11-29): an error is stated with a tenth added and rounded up, because the largest of a grid is up to 9 % below
//! the largest of all (measured on 41 x 71 places) and a tolerance is a promise, instead of a grid so dense that nobody waits for it.
//!
//! Decision (2026-11-22): costs are ordered by recorded constants, because an image must not depend on a clock that other
//! programs disturb, instead of by timing on the spot, which is what `velour chart` does.

use crate::bsdf::sheen::albedo::AlbedoCurve;
use crate::bsdf::sheen::reference::{Model, lambda_by_area};
use crate::bsdf::sheen::shadowing::{Exact, Published, Series};
use crate::closure::Settings;
use crate::closure::settings::{Shadowing, SheenAlbedo};
use crate::measure::chart::truth::{albedos, cosines};
use std::fmt;

/// Cost of a softened sheen lobe by its shadowing term, ns to evaluate a direction, as the figure `visibility` of `velour
/// chart` had it for batches of 128 lanes on one core of a 2-core AMD EPYC with AVX2. Only their order counts.
const SHADOWING_COSTS: [(Shadowing, f64); 4] =
    [(Shadowing::Ashikhmin, 7.4), (Shadowing::Exact, 9.5), (Shadowing::Series, 11.2), (Shadowing::Published, 17.0)];

/// Cost of an albedo, ns a direction, as the figure `albedo` of `velour chart` has it on the same machine; a table is read number
/// by number, where the polynomials are summed for many lanes at once.
const ALBEDO_COSTS: [(SheenAlbedo, f64); 4] =
    [(SheenAlbedo::Short, 1.5), (SheenAlbedo::Fit, 2.3), (SheenAlbedo::Long, 4.3), (SheenAlbedo::Table, 8.8)];

/// Roughnesses at which errors are looked for, all over what a sheen can have and between the rows of the table.
const ROUGHNESSES: [f64; 10] = [0.01, 0.0109, 0.0165, 0.0285, 0.052, 0.094, 0.17, 0.32, 0.6, 1.0];

/// Cosines at which errors of Lambda are looked for: on fewer the fit seems better than it is.
const LAMBDA_COSINES: usize = 61;

/// Cosines at which errors of the albedo are looked for, and one more in the first cells of the table, where it errs most.
const ALBEDO_COSINES: usize = 16;
const FIRST_CELL: f64 = 2.3e-4;

/// What an error found on these grids is multiplied with.
const MARGIN: f64 = 1.1;

/// What a user has asked for by name, which wins over any tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    /// The shadowing term.
    pub shadowing: Option<Shadowing>,
    /// The albedo evaluator.
    pub albedo: Option<SheenAlbedo>,
}

/// A method that could be taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The word that selects it.
    pub method: String,
    /// Its error, as its place measures it.
    pub error: f64,
    /// Its recorded cost, ns.
    pub cost: f64,
}

/// Why a method was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// It is the cheapest below the tolerance.
    Cheapest,
    /// None is below the tolerance, and it is the most exact.
    MostExact,
    /// The user named it.
    Asked,
}

/// What was taken at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Pick {
    /// What competes there.
    pub place: &'static str,
    /// What its error means.
    pub meaning: &'static str,
    /// What was taken.
    pub taken: Candidate,
    /// Why.
    pub reason: Reason,
    /// The others, cheapest first.
    pub passed_over: Vec<Candidate>,
}

/// All picks, and the settings that follow from them.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The largest error allowed.
    pub tolerance: f64,
    /// One pick a place.
    pub picks: Vec<Pick>,
    /// The settings to render with.
    pub closure: Settings,
}

/// Picks the methods of a render. Domain: tolerance above 0.
pub fn choose(tolerance: f64, asked: Asked, closure: Settings) -> Choice {
    let mut closure = closure;
    let shadowing = SHADOWING_COSTS.map(|(term, cost)| (term, Candidate::new(term, shadowing_error(term), cost)));
    let (term, first) = pick("shadowing", LAMBDA, tolerance, &shadowing, asked.shadowing);
    closure.shadowing = term;
    let errors = albedo_errors(term, closure.softening);
    let albedo: Vec<(SheenAlbedo, Candidate)> = ALBEDO_COSTS
        .iter()
        .zip(errors)
        .map(|((method, cost), error)| (*method, Candidate::new(method, error, *cost)))
        // Terms that are not exact have one polynomial, which every word selects.
        .filter(|(method, _)| term.is_exact() || *method == SheenAlbedo::Fit)
        .collect();
    let (method, second) = pick("albedo", ALBEDO, tolerance, &albedo, asked.albedo.filter(|_| term.is_exact()));
    closure.sheen_albedo = method;
    Choice { tolerance, picks: vec![first, second], closure }
}

const LAMBDA: &str = "largest relative error of Lambda, cosines 0.02 to 0.98";
const ALBEDO: &str = "largest error of the directional albedo, cosines 1e-4 to 1";

impl Candidate {
    fn new(method: impl fmt::Display, error: f64, cost: f64) -> Self {
        Candidate { method: method.to_string(), error, cost }
    }
}

/// Takes the one that was asked for, or else the cheapest below the tolerance, or else the most exact.
fn pick<M: Copy + PartialEq>(
    place: &'static str,
    meaning: &'static str,
    tolerance: f64,
    candidates: &[(M, Candidate)],
    asked: Option<M>,
) -> (M, Pick) {
    let named = asked.and_then(|asked| candidates.iter().position(|(method, _)| *method == asked));
    let least = |key: fn(&Candidate) -> f64, below: f64| {
        let fit = (0..candidates.len()).filter(|k| candidates[*k].1.error <= below);
        fit.min_by(|a, b| key(&candidates[*a].1).total_cmp(&key(&candidates[*b].1)))
    };
    let (index, reason) = match (named, least(|c| c.cost, tolerance)) {
        (Some(index), _) => (index, Reason::Asked),
        (None, Some(index)) => (index, Reason::Cheapest),
        (None, None) => (least(|c| c.error, f64::INFINITY).unwrap_or(0), Reason::MostExact),
    };
    let mut passed_over: Vec<Candidate> =
        candidates.iter().enumerate().filter(|(k, _)| *k != index).map(|(_, (_, c))| c.clone()).collect();
    passed_over.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    (candidates[index].0, Pick { place, meaning, taken: candidates[index].1.clone(), reason, passed_over })
}

/// The largest relative error of Lambda against the area that defines it.
fn shadowing_error(term: Shadowing) -> f64 {
    let mut worst = 0.0f64;
    for r in ROUGHNESSES {
        let r = r as f32;
        let (exact, published, series) = (Exact::new(1.0 / r), Published::new(r), Series::new(1.0 / r));
        for k in 0..LAMBDA_COSINES {
            let cos = 0.02 + 0.96 * k as f32 / (LAMBDA_COSINES - 1) as f32;
            let value = match term {
                Shadowing::Exact => exact.lambda(cos),
                Shadowing::Published => published.lambda(cos),
                Shadowing::Series => series.lambda(cos),
                // 1 / (4 (ci + co - ci co)) is Smith's term with this Lambda.
                Shadowing::Ashikhmin => 1.0 / cos - 1.0,
            };
            worst = worst.max((f64::from(value) / lambda_by_area(f64::from(cos), f64::from(r)) - 1.0).abs());
        }
    }
    MARGIN * worst
}

/// The largest error of the albedo by each of [`ALBEDO_COSTS`], for the term that is rendered with.
fn albedo_errors(term: Shadowing, soft: bool) -> [f64; 4] {
    let model = match term {
        Shadowing::Exact => Model::ExactFit,
        Shadowing::Series => Model::Exact,
        Shadowing::Published => Model::Published,
        Shadowing::Ashikhmin => Model::Ashikhmin,
    };
    let mut cosines = cosines(ALBEDO_COSINES);
    cosines.push(FIRST_CELL);
    let truth = albedos(model, soft, &ROUGHNESSES, &cosines, 32);
    let mut worst = [0.0f64; 4];
    for (row, r) in truth.iter().zip(ROUGHNESSES) {
        for (worst, (method, _)) in worst.iter_mut().zip(ALBEDO_COSTS) {
            let exact = AlbedoCurve::exact(method, soft, r as f32);
            let other = AlbedoCurve::new(term, soft, r as f32);
            for (truth, &cos) in row.iter().zip(&cosines) {
                let cos = cos as f32;
                let value = if term.is_exact() { exact.by_method(method, cos) } else { other.at::<true>(cos) };
                *worst = worst.max(MARGIN * (f64::from(value) - truth.min(1.0)).abs());
            }
        }
    }
    worst
}

/// An error with two digits, never less than it is.
struct RoundedUp(f64);

impl fmt::Display for RoundedUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Half a unit of the second digit turns rounding to the nearest into rounding up.
        let half = if self.0 > 0.0 { 0.5 * 10f64.powf(self.0.log10().floor() - 1.0) } else { 0.0 };
        write!(f, "{:.1e}", self.0 + 0.999 * half)
    }
}

impl Choice {
    /// The places where no method reaches the tolerance.
    pub fn missed(&self) -> impl Iterator<Item = &Pick> {
        self.picks.iter().filter(|pick| pick.taken.error > self.tolerance)
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "methods for a tolerance of {:e}, errors measured now, for roughness 0.01 to 1:", self.tolerance)?;
        writeln!(
            f,
            "a roughness below 0.01 counts as 0.01; not promised: closures whose shader sets the keyword \"shadowing\""
        )?;
        for pick in &self.picks {
            let Candidate { method, error, cost } = &pick.taken;
            let why = match pick.reason {
                Reason::Cheapest => "the cheapest below the tolerance",
                Reason::MostExact => "none is below the tolerance; the most exact",
                Reason::Asked => "asked for",
            };
            let error = RoundedUp(*error);
            writeln!(f, "{}: {method} ({why}), error {error}, {cost} ns; error: {}", pick.place, pick.meaning)?;
            for other in &pick.passed_over {
                let Candidate { method, error, cost } = other;
                let why = match (error <= &self.tolerance, pick.reason) {
                    (true, Reason::Cheapest) => "dearer",
                    (false, Reason::Cheapest) => "not exact enough",
                    (_, Reason::Asked) => "not asked for",
                    (_, Reason::MostExact) => "less exact",
                };
                writeln!(f, "  not {method}: {why}, error {}, {cost} ns", RoundedUp(*error))?;
            }
        }
        writeln!(
            f,
            "sampling: {}; every way is right on average, so no tolerance bears on it",
            self.closure.sheen_sampling
        )?;
        writeln!(f, "layering: {}; a rule is a choice of model, so no tolerance bears on it", self.closure.layering)
    }
}
