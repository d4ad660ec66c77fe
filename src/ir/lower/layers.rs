//! The order in which the layers of a group run, and what they hand to each other.
//!
//! As in OSL, the last layer runs, and an earlier one when a parameter that it feeds is first read, or never; and the globals that a
//! shader assigns stay assigned for those that run after it.
//!
//! Decision (2026-11-29): a layer whose parameter is first read where lanes may have parted (in a branch or a loop) runs before the statement
//! of the body that does so (before the layer that reads it, where that may `return`, or reads it in a function), unless that is the only
//! place that reads anything of it, because its code stands in the program once and its values are those of all lanes; instead of once a
//! place that reads it, guarded, whose code grows with the places and, in chains of layers, with their powers. What is seen of it is that
//! a layer prints whose branch no lane takes.

use super::assigned::{Assigned, Effects};
use super::shared::Shared;
use super::spec::{Binding, Layer, LowerOptions};
use super::state::{Bound, Frame, Lower};
use super::value::Value;
use crate::check::typed::{Argument, Expr, ExprKind, Place, Shader, ShaderParam, Stmt, VarId};
use crate::ir::build::Builder;
use crate::ir::program::{Const, Node, Output, OutputValue, Program, Reg};
use crate::lang::globals::Global;
use crate::lang::path::root;
use crate::lang::types::{Base, Type};
use std::rc::Rc;
use velour_grammar::ast::BinaryOp;

/// Writes the layers of a group into one program. Bindings have been checked against the shaders' parameters.
pub fn lower(layers: &[Layer], group_name: &str, options: LowerOptions) -> Program {
    let mut builder = Builder::new(options.simplify);
    let none = builder.constant(Const::NoClosure);
    let mut shared = Shared {
        layers,
        group_name: group_name.to_owned(),
        options,
        finished: vec![None; layers.len()],
        ..Shared::default()
    };
    let last = layers.len().saturating_sub(1);
    for number in 0..layers.len() {
        if (number == last || runs_in_turn(layers, number, options)) && shared.finished[number].is_none() {
            (builder, shared) = run_layer(builder, shared, number);
        }
    }
    let ci = shared.globals.iter().find(|(global, _)| *global == Global::Ci);
    let result = match ci {
        Some((_, Value::Regs(regs))) => regs[0],
        _ => shared.only_closure(last).unwrap_or(none),
    };
    let p = shared.globals.iter().find(|(global, _)| options.position && *global == Global::P);
    if let (Some((_, Value::Regs(regs))), Some(layer)) = (p, layers.last()) {
        let (layer, value) = (layer.name.clone(), OutputValue::Regs(regs.clone()));
        shared.outputs.push(Output { layer, name: "P".to_owned(), ty: Type::of(Base::Point), value });
    }
    let mut program = builder.finish();
    program.result = Some(result);
    program.outputs = shared.outputs;
    program.working_space = options.working_space;
    program
}

impl Shared<'_> {
    /// The closure that a layer puts out, where it is one alone: what a shader means that says nothing of `Ci`, as those of Blender's nodes
    /// do not.
    fn only_closure(&self, number: usize) -> Option<Reg> {
        let params = self.finished.get(number)?.as_ref()?;
        let shader = &self.layers[number].shader;
        let outputs = shader.params.iter().filter(|param| param.output);
        let names = outputs.map(|param| &shader.variables[param.var.0 as usize].name);
        let mut closures = names.filter_map(|name| params.get(name.as_str())).filter(|(_, ty)| *ty == Type::CLOSURE);
        match (closures.next(), closures.next()) {
            (Some((Value::Regs(regs), _)), None) => regs.first().copied(),
            _ => None,
        }
    }
}

/// Does a layer run whether or not another one reads what it puts out?
fn runs_in_turn(layers: &[Layer], number: usize, options: LowerOptions) -> bool {
    let (shader, lazy) = (&layers[number].shader, options.lazy);
    let kept = options.outputs && shader.params.iter().any(|param| param.output);
    let feeds = || layers.iter().flat_map(sources_of).any(|source| source == number);
    kept || !lazy.layers
        || (!lazy.globals && assigns_globals(shader))
        || (!lazy.unconnected && !feeds())
        || (!lazy.traces && body_effects(shader).traces)
        || (!lazy.errors && body_effects(shader).errors)
}

/// The layers that feed one, each as often as it does.
fn sources_of(layer: &Layer) -> impl Iterator<Item = usize> + '_ {
    layer.bindings.iter().filter_map(|(_, binding)| match binding {
        Binding::Connection(from, _) => Some(*from),
        Binding::Numbers(_) | Binding::Strings(_) => None,
    })
}

