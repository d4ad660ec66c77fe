//! Questions to the host: each is asked once a batch, for all lanes that ask it.

use super::host::{AttributeAnswer, AttributeRequest, TraceRequest, between};
use super::lane::Lane;
use super::report::Mistake;
use super::run::Run;
use crate::ir::op::{AttributeOf, AttributeQuery};
use crate::ir::program::{Kind, Reg};
use crate::lang::symbols::Symbol;
use crate::ops::matrix::{IDENTITY, Matrix};
use velour_grammar::Span;

impl Run<'_> {
    /// The matrix from a space to common, as the host gave it in this batch.
    fn space(&mut self, symbol: i32) -> Option<Matrix> {
        if let Some(known) = self.s.spaces.iter().find(|known| known.0 == symbol) {
            return known.1;
        }
        let matrix = self.host.space(self.tree.strings.text(Symbol(symbol)), self.points);
        self.s.spaces.push((symbol, matrix));
        matrix
    }

    pub(super) fn space_matrix(&mut self, dst: &[Reg], src: &[Reg], span: Span) {
        let lanes = self.lanes_of(dst[0]);
        for lane in 0..lanes {
            let args = Lane { run: self, src, lane };
            let (from, to) = (args.i(0), args.i(1));
            // Of a space to itself without asking, as the compiler has it where it knows both names.
            let found = if from == to { Some(IDENTITY) } else { between(self.space(from), self.space(to)) };
            if found.is_none() && !self.idle(lane, lanes) {
                for unknown in [from, to].into_iter().filter(|&name| self.space(name).is_none()).collect::<Vec<_>>() {
                    let name = self.tree.strings.text(Symbol(unknown)).to_owned();
                    let message = format!("there is no space \"{name}\"");
                    self.report_once(lane, span, Mistake::Space { name }, message);
                }
            }
            for (reg, value) in dst.iter().zip(found.unwrap_or(IDENTITY)) {
                self.regs.floats[reg.0 as usize][lane] = value;
            }
            self.regs.ints[dst[16].0 as usize][lane] = found.is_some() as i32;
        }
    }

    /// Asks what rays meet.
    pub(super) fn trace(&mut self, dst: Reg, src: &[Reg]) {
        let lanes: Vec<usize> = (0..self.n).filter(|&lane| self.s.mask[lane] != 0).collect();
        let rays: Vec<[f32; 8]> = lanes
            .iter()
            .map(|&lane| {
                let args = Lane { run: self, src, lane };
                std::array::from_fn(|at| args.f(at))
            })
            .collect();
        let hits = self.host.trace(&TraceRequest { lanes: &lanes, rays: &rays, points: self.points });
        for (at, &lane) in lanes.iter().enumerate() {
            self.regs.ints[dst.0 as usize][lane] = i32::from(hits.get(at).copied().unwrap_or(false));
        }
    }

    /// The bits of a ray type, as the host gave them in this batch.
    fn ray_bits(&mut self, symbol: i32) -> i32 {
        if let Some(known) = self.s.ray_types.iter().find(|known| known.0 == symbol) {
            return known.1;
        }
        let bits = self.host.ray_type(self.tree.strings.text(Symbol(symbol)));
        self.s.ray_types.push((symbol, bits));
        bits
    }

    pub(super) fn ray_type(&mut self, dst: &[Reg], src: &[Reg]) {
        for lane in 0..self.n {
            let symbol = Lane { run: self, src, lane }.i(0);
            let bits = self.ray_bits(symbol);
            self.regs.ints[dst[0].0 as usize][lane] = (self.points.ray_type[lane] & bits != 0) as i32;
        }
    }

    /// Asks for an attribute: once, or where its name differs from lane to lane, once a name.
    pub(super) fn attribute(&mut self, query: AttributeQuery, dst: &[Reg], src: &[Reg]) {
        let mut open = std::mem::take(&mut self.s.asked);
        open.clear();
        open.extend((0..self.n).filter(|&lane| !self.idle(lane, self.n)));
        self.regs.ints[dst[0].0 as usize].fill(0);
        let mut rest = 0;
        while rest < open.len() {
            let args = Lane { run: self, src, lane: open[rest] };
            let asked = |args: &Lane| (args.i(0), args.i(1), if query.indexed { args.i(2) } else { 0 });
            let first = asked(&args);
            // The lanes that ask the same come to the front.
            let mut end = rest;
            for at in rest..open.len() {
                if asked(&Lane { run: self, src, lane: open[at] }) == first {
                    open.swap(at, end);
                    end += 1;
                }
            }
            open[rest..end].sort_unstable();
            self.ask(query, dst, first, &open[rest..end]);
            rest = end;
        }
        self.s.asked = open;
    }

    /// Asks for an attribute of an object by its name, and by the number of an element where one is asked for.
    fn ask(&mut self, query: AttributeQuery, dst: &[Reg], (object, name, element): (i32, i32, i32), lanes: &[usize]) {
        let (kind, _) = query.ty.kind();
        let mut found = std::mem::take(&mut self.regs.ints[dst[0].0 as usize]);
        let (mut floats, mut ints) = (std::mem::take(&mut self.s.columns), std::mem::take(&mut self.s.int_columns));
        for reg in &dst[1..] {
            match kind {
                Kind::Float => floats.push(std::mem::take(&mut self.regs.floats[reg.0 as usize])),
                Kind::Int | Kind::String | Kind::Closure => {
                    ints.push(std::mem::take(&mut self.regs.ints[reg.0 as usize]))
                }
            }
        }
        lanes.iter().for_each(|&lane| {
            floats.iter_mut().for_each(|column| column[lane] = 0.0);
            ints.iter_mut().for_each(|column| column[lane] = 0);
        });
        // The names may be strings of the batch, and an answer may add to those, so they are copied.
        let mut names = std::mem::take(&mut self.s.names);
        for (text, symbol) in names.iter_mut().zip([object, name]) {
            text.clear();
            text.push_str(self.tree.strings.text(Symbol(symbol)));
        }
        let [object, name] = &names;
        // A number below 0 is one that no array has.
        let element = query.indexed.then_some(usize::try_from(element).unwrap_or(usize::MAX));
        let asked = AttributeRequest { object, name, ty: query.ty, element, slopes: query.slopes, points: self.points };
        let strings = &mut self.tree.strings;
        let (floats_out, ints_out) = (floats.as_mut_slice(), ints.as_mut_slice());
        let mut answer = AttributeAnswer {
            ty: query.ty,
            element,
            lanes,
            found: &mut found,
            floats: floats_out,
            ints: ints_out,
            strings,
        };
        match query.of {
            AttributeOf::Attribute => self.host.attribute(&asked, &mut answer),
            AttributeOf::Message => self.host.message(&asked, &mut answer),
        }
        self.regs.ints[dst[0].0 as usize] = found;
        match kind {
            Kind::Float => {
                for (reg, column) in dst[1..].iter().zip(floats.drain(..)) {
                    self.regs.floats[reg.0 as usize] = column;
                }
            }
            Kind::Int | Kind::String | Kind::Closure => {
                for (reg, column) in dst[1..].iter().zip(ints.drain(..)) {
                    self.regs.ints[reg.0 as usize] = column;
                }
            }
        }
        (self.s.columns, self.s.int_columns, self.s.names) = (floats, ints, names);
    }
}
