//! Calls: overloads of user functions, builtins, closures and struct constructors.
//!
//! Overloads are ranked as OSL ranks them: an exact argument counts most, then int to float, array length, triple to
//! triple, and any other conversion; the sums are compared, and a tie goes to the best return type.

use super::context::{Checker, Symbol};
use super::convert::{assignable, is_number};
use super::expr::nearest;
use super::typed::{Argument, Expr, ExprKind, FunctionId};
use crate::lang::builtins::{self, Formal, NOT_YET, Signature};
use crate::lang::closures::{ClosureId, ClosureSpec, ParamKind};
use crate::lang::types::{Base, Length, Type};
use velour_grammar::ast::{self, Ident};
use velour_grammar::{Diagnostic, Span};

/// Something a call may mean.
#[derive(Clone)]
enum Candidate {
    User(FunctionId),
    Builtin(&'static str, &'static Signature),
    Closure(ClosureId),
}

impl Checker<'_> {
    pub(super) fn check_call(&mut self, name: &Ident, args: &[ast::Expr], expected: Option<&Type>, span: Span) -> Expr {
        if let Some(Symbol::Struct(structure)) = self.lookup(&name.name) {
            let ty = Type { element: crate::lang::types::Element::Struct(structure.clone()), length: Length::Single };
            let list = ast::Expr { kind: ast::ExprKind::InitList(args.to_vec()), span };
            return self.check_initial(&list, &mut ty.clone());
        }
        let list = |arg: &ast::Expr| matches!(arg.kind, ast::ExprKind::InitList(_));
        let values: Vec<Expr> = args
            .iter()
            .map(|arg| if list(arg) { Expr::new(ExprKind::Int(1), Type::VOID, arg.span) } else { self.check_expr(arg, None) })
            .collect();
        if values.iter().any(Expr::is_error) {
            return Expr::error(span);
        }
        let candidates = self.candidates(&name.name);
        if candidates.is_empty() {
            self.unknown_function(name);
            return Expr::error(span);
        }
        match self.best(&candidates, &values, expected, name) {
            Some(Candidate::User(id)) => self.call_user(id, args, values, span),
            Some(Candidate::Builtin(name, signature)) => self.call_builtin(name, signature, args, values, span),
            Some(Candidate::Closure(id)) => self.call_closure(id, values, span),
            None => {
                self.no_match(name, &candidates, &values, span);
                Expr::error(span)
            }
        }
    }

    fn candidates(&self, name: &str) -> Vec<Candidate> {
        let users = self.functions_named(name).into_iter().map(Candidate::User);
        let builtin = builtins::static_name(name).unwrap_or_default();
        let builtins = builtins::signatures(name).unwrap_or_default().iter().map(|s| Candidate::Builtin(builtin, s));
        let closures = self.closures.named(name).map(|(id, _)| Candidate::Closure(id));
        users.chain(builtins).chain(closures).collect()
    }

    fn unknown_function(&mut self, name: &Ident) {
        let diagnostic = Diagnostic::error("E0405", name.span, format!("there is no function `{}`", name.name));
        let mut known: Vec<&str> = self.scopes.iter().flat_map(|scope| scope.keys().map(String::as_str)).collect();
        builtins::names().for_each(|name| known.push(name));
        self.closures.specs.iter().for_each(|spec| known.push(spec.name));
        let help = nearest(&name.name, known.into_iter()).map(|near| format!("did you mean `{near}`?"));
        self.report(diagnostic.help(help.unwrap_or_else(|| "`velour info` lists functions and closures".to_owned())));
    }

    fn best(&mut self, candidates: &[Candidate], args: &[Expr], expected: Option<&Type>, name: &Ident) -> Option<Candidate> {
        let mut best: Vec<(u32, u32, &Candidate)> = Vec::new();
        for candidate in candidates {
            let Some(score) = self.score(candidate, args) else { continue };
            let result = expected.and_then(|ty| score_type(ty, &self.returns_of(candidate))).unwrap_or(0);
            let top = best.first().map_or((0, 0), |b| (b.0, b.1));
            if (score, result) > top || best.is_empty() {
                best.clear();
            }
            if best.is_empty() || (score, result) == top {
                best.push((score, result, candidate));
            }
        }
        let tied_users = best.iter().filter(|b| matches!(b.2, Candidate::User(_))).count();
        // The plainest return type wins a tie that the surroundings do not decide.
        let rank = |c: &Candidate| rank_type(&self.returns_of(c));
        let chosen = best.iter().min_by_key(|b| rank(b.2)).map(|b| b.2.clone());
        let same_formals = |c: &Candidate| chosen.as_ref().is_some_and(|d| self.formals_text(c) == self.formals_text(d));
        if tied_users > 1 && best.iter().filter(|b| same_formals(b.2)).count() < best.len() {
            let diagnostic = Diagnostic::warning("W0502", name.span, format!("the call of `{}` is ambiguous", name.name));
            self.report(diagnostic.help("cast an argument, or the result, to the type that is meant"));
        }
        chosen
    }

    fn returns_of(&self, candidate: &Candidate) -> Type {
        match candidate {
            Candidate::User(id) => self.signatures[id.0 as usize].returns.clone(),
            Candidate::Builtin(_, signature) => signature.returns.clone(),
            Candidate::Closure(_) => Type::CLOSURE,
        }
    }

    fn score(&self, candidate: &Candidate, args: &[Expr]) -> Option<u32> {
        match candidate {
            Candidate::User(id) => {
                let formals = &self.signatures[id.0 as usize].formals;
                if formals.len() != args.len() {
                    return None;
                }
                // An empty argument list fits exactly; one more keeps it above "no score".
                formals.iter().zip(args).map(|((ty, _), arg)| score_argument(ty, arg)).try_fold(1, |sum, s| Some(sum + s?))
            }
            Candidate::Builtin(_, signature) => score_builtin(signature, args),
            Candidate::Closure(id) => score_closure(self.closures.get(*id), args),
        }
    }

    fn call_user(&mut self, id: FunctionId, args: &[ast::Expr], values: Vec<Expr>, span: Span) -> Expr {
        let signature = &self.signatures[id.0 as usize];
        let (returns, formals) = (signature.returns.clone(), signature.formals.clone());
        self.note_call(id, span);
        let mut arguments = Vec::new();
        for (((ty, output), value), arg) in formals.iter().zip(values).zip(args) {
            if *output {
                let Some(place) = self.check_place(arg) else { return Expr::error(span) };
                arguments.push(Argument::Out(place));
            } else if matches!(arg.kind, ast::ExprKind::InitList(_)) {
                arguments.push(Argument::In(self.check_initial(arg, &mut ty.clone())));
            } else {
                // The type wanted may choose between overloads inside the argument.
                let again = matches!(value.kind, ExprKind::Builtin(..)) && value.ty != *ty;
                let value = if again { self.check_expr(arg, Some(ty)) } else { value };
                arguments.push(Argument::In(self.convert(value, ty)));
            }
        }
        Expr::new(ExprKind::Call(id, arguments), returns, span)
    }

    fn call_builtin(
        &mut self,
        name: &'static str,
        signature: &'static Signature,
        args: &[ast::Expr],
        values: Vec<Expr>,
        span: Span,
    ) -> Expr {
        if NOT_YET.contains(&name) {
            let diagnostic = Diagnostic::error("E0412", span, format!("velour does not run `{name}` yet"));
            self.report(diagnostic.help("compute the value in the shader, or pass it as a parameter"));
            return Expr::error(span);
        }
        let mut arguments = Vec::new();
        for (at, (value, arg)) in values.into_iter().zip(args).enumerate() {
            match signature.formals.get(at) {
                Some((_, true)) => {
                    let Some(place) = self.check_place(arg) else { return Expr::error(span) };
                    arguments.push(Argument::Out(place));
                }
                Some((Formal::Type(ty), false)) => arguments.push(Argument::In(self.convert(value, ty))),
                _ => arguments.push(Argument::In(value)),
            }
        }
        self.check_format(name, &arguments, span);
        Expr::new(ExprKind::Builtin(name, arguments), signature.returns.clone(), span)
    }

    fn call_closure(&mut self, id: ClosureId, values: Vec<Expr>, span: Span) -> Expr {
        let spec = self.closures.get(id).clone();
        let mut values = values.into_iter();
        let mut params = Vec::new();
        for (param, value) in spec.params.iter().zip(values.by_ref()) {
            params.push(self.convert(value, &param_type(param.kind)));
        }
        let mut keywords = Vec::new();
        while let (Some(token), Some(value)) = (values.next(), values.next()) {
            let ExprKind::String(word) = &token.kind else {
                self.error("E0411", token.span, "the name of a keyword parameter is a literal string");
                continue;
            };
            let Some(at) = spec.keywords.iter().position(|keyword| keyword.name == word) else {
                let names: Vec<String> = spec.keywords.iter().map(|keyword| format!("\"{}\"", keyword.name)).collect();
                let message = format!("`{}` has no keyword parameter \"{word}\"", spec.name);
                let known = if names.is_empty() { "it has none".to_owned() } else { format!("it has {}", names.join(", ")) };
                self.report(Diagnostic::error("E0411", token.span, message).help(known));
                continue;
            };
            let value = self.convert(value, &param_type(spec.keywords[at].kind));
            keywords.push((at as u32, value));
        }
        Expr::new(ExprKind::Closure(id, params, keywords), Type::CLOSURE, span)
    }

    fn no_match(&mut self, name: &Ident, candidates: &[Candidate], args: &[Expr], span: Span) {
        let listed = matches!(args.first(), Some(arg) if arg.ty == Type::VOID);
        let given: Vec<String> = args.iter().map(|arg| arg.ty.to_string()).collect();
        let given = if listed { "a list".to_owned() } else { given.join(", ") };
        let message = format!("no `{}` takes ({given})", name.name);
        let mut diagnostic = Diagnostic::error("E0406", span, message);
        for candidate in candidates {
            if let Candidate::User(id) = candidate {
                let signature = &self.signatures[id.0 as usize];
                diagnostic = diagnostic.also(signature.span, "this one does not fit");
            }
        }
        let texts: Vec<String> = candidates.iter().take(8).map(|c| self.formals_text(c)).collect();
        self.report(diagnostic.help(format!("it takes {}", texts.join(" or "))));
    }

    fn formals_text(&self, candidate: &Candidate) -> String {
        let list: Vec<String> = match candidate {
            Candidate::User(id) => {
                let formals = &self.signatures[id.0 as usize].formals;
                formals.iter().map(|(ty, out)| if *out { format!("output {ty}") } else { ty.to_string() }).collect()
            }
            Candidate::Builtin(_, signature) => {
                let text = |formal: &Formal| match formal {
                    Formal::Type(ty) => ty.to_string(),
                    Formal::Any => "any".to_owned(),
                    Formal::AnyArray => "any[]".to_owned(),
                };
                let more = if signature.variadic || signature.options { Some("…".to_owned()) } else { None };
                signature.formals.iter().map(|(formal, _)| text(formal)).chain(more).collect()
            }
            Candidate::Closure(id) => {
                let spec = self.closures.get(*id);
                spec.params.iter().map(|p| format!("{} {}", param_type(p.kind), p.name)).collect()
            }
        };
        format!("({})", list.join(", "))
    }
}

