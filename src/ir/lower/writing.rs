//! Builtin functions that write some of their arguments.

use super::operand::Given;
use super::place::Target;
use super::state::Lower;
use super::value::Value;
use crate::check::typed::{Argument, Expr};
use crate::ir::op::{AttributeOf, AttributeQuery, AttributeType, Routine, Unary};
use crate::ir::program::Reg;
use crate::lang::symbols::Symbol;
use crate::lang::types::Type;

impl Lower<'_> {
    pub(super) fn writing_call(&mut self, name: &str, args: &[Argument], call: &Expr) -> Value {
        let (mut inputs, mut outputs) = (Vec::new(), Vec::new());
        for given in self.given(args) {
            match given {
                Given::In(value) => inputs.push(self.regs(&value)),
                Given::Out(target) => outputs.push(target),
            }
        }
        self.at(call.span);
        let strings = args.iter().filter(|arg| arg.ty() == &Type::STRING && matches!(arg, Argument::In(_))).count();
        let found = match name {
            "sincos" => {
                let results = [Unary::Sin, Unary::Cos].map(|op| {
                    let regs = inputs[0].iter().map(|&reg| self.b.unary(op, reg));
                    Value::Regs(regs.collect())
                });
                for (target, value) in outputs.iter().zip(&results) {
                    self.write(target, value);
                }
                return Value::Regs(Vec::new());
            }
            "getmatrix" => {
                let (matrix, found) = self.space_matrix(inputs[0][0], inputs[1][0]);
                self.write(&outputs[0], &Value::Regs(matrix));
                found
            }
            "getattribute" => self.attribute(&outputs[0], strings, inputs.concat()),
            "split" => self.split(&outputs[0], inputs.concat()),
            _ => self.regex(name == "regex_match", outputs.first(), inputs.concat()),
        };
        Value::Regs(vec![found])
    }

    /// The registers of a value, element by element when it is an array.
    pub(super) fn flat_regs(&mut self, value: &Value) -> Vec<Reg> {
        if !matches!(value, Value::Array { .. }) {
            return self.regs(value);
        }
        self.elements(value).iter().flat_map(|element| self.regs(element)).collect()
    }

    fn attribute(&mut self, out: &Target, strings: usize, mut inputs: Vec<Reg>) -> Reg {
        if strings == 1 {
            let object = self.symbol("");
            inputs.insert(0, object);
        }
        if let Some(known) = self.own_name(inputs[1]).filter(|_| strings == 1 && inputs.len() == 2) {
            let old = self.load(out);
            let old = self.flat_regs(&old);
            if matches!(self.attribute_type(&old), AttributeType::Strings(1)) {
                let name = self.symbol(&known);
                self.write_flat(out, &[name]);
                return self.b.int(1);
            }
        }
        self.attribute_of(AttributeOf::Attribute, out, inputs)
    }

    /// The name that a shader asks for of itself, its layer or its group.
    fn own_name(&self, asked: Reg) -> Option<String> {
        let asked = Symbol(self.b.known_int(asked)?);
        Some(match asked.text() {
            "shader:shadername" => self.shader.name.clone(),
            "shader:layername" => self.shared.layers[self.layer as usize].name.clone(),
            "shader:groupname" => self.shared.group_name.clone(),
            _ => return None,
        })
    }

    /// Asks the host for a value of the type of a place, and writes it there where it is found.
    pub(super) fn attribute_of(&mut self, of: AttributeOf, out: &Target, inputs: Vec<Reg>) -> Reg {
        let indexed = inputs.len() > 2;
        self.ask(out, inputs, |ty| Routine::Attribute(AttributeQuery { ty, slopes: false, of, indexed }))
    }

    /// Writes registers to an output argument, element by element when it is an array.
    pub(super) fn write_flat(&mut self, out: &Target, regs: &[Reg]) {
        let old = self.load(out);
        if !matches!(old, Value::Array { .. }) {
            return self.write(out, &Value::Regs(regs.to_vec()));
        }
        let elements = self.elements(&old);
        let width = regs.len() / elements.len().max(1);
        for (element, part) in elements.iter().zip(regs.chunks(width.max(1))) {
            self.store(element, &Value::Regs(part.to_vec()));
        }
    }

    fn regex(&mut self, whole: bool, positions: Option<&Target>, inputs: Vec<Reg>) -> Reg {
        let positions_count = positions.map_or(0, |target| self.load(target).count()) as u32;
        let results = self.b.call(Routine::Regex { whole, positions: positions_count }, inputs, self.span);
        if let Some(target) = positions {
            self.write_flat(target, &results[1..]);
        }
        results[0]
    }

    fn split(&mut self, out: &Target, mut inputs: Vec<Reg>) -> Reg {
        let count = self.load(out).count();
        if inputs.len() < 2 {
            let spaces = self.symbol("");
            inputs.push(spaces);
        }
        if inputs.len() < 3 {
            let most = self.b.int(count as i32);
            inputs.push(most);
        }
        let results = self.b.call(Routine::Split(count as u32), inputs, self.span);
        self.write_flat(out, &results[1..]);
        results[0]
    }
}
