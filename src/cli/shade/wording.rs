//! What goes wrong, in the words of OSL's shading system, which people search for and its references have.
//!
//! Decision (2026-11-29): where a group cannot be built, OSL's words come first and a line that begins with FAILED says what velour
//! knows besides, such as the folders looked in or the parameters that there are; instead of our words alone, by which nobody
//! who knows testshade would find the mistake, or of OSL's alone, which offer no way out.

use crate::compile::{GroupProblem, GroupSubject};
use crate::exec::{MessageFault, Mistake, Report, ReportKind, ReportPlace};
use crate::scene::{Connection, GroupSpec, SceneError, SceneProblem};

/// Why a group cannot be built: a layer or a parameter that is not there, or that nothing may feed. `text` where it was written as one.
pub fn group_error(error: &SceneError, spec: &GroupSpec, text: bool) -> String {
    let SceneProblem::Group(group) = &*error.problem else { return error.to_string() };
    let known = |name: &str| spec.layers.iter().any(|layer| layer.layer_name == name);
    let joins = |c: &&Connection| match &group.subject {
        GroupSubject::Layer(_) => !known(&c.source_layer) || !known(&c.target_layer),
        GroupSubject::Param { layer, name } => c.target_layer == *layer && c.target_param == *name,
    };
    let Some(connection) = spec.connections.iter().find(joins) else { return error.to_string() };
    let reason = match &*group.problem {
        GroupProblem::NoLayer { layer } if *layer == connection.source_layer => {
            format!("source layer \"{layer}\" not found")
        }
        GroupProblem::NoLayer { layer } => format!("destination layer \"{layer}\" not found"),
        GroupProblem::NotConnectable { path } => {
            format!("cannot connect to {}.{path} because it has metadata allowconnect=0", connection.target_layer)
        }
        _ => return error.to_string(),
    };
    let name = &spec.name;
    let mut out = format!("ERROR: ConnectShaders: {reason}\n        group: {name}\n");
    if text {
        let Connection { source_layer, source_param, target_layer, target_param, .. } = connection;
        out += &format!(
            "ERROR: ShaderGroupBegin: error parsing group description: \n        group: {name}\n        problem might be here: \
             connect {source_layer}.{source_param} {target_layer}.{target_param};\n\n"
        );
    }
    let place = error.place.as_ref().map_or(String::new(), |place| format!(" at {place}"));
    out += &format!("FAILED to build the group{place}: {}; {}", group.problem, group.help);
    if text {
        out += "\nERROR: Invalid shader group. Exiting testshade.";
    }
    out
}

/// Shaders that are not found, and the first connection that is idle without them.
pub fn missing(shaders: &[&str], help: &str, spec: &GroupSpec) -> String {
    let name = &spec.name;
    let mut out: String = shaders
        .iter()
        .map(|shader| {
            format!(
                "ERROR: No .oso file could be found for shader \"{shader}\"\nERROR: Could not find shader \"{shader}\"\n        \
                 group: {name}\n"
            )
        })
        .collect();
    let known = |layer: &str| {
        spec.layers.iter().any(|known| known.layer_name == layer && !shaders.contains(&known.shader.as_str()))
    };
    for c in &spec.connections {
        let (end, layer) = match (known(&c.source_layer), known(&c.target_layer)) {
            (false, _) => ("source", &c.source_layer),
            (true, false) => ("destination", &c.target_layer),
            (true, true) => continue,
        };
        out += &format!("ERROR: ConnectShaders: {end} layer \"{layer}\" not found\n        group: {name}\n");
        break;
    }
    out + &format!("FAILED to build the group: {help}")
}

/// A call of `error` that is still there when the group is optimised.
pub fn error_call(place: &ReportPlace, group: &str) -> String {
    format!(
        "WARNING: Optimization warning:\n  group:  {group}\n  layer:  {}\n  source: {}\n  issue:  error() call present in optimized \
         shader.\n",
        place.layer,
        at(place)
    )
}

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
        Mistake::NoDictionary { name } => {
            format!(
                "XML parsed with errors: File was not found, at offset 0\nFAILED to read \"{name}\", which {} asks for",
                at(place)
            )
        }
        Mistake::NotFinite { nan, variable, operation } => {
            let value = if *nan { "nan" } else { "inf" };
            format!("Detected {value} value in {variable} at {} (op {operation})", at(place))
        }
        Mistake::TextureInfo { reason } => format!("[RendererServices::get_texture_info] {reason}"),
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
