//! Parses a shader group's text: `param`, `shader` and `connect` statements, quotes optional, ended by `;` or `,`.

use super::error::{Place, SceneError, SceneProblem};
use super::group::{Connection, Hints, Layer, ParamType, ParamValue, Values};
use crate::lang::nearest::nearest;
use crate::limits::{NUMBERS, SCENE_VALUES};

/// What a group's text holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statements {
    /// The layers with their parameters.
    pub layers: Vec<Layer>,
    /// The connections.
    pub connections: Vec<Connection>,
    /// Parameters after the last shader: they belong to a shader that follows elsewhere.
    pub pending: Vec<ParamValue>,
}

/// Parses `text`; `place_of` turns a byte offset of it into a place.
pub fn parse_group(text: &str, place_of: &dyn Fn(usize) -> Place) -> Result<Statements, SceneError> {
    let mut parser = Parser { text, at: 0, place_of, held: 0, out: Statements::default() };
    while parser.skip_blank() {
        parser.statement()?;
    }
    Ok(parser.out)
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
    place_of: &'t dyn Fn(usize) -> Place,
    /// Values so far.
    held: usize,
    out: Statements,
}

impl<'t> Parser<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    fn here(&self) -> Place {
        (self.place_of)(self.at)
    }

    fn skip_space(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    /// Skips space and empty statements; false at the end of the text.
    fn skip_blank(&mut self) -> bool {
        let blank = |c: char| c.is_whitespace() || c == ';' || c == ',';
        self.at = self.text.len() - self.rest().trim_start_matches(blank).len();
        self.at < self.text.len()
    }

    fn take_char(&mut self, c: char) -> bool {
        self.skip_space();
        let found = self.rest().starts_with(c);
        if found {
            self.at += c.len_utf8();
        }
        found
    }

    /// The longest prefix without any of `stops`, after leading space.
    fn until(&mut self, stops: &[char]) -> &'t str {
        self.skip_space();
        let rest = self.rest();
        let end = rest.find(stops).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    fn word(&mut self) -> &'t str {
        self.skip_space();
        let rest = self.rest();
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    fn statement(&mut self) -> Result<(), SceneError> {
        let place = self.here();
        match self.word() {
            "shader" => self.shader(),
            "connect" => self.connect(),
            "param" => {
                self.skip_space();
                let type_place = self.here();
                let kind = self.word();
                self.parameter(kind, type_place)
            }
            word if ParamType::from_name(word).is_some() => self.parameter(word, place),
            word => {
                let shown = if word.is_empty() { self.until(&[' ', '\n', ';', ',']) } else { word };
                let known: Vec<&str> = ["param", "shader", "connect"].into_iter().chain(ParamType::NAMES).collect();
                let error = SceneError::at(place, SceneProblem::UnknownStatement { word: shown.to_owned() });
                Err(error.with_help(match nearest(shown, &known) {
                    Some(name) => format!("did you mean `{name}`?"),
                    None => "a statement begins with `param` (or a type), `shader` or `connect`".into(),
                }))
            }
        }
    }

    fn end_of_statement(&mut self) -> Result<(), SceneError> {
        self.skip_space();
        if self.rest().is_empty() || self.take_char(';') || self.take_char(',') {
            return Ok(());
        }
        let place = self.here();
        let found = self.until(&[' ', '\t', '\r', '\n', ';', ',']).to_owned();
        Err(SceneError::at(place, SceneProblem::UnendedStatement { found })
            .with_help("end each statement with `;`; a parameter takes no more values than its type has"))
    }

    fn shader(&mut self) -> Result<(), SceneError> {
        self.skip_space();
        let place = self.here();
        let shader = self.name("a shader's name", &[' ', '\t', '\r', '\n', ',', ';'])?;
        self.skip_space();
        let layer_name = match self.rest().chars().next() {
            // The layer's name may be left out when nothing connects to it.
            None | Some(';' | ',') => shader.clone(),
            _ => self.name("a layer's name", &[' ', '\t', '\r', '\n', ',', ';'])?,
        };
        let params = std::mem::take(&mut self.out.pending);
        self.out.layers.push(Layer { shader, layer_name, params, place });
        self.end_of_statement()
    }

    fn connect(&mut self) -> Result<(), SceneError> {
        self.skip_space();
        let place = self.here();
        let (source_layer, source_param) = self.endpoint()?;
        let (target_layer, target_param) = self.endpoint()?;
        self.out.connections.push(Connection { source_layer, source_param, target_layer, target_param, place });
        self.end_of_statement()
    }

    /// `LAYER.PARAM`, where the parameter may go on with `.field` or `[i]`.
    fn endpoint(&mut self) -> Result<(String, String), SceneError> {
        const STOPS: [char; 7] = [' ', '\t', '\r', '\n', '.', ',', ';'];
        let layer = self.name("a layer's name", &STOPS)?;
        if !self.take_char('.') {
            return Err(SceneError::at(self.here(), SceneProblem::NoParameter { layer })
                .with_help("a connection is written `connect LAYER.OUTPUT LAYER.INPUT`"));
        }
        Ok((layer, self.name("a parameter's name", &[' ', '\t', '\r', '\n', ',', ';'])?))
    }

    /// A name in quotes or without.
    fn name(&mut self, what: &str, stops: &[char]) -> Result<String, SceneError> {
        self.skip_space();
        if self.rest().starts_with('"') {
            return self.quoted();
        }
        let place = self.here();
        let name = self.until(stops);
        if name.is_empty() {
            return Err(SceneError::at(place, SceneProblem::NameMissing { what: what.to_owned() }));
        }
        Ok(name.to_owned())
    }

    fn quoted(&mut self) -> Result<String, SceneError> {
        let place = self.here();
        let mut out = String::new();
        let mut chars = self.rest().char_indices().skip(1);
        while let Some((offset, c)) = chars.next() {
            match c {
                '"' => {
                    self.at += offset + 1;
                    return Ok(out);
                }
                '\\' => match chars.next().map(|(_, c)| c) {
                    Some('n') => out.push('\n'),
                    Some('t') => out.push('\t'),
                    Some('r') => out.push('\r'),
                    Some(c) => out.push(c),
                    None => break,
                },
                c => out.push(c),
            }
        }
        Err(SceneError::at(place, SceneProblem::OpenString))
    }

    fn parameter(&mut self, kind_name: &str, type_place: Place) -> Result<(), SceneError> {
        let Some(kind) = ParamType::from_name(kind_name) else {
            let error = SceneError::at(type_place, SceneProblem::UnknownType { word: kind_name.to_owned() });
            return Err(match nearest(kind_name, &ParamType::NAMES) {
                Some(name) => error.with_help(format!("did you mean `{name}`?")),
                None => error.with_help(format!("known types: {}", ParamType::NAMES.join(", "))),
            });
        };
        let array = self.array_suffix()?;
        self.skip_space();
        let place = self.here();
        let name = self.until(&[' ', '\t', '\r', '\n', ',', ';', '"']).to_owned();
        if name.is_empty() {
            return Err(SceneError::at(place, SceneProblem::NameMissing { what: "a parameter's name".to_owned() }));
        }
        if array.flatten().is_some_and(|length| length * kind.components() > NUMBERS as usize) {
            return Err(SceneError::at(place, SceneProblem::TooManyValues { most: NUMBERS as usize }));
        }
        let (values, array) = self.values(kind, array)?;
        self.held += values.len();
        if self.held > SCENE_VALUES {
            return Err(SceneError::at(place, SceneProblem::TooManyValues { most: SCENE_VALUES }));
        }
        let hints = self.hints()?;
        self.out.pending.push(ParamValue { kind, array, name, values, hints, place });
        self.end_of_statement()
    }

    /// `[N]`, `[]` or nothing: `Some(Some(N))`, `Some(None)`, `None`.
    fn array_suffix(&mut self) -> Result<Option<Option<usize>>, SceneError> {
        if !self.take_char('[') {
            return Ok(None);
        }
        let place = self.here();
        let digits = self.until(&[']']).trim();
        let length = match digits {
            "" => None,
            // No parameter has more, and a slip of the pen does not ask for all memory.
            _ => Some(digits.parse().ok().filter(|n| (1..=NUMBERS as usize).contains(n)).ok_or_else(|| {
                SceneError::at(place, SceneProblem::ArrayLength { text: digits.to_owned() })
                    .with_help(format!("an array has 1 to {NUMBERS} elements"))
            })?),
        };
        self.take_char(']');
        Ok(Some(length))
    }

    fn values(&mut self, kind: ParamType, array: Option<Option<usize>>) -> Result<(Values, Option<usize>), SceneError> {
        let components = kind.components();
        let limit = match array {
            None => components,
            Some(Some(n)) => components * n,
            Some(None) => usize::MAX,
        };
        let padded = |count: usize| match array {
            Some(None) => components * (count / components).max(1),
            _ => limit,
        };
        let (values, size) = match kind {
            ParamType::Int => {
                let mut v = self.numbers::<i32>(limit);
                v.resize(padded(v.len()), 0);
                let size = v.len();
                (Values::Ints(v), size)
            }
            ParamType::String => {
                let mut v = self.strings(limit)?;
                v.resize(padded(v.len()), String::new());
                let size = v.len();
                (Values::Strings(v), size)
            }
            ParamType::Float
            | ParamType::Color
            | ParamType::Point
            | ParamType::Vector
            | ParamType::Normal
            | ParamType::Matrix => {
                let mut v = self.numbers::<f32>(limit);
                v.resize(padded(v.len()), 0.0);
                let size = v.len();
                (Values::Floats(v), size)
            }
        };
        Ok((values, array.map(|_| size / components)))
    }

    fn numbers<T: std::str::FromStr>(&mut self, limit: usize) -> Vec<T> {
        let mut out = Vec::new();
        while out.len() < limit {
            self.skip_space();
            let start = self.at;
            match self.until(&[' ', '\t', '\r', '\n', ',', ';', '[']).parse() {
                Ok(value) => out.push(value),
                Err(_) => {
                    self.at = start;
                    break;
                }
            }
        }
        out
    }

    fn strings(&mut self, limit: usize) -> Result<Vec<String>, SceneError> {
        let mut out = Vec::new();
        while out.len() < limit {
            self.skip_space();
            if self.rest().starts_with('"') {
                out.push(self.quoted()?);
                continue;
            }
            if self.rest().starts_with("[[") {
                break;
            }
            // A comma may be part of an unquoted string, as OSL reads it; only one at the end closes the statement.
            let word = self.until(&[' ', '\t', '\r', '\n', ';']);
            let trimmed = word.trim_end_matches(',');
            self.at -= word.len() - trimmed.len();
            if trimmed.is_empty() {
                break;
            }
            out.push(trimmed.to_owned());
        }
        Ok(out)
    }

    /// `[[ int lockgeom = 0, … ]]`, or nothing.
    fn hints(&mut self) -> Result<Hints, SceneError> {
        let mut hints = Hints::default();
        self.skip_space();
        if !self.rest().starts_with("[[") {
            return Ok(hints);
        }
        self.at += 2;
        loop {
            self.skip_space();
            let place = self.here();
            let kind = self.word();
            let name = self.word();
            if kind != "int" || !["lockgeom", "interpolated", "interactive"].contains(&name) {
                return Err(SceneError::at(place, SceneProblem::UnknownHint { hint: format!("{kind} {name}") })
                    .with_help("known hints: int lockgeom, int interpolated, int interactive"));
            }
            let value =
                if self.take_char('=') { self.until(&[' ', ',', ']', ';', '\n']).parse::<i32>().ok() } else { None };
            let Some(value) = value else {
                return Err(SceneError::at(place, SceneProblem::HintWithoutValue { hint: name.to_owned() }));
            };
            match name {
                "lockgeom" => hints.interpolated = Some(value == 0),
                "interpolated" => hints.interpolated = Some(value != 0),
                _ => hints.interactive = value != 0,
            }
            if !self.take_char(',') {
                break;
            }
        }
        if !(self.take_char(']') && self.take_char(']')) {
            return Err(SceneError::at(self.here(), SceneProblem::OpenHints));
        }
        Ok(hints)
    }
}
