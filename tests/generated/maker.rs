//! Makes up typed shaders: the choices, the names in scope, and statements. One statement a line, so that lines can be cut.

use crate::expression::Ty;

/// A variable in scope.
#[derive(Clone)]
pub struct Var {
    pub name: String,
    pub ty: Ty,
    /// Elements of an array; 0 for a single value.
    pub len: usize,
    pub writable: bool,
}

/// A function that may be called.
#[derive(Clone)]
pub struct Fun {
    pub name: String,
    pub returns: Option<Ty>,
    /// Type of each parameter, and whether it is written.
    pub params: Vec<(Ty, bool)>,
}

/// The program so far, and the stream of choices.
pub struct Maker {
    state: u64,
    pub lines: Vec<String>,
    pub vars: Vec<Var>,
    pub funs: Vec<Fun>,
    /// How much more may be written; 0 asks for the simplest.
    pub fuel: i32,
    /// The loops around the statement.
    loops: u32,
    depth: u32,
    names: u32,
    /// What `return` gives here; nothing in a shader or a function without value.
    returns: Option<Ty>,
    /// True where a `return` may stand.
    in_function: bool,
}

/// What every shader has: a structure, what makes one, and a function on arrays.
const HEAD: [&str; 3] = [
    "struct Q { float f; int k[2]; color c; string s; matrix m; };",
    "Q made(float f) { Q z; z.f = f; if (f > 1) { z.k[1] = 3; return z; } z.c[1] = f; return z; }",
    "float moved(float z[], int n, output float w[]) { w[n] = z[0] + w[1]; if (z[1] > 2) return z[n]; w[0] = 0.5; return z[2]; }",
];

impl Maker {
    pub fn new(seed: u64) -> Self {
        Maker {
            state: seed,
            lines: HEAD.map(str::to_owned).to_vec(),
            vars: Vec::new(),
            funs: Vec::new(),
            fuel: 0,
            loops: 0,
            depth: 0,
            names: 0,
            returns: None,
            in_function: false,
        }
    }

