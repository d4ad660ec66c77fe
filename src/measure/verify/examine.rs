//! The order of a verification: which laws each variant of a subject is held to, and what their findings add up to.

use super::effort::Effort;
use super::finding::{Check, Finding, Line, Report, Verdict};
use super::subject::Subject;
use super::view::{self, View};
use super::{finite, laws, reciprocity};
use crate::math::columns::Column3;
use crate::measure::statistics::{Random, seed_of, sidak};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The most probability with which a right build fails in some chi-square test of the run; as tests below it are looked at a second
/// time, which one view in a hundred costs, it is far less.
const LEVEL: f64 = 0.01;

/// Verifies subjects. `progress` hears how many variants of how many are done, from many threads.
pub fn verify(subjects: &[&dyn Subject], effort: &Effort, progress: &(dyn Fn(usize, usize) + Sync)) -> Report {
    let variants =
        |(k, subject): (usize, &&dyn Subject)| (0..subject.variants()).map(move |v| (k, v)).collect::<Vec<_>>();
    let tasks: Vec<(usize, usize)> = subjects.iter().enumerate().flat_map(variants).collect();
    let done = AtomicUsize::new(0);
    let examined = |&(subject, variant): &(usize, usize)| {
        let findings = examine(subjects[subject], variant, effort);
        progress(done.fetch_add(1, Ordering::Relaxed) + 1, tasks.len());
        findings
    };
    let found: Vec<Vec<Finding>> = tasks.par_iter().map(examined).collect();
    let mut report = Report::default();
    for (&(subject, variant), findings) in tasks.iter().zip(found) {
        let (name, label) = (subjects[subject].name(), subjects[subject].label(variant));
        let line = |finding| Line { subject: name.to_owned(), label: label.clone(), finding, variants: 1 };
        report.lines.extend(findings.into_iter().map(line));
    }
    judge(&mut report);
    report
}

/// Gives the chi-square tests their verdicts, now that it is known how many there are.
fn judge(report: &mut Report) {
    let tests = report.lines.iter().filter(|line| line.finding.check == Check::ChiSquare).count();
    report.tests = tests as u32;
    report.level = sidak(LEVEL, report.tests.max(1));
    for line in &mut report.lines {
        let finding = &mut line.finding;
        if finding.check == Check::ChiSquare {
            finding.bound = format!("p > {:.1e}", report.level);
            finding.verdict = if finding.value > report.level { Verdict::Pass } else { Verdict::Fail };
        }
    }
}

/// All findings of one variant. One that a first look condemns, or that has a chi-square below 0.01, is looked at again with
/// more directions and other samples, and that verdict holds: a wrong lobe fails twice, an edge that an integral passed
/// over does not.
pub fn examine(subject: &dyn Subject, variant: usize, effort: &Effort) -> Vec<Finding> {
    let first = examine_once(subject, variant, effort);
    let doubtful = |finding: &Finding| match finding.check {
        Check::ChiSquare => finding.value < LEVEL,
        Check::Scatters
        | Check::Finite
        | Check::Energy
        | Check::Reciprocity
        | Check::Density
        | Check::Weight
        | Check::Coverage
        | Check::Albedo => finding.verdict == Verdict::Fail,
    };
    if first.iter().any(doubtful) { examine_once(subject, variant, &effort.closer()) } else { first }
}

fn examine_once(subject: &dyn Subject, variant: usize, effort: &Effort) -> Vec<Finding> {
    let name = format!("{}, {}", subject.name(), subject.label(variant));
    let random = &mut Random(seed_of(&name, effort.seed));
    let promises = subject.promises(variant);
    let mut scatterer = subject.scatterer(variant);
    let scatterer = scatterer.as_mut();
    let extra = subject.views(variant);
    for view in &extra {
        // What a shader complains of from there is told with what is no number.
        scatterer.look(&Column3::splat(view.wo(), 1));
    }
    let mut findings = vec![finite::finite(scatterer, random)];
    let cosines =
        effort.sampled.iter().map(|&cos| (cos, true)).chain(effort.integrated.iter().map(|&cos| (cos, false)));
    // Azimuths all around, so that no symmetry of a lobe hides anything.
    let views = cosines.enumerate().map(|(k, (cos, sampled))| (View { cos, azimuth: 0.4 + 2.4 * k as f64 }, sampled));
    let views = views.chain(extra.iter().map(|&view| (view, false)));
    let seen: Vec<view::Seen> =
        views.map(|(view, sampled)| view::look(scatterer, view, sampled, effort, random)).collect();
    let dark = |seen: &view::Seen| {
        seen.integrals.total() == [0.0; 4]
            && seen.single.0 == [0.0; 3]
            && seen.tally.as_ref().is_none_or(|t| t.spread == 0.0)
    };
    if seen.iter().all(dark) {
        findings.push(nothing_scatters());
        return findings;
    }
    findings.extend(laws::energy(&seen, promises));
    findings.extend(reciprocity::reciprocity(scatterer, promises.reciprocity, effort.pairs, random));
    findings.extend(seen.iter().filter_map(laws::chi_square));
    findings.extend(laws::density(&seen));
    findings.extend(laws::weight(&seen));
    findings.extend(laws::coverage(&seen));
    findings.extend(laws::albedo(&seen));
    findings
}

fn nothing_scatters() -> Finding {
    let (check, verdict) = (Check::Scatters, Verdict::Pass);
    let (bound, place, note) = ("-".to_owned(), String::new(), "scatters nothing".to_owned());
    Finding { check, verdict, value: 0.0, severity: 0.0, bound, place, note }
}
