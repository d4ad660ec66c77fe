//! A user's shader as a subject: its whole closure tree is what scatters, over ranges of its parameters and of the surface.

use super::choices::{Setting, ranges, setting, surveyed};
use super::direction::View;
use super::effort::Effort;
use super::nothing::Nothing;
use super::subject::{Promise, Promises, Scatterer, Subject};
use super::survey::{Suspect, survey};
use super::tree::{Spot, TreeScatterer};
use crate::closure::Settings;
use crate::closure::print::tree_text;
use crate::compile::{GroupError, Shader};
use crate::exec::{Group, Machine, Points, RAY_TYPES, Report};
use crate::math::columns::Column3;
use rayon::prelude::*;

/// Surface coordinates that are tried, all against all.
const GRID: [f32; 3] = [0.1, 0.5, 0.9];

/// How many groups are surveyed at most, and how many places of all are looked at again.
const MOST_GROUPS: usize = 96;
const MOST_SUSPECTS: usize = 6;

/// Parameters with their values, as texts.
type Choice = Vec<(String, String)>;

/// A group at a place, with the parameters that make it, and views to try beside the usual ones.
#[derive(Clone, Debug)]
struct Variant {
    label: String,
    group: Group,
    spot: Spot,
    views: Vec<View>,
}

/// A shader with the places and parameters it is tried at.
#[derive(Debug)]
pub struct ShaderSubject {
    name: String,
    variants: Vec<Variant>,
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
        effort: &Effort,
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
                choices.push(with(&usual, &setting.name, value));
            }
        }
        let mut variants = Vec::new();
        for choice in choices {
            let group = build(shader, &choice)?;
            let spots = spots(&group);
            let many = spots.len() > 1;
            for spot in spots {
                let label = label(&choice, spot, many);
                variants.push(Variant { label, group: group.clone(), spot, views: Vec::new() });
            }
        }
        let free = |setting: &Setting| set.iter().all(|given| given.name != setting.name);
        let surveyed: Vec<Setting> = surveyed(shader, effort.steps).into_iter().filter(free).collect();
        variants.extend(suspects(shader, &usual, &surveyed, settings, effort));
        Ok(ShaderSubject { name: name.to_owned(), variants, settings })
    }
}

/// The same parameters with another value of one.
fn with(usual: &[(String, String)], name: &str, value: &str) -> Choice {
    let others = usual.iter().filter(|(other, _)| other != name).cloned();
    others.chain([(name.to_owned(), value.to_owned())]).collect()
}

/// The group of a shader with these parameters.
fn build(shader: &Shader, choice: &[(String, String)]) -> Result<Group, GroupError> {
    choice.iter().fold(shader.group(), |builder, (name, text)| builder.text(name, text)).build()
}

/// Surveys the usual parameters closely and each other value a little; gives what deserves a closer look.
fn suspects(
    shader: &Shader,
    usual: &[(String, String)],
    surveyed: &[Setting],
    settings: Settings,
    effort: &Effort,
) -> Vec<Variant> {
    let mut choices = vec![(usual.to_vec(), effort.places)];
    for setting in surveyed {
        for value in &setting.values {
            choices.push((with(usual, &setting.name, value), effort.places / 8));
        }
    }
    choices.truncate(MOST_GROUPS);
    let look = |(choice, places): &(Choice, usize)| {
        // A value that does not fit a parameter is none of the shader's faults.
        let group = build(shader, choice).ok()?;
        let found = survey(&group, settings, *places);
        Some(found.into_iter().map(|suspect| (suspect, choice.clone(), group.clone())).collect::<Vec<_>>())
    };
    let mut found: Vec<(Suspect, Choice, Group)> = choices.par_iter().filter_map(look).flatten().collect();
    found.sort_by(|a, b| b.0.excess.total_cmp(&a.0.excess));
    found.truncate(MOST_SUSPECTS);
    let variant = |(suspect, choice, group): (Suspect, Choice, Group)| Variant {
        label: label(&choice, suspect.spot, suspect.spot != Spot::MIDDLE),
        group,
        spot: suspect.spot,
        views: vec![suspect.view],
    };
    found.into_iter().map(variant).collect()
}

impl Subject for ShaderSubject {
    fn name(&self) -> &str {
        &self.name
    }

    fn variants(&self) -> usize {
        self.variants.len()
    }

    fn label(&self, variant: usize) -> String {
        self.variants[variant].label.clone()
    }

    fn promises(&self, _variant: usize) -> Promises {
        // A shader may lay and soften on purpose what is not reciprocal then; light out of nothing is never meant.
        Promises { energy: Promise::Kept, reciprocity: Promise::Open, layered: true, lossless: false }
    }

    fn views(&self, variant: usize) -> Vec<View> {
        self.variants[variant].views.clone()
    }

    fn scatterer(&self, variant: usize) -> Box<dyn Scatterer + '_> {
        let Variant { group, spot, .. } = &self.variants[variant];
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
    if let Some((name, _)) = RAY_TYPES.iter().find(|(_, bit)| *bit == spot.ray_type && spot.ray_type != 1) {
        parts.push(format!("a {name} ray"));
    }
    if spot.width > 0.0 {
        parts.push(format!("pixels {} wide", spot.width));
    }
    if parts.is_empty() { "defaults".to_owned() } else { parts.join(", ") }
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
            let spot = Spot { uv, back, ..Spot::MIDDLE };
            spot.points(&wo, &mut points);
            machine.shade(group, &points);
            if machine.take_reports().iter().any(Report::is_fatal) {
                out.push(spot);
                return out;
            }
            let tree = machine.tree();
            let text: Vec<String> = (0..views.len()).map(|lane| tree_text(group.table(), tree, lane)).collect();
            if !texts.contains(&text) {
                texts.push(text);
                out.push(spot);
            }
        }
    }
    out
}
