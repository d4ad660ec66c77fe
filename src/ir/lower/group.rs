//! The parameters of a layer: bound, fed by other layers, or defaulted.

use super::spec::{Binding, Layer};
use super::state::Lower;
use super::value::{Value, kind_of, zero_of};
use crate::check::typed::{ExprKind, ShaderParam, VarId};
use crate::ir::op::{AttributeOf, AttributeQuery, Routine};
use crate::ir::program::*;
use crate::lang::globals::Global;
use crate::lang::path::{Step, part, root, steps};
use crate::lang::symbols::Symbol;
use crate::lang::types::{Base, Element, Length, Type};
use std::collections::HashMap;

impl Lower<'_> {
    pub(super) fn global_var(&self, global: Global) -> VarId {
        let at = self.shader.variables.iter().position(|variable| variable.global == Some(global));
        VarId(at.unwrap_or(0) as u32)
    }

    /// Gives a parameter its value: what feeds it has run.
    pub(super) fn parameter(&mut self, param: &ShaderParam, layer: &Layer) {
        let var = param.var;
        let variable = &self.shader.variables[var.0 as usize];
        let (name, mut ty) = (variable.name.clone(), variable.ty.clone());
        let whole = layer.bindings.iter().rev().find(|(target, _)| *target == name);
        if let Some((_, binding)) = whole.filter(|_| param.open) {
            ty.length = Length::Fixed(self.given_length(binding, &ty).max(1));
        }
        let value = match whole {
            Some((_, binding)) => self.bound_value(binding, &ty),
            None => match &param.default {
                Some(default) => {
                    let value = self.expr(default);
                    self.owned(&value, &ty)
                }
                None => self.zero(&ty),
            },
        };
        let interpolated = self.interpolated(param, layer);
        if interpolated && self.shared.options.userdata_connects {
            self.connected.push(var);
        }
        let value = if interpolated { self.userdata(&name, value) } else { value };
        self.bind(var, value);
        for (target, binding) in
            layer.bindings.iter().filter(|(target, _)| *target != name && root(target) == name.as_str())
        {
            self.bind_part(var, &ty, target, binding);
        }
    }

    /// Does userdata of its name go before the value of a parameter? Not where an earlier layer feeds it; else as the group says,
    /// or the shader by its metadata.
    fn interpolated(&self, param: &ShaderParam, layer: &Layer) -> bool {
        let name = &self.shader.variables[param.var.0 as usize].name;
        if self.connected.contains(&param.var) {
            return false;
        }
        let said = layer.interpolated.iter().rev().find(|(named, _)| named == name);
        said.map_or_else(|| declared_interpolated(param), |&(_, yes)| yes)
    }

    /// The userdata of a name where the point has it, else the value.
    fn userdata(&mut self, name: &str, value: Value) -> Value {
        let Value::Regs(old) = &value else { return value };
        if old.first().is_none_or(|&reg| self.b.program.kind(reg) == Kind::Closure) {
            return value;
        }
        let query =
            AttributeQuery { ty: self.attribute_type(old), slopes: false, of: AttributeOf::Attribute, indexed: false };
        let asked = vec![self.symbol(""), self.symbol(name)];
        let results = self.b.call(Routine::Attribute(query), asked, self.span);
        let new = self.found_or(&results, old);
        Value::Regs(new)
    }

    /// How many elements a binding gives to a parameter that takes any number.
    fn given_length(&mut self, binding: &Binding, ty: &Type) -> u32 {
        let each = ty.element_type().base().map_or(1, Base::components).max(1);
        match binding {
            Binding::Numbers(numbers) => numbers.len().div_ceil(each) as u32,
            Binding::Strings(strings) => strings.len() as u32,
            Binding::Connection(layer, name) => {
                let found = self.output_of(*layer, name);
                found.map_or(1, |(value, _)| value.count() as u32)
            }
        }
    }

    /// Binds a part of a parameter, such as `.field` or `[2]`.
    fn bind_part(&mut self, var: VarId, ty: &Type, path: &str, binding: &Binding) {
        let Some(mut whole) = self.vars[var.0 as usize].clone() else { return };
        // Paths have been checked, but for the bounds of an array whose length another binding has set since.
        let steps = steps(path).unwrap_or_default();
        let inside = steps.iter().try_fold(ty.clone(), |ty, step| part(&ty, step));
        let Ok(of) = inside else { return };
        let new = self.bound_value(binding, &of);
        whole.value = self.with_part(&whole.value, ty, &steps, &new);
        self.vars[var.0 as usize] = Some(whole);
    }

    /// The value with the part that the steps lead to replaced. Elements of arrays are stored in place.
    fn with_part(&mut self, value: &Value, ty: &Type, steps: &[Step], new: &Value) -> Value {
        let Some((step, rest)) = steps.split_first() else { return self.replaced(value, new) };
        let Ok(inner) = part(ty, step) else { return value.clone() };
        match (value, step) {
            (Value::Struct(fields), Step::Field(name)) => {
                let position = ty.structure().and_then(|s| s.fields.iter().position(|(field, _)| field == name));
                let mut fields = fields.clone();
                if let Some(field) = position.and_then(|at| fields.get_mut(at)) {
                    *field = self.with_part(&field.clone(), &inner, rest, new);
                }
                Value::Struct(fields)
            }
            (_, Step::Index(at)) if ty.is_array() => {
                let index = self.b.int(*at as i32);
                let item = self.element(value, index);
                self.with_part(&item, &inner, rest, new);
                value.clone()
            }
            (Value::Regs(_) | Value::Item { .. }, Step::Index(at)) => {
                let (mut regs, new) = (self.regs(value), self.regs(new));
                if let (Some(slot), Some(&new)) = (regs.get_mut(*at as usize), new.first()) {
                    *slot = new;
                }
                let whole = Value::Regs(regs);
                if matches!(value, Value::Regs(_)) {
                    return whole;
                }
                self.store(value, &whole);
                value.clone()
            }
            _ => value.clone(),
        }
    }

    /// What stands for `value` once it is `new`: elements of arrays take it in, anything else gives way.
    fn replaced(&mut self, value: &Value, new: &Value) -> Value {
        match (value, new) {
            (Value::Struct(old), Value::Struct(new)) => {
                Value::Struct(old.iter().zip(new).map(|(old, new)| self.replaced(old, new)).collect())
            }
            (Value::Item { .. } | Value::Array { start: Some(_), .. }, _) => {
                self.store(value, new);
                value.clone()
            }
            _ => new.clone(),
        }
    }

    fn bound_value(&mut self, binding: &Binding, ty: &Type) -> Value {
        match binding {
            Binding::Numbers(_) | Binding::Strings(_) => self.constants(binding, ty, &mut 0),
            Binding::Connection(layer, name) => {
                let Some((value, from)) = self.output_of(*layer, name) else {
                    return self.zero(ty);
                };
                match (from.base(), ty.base()) {
                    (Some(a), Some(b)) => {
                        let regs = self.regs(&value);
                        let regs: Vec<Reg> = regs.into_iter().map(|reg| self.fixed(reg)).collect();
                        // A triple that feeds a number is averaged, as OSL does.
                        if a.is_triple() && b.is_number() {
                            let average = self.average(&regs);
                            return Value::Regs(self.convert(&[average], Base::Float, b));
                        }
                        Value::Regs(self.convert(&regs, a, b))
                    }
                    _ => self.owned(&value, ty),
                }
            }
        }
    }

    fn average(&mut self, regs: &[Reg]) -> Reg {
        let third = self.b.float(1.0 / 3.0);
        self.dot(regs, &[third; 3])
    }

    /// An output of an earlier layer by its path.
    fn output_of(&mut self, layer: usize, path: &str) -> Option<(Value, Type)> {
        let params = self.shared.finished.get(layer)?.clone()?;
        self.part_of(&params, path)
    }

    /// An output of an earlier layer, or a part of one.
    fn part_of(&mut self, params: &HashMap<String, (Value, Type)>, name: &str) -> Option<(Value, Type)> {
        let (mut value, mut ty) = params.get(root(name))?.clone();
        for step in steps(name)? {
            let inner = part(&ty, &step).ok()?;
            value = match (value, &step) {
                (Value::Struct(fields), Step::Field(field)) => {
                    let at = ty.structure()?.fields.iter().position(|(name, _)| name == field)?;
                    fields.get(at)?.clone()
                }
                (value, Step::Index(at)) if ty.is_array() => {
                    let index = self.b.int(*at as i32);
                    self.element(&value, index)
                }
                (value, Step::Index(at)) => Value::Regs(vec![*self.regs(&value).get(*at as usize)?]),
                _ => return None,
            };
            ty = inner;
        }
        Some((value, ty))
    }

    /// A value of constants, taken in order.
    fn constants(&mut self, binding: &Binding, ty: &Type, next: &mut usize) -> Value {
        if ty.is_array() {
            let array = self.allocate(ty, &[]);
            for at in 0..ty.count() {
                let value = self.constants(binding, &ty.element_type(), next);
                let index = self.b.int(at as i32);
                let item = self.element(&array, index);
                self.store(&item, &value);
            }
            return array;
        }
        match &ty.element {
            Element::Struct(s) => {
                Value::Struct(s.fields.iter().map(|(_, ty)| self.constants(binding, ty, next)).collect())
            }
            Element::Base(base) => {
                // One number for a triple is spread; in an array or a struct what is missing is zero.
                let single = *next == 0 && matches!(binding, Binding::Numbers(n) if n.len() == 1) && base.is_triple();
                let mut regs = Vec::new();
                for _ in 0..base.components() {
                    let value = constant_at(binding, *base, if single { 0 } else { *next });
                    regs.push(self.b.constant(value));
                    *next += 1;
                }
                Value::Regs(regs)
            }
        }
    }

    pub(super) fn final_params(&mut self) -> HashMap<String, (Value, Type)> {
        let mut out = HashMap::new();
        for param in &self.shader.params {
            // What has waited for its value to the end is read by nobody here; what it feeds others by is another layer's.
            if self.waiting.contains(&param.var) && !self.read.contains(&param.var) {
                continue;
            }
            let variable = &self.shader.variables[param.var.0 as usize];
            let value = self.variable(param.var);
            let value = self.stable(&value);
            let mut ty = variable.ty.clone();
            if param.open {
                ty.length = Length::Fixed(value.count() as u32);
            }
            out.insert(variable.name.to_string(), (value, ty));
        }
        out
    }

    pub(super) fn list_outputs(
        &mut self,
        layer: &Layer,
        params: &HashMap<String, (Value, Type)>,
        outputs: &mut Vec<Output>,
    ) {
        for param in self.shader.params.iter().filter(|param| param.output) {
            let name = &self.shader.variables[param.var.0 as usize].name;
            if let Some((value, ty)) = params.get(name.as_str()) {
                list_value(&layer.name, name.to_string(), value, ty, outputs);
            }
        }
    }
}

