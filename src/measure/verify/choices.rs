//! The values of a shader's parameters that are tried: what the user gives, ranges of metadata, and what else is likely.

use crate::check::compared::Compared;
use crate::check::typed::{Expr, ExprKind, Metadata, ShaderParam};
use crate::compile::Shader;
use crate::lang::types::{Base, Type};
use velour_grammar::ast::UnaryOp;

/// Names that metadata gives to the ends of a parameter's range, hard limits first.
const RANGES: [(&str, &str); 4] =
    [("min", "max"), ("softmin", "softmax"), ("UImin", "UImax"), ("slidermin", "slidermax")];
/// Values that a range is tried at in full.
const STEPS: usize = 5;
/// Values of a parameter without a range that are surveyed at most.
const MOST: usize = 16;

/// A parameter that the user sets, and the values to try: several for a sweep.
pub(super) struct Setting {
    /// The parameter.
    pub name: String,
    /// Its values, as texts.
    pub values: Vec<String>,
}

/// Splits what the user gave for a parameter into values.
pub(super) fn setting(shader: &Shader, name: &str, text: &str) -> Setting {
    let each = shader.typed.param(name).and_then(|(_, variable)| components(&variable.ty));
    let parts: Vec<&str> = text.split(',').collect();
    let values = match each {
        Some(each) if parts.len().is_multiple_of(each) => parts.chunks(each).map(|value| value.join(",")).collect(),
        _ => vec![text.to_owned()],
    };
    Setting { name: name.to_owned(), values }
}

/// How many parts of a text one value of a type takes; nothing for arrays and structs, which are given whole.
fn components(ty: &Type) -> Option<usize> {
    if ty.is_array() {
        return None;
    }
    match ty.base()? {
        Base::String => Some(1),
        base => Some(base.components().max(1)),
    }
}

/// The float parameters whose metadata tells their range, with its ends.
fn ranged(shader: &Shader) -> Vec<(String, [f32; 2])> {
    let mut out = Vec::new();
    for (param, variable) in shader.typed.declared().filter(|(param, _)| !param.output) {
        let of = |name: &str| param.metadata.iter().find(|entry| entry.name == name).and_then(value);
        let range = RANGES.iter().find_map(|(low, high)| Some([of(low)?, of(high)?]));
        if let Some([low, high]) = range.filter(|[low, high]| variable.ty == Type::FLOAT && low < high) {
            out.push((variable.name.to_string(), [low, high]));
        }
    }
    out
}

/// The ranges of a shader's parameters, each with a few values to try in full.
pub(super) fn ranges(shader: &Shader) -> Vec<Setting> {
    let at = |[low, high]: [f32; 2], k: usize| low + (high - low) * k as f32 / (STEPS - 1) as f32;
    let values = |ends| (0..STEPS).map(|k| format!("{}", at(ends, k))).collect();
    ranged(shader).into_iter().map(|(name, ends)| Setting { name, values: values(ends) }).collect()
}

/// Values of all parameters to survey: ranges closely, and of the others what their defaults, their choices and what the shader
/// compares with suggest.
pub(super) fn surveyed(shader: &Shader, steps: usize) -> Vec<Setting> {
    let typed = &shader.typed;
    let compared = Compared::of(typed);
    let ranged = ranged(shader);
    let mut out = Vec::new();
    for (param, variable) in typed.declared().filter(|(param, _)| !param.output) {
        let values = match ranged.iter().find(|(name, _)| *name == variable.name) {
            // The inverse of the golden ratio fills any number of steps evenly.
            Some((_, [low, high])) => {
                let at = |k: usize| low + (high - low) * (0.5 + 0.618_034 * k as f32).fract();
                (0..steps).map(|k| format!("{}", at(k))).collect()
            }
            None => suggested(param, &variable.ty, &compared),
        };
        if !values.is_empty() {
            out.push(Setting { name: variable.name.to_string(), values });
        }
    }
    out
}

/// Values that a parameter without a range may take.
fn suggested(param: &ShaderParam, ty: &Type, compared: &Compared) -> Vec<String> {
    let options = param.metadata.iter().find(|entry| entry.name == "options");
    let options =
        options.and_then(|entry| if let ExprKind::String(text) = &entry.value.kind { Some(text) } else { None });
    let listed: Vec<&str> = options.map_or(Vec::new(), |text| text.split(['|', ',']).collect());
    let unit = |value: f32| (0.0..=1.0).contains(&value);
    match ty.base().filter(|_| !ty.is_array()) {
        Some(Base::String) => {
            listed.into_iter().map(str::to_owned).chain(compared.strings.clone()).take(MOST).collect()
        }
        Some(Base::Int) => {
            let numbers = listed.iter().filter_map(|entry| entry.rsplit(':').next()?.trim().parse().ok());
            let near = compared.ints.iter().flat_map(|&k| [k.saturating_sub(1), k, k.saturating_add(1)]);
            let mut all: Vec<i32> = numbers.chain([0, 1, 2, 3]).chain(near).collect();
            all.sort_unstable();
            all.dedup();
            all.into_iter().take(MOST).map(|k| k.to_string()).collect()
        }
        // What is a part of something stays one; what is larger may be smaller, but nobody says how much larger it may be.
        Some(Base::Float) => match param.default.as_ref().and_then(number) {
            Some(value) if unit(value) => ["0", "0.03", "0.25", "0.5", "0.75", "1"].map(str::to_owned).to_vec(),
            Some(value) if value.is_finite() => [0.25, 0.5, 0.8].map(|k| format!("{}", k * value)).to_vec(),
            _ => Vec::new(),
        },
        Some(Base::Color) => ["0,0,0", "1,1,1", "1,0,0", "0,1,0", "0,0,1", "0.2,0.5,0.9"].map(str::to_owned).to_vec(),
        _ => Vec::new(),
    }
}

/// The number that an entry of metadata gives.
fn value(entry: &Metadata) -> Option<f32> {
    number(&entry.value).filter(|x| x.is_finite())
}

/// The number that an expression is, written out.
fn number(expr: &Expr) -> Option<f32> {
    match &expr.kind {
        ExprKind::Int(x) => Some(*x as f32),
        ExprKind::Float(x) => Some(*x),
        ExprKind::Convert(inner) => number(inner),
        ExprKind::Unary(UnaryOp::Neg, inner) => number(inner).map(|x| -x),
        _ => None,
    }
}
