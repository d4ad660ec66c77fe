//! All figures of the chart that need no scene, in their order.

use super::effort::Effort;
use super::figure::Figure;
use super::{albedo, lambda, layering, precision, sampling, terminator, visibility, widths};

/// What measures a figure.
type Measure = fn(&Effort) -> Result<Figure, String>;

/// Measures all figures that need no scene; tells how many of how many are done.
pub fn figures(effort: &Effort, progress: &dyn Fn(usize, usize)) -> Result<Vec<Figure>, String> {
    let all: [Measure; 8] = [
        lambda::figure,
        visibility::figure,
        albedo::figure,
        sampling::figure,
        layering::figure,
        terminator::figure,
        widths::figure,
        precision::figure,
    ];
    let mut out = Vec::new();
    for (done, measure) in all.iter().enumerate() {
        progress(done, all.len());
        out.push(measure(effort)?);
    }
    progress(all.len(), all.len());
    Ok(out)
}