/// `[[int lockgeom = 0]]` or `[[int interpolated = 1]]`, as OSL has it in old and in new.
fn declared_interpolated(param: &ShaderParam) -> bool {
    param.metadata.iter().any(|entry| match (entry.name.as_str(), &entry.value.kind) {
        ("lockgeom", ExprKind::Int(x)) => *x == 0,
        ("interpolated", ExprKind::Int(x)) => *x != 0,
        _ => false,
    })
}

fn list_value(layer: &str, name: String, value: &Value, ty: &Type, outputs: &mut Vec<Output>) {
    let make = |value| Output { layer: layer.to_owned(), name: name.clone(), ty: ty.clone(), value };
    match value {
        Value::Regs(regs) => outputs.push(make(OutputValue::Regs(regs.clone()))),
        Value::Array { id, .. } => outputs.push(make(OutputValue::Array(*id))),
        Value::Struct(fields) => {
            let names = ty.structure().map(|s| s.fields.clone()).unwrap_or_default();
            for (field, (field_name, ty)) in fields.iter().zip(names) {
                list_value(layer, format!("{name}.{field_name}"), field, &ty, outputs);
            }
        }
        Value::Item { .. } => {}
    }
}

fn constant_at(binding: &Binding, base: Base, at: usize) -> Const {
    match binding {
        Binding::Numbers(numbers) => {
            let number = numbers.get(at).copied().unwrap_or(0.0);
            match kind_of(base) {
                Kind::Float => Const::Float(number as f32),
                Kind::Int => Const::Int(number as i32),
                other => zero_of(other),
            }
        }
        Binding::Strings(strings) if base == Base::String => {
            Const::String(strings.get(at).map_or(0, |text| Symbol::new(text).0))
        }
        _ => zero_of(kind_of(base)),
    }
}