fn assigns_globals(shader: &Shader) -> bool {
    body_effects(shader).vars.iter().any(|var| shader.variables[var.0 as usize].global.is_some())
}

fn body_effects(shader: &Shader) -> Effects {
    Assigned::default().of_stmts(shader, &shader.body)
}

/// Appends a layer, and before it those that it needs and that cannot wait.
fn run_layer<'a>(builder: Builder, shared: Shared<'a>, number: usize) -> (Builder, Shared<'a>) {
    let layer = &shared.layers[number];
    let read = read_params(shared.layers, number, shared.options.outputs);
    let mut lower = Lower::new(builder, &layer.shader, number as u32, read);
    lower.shared = shared;
    lower.at(layer.shader.span);
    lower.take_globals();
    lower.layer(layer);
    lower.hand_on_globals();
    let params = lower.final_params();
    if lower.shared.options.outputs {
        let mut outputs = std::mem::take(&mut lower.shared.outputs);
        lower.list_outputs(layer, &params, &mut outputs);
        lower.shared.outputs = outputs;
    }
    lower.shared.finished[number] = Some(Rc::new(params));
    (lower.b, lower.shared)
}

impl<'a> Lower<'a> {
    fn layer(&mut self, layer: &'a Layer) {
        let effects = self.assigned.of_stmts(self.shader, &self.shader.body);
        let parts = effects.returns || effects.exits;
        for param in &self.shader.params {
            self.feed(param, layer, parts);
        }
        for param in &self.shader.params {
            if !self.waiting.contains(&param.var) {
                self.parameter(param, layer);
            }
        }
        if !parts {
            self.frames.push(Frame { scope: None, result: None });
            for stmt in &self.shader.body {
                self.pull_before(stmt);
                self.stmts(std::slice::from_ref(stmt));
            }
        } else {
            let scope = self.b.scope();
            self.exit = Some(scope);
            self.frames.push(Frame { scope: Some(scope), result: None });
            self.region(effects.vars, |l| {
                l.b.open();
                l.stmts(&l.shader.body);
                let block = l.b.close();
                l.b.push(Node::Scope(scope, block));
            });
        }
    }

    /// Runs the layers that feed a parameter, or lets it wait for the first time that it is read.
    fn feed(&mut self, param: &ShaderParam, layer: &'a Layer, parts: bool) {
        let name = &self.shader.variables[param.var.0 as usize].name;
        let fed: Vec<(&String, usize)> = layer
            .bindings
            .iter()
            .filter(|(target, _)| root(target) == name.as_str())
            .filter_map(|(target, binding)| match binding {
                Binding::Connection(from, _) => Some((target, *from)),
                Binding::Numbers(_) | Binding::Strings(_) => None,
            })
            .collect();
        if fed.is_empty() {
            return;
        }
        self.connected.push(param.var);
        let whole = fed.iter().all(|(target, _)| *target == name);
        let first = self.first_use(param.var);
        let alone = || fed.len() == 1 && self.read_once(param.var) && self.feeds_only_this(fed[0].1);
        let together = first == Use::Parted && !parts && !self.in_function(param.var) && !alone();
        let waits = match first {
            Use::Together => !parts,
            Use::Parted => together || alone(),
            // Nobody reads it, so what feeds it need not run.
            Use::None => true,
        };
        if waits && !param.open && whole {
            self.waiting.push(param.var);
            self.together.extend(together.then_some(param.var));
            return;
        }
        fed.into_iter().for_each(|(_, from)| self.run_before(from));
    }

    /// Gives the parameters their values that a statement reads where lanes have parted.
    fn pull_before(&mut self, stmt: &Stmt) {
        let read = |var: &VarId| use_of(stmt, *var) == Use::Parted;
        let together: Vec<VarId> = self.together.iter().copied().filter(read).collect();
        together.into_iter().for_each(|var| self.pull(var));
    }

    /// Runs a layer, if it has not run.
    fn run_before(&mut self, number: usize) {
        if self.shared.finished.get(number).is_none_or(Option::is_some) {
            return;
        }
        self.hand_on_globals();
        let (b, shared) = (std::mem::replace(&mut self.b, Builder::new(false)), std::mem::take(&mut self.shared));
        let (b, shared) = run_layer(b, shared, number);
        (self.b, self.shared) = (b, shared);
        self.take_globals();
    }

