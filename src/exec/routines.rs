//! Routines: work that is more than arithmetic, lane by lane.

use super::host::{Attribute, Report};
use super::machine::Run;
use super::points::RAY_TYPES;
use crate::ir::op::*;
use crate::ir::program::Reg;
use crate::lang::symbols::Symbol;
use crate::ops::color::{ColorSpace, blackbody, transformc, wavelength_color};
use crate::ops::color_slope::transformc_slope;
use crate::ops::spline::Basis;
use crate::ops::{hash, matrix, pattern, spline, string};
use velour_grammar::Span;

/// The arguments of one lane.
pub(super) struct Lane<'r> {
    run: &'r Run<'r>,
    src: &'r [Reg],
    lane: usize,
}

impl Lane<'_> {
    fn f(&self, at: usize) -> f32 {
        let column = self.run.regs.f(self.src[at]);
        if column.len() == 1 { column[0] } else { column[self.lane] }
    }

    fn i(&self, at: usize) -> i32 {
        let column = self.run.regs.i(self.src[at]);
        if column.len() == 1 { column[0] } else { column[self.lane] }
    }

    fn s(&self, at: usize) -> &'static str {
        Symbol(self.i(at)).text()
    }

    /// How many knots of a spline count: as many as asked for, and as there are.
    fn knots(&self) -> usize {
        (self.i(2).max(0) as usize).min(self.src.len() - 3)
    }

    fn triple(&self, at: usize) -> [f32; 3] {
        [self.f(at), self.f(at + 1), self.f(at + 2)]
    }

    fn matrix(&self) -> matrix::Matrix {
        std::array::from_fn(|i| self.f(i))
    }
}

