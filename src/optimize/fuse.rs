//! Fuses two float operations into one instruction where the first has its result for the second alone.
//!
//! The column of the first result is then neither written nor read, and one instruction is decoded instead of two.
//!
//! Decision (2026-11-23): such pairs of operations run as one loop over lanes, because a loop of 110 operations then takes 29.5 ns a
//! point instead of 31.7, a chain of ten 2.5 instead of 2.7 and the pattern of a weave 31.4 instead of 32.1
//! (benches/ratios), for 140 kB of loops; instead of one operation an instruction.

use crate::ir::op::*;
use crate::ir::program::*;
use std::collections::HashMap;

/// An operation whose result one instruction reads, and nothing else.
#[derive(Clone, Copy)]
struct First {
    /// Its place in its block.
    at: usize,
    /// When it ran, counted in instructions.
    time: u32,
    op: Binary,
    operands: [Reg; 2],
}

struct Walk<'p> {
    regs: &'p [RegInfo],
    /// How often each register is read in the whole program.
    reads: Vec<u32>,
    /// When each register was written last, counted in instructions.
    written: Vec<u32>,
    time: u32,
}

/// Replaces pairs of operations, in program order.
///
/// The fused instruction stands where the second one stood, so the first one runs later than it did. That gives the same bits
/// in all lanes: both compute every lane whatever the mask is, and no instruction in between writes an operand. Where
/// all lanes leave in between, neither runs, and the second was the only one to read the first one's result. A first operation
/// with a reader in another block stays, as a loop or a branch may run that block another number of times.
pub fn pairs(program: &mut Program) {
    let mut reads = vec![0; program.regs.len()];
    visit_instrs(&program.body, &mut |instr| instr.reads(|reg| reads[reg.0 as usize] += 1));
    // Conditions are ints and the result is a closure, so that of what is no instruction only outputs read floats.
    for output in &program.outputs {
        if let OutputValue::Regs(regs) = &output.value {
            regs.iter().for_each(|reg| reads[reg.0 as usize] += 1);
        }
    }
    let mut walk = Walk { regs: &program.regs, reads, written: vec![0; program.regs.len()], time: 0 };
    walk.block(&mut program.body);
}

impl Walk<'_> {
    fn block(&mut self, block: &mut Block) {
        let mut firsts = HashMap::new();
        let mut gone = vec![false; block.len()];
        for at in 0..block.len() {
            match &mut block[at] {
                Node::Instr(instr) => {
                    if let Instr::Binary(op, dst, a, b) = *instr {
                        if let Some((first, fused)) = self.fused(&firsts, op, dst, [a, b]) {
                            *instr = fused;
                            gone[first] = true;
                        } else if self.may_be_first(op, dst) {
                            firsts.insert(dst, First { at, time: self.time, op, operands: [a, b] });
                        }
                    }
                    self.time += 1;
                    instr.writes(|reg| self.written[reg.0 as usize] = self.time);
                }
                Node::If(_, a, b) => [a, b].into_iter().for_each(|block| self.block(block)),
                Node::Loop { head, body, .. } => [head, body].into_iter().for_each(|block| self.block(block)),
                Node::Scope(_, body) => self.block(body),
                Node::Leave(_) => {}
            }
        }
        let mut gone = gone.into_iter();
        block.retain(|_| gone.next() != Some(true));
    }

    /// Is the result a register that vanishes when its one reader computes it?
    fn may_be_first(&self, op: Binary, dst: Reg) -> bool {
        self.reads[dst.0 as usize] == 1 && !self.regs[dst.0 as usize].mutable && Pair::FIRST.contains(&op)
    }

    /// The place of a first operation and the instruction that does it and this one.
    fn fused(
        &self,
        firsts: &HashMap<Reg, First>,
        second: Binary,
        dst: Reg,
        [a, b]: [Reg; 2],
    ) -> Option<(usize, Instr)> {
        if !Pair::SECOND.contains(&second) {
            return None;
        }
        let first = |t: Reg| {
            let first = firsts.get(&t)?;
            let kept = first.operands.iter().all(|reg| self.written[reg.0 as usize] <= first.time);
            // One number for all lanes is not computed anew in each of them.
            let alike = self.regs[t.0 as usize].uniform == self.regs[dst.0 as usize].uniform;
            (kept && alike).then_some(first)
        };
        let (first, c, swapped) = match (first(a), first(b)) {
            (Some(first), _) => (first, b, false),
            // Sums and products are the same either way, and need one loop instead of two.
            (None, first) => (first?, a, !matches!(second, Binary::Add | Binary::Mul)),
        };
        let [a, b] = first.operands;
        Some((first.at, Instr::Fused(Pair { first: first.op, second, swapped }, dst, [a, b, c])))
    }
}

