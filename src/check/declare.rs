//! Declarations: structs, functions, shaders and their parameters.

use super::context::{Checker, Signature, Symbol};
use super::notes::Meaning;
use super::typed::{self, FunctionId, VarId};
use crate::lang::builtins;
use crate::lang::types::{Base, Element, Length, Struct, Type};
use crate::limits::{ELEMENTS, NUMBERS};
use std::sync::Arc;
use velour_grammar::ast::{ArrayLen, FunctionDecl, Metadata, Param, ShaderDecl, StructDecl, TypeName, TypeSpec};
use velour_grammar::{Diagnostic, Span};

impl Checker<'_> {
    /// The type written, with its array brackets.
    pub fn resolve_type(&mut self, spec: &TypeSpec, array: ArrayLen) -> Type {
        let ty = self.written_type(spec, array);
        if ty.numbers(NUMBERS) <= NUMBERS {
            return ty;
        }
        let message = format!("{} has more numbers than the {NUMBERS} that a shader may have", ty.named());
        let diagnostic = Diagnostic::error("E0507", spec.span, message);
        self.report(diagnostic.help("every point of a batch has its own copy: make its arrays shorter"));
        Type::VOID
    }

    /// The type of a variable, a parameter or a field, which has to be one that values have. Void stands for one that is wrong.
    pub fn type_of_value(&mut self, name: &str, spec: &TypeSpec, array: ArrayLen) -> Type {
        let ty = self.resolve_type(spec, array);
        if matches!(spec.base, TypeName::Void) && !spec.closure {
            let message = format!("`{name}` cannot be of type void");
            self.error("E0507", spec.span, message, "only functions can be void; give it a type");
            return Type::VOID;
        }
        ty
    }

    fn written_type(&mut self, spec: &TypeSpec, array: ArrayLen) -> Type {
        let base = match &spec.base {
            _ if spec.closure => Base::Closure,
            TypeName::Int => Base::Int,
            TypeName::Float => Base::Float,
            TypeName::Color => Base::Color,
            TypeName::Point => Base::Point,
            TypeName::Vector => Base::Vector,
            TypeName::Normal => Base::Normal,
            TypeName::Matrix => Base::Matrix,
            TypeName::String => Base::String,
            TypeName::Void => Base::Void,
            TypeName::Struct(name) => return self.resolve_struct(name, spec.span, array),
        };
        Type::of(base).array(self.resolve_length(array, spec.span))
    }

    fn resolve_struct(&mut self, name: &str, span: Span, array: ArrayLen) -> Type {
        let length = self.resolve_length(array, span);
        if let Some(Symbol::Struct(structure)) = self.lookup(name) {
            let structure = structure.clone();
            self.note_struct(span, &structure);
            return Type { element: Element::Struct(structure), length };
        }
        let diagnostic = Diagnostic::error("E0407", span, format!("there is no type `{name}`"));
        self.report(diagnostic.help(format!("declare `struct {name} {{ … }};` above, or use a built-in type")));
        Type::VOID
    }

    fn resolve_length(&mut self, array: ArrayLen, span: Span) -> Length {
        match array {
            ArrayLen::Single => Length::Single,
            ArrayLen::Unsized => Length::Unsized,
            ArrayLen::Sized(n) if n > ELEMENTS => {
                let diagnostic =
                    Diagnostic::error("E0507", span, format!("an array of {n} elements is too large for a shader"));
                self.report(diagnostic.help(format!("{ELEMENTS} elements are the most")));
                Length::Fixed(1)
            }
            ArrayLen::Sized(n) if n > 0 => Length::Fixed(n as u32),
            ArrayLen::Sized(n) => {
                self.error(
                    "E0507",
                    span,
                    format!("an array has at least one element, not {n}"),
                    "write a length from 1 on",
                );
                Length::Fixed(1)
            }
        }
    }

    pub fn declare_struct(&mut self, decl: &StructDecl) {
        let mut fields: Vec<(String, Type)> = Vec::new();
        for field in &decl.fields {
            let ty = self.type_of_value(&field.name.name, &field.ty, field.array);
            if fields.iter().any(|(name, _)| *name == field.name.name) {
                self.error(
                    "E0404",
                    field.name.span,
                    format!("the struct has two fields `{}`", field.name.name),
                    "give one of them another name",
                );
                continue;
            }
            if ty.length == Length::Unsized {
                self.error(
                    "E0507",
                    field.name.span,
                    "an array in a struct needs a length",
                    "write the length in the brackets",
                );
            }
            fields.push((field.name.name.to_string(), ty));
        }
        let structure = Arc::new(Struct { name: decl.name.name.to_string(), fields });
        self.note_declared_struct(decl, &structure);
        let scope = self.scopes.len() - 1;
        if let Some(Symbol::Struct(_)) = self.scopes[scope].insert(decl.name.name.clone(), Symbol::Struct(structure)) {
            self.error(
                "E0404",
                decl.name.span,
                format!("struct `{}` is declared twice", decl.name.name),
                "give one of them another name",
            );
        }
    }

    /// Notes a name that stands for a struct.
    pub(super) fn note_struct(&mut self, span: Span, structure: &Arc<Struct>) {
        let number = self.notes.as_ref().and_then(|notes| notes.number_of(structure));
        if let Some(number) = number {
            self.note(span, &structure.name.as_str().into(), Meaning::Struct(number), false);
        }
    }

    fn note_declared_struct(&mut self, decl: &StructDecl, structure: &Arc<Struct>) {
        let Some(notes) = &mut self.notes else { return };
        let number = notes.structs.len() as u32;
        notes.structs.push(structure.clone());
        self.note(decl.name.span, &decl.name.name, Meaning::Struct(number), true);
        for field in &decl.fields {
            let at = structure.fields.iter().position(|(name, _)| *name == field.name.name);
            let meaning = Meaning::Field(number, at.unwrap_or_default() as u32);
            self.note(field.name.span, &field.name.name, meaning, true);
        }
    }

    fn note_function(&mut self, decl: &FunctionDecl, id: FunctionId) {
        self.note(decl.name.span, &decl.name.name, Meaning::Function(id), true);
        if let Some(notes) = &mut self.notes {
            let least = notes.functions.len().max(id.0 as usize + 1);
            notes.functions.resize_with(least, Default::default);
            notes.functions[id.0 as usize].names = decl.params.iter().map(|param| param.name.name.clone()).collect();
        }
    }

    pub fn declare_function(&mut self, decl: &FunctionDecl) {
        if decl.body.is_none() && self.binds_to_builtin(decl) {
            return;
        }
        let returns = self.resolve_type(&decl.return_type, ArrayLen::Single);
        let formals: Vec<_> =
            decl.params.iter().map(|p| (self.type_of_value(&p.name.name, &p.ty, p.array), p.output)).collect();
        let mut id = self.function_id(decl, &returns, &formals);
        let Some(body) = &decl.body else { return self.note_function(decl, id) };
        if self.bodies[id.0 as usize].is_some() {
            id = self.replaced(id, decl);
        }
        self.note_function(decl, id);
        self.signatures[id.0 as usize].size = body_size(decl);
        let (saved_returns, saved_inside) = (self.returns.replace(returns.clone()), self.inside.replace(id));
        let saved_loops = std::mem::take(&mut self.loops);
        let (params, body) = self.scoped(|c| {
            let pairs = decl.params.iter().zip(&formals);
            let bound =
                pairs.map(|(p, (ty, output))| (c.bind(&p.name.name, ty.clone(), p.name.span, *output), *output));
            let params: Vec<(VarId, bool)> = bound.collect();
            (params, c.check_block(body))
        });
        self.loops = saved_loops;
        self.returns = saved_returns;
        self.inside = saved_inside;
        if returns != Type::VOID && !returns_somewhere(&body) {
            let message = format!("`{}` returns {}, but has no return statement", decl.name.name, returns.named());
            let diagnostic = Diagnostic::error("E0508", Span { first: decl.span.last, ..decl.span }, message)
                .also(decl.name.span, "declared here");
            self.report(diagnostic.help("write `return value;`, or declare it `void`"));
        }
        let function = typed::Function { name: decl.name.name.to_string(), returns, params, body };
        self.bodies[id.0 as usize] = Some(Arc::new(function));
    }

    /// Is a prototype one of a function that comes with the language, so that it declares nothing? A closure that is said to be builtin and
    /// that velour does not have is remembered, since calls of it are no mistake of the shader.
    fn binds_to_builtin(&mut self, decl: &FunctionDecl) -> bool {
        let name = &decl.name.name;
        let closure = self.closures.named(name).next().map(|(id, _)| Meaning::Closure(id));
        if let Some(meaning) = builtins::static_name(name).map(Meaning::Builtin).or(closure) {
            self.note(decl.name.span, name, meaning, false);
            return true;
        }
        let builtin = decl.metadata.iter().any(|entry| entry.name.name == "builtin");
        let closure = decl.return_type.closure;
        if builtin && closure {
            self.foreign.insert(name.to_string());
        }
        builtin && closure
    }

    /// A function that takes the place of one defined before; calls between the two keep the old one.
    fn replaced(&mut self, old: FunctionId, decl: &FunctionDecl) -> FunctionId {
        let before = &self.signatures[old.0 as usize];
        let diagnostic =
            Diagnostic::warning("W0504", decl.name.span, format!("function `{}` is defined twice", before.name));
        let diagnostic = diagnostic.also(before.span, "defined here first");
        let signature = Signature {
            name: before.name.clone(),
            returns: before.returns.clone(),
            formals: before.formals.clone(),
            span: decl.span,
            size: body_size(decl),
            calls: Vec::new(),
        };
        self.report(diagnostic.help("from here on the later one is called; remove one of them"));
        let id = FunctionId(self.signatures.len() as u32);
        self.signatures.push(signature);
        self.bodies.push(None);
        let scope = self.scopes.len() - 1;
        if let Some(Symbol::Functions(ids)) = self.scopes[scope].get_mut(&decl.name.name) {
            ids.retain(|known| *known != old);
            ids.push(id);
        }
        id
    }

    /// The id of a prototype with the same formals in this scope, or a new one.
    fn function_id(&mut self, decl: &FunctionDecl, returns: &Type, formals: &[(Type, bool)]) -> FunctionId {
        let name = &decl.name.name;
        let scope = self.scopes.len() - 1;
        let known = match self.scopes[scope].get(name) {
            Some(Symbol::Functions(ids)) => ids.clone(),
            Some(_) => {
                self.error(
                    "E0404",
                    decl.name.span,
                    format!("`{name}` is already the name of something else"),
                    "give the function another name",
                );
                Vec::new()
            }
            None => Vec::new(),
        };
        let same = |id: &&FunctionId| {
            let signature = &self.signatures[id.0 as usize];
            signature.formals == formals && signature.returns == *returns
        };
        if let Some(&id) = known.iter().find(same) {
            return id;
        }
        let id = FunctionId(self.signatures.len() as u32);
        self.signatures.push(Signature {
            name: name.to_string(),
            returns: returns.clone(),
            formals: formals.to_vec(),
            span: decl.span,
            size: body_size(decl),
            calls: Vec::new(),
        });
        self.bodies.push(None);
        let ids = known.into_iter().chain([id]).collect();
        self.scopes[scope].insert(name.clone(), Symbol::Functions(ids));
        id
    }

    pub fn declare_shader(&mut self, decl: &ShaderDecl) -> typed::Shader {
        self.note(decl.name.span, &decl.name.name, Meaning::Shader, true);
        self.scoped(|c| {
            let metadata = c.check_metadata(&decl.metadata);
            let params = decl.params.iter().map(|param| c.declare_param(param)).collect();
            let body = c.check_block(&decl.body);
            typed::Shader {
                kind: decl.kind,
                name: decl.name.name.to_string(),
                span: decl.span,
                metadata,
                params,
                variables: Vec::new(),
                functions: Vec::new(),
                body,
            }
        })
    }

    fn declare_param(&mut self, param: &Param) -> typed::ShaderParam {
        let mut ty = self.type_of_value(&param.name.name, &param.ty, param.array);
        let name = &param.name;
        let open = ty.length == Length::Unsized;
        if ty.length == Length::Unsized && param.output {
            self.error("E0507", name.span, "an output array needs a length", "write the length in the brackets");
        }
        let default = match &param.default {
            Some(value) => {
                self.in_params = true;
                let value = self.check_initial(value, &mut ty);
                self.in_params = false;
                Some(value)
            }
            None => {
                let diagnostic =
                    Diagnostic::error("E0408", name.span, format!("parameter `{}` has no default", name.name));
                self.report(diagnostic.help(format!("write `{} = …`", name.name)));
                None
            }
        };
        let metadata = self.check_metadata(&param.metadata);
        let var = self.bind(&name.name, ty, name.span, param.output);
        typed::ShaderParam { var, output: param.output, open, default, metadata }
    }

    fn check_metadata(&mut self, list: &[Metadata]) -> Vec<typed::Metadata> {
        let mut out = Vec::new();
        for entry in list {
            let mut ty = self.resolve_type(&entry.ty, entry.array);
            let value = self.check_initial(&entry.value, &mut ty);
            out.push(typed::Metadata { ty, name: entry.name.name.to_string(), value });
        }
        out
    }
}

/// How much text the body of a function is, in tokens.
fn body_size(decl: &FunctionDecl) -> u64 {
    let body = decl.body.as_deref().unwrap_or_default();
    match (body.first(), body.last()) {
        (Some(first), Some(last)) => u64::from(last.span.last.saturating_sub(first.span.first)) + 1,
        _ => 1,
    }
}

/// Is there a return statement anywhere in these statements?
fn returns_somewhere(stmts: &[typed::Stmt]) -> bool {
    use typed::Stmt;
    stmts.iter().any(|stmt| match stmt {
        Stmt::Return(_) => true,
        Stmt::Block(body) => returns_somewhere(body),
        Stmt::If(_, then, otherwise) => returns_somewhere(then) || returns_somewhere(otherwise),
        Stmt::Loop { body, .. } => returns_somewhere(body),
        Stmt::Expr(_) | Stmt::Declare(..) | Stmt::Break | Stmt::Continue => false,
    })
}
