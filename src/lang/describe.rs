//! What closures, builtins and functions are, as text for people: what `velour info` prints and editors show.

use super::builtins::{Formal, Signature};
use super::closures::{Claim, ClosureSpec, ParamKind, ParamSpec, Waiver};
use velour_grammar::ast::FunctionDecl;
use velour_grammar::print::print_type;

/// A whole declaration: signature, documentation, parameters, and what is not promised. One line each, indented by four.
pub fn closure_text(spec: &ClosureSpec) -> String {
    let mut out = format!("closure color {}\n    {}\n", closure_head(spec), spec.doc);
    if !spec.formula.is_empty() {
        out += &format!("    formula:\n        {}\n", spec.formula.replace('\n', "\n        "));
    }
    if !spec.source.is_empty() {
        out += &format!("    source: {}\n", spec.source);
    }
    for (list, title) in [(&spec.params, "parameters"), (&spec.keywords, "keyword parameters")] {
        if !list.is_empty() {
            out += &format!("    {title}:\n");
        }
        for param in list {
            out += &format!("        {} {}: {}\n", kind_name(param.kind), param.name, param.doc);
        }
    }
    out + &promises(spec)
}

/// The same as Markdown.
pub fn closure_markdown(spec: &ClosureSpec) -> String {
    let mut out = format!("```osl\nclosure color {}\n```\n\n{}\n", closure_head(spec), spec.doc);
    if !spec.formula.is_empty() {
        out += &format!("\n```text\n{}\n```\n", spec.formula);
    }
    if !spec.source.is_empty() {
        out += &format!("\nSource: {}\n", spec.source);
    }
    for (list, title) in [(&spec.params, ""), (&spec.keywords, "\nKeywords:\n")] {
        let mut lines =
            list.iter().map(|param| format!("- `{}` ({}): {}\n", param.name, kind_name(param.kind), param.doc));
        if let Some(first) = lines.next() {
            out += &format!("{title}\n{first}");
        }
        out.extend(lines);
    }
    for promise in promises(spec).lines() {
        out += &format!("\nIt {}\n", promise.trim_start());
    }
    out
}

/// Name and parameters, as `name(type param, ["keyword", type])`.
pub fn closure_head(spec: &ClosureSpec) -> String {
    let param = |p: &ParamSpec| format!("{} {}", kind_name(p.kind), p.name);
    let keyword = |p: &ParamSpec| format!("[\"{}\", {}]", p.name, kind_name(p.kind));
    let all: Vec<String> = spec.params.iter().map(param).chain(spec.keywords.iter().map(keyword)).collect();
    format!("{}({})", spec.name, all.join(", "))
}

/// An overload of a builtin: `float dot(vector, vector)`.
pub fn signature_text(name: &str, signature: &Signature) -> String {
    let formal = |(formal, output): &(Formal, bool)| {
        let ty = match formal {
            Formal::Type(ty) => ty.to_string(),
            Formal::Any => "any".to_owned(),
            Formal::AnyArray => "any[]".to_owned(),
        };
        if *output { format!("output {ty}") } else { ty }
    };
    let mut formals: Vec<String> = signature.formals.iter().map(formal).collect();
    if signature.variadic {
        formals.push("...".to_owned());
    }
    if signature.options {
        formals.push("[\"name\", value]...".to_owned());
    }
    format!("{} {name}({})", signature.returns, formals.join(", "))
}

/// The head of a function: `float f(float x, output color y)`.
pub fn function_text(function: &FunctionDecl) -> String {
    let params = function.params.iter().map(|param| {
        let output = if param.output { "output " } else { "" };
        format!("{output}{} {}", print_type(&param.ty), param.name.name)
    });
    let params: Vec<String> = params.collect();
    format!("{} {}({})", print_type(&function.return_type), function.name.name, params.join(", "))
}

/// What a closure does not promise, which `velour verify` measures.
fn promises(spec: &ClosureSpec) -> String {
    let mut out = String::new();
    for Waiver { claim, only, why } in spec.waivers {
        let what = match claim {
            Claim::Energy => "may reflect more than arrives",
            Claim::Reciprocity => "is not reciprocal",
        };
        let when = only.map_or(String::new(), |(name, value)| format!(" with {name} {value}"));
        out += &format!("    {what}{when}: {why}\n");
    }
    out
}

/// The type of a closure's parameter in the language.
pub fn kind_name(kind: ParamKind) -> &'static str {
    match kind {
        ParamKind::Float => "float",
        ParamKind::Int => "int",
        ParamKind::Color => "color",
        ParamKind::Vector => "vector",
        ParamKind::Normal => "normal",
        ParamKind::String => "string",
        ParamKind::Closure => "closure color",
    }
}
