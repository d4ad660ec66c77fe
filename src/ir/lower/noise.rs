//! Noise calls.

use super::state::Lower;
use super::value::Value;
use crate::check::typed::{Argument, Expr, ExprKind};
use crate::ir::op::{Binary, Compare, IntBinary, Noise, NoiseKind, PrintTo, Routine, TextArg, TextFormat, Unary};
use crate::ir::program::{Kind, Node, Reg};
use crate::lang::symbols::Symbol;
use crate::lang::types::Base;

impl Lower<'_> {
    /// A call of a noise function, or nothing when it is none.
    pub(super) fn noise_call(&mut self, name: &str, args: &[Argument], call: &Expr) -> Option<Value> {
        let periodic = matches!(name, "pnoise" | "psnoise");
        let named = matches!(name, "noise" | "pnoise") && args[0].ty().base() == Some(Base::String);
        let kind = match name {
            "noise" | "pnoise" => NoiseKind::UPerlin,
            "snoise" | "psnoise" => NoiseKind::Perlin,
            "cellnoise" => NoiseKind::Cell,
            "hashnoise" => NoiseKind::Hash,
            _ => return None,
        };
        let outputs = call.ty.base().map_or(1, Base::floats) as u8;
        let noise = |dims: usize| Noise { kind, dims: dims as u8, outputs, periodic, gradient: false, filtered: false };
        let coordinates =
            args.iter().skip(named as usize).take_while(|arg| arg.ty().base() != Some(Base::String)).count();
        let values = self.arguments(args);
        let options = named as usize + coordinates;
        let src: Vec<Reg> = values[named as usize..options].concat();
        let noise = noise(src.len() / (1 + periodic as usize));
        self.at(call.span);
        if named {
            let name = values[0][0];
            let gabor = self.gabor_options(&args[options..], &values[options..]);
            return Some(Value::Regs(self.named_noise(name, noise, &src, gabor)));
        }
        Some(Value::Regs(self.noise(noise, &src, None)))
    }

    /// Direction, bandwidth, impulses, anisotropy and whether it is filtered, of Gabor noise, by the options of a call or as OSL has them without.
    fn gabor_options(&mut self, args: &[Argument], values: &[Vec<Reg>]) -> [Reg; 7] {
        let (zero, one, sixteen) = (self.b.float(0.0), self.b.float(1.0), self.b.float(16.0));
        let mut options = [one, zero, zero, one, sixteen, zero, one];
        for (pair, regs) in args.chunks(2).zip(values.chunks(2)) {
            let (Some(Argument::In(token)), [_, value]) = (pair.first(), regs) else { continue };
            let ExprKind::String(name) = &token.kind else { continue };
            let floats: Vec<Reg> = value.iter().map(|&reg| self.as_float(reg)).collect();
            match (name.as_str(), floats.as_slice()) {
                ("direction", [x, y, z]) => options[..3].copy_from_slice(&[*x, *y, *z]),
                ("bandwidth", [x]) => options[3] = *x,
                ("impulses", [x]) => options[4] = *x,
                ("anisotropic", [x]) => options[5] = *x,
                ("do_filter", [x]) => options[6] = *x,
                _ => {}
            }
        }
        options
    }

    fn as_float(&mut self, reg: Reg) -> Reg {
        if self.b.program.kind(reg) == Kind::Int { self.b.int_to_float(reg) } else { reg }
    }

    fn noise(&mut self, mut noise: Noise, src: &[Reg], gabor: Option<[Reg; 7]>) -> Vec<Reg> {
        let dims = noise.dims as usize;
        let mut src = src.to_vec();
        if let (NoiseKind::Gabor, Some([options @ .., filter])) = (noise.kind, gabor) {
            let pixel = self.noise_pixel(&src[..dims.min(3)], filter);
            noise.filtered = !pixel.is_empty();
            src.extend(options);
            src.extend(pixel);
        }
        if noise.periodic && matches!(noise.kind, NoiseKind::Cell | NoiseKind::Hash) {
            // What looks at whole cells repeats when its coordinates do.
            src = (0..dims).map(|i| self.wrapped(src[i], src[dims + i])).collect();
            noise.periodic = false;
        }
        self.b.call(Routine::Noise(noise), src, self.span)
    }

    /// How coordinates change along x, then along y, where the noise is filtered and more than a line of it is seen; as much as nothing where
    /// the filter is found to be off when it runs.
    fn noise_pixel(&mut self, coordinates: &[Reg], filter: Reg) -> Vec<Reg> {
        let known = self.b.known_float(filter);
        if coordinates.len() < 2 || known == Some(0.0) {
            return Vec::new();
        }
        let zero = self.b.float(0.0);
        let on = known.is_none().then(|| self.b.compare(Compare::Ne, filter, zero));
        let mut pixel = Vec::new();
        for along_y in [false, true] {
            for &coordinate in coordinates {
                let change = self.b.derivative(coordinate, along_y);
                pixel.push(on.map_or(change, |on| self.b.select(on, change, zero)));
            }
        }
        pixel
    }

    /// A coordinate brought into `0..period`; periods are whole numbers from 1 on.
    fn wrapped(&mut self, x: Reg, period: Reg) -> Reg {
        let one = self.b.float(1.0);
        let whole = self.b.unary(Unary::Floor, period);
        let period = self.b.binary(Binary::Max, whole, one);
        let quotient = self.b.binary(Binary::Div, x, period);
        let rounds = self.b.unary(Unary::Floor, quotient);
        let offset = self.b.binary(Binary::Mul, period, rounds);
        self.b.binary(Binary::Sub, x, offset)
    }

    /// Noise whose kind is a string: known here, or compared with every name when it runs.
    fn named_noise(&mut self, name: Reg, mut noise: Noise, src: &[Reg], gabor: [Reg; 7]) -> Vec<Reg> {
        if let Some(known) = self.b.known_int(name)
            && let Some(kind) =
                NoiseKind::from_name(Symbol(known).text()).filter(|kind| !noise.periodic || kind.repeats())
        {
            noise.kind = kind;
            return self.noise(noise, src, Some(gabor));
        }
        let gabor = gabor.map(|reg| self.fixed(reg));
        let (name, zero) = (self.fixed(name), self.b.float(0.0));
        let src: Vec<Reg> = src.iter().map(|&reg| self.fixed(reg)).collect();
        let result: Vec<Reg> = (0..noise.outputs).map(|_| self.b.copy(zero, true)).collect();
        self.noise_choice(name, noise, (&src, gabor), &result, NoiseKind::ALL);
        result.into_iter().map(|reg| self.fixed(reg)).collect()
    }

    fn noise_choice(
        &mut self,
        name: Reg,
        mut noise: Noise,
        (src, gabor): (&[Reg], [Reg; 7]),
        result: &[Reg],
        kinds: &[NoiseKind],
    ) {
        let Some((&kind, others)) = kinds.split_first() else {
            let text = "there is no noise \"%s\"".to_owned();
            let format = TextFormat { text, computed: false, args: vec![TextArg::Strings(1)] };
            self.b.call(Routine::Print(PrintTo::UnknownNoise, format), vec![name], self.span);
            return;
        };
        if noise.periodic && !kind.repeats() {
            return self.noise_choice(name, noise, (src, gabor), result, others);
        }
        let mut test = self.b.int(0);
        for text in kind.names() {
            let text = self.symbol(text);
            let same = self.b.int_binary(IntBinary::Eq, name, text);
            test = self.b.int_binary(IntBinary::Or, test, same);
        }
        self.b.open();
        noise.kind = kind;
        let value = self.noise(noise, src, Some(gabor));
        self.store(&Value::Regs(result.to_vec()), &Value::Regs(value));
        let then = self.b.close();
        self.b.open();
        self.noise_choice(name, noise, (src, gabor), result, others);
        let otherwise = self.b.close();
        self.b.push(Node::If(test, then, otherwise));
    }
}
