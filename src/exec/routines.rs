//! Routines: work that is more than arithmetic, lane by lane.

use super::host::{Attribute as Value, Report};
use super::lane::Lane;
use super::machine::Run;
use super::points::RAY_TYPES;
use super::smooth;
use crate::ir::op::*;
use crate::ir::program::Reg;
use crate::lang::symbols::Symbol;
use crate::ops::color::{ColorSpace, transformc};
use crate::ops::{hash, matrix, pattern, string};
use velour_grammar::Span;

impl Run<'_> {
    pub(super) fn call(&mut self, routine: &Routine, dst: &[Reg], src: &[Reg], span: Span) {
        match routine {
            Routine::Noise(noise) => self.noise(*noise, dst, src),
            Routine::Smooth(Smooth::TransformColor) => self.transform_color(dst, src, span),
            Routine::Smooth(function) => self.float_lanes(dst, src, |a, out| smooth::value(*function, a, out)),
            Routine::Slope(function) => self.float_lanes(dst, src, |a, out| smooth::change(*function, a, out)),
            Routine::SpaceMatrix => self.space_matrix(dst, src, span),
            Routine::HashInt => self.int_lanes(dst, src, |a| hash::hash_int(a.i(0))),
            Routine::HashFloats(count) => self.int_lanes(dst, src, |a| match count {
                1 => hash::hash_float(a.f(0)),
                2 => hash::hash_float2(a.f(0), a.f(1)),
                3 => hash::hash_point(a.f(0), a.f(1), a.f(2)),
                _ => hash::hash_point_float(a.f(0), a.f(1), a.f(2), a.f(3)),
            }),
            Routine::HashString => self.int_lanes(dst, src, |a| hash::hash_string(a.s(0))),
            Routine::Strlen => self.int_lanes(dst, src, |a| string::strlen(a.s(0))),
            Routine::GetChar => self.int_lanes(dst, src, |a| string::getchar(a.s(0), a.i(1))),
            Routine::StartsWith => self.int_lanes(dst, src, |a| string::startswith(a.s(0), a.s(1))),
            Routine::EndsWith => self.int_lanes(dst, src, |a| string::endswith(a.s(0), a.s(1))),
            Routine::Substr => self.string_lanes(dst, src, |a| string::substr(a.s(0), a.i(1), a.i(2))),
            Routine::Concat => self.string_lanes(dst, src, |a| string::concat(a.s(0), a.s(1))),
            Routine::Stof => self.float_lanes(dst, src, |a, out| out[0] = string::stof(a.s(0))),
            Routine::Stoi => self.int_lanes(dst, src, |a| string::stoi(a.s(0))),
            Routine::Regex { whole, .. } => self.regex(*whole, dst, src),
            Routine::Split(parts) => self.split(*parts, dst, src),
            Routine::Format(format) => self.format(format, dst[0], src),
            Routine::Print(to, format) => self.print(*to, format, src, span),
            Routine::RayType => self.ray_type(dst, src),
            Routine::Attribute(attribute) => self.attribute(*attribute, dst, src),
        }
    }

    /// The lanes a result is computed in: one when all are the same.
    pub(super) fn lanes_of(&self, dst: Reg) -> usize {
        if self.group.program.regs[dst.0 as usize].uniform { 1 } else { self.n }
    }

    /// Is there anything to do in a lane? Lanes that are not here may hold anything, which costs time in the slow routines.
    pub(super) fn idle(&self, lane: usize, lanes: usize) -> bool {
        self.s.mask[lane] == 0 && self.active < self.n && lanes > 1
    }

    /// Computes floats lane by lane, at most 16 of them.
    fn float_lanes(&mut self, dst: &[Reg], src: &[Reg], compute: impl Fn(&Lane, &mut [f32; 16])) {
        let Some(&first) = dst.first() else { return };
        let lanes = self.lanes_of(first);
        let mut out = [0.0f32; 16];
        for lane in 0..lanes {
            if self.idle(lane, lanes) {
                continue;
            }
            compute(&Lane { run: self, src, lane }, &mut out);
            for (reg, value) in dst.iter().zip(out) {
                self.regs.floats[reg.0 as usize][lane] = value;
            }
        }
    }

    /// Computes an int lane by lane.
    fn int_lanes(&mut self, dst: &[Reg], src: &[Reg], compute: impl Fn(&Lane) -> i32) {
        let lanes = self.lanes_of(dst[0]);
        for lane in 0..lanes {
            if !self.idle(lane, lanes) {
                let value = compute(&Lane { run: self, src, lane });
                self.regs.ints[dst[0].0 as usize][lane] = value;
            }
        }
    }

    /// Computes a string lane by lane.
    fn string_lanes(&mut self, dst: &[Reg], src: &[Reg], compute: impl Fn(&Lane) -> String) {
        self.int_lanes(dst, src, |a| Symbol::new(&compute(a)).0);
    }

    fn regex(&mut self, whole: bool, dst: &[Reg], src: &[Reg]) {
        let search = if whole { pattern::regex_match } else { pattern::regex_search };
        let lanes = self.lanes_of(dst[0]);
        let mut positions = std::mem::take(&mut self.s.ints);
        positions.clear();
        positions.resize(dst.len() - 1, 0);
        for lane in 0..lanes {
            if self.idle(lane, lanes) {
                continue;
            }
            let args = Lane { run: self, src, lane };
            positions.fill(0);
            let found = search(args.s(0), args.s(1), &mut positions);
            self.regs.ints[dst[0].0 as usize][lane] = found;
            for (reg, &position) in dst[1..].iter().zip(&positions) {
                self.regs.ints[reg.0 as usize][lane] = position;
            }
        }
        self.s.ints = positions;
    }

    fn split(&mut self, most: u32, dst: &[Reg], src: &[Reg]) {
        let lanes = self.lanes_of(dst[0]);
        let mut found = std::mem::take(&mut self.s.ints);
        for lane in 0..lanes {
            if self.idle(lane, lanes) {
                continue;
            }
            let args = Lane { run: self, src, lane };
            let parts = string::split(args.s(0), args.s(1), args.i(2).min(most as i32));
            found.clear();
            found.push(parts.len() as i32);
            found.extend(parts.into_iter().map(|part| Symbol::new(part).0));
            // What an array holds beyond the last part is empty.
            found.resize(dst.len(), 0);
            for (reg, &value) in dst.iter().zip(&found) {
                self.regs.ints[reg.0 as usize][lane] = value;
            }
        }
        self.s.ints = found;
    }

    fn ray_type(&mut self, dst: &[Reg], src: &[Reg]) {
        self.int_lanes(dst, src, |a| {
            let bit = RAY_TYPES.iter().find(|(name, _)| *name == a.s(0)).map_or(0, |(_, bit)| *bit);
            (a.run.points.ray_type[a.lane] & bit != 0) as i32
        });
    }

    fn space_matrix(&mut self, dst: &[Reg], src: &[Reg], span: Span) {
        let lanes = self.lanes_of(dst[0]);
        for lane in 0..lanes {
            let args = Lane { run: self, src, lane };
            let (from, to) = (args.s(0), args.s(1));
            let found = self.host.matrix(from, to);
            if found.is_none() && !self.idle(lane, lanes) {
                let place = (self.group.locate)(span);
                self.report_once(lane, format!("{place}: error: there is no space \"{from}\" or no space \"{to}\""));
            }
            let matrix = found.unwrap_or(matrix::IDENTITY);
            for (reg, value) in dst.iter().zip(matrix) {
                self.regs.floats[reg.0 as usize][lane] = value;
            }
            self.regs.ints[dst[16].0 as usize][lane] = found.is_some() as i32;
        }
    }

    fn transform_color(&mut self, dst: &[Reg], src: &[Reg], span: Span) {
        let lanes = self.lanes_of(dst[0]);
        for lane in 0..lanes {
            let args = Lane { run: self, src, lane };
            let (from, to, color) = (args.s(0), args.s(1), args.triple(2));
            let result = match (ColorSpace::from_name(from), ColorSpace::from_name(to)) {
                (Some(from), Some(to)) => transformc(from, to, color),
                _ if self.idle(lane, lanes) => color,
                _ => {
                    let place = (self.group.locate)(span);
                    let message = format!("{place}: error: there is no color space \"{from}\" or no \"{to}\"");
                    self.report_once(lane, message);
                    color
                }
            };
            for (reg, value) in dst.iter().zip(result) {
                self.regs.floats[reg.0 as usize][lane] = value;
            }
        }
    }

    fn attribute(&mut self, asked: Attribute, dst: &[Reg], src: &[Reg]) {
        let count = asked.ty.kind().1 as usize;
        for lane in 0..self.lanes_of(dst[0]) {
            let args = Lane { run: self, src, lane };
            let name = args.s(1);
            let found = self.host.attributes.get(name).filter(|value| fits(value, asked.ty));
            match found {
                Some(Value::Floats(values)) => {
                    for (reg, &value) in dst[1..].iter().zip(values) {
                        self.regs.floats[reg.0 as usize][lane] = value;
                    }
                    for reg in &dst[1 + count..] {
                        self.regs.floats[reg.0 as usize][lane] = 0.0;
                    }
                }
                Some(Value::Ints(values)) => {
                    for (reg, &value) in dst[1..].iter().zip(values) {
                        self.regs.ints[reg.0 as usize][lane] = value;
                    }
                }
                Some(Value::Strings(values)) => {
                    for (reg, value) in dst[1..].iter().zip(values) {
                        self.regs.ints[reg.0 as usize][lane] = Symbol::new(value).0;
                    }
                }
                None => {}
            }
            self.regs.ints[dst[0].0 as usize][lane] = found.is_some() as i32;
        }
    }

    /// Reports a mistake that shading survives, once a batch, among what its lane prints.
    pub(super) fn report_once(&mut self, lane: usize, message: String) {
        if !self.s.said.contains(&message) {
            self.say(lane, Report::Error(message.clone()));
            self.s.said.push(message);
        }
    }
}

fn fits(value: &Value, ty: AttributeType) -> bool {
    match (value, ty) {
        (Value::Ints(values), AttributeType::Ints(n)) => values.len() == n as usize,
        (Value::Floats(values), AttributeType::Floats(n)) => values.len() == n as usize,
        (Value::Strings(values), AttributeType::Strings(n)) => values.len() == n as usize,
        (Value::Ints(_) | Value::Floats(_) | Value::Strings(_), _) => false,
    }
}
