//! What goes wrong, in the words of OSL's shading system, which people search for and its references have.

use crate::exec::{MessageFault, Mistake, Report, ReportKind, ReportPlace};

/// A message as one line or more.
pub fn line(report: &Report, group: &str) -> String {
    let shader = &report.place.shader;
    match &report.kind {
        ReportKind::Warning if !shader.is_empty() => format!("WARNING: Shader warning [{shader}]: {}\n", report.text),
        ReportKind::Warning => format!("WARNING: {}\n", report.text),
        ReportKind::Error => format!("ERROR: Shader error [{shader}]: {}\n", report.text),
        ReportKind::Mistake(mistake) => format!("ERROR: {}\n", words(mistake, report, group)),
        ReportKind::Output | ReportKind::File(_) | ReportKind::Fatal => format!("{report}\n"),
    }
}

fn words(mistake: &Mistake, report: &Report, group: &str) -> String {
    let place = &report.place;
    match mistake {
        Mistake::Index { index, len } => format!(
            "Index [{index}] out of range {}[0..{}]: {}:{} (group {group}, layer {} {}, shader {})",
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
        Mistake::Noise { name } => {
            format!("noise type \"{name}\" is unknown, called from ({})", at(place))
        }
        Mistake::Texture { reason } => format!("[RendererServices::texture] {reason}"),
        Mistake::Message { name, fault, first } => {
            let (before, here) = (at(first), at(place));
            match fault {
                MessageFault::Twice => {
                    format!("message \"{name}\" already exists (created here: {before}) cannot set again from {here}")
                }
                MessageFault::AskedBefore => format!(
                    "message \"{name}\" was queried before being set (queried here: {before}) setting it now ({here}) would lead to \
                     inconsistent results"
                ),
                MessageFault::Type { created, wanted } => format!(
                    "type mismatch for message \"{name}\" (created as {created} here: {before}) cannot fetch as {wanted} from {here}"
                ),
            }
        }
        _ => report.to_string(),
    }
}

fn at(place: &ReportPlace) -> String {
    format!("{}:{}", place.file, place.line)
}
