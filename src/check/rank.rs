//! Ranking of overloads: how well arguments fit what a call may mean.
//!
//! Overloads are ranked as OSL ranks them: an exact argument counts most, then int to float, array length, triple to
//! triple, and any other conversion; the sums are compared, and a tie goes to the best return type.

use super::candidate::{Candidate, param_type};
use super::context::Checker;
use super::convert::{assignable, equivalent, is_number};
use super::typed::{Argument, Expr, ExprKind};
use crate::lang::builtins::{self, Formal, Signature};
use crate::lang::closures::ClosureSpec;
use crate::lang::types::{Base, Length, Type};
use velour_grammar::{Severity, ast};

impl Checker<'_> {
    /// How well arguments fit a candidate; nothing when they do not.
    pub(super) fn score(&mut self, candidate: &Candidate, lists: &[ast::Expr], args: &[Expr]) -> Option<u32> {
        let formals = match candidate {
            Candidate::User(id) => {
                let formals = &self.signatures[id.0 as usize].formals;
                if formals.len() != args.len() {
                    return None;
                }
                formals.clone()
            }
            // Closures are given by nobody but other shaders.
            Candidate::Builtin(name, signature) if *name != "getmessage" && writes_closure(signature, args) => {
                return None;
            }
            Candidate::Builtin(_, signature) => {
                return score_builtin(signature, args).filter(|_| self.lists_fit_builtin(signature, lists));
            }
            Candidate::Closure(id) => return score_closure(self.closures.get(*id), args),
        };
        // An empty argument list fits exactly; one more keeps it above "no score".
        let mut sum = 1;
        for (((ty, output), arg), list) in formals.iter().zip(args).zip(lists) {
            // The function works on the caller's own variable, which no conversion can stand in for.
            if *output && !same_storage(ty, &arg.ty) {
                return None;
            }
            sum += score_argument(ty, arg)?;
            if matches!(list.kind, ast::ExprKind::InitList(_)) && !self.list_fits(list, ty) {
                return None;
            }
        }
        Some(sum)
    }

    fn lists_fit_builtin(&mut self, signature: &Signature, args: &[ast::Expr]) -> bool {
        signature.formals.iter().zip(args).all(|((formal, _), arg)| match (formal, &arg.kind) {
            (Formal::Type(ty), ast::ExprKind::InitList(_)) => self.list_fits(arg, ty),
            (_, ast::ExprKind::InitList(_)) => false,
            _ => true,
        })
    }

    /// Tries an initialiser list for a type and takes back whatever was said about it. A list that leaves parts out fits
    /// none of several candidates: it would fit too many.
    fn list_fits(&mut self, list: &ast::Expr, ty: &Type) -> bool {
        let ast::ExprKind::InitList(items) = &list.kind else { return false };
        let wanted = match ty.structure() {
            Some(structure) if !ty.is_array() => structure.fields.len(),
            _ if ty.length == Length::Unsized => items.len(),
            _ if ty.is_array() => ty.count(),
            _ => ty.base().map_or(1, |base| base.components().max(1)),
        };
        if items.len() != wanted {
            return false;
        }
        let said = self.diagnostics.list.len();
        self.check_initial(list, &mut ty.clone());
        let fits = self.diagnostics.list[said..].iter().all(|d| d.severity == Severity::Warning);
        self.diagnostics.list.truncate(said);
        fits
    }
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
pub(super) fn score_type(formal: &Type, actual: &Type) -> Option<u32> {
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
            _ if *output && !holds_values(&arg.ty) => return None,
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

/// Would a builtin that writes any type write a closure?
fn writes_closure(signature: &Signature, args: &[Expr]) -> bool {
    let written = signature
        .formals
        .iter()
        .zip(args)
        .filter(|((formal, output), _)| *output && !matches!(formal, Formal::Type(_)));
    written.map(|(_, arg)| arg).any(|arg| arg.ty.element_type().base() == Some(Base::Closure))
}

/// Can a builtin that writes any type write this one? Structs are not among what it gives.
fn holds_values(ty: &Type) -> bool {
    ty.element_type().base().is_some_and(|base| base != Base::Void)
}

/// May a function that writes a `formal` work on a variable of type `actual` itself?
pub(super) fn same_storage(formal: &Type, actual: &Type) -> bool {
    let open = formal.length == Length::Unsized && actual.is_array() && formal.element == actual.element;
    open || equivalent(formal, actual)
}

/// The call of a builtin, by the overload that gives `expected` when one of the same parameters does so better. The
/// arguments stay as they were checked.
pub(super) fn better_overload(mut call: Expr, expected: &Type) -> Expr {
    let ExprKind::Builtin(name, arguments) = &call.kind else { return call };
    let same = |(formal, actual): (&(Formal, bool), &Argument)| match &formal.0 {
        Formal::Type(ty) => same_storage(ty, actual.ty()),
        Formal::Any => !actual.ty().is_array(),
        Formal::AnyArray => actual.ty().is_array(),
    };
    let fits = |s: &&Signature| {
        let more = s.variadic || s.options;
        let counts = s.formals.len() == arguments.len() || (more && s.formals.len() < arguments.len());
        counts && s.formals.iter().zip(arguments).all(same)
    };
    let score = |ty: &Type| (score_type(expected, ty).unwrap_or(0), std::cmp::Reverse(rank_type(ty)));
    let others = builtins::signatures(name).unwrap_or_default().iter().filter(fits);
    let best = others.map(|s| &s.returns).max_by_key(|ty| score(ty));
    if let Some(best) = best.filter(|best| score(best) > score(&call.ty)) {
        call.ty = best.clone();
    }
    call
}

/// The place of a return type in the order that decides a tie.
pub(super) fn rank_type(ty: &Type) -> u32 {
    match ty.base() {
        Some(Base::Float) => 0,
        Some(Base::Int) => 1,
        Some(Base::Color) => 2,
        Some(Base::Vector) => 3,
        Some(Base::Point) => 4,
        Some(Base::Normal) => 5,
        Some(Base::Matrix) => 6,
        Some(Base::String) => 7,
        Some(Base::Closure) => 8,
        Some(Base::Void) => 10,
        None => 9,
    }
}
