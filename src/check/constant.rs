//! Constants: what an expression is where it can be told without running the shader, such as a default or an entry of metadata.

use super::typed::{Expr, ExprKind};
use crate::lang::types::{Base, Type};
use velour_grammar::ast::UnaryOp;

/// One part of a constant.
#[derive(Clone, Debug, PartialEq)]
pub enum Constant {
    /// An int.
    Int(i32),
    /// A float.
    Float(f32),
    /// A string.
    String(String),
}

impl Constant {
    /// The number that it is, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Constant::Int(x) => Some(f64::from(*x)),
            Constant::Float(x) => Some(f64::from(*x)),
            Constant::String(_) => None,
        }
    }
}

/// The parts of a constant expression, in order: a number, three of a triple, all elements of an array or a struct. Nothing where it
/// depends on anything. A triple in a named space begins with the name.
pub fn constants(value: &Expr) -> Option<Vec<Constant>> {
    let mut out = Vec::new();
    collect(value, &mut out)?;
    Some(out)
}

fn collect(value: &Expr, out: &mut Vec<Constant>) -> Option<()> {
    match &value.kind {
        ExprKind::Int(x) => out.push(Constant::Int(*x)),
        ExprKind::Float(x) => out.push(Constant::Float(*x)),
        ExprKind::String(x) => out.push(Constant::String(x.clone())),
        ExprKind::Convert(inner) => {
            let start = out.len();
            collect(inner, out)?;
            spread(&value.ty, start, out);
        }
        ExprKind::Unary(UnaryOp::Neg, inner) => {
            let start = out.len();
            collect(inner, out)?;
            for part in &mut out[start..] {
                match part {
                    Constant::Int(x) => *x = x.wrapping_neg(),
                    Constant::Float(x) => *x = -*x,
                    Constant::String(_) => {}
                }
            }
        }
        ExprKind::Construct(parts) | ExprKind::Aggregate(parts) => {
            let start = out.len();
            parts.iter().try_for_each(|part| collect(part, out))?;
            spread(&value.ty, start, out);
        }
        ExprKind::ConstructIn(space, parts) => {
            collect(space, out)?;
            parts.iter().try_for_each(|part| collect(part, out))?;
        }
        _ => return None,
    }
    Some(())
}

/// A float alone stands for all components of a triple, and for the diagonal of a matrix.
fn spread(ty: &Type, start: usize, out: &mut Vec<Constant>) {
    let components = ty.base().map_or(1, Base::components);
    if out.len() != start + 1 || components == 1 {
        return;
    }
    let zero = match &out[start] {
        Constant::Int(_) | Constant::String(_) => Constant::Int(0),
        Constant::Float(_) => Constant::Float(0.0),
    };
    let only = out[start].clone();
    let at = |i: usize| if components == 3 || i.is_multiple_of(5) { only.clone() } else { zero.clone() };
    out.truncate(start);
    out.extend((0..components).map(at));
}
