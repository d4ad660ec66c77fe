//! The tree as text: normalised OSL that parses back to an equal tree, spans aside.

mod expression;
mod types;

pub use types::print_type;

use crate::ast::*;
use std::fmt::Write;

/// Prints a translation unit.
pub fn print(file: &File) -> String {
    let mut printer = Printer { out: String::new(), indent: 0 };
    for (i, item) in file.items.iter().enumerate() {
        if i > 0 {
            printer.out.push('\n');
        }
        match item {
            Item::Struct(s) => printer.structure(s),
            Item::Function(f) => printer.function(f),
            Item::Shader(s) => printer.shader(s),
        }
    }
    printer.out
}

/// Prints one expression.
pub fn print_expr(expr: &Expr) -> String {
    let mut out = String::new();
    expression::write(expr, &mut out);
    out
}

/// The word that starts a shader.
fn kind_word(kind: ShaderKind) -> &'static str {
    match kind {
        ShaderKind::Generic => "shader",
        ShaderKind::Surface => "surface",
        ShaderKind::Displacement => "displacement",
        ShaderKind::Volume => "volume",
    }
}

fn brackets(array: ArrayLen) -> String {
    match array {
        ArrayLen::Single => String::new(),
        ArrayLen::Unsized => "[]".into(),
        // A negative length can be written in hexadecimal only, as all negative literals.
        ArrayLen::Sized(n) if n < 0 => format!("[{n:#x}]"),
        ArrayLen::Sized(n) => format!("[{n}]"),
    }
}

struct Printer {
    out: String,
    indent: usize,
}

impl Printer {
    fn line(&mut self, text: &str) {
        self.margin();
        self.out.push_str(text);
        self.out.push('\n');
    }

    fn margin(&mut self) {
        for _ in 0..self.indent {
            self.out.push_str("    ");
        }
    }

    fn structure(&mut self, decl: &StructDecl) {
        self.line(&format!("struct {} {{", decl.name.name));
        for field in &decl.fields {
            self.line(&format!("    {} {}{};", print_type(&field.ty), field.name.name, brackets(field.array)));
        }
        self.line("};");
    }

    fn shader(&mut self, decl: &ShaderDecl) {
        let _ = write!(self.out, "{} {}", kind_word(decl.kind), decl.name.name);
        self.metadata(&decl.metadata);
        self.out.push_str(if decl.params.is_empty() { "(" } else { "(\n" });
        for (i, param) in decl.params.iter().enumerate() {
            self.out.push_str("    ");
            self.param(param);
            self.out.push_str(if i + 1 < decl.params.len() { ",\n" } else { "\n" });
        }
        self.out.push_str(") {\n");
        self.body(&decl.body);
    }

    fn function(&mut self, decl: &FunctionDecl) {
        self.margin();
        let _ = write!(self.out, "{} {}(", print_type(&decl.return_type), decl.name.name);
        for (i, param) in decl.params.iter().enumerate() {
            if i > 0 {
                self.out.push_str(", ");
            }
            self.param(param);
        }
        self.out.push(')');
        self.metadata(&decl.metadata);
        match &decl.body {
            None => self.out.push_str(";\n"),
            Some(body) => {
                self.out.push_str(" {\n");
                self.body(body);
            }
        }
    }

    fn param(&mut self, param: &Param) {
        if param.output {
            self.out.push_str("output ");
        }
        self.declarator(&param.ty, &param.name, param.array, param.default.as_deref());
        self.metadata(&param.metadata);
    }

    fn declarator(&mut self, ty: &TypeSpec, name: &Ident, array: ArrayLen, init: Option<&Expr>) {
        let _ = write!(self.out, "{} ", print_type(ty));
        self.named(name, array, init);
    }

    fn named(&mut self, name: &Ident, array: ArrayLen, init: Option<&Expr>) {
        let _ = write!(self.out, "{}{}", name.name, brackets(array));
        if let Some(init) = init {
            self.out.push_str(" = ");
            expression::write_item(init, &mut self.out);
        }
    }

    fn metadata(&mut self, list: &[Metadata]) {
        if list.is_empty() {
            return;
        }
        self.out.push_str(" [[ ");
        for (i, item) in list.iter().enumerate() {
            if i > 0 {
                self.out.push_str(", ");
            }
            self.declarator(&item.ty, &item.name, item.array, Some(&item.value));
        }
        self.out.push_str(" ]]");
    }

