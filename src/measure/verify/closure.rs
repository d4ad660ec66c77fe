//! A closure of the table as a subject: a shader that calls it is written from its declaration, one parameter a try.

use super::subject::{Promise, Promises, Scatterer, Subject};
use super::tree::{Spot, TreeScatterer};
use crate::closure::Settings;
use crate::compile::{Compiler, Shader};
use crate::exec::Group;
use crate::ir::lower::Binding;
use crate::lang::closures::{Claim, ClosureId, ClosureSpec, ParamKind, ParamSpec};

/// Words are tried in all combinations up to this many, and one after the other beyond.
const MOST_COMBINATIONS: usize = 12;
/// What a number is when the table names no values for it.
const USUAL: f32 = 0.5;
/// Boundaries are tried from both sides when the table names no values for their index.
const INDICES: [f32; 2] = [1.5, 1.0 / 1.5];
/// How many values of the first width or roughness are tried at least.
const LEAST_WIDTHS: usize = 5;

/// A parameter and the values it is given.
#[derive(Clone, Debug)]
struct Tried {
    name: &'static str,
    kind: ParamKind,
    values: Values,
}

#[derive(Clone, Debug)]
enum Values {
    Numbers(Vec<f32>),
    Words(Vec<&'static str>),
}

impl Tried {
    /// What is tried of a parameter; nothing when the table gives no reason to.
    fn of(param: &ParamSpec) -> Option<Tried> {
        let index = param.kind == ParamKind::Float && (param.name.starts_with("eta") || param.name == "ior");
        let swept = match param.kind {
            ParamKind::Float | ParamKind::Int | ParamKind::Color | ParamKind::Vector => param.sweep,
            ParamKind::String | ParamKind::Normal | ParamKind::Closure => &[],
        };
        let values = if !param.choices.is_empty() {
            Values::Words(param.choices.clone())
        } else if !swept.is_empty() {
            Values::Numbers(swept.to_vec())
        } else if index {
            Values::Numbers(INDICES.to_vec())
        } else {
            return None;
        };
        Some(Tried { name: param.name, kind: param.kind, values })
    }

    fn len(&self) -> usize {
        match &self.values {
            Values::Numbers(numbers) => numbers.len(),
            Values::Words(words) => words.len(),
        }
    }

    fn text(&self, value: usize) -> String {
        match &self.values {
            Values::Numbers(numbers) => format!("{}", numbers[value]),
            Values::Words(words) => format!("{:?}", words[value]),
        }
    }

    fn binding(&self, value: usize) -> Binding {
        match &self.values {
            Values::Words(words) => Binding::Strings(vec![words[value].to_owned()]),
            Values::Numbers(numbers) => {
                let count = if matches!(self.kind, ParamKind::Color | ParamKind::Vector) { 3 } else { 1 };
                Binding::Numbers(vec![f64::from(numbers[value]); count])
            }
        }
    }

    /// True when a value is the one that a waiver names.
    fn is(&self, value: usize, word: &str) -> bool {
        match &self.values {
            Values::Words(words) => words[value] == word,
            Values::Numbers(numbers) => word.parse::<f32>().is_ok_and(|number| number == numbers[value]),
        }
    }

    /// Fills in values between those of the table until there are enough.
    fn refine(&mut self) {
        let Values::Numbers(numbers) = &mut self.values else { return };
        while numbers.len() >= 2 && numbers.len() < LEAST_WIDTHS {
            let mut sorted = numbers.clone();
            sorted.sort_by(f32::total_cmp);
            let widest = sorted.windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
            let Some(pair) = widest else { return };
            numbers.push(0.5 * (pair[0] + pair[1]));
        }
    }
}

/// A closure by name, with the sweep of the table.
#[derive(Clone, Debug)]
pub struct ClosureSubject {
    name: String,
    spec: ClosureSpec,
    shader: Shader,
    tried: Vec<Tried>,
    /// The index of every tried parameter's value.
    variants: Vec<Vec<usize>>,
    settings: Settings,
}

impl ClosureSubject {
    /// The subject of one closure of the compiler's table; `thorough` crosses all words with all numbers.
    ///
    /// # Errors
    /// The messages, should the shader that calls it not compile.
    pub fn new(compiler: &Compiler, id: ClosureId, thorough: bool, settings: Settings) -> Result<Self, String> {
        let spec = compiler.closures.get(id).clone();
        let mut tried: Vec<Tried> = spec.params.iter().chain(&spec.keywords).filter_map(Tried::of).collect();
        if let Some(width) = tried.iter_mut().find(|t| matches!(t.values, Values::Numbers(_)) && is_width(t.name)) {
            width.refine();
        }
        let shader = compiler.compile(spec.name, &source(&spec, &tried)).map_err(|error| error.to_string())?;
        let variants = variants(&tried, thorough);
        let name = match compiler.closures.named(spec.name).position(|(other, _)| other == id) {
            Some(overload) if overload > 0 => format!("{} ({})", spec.name, overload + 1),
            _ => spec.name.to_owned(),
        };
        Ok(ClosureSubject { name, spec, shader, tried, variants, settings })
    }

    fn group(&self, variant: usize) -> Option<Group> {
        let pairs = self.tried.iter().zip(&self.variants[variant]);
        let builder = pairs.fold(self.shader.group(), |builder, (tried, &value)| {
            builder.bind(&parameter(tried.name), tried.binding(value))
        });
        builder.build().ok()
    }

