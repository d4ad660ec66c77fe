//! A `<ShaderGroup>` as it is written: statements or elements, to layers, parameters and connections.

use super::error::{Place, SceneError, SceneProblem};
use super::group::{Connection, GroupSpec, Hints, Layer, ParamType, ParamValue, Usage, Values};
use super::spec::{Statements, parse_group};
use super::xml::Element;
use crate::lang::nearest::nearest;
use std::path::PathBuf;

const TAGS: [&str; 3] = ["Parameter", "Shader", "ConnectShaders"];

/// The group that an element describes; `folders` are searched for its shaders.
pub fn read_group(e: &Element, folders: &[PathBuf]) -> Result<GroupSpec, SceneError> {
    e.check_attributes(&["name", "type", "commands", "is_light"])?;
    let usage = usage_of(e)?;
    let is_light = matches!(e.node.attribute("is_light"), Some("1" | "on" | "yes"));
    let Statements { mut layers, mut connections, mut pending } = group_text(e)?;
    for child in e.children() {
        group_child(&child, &mut layers, &mut connections, &mut pending)?;
    }
    if layers.is_empty() {
        return Err(SceneError::at(e.place(), SceneProblem::EmptyGroup)
            .with_help("write `shader NAME LAYER;` in it, or a <Shader name=\"\" layer=\"\"/>"));
    }
    if let Some(param) = pending.first() {
        return Err(SceneError::at(param.place.clone(), SceneProblem::StrayParameter { name: param.name.clone() })
            .with_help("a parameter belongs to the next shader of the group"));
    }
    check_connections(&layers, &connections)?;
    let name = e.node.attribute("name").unwrap_or("group").into();
    Ok(GroupSpec { usage, name, is_light, layers, connections, place: e.place(), search: folders.to_vec() })
}

fn usage_of(e: &Element) -> Result<Usage, SceneError> {
    let name = e.node.attribute("type").unwrap_or("surface");
    Usage::from_name(name).ok_or_else(|| {
        let error = e.bad_value("type", "surface, displacement, volume or shader");
        match nearest(name, &Usage::NAMES) {
            Some(near) => error.with_help(format!("did you mean `{near}`?")),
            None => error,
        }
    })
}

/// The statements of the `commands` attribute, or else of the element's own text.
fn group_text(e: &Element) -> Result<Statements, SceneError> {
    let (text, range) = match e.node.attribute_node("commands") {
        Some(attribute) => (attribute.value(), attribute.range_value()),
        None => match e.node.children().find(|n| n.is_text() && !n.text().unwrap_or("").trim().is_empty()) {
            Some(node) => (node.text().unwrap_or(""), node.range()),
            None => return Ok(Statements::default()),
        },
    };
    // Entities make the text shorter than its source; then offsets do not map, and the start has to do.
    let exact = range.len() == text.len();
    parse_group(text, &|offset| e.place_at(range.start + if exact { offset } else { 0 }))
}

fn group_child(
    e: &Element,
    layers: &mut Vec<Layer>,
    connections: &mut Vec<Connection>,
    pending: &mut Vec<ParamValue>,
) -> Result<(), SceneError> {
    match e.tag() {
        "Parameter" => {
            pending.extend(e.attributes().map(|a| parameter_value(a.name(), a.value(), e.place_at(a.range().start))))
        }
        "Shader" => {
            e.check_attributes(&["type", "name", "layer"])?;
            let shader = e.required("name")?.to_owned();
            let layer_name = e.required("layer")?.to_owned();
            let params = std::mem::take(pending);
            layers.push(Layer { shader, layer_name, params, place: e.value_place("name") });
        }
        "ConnectShaders" => {
            e.check_attributes(&["srclayer", "srcparam", "dstlayer", "dstparam"])?;
            connections.push(Connection {
                source_layer: e.required("srclayer")?.to_owned(),
                source_param: e.required("srcparam")?.to_owned(),
                target_layer: e.required("dstlayer")?.to_owned(),
                target_param: e.required("dstparam")?.to_owned(),
                place: e.place(),
            });
        }
        _ => return Err(e.unknown_tag(&TAGS)),
    }
    Ok(())
}

/// `int 3`, `float .5`, `color 1 2 3` and so on; anything else is a string, as testrender reads it.
fn parameter_value(name: &str, text: &str, place: Place) -> ParamValue {
    let plain = |kind, values| ParamValue {
        kind,
        array: None,
        name: name.to_owned(),
        values,
        hints: Hints::default(),
        place: place.clone(),
    };
    let (word, rest) = text.split_once(' ').unwrap_or(("", text));
    let number = rest.trim();
    if word == "int"
        && let Ok(value) = number.parse()
    {
        return plain(ParamType::Int, Values::Ints(vec![value]));
    }
    if let Some(kind) = ParamType::from_name(word).filter(|k| !matches!(k, ParamType::Int | ParamType::String)) {
        let floats: Result<Vec<f32>, _> = number.split_whitespace().map(str::parse).collect();
        if let Ok(floats) = floats
            && floats.len() == kind.components()
        {
            return plain(kind, Values::Floats(floats));
        }
    }
    plain(ParamType::String, Values::Strings(vec![text.to_owned()]))
}

/// A connection must join two layers of the group, the earlier to the later.
fn check_connections(layers: &[Layer], connections: &[Connection]) -> Result<(), SceneError> {
    let names: Vec<&str> = layers.iter().map(|l| l.layer_name.as_str()).collect();
    for c in connections {
        let find = |layer: &str| {
            names.iter().position(|n| *n == layer).ok_or_else(|| {
                let error = SceneError::at(c.place.clone(), SceneProblem::NoSuchLayer { layer: layer.to_owned() });
                error.with_help(format!("the group's layers are: {}", names.join(", ")))
            })
        };
        if find(&c.source_layer)? >= find(&c.target_layer)? {
            let problem = SceneProblem::LayerOrder { source: c.source_layer.clone(), target: c.target_layer.clone() };
            return Err(
                SceneError::at(c.place.clone(), problem).with_help("values flow from earlier layers to later ones")
            );
        }
    }
    Ok(())
}
