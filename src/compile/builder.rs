//! Building a group: layers, parameters, connections.

use super::Shader;
use super::error::{GroupError, GroupSubject};
use crate::exec::{Group, Locate};
use crate::ir::lower::value::SPANS_PER_LAYER;
use crate::ir::lower::{Binding, Layer, LowerOptions, lower};
use crate::lang::closures::ClosureTable;
use crate::lang::types::{Base, Length, Type};
use crate::optimize::{OptimizeOptions, optimize};
use std::sync::Arc;
use velour_grammar::{Sources, Span};

/// Collects layers, parameters and connections, and makes a group of them.
#[derive(Clone, Debug)]
pub struct GroupBuilder {
    closures: Arc<ClosureTable>,
    layers: Vec<Layer>,
    sources: Vec<Sources>,
    lower: LowerOptions,
    optimize: OptimizeOptions,
    error: Option<GroupError>,
}

impl GroupBuilder {
    /// An empty group.
    pub fn new(closures: Arc<ClosureTable>) -> Self {
        GroupBuilder {
            closures,
            layers: Vec::new(),
            sources: Vec::new(),
            lower: LowerOptions { simplify: true, outputs: false },
            optimize: OptimizeOptions::default(),
            error: None,
        }
    }

    /// Adds a layer after the others.
    pub fn layer(mut self, name: &str, shader: &Shader) -> Self {
        let (shader, sources) = (shader.typed.clone(), shader.sources.clone());
        self.layers.push(Layer { name: name.to_owned(), shader, bindings: Vec::new() });
        self.sources.push(sources);
        self
    }

    /// Sets numbers of a parameter of the last layer: one for a float or int, three for a triple, and so on.
    pub fn param(self, name: &str, numbers: &[f64]) -> Self {
        self.bind(name, Binding::Numbers(numbers.to_vec()))
    }

    /// Sets strings of a parameter of the last layer.
    pub fn strings(self, name: &str, strings: &[&str]) -> Self {
        self.bind(name, Binding::Strings(strings.iter().map(|&s| s.to_owned()).collect()))
    }

    /// Sets a parameter of the last layer, `name` or a part of it such as `name.field` or `name[2]`.
    pub fn bind(mut self, name: &str, binding: Binding) -> Self {
        let Some(layer) = self.layers.last() else { return self };
        if let Err(error) = checked_binding(layer, name, &binding) {
            self.error.get_or_insert(error);
        } else if let Some(layer) = self.layers.last_mut() {
            layer.bindings.push((name.to_owned(), binding));
        }
        self
    }

    /// Connects an output of an earlier layer to a parameter of a later one.
    pub fn connect(mut self, from: (&str, &str), to: (&str, &str)) -> Self {
        if let Err(error) = self.try_connect(from, to) {
            self.error.get_or_insert(error);
        }
        self
    }

    fn try_connect(&mut self, from: (&str, &str), to: (&str, &str)) -> Result<(), GroupError> {
        let at = |name: &str| self.layers.iter().position(|layer| layer.name == name);
        let missing = |name: &str| GroupError {
            message: format!("there is no layer `{name}`"),
            help: "declare the shader of a layer before connecting it".to_owned(),
            subject: GroupSubject::Layer(name.to_owned()),
        };
        let source = at(from.0).ok_or_else(|| missing(from.0))?;
        let target = at(to.0).ok_or_else(|| missing(to.0))?;
        if source >= target {
            return Err(GroupError {
                message: format!("layer `{}` does not come before layer `{}`", from.0, to.0),
                help: "declare the layer that is read first".to_owned(),
                subject: GroupSubject::Layer(from.0.to_owned()),
            });
        }
        let (given, wanted) = (find_type(&self.layers[source], from.1)?, find_type(&self.layers[target], to.1)?);
        if !connects(&given, &wanted) {
            return Err(param_error(
                &self.layers[target],
                to.1,
                format!("a {given} cannot feed the {wanted} `{}`", to.1),
            ));
        }
        self.layers[target].bindings.push((to.1.to_owned(), Binding::Connection(source, from.1.to_owned())));
        Ok(())
    }

    /// Keeps the output parameters of all layers as results.
    pub fn keep_outputs(mut self) -> Self {
        self.lower.outputs = true;
        self
    }