    fn promise(&self, claim: Claim, variant: usize) -> Promise {
        let given = || self.tried.iter().zip(&self.variants[variant]);
        let holds = |only: Option<(&str, &str)>| {
            only.is_none_or(|(name, word)| given().any(|(tried, &value)| tried.name == name && tried.is(value, word)))
        };
        let waiver = self.spec.waivers.iter().find(|waiver| waiver.claim == claim && holds(waiver.only));
        waiver.map_or(Promise::Kept, |waiver| Promise::Waived(waiver.why))
    }
}

impl Subject for ClosureSubject {
    fn name(&self) -> &str {
        &self.name
    }

    fn variants(&self) -> usize {
        self.variants.len()
    }

    fn label(&self, variant: usize) -> String {
        let pairs = self.tried.iter().zip(&self.variants[variant]);
        let parts: Vec<String> = pairs.map(|(tried, &value)| format!("{} {}", tried.name, tried.text(value))).collect();
        parts.join(", ")
    }

    fn promises(&self, variant: usize) -> Promises {
        Promises {
            energy: self.promise(Claim::Energy, variant),
            reciprocity: self.promise(Claim::Reciprocity, variant),
            layered: self.spec.nests(),
            lossless: self.spec.lossless,
        }
    }

    fn scatterer(&self, variant: usize) -> Box<dyn Scatterer + '_> {
        // The text was made for these values, so they fit; without a group there would be nothing to look at.
        let group = self.group(variant).or_else(|| self.shader.group().build().ok());
        match group {
            Some(group) => Box::new(TreeScatterer::new(group, Spot::MIDDLE, self.settings)),
            None => Box::new(super::nothing::Nothing::because("the shader that calls the closure cannot be built")),
        }
    }
}

/// Does the parameter say how wide the lobe is?
fn is_width(name: &str) -> bool {
    ["rough", "alpha", "sigma", "exponent", "width", "_x", "nx"].iter().any(|part| name.contains(part))
}

/// The shader parameter of a closure parameter; prefixed, for a closure may use names that the language reserves.
fn parameter(name: &str) -> String {
    format!("p_{name}")
}

/// The text of a shader that calls the closure.
fn source(spec: &ClosureSpec, tried: &[Tried]) -> String {
    let declare = |tried: &Tried| {
        let (ty, value) = match tried.kind {
            ParamKind::String => ("string", "\"\""),
            ParamKind::Int => ("int", "0"),
            ParamKind::Color => ("color", "0"),
            ParamKind::Vector => ("vector", "0"),
            ParamKind::Normal => ("normal", "0"),
            ParamKind::Closure => ("closure color", "0"),
            ParamKind::Float => ("float", "0"),
        };
        format!("{ty} {} = {value}", parameter(tried.name))
    };
    let is_tried = |param: &ParamSpec| tried.iter().any(|t| t.name == param.name);
    let nested = spec.params.iter().filter(|param| param.kind == ParamKind::Closure).count();
    let mut tops = nested.saturating_sub(1);
    let mut untried = |kind: ParamKind| match kind {
        ParamKind::Normal => "N".to_owned(),
        ParamKind::Vector => "dPdu".to_owned(),
        ParamKind::Color => "color(1)".to_owned(),
        ParamKind::Float => format!("{USUAL}"),
        ParamKind::Int => "0".to_owned(),
        ParamKind::String => "\"\"".to_owned(),
        ParamKind::Closure if tops > 0 => {
            tops -= 1;
            // Without softening, which is not reciprocal, so that what is seen is the layer's own doing.
            "sheen_bsdf(N, color(1), 0.3, \"softening\", 0)".to_owned()
        }
        ParamKind::Closure => "diffuse(N)".to_owned(),
    };
    let value = |param: &ParamSpec| if is_tried(param) { parameter(param.name) } else { untried(param.kind) };
    let mut arguments: Vec<String> = spec.params.iter().map(value).collect();
    for keyword in spec.keywords.iter().filter(|keyword| is_tried(keyword)) {
        arguments.push(format!("{:?}, {}", keyword.name, parameter(keyword.name)));
    }
    let declared: Vec<String> = tried.iter().map(declare).collect();
    format!("surface verified({}) {{ Ci = {}({}); }}", declared.join(", "), spec.name, arguments.join(", "))
}

/// The choices of values: the usual ones, and around them one parameter at a time, for each combination of words.
fn variants(tried: &[Tried], thorough: bool) -> Vec<Vec<usize>> {
    let words: Vec<usize> = (0..tried.len()).filter(|&k| matches!(tried[k].values, Values::Words(_))).collect();
    let numbers: Vec<usize> = (0..tried.len()).filter(|k| !words.contains(k)).collect();
    let centre = vec![0; tried.len()];
    let mut combinations = vec![centre.clone()];
    if words.iter().map(|&k| tried[k].len()).product::<usize>() <= MOST_COMBINATIONS {
        for &k in &words {
            let with = |v: usize| move |c: &Vec<usize>| replaced(c, k, v);
            combinations =
                (0..tried[k].len()).flat_map(|v| combinations.iter().map(with(v)).collect::<Vec<_>>()).collect();
        }
    } else {
        combinations.extend(
            words.iter().flat_map(|&k| (1..tried[k].len()).map(move |v| (k, v))).map(|(k, v)| replaced(&centre, k, v)),
        );
    }
    let mut out = Vec::new();
    for combination in combinations {
        // In haste only the first number, which is a width as a rule, is tried with every word.
        let swept = if thorough || combination == centre { numbers.len() } else { numbers.len().min(1) };
        let changes = numbers[..swept].iter().flat_map(|&k| (1..tried[k].len()).map(move |v| (k, v)));
        let around: Vec<Vec<usize>> = changes.map(|(k, v)| replaced(&combination, k, v)).collect();
        out.push(combination);
        out.extend(around);
    }
    out
}

fn replaced(values: &[usize], at: usize, value: usize) -> Vec<usize> {
    let mut out = values.to_vec();
    out[at] = value;
    out
}
