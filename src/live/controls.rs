//! The controls of a subject as the page draws them: groups, layers and parameters, with what their metadata says.

use super::inbox::Knob;
use super::subject::{Overrides, Part, Subject, base};
use super::values::{Given, kind};
use crate::check::constants;
use crate::check::typed::{Metadata, ShaderParam};
use crate::compile::Shader;
use crate::scene::Layer;
use serde_json::{Value, json};

/// Entries of metadata that say how a parameter is shown, as OSL's own conventions have them.
const SHOWN: [&str; 15] = [
    "label",
    "help",
    "page",
    "widget",
    "options",
    "units",
    "min",
    "max",
    "softmin",
    "softmax",
    "slidermin",
    "slidermax",
    "UImin",
    "UImax",
    "slider",
];

/// All groups with all parameters that can be shown.
pub fn controls(subject: &Subject, overrides: &Overrides) -> Value {
    let groups = subject.parts.iter().enumerate().map(|(number, part)| {
        let layers: Vec<Value> = part
            .spec
            .layers
            .iter()
            .zip(&part.shaders)
            .enumerate()
            .map(|(k, (layer, shader))| {
                let params = params(part, layer, shader, (number, k), overrides);
                json!({"name": layer.layer_name, "shader": shader.name(), "params": params})
            })
            .collect();
        let first = Some(subject.stands_for(number)).filter(|first| *first != number);
        json!({"name": label(subject, number), "as": first, "layers": layers})
    });
    json!({"first": subject.first, "groups": groups.collect::<Vec<_>>()})
}

/// What people call a group: its name, or its last shader's, with a number where several are called so.
pub fn label(subject: &Subject, number: usize) -> String {
    let number = subject.stands_for(number);
    let name = |k: usize| {
        let part = &subject.parts[k];
        let shown = subject.own_layer(k).or(part.shaders.len().checked_sub(1));
        let shader = || shown.map_or(String::new(), |layer| part.shaders[layer].name().to_owned());
        let unnamed = part.spec.name == "group" || subject.own_layer(k).is_some();
        if unnamed { shader() } else { part.spec.name.clone() }
    };
    let own = name(number);
    let same = |end: usize| (0..end).filter(|&k| subject.stands_for(k) == k && name(k) == own).count();
    if same(subject.parts.len()) > 1 { format!("{own} {}", same(number) + 1) } else { own }
}

fn params(
    part: &Part,
    layer: &Layer,
    shader: &Shader,
    (group, number): (usize, usize),
    overrides: &Overrides,
) -> Vec<Value> {
    let mut out = Vec::new();
    for (param, variable) in shader.typed.declared().filter(|(param, _)| !param.output) {
        let Some(kind) = kind(&variable.ty) else { continue };
        let name = variable.name.to_string();
        let mut shown = serde_json::Map::new();
        for (entry, value) in SHOWN.iter().filter_map(|entry| Some((*entry, metadata(param, entry)?))) {
            shown.insert(entry.to_owned(), value);
        }
        let feeds = |c: &&crate::scene::Connection| {
            c.target_layer == layer.layer_name && crate::lang::path::root(&c.target_param) == name
        };
        let fed = part.spec.connections.iter().find(feeds);
        let base = base(layer, shader, &name);
        let knob = Knob { group, layer: number, name: name.clone() };
        out.push(json!({
            "name": name,
            "type": kind.name(),
            "meta": shown,
            "base": base.as_ref().map(Given::json),
            "value": overrides.get(&knob).or(base.as_ref()).map(Given::json),
            "set": overrides.contains_key(&knob),
            "fed": fed.map(|c| format!("{}.{}", c.source_layer, c.source_param)),
        }));
    }
    out
}

/// The double of the fewest digits that is the same single: .05 is .05, and not what a single makes of it.
fn short(x: f64) -> f64 {
    (x as f32).to_string().parse().unwrap_or(x)
}

/// An entry of metadata: a number or a text.
fn metadata(param: &ShaderParam, name: &str) -> Option<Value> {
    let entry: &Metadata = param.metadata.iter().find(|entry| entry.name == name)?;
    match Given::of_constants(&constants(&entry.value)?)? {
        Given::Numbers(numbers) => numbers.first().filter(|x| x.is_finite()).map(|&x| Value::from(short(x))),
        Given::Text(text) => Some(Value::from(text)),
    }
}
