//! Array elements chosen at run time, one index a lane.

use super::report::Mistake;
use super::run::Run;
use crate::ir::program::*;
use velour_grammar::Span;

impl Run<'_> {
    /// The element each lane wants, kept inside the array.
    fn checked(&mut self, index: Reg, lane: usize, len: u32, span: Span) -> usize {
        let column = self.regs.i(index);
        let wanted = if column.len() == 1 { column[0] } else { column[lane] };
        if wanted >= 0 && (wanted as u32) < len {
            return wanted as usize;
        }
        // Told of a few times; after that it costs no more than the element.
        if self.s.mask[lane] != 0 && self.tells_mistakes() {
            let message = match len.checked_sub(1) {
                Some(last) => format!("index {wanted} is outside 0..{last}"),
                None => format!("index {wanted} is outside an array without elements"),
            };
            self.report_once(lane, span, Mistake::Index { index: wanted, len }, message);
        }
        (wanted.max(0) as usize).min(len.saturating_sub(1) as usize)
    }

    /// The component each lane wants, kept inside.
    pub(super) fn clamp_index(&mut self, len: u32, dst: Reg, index: Reg, span: Span) {
        let last = len.saturating_sub(1) as i32;
        let mut out = std::mem::take(&mut self.regs.ints[dst.0 as usize]);
        let column = self.regs.i(index);
        let mut inside = true;
        if column.len() == 1 {
            out.fill(column[0].clamp(0, last));
            inside = column[0] == out[0];
        } else {
            for (clamped, &wanted) in out.iter_mut().zip(column) {
                *clamped = wanted.clamp(0, last);
                inside &= *clamped == wanted;
            }
        }
        let lanes = out.len();
        self.regs.ints[dst.0 as usize] = out;
        if inside {
            return;
        }
        // Where one number stands for all lanes, one that is here reports it.
        let first = if lanes == 1 { self.first_active() } else { 0 };
        (first..first + lanes).for_each(|lane| {
            self.checked(index, lane, len, span);
        });
    }

    pub(super) fn array_get(&mut self, dst: Reg, array: ArrayId, component: u32, index: Reg, span: Span) {
        let info = self.group.program.arrays[array.0 as usize];
        if info.len == 0 {
            self.checked(index, self.first_active(), 0, span);
            match info.kind {
                Kind::Float => self.regs.floats[dst.0 as usize].fill(0.0),
                Kind::Int | Kind::String => self.regs.ints[dst.0 as usize].fill(0),
                Kind::Closure => self.regs.closures[dst.0 as usize] = None,
            }
            return;
        }
        if info.kind == Kind::Closure {
            return self.closure_array_get(dst, array, index, span);
        }
        let lanes = if info.uniform { 1 } else { self.n };
        let out = self.lanes_of(dst);
        if self.regs.i(index).len() == 1 && out == lanes {
            let element = self.checked(index, self.first_active(), info.len, span);
            let at = (element * info.components as usize + component as usize) * lanes;
            if info.kind == Kind::Float {
                let source = &self.regs.float_arrays[array.0 as usize][at..at + lanes];
                self.regs.floats[dst.0 as usize].copy_from_slice(source);
            } else {
                self.regs.ints[dst.0 as usize].copy_from_slice(&self.regs.int_arrays[array.0 as usize][at..at + lanes]);
            }
            return;
        }
        for lane in 0..out {
            let element = self.checked(index, lane, info.len, span);
            let at = (element * info.components as usize + component as usize) * lanes + lane.min(lanes - 1);
            if info.kind == Kind::Float {
                self.regs.floats[dst.0 as usize][lane] = self.regs.float_arrays[array.0 as usize][at];
            } else {
                self.regs.ints[dst.0 as usize][lane] = self.regs.int_arrays[array.0 as usize][at];
            }
        }
    }

    pub(super) fn array_set(
        &mut self,
        array: ArrayId,
        component: u32,
        (index, src): (Reg, Reg),
        masked: bool,
        span: Span,
    ) {
        let info = self.group.program.arrays[array.0 as usize];
        if info.len == 0 {
            self.checked(index, self.first_active(), 0, span);
            return;
        }
        if info.kind == Kind::Closure {
            return self.closure_array_set(array, index, src, masked, span);
        }
        let lanes = if info.uniform { 1 } else { self.n };
        for lane in 0..lanes {
            if masked && self.s.mask[lane] == 0 {
                continue;
            }
            let element = self.checked(index, lane, info.len, span);
            let at = (element * info.components as usize + component as usize) * lanes + lane;
            if info.kind == Kind::Float {
                let column = self.regs.f(src);
                let value = if column.len() == 1 { column[0] } else { column[lane] };
                self.regs.float_arrays[array.0 as usize][at] = value;
            } else {
                let column = self.regs.i(src);
                let value = if column.len() == 1 { column[0] } else { column[lane] };
                self.regs.int_arrays[array.0 as usize][at] = value;
            }
        }
    }

    /// Reads a closure array. Lanes with different indices get a chain of choices.
    fn closure_array_get(&mut self, dst: Reg, array: ArrayId, index: Reg, span: Span) {
        let info = self.group.program.arrays[array.0 as usize];
        if self.regs.i(index).len() == 1 {
            let element = self.checked(index, self.first_active(), info.len, span);
            self.regs.closures[dst.0 as usize] = self.regs.closure_arrays[array.0 as usize][element];
            return;
        }
        let elements: Vec<usize> = (0..self.n).map(|lane| self.checked(index, lane, info.len, span)).collect();
        let mut chosen = None;
        for element in 0..info.len as usize {
            let mask: Vec<i32> = elements.iter().map(|&e| (e == element) as i32).collect();
            if mask.contains(&1) {
                let value = self.regs.closure_arrays[array.0 as usize][element];
                chosen = self.choose_closure(&mask, value, chosen);
            }
        }
        self.regs.closures[dst.0 as usize] = chosen;
    }

    /// Writes a closure array, each lane its own element.
    fn closure_array_set(&mut self, array: ArrayId, index: Reg, src: Reg, masked: bool, span: Span) {
        let info = self.group.program.arrays[array.0 as usize];
        let new = self.closure(src);
        let elements: Vec<usize> = (0..self.n).map(|lane| self.checked(index, lane, info.len, span)).collect();
        for element in 0..info.len as usize {
            let wanted = |lane: usize| elements[lane] == element && (!masked || self.s.mask[lane] != 0);
            let mask: Vec<i32> = (0..self.n).map(|lane| wanted(lane) as i32).collect();
            if mask.contains(&1) {
                let old = self.regs.closure_arrays[array.0 as usize][element];
                let value = self.choose_closure(&mask, new, old);
                self.regs.closure_arrays[array.0 as usize][element] = value;
            }
        }
    }
}
