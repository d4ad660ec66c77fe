//! The laws that hold for each view: energy, chi-square, total density, weights, coverage, stated albedo.

use super::finding::{Check, Finding, Verdict};
use super::subject::{Promise, Promises};
use super::view::Seen;
use crate::measure::statistics::chi_square_within;

/// How far the albedo of a lobe may pass 1.
pub const ENERGY: f64 = 1e-4;
/// How far the albedo of layers may pass 1: the evaluators that scale their bases err by up to 1e-3, a layer each.
pub const LAYERED: f64 = 2e-3;
/// How far the albedo of a lossless lobe may be from 1.
pub const LOSSLESS: f64 = 1e-3;
/// How far a weight may be, relatively, from f |cos| / pdf.
pub const WEIGHT: f64 = 1e-4;
/// Standard errors that condemn: beyond 5, a right build fails once in two million tests.
const SIGNIFICANT: f64 = 5.0;

/// `cos 0.25`.
pub fn cosine(cos: f64) -> String {
    if cos >= 1e-3 { format!("view cos {cos}") } else { format!("view cos {cos:e}") }
}

fn at(seen: &Seen) -> String {
    cosine(seen.view.cos)
}

/// The finding of the view with the greatest severity; one that is no number is worse than any.
fn worst(findings: impl Iterator<Item = Finding>) -> Option<Finding> {
    let rank = |finding: &Finding| if finding.severity.is_nan() { f64::INFINITY } else { finding.severity };
    findings.reduce(|a, b| if (b.verdict, rank(&b)) > (a.verdict, rank(&a)) { b } else { a })
}

/// Furnace: a white sky must not look brighter than itself, from no direction.
pub fn energy(seen: &[Seen], promises: Promises) -> Option<Finding> {
    let Promises { energy: promise, layered, lossless, .. } = promises;
    let most = if layered { LAYERED } else { ENERGY };
    worst(seen.iter().map(|seen| {
        let (albedo, error) = seen.largest();
        let excess = albedo - 1.0 - error;
        let broken = albedo.is_nan() || excess > most;
        let lossy = lossless && (albedo - 1.0).abs() > LOSSLESS + error;
        let (verdict, note) = if broken {
            match promise {
                Promise::Kept => {
                    (Verdict::Fail, format!("sends back {:.2} % more light than arrives", 100.0 * (albedo - 1.0)))
                }
                Promise::Waived(why) => (Verdict::Waived, why.to_owned()),
                Promise::Open => (Verdict::Info, String::new()),
            }
        } else if lossy {
            (Verdict::Fail, "is to be lossless".to_owned())
        } else if error > 10.0 * most {
            (Verdict::Pass, format!("known to +- {error:.0e} only"))
        } else {
            (Verdict::Pass, String::new())
        };
        let (severity, bound) = if lossless {
            ((albedo - 1.0).abs(), format!("1 +- {LOSSLESS:e}"))
        } else {
            (albedo, format!("<= 1 + {most:e}"))
        };
        Finding { check: Check::Energy, verdict, value: albedo, severity, bound, place: at(seen), note }
    }))
}

/// Samples against density, cell by cell; what is not drawn by density is one cell more. The verdict waits for the level.
pub fn chi_square(seen: &Seen) -> Option<Finding> {
    let tally = seen.tally.as_ref()?;
    let expected: Vec<f64> = seen.integrals.cells.iter().map(|cell| cell[0] * tally.count).collect();
    let total: f64 = expected.iter().sum();
    if tally.spread == 0.0 && total < 5.0 {
        return None;
    }
    let errors: Vec<f64> = seen.integrals.cell_errors.iter().map(|error| error * tally.count).collect();
    let (mut observed, mut expected) = (tally.cells.clone(), expected);
    observed.push(tally.count - tally.spread);
    expected.push((tally.count - total).max(0.0));
    let errors = [errors.as_slice(), &[seen.integrals.error[0] * tally.count]].concat();
    let p = if total.is_nan() { 0.0 } else { chi_square_within(&observed, &expected, &errors) };
    let (check, verdict) = (Check::ChiSquare, Verdict::Pass);
    Some(Finding { check, verdict, value: p, severity: -p, bound: String::new(), place: at(seen), note: String::new() })
}