/// The language's type of a closure parameter.
pub(super) fn param_type(kind: ParamKind) -> Type {
    Type::of(match kind {
        ParamKind::Float => Base::Float,
        ParamKind::Int => Base::Int,
        ParamKind::Color => Base::Color,
        ParamKind::Vector => Base::Vector,
        ParamKind::Normal => Base::Normal,
        ParamKind::String => Base::String,
        ParamKind::Closure => Base::Closure,
    })
}

fn score_argument(formal: &Type, arg: &Expr) -> Option<u32> {
    let list = arg.ty == Type::VOID && matches!(arg.kind, ExprKind::Int(1));
    let null = formal.base() == Some(Base::Closure) && matches!(arg.kind, ExprKind::Int(0));
    if list || null {
        return Some(1);
    }
    score_type(formal, &arg.ty)
}

/// How well a value of type `actual` fits a formal of type `formal`.
fn score_type(formal: &Type, actual: &Type) -> Option<u32> {
    if formal == actual {
        return Some(100);
    }
    if is_number(formal) && is_number(actual) {
        return (formal.base() == Some(Base::Float)).then_some(77);
    }
    if formal.length == Length::Unsized && actual.is_array() && formal.element == actual.element {
        return Some(44);
    }
    if !assignable(formal, actual) {
        return None;
    }
    let (a, b) = (formal.base()?, actual.base()?);
    let spatial = |base: Base| base.is_triple() && base != Base::Color;
    Some(match () {
        _ if spatial(a) && spatial(b) => 32,
        _ if a.is_triple() && b.is_triple() => 27,
        _ => 23,
    })
}

