//! A user's shader as a subject: its whole closure tree is what scatters, over ranges of its parameters and of the surface.

use super::nothing::Nothing;
use super::subject::{Promise, Promises, Scatterer, Subject};
use super::tree::{Spot, TreeScatterer};
use super::view::View;
use crate::check::typed::{Expr, ExprKind, Metadata};
use crate::closure::Settings;
use crate::closure::print::tree_text;
use crate::compile::{GroupError, Shader};
use crate::exec::{Group, Machine, Points};
use crate::lang::types::{Base, Type};
use crate::math::columns::Column3;

use velour_grammar::ast::UnaryOp;

/// Names that metadata gives to the ends of a parameter's range, hard limits first.
const RANGES: [(&str, &str); 4] =
    [("min", "max"), ("softmin", "softmax"), ("UImin", "UImax"), ("slidermin", "slidermax")];
/// Values that a range is tried at.
const STEPS: usize = 5;
/// Surface coordinates that are tried, all against all.
const GRID: [f32; 3] = [0.1, 0.5, 0.9];

/// A parameter that the user sets, and the values to try: several for a sweep.
struct Setting {
    name: String,
    values: Vec<String>,
}

/// A shader with the places and parameters it is tried at.
#[derive(Debug)]
pub struct ShaderSubject {
    name: String,
    variants: Vec<(String, Group, Spot)>,
    settings: Settings,
}

impl ShaderSubject {
    /// The subject of a shader. `given` are parameters with values: as many numbers as the parameter has components make
    /// one value, more of them several.
    ///
    /// # Errors
    /// The first parameter that does not fit.
    pub fn new(
        name: &str,
        shader: &Shader,
        given: &[(String, String)],
        settings: Settings,
    ) -> Result<Self, GroupError> {
        let set: Vec<Setting> = given.iter().map(|(name, text)| setting(shader, name, text)).collect();
        let ranges: Vec<Setting> =
            ranges(shader).into_iter().filter(|range| set.iter().all(|s| s.name != range.name)).collect();
        let first = |setting: &Setting| (setting.name.clone(), setting.values[0].clone());
        let usual: Vec<(String, String)> = set.iter().map(first).collect();
        let mut choices = vec![usual.clone()];
        let others = set.iter().map(|s| (s, 1)).chain(ranges.iter().map(|s| (s, 0)));
        for (setting, from) in others {
            for value in &setting.values[from..] {
                let mut choice = usual.clone();
                choice.retain(|(name, _)| *name != setting.name);
                choice.push((setting.name.clone(), value.clone()));
                choices.push(choice);
            }
        }
        let mut variants = Vec::new();
        for choice in choices {
            let builder = choice.iter().fold(shader.group(), |builder, (name, text)| builder.text(name, text));
            let group = builder.build()?;
            let spots = spots(&group);
            let many = spots.len() > 1;
            for spot in spots {
                variants.push((label(&choice, spot, many), group.clone(), spot));
            }
        }
        Ok(ShaderSubject { name: name.to_owned(), variants, settings })
    }
}

impl Subject for ShaderSubject {
    fn name(&self) -> &str {
        &self.name
    }

    fn variants(&self) -> usize {
        self.variants.len()
    }

    fn label(&self, variant: usize) -> String {
        self.variants[variant].0.clone()
    }

    fn promises(&self, _variant: usize) -> Promises {
        // A shader may lay and soften on purpose what is not reciprocal then; light out of nothing is never meant.
        Promises { energy: Promise::Kept, reciprocity: Promise::Open, layered: true, lossless: false }
    }

    fn scatterer(&self, variant: usize) -> Box<dyn Scatterer + '_> {
        let (_, group, spot) = &self.variants[variant];
        if group.can_scatter() {
            Box::new(TreeScatterer::new(group.clone(), *spot, self.settings))
        } else {
            Box::new(Nothing::default())
        }
    }
}

fn label(choice: &[(String, String)], spot: Spot, many: bool) -> String {
    let mut parts: Vec<String> = choice.iter().map(|(name, text)| format!("{name} {text}")).collect();
    if many {
        parts.push(format!("u {}, v {}{}", spot.uv[0], spot.uv[1], if spot.back { ", from behind" } else { "" }));
    }
    if parts.is_empty() { "defaults".to_owned() } else { parts.join(", ") }
}

/// Splits what the user gave for a parameter into values.
fn setting(shader: &Shader, name: &str, text: &str) -> Setting {
    let variables = &shader.typed.variables;
    let mut types = shader.typed.params.iter().map(|p| &variables[p.var.0 as usize]);
    let each = types.find(|v| v.name == name).and_then(|v| components(&v.ty));
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

/// The float parameters whose metadata tells their range.
fn ranges(shader: &Shader) -> Vec<Setting> {
    let typed = &shader.typed;
    let mut out = Vec::new();
    for param in &typed.params {
        let variable = &typed.variables[param.var.0 as usize];
        if param.output || variable.ty != Type::FLOAT {
            continue;
        }
        let of = |name: &str| param.metadata.iter().find(|entry| entry.name == name).and_then(value);
        let Some((low, high)) = RANGES.iter().find_map(|(low, high)| Some((of(low)?, of(high)?))) else { continue };
        if low < high {
            let at = |k: usize| low + (high - low) * k as f32 / (STEPS - 1) as f32;
            out.push(Setting {
                name: variable.name.clone(),
                values: (0..STEPS).map(|k| format!("{}", at(k))).collect(),
            });
        }
    }
    out
}

/// The number that an entry of metadata gives.
fn value(entry: &Metadata) -> Option<f32> {
    fn number(expr: &Expr) -> Option<f32> {
        match &expr.kind {
            ExprKind::Int(x) => Some(*x as f32),
            ExprKind::Float(x) => Some(*x),
            ExprKind::Convert(inner) => number(inner),
            ExprKind::Unary(UnaryOp::Neg, inner) => number(inner).map(|x| -x),
            _ => None,
        }
    }
    number(&entry.value).filter(|x| x.is_finite())
}

/// Places on the surface where the tree differs, as a few viewers see it.
fn spots(group: &Group) -> Vec<Spot> {
    let views = [(1.0, 0.0), (0.6, 0.5), (0.2, 3.0)].map(|(cos, azimuth)| View { cos, azimuth }.wo());
    let mut wo = Column3::zeros(views.len());
    views.into_iter().enumerate().for_each(|(lane, view)| wo.set(lane, view));
    let (mut machine, mut points) = (Machine::new(), Points::default());
    let (mut out, mut texts) = (Vec::new(), Vec::new());
    let places = GRID.into_iter().flat_map(|v| GRID.map(|u| [u, v]));
    // The middle first: it stands for all places when they are alike.
    let places: Vec<[f32; 2]> = std::iter::once(Spot::MIDDLE.uv).chain(places).collect();
    for back in [false, true] {
        for &uv in &places {
            let spot = Spot { uv, back };
            spot.points(&wo, &mut points);
            let tree = machine.shade(group, &points);
            let text: Vec<String> = (0..views.len()).map(|lane| tree_text(group.table(), tree, lane)).collect();
            if !texts.contains(&text) {
                texts.push(text);
                out.push(spot);
            }
        }
    }
    out
}
