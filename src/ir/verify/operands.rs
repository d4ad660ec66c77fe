//! The operands of instructions: their kinds, how many there are, and which of them differ from lane to lane.

use super::{Problem, Walk};
use crate::ir::op::*;
use crate::ir::program::*;
use crate::lang::closures::{ClosureId, ParamKind, ParamSpec};
use crate::lang::types::Base;

/// The registers of a closure's parameter.
fn param(spec: &ParamSpec) -> (Kind, u32) {
    match spec.kind {
        ParamKind::Float => (Kind::Float, 1),
        ParamKind::Int => (Kind::Int, 1),
        ParamKind::Color | ParamKind::Vector | ParamKind::Normal => (Kind::Float, 3),
        ParamKind::String => (Kind::String, 1),
        ParamKind::Closure => (Kind::Closure, 1),
    }
}

/// The registers of a value of a base type.
fn base(base: Base) -> (Kind, u32) {
    let kind = match base {
        Base::Int => Kind::Int,
        Base::String => Kind::String,
        Base::Closure => Kind::Closure,
        Base::Void | Base::Float | Base::Color | Base::Point | Base::Vector | Base::Normal | Base::Matrix => {
            Kind::Float
        }
    };
    (kind, base.components() as u32)
}

impl Walk<'_> {
    fn all(&self, regs: &[Reg], wanted: Kind) -> Result<(), Problem> {
        regs.iter().try_for_each(|&reg| self.kind(reg, wanted))
    }

    /// Registers that have to be of the kinds listed.
    fn listed(&self, of: &'static str, regs: &[Reg], kinds: &Kinds) -> Result<(), Problem> {
        let (given, wanted) = (regs.len(), width(kinds));
        if given != wanted {
            return Err(Problem::WrongCount { of, given, wanted });
        }
        regs.iter().zip(each(kinds)).try_for_each(|(&reg, kind)| self.kind(reg, kind))
    }

    fn kind_of(&self, reg: Reg) -> Result<Kind, Problem> {
        self.program.regs.get(reg.0 as usize).map(|info| info.kind).ok_or(Problem::NoRegister(reg))
    }

    /// A kind that may not be a closure.
    fn number(&self, reg: Reg) -> Result<Kind, Problem> {
        match self.kind_of(reg)? {
            Kind::Closure => Err(Problem::WrongKind { holds: Kind::Closure, wanted: Kind::Float }),
            kind @ (Kind::Float | Kind::Int | Kind::String) => Ok(kind),
        }
    }

    pub(super) fn operands(&self, instr: &Instr) -> Result<(), Problem> {
        use Kind::{Closure, Float, Int};
        match instr {
            Instr::Unary(_, d, a) | Instr::Derivative(d, a, _) => self.all(&[*d, *a], Float),
            Instr::Binary(_, d, a, b) => self.all(&[*d, *a, *b], Float),
            Instr::Fused(op, ..) if !op.has_loop() => Err(Problem::NoPair(*op)),
            Instr::Fused(_, d, [a, b, c]) => self.all(&[*d, *a, *b, *c], Float),
            Instr::Compare(_, d, a, b) => self.all(&[*a, *b], Float).and(self.kind(*d, Int)),
            Instr::Test(_, d, a) | Instr::FloatToInt(d, a) => self.kind(*a, Float).and(self.kind(*d, Int)),
            Instr::IntToFloat(d, a) => self.kind(*a, Int).and(self.kind(*d, Float)),
            Instr::IntUnary(_, d, a) => self.all(&[*d, *a], Int),
            Instr::IntBinary(op, d, a, b) => self.int_binary(*op, *d, *a, *b),
            Instr::Select(d, c, a, b) => {
                let kind = self.number(*d)?;
                self.kind(*c, Int).and(self.all(&[*a, *b], kind))
            }
            Instr::Move { dst, src, .. } if dst == src => Err(Problem::MovedToItself(*dst)),
            Instr::Move { dst, src, .. } => self.kind(*src, self.kind_of(*dst)?),
            Instr::ArrayGet { dst, array, component, index, .. } => self.element(*array, *component, *index, *dst),
            Instr::ArraySet { array, component, index, src, .. } => self.element(*array, *component, *index, *src),
            Instr::Call { routine, dst, src, .. } => self.call(routine, dst, src),
            Instr::Leaf { dst, closure, params, keywords, .. } => {
                self.kind(*dst, Closure)?;
                self.leaf(*closure, params, keywords)
            }
            Instr::ClosureAdd(d, a, b) => self.all(&[*d, *a, *b], Closure),
            Instr::ClosureScale(d, a, w) => self.all(&[*d, *a], Closure).and(self.all(w, Float)),
            Instr::ClosureAbsent(d, a) => self.kind(*a, Closure).and(self.kind(*d, Int)),
            Instr::ClosureSelect(d, c, a, b) => self.kind(*c, Int).and(self.all(&[*d, *a, *b], Closure)),
        }
    }

    /// Of strings it can only be asked whether they are the same.
    fn int_binary(&self, op: IntBinary, d: Reg, a: Reg, b: Reg) -> Result<(), Problem> {
        let strings = matches!(op, IntBinary::Eq | IntBinary::Ne) && self.kind_of(a)? == Kind::String;
        let wanted = if strings { Kind::String } else { Kind::Int };
        self.kind(d, Kind::Int).and(self.all(&[a, b], wanted))
    }

    fn element(&self, array: ArrayId, component: u32, index: Reg, value: Reg) -> Result<(), Problem> {
        let info = self.array(array)?;
        if component >= info.components {
            return Err(Problem::NoComponent(array, component));
        }
        self.kind(index, Kind::Int).and(self.kind(value, info.kind))
    }

    fn call(&self, routine: &Routine, dst: &[Reg], src: &[Reg]) -> Result<(), Problem> {
        if !routine.exists() {
            return Err(Problem::NoRoutine(routine.name()));
        }
        let Declaration { takes, gives, .. } = routine.declaration();
        self.listed("sources", src, &takes)?;
        self.listed("results", dst, &gives)
    }

    fn leaf(&self, closure: ClosureId, params: &[Reg], keywords: &[(u32, Vec<Reg>)]) -> Result<(), Problem> {
        let spec = self.table.specs.get(closure.0 as usize).ok_or(Problem::NoClosure(closure))?;
        self.listed("parameters", params, &spec.params.iter().map(param).collect())?;
        for (at, regs) in keywords {
            let keyword = spec.keywords.get(*at as usize).ok_or(Problem::NoKeyword(closure, *at))?;
            self.listed("numbers of a keyword parameter", regs, &std::iter::once(param(keyword)).collect())?;
        }
        Ok(())
    }

    pub(super) fn output(&self, output: &Output) -> Result<(), Problem> {
        let (kind, count) = output.ty.element_type().base().map_or((Kind::Float, 0), base);
        match &output.value {
            OutputValue::Regs(regs) => {
                regs.iter().try_for_each(|&reg| self.read(reg))?;
                self.listed("numbers", regs, &std::iter::once((kind, count)).collect())
            }
            OutputValue::Array(id) => {
                let info = self.array(*id)?;
                if info.kind != kind {
                    return Err(Problem::WrongKind { holds: info.kind, wanted: kind });
                }
                let (given, wanted) = (info.components as usize, count as usize);
                let fits = given == wanted;
                if fits { Ok(()) } else { Err(Problem::WrongCount { of: "components", given, wanted }) }
            }
        }
    }

    /// One number can only stand for all lanes when it is made of such.
    pub(super) fn uniform(&self, instr: &Instr) -> Result<(), Problem> {
        let is_uniform = |reg: Reg| self.program.regs.get(reg.0 as usize).is_some_and(|info| info.uniform);
        let mut varies = false;
        instr.reads(|reg| varies |= !is_uniform(reg));
        let mut alike = true;
        match instr {
            Instr::ArraySet { array, masked, .. } => {
                let varies = varies || *masked;
                let uniform = self.array(*array)?.uniform;
                return if varies && uniform { Err(Problem::VariesInArray(*array)) } else { Ok(()) };
            }
            Instr::ArrayGet { array, .. } => varies |= !self.array(*array)?.uniform,
            Instr::Move { masked, .. } => varies |= masked,
            Instr::Call { routine, dst, .. } => {
                varies |= routine.declaration().reach == Reach::Lane;
                alike = dst.windows(2).all(|pair| is_uniform(pair[0]) == is_uniform(pair[1]));
            }
            Instr::Unary(..) | Instr::Binary(..) | Instr::Fused(..) | Instr::Compare(..) | Instr::Test(..) => {}
            Instr::IntUnary(..) | Instr::IntBinary(..) | Instr::IntToFloat(..) | Instr::FloatToInt(..) => {}
            Instr::Select(..) | Instr::Derivative(..) | Instr::Leaf { .. } | Instr::ClosureAdd(..) => {}
            Instr::ClosureScale(..) | Instr::ClosureSelect(..) | Instr::ClosureAbsent(..) => {}
        }
        if !alike {
            return Err(Problem::PartlyUniform);
        }
        let mut found = Ok(());
        instr.writes(|reg| {
            if varies && is_uniform(reg) {
                found = Err(Problem::Varies(reg));
            }
        });
        found
    }
}
