//! Calls of `texture`, `environment` and `gettextureinfo`.

use super::operand::Given;
use super::place::Target;
use super::state::Lower;
use super::value::Value;
use crate::check::typed::{Argument, Expr, ExprKind};
use crate::ir::op::{Routine, TextureCall};
use crate::ir::program::{Kind, Reg};
use crate::lang::types::Base;

/// The options of a call, each in the registers that the routine wants them in.
struct TextureOptions {
    /// `swidth twidth sblur tblur fill`, three of `missingcolor`, `missingalpha`.
    floats: [Reg; 9],
    /// `firstchannel subimage`, and which of the two above are given.
    ints: [Reg; 3],
    /// `swrap twrap interp subimagename colorspace`
    strings: [Reg; 5],
    missing: i32,
    alpha: Option<Target>,
    message: Option<Target>,
}

impl Lower<'_> {
    /// A call of one of these functions, or nothing for any other.
    pub(super) fn texture_call(&mut self, name: &str, args: &[Argument], call: &Expr) -> Option<Value> {
        match name {
            "texture" | "environment" => Some(self.look_up(name == "environment", args, call)),
            "gettextureinfo" => Some(self.texture_info(args, call)),
            _ => None,
        }
    }

    fn look_up(&mut self, environment: bool, args: &[Argument], call: &Expr) -> Value {
        let is_text = |arg: &&Argument| arg.ty().base() == Some(Base::String);
        let coordinates = args[1..].iter().take_while(|arg| !is_text(arg)).count();
        let mut given = self.given(args).into_iter();
        self.at(call.span);
        let mut regs = |l: &mut Self| match given.next() {
            Some(Given::In(value)) => l.regs(&value),
            _ => Vec::new(),
        };
        let mut src = regs(self);
        let places: Vec<Vec<Reg>> = (0..coordinates).map(|_| regs(self)).collect();
        let places = self.with_slopes(environment, &places);
        src.extend(places);
        let options = self.texture_options(&args[1 + coordinates..], given);
        src.extend(options.floats);
        src.extend(&options.ints[..2]);
        src.push(self.b.int(options.missing));
        src.extend(options.strings);
        let channels = call.ty.base().map_or(1, Base::floats) as u32;
        let routine =
            Routine::Texture(TextureCall { channels, environment, slopes: false, asks: options.message.is_some() });
        let results = self.b.call(routine, src, self.span);
        let n = channels as usize;
        if let Some(target) = options.alpha {
            self.write(&target, &Value::Regs(vec![results[n]]));
        }
        if let Some(target) = options.message {
            let text = results[n + 2];
            self.write(&target, &Value::Regs(vec![text]));
        }
        Value::Regs(results[..n].to_vec())
    }

    /// The coordinates, then how each changes along x, then along y: as given, or their derivatives.
    fn with_slopes(&mut self, environment: bool, places: &[Vec<Reg>]) -> Vec<Reg> {
        let own = if environment { 1 } else { 2 };
        let mut out = places[..own].concat();
        if places.len() > own {
            // texture(file, s, t, dsdx, dtdx, dsdy, dtdy), environment(file, R, dRdx, dRdy)
            out.extend(places[own..].concat());
            return out;
        }
        for along_y in [false, true] {
            let slopes: Vec<Reg> = places[..own].concat().iter().map(|&reg| self.b.derivative(reg, along_y)).collect();
            out.extend(slopes);
        }
        out
    }

    fn texture_options(&mut self, args: &[Argument], mut given: impl Iterator<Item = Given>) -> TextureOptions {
        let (zero, one, empty, none) = (self.b.float(0.0), self.b.float(1.0), self.symbol(""), self.b.int(0));
        let mut options = TextureOptions {
            floats: [one, one, zero, zero, zero, zero, zero, zero, one],
            ints: [none; 3],
            strings: [empty; 5],
            missing: 0,
            alpha: None,
            message: None,
        };
        for pair in args.chunks(2) {
            let (_, value) = (given.next(), given.next());
            let name = match pair[0].read().map(|expr| &expr.kind) {
                Some(ExprKind::String(name)) => name.as_str(),
                _ => "",
            };
            match value {
                Some(Given::Out(target)) if name == "alpha" => options.alpha = Some(target),
                Some(Given::Out(target)) => options.message = Some(target),
                Some(Given::In(value)) => {
                    let regs = self.regs(&value);
                    self.set_option(&mut options, name, &regs);
                }
                None => {}
            }
        }
        options
    }

    fn set_option(&mut self, options: &mut TextureOptions, name: &str, regs: &[Reg]) {
        let Some(&first) = regs.first() else { return };
        let kind = self.b.program.kind(first);
        let floats: &[usize] = match name {
            "width" => &[0, 1],
            "swidth" => &[0],
            "twidth" => &[1],
            "blur" => &[2, 3],
            "sblur" => &[2],
            "tblur" => &[3],
            "fill" => &[4],
            "missingcolor" => &[5, 6, 7],
            "missingalpha" => &[8],
            _ => &[],
        };
        if matches!(kind, Kind::Float | Kind::Int) && !floats.is_empty() {
            for (at, &slot) in floats.iter().enumerate() {
                let reg = if regs.len() == floats.len() { regs[at] } else { first };
                options.floats[slot] = if kind == Kind::Int { self.b.int_to_float(reg) } else { reg };
            }
            options.missing |= i32::from(name == "missingcolor") | (i32::from(name == "missingalpha") << 1);
            return;
        }
        match (name, kind) {
            ("firstchannel", Kind::Int) => options.ints[0] = first,
            ("subimage", Kind::Int) => options.ints[1] = first,
            ("subimage", Kind::String) => options.strings[3] = first,
            ("wrap", Kind::String) => [options.strings[0], options.strings[1]] = [first; 2],
            ("swrap", Kind::String) => options.strings[0] = first,
            ("twrap", Kind::String) => options.strings[1] = first,
            ("interp", Kind::String) => options.strings[2] = first,
            ("colorspace", Kind::String) => options.strings[4] = first,
            // The checker has warned of what has no meaning.
            _ => {}
        }
    }

    /// `gettextureinfo(file, [s, t,] name, value)`
    fn texture_info(&mut self, args: &[Argument], call: &Expr) -> Value {
        let (read, out) = self.asked(args);
        self.at(call.span);
        // No place at all: any tile of a texture will do.
        let zero = self.b.float(f32::NAN);
        let (file, name) = (read[0], read[read.len() - 1]);
        let (s, t) = if read.len() == 4 { (read[1], read[2]) } else { (zero, zero) };
        let Some(out) = out else { return Value::Regs(vec![self.b.int(0)]) };
        Value::Regs(vec![self.ask(&out, vec![file, name, s, t], Routine::TextureInfo)])
    }
}