    pub fn below(&mut self, n: usize) -> usize {
        // xorshift64*: enough for choices.
        self.state ^= self.state >> 12;
        self.state ^= self.state << 25;
        self.state ^= self.state >> 27;
        ((self.state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) % n as u64) as usize
    }

    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }

    fn line(&mut self, text: String) {
        self.lines.push(text);
    }

    fn fresh(&mut self, letter: &str) -> String {
        self.names += 1;
        format!("{letter}{}", self.names)
    }

    fn add(&mut self, name: &str, ty: Ty, len: usize, writable: bool) {
        self.vars.push(Var { name: name.to_owned(), ty, len, writable });
    }

    /// The parts of a variable of the structure.
    fn add_structure(&mut self, name: &str, writable: bool) {
        let parts =
            [("f", Ty::Float, 0), ("k", Ty::Int, 2), ("c", Ty::Color, 0), ("s", Ty::Str, 0), ("m", Ty::Matrix, 0)];
        for (part, ty, len) in parts {
            self.add(&format!("{name}.{part}"), ty, len, writable);
        }
    }

    /// A whole shader.
    pub fn shader(mut self) -> Vec<String> {
        for _ in 0..self.below(3) {
            self.function();
        }
        let before = self.vars.len();
        self.line(
            "shader s(output float x = 0.5, output int i = 3, output color c = color(1, 2, 3), output string t = \"a\", output float a[3] = {1, 2, 3}, output Q q = {0.5, {1, 2}, 3, \"b\", 4}) {"
                .to_owned(),
        );
        self.globals();
        for (name, ty, len) in
            [("x", Ty::Float, 0), ("i", Ty::Int, 0), ("c", Ty::Color, 0), ("t", Ty::Str, 0), ("a", Ty::Float, 3)]
        {
            self.add(name, ty, len, true);
        }
        self.add("q", Ty::Record, 0, true);
        self.add_structure("q", true);
        self.fuel = 100;
        self.declarations();
        for _ in 0..self.below(3) {
            self.function();
        }
        self.fuel = 60 + self.below(300) as i32;
        self.statements(6);
        self.line("printf(\"%.9g %d %.9g %s %.9g %s\\n\", x, i, c, t, a, Ci);".to_owned());
        self.line("}".to_owned());
        self.vars.truncate(before);
        self.lines
    }

    fn globals(&mut self) {
        for (name, ty, writable) in [
            ("P", Ty::Point, true),
            ("N", Ty::Normal, true),
            ("I", Ty::Vector, true),
            ("Ci", Ty::Closure, true),
            ("u", Ty::Float, false),
            ("v", Ty::Float, false),
            ("Ng", Ty::Normal, false),
            ("dPdu", Ty::Vector, false),
        ] {
            self.add(name, ty, 0, writable);
        }
    }

    /// Variables of every type, some without a value.
    fn declarations(&mut self) {
        for ty in Ty::ALL {
            if self.one_in(3) {
                continue;
            }
            self.declaration(ty);
        }
        if self.one_in(2) {
            self.line("Q r[2];".to_owned());
            self.add("r[@]", Ty::Record, 0, true);
            self.add_structure("r[@]", true);
        }
    }

    fn declaration(&mut self, ty: Ty) {
        let name = self.fresh(ty.letter());
        if ty == Ty::Record {
            let value = self.expr(ty, 2);
            self.line(format!("Q {name} = {value};"));
            self.add(&name, ty, 0, true);
            return self.add_structure(&name, true);
        }
        match self.below(4) {
            0 => {
                self.line(format!("{} {name};", ty.name()));
                self.add(&name, ty, 0, true);
            }
            1 if ty != Ty::Matrix => {
                let values: Vec<String> = (0..2).map(|_| self.expr(ty, 1)).collect();
                self.line(format!("{} {name}[2] = {{{}}};", ty.name(), values.join(", ")));
                self.add(&name, ty, 2, true);
            }
            _ => {
                let value = self.expr(ty, 2);
                self.line(format!("{} {name} = {value};", ty.name()));
                self.add(&name, ty, 0, true);
            }
        }
    }

    /// A function, which sees the variables in scope; it is called by what follows.
    fn function(&mut self) {
        let name = self.fresh("f");
        let returns = if self.one_in(3) { None } else { Some(self.pick(&Ty::ALL)) };
        let count = 1 + self.below(3);
        let (scope, in_function, before) = (self.vars.len(), self.in_function, self.returns);
        let (mut params, mut heads) = (Vec::new(), Vec::new());
        for _ in 0..count {
            let (ty, output, param) = (self.pick(&Ty::ALL), self.one_in(2), self.fresh("p"));
            heads.push(format!("{}{} {param}", if output { "output " } else { "" }, ty.name()));
            params.push((ty, output));
            self.add(&param, ty, 0, output);
            if ty == Ty::Record {
                self.add_structure(&param, output);
            }
        }
        let head = returns.map_or("void", Ty::name);
        self.line(format!("{head} {name}({}) {{", heads.join(", ")));
        let (loops, depth) = (std::mem::take(&mut self.loops), std::mem::replace(&mut self.depth, 1));
        (self.in_function, self.returns, self.fuel) = (true, returns, 40);
        self.statements(3);
        if let Some(ty) = returns {
            let value = self.expr(ty, 1);
            self.line(format!("return {value};"));
        }
        self.line("}".to_owned());
        (self.in_function, self.returns, self.loops, self.depth) = (in_function, before, loops, depth);
        self.vars.truncate(scope);
        self.funs.push(Fun { name, returns, params });
    }

    fn statements(&mut self, most: usize) {
        let scope = self.vars.len();
        for _ in 0..1 + self.below(most) {
            self.statement();
        }
        self.vars.truncate(scope);
    }

    fn block(&mut self, head: String) {
        self.line(format!("{head} {{"));
        self.depth += 1;
        self.statements(4);
        self.depth -= 1;
        self.line("}".to_owned());
    }

    fn statement(&mut self) {
        self.fuel -= 4;
        let ty = self.pick(&Ty::ALL);
        match self.below(18) {
            0..=4 => self.assignment(ty),
            5 => self.declaration(ty),
            6 | 7 if self.depth < 4 && self.fuel > 0 => {
                let condition = self.expr(Ty::Int, 2);
                self.block(format!("if ({condition})"));
                if self.one_in(2) {
                    self.block("else".to_owned());
                }
            }
            8 | 9 if self.depth < 4 && self.loops < 2 && self.fuel > 0 => self.repetition(),
            10 if self.loops > 0 => {
                let condition = self.expr(Ty::Int, 1);
                let word = self.pick(&["break", "continue"]);
                self.line(format!("if ({condition}) {word};"));
            }
            11 if self.in_function || self.depth > 0 => self.leave(),
            12 => {
                let ty = self.pick(&Ty::PRINTED);
                let value = self.expr(ty, 2);
                self.line(format!("printf(\"{}\\n\", {value});", ty.format()));
            }
            13 => {
                let ty = self.pick(&Ty::PRINTED);
                let (x, y, z) = (self.expr(ty, 1), self.expr(ty, 1), self.expr(Ty::Float, 1));
                self.line(format!("printf(\"{0} {0} %.9g\\n\", {x}, {y}, {z});", ty.format()));
            }
            14 => {
                let value = self.expr(Ty::Closure, 2);
                match self.sees("Ci") {
                    true => self.line(format!("Ci += {value};")),
                    false => self.line(format!("{value};")),
                }
            }
            15 | 16 => {
                let call = self.call(None, 1);
                let value = call.unwrap_or_else(|| self.expr(ty, 2));
                self.line(format!("{value};"));
            }
            _ => self.assignment(Ty::Record),
        }
    }

    fn sees(&self, name: &str) -> bool {
        self.vars.iter().any(|var| var.name == name)
    }

    fn assignment(&mut self, ty: Ty) {
        let Some(place) = self.place(ty) else { return self.declaration(ty) };
        let value = self.expr(ty, 3);
        let op = match ty {
            Ty::Int => self.pick(&["=", "=", "+=", "-=", "*=", "^=", "|=", "<<="]),
            Ty::Float | Ty::Color | Ty::Point | Ty::Vector | Ty::Normal => {
                self.pick(&["=", "=", "+=", "-=", "*=", "/="])
            }
            Ty::Matrix | Ty::Str | Ty::Closure | Ty::Record => "=",
        };
        self.line(format!("{place} {op} {value};"));
    }

    /// A loop of a few rounds, whose counter nothing else writes.
    fn repetition(&mut self) {
        let (name, scope) = (self.fresh("n"), self.vars.len());
        let limit = match self.below(4) {
            0 => "3".to_owned(),
            1 => "u * 4".to_owned(),
            2 => format!("({} & 3)", self.expr(Ty::Int, 1)),
            _ => "2".to_owned(),
        };
        let limit = if self.sees("u") { limit } else { "3".to_owned() };
        self.add(&name, Ty::Int, 0, false);
        self.loops += 1;
        match self.below(3) {
            0 => self.block(format!("for (int {name} = 0; {name} < {limit} && {name} < 4; ++{name})")),
            1 => {
                self.line(format!("int {name} = 0;"));
                self.block(format!("while ({name}++ < 2 && {} > {name})", limit.replace("u * 4", "3")));
            }
            _ => {
                self.line(format!("int {name} = 0;"));
                self.line("do {".to_owned());
                self.depth += 1;
                self.statements(4);
                self.depth -= 1;
                let condition = self.expr(Ty::Int, 1);
                self.line(format!("}} while (++{name} < 3 && {condition});"));
            }
        }
        self.loops -= 1;
        self.vars.truncate(scope);
        // The counter stays declared, and may be read.
        self.add(&name, Ty::Int, 0, false);
        self.vars.pop();
    }

    fn leave(&mut self) {
        let condition = self.expr(Ty::Int, 1);
        let word = match (self.in_function, self.returns) {
            (true, Some(ty)) => format!("return {}", self.expr(ty, 1)),
            _ => self.pick(&["return", "return", "exit()"]).to_owned(),
        };
        self.line(format!("if ({condition}) {word};"));
    }
}
