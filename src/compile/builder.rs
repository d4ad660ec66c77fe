//! Building a group: layers, parameters, connections.

use super::error::{GroupError, GroupProblem, GroupSubject};
use super::fit::{allows_connection, checked_binding, checked_type, connects, find_type, param_error};
use super::shader::Shader;
use crate::closure::Library;
use crate::exec::{Group, Locate, ReportPlace};
use crate::ir::lower::{Binding, Layer, Lazy, LowerOptions, SPANS_PER_LAYER, lower};
use crate::lang::types::{Base, Length, Type};
use crate::ops::working_space::WorkingSpace;
use crate::optimize::{OptimizeOptions, optimize};
use std::sync::Arc;
use velour_grammar::{Sources, Span};

/// Collects layers, parameters and connections, and makes a group of them.
#[derive(Clone, Debug)]
pub struct GroupBuilder {
    closures: Arc<Library>,
    name: String,
    layers: Vec<Layer>,
    sources: Vec<Sources>,
    lower: LowerOptions,
    optimize: OptimizeOptions,
    error: Option<GroupError>,
}

impl GroupBuilder {
    /// An empty group.
    pub fn new(closures: Arc<Library>) -> Self {
        GroupBuilder {
            closures,
            name: String::new(),
            layers: Vec::new(),
            sources: Vec::new(),
            lower: LowerOptions {
                simplify: true,
                outputs: false,
                position: false,
                lazy: Lazy::default(),
                userdata_connects: false,
                watch: false,
                working_space: WorkingSpace::Rec709,
            },
            optimize: OptimizeOptions::default(),
            error: None,
        }
    }

    /// Gives the group a name, which shaders may ask for.
    pub fn group_name(mut self, name: &str) -> Self {
        self.name = name.to_owned();
        self
    }

    /// Adds a layer after the others.
    pub fn layer(mut self, name: &str, shader: &Shader) -> Self {
        let (shader, sources) = (shader.typed.clone(), shader.sources.clone());
        self.layers.push(Layer { name: name.to_owned(), shader, bindings: Vec::new(), interpolated: Vec::new() });
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

    /// Sets a parameter of the last layer from a value that was written with a type; an int may stand for a float.
    pub fn bind_as(mut self, name: &str, binding: Binding, written: &Type) -> Self {
        if let Some(Err(error)) = self.layers.last().map(|layer| checked_type(layer, name, written)) {
            self.error.get_or_insert(error);
        }
        self.bind(name, binding)
    }

    /// Sets a parameter of the last layer from text: numbers with commas or spaces between, or a string as it is. One number is enough
    /// for a color, point, vector or normal of three equal ones.
    pub fn text(self, name: &str, text: &str) -> Self {
        let ty = self.layers.last().and_then(|layer| find_type(layer, name).ok());
        let string = ty.as_ref().is_some_and(|ty| ty.element_type().base() == Some(Base::String));
        let triple =
            ty.is_some_and(|ty| ty.length == Length::Single && ty.base().is_some_and(|base| base.components() == 3));
        let parts = text.split([',', ' ']).filter(|part| !part.is_empty());
        let numbers: Result<Vec<f64>, _> = parts.map(str::parse).collect();
        match numbers {
            Ok(numbers) if numbers.len() == 1 && triple => self.bind(name, Binding::Numbers(numbers.repeat(3))),
            Ok(numbers) if !numbers.is_empty() && !string => self.bind(name, Binding::Numbers(numbers)),
            _ => self.bind(name, Binding::Strings(vec![text.to_owned()])),
        }
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
            problem: Box::new(GroupProblem::NoLayer { layer: name.to_owned() }),
            help: "declare the shader of a layer before connecting it".to_owned(),
            subject: GroupSubject::Layer(name.to_owned()),
        };
        let source = at(from.0).ok_or_else(|| missing(from.0))?;
        let target = at(to.0).ok_or_else(|| missing(to.0))?;
        if source >= target {
            return Err(GroupError {
                problem: Box::new(GroupProblem::LayerOrder { source: from.0.to_owned(), target: to.0.to_owned() }),
                help: "declare the layer that is read first".to_owned(),
                subject: GroupSubject::Layer(from.0.to_owned()),
            });
        }
        let (given, wanted) = (find_type(&self.layers[source], from.1)?, find_type(&self.layers[target], to.1)?);
        if !connects(&given, &wanted) {
            let problem = GroupProblem::CannotFeed { path: to.1.to_owned(), wanted, given };
            return Err(param_error(&self.layers[target], to.1, problem));
        }
        if !allows_connection(&self.layers[target], to.1) {
            let problem = GroupProblem::NotConnectable { path: to.1.to_owned() };
            return Err(param_error(&self.layers[target], to.1, problem));
        }
        self.layers[target].bindings.push((to.1.to_owned(), Binding::Connection(source, from.1.to_owned())));
        Ok(())
    }