    /// Gives a parameter that was waiting its value: the layer that feeds it runs now.
    pub(super) fn pull(&mut self, var: VarId) {
        let Some(at) = self.waiting.iter().position(|known| *known == var) else { return };
        self.waiting.swap_remove(at);
        let shader = self.shader;
        let layer = &self.shared.layers[self.layer as usize];
        let name = &shader.variables[var.0 as usize].name;
        let fed = layer.bindings.iter().rev().find(|(target, _)| target == name);
        if let Some((_, Binding::Connection(from, _))) = fed {
            self.run_before(*from);
        }
        if let Some(param) = shader.params.iter().find(|param| param.var == var) {
            self.parameter(param, layer);
        }
    }

    /// Begins with the globals as the layers before have left them.
    fn take_globals(&mut self) {
        for (global, value) in self.shared.globals.clone() {
            let var = self.global_var(global);
            self.vars[var.0 as usize] = Some(Bound { value, level: 0 });
        }
    }

    /// Leaves the globals to the layers that follow.
    fn hand_on_globals(&mut self) {
        for at in 0..self.shader.variables.len() {
            let Some(global) = self.shader.variables[at].global else { continue };
            if let Some(bound) = self.vars[at].clone() {
                let value = self.stable(&bound.value);
                self.shared.globals.retain(|(known, _)| *known != global);
                self.shared.globals.push((global, value));
            }
        }
    }

    /// Where a parameter is first read: by a statement of the body, or in a function, of which it is not known where it is called.
    fn first_use(&self, var: VarId) -> Use {
        if self.in_function(var) { Use::Parted } else { first_use(&self.shader.body, var) }
    }

    fn in_function(&self, var: VarId) -> bool {
        self.shader.functions.iter().any(|function| first_use(&function.body, var) != Use::None)
    }

    /// Is a parameter read in one place alone, which is in no loop, and not by those who follow? Then it may get its value there, though
    /// only some lanes are there.
    fn read_once(&self, var: VarId) -> bool {
        !self.in_function(var) && !self.read.contains(&var) && mentions(&self.shader.body, var) == Some(1)
    }

    /// Does all that a layer, and those before it, put out go to one parameter of this one, and do they leave globals alone?
    fn feeds_only_this(&self, number: usize) -> bool {
        let layers = self.shared.layers;
        let mut set = vec![number];
        let mut at = 0;
        while at < set.len() {
            let sources: Vec<usize> = sources_of(&layers[set[at]]).filter(|source| !set.contains(source)).collect();
            set.extend(sources);
            set.dedup();
            at += 1;
        }
        let outgoing = |to: &Layer| sources_of(to).filter(|source| set.contains(source)).count();
        let outside = layers.iter().enumerate().filter(|(number, _)| !set.contains(number));
        let once = outside.map(|(_, layer)| outgoing(layer)).sum::<usize>() == 1;
        let fresh = set.iter().all(|&number| self.shared.finished[number].is_none());
        once && fresh && !set.iter().any(|&number| assigns_globals(&layers[number].shader))
    }
}

/// Where a variable is first mentioned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Use {
    /// Nowhere.
    None,
    /// In a statement that all lanes run together.
    Together,
    /// In a branch, a loop, or a part of an expression that may be left out.
    Parted,
}

fn first_use(stmts: &[Stmt], var: VarId) -> Use {
    stmts.iter().map(|stmt| use_of(stmt, var)).find(|found| *found != Use::None).unwrap_or(Use::None)
}

fn use_of(stmt: &Stmt, var: VarId) -> Use {
    let parted = |found: bool| if found { Use::Parted } else { Use::None };
    let inside = |stmts: &[Stmt]| parted(first_use(stmts, var) != Use::None);
    let first = |uses: &[Use]| uses.iter().copied().find(|found| *found != Use::None).unwrap_or(Use::None);
    match stmt {
        Stmt::Expr(expr) | Stmt::Declare(_, Some(expr)) | Stmt::Return(Some(expr)) => use_in(expr, var),
        Stmt::Declare(_, None) | Stmt::Return(None) | Stmt::Break | Stmt::Continue => Use::None,
        Stmt::Block(body) => first_use(body, var),
        Stmt::If(condition, yes, no) => first(&[use_in(condition, var), inside(yes), inside(no)]),
        Stmt::Loop { init, condition, step, body, .. } => {
            let conditions = condition.iter().chain(step).any(|expr| use_in(expr, var) != Use::None);
            first(&[first_use(init, var), parted(conditions), inside(body)])
        }
    }
}

