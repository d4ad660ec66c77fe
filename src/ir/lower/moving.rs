//! `bump` and `displace`: the functions that move the surface, or make it look moved.
//!
//! Decision (2026-11-29): the new normal is the old one turned as much as the geometric normal turns, normalize(N + (n' - n)) with n the
//! normal of P's derivatives and n' that of the moved P's, because on a mesh whose normals are interpolated the normal of the moved
//! points alone shows every facet; instead of calculatenormal(P), which is the same where N is geometric.

use super::state::Lower;
use super::value::Value;
use crate::check::typed::{Argument, Expr, VarId};
use crate::ir::op::{Binary, Compare};
use crate::ir::program::Reg;
use crate::lang::globals::Global;
use crate::lang::types::Base;

impl Lower<'_> {
    /// `bump(amount)`, `bump(space, amount)`, `bump(offset)`, and `displace` of the same, which moves P as well.
    pub(super) fn move_surface(&mut self, name: &str, args: &[Argument], call: &Expr) -> Value {
        let values = self.arguments(args);
        self.at(call.span);
        let (p_var, n_var) = (self.global_var(Global::P), self.global_var(Global::N));
        let (p, n) = (self.global_regs(p_var), self.global_regs(n_var));
        let amount = args.last().and_then(|arg| arg.ty().base());
        let offset = match (&values[..], amount) {
            ([offset], Some(base)) if base != Base::Float => offset.clone(),
            ([amount], _) => self.along(&n, amount[0]),
            ([space, amount], _) => {
                // The amount is a length in the space, along the normal there.
                let common = self.symbol("common");
                let (there, _) = self.space_matrix(common, space[0]);
                let turned = self.transformed(&there, &n, Base::Vector);
                let length = self.length(&turned);
                let scaled = self.b.binary(Binary::Div, amount[0], length);
                self.along(&n, scaled)
            }
            _ => return Value::Regs(Vec::new()),
        };
        let moved = self.each(&p, &offset, |l, a, b| l.b.binary(Binary::Add, a, b));
        let (before, after) = (self.unit_normal(&p), self.unit_normal(&moved));
        // The derivatives make a left-handed normal where the pixel's axes are so seen; the sides of both agree.
        let turn = self.each(&after, &before, |l, a, b| l.b.binary(Binary::Sub, a, b));
        let side = self.dot(&before, &n);
        let zero = self.b.float(0.0);
        let (one, minus) = (self.b.float(1.0), self.b.float(-1.0));
        let same = self.b.compare(Compare::Ge, side, zero);
        let sign = self.b.select(same, one, minus);
        let turn: Vec<Reg> = turn.iter().map(|&c| self.b.binary(Binary::Mul, c, sign)).collect();
        let normal = self.each(&n, &turn, |l, a, b| l.b.binary(Binary::Add, a, b));
        let normal = self.normalize(&normal);
        self.set_global(n_var, normal);
        if name == "displace" {
            self.set_global(p_var, moved);
        }
        Value::Regs(Vec::new())
    }

    fn along(&mut self, n: &[Reg], amount: Reg) -> Vec<Reg> {
        n.iter().map(|&c| self.b.binary(Binary::Mul, c, amount)).collect()
    }

    fn unit_normal(&mut self, p: &[Reg]) -> Vec<Reg> {
        let normal = self.calculate_normal(p);
        self.normalize(&normal)
    }

    fn global_regs(&mut self, var: VarId) -> Vec<Reg> {
        let value = self.variable(var);
        let value = self.stable(&value);
        self.regs(&value)
    }

    fn set_global(&mut self, var: VarId, regs: Vec<Reg>) {
        let target = self.variable_target(var);
        self.write(&target, &Value::Regs(regs));
    }
}
