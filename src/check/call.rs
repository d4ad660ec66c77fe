//! Calls: what a name may mean, and the checked call of what fits best.

use super::candidate::{Candidate, param_type};
use super::context::{Checker, Signature, Symbol};
use super::rank::{better_overload, rank_type, same_storage, score_type};
use super::typed::{Argument, Expr, ExprKind, FunctionId};
use crate::lang::builtins::{self, Formal};
use crate::lang::closures::{ClosureId, ClosureSpec, ParamSpec};
use crate::lang::nearest::nearest;
use crate::lang::types::{Length, Type};
use velour_grammar::ast::{self, Ident};
use velour_grammar::names::Name;
use velour_grammar::{Diagnostic, Span};

impl Checker<'_> {
    pub(super) fn check_call(&mut self, name: &Ident, args: &[ast::Expr], expected: Option<&Type>, span: Span) -> Expr {
        if let Some(Symbol::Struct(structure)) = self.lookup(&name.name) {
            let structure = structure.clone();
            self.note_struct(name.span, &structure);
            let ty = Type { element: crate::lang::types::Element::Struct(structure.clone()), length: Length::Single };
            if args.len() < structure.fields.len() {
                let (given, wanted) = (args.len(), structure.fields.len());
                let message = format!("`{}` has {wanted} parts, not {given}", name.name);
                let diagnostic = Diagnostic::error("E0510", span, message);
                self.report(
                    diagnostic.help("give all parts, or use an initialiser list `{ … }`, where missing parts are zero"),
                );
                return Expr::error(span);
            }
            let list = ast::Expr { kind: ast::ExprKind::InitList(args.to_vec()), span };
            return self.check_initial(&list, &mut ty.clone());
        }
        // Wrong arguments leave it open which one is meant.
        if self.notes.is_some()
            && let Some(meaning) = self.nearest_meaning(&name.name)
        {
            self.note(name.span, &name.name, meaning, false);
        }
        let list = |arg: &ast::Expr| matches!(arg.kind, ast::ExprKind::InitList(_));
        let values: Vec<Expr> =
            args.iter()
                .map(|arg| {
                    if list(arg) {
                        Expr::new(ExprKind::Int(1), Type::VOID, arg.span)
                    } else {
                        self.check_expr(arg, None)
                    }
                })
                .collect();
        let wrong = values.iter().any(Expr::is_error);
        let candidates = self.candidates(&name.name);
        let foreign = candidates.is_empty() && self.foreign.contains(name.name.as_str());
        if foreign && !wrong {
            let message = format!("velour has no closure `{}`; it adds nothing", name.name);
            self.report(
                Diagnostic::warning("W0506", name.span, message).help("`velour info` lists the closures there are"),
            );
            let zero = Expr::new(ExprKind::Int(0), Type::INT, span);
            return Expr::new(ExprKind::Convert(Box::new(zero)), Type::CLOSURE, span);
        }
        // That there is no such function does not depend on what it is called with.
        if !foreign && (candidates.is_empty() || matches!(self.lookup(&name.name), Some(Symbol::Var(_)))) {
            self.unknown_function(name);
            return Expr::error(span);
        }
        if wrong {
            return Expr::error(span);
        }
        let best = self.best(&candidates, (args, &values), expected, name);
        if let Some(best) = &best {
            self.note(name.span, &name.name, best.meaning(), false);
        }
        match best {
            Some(Candidate::User(id)) => self.call_user(id, args, values, span),
            Some(Candidate::Builtin(name, signature)) => self.call_builtin(name, signature, args, values, span),
            Some(Candidate::Closure(id)) => self.call_closure(id, values, span),
            None if self.diagnostics.list.last().is_some_and(|d| d.code == "E0413" && d.span == name.span) => {
                Expr::error(span)
            }
            None => {
                self.no_match(name, &candidates, &values, span);
                Expr::error(span)
            }
        }
    }

    fn unknown_function(&mut self, name: &Ident) {
        if let Some(Symbol::Var(var)) = self.lookup(&name.name) {
            let declared = self.variables[var.0 as usize].span;
            let diagnostic =
                Diagnostic::error("E0405", name.span, format!("`{}` is a variable, not a function", name.name));
            self.report(diagnostic.also(declared, "declared here").help("give the variable another name"));
            return;
        }
        let diagnostic = Diagnostic::error("E0405", name.span, format!("there is no function `{}`", name.name));
        let mut known: Vec<&str> = self.scopes.iter().flat_map(|scope| scope.keys().map(Name::as_str)).collect();
        builtins::names().for_each(|name| known.push(name));
        self.closures.specs.iter().for_each(|spec| known.push(spec.name));
        let help = nearest(&name.name, &known).map(|near| format!("did you mean `{near}`?"));
        self.report(diagnostic.help(help.unwrap_or_else(|| "`velour info` lists functions and closures".to_owned())));
    }

    /// The candidate that fits best, or nothing; an undecidable tie is reported.
    fn best(
        &mut self,
        candidates: &[Candidate],
        args: (&[ast::Expr], &[Expr]),
        expected: Option<&Type>,
        name: &Ident,
    ) -> Option<Candidate> {
        let mut best: Vec<(u32, u32, &Candidate)> = Vec::new();
        for candidate in candidates {
            let Some(score) = self.score(candidate, args.0, args.1) else { continue };
            let result = expected.and_then(|ty| score_type(ty, &self.returns_of(candidate))).unwrap_or(0);
            let top = best.first().map_or((0, 0), |b| (b.0, b.1));
            if (score, result) > top || best.is_empty() {
                best.clear();
            }
            if best.is_empty() || (score, result) == top {
                best.push((score, result, candidate));
            }
        }
        // The plainest return type wins a tie that the surroundings do not decide.
        let rank = |c: &Candidate| rank_type(&self.returns_of(c));
        let chosen = best.iter().min_by_key(|b| rank(b.2)).map(|b| b.2.clone())?;
        let lists = args.0.iter().any(|arg| matches!(arg.kind, ast::ExprKind::InitList(_)));
        let tied = || best.iter().filter(|b| lists || matches!(b.2, Candidate::User(_)));
        // Which of the builtins a list goes to is for the plainest of them to say, as in OSL.
        let own = best.iter().any(|b| !matches!(b.2, Candidate::Builtin(..)));
        if own && tied().count() > 1 {
            let undecided = best.iter().filter(|b| rank(b.2) == rank(&chosen)).count() > 1;
            let fatal =
                undecided && (lists || self.returns_of(&chosen).structure().is_some()) || lists && expected.is_none();
            let mut fits: Vec<&Candidate> = tied().map(|b| b.2).collect();
            fits.sort_by_key(|candidate| rank(candidate));
            self.ambiguous(name, &fits, fatal);
            if fatal {
                return None;
            }
        }
        Some(chosen)
    }

    /// Reports a call that several candidates fit, the one that is taken first.
    fn ambiguous(&mut self, name: &Ident, fits: &[&Candidate], fatal: bool) {
        let message = format!("the call of `{}` is ambiguous", name.name);
        let diagnostic = if fatal {
            Diagnostic::error("E0413", name.span, message)
        } else {
            Diagnostic::warning("W0502", name.span, message)
        };
        let text = |candidate: &&Candidate| {
            let span = self.span_of(candidate)?;
            let (returns, formals) = (self.returns_of(candidate), self.formals_text(candidate));
            Some((span, format!("{returns} {} {formals}", name.name)))
        };
        let functions: Vec<(Span, String)> = fits.iter().filter_map(text).collect();
        let diagnostic = functions.iter().fold(diagnostic, |d, (span, _)| d.also(*span, "this one fits"));
        // The headings are oslc's.
        let diagnostic = match functions.split_first() {
            Some((chosen, others)) if !fatal => diagnostic
                .functions("Chosen function is", vec![chosen.clone()])
                .functions("Other candidates are", others.to_vec()),
            _ => diagnostic.functions("Candidates are", functions),
        };
        self.report(diagnostic.help("cast an argument, or the result, to the type that is meant"));
    }

    fn call_user(&mut self, id: FunctionId, args: &[ast::Expr], values: Vec<Expr>, span: Span) -> Expr {
        let signature = &self.signatures[id.0 as usize];
        let (returns, formals) = (signature.returns.clone(), signature.formals.clone());
        self.note_call(id, span);
        let mut arguments = Vec::with_capacity(values.len());
        for (((ty, output), value), arg) in formals.iter().zip(values).zip(args) {
            // What has no name cannot be written: the function writes a copy that nobody reads.
            if *output && is_place(arg) {
                let Some(place) = self.check_place(arg) else { return Expr::error(span) };
                arguments.push(Argument::Out(place));
            } else if matches!(arg.kind, ast::ExprKind::InitList(_)) {
                arguments.push(Argument::In(self.check_initial(arg, &mut ty.clone())));
            } else {
                arguments.push(Argument::In(self.convert(better_overload(value, ty), ty)));
            }
        }
        Expr::new(ExprKind::Call(id, arguments), returns, span)
    }

    fn call_builtin(
        &mut self,
        name: &'static str,
        signature: &'static builtins::Signature,
        args: &[ast::Expr],
        values: Vec<Expr>,
        span: Span,
    ) -> Expr {
        if let (true, Some(ExprKind::String(kind))) =
            (matches!(name, "noise" | "pnoise"), values.first().map(|v| &v.kind))
        {
            self.warn_of_noise(name, kind, values[0].span);
        }
        let mut arguments = Vec::with_capacity(values.len());
        let mut option = String::new();
        for (at, (value, arg)) in values.into_iter().zip(args).enumerate() {
            if signature.options && at >= signature.formals.len() {
                if (at - signature.formals.len()).is_multiple_of(2) {
                    option = self.option_name(name, &value);
                } else if is_written(name, &option) {
                    let Some(place) = self.check_place(arg) else { return Expr::error(span) };
                    arguments.push(Argument::Out(place));
                    continue;
                }
            }
            match signature.formals.get(at) {
                Some((_, true)) => {
                    let Some(place) = self.check_place(arg) else { return Expr::error(span) };
                    arguments.push(Argument::Out(place));
                }
                Some((Formal::Type(ty), false)) if matches!(arg.kind, ast::ExprKind::InitList(_)) => {
                    arguments.push(Argument::In(self.check_initial(arg, &mut ty.clone())));
                }
                Some((Formal::Type(ty), false)) => arguments.push(Argument::In(self.convert(value, ty))),
                _ => arguments.push(Argument::In(value)),
            }
        }
        self.check_format(name, &arguments, span);
        Expr::new(ExprKind::Builtin(name, arguments), signature.returns.clone(), span)
    }

    /// The name of an option, with a warning where it has no meaning here.
    fn option_name(&mut self, function: &str, token: &Expr) -> String {
        let known: &[&str] = match function {
            "texture" | "environment" => TEXTURE_OPTIONS,
            _ => &[],
        };
        let ExprKind::String(name) = &token.kind else {
            if !known.is_empty() {
                let message = format!("an option of `{function}` whose name is computed has no effect");
                self.report(
                    Diagnostic::warning("W0506", token.span, message).help("write its name as a literal string"),
                );
            }
            return String::new();
        };
        if !known.is_empty() && !known.contains(&name.as_str()) {
            let message = format!("`{function}` has no option \"{name}\"");
            let help = match nearest(name, known) {
                Some(near) => format!("did you mean \"{near}\"?"),
                None => format!("its options are {}", known.join(", ")),
            };
            self.report(Diagnostic::warning("W0506", token.span, message).help(help));
        }
        name.clone()
    }

    /// Warns of a literal name that stands for no noise, which is an error when it runs.
    fn warn_of_noise(&mut self, function: &str, name: &str, span: Span) {
        let known: Vec<&str> =
            NOISES.iter().copied().filter(|n| function == "noise" || !n.contains("simplex")).collect();
        if !known.contains(&name) {
            let diagnostic =
                Diagnostic::warning("W0511", span, format!("`{function}` has no \"{name}\"; it gives 0 and an error"));
            let help = match nearest(name, &known) {
                Some(near) => format!("did you mean \"{near}\"?"),
                None => format!("the kinds of noise are {}", known.join(", ")),
            };
            self.report(diagnostic.help(help));
        }
    }

    fn call_closure(&mut self, id: ClosureId, values: Vec<Expr>, span: Span) -> Expr {
        let spec = self.closures.get(id).clone();
        let mut values = values.into_iter();
        let mut params = Vec::new();
        for (param, value) in spec.params.iter().zip(values.by_ref()) {
            if let Some(message) = wrong_choice(param, &value) {
                let diagnostic = Diagnostic::warning("W0505", value.span, message);
                self.report(diagnostic.help(format!("the first choice, \"{}\", is taken", param.choices[0])));
            }
            params.push(self.convert(value, &param_type(param.kind)));
        }
        let mut keywords = Vec::new();
        while let (Some(token), Some(value)) = (values.next(), values.next()) {
            let ExprKind::String(word) = &token.kind else {
                self.error(
                    "E0411",
                    token.span,
                    "the name of a keyword parameter is a literal string",
                    "write the name in quotes",
                );
                continue;
            };
            let Some(at) = spec.keywords.iter().position(|keyword| keyword.name == word) else {
                self.unknown_keyword(&spec, word, token.span);
                continue;
            };
            if let Some(message) = wrong_choice(&spec.keywords[at], &value) {
                let choices = spec.keywords[at].choices.join("\", \"");
                self.report(Diagnostic::error("E0411", value.span, message).help(format!("choose \"{choices}\"")));
            }
            if let (Some(numbered), ExprKind::Int(given)) = (spec.keywords[at].numbered, &value.kind)
                && !(numbered.least..=numbered.most).contains(given)
            {
                let message = format!("`{}` has no \"{word}\" {given}", spec.name);
                self.report(Diagnostic::error("E0412", value.span, message).help(numbered.meaning));
            }
            if let Some((_, what)) = spec.keywords[at].left_out.filter(|(nothing, _)| !is_literally(&value, *nothing)) {
                let message = format!("velour does not model \"{word}\" of `{}`", spec.name);
                self.report(Diagnostic::warning("W0506", token.span, message).help(format!("left out: {what}")));
            }
            let value = self.convert(value, &param_type(spec.keywords[at].kind));
            // Of a keyword that is given more than once the last value counts, as in OSL.
            keywords.retain(|(known, _): &(u32, Expr)| *known != at as u32);
            keywords.push((at as u32, value));
        }
        Expr::new(ExprKind::Closure(id, params.into(), keywords.into()), Type::CLOSURE, span)
    }

    /// Warns of a keyword that a closure does not have. The tags of `debug` are the host's own.
    fn unknown_keyword(&mut self, spec: &ClosureSpec, word: &str, span: Span) {
        if spec.name == "debug" {
            return;
        }
        let names: Vec<&str> = spec.keywords.iter().map(|keyword| keyword.name).collect();
        let message = format!("`{}` has no keyword parameter \"{word}\"; it has no effect", spec.name);
        let help = match nearest(word, &names) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None if names.is_empty() => "it has none".to_owned(),
            None => format!("it has \"{}\"", names.join("\", \"")),
        };
        self.report(Diagnostic::warning("W0506", span, message).help(help));
    }

    /// The message for a call of one function whose only fault is the type of a variable that it writes.
    fn wrong_output(&self, candidates: &[Candidate], args: &[Expr]) -> Option<Diagnostic> {
        let [Candidate::User(id)] = candidates else { return None };
        let Signature { name, formals, span, .. } = &self.signatures[id.0 as usize];
        let listed = args.iter().any(|arg| arg.ty == Type::VOID);
        if formals.len() != args.len() || listed {
            return None;
        }
        let wrong = |((ty, output), arg): &(&(Type, bool), &Expr)| *output && !same_storage(ty, &arg.ty);
        let ((ty, _), arg) = formals.iter().zip(args).find(wrong)?;
        let message =
            format!("`{name}` writes this argument: {} is needed here, this is {}", ty.named(), arg.ty.named());
        let diagnostic = Diagnostic::error("E0406", arg.span, message).also(*span, "declared here");
        Some(diagnostic.help(format!("give a variable of type {ty}, and copy it afterwards")))
    }

    fn no_match(&mut self, name: &Ident, candidates: &[Candidate], args: &[Expr], span: Span) {
        if let Some(diagnostic) = self.wrong_output(candidates, args) {
            return self.report(diagnostic);
        }
        // What a parameter of a wrong type takes is not known.
        let unknown = |c: &Candidate| match c {
            Candidate::User(id) => self.signatures[id.0 as usize].formals.iter().any(|(ty, _)| *ty == Type::VOID),
            Candidate::Builtin(..) | Candidate::Closure(_) => false,
        };
        if candidates.iter().any(unknown) {
            return;
        }
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
}