    /// Compiles without folding, dead-code removal and uniform values. For tests and comparisons.
    pub fn unoptimized(mut self) -> Self {
        self.lower.simplify = false;
        self.optimize = OptimizeOptions { dead_code: false, uniform: false };
        self
    }

    /// The group.
    ///
    /// # Errors
    /// The first parameter or connection that does not fit.
    pub fn build(self) -> Result<Group, GroupError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        let program = optimize(lower(&self.layers, self.lower), self.optimize);
        crate::ir::verify::debug_verify(&program);
        Ok(Group::new(program, self.closures, locator(self.sources)))
    }
}

/// Turns a span of the group into `file:line:column`.
fn locator(sources: Vec<Sources>) -> Locate {
    Arc::new(move |span: Span| {
        let (layer, first) = (span.first / SPANS_PER_LAYER, span.first % SPANS_PER_LAYER);
        let place = sources.get(layer as usize).and_then(|s| s.locate(Span { first, last: first }));
        place.map_or("shader".to_owned(), |p| format!("{}:{}:{}", p.file, p.line, p.column))
    })
}

fn param_error(layer: &Layer, name: &str, message: String) -> GroupError {
    let shader = &layer.shader;
    let names: Vec<&str> = shader.params.iter().map(|p| shader.variables[p.var.0 as usize].name.as_str()).collect();
    let help = if names.is_empty() {
        "the shader has no parameters".to_owned()
    } else {
        format!("its parameters are {}", names.join(", "))
    };
    let subject = GroupSubject::Param { layer: layer.name.clone(), name: name.to_owned() };
    GroupError { message, help, subject }
}

/// The type of a parameter or of the part of it that a path names.
fn find_type(layer: &Layer, path: &str) -> Result<Type, GroupError> {
    let end = path.find(['.', '[']).unwrap_or(path.len());
    let variables = &layer.shader.variables;
    let found = layer.shader.params.iter().map(|p| &variables[p.var.0 as usize]).find(|v| v.name == path[..end]);
    let no_such = || param_error(layer, path, format!("shader `{}` has no parameter `{path}`", layer.shader.name));
    let found = found.ok_or_else(no_such)?;
    let mut ty = found.ty.clone();
    let open = layer.shader.params.iter().any(|p| p.open && variables[p.var.0 as usize].name == path);
    if open {
        ty.length = Length::Unsized;
    }
    for step in path[end..].split_inclusive([']', '.']).flat_map(|s| s.split('.')).filter(|s| !s.is_empty()) {
        ty = match step.strip_prefix('[') {
            Some(_) if ty.is_array() => ty.element_type(),
            Some(_) if ty.base().is_some_and(Base::is_triple) => Type::FLOAT,
            Some(_) => return Err(no_such()),
            None => {
                let name = step.split('[').next().unwrap_or(step);
                let field = ty.structure().and_then(|s| s.fields.iter().find(|(field, _)| field == name));
                let mut field = field.ok_or_else(no_such)?.1.clone();
                if step.contains('[') {
                    field = field.element_type();
                }
                field
            }
        };
    }
    Ok(ty)
}

fn checked_binding(layer: &Layer, name: &str, binding: &Binding) -> Result<(), GroupError> {
    let ty = find_type(layer, name)?;
    let text = ty.element_type().base() == Some(Base::String);
    let structure = ty.structure().is_some();
    let fits = match binding {
        Binding::Numbers(_) => !text && ty.element_type().base() != Some(Base::Closure),
        Binding::Strings(_) => text || structure,
        Binding::Connection(..) => true,
    };
    if fits {
        return Ok(());
    }
    let given = if matches!(binding, Binding::Numbers(_)) { "numbers" } else { "a string" };
    Err(param_error(layer, name, format!("parameter `{name}` is a {ty}, not {given}")))
}

/// May an output of one type feed a parameter of another?
fn connects(from: &Type, to: &Type) -> bool {
    if from == to || (from.element == to.element && from.is_array() && to.length == Length::Unsized) {
        return true;
    }
    let numeric = |base: Base| base.is_number() || base.is_triple();
    match (from.base(), to.base()) {
        (Some(Base::Closure), Some(Base::Closure)) | (Some(Base::String), Some(Base::String)) => true,
        (Some(a), Some(b)) => numeric(a) && numeric(b),
        _ => false,
    }
}
