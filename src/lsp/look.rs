//! What is known, in the shapes of the protocol.

use super::text::{Position, Text};
use crate::query::{CallHelp, Item, ItemKind, Level, Message, Outline, OutlineKind};
use lsp_types::{CompletionItemKind, DiagnosticSeverity, DiagnosticTag, SymbolKind};
use serde_json::{Value, json};
use std::ops::Range;

/// A place of the protocol.
pub(super) fn position(value: lsp_types::Position) -> Position {
    Position { line: value.line, column: value.character }
}

/// A range of bytes in the protocol's terms.
pub(super) fn range(text: &Text, range: &Range<usize>) -> Value {
    let place = |offset: usize| {
        let Position { line, column } = text.position(offset);
        json!({ "line": line, "character": column })
    };
    json!({ "start": place(range.start), "end": place(range.end) })
}

/// A message.
pub(super) fn diagnostic(uri: &str, text: &Text, message: &Message) -> Value {
    let (severity, tags) = match message.level {
        Level::Error => (DiagnosticSeverity::ERROR, None),
        Level::Warning => (DiagnosticSeverity::WARNING, None),
        Level::Unused => (DiagnosticSeverity::HINT, Some([DiagnosticTag::UNNECESSARY])),
    };
    let also = message
        .also
        .iter()
        .map(|(place, remark)| json!({ "location": { "uri": uri, "range": range(text, place) }, "message": remark }));
    let mut out = json!({
        "range": range(text, &message.range),
        "severity": severity,
        "code": message.code,
        "source": "velour",
        "message": message.text,
        "relatedInformation": also.collect::<Vec<_>>(),
    });
    if let Some(tags) = tags {
        out["tags"] = json!(tags);
    }
    out
}

/// Something that may be written.
pub(super) fn item(text: &Text, item: &Item) -> Value {
    // What is nearest comes first.
    let (kind, order) = match item.kind {
        ItemKind::Keyword => (CompletionItemKind::PROPERTY, 0),
        ItemKind::Value => (CompletionItemKind::ENUM_MEMBER, 0),
        ItemKind::Field => (CompletionItemKind::FIELD, 0),
        ItemKind::Variable => (CompletionItemKind::VARIABLE, 1),
        ItemKind::Global => (CompletionItemKind::CONSTANT, 2),
        ItemKind::Closure => (CompletionItemKind::CLASS, 3),
        ItemKind::Struct => (CompletionItemKind::STRUCT, 3),
        ItemKind::Function => (CompletionItemKind::FUNCTION, 4),
        ItemKind::Word => (CompletionItemKind::KEYWORD, 5),
        ItemKind::Macro => (CompletionItemKind::CONSTANT, 6),
        ItemKind::File => (CompletionItemKind::FILE, 6),
    };
    let (place, new) = &item.insert;
    json!({
        "label": item.label,
        "kind": kind,
        "detail": item.detail,
        "documentation": item.doc,
        "sortText": format!("{order}{}", item.label.trim_matches('"')),
        "filterText": new,
        "textEdit": { "range": range(text, place), "newText": new },
    })
}

/// The call that is being written.
pub(super) fn call(help: &CallHelp) -> Value {
    let signatures = help.overloads.iter().map(|overload| {
        let units = |byte: usize| overload.label[..byte].encode_utf16().count();
        let parameters =
            overload.parameters.iter().zip(&overload.meanings).map(
                |((start, end), meaning)| json!({ "label": [units(*start), units(*end)], "documentation": meaning }),
            );
        let parameters: Vec<Value> = parameters.collect();
        json!({ "label": overload.label, "documentation": overload.doc, "parameters": parameters })
    });
    let signatures: Vec<Value> = signatures.collect();
    json!({ "signatures": signatures, "activeSignature": help.likely, "activeParameter": help.argument })
}

/// Something that the text declares.
pub(super) fn symbol(text: &Text, outline: &Outline) -> Value {
    let kind = match outline.kind {
        OutlineKind::Shader => SymbolKind::MODULE,
        OutlineKind::Function => SymbolKind::FUNCTION,
        OutlineKind::Struct => SymbolKind::STRUCT,
        OutlineKind::Field => SymbolKind::FIELD,
        OutlineKind::Parameter => SymbolKind::PROPERTY,
        OutlineKind::Macro => SymbolKind::CONSTANT,
    };
    json!({
        "name": outline.name,
        "detail": outline.detail,
        "kind": kind,
        "range": range(text, &outline.range),
        "selectionRange": range(text, &outline.name_range),
        "children": outline.children.iter().map(|child| symbol(text, child)).collect::<Vec<_>>(),
    })
}
