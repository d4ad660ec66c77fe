//! The checker's state: scopes, variables, functions, and the messages so far.

use super::notes::{Meaning, NotedFunction, Notes, Use};
use super::typed::{Function, FunctionId, Shader, Stmt, VarId, Variable};
use crate::lang::closures::ClosureTable;
use crate::lang::globals::GLOBALS;
use crate::lang::types::{Struct, Type};
use crate::limits::EXPANDED;
use std::collections::HashSet;
use std::sync::Arc;
use velour_grammar::names::{Name, NameMap};
use velour_grammar::{Diagnostic, Diagnostics, Span};

/// What a name means in a scope.
#[derive(Clone)]
pub(super) enum Symbol {
    Var(VarId),
    Functions(Vec<FunctionId>),
    Struct(Arc<Struct>),
}

/// The head of a function, known before its body is.
pub(super) struct Signature {
    pub name: String,
    pub returns: Type,
    pub formals: Vec<(Type, bool)>,
    pub span: Span,
    /// How much text the body is, in tokens.
    pub size: u64,
    /// Called functions and where, to find recursion.
    pub calls: Vec<(FunctionId, Span)>,
}

/// The state of one run of the checker.
pub(super) struct Checker<'a> {
    pub closures: &'a ClosureTable,
    pub diagnostics: Diagnostics,
    pub scopes: Vec<NameMap<Name, Symbol>>,
    pub variables: Vec<Variable>,
    /// Whether each variable may be assigned.
    pub writable: Vec<bool>,
    /// Closures that a header says are builtin and velour does not have.
    pub foreign: HashSet<String>,
    /// Declarations of the statements being checked that belong before them.
    pub hoisted: Vec<Stmt>,
    pub signatures: Vec<Signature>,
    pub bodies: Vec<Option<Arc<Function>>>,
    /// What `return` gives here: `None` in a shader body.
    pub returns: Option<Type>,
    pub loops: u32,
    /// True while the default of a shader parameter is checked.
    pub in_params: bool,
    /// The function whose body is being checked.
    pub inside: Option<FunctionId>,
    /// Calls made by the shader body itself.
    pub shader_calls: Vec<(FunctionId, Span)>,
    /// What is noted of names, when somebody asks for it.
    pub notes: Option<Box<Notes>>,
}

impl<'a> Checker<'a> {
    pub fn new(closures: &'a ClosureTable) -> Self {
        let mut checker = Checker {
            closures,
            diagnostics: Diagnostics::default(),
            scopes: vec![NameMap::default()],
            variables: Vec::new(),
            writable: Vec::new(),
            foreign: HashSet::new(),
            hoisted: Vec::new(),
            signatures: Vec::new(),
            bodies: Vec::new(),
            returns: None,
            loops: 0,
            in_params: false,
            inside: None,
            shader_calls: Vec::new(),
            notes: None,
        };
        for &(name, global, base, writable) in GLOBALS {
            let id = VarId(checker.variables.len() as u32);
            let (ty, global) = (Type::of(base), Some(global));
            checker.variables.push(Variable { name: name.into(), ty, span: Span::NONE, global });
            checker.writable.push(writable);
            checker.scopes[0].insert(name.into(), Symbol::Var(id));
        }
        checker
    }

    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    pub fn error(&mut self, code: &'static str, span: Span, message: impl Into<String>, help: impl Into<String>) {
        self.report(Diagnostic::error(code, span, message).help(help));
    }

    /// The meaning of a name, innermost scope first.
    pub fn lookup(&self, name: &str) -> Option<&Symbol> {
        self.scopes.iter().rev().find_map(|scope| scope.get(name))
    }

    /// All functions of a name, innermost scope first.
    pub fn functions_named(&self, name: &str) -> Vec<FunctionId> {
        let mut found = Vec::new();
        for scope in self.scopes.iter().rev() {
            if let Some(Symbol::Functions(ids)) = scope.get(name) {
                found.extend(ids.iter().rev());
            }
        }
        found
    }

    /// Runs `body` in a scope of its own.
    pub fn scoped<T>(&mut self, body: impl FnOnce(&mut Self) -> T) -> T {
        self.scopes.push(NameMap::default());
        let result = body(self);
        self.scopes.pop();
        result
    }

    /// Makes a variable and binds its name in the innermost scope.
    pub fn bind(&mut self, name: &Name, ty: Type, span: Span, writable: bool) -> VarId {
        let id = VarId(self.variables.len() as u32);
        self.variables.push(Variable { name: name.clone(), ty, span, global: None });
        self.writable.push(writable);
        self.note(span, name, Meaning::Variable(id), true);
        let earlier = self.scopes.last_mut().and_then(|scope| scope.insert(name.clone(), Symbol::Var(id)));
        if let Some(Symbol::Var(earlier)) = earlier {
            let before = self.variables[earlier.0 as usize].span;
            let diagnostic = Diagnostic::error("E0404", span, format!("`{name}` is declared twice in this scope"));
            self.report(diagnostic.also(before, "declared here first").help("give one of them another name"));
        }
        id
    }