fn score_builtin(signature: &Signature, args: &[Expr]) -> Option<u32> {
    let fixed = signature.formals.len();
    let extra = args.len().checked_sub(fixed)?;
    let pairs = || args[fixed..].chunks(2).all(|pair| pair.len() == 2 && pair[0].ty == Type::STRING);
    if extra > 0 && !signature.variadic && !(signature.options && pairs()) {
        return None;
    }
    let mut sum = 1 + extra as u32;
    for ((formal, output), arg) in signature.formals.iter().zip(args) {
        sum += match formal {
            // What a builtin writes must be of the very type.
            Formal::Type(ty) if *output && ty.length != Length::Unsized => (*ty == arg.ty).then_some(100)?,
            Formal::Type(ty) => score_argument(ty, arg)?,
            Formal::Any => (!arg.ty.is_array()).then_some(1)?,
            Formal::AnyArray => arg.ty.is_array().then_some(1)?,
        };
    }
    Some(sum)
}

fn score_closure(spec: &ClosureSpec, args: &[Expr]) -> Option<u32> {
    let fixed = spec.params.len();
    let extra = args.len().checked_sub(fixed)?;
    if extra % 2 != 0 || args[fixed..].chunks(2).any(|pair| pair[0].ty != Type::STRING) {
        return None;
    }
    let mut scores = spec.params.iter().zip(args).map(|(param, arg)| score_argument(&param_type(param.kind), arg));
    scores.try_fold(1 + extra as u32, |sum, score| Some(sum + score?))
}

fn rank_type(ty: &Type) -> u32 {
    match ty.base() {
        Some(Base::Float) => 0,
        Some(Base::Int) => 1,
        Some(Base::Color) => 2,
        Some(Base::Vector) => 3,
        Some(Base::Point) => 4,
        Some(Base::Normal) => 5,
        Some(Base::Matrix) => 6,
        _ => 7,
    }
}