fn use_in(expr: &Expr, var: VarId) -> Use {
    // As deep as the expression: the stack grows where parts are taken, and here where they are not.
    stacker::maybe_grow(64 << 10, 1 << 20, || use_of_expr(expr, var))
}

fn use_of_expr(expr: &Expr, var: VarId) -> Use {
    use ExprKind::*;
    let parted = |found: Use| if found == Use::None { Use::None } else { Use::Parted };
    let then = |found: Use, next: &dyn Fn() -> Use| if found == Use::None { next() } else { found };
    match &expr.kind {
        Var(own) if *own == var => Use::Together,
        // The right side may be left out.
        Binary(BinaryOp::And | BinaryOp::Or, a, b) => then(use_in(a, var), &|| parted(use_in(b, var))),
        Ternary(a, b, c) => then(use_in(a, var), &|| parted(then(use_in(b, var), &|| use_in(c, var)))),
        Assign(place, _) | Update(_, place, _) | Step { place, .. } if place.var == var => Use::Together,
        Call(_, args) | Builtin(_, args) => {
            // A function works on the variable itself, maybe in a branch of its own.
            let call = matches!(expr.kind, Call(..));
            let of = |arg: &Argument| match arg {
                Argument::In(expr) => use_in(expr, var),
                Argument::Out(place) if call => parted(use_in_place(place, var)),
                Argument::Out(place) => use_in_place(place, var),
            };
            args.iter().map(of).find(|found| *found != Use::None).unwrap_or(Use::None)
        }
        _ => {
            let mut found = Use::None;
            expr.parts(&mut |part| found = then(found, &|| use_in(part, var)));
            found
        }
    }
}

/// How often statements mention a variable; nothing where a loop does.
fn mentions(stmts: &[Stmt], var: VarId) -> Option<usize> {
    let mut sum = 0;
    for stmt in stmts {
        sum += match stmt {
            Stmt::Block(body) => mentions(body, var)?,
            Stmt::If(condition, yes, no) => count_in(condition, var) + mentions(yes, var)? + mentions(no, var)?,
            Stmt::Loop { .. } if use_of(stmt, var) != Use::None => return None,
            Stmt::Expr(expr) | Stmt::Declare(_, Some(expr)) | Stmt::Return(Some(expr)) => count_in(expr, var),
            Stmt::Loop { .. } | Stmt::Declare(_, None) | Stmt::Return(None) | Stmt::Break | Stmt::Continue => 0,
        };
    }
    Some(sum)
}

/// At most how often an expression mentions a variable: an expression that does so more than once counts as two.
fn count_in(expr: &Expr, var: VarId) -> usize {
    match use_in(expr, var) {
        Use::None => 0,
        // A variable by itself, converted, or as one argument of a call that prints, which is how conditions are mostly used.
        _ => match &expr.kind {
            ExprKind::Var(_) => 1,
            ExprKind::Convert(inner) | ExprKind::Unary(_, inner) => count_in(inner, var),
            ExprKind::Assign(place, value) if use_in_place(place, var) == Use::None => count_in(value, var),
            ExprKind::Builtin(_, args) => {
                let of = |arg: &Argument| arg.read().map_or(2, |expr| count_in(expr, var));
                args.iter().map(of).sum()
            }
            ExprKind::Binary(op, a, b) if !matches!(op, BinaryOp::And | BinaryOp::Or) => {
                count_in(a, var) + count_in(b, var)
            }
            _ => 2,
        },
    }
}

fn use_in_place(place: &Place, var: VarId) -> Use {
    let mut found = if place.var == var { Use::Together } else { Use::None };
    place.indices(&mut |index| {
        if found == Use::None {
            found = use_in(index, var);
        }
    });
    found
}

/// The parameters of a layer that somebody reads: later layers, or the host when outputs are kept.
fn read_params(layers: &[Layer], number: usize, kept: bool) -> Vec<VarId> {
    let shader = &layers[number].shader;
    let named = |param: &ShaderParam| &shader.variables[param.var.0 as usize].name;
    let reads = |name: &str| {
        let mut bindings = layers[number + 1..].iter().flat_map(|layer| &layer.bindings);
        bindings.any(|(_, b)| matches!(b, Binding::Connection(from, path) if *from == number && root(path) == name))
    };
    let last = number + 1 == layers.len();
    let seen = |param: &&ShaderParam| reads(named(param)) || (kept && last && param.output);
    shader.params.iter().filter(seen).map(|param| param.var).collect()
}