    /// The statements of a block and its closing brace; the opening one has been printed.
    fn body(&mut self, body: &[Stmt]) {
        self.indent += 1;
        for stmt in body {
            self.stmt(stmt);
        }
        self.indent -= 1;
        self.line("}");
    }

    fn stmt(&mut self, stmt: &Stmt) {
        if let StmtKind::Function(f) = &stmt.kind {
            return self.function(f);
        }
        self.margin();
        self.unindented(stmt);
    }

    /// A statement whose first line has its margin already.
    fn unindented(&mut self, stmt: &Stmt) {
        match &stmt.kind {
            StmtKind::Function(f) => {
                self.out.truncate(self.out.trim_end_matches(' ').len());
                self.function(f);
            }
            StmtKind::Block(body) => {
                self.out.push_str("{\n");
                self.body(body);
            }
            StmtKind::If { condition, then, otherwise } => self.branch(condition, then, otherwise.as_deref()),
            StmtKind::While { condition, body } => {
                let _ = write!(self.out, "while ({})", print_expr(condition));
                self.nested(body);
            }
            StmtKind::DoWhile { body, condition } => {
                self.out.push_str("do");
                self.nested(body);
                self.line(&format!("while ({});", print_expr(condition)));
            }
            StmtKind::For { init, condition, step, body } => {
                self.out.push_str("for (");
                self.simple(init);
                for (before, part, after) in [(" ", condition, ";"), (" ", step, ")")] {
                    if let Some(expr) = part {
                        self.out.push_str(before);
                        expression::write(expr, &mut self.out);
                    }
                    self.out.push_str(after);
                }
                self.nested(body);
            }
            _ => {
                self.simple(stmt);
                self.out.push('\n');
            }
        }
    }

    fn branch(&mut self, condition: &Expr, then: &Stmt, otherwise: Option<&Stmt>) {
        let _ = write!(self.out, "if ({})", print_expr(condition));
        match otherwise {
            None => self.nested(then),
            // Without braces the `else` would go to the inner `if`.
            Some(_) if ends_open(then) => {
                self.out.push_str(" {\n");
                self.body(std::slice::from_ref(then));
            }
            Some(_) => self.nested(then),
        }
        let Some(otherwise) = otherwise else { return };
        self.margin();
        self.out.push_str("else");
        match otherwise.kind {
            StmtKind::If { .. } => {
                self.out.push(' ');
                self.unindented(otherwise);
            }
            _ => self.nested(otherwise),
        }
    }

    /// A statement inside another one: a block stays on the line, all else goes on its own.
    fn nested(&mut self, stmt: &Stmt) {
        if let StmtKind::Block(body) = &stmt.kind {
            self.out.push_str(" {\n");
            return self.body(body);
        }
        self.out.push('\n');
        self.indent += 1;
        self.stmt(stmt);
        self.indent -= 1;
    }

    /// A statement that fits on a line, without the line's end.
    fn simple(&mut self, stmt: &Stmt) {
        match &stmt.kind {
            StmtKind::Expr(expr) => expression::write(expr, &mut self.out),
            StmtKind::Declare(list) => {
                for (i, decl) in list.iter().enumerate() {
                    match i {
                        0 => self.declarator(&decl.ty, &decl.name, decl.array, decl.init.as_deref()),
                        _ => {
                            self.out.push_str(", ");
                            self.named(&decl.name, decl.array, decl.init.as_deref());
                        }
                    }
                }
            }
            StmtKind::Break => self.out.push_str("break"),
            StmtKind::Continue => self.out.push_str("continue"),
            StmtKind::Return(None) => self.out.push_str("return"),
            StmtKind::Return(Some(value)) => {
                self.out.push_str("return ");
                match value.kind {
                    ExprKind::InitList(_) => expression::write_item(value, &mut self.out),
                    _ => expression::write(value, &mut self.out),
                }
            }
            StmtKind::Error => self.out.push_str("<error>"),
            _ => {}
        }
        self.out.push(';');
    }
}

/// True when an `else` behind the statement would belong to an `if` inside of it.
fn ends_open(stmt: &Stmt) -> bool {
    match &stmt.kind {
        StmtKind::If { otherwise: None, .. } => true,
        StmtKind::If { otherwise: Some(last), .. } => ends_open(last),
        StmtKind::While { body, .. } | StmtKind::For { body, .. } => ends_open(body),
        _ => false,
    }
}
