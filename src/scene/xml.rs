//! Elements of the scene's XML, with the place of each attribute and complaints that name what is known.

use super::error::{Place, SceneError, SceneProblem};
use super::nearest::nearest;
use glam::Vec3;
use roxmltree::{Attribute, Document, Node};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// An element and the file it is in.
#[derive(Clone)]
pub struct Element<'d, 'i> {
    /// The element.
    pub node: Node<'d, 'i>,
    /// The file's name, for places.
    pub file: Arc<str>,
}

/// Parses `text`; the error has its place in `file`.
pub fn parse<'i>(text: &'i str, file: &Arc<str>) -> Result<Document<'i>, SceneError> {
    Document::parse(text).map_err(|e| {
        let pos = e.pos();
        let place = Place { file: file.clone(), line: pos.row, column: pos.col };
        // The parser ends its sentence with the position, which the place already says.
        let message = e.to_string();
        let reason = message.split(" at ").next().unwrap_or(&message).to_owned();
        SceneError::at(place, SceneProblem::NotXml { reason })
    })
}

impl<'d, 'i> Element<'d, 'i> {
    /// The tag.
    pub fn tag(&self) -> &'d str {
        self.node.tag_name().name()
    }

    /// The place of a byte of the document.
    pub fn place_at(&self, offset: usize) -> Place {
        let pos = self.node.document().text_pos_at(offset);
        Place { file: self.file.clone(), line: pos.row, column: pos.col }
    }

    /// Where the element begins.
    pub fn place(&self) -> Place {
        self.place_at(self.node.range().start)
    }

    /// Where an attribute's value begins.
    pub fn value_place(&self, name: &str) -> Place {
        match self.node.attribute_node(name) {
            Some(attribute) => self.place_at(attribute.range_value().start),
            None => self.place(),
        }
    }

    /// The child elements, for an element that holds nothing else.
    ///
    /// # Errors
    /// There is text between them.
    pub fn only_children(&self) -> Result<impl Iterator<Item = Element<'d, 'i>> + use<'d, 'i>, SceneError> {
        for text in self.node.children().filter(|n| n.is_text()) {
            let written = text.text().unwrap_or_default();
            if let Some(at) = written.find(|c: char| !c.is_whitespace()) {
                // Entities make the text shorter than its source; then the start has to do.
                let exact = text.range().len() == written.len();
                let place = self.place_at(text.range().start + if exact { at } else { 0 });
                let error = SceneError::at(place, SceneProblem::StrayText { tag: self.tag().to_owned() });
                return Err(error.with_help("remove it, or put it between `<!--` and `-->`"));
            }
        }
        Ok(self.children())
    }

    /// The child elements, whatever is between them.
    pub fn children(&self) -> impl Iterator<Item = Element<'d, 'i>> + use<'d, 'i> {
        let file = self.file.clone();
        self.node.children().filter(|n| n.is_element()).map(move |node| Element { node, file: file.clone() })
    }

    /// The attributes.
    pub fn attributes(&self) -> impl Iterator<Item = Attribute<'d, 'i>> + use<'d, 'i> {
        self.node.attributes()
    }

    /// An unknown tag: says which one was meant.
    pub fn unknown_tag(&self, known: &[&str]) -> SceneError {
        let tag = self.tag();
        let problem = SceneProblem::UnknownTag { tag: tag.to_owned() };
        SceneError::at(self.place(), problem).with_help(match nearest(tag, known) {
            Some(name) => format!("did you mean <{name}>?"),
            None => format!("known tags here: {}", known.join(", ")),
        })
    }

    /// Complains of the first attribute that is not in `known`.
    pub fn check_attributes(&self, known: &[&str]) -> Result<(), SceneError> {
        for attribute in self.attributes() {
            let name = attribute.name();
            if !known.contains(&name) {
                let place = self.place_at(attribute.range().start);
                let (tag, attribute) = (self.tag().to_owned(), name.to_owned());
                let error = SceneError::at(place, SceneProblem::UnknownAttribute { tag, attribute });
                return Err(match nearest(name, known) {
                    Some(name) => error.with_help(format!("did you mean `{name}`?")),
                    None if known.is_empty() => error,
                    None => error.with_help(format!("it has: {}", known.join(", "))),
                });
            }
        }
        Ok(())
    }

    /// A required attribute.
    pub fn required(&self, name: &str) -> Result<&'d str, SceneError> {
        self.node.attribute(name).ok_or_else(|| {
            let (tag, attribute) = (self.tag().to_owned(), name.to_owned());
            SceneError::at(self.place(), SceneProblem::MissingAttribute { tag, attribute })
        })
    }

    /// A triple `x,y,z`, when the attribute is there.
    pub fn vector(&self, name: &str) -> Result<Option<Vec3>, SceneError> {
        let Some(text) = self.node.attribute(name) else { return Ok(None) };
        let numbers: Option<Vec<f32>> = text
            .split(|c: char| c == ',' || c.is_whitespace())
            .filter(|part| !part.is_empty())
            .map(|part| part.parse::<f32>().ok().filter(|x| x.is_finite()))
            .collect();
        match numbers.as_deref() {
            Some(&[x, y, z]) => Ok(Some(Vec3::new(x, y, z))),
            _ => Err(self.bad_value(name, "three numbers `x,y,z`")),
        }
    }

    /// A required triple.
    pub fn required_vector(&self, name: &str) -> Result<Vec3, SceneError> {
        self.required(name)?;
        Ok(self.vector(name)?.unwrap_or_default())
    }

    /// A number, when the attribute is there.
    pub fn number<T: std::str::FromStr>(&self, name: &str, what: &str) -> Result<Option<T>, SceneError> {
        match self.node.attribute(name) {
            None => Ok(None),
            Some(text) => text.trim().parse().map(Some).map_err(|_| self.bad_value(name, what)),
        }
    }

    /// A whole number in a range, or `default` when the attribute is not there.
    pub fn whole(&self, name: &str, default: u32, range: RangeInclusive<u32>) -> Result<u32, SceneError> {
        let what = format!("a whole number from {} to {}", range.start(), range.end());
        match self.number::<u32>(name, &what)?.unwrap_or(default) {
            value if range.contains(&value) => Ok(value),
            _ => Err(self.bad_value(name, &what)),
        }
    }

    /// A number in a range, or `default` when the attribute is not there.
    pub fn real(&self, name: &str, default: f32, range: RangeInclusive<f32>) -> Result<f32, SceneError> {
        let what = format!("a number from {} to {}", range.start(), range.end());
        match self.number::<f32>(name, &what)?.unwrap_or(default) {
            value if range.contains(&value) => Ok(value),
            _ => Err(self.bad_value(name, &what)),
        }
    }

    /// An attribute whose value is not what it should be.
    pub fn bad_value(&self, name: &str, expected: &str) -> SceneError {
        let problem = SceneProblem::BadValue {
            tag: self.tag().to_owned(),
            attribute: name.to_owned(),
            value: self.node.attribute(name).unwrap_or_default().to_owned(),
            expected: expected.to_owned(),
        };
        SceneError::at(self.value_place(name), problem)
    }
}
