//! Expressions of every type, with side effects inside, indices out of range and numbers at the ends of their range.

use crate::maker::{Fun, Maker, Var};

/// The types of single values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ty {
    Int,
    Float,
    Color,
    Point,
    Vector,
    Normal,
    Matrix,
    Str,
    Closure,
    /// The structure `Q`.
    Record,
}

impl Ty {
    /// Those that can be printed.
    pub const PRINTED: [Ty; 9] =
        [Ty::Int, Ty::Float, Ty::Color, Ty::Point, Ty::Vector, Ty::Normal, Ty::Matrix, Ty::Str, Ty::Closure];

    pub const ALL: [Ty; 10] = [
        Ty::Int,
        Ty::Float,
        Ty::Color,
        Ty::Point,
        Ty::Vector,
        Ty::Normal,
        Ty::Matrix,
        Ty::Str,
        Ty::Closure,
        Ty::Record,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Ty::Int => "int",
            Ty::Float => "float",
            Ty::Color => "color",
            Ty::Point => "point",
            Ty::Vector => "vector",
            Ty::Normal => "normal",
            Ty::Matrix => "matrix",
            Ty::Str => "string",
            Ty::Closure => "closure color",
            Ty::Record => "Q",
        }
    }

    /// The letter its variables begin with.
    pub fn letter(self) -> &'static str {
        match self {
            Ty::Int => "j",
            Ty::Float => "y",
            Ty::Color => "b",
            Ty::Point => "o",
            Ty::Vector => "d",
            Ty::Normal => "g",
            Ty::Matrix => "m",
            Ty::Str => "h",
            Ty::Closure => "l",
            Ty::Record => "w",
        }
    }

    pub fn format(self) -> &'static str {
        match self {
            Ty::Int => "%d",
            Ty::Str | Ty::Closure => "%s",
            _ => "%.9g",
        }
    }
}

const SPACES: &[&str] = &["\"common\"", "\"world\"", "\"mine\"", "\"nowhere\""];

impl Maker {
    /// Puts an index where a name asks for one.
    pub fn with_index(&mut self, name: &str, len: usize) -> String {
        if !name.contains('@') {
            return name.to_owned();
        }
        let index = self.index(len);
        name.replace('@', &index)
    }

    /// An index, mostly inside.
    pub fn index(&mut self, len: usize) -> String {
        match self.below(8) {
            0..=2 => self.below(len).to_string(),
            3 => self.pick(&["-1", "7", "2147483647"]).to_owned(),
            4 => self.expr(Ty::Int, 1),
            _ => format!("(abs({}) % {len})", self.expr(Ty::Int, 1)),
        }
    }

    fn find(&mut self, fits: impl Fn(&Var) -> bool) -> Option<Var> {
        let list: Vec<usize> = (0..self.vars.len()).filter(|&at| fits(&self.vars[at])).collect();
        if list.is_empty() {
            return None;
        }
        let at = self.pick(&list);
        Some(self.vars[at].clone())
    }

    /// A place of a type that may be assigned.
    pub fn place(&mut self, ty: Ty) -> Option<String> {
        if ty == Ty::Float && self.one_in(3) {
            let triple = [Ty::Color, Ty::Point, Ty::Vector, Ty::Normal, Ty::Matrix];
            if let Some(var) = self.find(|var| var.writable && triple.contains(&var.ty)) {
                return Some(self.component(var));
            }
        }
        let var = self.find(|var| var.writable && var.ty == ty)?;
        Some(self.whole(var))
    }

    /// A variable, or an element of it.
    fn whole(&mut self, var: Var) -> String {
        let name = self.with_index(&var.name, 2);
        if var.len == 0 { name } else { format!("{name}[{}]", self.index(var.len)) }
    }

    fn component(&mut self, var: Var) -> String {
        let matrix = var.ty == Ty::Matrix;
        let whole = self.whole(var);
        if matrix {
            format!("{whole}[{}][{}]", self.index(4), self.index(4))
        } else {
            format!("{whole}[{}]", self.index(3))
        }
    }

    /// A call of a function of this type, or of one without value.
    pub fn call(&mut self, ty: Option<Ty>, depth: u32) -> Option<String> {
        let list: Vec<usize> = (0..self.funs.len()).filter(|&at| self.funs[at].returns == ty).collect();
        if list.is_empty() {
            return None;
        }
        let at = self.pick(&list);
        let Fun { name, params, .. } = self.funs[at].clone();
        let mut args = Vec::new();
        for (ty, output) in params {
            args.push(if output { self.place(ty)? } else { self.expr(ty, depth.min(1)) });
        }
        Some(format!("{name}({})", args.join(", ")))
    }

