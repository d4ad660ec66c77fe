//! What a word means, as Markdown.

use super::study::{Found, Study, Symbol};
use crate::check::notes::Meaning;
use crate::check::typed::VarId;
use crate::lang::builtins;
use crate::lang::describe::{closure_markdown, signature_text};
use crate::lang::sentences::sentence;
use velour_grammar::ast::{ExprKind, Item, Metadata};
use velour_grammar::places::{MAIN_FILE, TextRange};

/// Overloads of a builtin that are shown; then how many more there are.
const SHOWN: usize = 8;

impl Study {
    /// What stands there, in Markdown.
    pub fn explain(&self, found: &Found) -> Option<String> {
        let sources = &self.checked.sources;
        match &found.symbol {
            Symbol::Named(meaning) => self.explain_meaning(*meaning),
            Symbol::Macro(name, Some(place)) => Some(code(&self.definition_line(*place, name))),
            Symbol::Macro(name, None) => Some(format!("`{name}` is a macro that comes with velour")),
            Symbol::Include(file) => {
                let name = sources.name_of(*file);
                let own = if self.comes_with_velour(name) { ", which comes with velour" } else { "" };
                Some(format!("the file `{name}`{own}"))
            }
        }
    }

    fn explain_meaning(&self, meaning: Meaning) -> Option<String> {
        match meaning {
            Meaning::Variable(var) => self.explain_variable(var),
            Meaning::Function(id) => {
                let function = self.notes.functions.get(id.0 as usize)?;
                let formals = function
                    .formals
                    .iter()
                    .zip(function.names.iter().map(|name| name.as_str()).chain(std::iter::repeat("")));
                let formals = formals.map(|((ty, output), name)| {
                    format!("{}{ty} {name}", if *output { "output " } else { "" }).trim_end().to_owned()
                });
                let formals: Vec<String> = formals.collect();
                let head = code(&format!("{} {}({})", function.returns, function.name, formals.join(", ")));
                let comment = self.comment_of(id.0 as usize);
                let doc =
                    sentence(&function.name).map(str::to_owned).filter(|_| self.is_own(id.0 as usize)).or(comment);
                Some(with(head, &doc.unwrap_or_default()))
            }
            Meaning::Builtin(name) => {
                let all = builtins::signatures(name)?;
                let mut lines: Vec<String> = all.iter().take(SHOWN).map(|s| signature_text(name, s)).collect();
                if all.len() > SHOWN {
                    lines.push(format!("// and {} more", all.len() - SHOWN));
                }
                Some(with(code(&lines.join("\n")), sentence(name).unwrap_or_default()))
            }
            Meaning::Closure(id) => {
                let name = self.compiler.closures.table().get(id).name;
                let texts: Vec<String> =
                    self.compiler.closures.named(name).map(|(_, spec)| closure_markdown(spec)).collect();
                Some(texts.join("\n"))
            }
            Meaning::Struct(number) => {
                let structure = self.notes.structs.get(number as usize)?;
                let fields: String = structure.fields.iter().map(|(name, ty)| format!("    {ty} {name};\n")).collect();
                Some(code(&format!("struct {} {{\n{fields}}};", structure.name)))
            }
            Meaning::Field(number, at) => {
                let structure = self.notes.structs.get(number as usize)?;
                let (name, ty) = structure.fields.get(at as usize)?;
                Some(with(code(&format!("{ty} {name}")), &format!("field of `struct {}`", structure.name)))
            }
            Meaning::Shader => {
                let shader = self.checked.tree.items.iter().find_map(|item| match item {
                    Item::Shader(shader) => Some(shader),
                    Item::Struct(_) | Item::Function(_) => None,
                })?;
                let head = code(&format!("shader {}", shader.name.name));
                Some(with(head, &help_of(&shader.metadata).unwrap_or_default()))
            }
        }
    }

    fn explain_variable(&self, var: VarId) -> Option<String> {
        let variable = self.notes.variables.get(var.0 as usize)?;
        let head = code(&format!("{} {}", variable.ty, variable.name));
        if variable.global.is_some() {
            return Some(with(head, sentence(&variable.name).unwrap_or_default()));
        }
        for item in &self.checked.tree.items {
            let Item::Shader(shader) = item else { continue };
            if let Some(param) = shader.params.iter().find(|param| param.name.span == variable.span) {
                let default = param.default.as_ref().map(|default| self.checked.sources.text(default.span));
                let default = default.map_or(String::new(), |text| format!(", `{text}` by default"));
                let output = if param.output { "output parameter" } else { "parameter" };
                let told = format!("{output} of the shader `{}`{default}", shader.name.name);
                let help = help_of(&param.metadata).map_or(String::new(), |help| format!("\n\n{help}"));
                return Some(with(head, &(told + &help)));
            }
        }
        Some(head)
    }

    /// Does a function come with velour?
    pub(super) fn is_own(&self, function: usize) -> bool {
        let place = self.declared(function);
        place.is_some_and(|place| self.comes_with_velour(self.checked.sources.name_of(place.file)))
    }

    fn declared(&self, function: usize) -> Option<TextRange> {
        let id = crate::check::typed::FunctionId(u32::try_from(function).ok()?);
        let token = self.tokens_of(Meaning::Function(id), true).into_iter().next_back()?;
        self.position(token)
    }

    /// The comment above a function: the lines of `//` right before it.
    pub(super) fn comment_of(&self, function: usize) -> Option<String> {
        let place = self.declared(function)?;
        let text = self.checked.sources.text_of(place.file).get(..place.start as usize)?;
        let mut lines: Vec<&str> = text
            .lines()
            .rev()
            .skip(usize::from(!text.ends_with('\n')))
            .map(str::trim)
            .take_while(|l| l.starts_with("//"))
            .collect();
        lines.reverse();
        let words: Vec<&str> = lines.iter().map(|line| line.trim_start_matches('/').trim()).collect();
        (!words.is_empty()).then(|| words.join("\n"))
    }

    /// The lines of a macro's definition.
    fn definition_line(&self, place: TextRange, name: &str) -> String {
        let text = self.checked.sources.text_of(place.file);
        let rest = text.get(place.end as usize..).unwrap_or_default();
        let mut out = String::new();
        for line in rest.lines().take(SHOWN) {
            out += line;
            if !line.ends_with('\\') {
                break;
            }
            out.push('\n');
        }
        let options = place.file != MAIN_FILE && self.checked.sources.name_of(place.file).starts_with('<');
        format!("#define {name}{}{}", out.trim_end(), if options { " // by an option" } else { "" })
    }
}

/// The text of `help` or `description` among metadata.
fn help_of(metadata: &[Metadata]) -> Option<String> {
    let named = |name: &str| metadata.iter().find(|entry| entry.name.name == *name);
    let entry = named("help").or_else(|| named("description")).or_else(|| named("label"))?;
    match &entry.value.kind {
        ExprKind::String(text) => Some(text.clone()),
        _ => None,
    }
}

fn code(text: &str) -> String {
    format!("```osl\n{text}\n```")
}

fn with(head: String, doc: &str) -> String {
    if doc.is_empty() { head } else { format!("{head}\n\n{doc}") }
}
