//! What a closure's declaration says, as text for people: the part of `velour info` that is about closures.

use super::closures::{Claim, ClosureSpec, ParamKind, ParamSpec, Waiver};

/// A whole declaration: signature, documentation, parameters, and what is not promised. One line each, indented by four.
pub fn closure_text(spec: &ClosureSpec) -> String {
    let mut out = format!("closure color {}\n    {}\n", closure_head(spec), spec.doc);
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

/// Name and parameters, as `name(type param, ["keyword", type])`.
pub fn closure_head(spec: &ClosureSpec) -> String {
    let param = |p: &ParamSpec| format!("{} {}", kind_name(p.kind), p.name);
    let keyword = |p: &ParamSpec| format!("[\"{}\", {}]", p.name, kind_name(p.kind));
    let all: Vec<String> = spec.params.iter().map(param).chain(spec.keywords.iter().map(keyword)).collect();
    format!("{}({})", spec.name, all.join(", "))
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

fn kind_name(kind: ParamKind) -> &'static str {
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
