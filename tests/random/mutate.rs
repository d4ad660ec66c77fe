//! Choices from one stream of numbers, and programs that differ from real ones in a few places.

use velour::ir::op::*;
use velour::ir::program::*;
use velour::lang::closures::ClosureId;

/// A stream of choices.
pub struct Choice(u64);

impl Choice {
    pub fn new(seed: u64) -> Self {
        Choice(seed)
    }

    /// A number below `n`, which is not zero.
    pub fn below(&mut self, n: usize) -> usize {
        // xorshift64*: enough for choices.
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) % n as u64) as usize
    }

    /// True once in `n` times.
    pub fn once_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    /// A register, mostly one that is there.
    pub fn reg(&mut self, count: usize) -> Reg {
        let beyond = self.once_in(20);
        Reg(self.below(count + if beyond { 3 } else { 0 }).min(if beyond { usize::MAX } else { count - 1 }) as u32)
    }

    pub fn kind(&mut self) -> Kind {
        [Kind::Float, Kind::Int, Kind::String, Kind::Closure][self.below(4)]
    }
}

/// Calls `visit` for every register that an instruction names.
fn registers(instr: &mut Instr, visit: &mut impl FnMut(&mut Reg)) {
    match instr {
        Instr::Unary(_, a, b) | Instr::Test(_, a, b) | Instr::IntUnary(_, a, b) | Instr::IntToFloat(a, b) => {
            [a, b].into_iter().for_each(visit);
        }
        Instr::FloatToInt(a, b) | Instr::Derivative(a, b, _) | Instr::ClosureAbsent(a, b) => {
            [a, b].into_iter().for_each(visit)
        }
        Instr::Move { dst, src, .. } => [dst, src].into_iter().for_each(visit),
        Instr::Binary(_, a, b, c)
        | Instr::Compare(_, a, b, c)
        | Instr::IntBinary(_, a, b, c)
        | Instr::ClosureAdd(a, b, c) => {
            [a, b, c].into_iter().for_each(visit);
        }
        Instr::Select(a, b, c, d) | Instr::ClosureSelect(a, b, c, d) => [a, b, c, d].into_iter().for_each(visit),
        Instr::Fused(_, d, abc) => [d].into_iter().chain(abc).for_each(visit),
        Instr::ClosureScale(d, a, w) => [d, a].into_iter().chain(w).for_each(visit),
        Instr::ArrayGet { dst, index, .. } => [dst, index].into_iter().for_each(visit),
        Instr::ArraySet { index, src, .. } => [index, src].into_iter().for_each(visit),
        Instr::Call { dst, src, .. } => dst.iter_mut().chain(src).for_each(visit),
        Instr::Leaf { dst, params, keywords, .. } => {
            [dst].into_iter().chain(params).chain(keywords.iter_mut().flat_map(|k| &mut k.1)).for_each(visit);
        }
    }
}

/// A block somewhere in a program.
fn some_block<'b>(block: &'b mut Block, choice: &mut Choice) -> &'b mut Block {
    let inner = block.iter().position(|node| !matches!(node, Node::Instr(_) | Node::Leave(_)));
    if choice.once_in(2) || inner.is_none() {
        return block;
    }
    let nested: Vec<usize> =
        (0..block.len()).filter(|&at| !matches!(block[at], Node::Instr(_) | Node::Leave(_))).collect();
    let at = nested[choice.below(nested.len())];
    match &mut block[at] {
        Node::If(_, a, b) => some_block(if choice.once_in(2) { a } else { b }, choice),
        Node::Loop { head, body, .. } => some_block(if choice.once_in(3) { head } else { body }, choice),
        Node::Scope(_, body) => some_block(body, choice),
        Node::Instr(_) | Node::Leave(_) => unreachable!("only nodes with blocks are listed"),
    }
}

/// A program with one to three changes.
pub fn mutated(program: &Program, choice: &mut Choice) -> Program {
    let mut program = program.clone();
    for _ in 0..1 + choice.below(3) {
        match choice.below(8) {
            0 => register(&mut program, choice),
            1 => array(&mut program, choice),
            2 => {
                let count = program.regs.len();
                program.result = Some(choice.reg(count)).filter(|_| !choice.once_in(3));
                program.scopes = choice.below(4) as u32;
            }
            3 => nodes(&mut program, choice),
            _ => instruction(&mut program, choice),
        }
    }
    program
}

fn register(program: &mut Program, choice: &mut Choice) {
    let at = choice.below(program.regs.len());
    let kind = choice.kind();
    let info = &mut program.regs[at];
    match choice.below(5) {
        0 => info.kind = kind,
        1 => info.mutable = !info.mutable,
        2 => info.uniform = !info.uniform,
        3 => info.source = Source::Code,
        _ => info.source = Source::Const(Const::Int(choice.below(9) as i32 - 4)),
    }
}

fn array(program: &mut Program, choice: &mut Choice) {
    if program.arrays.is_empty() {
        return;
    }
    let at = choice.below(program.arrays.len());
    let kind = choice.kind();
    let info = &mut program.arrays[at];
    match choice.below(4) {
        0 => info.kind = kind,
        1 => info.len = choice.below(6) as u32,
        2 => info.components = choice.below(4) as u32,
        _ => info.uniform = !info.uniform,
    }
}

