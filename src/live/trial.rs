//! `velour verify` on the shader that is being looked at, beside the picture.

use super::board::Board;
use super::inbox::Knob;
use super::subject::{Overrides, Subject, base};
use crate::closure::Settings;
use crate::compile::Shader;
use crate::measure::verify::{Effort, ShaderSubject, cannot_run, verify};
use serde_json::{Value, json};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// One verification at a time.
#[derive(Debug, Default)]
pub struct Trial {
    running: Arc<AtomicBool>,
}

/// Says how a verification stands.
fn put(board: &Board, value: Value) {
    board.publish([("verify", value)], None);
}

impl Trial {
    /// Verifies the last shader of a group, with the values that the scene and the page give it, unless one is being verified. Where its
    /// text has a mistake now, the text before it is `stale`.
    pub fn begin(
        &self,
        subject: &Subject,
        group: usize,
        overrides: &Overrides,
        (settings, stale): (Settings, bool),
        board: &Arc<Board>,
    ) {
        let Some(part) = subject.parts.get(group) else { return };
        let last = part.spec.layers.len().saturating_sub(1);
        let number = subject.own_layer(group).unwrap_or(last);
        let pair = part.spec.layers.get(number).zip(part.shaders.get(number).cloned());
        let Some((layer, shader)) = pair else { return };
        if self.running.swap(true, Ordering::Relaxed) {
            return;
        }
        let value = |name: &str| {
            let knob = Knob { group, layer: number, name: name.to_owned() };
            let written = layer.params.iter().any(|param| param.name == name);
            overrides.get(&knob).cloned().or_else(|| base(layer, &shader, name).filter(|_| written))
        };
        let given = shader.params().filter_map(|name| Some((name.to_owned(), value(name)?.text())));
        let given: Vec<(String, String)> = given.collect();
        let (board, running, fed) = (board.clone(), self.running.clone(), !part.spec.connections.is_empty());
        std::thread::spawn(move || {
            put(&board, json!({"state": "running", "shader": shader.name(), "done": 0, "total": 0}));
            let mut found = run(&shader, &given, settings, fed, &board);
            found["stale"] = json!(stale);
            put(&board, found);
            running.store(false, Ordering::Relaxed);
        });
    }
}

fn run(shader: &Shader, given: &[(String, String)], settings: Settings, fed: bool, board: &Board) -> Value {
    let name = shader.name();
    let wrong = |text: String| json!({"state": "error", "shader": name, "text": text});
    // A shader that cannot be run is not tried at thousands of places.
    let group = given.iter().fold(shader.group(), |group, (name, text)| group.text(name, text)).build();
    let group = match group {
        Ok(group) => group,
        Err(error) => return wrong(error.to_string()),
    };
    if let Some(report) = cannot_run(&group) {
        return wrong(report.to_string());
    }
    let effort = Effort::quick();
    let subject = match ShaderSubject::new(name, shader, given, settings, &effort) {
        Ok(subject) => subject,
        Err(error) => return wrong(error.to_string()),
    };
    let report = verify(&[&subject], &effort, &|done, total| {
        put(board, json!({"state": "running", "shader": name, "done": done, "total": total}));
    });
    let rows: Vec<Value> = report
        .worst()
        .iter()
        .map(|line| {
            let [_, check, worst, bound, verdict, place] = line.cells();
            json!({"check": check, "worst": worst, "bound": bound, "verdict": verdict, "place": place})
        })
        .collect();
    let given: Vec<String> = given.iter().map(|(name, text)| format!("{name} {text}")).collect();
    json!({"state": "done", "shader": name, "passed": report.passed(), "rows": rows, "given": given, "alone": fed})
}