/// What is wrong with a literal that is none of the strings a parameter may be.
fn wrong_choice(param: &ParamSpec, value: &Expr) -> Option<String> {
    let ExprKind::String(text) = &value.kind else { return None };
    let known = param.choices.is_empty() || param.choices.contains(&text.as_str());
    (!known).then(|| format!("\"{text}\" is no {} that velour knows", param.name))
}

/// Does an expression name a variable or a part of one?
fn is_place(expr: &ast::Expr) -> bool {
    match &expr.kind {
        ast::ExprKind::Name(_) => true,
        ast::ExprKind::Index(base, _) | ast::ExprKind::Field(base, _) => is_place(base),
        _ => false,
    }
}

/// The kinds of noise that have names.
pub(crate) const NOISES: &[&str] =
    &["perlin", "snoise", "uperlin", "noise", "simplex", "usimplex", "cell", "hash", "gabor"];

/// The options of `texture` and `environment`.
pub(crate) const TEXTURE_OPTIONS: &[&str] = &[
    "alpha",
    "blur",
    "colorspace",
    "errormessage",
    "fill",
    "firstchannel",
    "interp",
    "missingalpha",
    "missingcolor",
    "rblur",
    "rwidth",
    "rwrap",
    "sblur",
    "subimage",
    "swidth",
    "swrap",
    "tblur",
    "time",
    "twidth",
    "twrap",
    "width",
    "wrap",
];

/// Does the function write the value of an option?
fn is_written(function: &str, option: &str) -> bool {
    matches!(function, "texture" | "environment" | "texture3d") && matches!(option, "alpha" | "errormessage")
}

/// True for a literal of this value.
fn is_literally(value: &Expr, wanted: f32) -> bool {
    match value.kind {
        ExprKind::Int(given) => given as f32 == wanted,
        ExprKind::Float(given) => given == wanted,
        _ => false,
    }
}