#[cfg(test)]
mod tests {
    use crate::compile::compile;
    use crate::ir::print::listing;

    /// The float operations that a body becomes, with outputs `x` and `y` kept.
    fn operations(body: &str) -> Vec<String> {
        let text = format!("shader s(output float x = 0, output float y = 0) {{ {body} }}");
        let group = compile(&text).unwrap().group().keep_outputs().build().unwrap();
        let listing = listing(group.program(), group.table());
        let word =
            |line: &str| line.split(' ').nth(2).is_some_and(|word| ["add", "sub", "mul", "div", "min"].contains(&word));
        listing.lines().map(str::trim).filter(|line| word(line)).map(str::to_owned).collect()
    }

    #[test]
    fn a_result_with_one_reader_is_never_written() {
        assert_eq!(operations("x = u * v + 1;"), ["%0 = add (mul u, v), 1.0"]);
        assert_eq!(operations("x = 1 + u * v;"), ["%0 = add (mul u, v), 1.0"]);
        assert_eq!(operations("x = 1 - u * v;"), ["%0 = sub 1.0, (mul u, v)"]);
        assert_eq!(operations("x = min(u, v / 3);"), ["%0 = min u, (div v, 3.0)"]);
        assert_eq!(
            operations("x = u + v + u * v + 2;"),
            ["%0 = mul u, v", "%1 = add (add u, v), %0", "%2 = add %1, 2.0"]
        );
    }

    #[test]
    fn a_result_that_others_read_stays() {
        assert_eq!(operations("float t = u * v; x = t + 1; y = t - 1;").len(), 3);
        assert_eq!(operations("float t = u * v; x = t * t;").len(), 2);
        assert_eq!(operations("x = u * v; y = x + 1;"), ["%0 = mul u, v", "%1 = add %0, 1.0"], "an output");
        assert_eq!(operations("float t = u * v; x = sin(t); y = sin(t + 1);").len(), 2);
    }

    #[test]
    fn a_result_for_another_block_stays() {
        assert_eq!(operations("float t = u * v; if (v > 0.5) x = t + 1;").len(), 2);
        assert_eq!(operations("float t = u * v; for (int i = 0; i < 3; ++i) x += t;").len(), 2);
    }

    #[test]
    fn an_operand_that_changes_in_between_keeps_the_first_operation_where_it_is() {
        let rounds = |body: &str| operations(&format!("for (int i = 0; i < 3; ++i) {{ {body} }}"));
        assert_eq!(rounds("float t = x * u; x = t + v;"), ["%3 = add (mul %0!, u), v"]);
        assert_eq!(rounds("float t = x * u; x = v; y = t + v;").len(), 2);
        assert_eq!(rounds("float t = x * u; if (v > 0.5) x = v; y = t + v;").len(), 2, "in a branch");
        assert_eq!(rounds("float t = x * u; for (int j = 0; j < 2; ++j) x = v; y = t + v;").len(), 2, "in a loop");
        assert_eq!(rounds("float t = x * u; y = t + v; x = v;").len(), 1, "afterwards");
        // The second operation's other operand is read where it always was.
        assert_eq!(rounds("float t = v * u; x = v; y = t + x;").len(), 1);
    }

    #[test]
    fn a_number_for_all_lanes_is_not_computed_in_each() {
        let body = "float k = 1; for (int i = 0; i < 3; ++i) { k = k * 0.5; x += (k + 2) * u; }";
        let found = operations(body);
        assert!(found.iter().any(|line| line.contains("= add $")), "{found:?}");
        assert!(found.iter().any(|line| line.contains("(mul $") && line.contains(", u)")), "{found:?}");
    }

    #[test]
    fn nothing_is_fused_without_optimisation() {
        let shader = compile("shader s(output float x = 0) { x = u * v + 1; }").unwrap();
        let group = shader.group().keep_outputs().unoptimized().build().unwrap();
        assert!(!listing(group.program(), group.table()).contains('('));
    }
}