    /// An expression of a type.
    pub fn expr(&mut self, ty: Ty, depth: u32) -> String {
        self.fuel -= 1;
        if depth == 0 || self.fuel < 0 {
            return self.leaf(ty);
        }
        let d = depth - 1;
        match self.below(12) {
            0 => self.leaf(ty),
            1 => {
                let c = self.expr(Ty::Int, d);
                format!("({c} ? {} : {})", self.expr(ty, d), self.expr(ty, d))
            }
            2 => match self.place(ty) {
                Some(place) => format!("({place} = {})", self.expr(ty, d)),
                None => self.leaf(ty),
            },
            3 => {
                let other = self.pick(&Ty::ALL);
                format!("({}, {})", self.expr(other, d), self.expr(ty, d))
            }
            4 => self.call(Some(ty), depth).unwrap_or_else(|| self.leaf(ty)),
            _ => self.operation(ty, d),
        }
    }

    fn leaf(&mut self, ty: Ty) -> String {
        if !self.one_in(3)
            && let Some(var) = self.find(|var| var.ty == ty)
        {
            return self.whole(var);
        }
        match ty {
            Ty::Int => self.pick(&["0", "1", "2", "-3", "7", "2147483647", "(-2147483647 - 1)"]).to_owned(),
            Ty::Float => {
                self.pick(&["0.0", "1.0", "0.5", "-2.5", "3.0", "3e38", "1e39", "-1e39", "1e-40", "-0.0"]).to_owned()
            }
            Ty::Color | Ty::Point | Ty::Vector | Ty::Normal => {
                let value = self.pick(&["0", "1", "0.25", "0.5, 1, 2", "-1, 0.0, 1e39", "3e38, 1, -3e38"]);
                format!("{}({value})", ty.name())
            }
            Ty::Matrix => self
                .pick(&["matrix(1)", "matrix(0.5)", "matrix(0)", "matrix(1,0,0,0, 0,2,0,0, 0,1,3,0, 4,5,6,1)"])
                .to_owned(),
            Ty::Str => self.pick(&["\"\"", "\"a\"", "\"b1\"", "\"perlin\"", "\"2.5\""]).to_owned(),
            Ty::Record => "made(0.5)".to_owned(),
            Ty::Closure => self
                .pick(&["diffuse(N)", "emission()", "transparent()", "(0 * emission())"])
                .replace("(N)", if self.vars.iter().any(|v| v.name == "N") { "(N)" } else { "(normal(0, 0, 1))" }),
        }
    }

    fn operation(&mut self, ty: Ty, d: u32) -> String {
        match ty {
            Ty::Int => self.int(d),
            Ty::Float => self.float(d),
            Ty::Color | Ty::Point | Ty::Vector | Ty::Normal => self.triple(ty, d),
            Ty::Matrix => self.matrix(d),
            Ty::Str => self.string(d),
            Ty::Closure => self.closure(d),
            Ty::Record => {
                let value = self.expr(Ty::Float, d);
                self.call(Some(ty), d).unwrap_or(format!("made({value})"))
            }
        }
    }

    fn int(&mut self, d: u32) -> String {
        let mut e = |ty| self.expr(ty, d);
        let (l, r) = (e(Ty::Int), e(Ty::Int));
        match self.below(24) {
            22 => format!("raytype({})", self.pick(&["\"camera\"", "\"shadow\"", "\"diffuse\""])),
            23 => format!("hash({}, {})", self.expr(Ty::Float, d), self.expr(Ty::Float, 0)),
            0..=4 => format!("({l} {} {r})", self.pick(&["+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>"])),
            5 | 6 => format!("({l} {} {r})", self.pick(&["<", "<=", ">", ">=", "==", "!="])),
            7 | 8 => {
                let (x, y) = (self.expr(Ty::Float, d), self.expr(Ty::Float, d));
                format!("({x} {} {y})", self.pick(&["<", "<=", ">", ">=", "==", "!="]))
            }
            9 | 10 => format!("({l} {} {r})", self.pick(&["&&", "||"])),
            11 => format!("{}({l})", self.pick(&["!", "~", "-"])),
            12 => format!("(int)({})", self.expr(Ty::Float, d)),
            13 => format!("{}({l}, {r})", self.pick(&["min", "max"])),
            14 => match self.place(Ty::Int) {
                Some(place) => self
                    .pick(&["@++", "@--", "(++@)", "(--@)"])
                    .replace('@', format!("({place})").trim_start_matches('(').trim_end_matches(')')),
                None => l,
            },
            15 => {
                let ty = self.pick(&[Ty::Color, Ty::Point, Ty::Matrix, Ty::Str]);
                format!("({} {} {})", self.expr(ty, d), self.pick(&["==", "!="]), self.expr(ty, d))
            }
            16 => format!("strlen({})", self.expr(Ty::Str, d)),
            17 => format!("{}({})", self.pick(&["isnan", "isinf", "isfinite"]), self.expr(Ty::Float, d)),
            18 => format!("!({})", self.expr(Ty::Closure, d)),
            19 => match self.place(Ty::Matrix) {
                Some(place) => format!("getmatrix({}, {}, {place})", self.pick(SPACES), self.pick(SPACES)),
                None => r,
            },
            20 => match self.place(Ty::Float) {
                Some(place) => format!("getattribute({}, {place})", self.pick(&["\"there\"", "\"absent\""])),
                None => r,
            },
            _ => format!("hash({})", self.expr(Ty::Int, d)),
        }
    }

