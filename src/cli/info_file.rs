//! What a shader declares, in the manner of oslinfo: kind, name, parameters with types, defaults and metadata.

use crate::check::typed::{Expr, Metadata, Shader, ShaderParam, Variable};
use crate::check::{Constant, constants};
use crate::lang::types::{Base, Length, Type};
use velour_grammar::ast::ShaderKind;
use velour_grammar::json;

/// The declaration of a shader as text.
pub fn shader_text(shader: &Shader) -> String {
    let mut out = format!("{} \"{}\"\n", kind_of(shader), shader.name);
    out.extend(shader.metadata.iter().map(|entry| metadata_text("\t\t", entry)));
    for (param, variable) in shader.declared() {
        out += &param_text(param, variable);
    }
    out
}

fn kind_of(shader: &Shader) -> &'static str {
    match shader.kind {
        ShaderKind::Generic => "shader",
        ShaderKind::Surface => "surface",
        ShaderKind::Displacement => "displacement",
        ShaderKind::Volume => "volume",
    }
}

/// The declaration in lines of a word each for kind and name, then for each parameter `output`, if it is one, type, name and
/// default.
pub fn shader_lines(shader: &Shader) -> String {
    let mut out = format!("{} {}\n", kind_of(shader), shader.name);
    for (param, variable) in shader.declared() {
        let output = if param.output { "output " } else { "" };
        let default = param.default.as_ref().and_then(|value| known(&variable.ty, value));
        out += &format!(
            "{output}{} {} {}\n",
            declared_type(variable, param),
            variable.name,
            default.as_deref().unwrap_or("nodefault")
        );
    }
    out
}

/// The declaration as JSON: `kind`, `name`, `metadata`, and `params` with `name`, `type`, `output`, `default` (a list of numbers and
/// strings, or null where it is computed) and `metadata`.
pub fn shader_json(shader: &Shader) -> String {
    let params = shader.declared().map(|(param, variable)| {
        format!(
            "\n  {{\"name\":{},\"type\":{},\"output\":{},\"default\":{},\"metadata\":{}}}",
            json(&variable.name),
            json(&declared_type(variable, param).to_string()),
            param.output,
            param.default.as_ref().map_or("null".to_owned(), json_value),
            json_metadata(&param.metadata)
        )
    });
    format!(
        "{{\"kind\":\"{}\",\"name\":{},\"metadata\":{},\"params\":[{}]}}\n",
        kind_of(shader),
        json(&shader.name),
        json_metadata(&shader.metadata),
        params.collect::<Vec<_>>().join(",")
    )
}

fn json_metadata(metadata: &[Metadata]) -> String {
    let entry = |entry: &Metadata| {
        let (name, ty) = (json(&entry.name), json(&entry.ty.to_string()));
        format!("{{\"name\":{name},\"type\":{ty},\"value\":{}}}", json_value(&entry.value))
    };
    format!("[{}]", metadata.iter().map(entry).collect::<Vec<_>>().join(","))
}

/// A constant as a list; JSON has no infinities, which are then null.
fn json_value(value: &Expr) -> String {
    let Some(mut parts) = texts(value, json) else { return "null".to_owned() };
    let none = |part: &&mut String| ["inf", "-inf", "NaN"].contains(&part.as_str());
    parts.iter_mut().filter(none).for_each(|part| *part = "null".into());
    format!("[{}]", parts.join(","))
}

fn param_text(param: &ShaderParam, variable: &Variable) -> String {
    let output = if param.output { "output " } else { "" };
    let mut out = format!("    \"{}\" \"{output}{}\"\n", variable.name, declared_type(variable, param));
    match &variable.ty.structure() {
        Some(structure) => {
            let fields: Vec<String> = structure.fields.iter().map(|(name, ty)| format!("{ty} {name}")).collect();
            out += &format!("\t\tfields: {{{}}}\n", fields.join(", "));
        }
        None => out += &format!("\t\t{}\n", default_text(&variable.ty, param.default.as_ref())),
    }
    out.extend(param.metadata.iter().map(|entry| metadata_text("\t\t", entry)));
    out
}

/// The type as it was declared: an array of any length has none.
fn declared_type(variable: &Variable, param: &ShaderParam) -> Type {
    if param.open { variable.ty.array(Length::Unsized) } else { variable.ty.clone() }
}

fn metadata_text(indent: &str, entry: &Metadata) -> String {
    let value = known(&entry.ty, &entry.value).unwrap_or_else(|| "?".to_owned());
    let value = value.trim_start_matches("[ ").trim_end_matches(" ]");
    format!("{indent}metadata: {} {} = {value}\n", entry.ty, entry.name)
}

fn default_text(ty: &Type, default: Option<&Expr>) -> String {
    match default.and_then(|value| known(ty, value)) {
        Some(text) => format!("Default value: {text}"),
        // Computed from globals or other parameters, so there is nothing to show before the shader runs.
        None => "Unknown default value".to_owned(),
    }
}

/// A value that can be told without running the shader.
fn known(ty: &Type, value: &Expr) -> Option<String> {
    if ty.base() == Some(Base::Closure) {
        return Some("0".to_owned());
    }
    let mut parts = texts(value, |text| format!("{text:?}"))?;
    let plain = parts.len() == 1 && !ty.is_array();
    Some(if plain { parts.remove(0) } else { format!("[ {} ]", parts.join(" ")) })
}

/// The parts of a constant as texts; strings are `quoted`.
fn texts(value: &Expr, quoted: fn(&str) -> String) -> Option<Vec<String>> {
    let text = |part: Constant| match part {
        Constant::Int(x) => x.to_string(),
        Constant::Float(x) => float_text(x),
        Constant::String(x) => quoted(&x),
    };
    Some(constants(value)?.into_iter().map(text).collect())
}

/// The shortest digits that give the number back, with an exponent where there would be many zeros.
fn float_text(x: f32) -> String {
    let long = x != 0.0 && !(1e-4..1e7).contains(&x.abs()) && x.is_finite();
    if long { format!("{x:e}") } else { x.to_string() }
}
