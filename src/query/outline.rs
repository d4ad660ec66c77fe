//! What a text declares, as a tree.

use super::study::Study;
use std::ops::Range;
use velour_grammar::Span;
use velour_grammar::ast::{FunctionDecl, Ident, Item, ShaderDecl, Stmt, StmtKind, StructDecl};
use velour_grammar::places::MAIN_FILE;
use velour_grammar::print::print_type;

/// What something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutlineKind {
    /// A shader.
    Shader,
    /// A function.
    Function,
    /// A struct.
    Struct,
    /// A field of a struct.
    Field,
    /// A parameter of a shader.
    Parameter,
    /// A macro.
    Macro,
}

/// Something that the text declares.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Its name.
    pub name: String,
    /// Its type, or what is known of it besides.
    pub detail: String,
    /// What it is.
    pub kind: OutlineKind,
    /// All of it, in bytes.
    pub range: Range<usize>,
    /// Its name.
    pub name_range: Range<usize>,
    /// What is declared in it.
    pub children: Vec<Outline>,
}

impl Study {
    /// What the text declares, in order.
    pub fn outline(&self) -> Vec<Outline> {
        let mut out: Vec<Outline> = Vec::new();
        for (name, place) in self.defines() {
            let range = place.start as usize..place.end as usize;
            let (name, detail, kind) = (name.to_owned(), String::new(), OutlineKind::Macro);
            out.push(Outline { name, detail, kind, range: range.clone(), name_range: range, children: Vec::new() });
        }
        for item in &self.checked.tree.items {
            out.extend(match item {
                Item::Struct(decl) => self.structure(decl),
                Item::Function(decl) => self.function(decl),
                Item::Shader(decl) => self.shader(decl),
            });
        }
        out.sort_by_key(|entry| entry.range.start);
        out
    }

    fn structure(&self, decl: &StructDecl) -> Option<Outline> {
        let mut out = self.entry(OutlineKind::Struct, &decl.name, String::new(), decl.span)?;
        let field = |field: &velour_grammar::ast::Field| {
            self.entry(OutlineKind::Field, &field.name, print_type(&field.ty), field.ty.span.to(field.name.span))
        };
        out.children = decl.fields.iter().filter_map(field).collect();
        Some(out)
    }

    fn function(&self, decl: &FunctionDecl) -> Option<Outline> {
        let detail = crate::lang::describe::function_text(decl);
        let mut out = self.entry(OutlineKind::Function, &decl.name, detail, decl.span)?;
        if let Some(body) = &decl.body {
            self.with_body(&mut out, body);
        }
        Some(out)
    }

    fn shader(&self, decl: &ShaderDecl) -> Option<Outline> {
        let mut out = self.entry(OutlineKind::Shader, &decl.name, String::new(), decl.span)?;
        let param = |param: &velour_grammar::ast::Param| {
            let output = if param.output { "output " } else { "" };
            let detail = format!("{output}{}", print_type(&param.ty));
            let default = param.default.as_ref().map_or(Span::NONE, |default| default.span);
            self.entry(OutlineKind::Parameter, &param.name, detail, param.ty.span.to(param.name.span).to(default))
        };
        out.children = decl.params.iter().filter_map(param).collect();
        self.with_body(&mut out, &decl.body);
        Some(out)
    }

    /// Adds the functions declared in a body, and the body itself.
    fn with_body(&self, out: &mut Outline, body: &[Stmt]) {
        for stmt in body {
            if let StmtKind::Function(inner) = &stmt.kind {
                out.children.extend(self.function(inner));
            }
        }
        let last = body.last().and_then(|stmt| self.range(stmt.span)).map_or(out.range.end, |range| range.end);
        let after = self.raw.partition_point(|token| token.start < last.max(out.range.end));
        let close = self.raw[after..].iter().find(|token| &self.text[token.start..token.end] == "}");
        out.range.end = close.map_or(last, |token| token.end).max(out.range.end);
    }

    fn entry(&self, kind: OutlineKind, name: &Ident, detail: String, span: Span) -> Option<Outline> {
        let name_range = self.range(name.span)?;
        let whole = self.range(span).unwrap_or_else(|| name_range.clone());
        let range = whole.start.min(name_range.start)..whole.end.max(name_range.end);
        Some(Outline { name: name.name.to_string(), detail, kind, range, name_range, children: Vec::new() })
    }

    /// The bytes of a span in the text itself.
    pub(super) fn range(&self, span: Span) -> Option<Range<usize>> {
        let place = self.checked.sources.written(span).filter(|place| place.file == MAIN_FILE)?;
        Some(place.start as usize..place.end as usize)
    }
}
