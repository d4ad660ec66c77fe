//! The call that is being written: what may be called so, and which argument is next.

use super::context::Call;
use super::study::Study;
use crate::lang::builtins::{self, Formal};
use crate::lang::describe::kind_name;
use crate::lang::sentences::sentence;

/// One of the things a name may call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Overload {
    /// All of it: `float dot(vector, vector)`.
    pub label: String,
    /// The bytes of each parameter in it.
    pub parameters: Vec<(usize, usize)>,
    /// What each parameter means; empty where nothing is known.
    pub meanings: Vec<String>,
    /// What it does.
    pub doc: String,
}

/// The call that is being written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CallHelp {
    /// What the name may call.
    pub overloads: Vec<Overload>,
    /// The first of them that takes so many arguments.
    pub likely: usize,
    /// Which argument is next, from 0.
    pub argument: usize,
}

/// Puts an overload together.
pub(super) struct Maker {
    overload: Overload,
}

impl Maker {
    pub(super) fn new(head: String, doc: &str) -> Self {
        let label = head + "(";
        Maker { overload: Overload { label, parameters: Vec::new(), meanings: Vec::new(), doc: doc.to_owned() } }
    }

    pub(super) fn parameter(mut self, text: &str, meaning: &str) -> Self {
        let overload = &mut self.overload;
        if !overload.parameters.is_empty() {
            overload.label += ", ";
        }
        let start = overload.label.len();
        overload.label += text;
        overload.parameters.push((start, overload.label.len()));
        overload.meanings.push(meaning.to_owned());
        self
    }

    pub(super) fn finish(mut self) -> Overload {
        self.overload.label.push(')');
        self.overload
    }
}

impl Study {
    /// The call around a byte, if there is one.
    pub fn call_help(&self, offset: usize) -> Option<CallHelp> {
        if self.in_comment(offset) {
            return None;
        }
        let Call { name, argument, .. } = self.call_at(offset)?;
        let overloads = self.overloads(&name);
        let fits = |overload: &Overload| {
            let open = overload.label.contains('…') || overload.label.contains("[\"");
            argument < overload.parameters.len() || open || overload.parameters.is_empty() && argument == 0
        };
        let likely = overloads.iter().position(fits).unwrap_or(0);
        // What follows the last parameter belongs to it: options, or further values.
        let last = overloads.get(likely)?.parameters.len().saturating_sub(1);
        Some(CallHelp { argument: argument.min(last.max(argument.min(last))), overloads, likely })
    }

    /// All that a name may call.
    pub(super) fn overloads(&self, name: &str) -> Vec<Overload> {
        let doc = sentence(name).unwrap_or_default();
        let (mut out, mut header) = (Vec::new(), Vec::new());
        for (at, function) in self.notes.functions.iter().enumerate().filter(|(_, f)| f.name == name) {
            let own = self.is_own(at);
            let doc = self.comment_of(at).filter(|_| !own).unwrap_or_else(|| doc.to_owned());
            let mut maker = Maker::new(format!("{} {name}", function.returns), &doc);
            for (i, (ty, output)) in function.formals.iter().enumerate() {
                let name = function.names.get(i).map_or("", |name| name.as_str());
                let output = if *output { "output " } else { "" };
                maker = maker.parameter(format!("{output}{ty} {name}").trim_end(), "");
            }
            if own { header.push(maker.finish()) } else { out.push(maker.finish()) }
        }
        for signature in builtins::signatures(name).unwrap_or_default() {
            let mut maker = Maker::new(format!("{} {name}", signature.returns), doc);
            for (formal, output) in &signature.formals {
                let ty = match formal {
                    Formal::Type(ty) => ty.to_string(),
                    Formal::Any => "any".to_owned(),
                    Formal::AnyArray => "any[]".to_owned(),
                };
                maker = maker.parameter(&if *output { format!("output {ty}") } else { ty }, "");
            }
            if signature.variadic || signature.options {
                let more = if signature.options { "[\"name\", value]…" } else { "…" };
                maker = maker.parameter(more, "");
            }
            out.push(maker.finish());
        }
        for (_, spec) in self.compiler.closures.named(name) {
            let mut maker = Maker::new(format!("closure color {name}"), spec.doc);
            for param in &spec.params {
                maker = maker.parameter(&format!("{} {}", kind_name(param.kind), param.name), param.doc);
            }
            for keyword in &spec.keywords {
                maker = maker.parameter(&format!("[\"{}\", {}]", keyword.name, kind_name(keyword.kind)), keyword.doc);
            }
            out.push(maker.finish());
        }
        for structure in self.notes.structs.iter().filter(|structure| structure.name == name) {
            let mut maker = Maker::new(format!("struct {name}"), "");
            for (field, ty) in &structure.fields {
                maker = maker.parameter(&format!("{ty} {field}"), "");
            }
            out.push(maker.finish());
        }
        // What a header adds to a builtin comes after it.
        out.extend(header);
        out
    }
}
