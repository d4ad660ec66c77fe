//! Writes that are watched for what is no finite number, where the host asks for it.
//!
//! Decision (2026-11-29): what is assigned to a variable is looked at, once an assignment, in the program as it is optimised; instead of after
//! every instruction, as OSL does, because results between have no name that a user could look for, and a number that is not finite
//! comes to a variable before it does harm, or does none.

use super::state::Lower;
use super::value::Value;
use crate::check::typed::{Expr, ExprKind, VarId};
use crate::ir::program::Kind;
use crate::ir::routine::{Routine, Watch};
use velour_grammar::Span;
use velour_grammar::ast::{BinaryOp, UnaryOp};

impl Lower<'_> {
    /// Looks at what a variable is given, if that is wanted.
    pub(super) fn watch(&mut self, var: VarId, value: &Value, operation: &'static str, span: Span) {
        if !self.shared.options.watch {
            return;
        }
        match value {
            Value::Struct(fields) => fields.iter().for_each(|field| self.watch(var, field, operation, span)),
            // What fills an array comes from variables, or through an assignment to an element.
            Value::Array { .. } => {}
            Value::Regs(_) | Value::Item { .. } => {
                let regs = self.regs(value);
                let floats = regs.iter().all(|&reg| self.b.program.kind(reg) == Kind::Float);
                if floats && !regs.is_empty() {
                    let variable = self.shader.variables[var.0 as usize].name.to_string();
                    let watch = Watch { variable, operation, count: regs.len() as u32 };
                    self.at(span);
                    self.b.call(Routine::CheckFinite(Box::new(watch)), regs, self.span);
                }
            }
        }
    }
}

/// What computes a value last, by the names that OSL gives to operations.
pub(super) fn operation(expr: &Expr) -> &'static str {
    match &expr.kind {
        ExprKind::Convert(inner) => operation(inner),
        ExprKind::Builtin(name, _) => name,
        ExprKind::Binary(op, ..) | ExprKind::Update(op, ..) => binary(*op),
        ExprKind::Unary(UnaryOp::Neg, _) => "neg",
        ExprKind::Call(..) => "functioncall",
        ExprKind::Index(..) | ExprKind::MatrixElement(..) => "compref",
        _ => "assign",
    }
}

/// The name of an operator.
pub(super) fn binary(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::Add => "add",
        BinaryOp::Sub => "sub",
        BinaryOp::Mul => "mul",
        BinaryOp::Div => "div",
        BinaryOp::Mod => "mod",
        // The others give ints.
        _ => "assign",
    }
}