    fn float(&mut self, d: u32) -> String {
        const ONE: &[&str] = &[
            "sqrt",
            "inversesqrt",
            "cbrt",
            "exp",
            "exp2",
            "log",
            "log2",
            "sin",
            "cos",
            "tan",
            "asin",
            "acos",
            "atan",
            "tanh",
            "floor",
            "ceil",
            "round",
            "trunc",
            "sign",
            "fabs",
            "erf",
            "-",
            "Dx",
            "Dy",
            "filterwidth",
        ];
        let (l, r) = (self.expr(Ty::Float, d), self.expr(Ty::Float, d));
        match self.below(22) {
            20 => format!("made({l}).f"),
            21 => {
                let array = |var: &Var| var.ty == Ty::Float && var.len == 3;
                match (self.find(array), self.find(array)) {
                    (Some(from), Some(to)) => format!("moved({}, {}, {})", from.name, self.expr(Ty::Int, d), to.name),
                    _ => r,
                }
            }
            0..=5 => format!("({l} {} {r})", self.pick(&["+", "-", "*", "/"])),
            6 | 7 => format!("{}({l})", self.pick(ONE)),
            8 => format!("{}({l}, {r})", self.pick(&["pow", "fmod", "atan2", "min", "max", "step"])),
            9 => format!("{}({l}, {r}, {})", self.pick(&["mix", "smoothstep", "clamp"]), self.expr(Ty::Float, d)),
            10 => format!("float({})", self.expr(Ty::Int, d)),
            11 | 12 => {
                let triple = [Ty::Color, Ty::Point, Ty::Vector, Ty::Normal, Ty::Matrix];
                self.find(|var| triple.contains(&var.ty)).map_or(l, |var| self.component(var))
            }
            13 => {
                let (x, y) = (self.expr(Ty::Vector, d), self.expr(Ty::Normal, d));
                self.pick(&["dot(@, #)", "length(@)", "distance(point(@), point(#))"]).replace('@', &x).replace('#', &y)
            }
            14 => self.noise(Ty::Float, d),
            15 => match self.place(Ty::Float) {
                Some(place) => format!("({place} {} {l})", self.pick(&["+=", "-=", "*=", "/="])),
                None => l,
            },
            16 => format!("luminance({})", self.expr(Ty::Color, d)),
            17 => format!("determinant({})", self.expr(Ty::Matrix, d)),
            18 => match self.find(|var| var.ty == Ty::Float && var.len > 1) {
                Some(var) => {
                    let basis = self.pick(&["linear", "bspline", "catmull-rom"]);
                    let name = self.with_index(&var.name, 2);
                    format!("spline(\"{basis}\", {l}, {}, {name})", self.pick(&["2", "3", "-1", "9"]))
                }
                None => r,
            },
            _ => format!("stof({})", self.expr(Ty::Str, d)),
        }
    }

    fn noise(&mut self, ty: Ty, d: u32) -> String {
        let name = self.pick(&["noise", "snoise", "cellnoise", "hashnoise"]);
        let (x, p) = (self.expr(Ty::Float, d), self.expr(Ty::Point, d));
        let args = match self.below(4) {
            0 => x,
            1 => p,
            2 => format!("{p}, {x}"),
            _ => format!("{x}, {}", self.expr(Ty::Float, 0)),
        };
        if self.one_in(4) {
            let kind = self.pick(&["perlin", "uperlin", "simplex", "usimplex", "cell", "hash"]);
            let kind = if self.one_in(3) { self.expr(Ty::Str, 0) } else { format!("\"{kind}\"") };
            let kind = if kind.starts_with('"') && !["\"perlin\""].contains(&kind.as_str()) && kind.len() < 6 {
                "\"cell\"".to_owned()
            } else {
                kind
            };
            return format!("({})noise({kind}, {args})", ty.name());
        }
        format!("({}){name}({args})", ty.name())
    }

