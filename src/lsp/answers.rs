//! The answers to an editor's questions.

use super::documents::Documents;
use super::text::Text;
use super::{look, uri};
use crate::query::{Found, Study};
use lsp_server::ErrorCode;
use lsp_types::{
    DocumentFormattingParams, DocumentHighlightParams, DocumentSymbolParams, GotoDefinitionParams, HoverParams,
    ReferenceParams, RenameParams, TextDocumentPositionParams,
};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use velour_grammar::FormatError;
use velour_grammar::places::{MAIN_FILE, TextRange};

/// What an answer is when there is none: a code of the protocol and a sentence.
pub(super) type Refusal = (ErrorCode, String);

type Answer = Result<Value, Refusal>;

/// Answers a question about a text.
pub(super) fn answer(documents: &mut Documents, headers: Option<&Path>, method: &str, params: Value) -> Answer {
    match method {
        "textDocument/hover" => {
            let params: HoverParams = read(params)?;
            at(documents, &params.text_document_position_params, hover)
        }
        "textDocument/definition" => {
            let params: GotoDefinitionParams = read(params)?;
            at(documents, &params.text_document_position_params, |place| definition(place, headers))
        }
        "textDocument/references" => {
            let params: ReferenceParams = read(params)?;
            let declarations = params.context.include_declaration;
            at(documents, &params.text_document_position, |place| references(place, headers, declarations))
        }
        "textDocument/documentHighlight" => {
            let params: DocumentHighlightParams = read(params)?;
            at(documents, &params.text_document_position_params, highlights)
        }
        "textDocument/prepareRename" => {
            let params: TextDocumentPositionParams = read(params)?;
            at(documents, &params, prepare_rename)
        }
        "textDocument/rename" => {
            let params: RenameParams = read(params)?;
            at(documents, &params.text_document_position, |place| rename(place, &params.new_name))
        }
        "textDocument/completion" => {
            let params: TextDocumentPositionParams = read(params)?;
            at(documents, &params, completion)
        }
        "textDocument/signatureHelp" => {
            let params: TextDocumentPositionParams = read(params)?;
            at(documents, &params, |place| {
                Ok(place.study.call_help(place.offset).map_or(Value::Null, |help| look::call(&help)))
            })
        }
        "textDocument/documentSymbol" => {
            let params: DocumentSymbolParams = read(params)?;
            let uri = params.text_document.uri.as_str();
            let Some(study) = documents.study(uri) else { return Ok(Value::Null) };
            let text = &documents.open[uri].text;
            Ok(study.outline().iter().map(|outline| look::symbol(text, outline)).collect())
        }
        "textDocument/formatting" => {
            let params: DocumentFormattingParams = read(params)?;
            formatting(documents, params.text_document.uri.as_str())
        }
        "velour/text" => {
            let uri = params["textDocument"]["uri"].as_str().unwrap_or_default();
            Ok(documents.open.get(uri).map_or(Value::Null, |document| json!(document.text.as_str())))
        }
        _ => Err((ErrorCode::MethodNotFound, format!("velour has no {method}"))),
    }
}

fn read<T: DeserializeOwned>(params: Value) -> Result<T, Refusal> {
    serde_json::from_value(params).map_err(|error| (ErrorCode::InvalidParams, error.to_string()))
}

/// A place that is asked about.
struct Place<'d> {
    uri: &'d str,
    text: &'d Text,
    study: Arc<Study>,
    whole: Option<Arc<Study>>,
    offset: usize,
}

impl Place<'_> {
    fn found(&self) -> Option<Found> {
        self.study.at(self.offset)
    }
}

