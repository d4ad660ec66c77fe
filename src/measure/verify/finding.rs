//! What verification finds: a figure, its bound and a verdict for each check of each variant, and the table made of them.

use std::fmt;

/// The laws that are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Check {
    /// Does it scatter at all?
    Scatters,
    /// Everything is a number, and nothing is negative.
    Finite,
    /// No more light leaves than arrives.
    Energy,
    /// f is the same when directions are exchanged.
    Reciprocity,
    /// Samples fall where the density says.
    ChiSquare,
    /// The density integrates to the share of samples that are not lost.
    Density,
    /// The weight of a sample is f |cos| / pdf.
    Weight,
    /// Samples reach all that is evaluated: their mean weight is the integral of f |cos|.
    Coverage,
    /// The albedo that the evaluators of layers state is the measured one.
    Albedo,
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Check::Scatters => "scatters",
            Check::Finite => "finite",
            Check::Energy => "energy",
            Check::Reciprocity => "reciprocity",
            Check::ChiSquare => "chi-square",
            Check::Density => "pdf total",
            Check::Weight => "weight",
            Check::Coverage => "mean weight",
            Check::Albedo => "albedo",
        })
    }
}

/// How a check ended, the worst last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Verdict {
    /// The law is kept.
    Pass,
    /// Told, not judged.
    Info,
    /// Broken, and never promised.
    Waived,
    /// Broken.
    Fail,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Verdict::Pass => "pass",
            Verdict::Info => "info",
            Verdict::Waived => "waived",
            Verdict::Fail => "FAIL",
        })
    }
}

/// The worst that one check saw in one variant.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What was checked.
    pub check: Check,
    /// How it ended.
    pub verdict: Verdict,
    /// The worst figure.
    pub value: f64,
    /// How near it comes to its bound; the greatest of many findings is shown.
    pub severity: f64,
    /// What the figure must keep to, for people to read.
    pub bound: String,
    /// Where it was seen: the view, and directions.
    pub place: String,
    /// What else there is to say.
    pub note: String,
}

/// A finding with its subject and variant.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The subject.
    pub subject: String,
    /// The parameters of the variant.
    pub label: String,
    /// The finding.
    pub finding: Finding,
    /// How many variants the line speaks for.
    pub variants: usize,
}

impl Finding {
    /// The figure as people read it.
    pub fn figure(&self) -> String {
        let value = self.value;
        match self.check {
            Check::Scatters => "-".to_owned(),
            Check::Finite => format!("{value}"),
            Check::Energy => format!("{value:.5}"),
            Check::ChiSquare if value >= 1e-3 => format!("p = {value:.3}"),
            Check::ChiSquare => format!("p = {value:.1e}"),
            Check::Density | Check::Coverage => format!("{value:.4}"),
            Check::Albedo => format!("{value:+.4}"),
            Check::Weight | Check::Reciprocity => format!("{value:.1e}"),
        }
    }
}

impl Line {
    /// The line as cells of a table: subject, check, worst figure, bound, verdict, and where it was seen with what else there is to say.
    pub fn cells(&self) -> [String; 6] {
        let Finding { check, verdict, place, note, bound, .. } = &self.finding;
        let parts = [place.as_str(), self.label.as_str()].into_iter().filter(|part| !part.is_empty());
        let place = parts.collect::<Vec<_>>().join("; ");
        let place = match (note.is_empty(), place.is_empty()) {
            (true, _) => place,
            (_, true) => note.clone(),
            _ => format!("{place}: {note}"),
        };
        [self.subject.clone(), check.to_string(), self.finding.figure(), bound.clone(), verdict.to_string(), place]
    }
}

/// All findings of a run.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// One a subject, variant and check, in the order of the subjects.
    pub lines: Vec<Line>,
    /// How many chi-square tests were made.
    pub tests: u32,
    /// The level of each of them.
    pub level: f64,
}

impl Report {
    /// True when nothing failed.
    pub fn passed(&self) -> bool {
        self.lines.iter().all(|line| line.finding.verdict != Verdict::Fail)
    }

    /// The worst line of each subject and check; what is waived stands beside what is kept.
    pub fn worst(&self) -> Vec<Line> {
        let mut out: Vec<Line> = Vec::new();
        for line in &self.lines {
            // A promise that is not made has a line for each reason.
            let waiver = |line: &Line| (line.finding.verdict == Verdict::Waived).then(|| line.finding.note.clone());
            let mine = waiver(line);
            let same = |other: &&mut Line| {
                other.subject == line.subject && other.finding.check == line.finding.check && waiver(other) == mine
            };
            let Some(kept) = out.iter_mut().rev().find(same) else {
                out.push(line.clone());
                continue;
            };
            let variants = kept.variants + line.variants;
            let rank = |line: &Line| (line.finding.verdict, line.finding.severity);
            if rank(line) > rank(kept) {
                *kept = line.clone();
            }
            kept.variants = variants;
        }
        // Stable: subjects keep their order, checks follow that of the laws.
        let mut subjects: Vec<&str> = Vec::new();
        for line in &self.lines {
            if !subjects.contains(&line.subject.as_str()) {
                subjects.push(&line.subject);
            }
        }
        let at = |line: &Line| subjects.iter().position(|s| *s == line.subject);
        out.sort_by_key(|line| (at(line), line.finding.check, line.finding.verdict));
        out
    }
}
