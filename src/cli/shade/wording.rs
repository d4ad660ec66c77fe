//! What goes wrong, in the words of OSL's shading system, which people search for and its references have.

use crate::exec::{Mistake, Report, ReportKind};

/// A message as one line or more.
pub fn line(report: &Report) -> String {
    let shader = &report.place.shader;
    match &report.kind {
        ReportKind::Warning if !shader.is_empty() => format!("WARNING: Shader warning [{shader}]: {}\n", report.text),
        ReportKind::Warning => format!("WARNING: {}\n", report.text),
        ReportKind::Error => format!("ERROR: Shader error [{shader}]: {}\n", report.text),
        ReportKind::Mistake(mistake) => format!("ERROR: {}\n", words(mistake, report)),
        ReportKind::Output | ReportKind::File(_) | ReportKind::Fatal => format!("{report}\n"),
    }
}

fn words(mistake: &Mistake, report: &Report) -> String {
    let place = &report.place;
    match mistake {
        Mistake::Index { index, len } => format!(
            "Index [{index}] out of range {}[0..{}]: {}:{} (group unnamed_group_1, layer {} {}, shader {})",
            place.word,
            i64::from(*len) - 1,
            place.file,
            place.line,
            place.layer_number,
            place.layer,
            place.shader
        ),
        Mistake::Space { name } => format!("Unknown transformation \"{name}\""),
        Mistake::ColorSpace { from, to } => format!("Unknown color space transformation \"{from}\" -> \"{to}\""),
        _ => report.to_string(),
    }
}