    fn triple(&mut self, ty: Ty, d: u32) -> String {
        let (l, r) = (self.expr(ty, d), self.expr(ty, d));
        match self.below(16) {
            0..=3 => format!("{}({l} {} {r})", ty.name(), self.pick(&["+", "-", "*", "/"])),
            4 => format!("({l} {} {})", self.pick(&["*", "/"]), self.expr(Ty::Float, d)),
            5 | 6 => {
                let parts: Vec<String> = (0..3).map(|_| self.expr(Ty::Float, d)).collect();
                format!("{}({})", ty.name(), parts.join(", "))
            }
            7 => format!("{}({})", ty.name(), self.expr(Ty::Float, d)),
            8 => format!("{}(cross(vector({l}), vector({r})))", ty.name()),
            9 => format!("{}(normalize(vector({l})))", ty.name()),
            10 => self.noise(ty, d),
            11 => format!("mix({l}, {r}, {})", self.expr(Ty::Float, d)),
            12 => match ty {
                Ty::Color => match self.below(3) {
                    0 => format!("blackbody({})", self.expr(Ty::Float, d)),
                    1 => format!("transformc(\"hsv\", \"rgb\", {l})"),
                    _ => format!("color(\"hsl\", {}, 0.5, 0.5)", self.expr(Ty::Float, d)),
                },
                _ => format!("transform({}, {}, {l})", self.pick(SPACES), self.pick(SPACES)),
            },
            13 if ty != Ty::Color => format!("transform({}, {l})", self.expr(Ty::Matrix, d)),
            14 => format!("{}({l})", self.pick(&["Dx", "Dy", "floor", "fabs", "-"]))
                .replace("Dx(", if ty == Ty::Normal { "(normal)Dx(" } else { "Dx(" }),
            _ => {
                let other = self.pick(&[Ty::Color, Ty::Point, Ty::Vector, Ty::Normal]);
                format!("{}({})", ty.name(), self.expr(other, d))
            }
        }
    }

    fn matrix(&mut self, d: u32) -> String {
        match self.below(6) {
            0 => format!("({} * {})", self.expr(Ty::Matrix, d), self.expr(Ty::Matrix, d)),
            1 => format!("({} / {})", self.expr(Ty::Matrix, d), self.expr(Ty::Matrix, d)),
            2 => format!("transpose({})", self.expr(Ty::Matrix, d)),
            3 => format!("matrix({})", self.expr(Ty::Float, d)),
            4 => format!("matrix({}, {})", self.pick(SPACES), self.pick(SPACES)),
            _ => format!("({} * {})", self.expr(Ty::Matrix, d), self.expr(Ty::Float, d)),
        }
    }

    fn string(&mut self, d: u32) -> String {
        match self.below(4) {
            0 => format!("substr(concat({}, {}), 0, 12)", self.expr(Ty::Str, d), self.expr(Ty::Str, d)),
            1 => format!("format(\"%.9g\", {})", self.expr(Ty::Float, d)),
            2 => format!("substr({}, {}, {})", self.expr(Ty::Str, d), self.expr(Ty::Int, d), self.expr(Ty::Int, d)),
            _ => format!("format(\"%d\", {})", self.expr(Ty::Int, d)),
        }
    }

    fn closure(&mut self, d: u32) -> String {
        match self.below(7) {
            0 => format!("({} + {})", self.expr(Ty::Closure, d), self.expr(Ty::Closure, d)),
            1 => format!("({} * {})", self.expr(Ty::Float, d), self.expr(Ty::Closure, d)),
            2 => format!("({} * {})", self.expr(Ty::Closure, d), self.expr(Ty::Color, d)),
            3 => format!("diffuse({})", self.expr(Ty::Normal, d)),
            4 => format!("oren_nayar({}, {})", self.expr(Ty::Normal, d), self.expr(Ty::Float, d)),
            5 => {
                let (base, normal) = (self.expr(Ty::Closure, d), self.expr(Ty::Normal, 0));
                format!("sheen({base}, {normal}, {}, {})", self.expr(Ty::Color, d), self.expr(Ty::Float, d))
            }
            _ => format!("-({})", self.expr(Ty::Closure, d)),
        }
    }
}