impl Run<'_> {
    pub(super) fn call(&mut self, routine: &Routine, dst: &[Reg], src: &[Reg], span: Span) {
        match routine {
            Routine::Noise(noise) => self.noise(*noise, dst, src),
            Routine::Print(to, format) => self.print(*to, format, src, span),
            Routine::Format(format) => self.format(format, dst[0], src),
            Routine::Attribute(ty) => self.attribute(*ty, dst, src),
            Routine::SpaceMatrix => self.space_matrix(dst, src, span),
            Routine::TransformColor => self.transform_color(dst, src, span),
            Routine::ClampIndex(len) => self.clamp_index(*len, dst[0], src[0], span),
            _ => self.each_lane(routine, dst, src),
        }
    }

    /// The lanes a result is computed in: one when all are the same.
    pub(super) fn lanes_of(&self, dst: Reg) -> usize {
        if self.group.program.regs[dst.0 as usize].uniform { 1 } else { self.n }
    }

    fn each_lane(&mut self, routine: &Routine, dst: &[Reg], src: &[Reg]) {
        let Some(&first) = dst.first() else { return };
        let mut floats = [0.0f32; 16];
        let mut ints = std::mem::take(&mut self.s.ints);
        ints.clear();
        ints.resize(dst.len(), 0);
        for lane in 0..self.lanes_of(first) {
            // Lanes that are not here may hold anything, which costs time in the slow routines.
            if self.s.mask[lane] == 0 && self.active < self.n && self.lanes_of(first) > 1 {
                continue;
            }
            let args = Lane { run: self, src, lane };
            let whole = compute(routine, &args, &mut floats, &mut ints);
            for (at, reg) in dst.iter().enumerate() {
                if whole {
                    self.regs.ints[reg.0 as usize][lane] = ints[at];
                } else {
                    self.regs.floats[reg.0 as usize][lane] = floats[at];
                }
            }
        }
        self.s.ints = ints;
    }

    fn space_matrix(&mut self, dst: &[Reg], src: &[Reg], span: Span) {
        for lane in 0..self.lanes_of(dst[0]) {
            let args = Lane { run: self, src, lane };
            let (from, to) = (args.s(0), args.s(1));
            // Of a space to itself without asking, as the compiler has it where it knows both names.
            let found = if from == to { Some(matrix::IDENTITY) } else { self.host.matrix(from, to) };
            if found.is_none() && self.s.mask[lane] != 0 {
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
        for lane in 0..self.lanes_of(dst[0]) {
            let args = Lane { run: self, src, lane };
            let (from, to, color) = (args.s(0), args.s(1), args.triple(2));
            let result = match (ColorSpace::from_name(from), ColorSpace::from_name(to)) {
                (Some(from), Some(to)) => transformc(from, to, color),
                _ if self.s.mask[lane] == 0 => color,
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

    fn attribute(&mut self, ty: AttributeType, dst: &[Reg], src: &[Reg]) {
        for lane in 0..self.lanes_of(dst[0]) {
            let args = Lane { run: self, src, lane };
            let name = args.s(1);
            let found = self.host.attributes.get(name).filter(|value| fits(value, ty));
            match found {
                Some(Attribute::Floats(values)) => {
                    for (reg, &value) in dst[1..].iter().zip(values) {
                        self.regs.floats[reg.0 as usize][lane] = value;
                    }
                }
                Some(Attribute::Ints(values)) => {
                    for (reg, &value) in dst[1..].iter().zip(values) {
                        self.regs.ints[reg.0 as usize][lane] = value;
                    }
                }
                Some(Attribute::Strings(values)) => {
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

fn fits(value: &Attribute, ty: AttributeType) -> bool {
    match (value, ty) {
        (Attribute::Ints(values), AttributeType::Ints(n)) => values.len() == n as usize,
        (Attribute::Floats(values), AttributeType::Floats(n)) => values.len() == n as usize,
        (Attribute::Strings(values), AttributeType::Strings(n)) => values.len() == n as usize,
        _ => false,
    }
}

/// Computes one lane. Gives true when the results are ints, false when they are floats.
fn compute(routine: &Routine, a: &Lane, floats: &mut [f32; 16], ints: &mut [i32]) -> bool {
    match routine {
        Routine::Spline => {
            let (basis, count) = (Basis::from_name(a.s(0)), a.knots());
            floats[0] = spline::spline(basis, a.f(1), count, |i| a.f(3 + i));
            floats[1] = spline::spline_slope(basis, a.f(1), count, |i| a.f(3 + i));
        }
        Routine::SplineInverse => {
            let knots: Vec<f32> = (0..a.knots()).map(|i| a.f(3 + i)).collect();
            floats[0] = spline::splineinverse(Basis::from_name(a.s(0)), a.f(1), &knots);
        }
        Routine::MatrixInverse => *floats = matrix::inverse(&a.matrix()),
        Routine::Determinant => floats[0] = matrix::determinant(&a.matrix()),
        Routine::Blackbody => floats[..3].copy_from_slice(&blackbody(a.f(0))),
        Routine::WavelengthColor => floats[..3].copy_from_slice(&wavelength_color(a.f(0))),
        Routine::TransformColorSlope => {
            if let (Some(from), Some(to)) = (ColorSpace::from_name(a.s(0)), ColorSpace::from_name(a.s(1))) {
                floats[..3].copy_from_slice(&transformc_slope(from, to, a.triple(2), a.triple(5)));
            } else {
                floats[..3].copy_from_slice(&a.triple(5));
            }
        }
        Routine::TransformUnit => floats[0] = a.f(2) * unit(a.s(0)) / unit(a.s(1)),
        Routine::Stof => floats[0] = string::stof(a.s(0)),
        _ => {
            compute_ints(routine, a, ints);
            return true;
        }
    }
    false
}

fn compute_ints(routine: &Routine, a: &Lane, out: &mut [i32]) {
    out[0] = match routine {
        Routine::HashInt => hash::hash_int(a.i(0)),
        Routine::HashFloats => match a.src.len() {
            1 => hash::hash_float(a.f(0)),
            2 => hash::hash_float2(a.f(0), a.f(1)),
            3 => hash::hash_point(a.f(0), a.f(1), a.f(2)),
            _ => hash::hash_point_float(a.f(0), a.f(1), a.f(2), a.f(3)),
        },
        Routine::HashString => hash::hash_string(a.s(0)),
        Routine::Strlen => string::strlen(a.s(0)),
        Routine::GetChar => string::getchar(a.s(0), a.i(1)),
        Routine::StartsWith => string::startswith(a.s(0), a.s(1)),
        Routine::EndsWith => string::endswith(a.s(0), a.s(1)),
        Routine::Substr => Symbol::new(&string::substr(a.s(0), a.i(1), a.i(2))).0,
        Routine::Concat => Symbol::new(&string::concat(a.s(0), a.s(1))).0,
        Routine::Stoi => string::stoi(a.s(0)),
        Routine::Regex(whole) => {
            let search = if *whole { pattern::regex_match } else { pattern::regex_search };
            search(a.s(0), a.s(1), &mut out[1..])
        }
        Routine::Split => {
            let most = a.i(2).min(out.len() as i32 - 1);
            let parts = string::split(a.s(0), a.s(1), most);
            for (slot, part) in out[1..].iter_mut().zip(&parts) {
                *slot = Symbol::new(part).0;
            }
            parts.len() as i32
        }
        // What is left is the ray type: every other routine has its own arm.
        _ => {
            let bit = RAY_TYPES.iter().find(|(name, _)| *name == a.s(0)).map_or(0, |(_, bit)| *bit);
            (a.run.points.ray_type[a.lane] & bit != 0) as i32
        }
    };
}

/// Length of a unit in metres; common space is in metres, unknown units count as common.
fn unit(name: &str) -> f32 {
    match name {
        "mm" => 1e-3,
        "cm" => 1e-2,
        "km" => 1e3,
        "in" => 0.0254,
        "ft" => 0.3048,
        "mi" => 1609.344,
        _ => 1.0,
    }
}
