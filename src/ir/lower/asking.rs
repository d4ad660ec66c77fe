//! Builtin functions that ask or tell somebody outside the shader: messages, rays, dictionaries, numbers by chance; and those that
//! velour answers for by "there is none".

use super::operand::Given;
use super::place::Target;
use super::state::Lower;
use super::value::Value;
use crate::check::typed::{Argument, Expr, ExprKind};
use crate::ir::op::{AttributeOf, AttributeType, MessageShape, Routine};
use crate::ir::program::{Kind, Reg};
use crate::lang::types::{Base, Type};

impl Lower<'_> {
    /// A call of one of these functions, or nothing for any other.
    pub(super) fn asking_call(&mut self, name: &str, args: &[Argument], call: &Expr) -> Option<Value> {
        Some(match name {
            "setmessage" => self.set_message(args, call),
            "getmessage" => self.get_message(args, call),
            "random" => {
                self.at(call.span);
                let count = call.ty.base().map_or(1, Base::floats) as u32;
                Value::Regs(self.b.call(Routine::Random(count), Vec::new(), self.span))
            }
            "trace" => self.trace(args, call),
            "dict_find" => {
                let values = self.arguments(args);
                self.at(call.span);
                let text = args[0].ty().base() == Some(Base::String);
                let src = values.concat();
                let routine = if text { Routine::DictFind } else { Routine::DictFindBelow };
                Value::Regs(self.b.call(routine, src, self.span))
            }
            "dict_next" => {
                let values = self.arguments(args);
                self.at(call.span);
                Value::Regs(self.b.call(Routine::DictNext, values.concat(), self.span))
            }
            "dict_value" => self.dict_value(args, call),
            "pointcloud_search" | "pointcloud_get" | "pointcloud_write" => {
                // The arguments' own effects happen; there is no cloud.
                self.given(args);
                Value::Regs(vec![self.b.int(0)])
            }
            "texture3d" => {
                self.given(args);
                let zero = self.b.float(0.0);
                Value::Regs(vec![zero; call.ty.base().map_or(1, Base::floats)])
            }
            _ => return None,
        })
    }

    /// What a value is made of, and its type's name for messages about it.
    fn shape(&mut self, value: &Value, ty: &Type) -> (Vec<Reg>, MessageShape) {
        let regs = self.flat_regs(value);
        let kind = regs.first().map_or(Kind::Int, |&reg| self.b.program.kind(reg));
        let shape = MessageShape { kind, count: regs.len() as u32, ty: ty.to_string() };
        (regs, shape)
    }

    fn set_message(&mut self, args: &[Argument], call: &Expr) -> Value {
        let exprs: Vec<&Expr> = args.iter().filter_map(Argument::read).collect();
        let values = self.operands(&exprs);
        self.at(call.span);
        let (regs, shape) = self.shape(&values[1], &exprs[1].ty);
        let mut src = self.regs(&values[0]);
        src.extend(regs);
        self.b.call(Routine::SetMessage(shape), src, self.span);
        Value::Regs(Vec::new())
    }

    fn get_message(&mut self, args: &[Argument], call: &Expr) -> Value {
        let (strings, out) = self.asked(args);
        self.at(call.span);
        let Some(out) = out else { return Value::Regs(vec![self.b.int(0)]) };
        // A message of a named source, such as the last ray, is the host's.
        if let [source, name] = strings[..] {
            let found = self.attribute_of(AttributeOf::Message, &out, vec![source, name]);
            return Value::Regs(vec![found]);
        }
        let old = self.load(&out);
        let ty = args.iter().find(|arg| matches!(arg, Argument::Out(_))).map_or(Type::INT, |arg| arg.ty().clone());
        let (old, shape) = self.shape(&old, &ty);
        let results = self.b.call(Routine::GetMessage(shape), strings, self.span);
        self.take_found(&out, &old, &results);
        Value::Regs(vec![results[0]])
    }

    /// The registers of what is read only, and the place that is written.
    pub(super) fn asked(&mut self, args: &[Argument]) -> (Vec<Reg>, Option<Target>) {
        let (mut read, mut out) = (Vec::new(), None);
        for given in self.given(args) {
            match given {
                Given::In(value) => read.extend(self.regs(&value)),
                Given::Out(target) => out = Some(target),
            }
        }
        (read, out)
    }

    /// Writes what was found, and leaves what was there where nothing was.
    fn take_found(&mut self, out: &Target, old: &[Reg], results: &[Reg]) {
        let new = self.found_or(results, old);
        self.write_flat(out, &new);
    }

    /// The values behind the first of some results where that says that they were found, else others.
    pub(super) fn found_or(&mut self, results: &[Reg], old: &[Reg]) -> Vec<Reg> {
        results[1..].iter().zip(old).map(|(&new, &old)| self.b.select(results[0], new, old)).collect()
    }

    /// Asks for a value of the type of a place, and writes it there where it is found; gives whether it is.
    pub(super) fn ask(&mut self, out: &Target, src: Vec<Reg>, routine: impl FnOnce(AttributeType) -> Routine) -> Reg {
        let old = self.load(out);
        let old = self.flat_regs(&old);
        let results = self.b.call(routine(self.attribute_type(&old)), src, self.span);
        self.take_found(out, &old, &results);
        results[0]
    }

    fn dict_value(&mut self, args: &[Argument], call: &Expr) -> Value {
        let (read, out) = self.asked(args);
        self.at(call.span);
        let Some(out) = out else { return Value::Regs(vec![self.b.int(0)]) };
        Value::Regs(vec![self.ask(&out, read, Routine::DictValue)])
    }

    /// `trace(from, direction, "mindist", …)`: of the options those that limit the ray are passed on.
    fn trace(&mut self, args: &[Argument], call: &Expr) -> Value {
        let exprs: Vec<&Expr> = args.iter().filter_map(Argument::read).collect();
        let values: Vec<Vec<Reg>> = self.operands(&exprs).iter().map(|value| self.regs(value)).collect();
        self.at(call.span);
        let (mut least, mut most) = (self.b.float(0.0), self.b.float(1e30));
        for (option, given) in exprs[2..].chunks_exact(2).zip(values[2..].chunks_exact(2)) {
            let ExprKind::String(name) = &option[0].kind else { continue };
            match (name.as_str(), given[1].first()) {
                ("mindist", Some(&reg)) if self.b.program.kind(reg) == Kind::Float => least = reg,
                ("maxdist", Some(&reg)) if self.b.program.kind(reg) == Kind::Float => most = reg,
                _ => {}
            }
        }
        let src = values[0].iter().chain(&values[1]).copied().chain([least, most]).collect();
        Value::Regs(self.b.call(Routine::Trace, src, self.span))
    }

    /// The type that registers are asked for as.
    pub(super) fn attribute_type(&self, regs: &[Reg]) -> AttributeType {
        let count = regs.len() as u32;
        match regs.first().map_or(Kind::Int, |&reg| self.b.program.kind(reg)) {
            Kind::Float => AttributeType::Floats(count),
            Kind::String => AttributeType::Strings(count),
            Kind::Int | Kind::Closure => AttributeType::Ints(count),
        }
    }
}