/// Takes a node away, doubles one, or exchanges two.
fn nodes(program: &mut Program, choice: &mut Choice) {
    let block = some_block(&mut program.body, choice);
    if block.is_empty() {
        return;
    }
    let (at, other) = (choice.below(block.len()), choice.below(block.len()));
    match choice.below(4) {
        0 => drop(block.remove(at)),
        1 => block.insert(at, block[other].clone()),
        2 => block.insert(at, Node::Leave(ScopeId(choice.below(2) as u32))),
        _ => block.swap(at, other),
    }
}

fn instruction(program: &mut Program, choice: &mut Choice) {
    let (regs, arrays) = (program.regs.len(), program.arrays.len());
    let block = some_block(&mut program.body, choice);
    let places: Vec<usize> = (0..block.len()).filter(|&at| matches!(block[at], Node::Instr(_))).collect();
    if places.is_empty() {
        return;
    }
    let Node::Instr(instr) = &mut block[places[choice.below(places.len())]] else { return };
    if choice.once_in(2) {
        let mut count = 0;
        registers(instr, &mut |_| count += 1);
        let (wanted, new) = (choice.below(count.max(1)), choice.reg(regs));
        let mut at = 0;
        registers(instr, &mut |reg| {
            if at == wanted {
                *reg = new;
            }
            at += 1;
        });
        return;
    }
    match instr {
        Instr::ArrayGet { array, component, .. } | Instr::ArraySet { array, component, .. } => {
            *array = ArrayId(choice.below(arrays + 1) as u32);
            *component = choice.below(4) as u32;
        }
        Instr::Move { masked, .. } => *masked = !*masked,
        Instr::Call { routine, dst, src, .. } => match choice.below(3) {
            0 => drop(dst.pop()),
            1 => drop(src.pop()),
            _ => *routine = another(choice),
        },
        Instr::Leaf { closure, params, keywords, .. } => match choice.below(3) {
            0 => *closure = ClosureId(choice.below(60) as u32),
            1 => drop(params.pop()),
            _ => keywords.push((choice.below(6) as u32, vec![choice.reg(regs)])),
        },
        Instr::Fused(pair, ..) => pair.first = [Binary::Add, Binary::Pow, Binary::Mul][choice.below(3)],
        other => {
            let (a, b) = (choice.reg(regs), choice.reg(regs));
            *other = Instr::Move { dst: a, src: b, masked: choice.once_in(2) };
        }
    }
}

/// A routine of any shape, one that exists or not.
pub fn another(choice: &mut Choice) -> Routine {
    let number = |choice: &mut Choice| choice.below(6) as u32;
    let kinds = NoiseKind::ALL;
    match choice.below(12) {
        0 | 1 => Routine::Noise(Noise {
            kind: kinds[choice.below(kinds.len())],
            dims: choice.below(6) as u8,
            outputs: [1, 3, 1, 3, 2][choice.below(5)],
            periodic: choice.once_in(3),
            gradient: choice.once_in(3),
            filtered: choice.once_in(3),
        }),
        2 => Routine::Smooth(function(choice)),
        3 => Routine::Slope(function(choice)),
        4 => Routine::HashFloats(number(choice)),
        5 => Routine::Regex { whole: choice.once_in(2), positions: number(choice) },
        6 => Routine::Split(number(choice)),
        7 => {
            let count = number(choice);
            let ty = [AttributeType::Ints(count), AttributeType::Floats(count), AttributeType::Strings(count)]
                [choice.below(3)];
            Routine::Attribute(AttributeQuery {
                ty,
                slopes: choice.once_in(2),
                of: AttributeOf::Attribute,
                indexed: choice.once_in(3),
            })
        }
        8 => Routine::Format(format(choice)),
        9 => {
            let to = [PrintTo::Output, PrintTo::File, PrintTo::Warning, PrintTo::Error][choice.below(4)];
            Routine::Print(to, format(choice))
        }
        _ => {
            let all = [
                Routine::SpaceMatrix,
                Routine::HashInt,
                Routine::HashString,
                Routine::Strlen,
                Routine::GetChar,
                Routine::StartsWith,
                Routine::EndsWith,
                Routine::Substr,
                Routine::Concat,
                Routine::Stof,
                Routine::Stoi,
                Routine::RayType,
            ];
            all[choice.below(all.len())].clone()
        }
    }
}

fn function(choice: &mut Choice) -> Smooth {
    let knots = choice.below(8) as u32;
    [
        Smooth::Spline(knots),
        Smooth::SplineInverse(knots),
        Smooth::MatrixInverse,
        Smooth::Determinant,
        Smooth::Blackbody,
        Smooth::WavelengthColor,
        Smooth::TransformColor,
        Smooth::TransformUnit,
    ][choice.below(8)]
}

/// A format whose text may or may not fit its arguments.
fn format(choice: &mut Choice) -> TextFormat {
    let args = (0..choice.below(3))
        .map(|_| [TextArg::Ints(1), TextArg::Floats(3), TextArg::Strings(1), TextArg::Floats(0)][choice.below(4)]);
    let args = args.collect();
    let text = ["%d %g %s", "%s", "", "%", "%*d", "%5.3f\n"][choice.below(6)].to_owned();
    TextFormat { computed: false, text, args }
}
