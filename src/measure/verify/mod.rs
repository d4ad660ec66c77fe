//! Verification: is this a material? Furnace, reciprocity, chi-square, total density, weights, finite numbers.
//!
//! A [`Subject`] is a closure by name ([`ClosureSubject`]), a user's shader ([`ShaderSubject`]), or anything that a test
//! dresses up as one. Each of its variants is looked at from several directions ([`view`]), the laws ([`laws`],
//! [`reciprocity`], [`finite`]) give a [`Finding`] each, and [`verify`] makes a [`Report`] of them. Random numbers are seeded by the
//! names of subject and variant, so a report depends on neither time nor threads.

mod closure;
pub mod draws;
pub mod finding;
pub mod finite;
pub mod laws;
mod nothing;
pub mod reciprocity;
mod shader;
pub mod subject;
mod tree;
pub mod view;

pub use closure::ClosureSubject;
pub use finding::{Check, Finding, Line, Report, Verdict};
pub use shader::ShaderSubject;
pub use subject::{Promise, Promises, Scatterer, Subject};
pub use tree::{Spot, TreeScatterer};

use crate::measure::statistics::{Random, seed_of, sidak};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use view::View;

/// The most probability with which a right build fails in some chi-square test of the run; as tests below it are looked at a second
/// time, which one view in a hundred costs, it is far less.
const LEVEL: f64 = 0.01;

/// How much work goes into a verification.
#[derive(Clone, Debug, PartialEq)]
pub struct Effort {
    /// Samples a sampled view.
    pub samples: usize,
    /// Cells that they are counted in.
    pub cells: usize,
    /// Directions that the integrals of a view may take.
    pub directions: usize,
    /// What a refinement may still change in a patch's part of the albedo.
    pub tolerance: f64,
    /// Cosines of the views that are sampled and integrated.
    pub sampled: Vec<f64>,
    /// Cosines of the views that are only integrated.
    pub integrated: Vec<f64>,
    /// Batches of pairs whose directions are exchanged.
    pub pairs: usize,
    /// Chosen by the user, to try other random numbers.
    pub seed: u64,
}

impl Effort {
    /// All there is.
    pub fn full() -> Self {
        Effort {
            samples: 100_000,
            cells: 128,
            directions: 600_000,
            tolerance: 1e-6,
            sampled: vec![0.05, 0.25, 0.5, 0.75, 0.999],
            integrated: vec![1e-4, 1e-3, 0.01, 0.1, 0.9, 1.0],
            pairs: 16,
            seed: 0,
        }
    }

    /// A second look at what a first one finds wrong.
    fn closer(&self) -> Self {
        Effort {
            samples: 2 * self.samples,
            cells: 4 * self.cells,
            directions: 40 * self.directions,
            tolerance: 0.1 * self.tolerance,
            seed: self.seed.wrapping_add(1),
            ..self.clone()
        }
    }

    /// Enough to see a density 5 % wrong and a lobe 2 % too bright.
    pub fn quick() -> Self {
        Effort {
            samples: 30_000,
            cells: 64,
            directions: 100_000,
            tolerance: 2e-6,
            integrated: vec![1e-4, 0.01],
            pairs: 4,
            ..Effort::full()
        }
    }
}

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
        _ => finding.verdict == Verdict::Fail,
    };
    if first.iter().any(doubtful) { examine_once(subject, variant, &effort.closer()) } else { first }
}

fn examine_once(subject: &dyn Subject, variant: usize, effort: &Effort) -> Vec<Finding> {
    let name = format!("{}, {}", subject.name(), subject.label(variant));
    let random = &mut Random(seed_of(&name, effort.seed));
    let promises = subject.promises(variant);
    let mut scatterer = subject.scatterer(variant);
    let scatterer = scatterer.as_mut();
    let mut findings = vec![finite::finite(scatterer, random)];
    let cosines =
        effort.sampled.iter().map(|&cos| (cos, true)).chain(effort.integrated.iter().map(|&cos| (cos, false)));
    // Azimuths all around, so that no symmetry of a lobe hides anything.
    let views = cosines.enumerate().map(|(k, (cos, sampled))| (View { cos, azimuth: 0.4 + 2.4 * k as f64 }, sampled));
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
