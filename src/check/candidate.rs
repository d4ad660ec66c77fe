//! What a call of a name may mean: functions, builtins and closures that are visible, and how each presents itself.

use super::context::Checker;
use super::notes::Meaning;
use super::typed::FunctionId;
use crate::lang::builtins::{self, Formal};
use crate::lang::closures::{ClosureId, ParamKind};
use crate::lang::types::{Base, Type};
use velour_grammar::Span;

/// Something a call may mean.
#[derive(Clone)]
pub(super) enum Candidate {
    User(FunctionId),
    Builtin(&'static str, &'static builtins::Signature),
    Closure(ClosureId),
}

impl Candidate {
    /// What its name stands for.
    pub(super) fn meaning(&self) -> Meaning {
        match self {
            Candidate::User(id) => Meaning::Function(*id),
            Candidate::Builtin(name, _) => Meaning::Builtin(name),
            Candidate::Closure(id) => Meaning::Closure(*id),
        }
    }
}

impl Checker<'_> {
    /// What a call of this name means when nothing is known of its arguments.
    pub(super) fn nearest_meaning(&self, name: &str) -> Option<Meaning> {
        let function = self.functions_named(name).first().map(|id| Meaning::Function(*id));
        let builtin = || builtins::static_name(name).map(Meaning::Builtin);
        let closure = || self.closures.named(name).next().map(|(id, _)| Meaning::Closure(id));
        function.or_else(builtin).or_else(closure)
    }

    /// What a call of this name may mean. A function hides builtins and outer functions of the same parameters; inside
    /// its own body it stands back for them, so that it can build on what it replaces.
    pub(super) fn candidates(&self, name: &str) -> Vec<Candidate> {
        let mut users = self.functions_named(name);
        let mut all = self.visible(name, &users);
        if let Some(own) = self.inside.filter(|own| users.contains(own)) {
            users.retain(|id| *id != own);
            let others = self.visible(name, &users);
            let hidden = self.formals_text(&Candidate::User(own));
            if others.iter().any(|other| self.formals_text(other) == hidden) {
                all = others;
            }
        }
        all
    }

    fn visible(&self, name: &str, users: &[FunctionId]) -> Vec<Candidate> {
        let alone = users.is_empty();
        let users = users.iter().copied().map(Candidate::User);
        let builtin = builtins::static_name(name).unwrap_or_default();
        let builtins = builtins::signatures(name).unwrap_or_default().iter().map(|s| Candidate::Builtin(builtin, s));
        let closures = self.closures.named(name).map(|(id, _)| Candidate::Closure(id));
        let everything = users.chain(builtins).chain(closures);
        if alone {
            return everything.collect();
        }
        let mut all: Vec<Candidate> = Vec::new();
        let mut seen: Vec<(String, Option<Type>)> = Vec::new();
        for candidate in everything {
            let user = matches!(candidate, Candidate::User(_));
            let formals = self.formals_text(&candidate);
            // Overloads on the return type stand side by side; a builtin gives way to any function of its parameters.
            let returns = Some(self.returns_of(&candidate));
            let hidden = seen.iter().any(|(f, r)| *f == formals && (!user || *r == returns));
            if user {
                seen.push((formals, returns));
            }
            if !hidden {
                all.push(candidate);
            }
        }
        all
    }

    pub(super) fn span_of(&self, candidate: &Candidate) -> Option<Span> {
        match candidate {
            Candidate::User(id) => Some(self.signatures[id.0 as usize].span),
            _ => None,
        }
    }

    pub(super) fn returns_of(&self, candidate: &Candidate) -> Type {
        match candidate {
            Candidate::User(id) => self.signatures[id.0 as usize].returns.clone(),
            Candidate::Builtin(_, signature) => signature.returns.clone(),
            Candidate::Closure(_) => Type::CLOSURE,
        }
    }

    pub(super) fn formals_text(&self, candidate: &Candidate) -> String {
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
