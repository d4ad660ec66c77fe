//! Routines: work that is more than arithmetic, lane by lane.

use super::cost;
use super::lane::Lane;
use super::report::Mistake;
use super::run::Run;
use super::smooth;
use crate::ir::op::*;
use crate::ir::program::Reg;
use crate::ir::routine::Watch;
use crate::ops::color::{ColorSpace, transformc};
use crate::ops::{hash, pattern, string};
use velour_grammar::Span;

impl Run<'_> {
    pub(super) fn call(&mut self, routine: &Routine, dst: &[Reg], src: &[Reg], span: Span) {
        let made = self.tree.strings.bytes();
        self.dispatch(routine, dst, src, span);
        let lanes = dst.first().map_or(self.n, |&first| self.lanes_of(first)).min(self.n) as u64;
        let texts = self.read.take() + (self.tree.strings.bytes().saturating_sub(made)) as u64;
        self.charge(cost::of(routine) * lanes / cost::PARTS + texts / cost::BYTES);
        self.ask_host();
        if self.budget == 0 {
            self.fatal(span, "the shader is too costly: the batch has done as much work as it may");
        }
    }

    fn dispatch(&mut self, routine: &Routine, dst: &[Reg], src: &[Reg], span: Span) {
        match routine {
            Routine::Noise(noise) => self.noise(*noise, dst, src),
            Routine::Smooth(Smooth::TransformColor) => self.transform_color(dst, src, span),
            Routine::Smooth(function) => self.float_lanes(dst, src, |a, out| smooth::value(*function, a, out)),
            Routine::Slope(function) => self.float_lanes(dst, src, |a, out| smooth::change(*function, a, out)),
            Routine::SpaceMatrix => self.space_matrix(dst, src, span),
            Routine::CheckFinite(watch) => self.check_finite(watch, src, span),
            Routine::ClampIndex { len, .. } => self.clamp_index(*len, dst[0], src[0], span),
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
            Routine::Substr => self.string_lanes(dst, src, span, |a| string::substr(a.s(0), a.i(1), a.i(2))),
            Routine::Concat => self.string_lanes(dst, src, span, |a| string::concat(a.s(0), a.s(1))),
            Routine::Stof => self.float_lanes(dst, src, |a, out| out[0] = string::stof(a.s(0))),
            Routine::Stoi => self.int_lanes(dst, src, |a| string::stoi(a.s(0))),
            Routine::Regex { whole, .. } => self.regex(*whole, dst, src, span),
            Routine::Split(parts) => self.split(*parts, dst, src, span),
            Routine::Format(format) => self.format(format, dst[0], src, span),
            Routine::Print(to, format) => self.print(*to, format, src, span),
            Routine::RayType => self.ray_type(dst, src),
            Routine::Attribute(attribute) => self.attribute(*attribute, dst, src),
            Routine::Texture(texture) => self.texture(*texture, dst, src, span),
            Routine::TextureInfo(ty) => self.texture_info(*ty, dst, src, span),
            Routine::SetMessage(shape) => self.set_message(shape, src, span),
            Routine::GetMessage(shape) => self.get_message(shape, dst, src, span),
            Routine::Random(_) => self.random(dst),
            Routine::Trace => self.trace(dst[0], src),
            Routine::DictFind => self.dict_find(dst[0], src, span),
            Routine::DictFindBelow => self.dict_find_below(dst[0], src, span),
            Routine::DictNext => self.dict_next(dst[0], src, span),
            Routine::DictValue(ty) => self.dict_value(*ty, dst, src, span),
        }
    }

    /// Numbers in [0, 1) by chance: of the place of the point and of how many there were before, so that a picture comes out the same
    /// again, in any order of its points.
    fn random(&mut self, dst: &[Reg]) {
        self.s.draws.resize(self.n, 0);
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            let p = self.points.p.get(lane);
            for reg in dst {
                let draw = self.s.draws[lane];
                self.s.draws[lane] = draw.wrapping_add(1);
                let mixed = hash::hash_point_float(p.x, p.y, p.z, f32::from_bits(draw)) as u32;
                self.regs.floats[reg.0 as usize][lane] = (mixed >> 8) as f32 / (1 << 24) as f32;
            }
        }
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

    /// Makes a string lane by lane.
    fn string_lanes(&mut self, dst: &[Reg], src: &[Reg], span: Span, compute: impl Fn(&Lane) -> String) {
        let lanes = self.lanes_of(dst[0]);
        for lane in 0..lanes {
            if !self.idle(lane, lanes) {
                let text = compute(&Lane { run: self, src, lane });
                let symbol = self.tree.strings.symbol(&text);
                self.regs.ints[dst[0].0 as usize][lane] = symbol.0;
            }
        }
        self.check_strings(span);
    }

    /// Gives the batch up when its strings take too much memory.
    pub(super) fn check_strings(&mut self, span: Span) {
        if self.tree.strings.is_full() {
            self.fatal(span, "the strings of a batch are longer than 64 MB together");
        }
    }

    /// Reports what is assigned in a lane and is no finite number.
    fn check_finite(&mut self, watch: &Watch, src: &[Reg], span: Span) {
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            let args = Lane { run: self, src, lane };
            let Some(value) = (0..src.len()).map(|at| args.f(at)).find(|x| !x.is_finite()) else { continue };
            let (nan, Watch { variable, operation, .. }) = (value.is_nan(), watch.clone());
            let text =
                format!("{variable} is given {}, which {operation} has made", if nan { "a nan" } else { "an inf" });
            self.report_once(lane, span, Mistake::NotFinite { nan, variable, operation: operation.to_owned() }, text);
        }
    }

    fn regex(&mut self, whole: bool, dst: &[Reg], src: &[Reg], span: Span) {
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
            let flaw =
                if found == 0 { pattern::flaw(args.s(1)).map(|flaw| (args.s(1).to_owned(), flaw)) } else { None };
            if let Some((pattern, flaw)) = flaw {
                self.report_once(lane, span, Mistake::Other, format!("\"{pattern}\" is no pattern: {flaw}"));
            }
            self.regs.ints[dst[0].0 as usize][lane] = found;
            for (reg, &position) in dst[1..].iter().zip(&positions) {
                self.regs.ints[reg.0 as usize][lane] = position;
            }
        }
        self.s.ints = positions;
    }

    fn split(&mut self, most: u32, dst: &[Reg], src: &[Reg], span: Span) {
        let lanes = self.lanes_of(dst[0]);
        let mut found = std::mem::take(&mut self.s.ints);
        for lane in 0..lanes {
            if self.idle(lane, lanes) {
                continue;
            }
            let args = Lane { run: self, src, lane };
            let parts = string::split(args.s(0), args.s(1), args.i(2).min(most as i32));
            let parts: Vec<String> = parts.into_iter().map(str::to_owned).collect();
            found.clear();
            found.push(parts.len() as i32);
            found.extend(parts.iter().map(|part| self.tree.strings.symbol(part).0));
            // What an array holds beyond the last part is empty.
            found.resize(dst.len(), 0);
            for (reg, &value) in dst.iter().zip(&found) {
                self.regs.ints[reg.0 as usize][lane] = value;
            }
        }
        self.s.ints = found;
        self.check_strings(span);
    }

    fn transform_color(&mut self, dst: &[Reg], src: &[Reg], span: Span) {
        let (lanes, space) = (self.lanes_of(dst[0]), self.group.program.working_space);
        for lane in 0..lanes {
            let args = Lane { run: self, src, lane };
            let (from, to, color) = (args.s(0), args.s(1), args.triple(2));
            let result = match (ColorSpace::from_name(from), ColorSpace::from_name(to)) {
                (Some(from), Some(to)) => transformc(space, from, to, color),
                _ if self.idle(lane, lanes) => color,
                _ => {
                    let message = format!("there is no color space \"{from}\" or no \"{to}\"");
                    let mistake = Mistake::ColorSpace { from: from.to_owned(), to: to.to_owned() };
                    self.report_once(lane, span, mistake, message);
                    color
                }
            };
            for (reg, value) in dst.iter().zip(result) {
                self.regs.floats[reg.0 as usize][lane] = value;
            }
        }
    }
}