/// Answers about a place; nothing is known of texts that are not open.
fn at(
    documents: &mut Documents,
    params: &TextDocumentPositionParams,
    answer: impl FnOnce(&Place<'_>) -> Answer,
) -> Answer {
    let uri = params.text_document.uri.as_str();
    let Some(study) = documents.study(uri) else { return Ok(Value::Null) };
    let whole = documents.whole(uri);
    let text = &documents.open[uri].text;
    answer(&Place { uri, text, study, whole, offset: text.offset(look::position(params.position)) })
}

fn hover(place: &Place<'_>) -> Answer {
    let Some(found) = place.found() else { return Ok(Value::Null) };
    let Some(text) = place.study.explain(&found) else { return Ok(Value::Null) };
    let contents = json!({ "kind": "markdown", "value": text });
    Ok(json!({ "contents": contents, "range": look::range(place.text, &found.range) }))
}

/// A place in this text or in another file; nothing for what stands in none.
fn location(place: &Place<'_>, there: TextRange, headers: Option<&Path>) -> Option<Value> {
    let range = there.start as usize..there.end as usize;
    if there.file == MAIN_FILE {
        return Some(json!({ "uri": place.uri, "range": look::range(place.text, &range) }));
    }
    let (name, text) = place.study.file(there.file);
    let path = match place.study.comes_with_velour(name) {
        true => header_file(headers?, name, text)?,
        false => std::path::absolute(name).ok().filter(|_| !name.starts_with('<'))?,
    };
    Some(json!({ "uri": uri::of_path(&path), "range": look::range(&Text::new(text), &range) }))
}

/// The file of a header that comes with velour, which is written when it is not there.
fn header_file(folder: &Path, name: &str, text: &str) -> Option<PathBuf> {
    let path = folder.join(name);
    if std::fs::read(&path).is_ok_and(|there| there == text.as_bytes()) {
        return Some(path);
    }
    std::fs::create_dir_all(folder).ok()?;
    // Another server may be about to write the same.
    let own = folder.join(format!(".{name}.{}", std::process::id()));
    std::fs::write(&own, text).and_then(|()| std::fs::rename(&own, &path)).ok()?;
    Some(path)
}

fn definition(place: &Place<'_>, headers: Option<&Path>) -> Answer {
    let there = place.found().and_then(|found| place.study.definition(&found));
    Ok(there.and_then(|there| location(place, there, headers)).unwrap_or(Value::Null))
}

fn references(place: &Place<'_>, headers: Option<&Path>, declarations: bool) -> Answer {
    let Some(found) = place.found() else { return Ok(Value::Null) };
    let all = place.study.references(&found, declarations);
    Ok(all.into_iter().filter_map(|there| location(place, there, headers)).collect())
}

fn highlights(place: &Place<'_>) -> Answer {
    let Some(found) = place.found() else { return Ok(Value::Null) };
    let all = place.study.references(&found, true).into_iter().filter(|there| there.file == MAIN_FILE);
    let range = |there: TextRange| look::range(place.text, &(there.start as usize..there.end as usize));
    Ok(all.map(|there| json!({ "range": range(there) })).collect())
}

fn prepare_rename(place: &Place<'_>) -> Answer {
    let found = place.found().ok_or_else(|| refused(&crate::query::RenameError::Nothing))?;
    place.study.renamable(&found).map_err(|error| refused(&error))?;
    let old = &place.text.as_str()[found.range.clone()];
    Ok(json!({ "range": look::range(place.text, &found.range), "placeholder": old }))
}

fn rename(place: &Place<'_>, new: &str) -> Answer {
    let found = place.found().ok_or_else(|| refused(&crate::query::RenameError::Nothing))?;
    let ranges = place.study.rename(&found, new).map_err(|error| refused(&error))?;
    let edit = |range: &std::ops::Range<usize>| json!({ "range": look::range(place.text, range), "newText": new });
    Ok(json!({ "changes": { place.uri: ranges.iter().map(edit).collect::<Vec<_>>() } }))
}

fn refused(error: &crate::query::RenameError) -> Refusal {
    (ErrorCode::RequestFailed, error.to_string())
}

fn completion(place: &Place<'_>) -> Answer {
    let items = place.study.complete(place.offset, place.whole.as_deref());
    Ok(items.iter().map(|item| look::item(place.text, item)).collect())
}

fn formatting(documents: &mut Documents, uri: &str) -> Answer {
    let Some(document) = documents.open.get(uri).filter(|document| !document.is_too_long()) else {
        return Ok(Value::Null);
    };
    let old = document.text.as_str();
    let new = match velour_grammar::format(&document.name, old, &documents.compiler().options) {
        Ok(new) => new,
        // What is wrong is shown already.
        Err(FormatError::Wrong(..)) => return Ok(Value::Null),
        Err(error) => return Err((ErrorCode::RequestFailed, error.to_string())),
    };
    if new == *old {
        return Ok(json!([]));
    }
    // The lines that stay as they are keep their marks.
    let same = |a: &str, b: &str| a == b;
    let first: usize = lines(old).zip(lines(&new)).take_while(|(a, b)| same(a, b)).map(|(a, _)| a.len()).sum();
    let (rest_old, rest_new) = (&old[first..], &new[first..]);
    let ends = lines(rest_old).rev().zip(lines(rest_new).rev());
    let last: usize = ends.take_while(|(a, b)| same(a, b)).map(|(a, _)| a.len()).sum();
    let range = look::range(&document.text, &(first..old.len() - last));
    Ok(json!([{ "range": range, "newText": rest_new[..rest_new.len() - last] }]))
}

/// The lines of a text with their ends.
fn lines(text: &str) -> impl DoubleEndedIterator<Item = &str> {
    text.split_inclusive('\n')
}