    /// Notes what a name stands for.
    pub fn note(&mut self, span: Span, name: &Name, meaning: Meaning, declares: bool) {
        if let Some(notes) = &mut self.notes {
            notes.uses.push(Use { span, name: name.clone(), meaning, declares });
        }
    }

    /// The notes, with all variables and functions there are.
    pub fn take_notes(&mut self) -> Notes {
        let mut notes = *self.notes.take().unwrap_or_default();
        notes.variables = self.variables.clone();
        notes.functions.resize_with(self.signatures.len(), NotedFunction::default);
        for (function, signature) in notes.functions.iter_mut().zip(&self.signatures) {
            (function.name, function.returns) = (signature.name.clone(), signature.returns.clone());
            function.formals = signature.formals.clone();
        }
        notes
    }

    /// Notes that the body being checked calls a function.
    pub fn note_call(&mut self, callee: FunctionId, span: Span) {
        match self.inside {
            Some(caller) => self.signatures[caller.0 as usize].calls.push((callee, span)),
            None => self.shader_calls.push((callee, span)),
        }
    }

    /// Last checks on the whole; gives the shader when nothing is wrong.
    pub fn finish(mut self, shader: Option<Shader>) -> (Option<Shader>, Diagnostics) {
        self.find_undefined_and_recursive();
        if let (Some(shader), false) = (&shader, self.diagnostics.has_errors()) {
            self.limit_expansion(shader.span);
        }
        if self.diagnostics.has_errors() {
            return (None, self.diagnostics);
        }
        let shader = shader.map(|mut shader| {
            shader.variables = std::mem::take(&mut self.variables);
            // A prototype that nothing calls has no body; an empty one keeps the indices.
            let empty = |sig: &Signature| {
                let (name, returns) = (sig.name.clone(), sig.returns.clone());
                Arc::new(Function { name, returns, params: Vec::new(), body: Vec::new() })
            };
            let pairs = self.bodies.iter().zip(&self.signatures);
            shader.functions = pairs.map(|(body, sig)| body.clone().unwrap_or_else(|| empty(sig))).collect();
            shader
        });
        (shader, self.diagnostics)
    }

    fn find_undefined_and_recursive(&mut self) {
        let mut state = vec![0u8; self.signatures.len()];
        for start in 0..self.signatures.len() {
            self.visit(start, &mut state);
        }
        for at in 0..self.shader_calls.len() {
            let (callee, span) = self.shader_calls[at];
            self.require_body(callee, span);
        }
    }

    /// Functions are expanded in place, so a few lines of calls within calls can grow without bound.
    fn limit_expansion(&mut self, span: Span) {
        let mut sizes: Vec<Option<u64>> = vec![None; self.signatures.len()];
        let mut open: Vec<usize> = (0..self.signatures.len()).collect();
        while let Some(&at) = open.last() {
            let signature = &self.signatures[at];
            let waiting = signature.calls.iter().map(|call| call.0.0 as usize).find(|&callee| sizes[callee].is_none());
            match waiting {
                Some(callee) => open.push(callee),
                None => {
                    let inner = signature.calls.iter().filter_map(|call| sizes[call.0.0 as usize]);
                    sizes[at] = Some(inner.fold(signature.size, u64::saturating_add));
                    open.pop();
                }
            }
        }
        let whole = self.shader_calls.iter().filter_map(|call| sizes[call.0.0 as usize]);
        if whole.fold(0, u64::saturating_add) > EXPANDED {
            let message =
                "the shader is too large: functions are expanded in place, and here they call each other too often";
            self.report(
                Diagnostic::error("E0415", span, message).help("call a function in a loop instead of many times"),
            );
        }
    }

    /// Depth-first walk over the calls of one function: 0 new, 1 on the way, 2 done. The depth is bounded by the
    /// number of functions a user nests by hand, and each keeps its own place on an explicit stack.
    fn visit(&mut self, start: usize, state: &mut [u8]) {
        let mut stack = vec![(start, 0)];
        while let Some((at, next)) = stack.pop() {
            if state[at] == 2 {
                continue;
            }
            state[at] = 1;
            let Some(&(callee, span)) = self.signatures[at].calls.get(next) else {
                state[at] = 2;
                continue;
            };
            stack.push((at, next + 1));
            self.require_body(callee, span);
            match state[callee.0 as usize] {
                0 => stack.push((callee.0 as usize, 0)),
                1 => {
                    let name = &self.signatures[callee.0 as usize].name;
                    let message = format!("`{name}` calls itself");
                    let diagnostic = Diagnostic::error("E0410", span, message);
                    self.report(diagnostic.help("functions are expanded in place; write a loop instead"));
                }
                _ => {}
            }
        }
    }

    fn require_body(&mut self, callee: FunctionId, span: Span) {
        if self.bodies[callee.0 as usize].is_none() {
            let signature = &self.signatures[callee.0 as usize];
            let message = format!("`{}` is called but never defined", signature.name);
            let diagnostic = Diagnostic::error("E0409", span, message).also(signature.span, "only declared here");
            self.report(diagnostic.help("write its body in this file or in an included one"));
        }
    }
}
