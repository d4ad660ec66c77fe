//! How derivatives pass through routines, by what each declares.

use super::{Slope, Writer, floats};
use crate::ir::op::*;
use crate::ir::program::*;
use velour_grammar::Span;

impl Writer<'_> {
    /// Emits a call, and after it the derivatives of its results, as its declaration says.
    pub(super) fn call_slope(&mut self, routine: Routine, dst: Vec<Reg>, src: Vec<Reg>, span: Span) {
        match (routine.declaration().slopes, routine) {
            (Slopes::Rule(function), routine) => self.rule_slope(function, routine, dst, src, span),
            (Slopes::Gradient, Routine::Noise(noise)) => self.noise_slope(noise, dst, src, span),
            (Slopes::Given, Routine::Attribute(attribute)) => self.attribute_slope(attribute, dst, src, span),
            (Slopes::Given, Routine::Texture(call)) => self.texture_slope(call, dst, src, span),
            (Slopes::Gradient | Slopes::Given | Slopes::None, routine) => {
                self.emit(Instr::Call { routine, dst, src, span });
            }
        }
    }

    /// Calls the function's slope once an axis along which an argument changes.
    fn rule_slope(&mut self, function: Smooth, routine: Routine, dst: Vec<Reg>, src: Vec<Reg>, span: Span) {
        let Declaration { takes, gives, .. } = routine.declaration();
        let (values, args): (Vec<Reg>, Vec<Reg>) = (floats(&gives, &dst).collect(), floats(&takes, &src).collect());
        self.emit(Instr::Call { routine, dst, src: src.clone(), span });
        let from: Vec<Slope> = args.into_iter().map(|reg| self.slope(reg)).collect();
        let mut slopes = vec![[None; 2]; values.len()];
        for axis in 0..2 {
            if from.iter().all(|slope| slope[axis].is_none()) {
                continue;
            }
            let changes: Vec<Reg> = from.iter().map(|slope| slope[axis].unwrap_or_else(|| self.zero())).collect();
            let dst: Vec<Reg> = values.iter().map(|_| self.program.reg(Kind::Float, false)).collect();
            for (slope, &reg) in slopes.iter_mut().zip(&dst) {
                slope[axis] = Some(reg);
            }
            let src = src.iter().chain(&values).copied().chain(changes).collect();
            self.emit(Instr::Call { routine: Routine::Slope(function), dst, src, span });
        }
        self.slopes.extend(values.into_iter().zip(slopes));
    }

    /// Asks the host for the derivatives as well.
    fn attribute_slope(&mut self, attribute: AttributeQuery, mut dst: Vec<Reg>, src: Vec<Reg>, span: Span) {
        let values = dst[1..].to_vec();
        let [dx, dy] =
            [0, 1].map(|_| values.iter().map(|_| self.program.reg(Kind::Float, false)).collect::<Vec<Reg>>());
        for ((&value, &x), &y) in values.iter().zip(&dx).zip(&dy) {
            self.slopes.insert(value, [Some(x), Some(y)]);
        }
        dst.extend(dx.into_iter().chain(dy));
        let routine = Routine::Attribute(AttributeQuery { slopes: true, ..attribute });
        self.emit(Instr::Call { routine, dst, src, span });
    }

    /// Asks the texture for the derivatives as well.
    fn texture_slope(&mut self, call: TextureCall, dst: Vec<Reg>, src: Vec<Reg>, span: Span) {
        let (values, rest) = dst.split_at(call.channels as usize + 1);
        let [dx, dy] =
            [0, 1].map(|_| values.iter().map(|_| self.program.reg(Kind::Float, false)).collect::<Vec<Reg>>());
        for ((&value, &x), &y) in values.iter().zip(&dx).zip(&dy) {
            self.slopes.insert(value, [Some(x), Some(y)]);
        }
        let all = values.iter().chain(&dx).chain(&dy).chain(rest).copied().collect();
        self.emit(Instr::Call { routine: Routine::Texture(TextureCall { slopes: true, ..call }), dst: all, src, span });
    }

    /// Asks the noise for its gradient as well and applies the chain rule.
    fn noise_slope(&mut self, mut noise: Noise, mut dst: Vec<Reg>, src: Vec<Reg>, span: Span) {
        let (dims, outputs) = (noise.dims as usize, noise.outputs as usize);
        noise.gradient = true;
        let values = dst.clone();
        dst.extend((0..dims * outputs).map(|_| self.program.reg(Kind::Float, false)));
        let gradient = dst[outputs..].to_vec();
        let inputs: Vec<Slope> = src[..dims].iter().map(|&reg| self.slope(reg)).collect();
        self.emit(Instr::Call { routine: Routine::Noise(noise), dst, src, span });
        for (o, value) in values.into_iter().enumerate() {
            let mut slope = [None; 2];
            for (axis, slot) in slope.iter_mut().enumerate() {
                for d in 0..dims {
                    let part = self.mul(inputs[d][axis], gradient[o * dims + d]);
                    *slot = self.add(*slot, part);
                }
            }
            self.slopes.insert(value, slope);
        }
    }
}