/// The density integrates to the share of samples that it was drawn from.
pub fn density(seen: &[Seen]) -> Option<Finding> {
    worst(seen.iter().filter_map(|seen| {
        let tally = seen.tally.as_ref()?;
        let (share, total) = (tally.spread / tally.count, seen.integrals.total()[0]);
        if tally.spread == 0.0 && total == 0.0 {
            return None;
        }
        let noise = (share * (1.0 - share)).max(1.0 / tally.count) / tally.count;
        let allowed = SIGNIFICANT * noise.sqrt() + seen.integrals.error[0] + 1e-4;
        let off = (share - total).abs();
        let verdict = if off <= allowed { Verdict::Pass } else { Verdict::Fail };
        let note =
            if share < 1.0 { format!("{:.2} % of the samples are lost", 100.0 * (1.0 - share)) } else { String::new() };
        let bound = format!("{share:.4} +- {allowed:.1e}");
        Some(Finding {
            check: Check::Density,
            verdict,
            value: total,
            severity: off / allowed,
            bound,
            place: at(seen),
            note,
        })
    }))
}

/// The weight of each sample is f |cos| / pdf of its direction.
pub fn weight(seen: &[Seen]) -> Option<Finding> {
    worst(seen.iter().filter_map(|seen| {
        let (value, wi) = seen.tally.as_ref().filter(|tally| tally.spread > 0.0)?.mismatch;
        let verdict = if value <= WEIGHT { Verdict::Pass } else { Verdict::Fail };
        let place = if value > WEIGHT { format!("{}, wi ({}, {}, {})", at(seen), wi.x, wi.y, wi.z) } else { at(seen) };
        let (bound, note) = (format!("<= {WEIGHT:e}"), String::new());
        Some(Finding { check: Check::Weight, verdict, value, severity: value, bound, place, note })
    }))
}

/// The mean weight is the integral of f |cos|: no light comes from where no sample goes.
pub fn coverage(seen: &[Seen]) -> Option<Finding> {
    worst(seen.iter().filter_map(|seen| {
        let tally = seen.tally.as_ref().filter(|tally| tally.spread > 0.0)?;
        let total = seen.integrals.total();
        let component = |k: usize| {
            let mean = tally.sum[k] / tally.count;
            let variance = (tally.squares[k] / tally.count - mean * mean).max(0.0) / tally.count;
            // Weights with a long tail show less variance than they have; a percent is beyond that.
            let allowed = SIGNIFICANT * variance.sqrt() + seen.integrals.error[k + 1] + 0.01 * mean.abs() + 1e-4;
            ((mean - total[k + 1]).abs() / allowed, mean, allowed, total[k + 1])
        };
        let (severity, mean, allowed, total) =
            (0..3).map(component).reduce(|a, b| if b.0 > a.0 || b.0.is_nan() { b } else { a })?;
        let verdict = if severity <= 1.0 { Verdict::Pass } else { Verdict::Fail };
        let (bound, note) = (format!("{total:.4} +- {allowed:.1e}"), String::new());
        Some(Finding { check: Check::Coverage, verdict, value: mean, severity, bound, place: at(seen), note })
    }))
}

/// How far the albedo that decides what a layer takes from its base is from the measured one.
pub fn albedo(seen: &[Seen]) -> Option<Finding> {
    worst(seen.iter().map(|seen| {
        let measured = seen.largest().0;
        let off = seen.stated - measured;
        let (bound, note) = ("-".to_owned(), format!("states {:.4}, is {measured:.4}", seen.stated));
        let (check, verdict) = (Check::Albedo, Verdict::Info);
        Finding { check, verdict, value: off, severity: off.abs(), bound, place: at(seen), note }
    }))
}