    /// Says which layers wait until somebody reads what they put out; by default all but the last.
    pub fn lazy(mut self, lazy: Lazy) -> Self {
        self.lower.lazy = lazy;
        self
    }

    /// Reports what shaders assign and is no finite number, which costs a look at every assignment.
    pub fn watched(mut self, watch: bool) -> Self {
        self.lower.watch = watch;
        self
    }

    /// Says what RGB means to the shaders; by default Rec. 709.
    pub fn working_space(mut self, space: WorkingSpace) -> Self {
        self.lower.working_space = space;
        self
    }

    /// Lets `isconnected` count parameters that userdata may fill.
    pub fn userdata_connects(mut self) -> Self {
        self.lower.userdata_connects = true;
        self
    }

    /// Keeps the output parameters of all layers as results.
    pub fn keep_outputs(mut self) -> Self {
        self.lower.outputs = true;
        self
    }

    /// Keeps `P`, where shaders assign it, as a result of that name: what displacement is.
    pub fn keep_position(mut self) -> Self {
        self.lower.position = true;
        self
    }

    /// Lets userdata of its name go before the value of a parameter of the last layer, or not, whatever its shader says.
    pub fn interpolate(mut self, name: &str, interpolated: bool) -> Self {
        if let Some(layer) = self.layers.last_mut() {
            layer.interpolated.push((name.to_owned(), interpolated));
        }
        self
    }

    /// Compiles without folding, dead-code removal, uniform values and fused operations. For tests and comparisons.
    pub fn unoptimized(mut self) -> Self {
        self.lower.simplify = false;
        self.optimize = OptimizeOptions { dead_code: false, uniform: false, fuse: false };
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
        let program = optimize(lower(&self.layers, &self.name, self.lower), self.closures.table(), self.optimize);
        let last = self.layers.last().map_or(String::new(), |layer| layer.name.clone());
        let names = self.layers.iter().map(|layer| (layer.shader.name.clone(), layer.name.clone())).collect();
        Group::new(program, self.closures, locator(self.sources, names)).map_err(|error| GroupError {
            problem: Box::new(GroupProblem::CannotRun { error }),
            help: "this is a limit of the machine, or a mistake of the compiler that should be reported".to_owned(),
            subject: GroupSubject::Layer(last),
        })
    }
}

impl Shader {
    /// A group of this shader alone.
    pub fn group(&self) -> GroupBuilder {
        GroupBuilder::new(self.closures.clone()).layer(self.name(), self)
    }
}

/// Finds the place of a span of the group, with the names of its shader and its layer.
fn locator(sources: Vec<Sources>, names: Vec<(String, String)>) -> Locate {
    Arc::new(move |span: Span| {
        let (layer, first) = ((span.first / SPANS_PER_LAYER) as usize, span.first % SPANS_PER_LAYER);
        let (shader, layer_name) = names.get(layer).cloned().unwrap_or_default();
        let place = sources.get(layer).and_then(|s| s.locate(Span { first, last: first }));
        let (file, line, column) = place.map_or(("shader".to_owned(), 0, 0), |p| (p.file, p.line, p.column));
        let word = sources.get(layer).map_or(String::new(), |s| s.text(Span { first, last: first }));
        ReportPlace { shader, layer: layer_name, layer_number: layer, file, line, column, word }
    })
}
