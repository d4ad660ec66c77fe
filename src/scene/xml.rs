//! Elements of the scene's XML, with the place of each attribute and complaints that name what is known.

use super::error::{Place, SceneError, SceneProblem};
use super::places::Places;
use crate::lang::nearest::nearest;
use crate::limits::{ATTRIBUTES, SCENE_NODES};
use glam::Vec3;
use roxmltree::{Attribute, Document, Node, ParsingOptions};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// An element and the text it is in.
#[derive(Clone)]
pub struct Element<'d, 'i> {
    /// The element.
    pub node: Node<'d, 'i>,
    places: Arc<Places<'i>>,
}

/// Parses `text`; the error has its place in `file`.
pub fn parse<'i>(text: &'i str, file: &Arc<str>) -> Result<Document<'i>, SceneError> {
    let not_xml = |place, reason: String| SceneError::at(place, SceneProblem::NotXml { reason });
    if let Some(offset) = crowded(text.as_bytes()) {
        let reason = format!("an element has more than {ATTRIBUTES} attributes");
        return Err(not_xml(Places::new(file, text).at(offset), reason).with_help("use several elements"));
    }
    let options = ParsingOptions { nodes_limit: SCENE_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|e| {
        let pos = e.pos();
        let place = Place { file: file.clone(), line: pos.row, column: pos.col };
        // The parser ends its sentence with the position, which the place already says.
        let message = e.to_string();
        not_xml(place, message.split(" at ").next().unwrap_or(&message).to_owned())
    })
}

/// Where the first tag begins that has too many values in quotes. Comments and sections of plain text have no tags.
fn crowded(text: &[u8]) -> Option<usize> {
    let find = |from: usize, what: &[u8]| text[from..].windows(what.len()).position(|w| w == what).map(|at| from + at);
    let mut at = 0;
    while let Some(start) = find(at, b"<") {
        at = start + 1;
        let end = [(&b"<!--"[..], &b"-->"[..]), (b"<![CDATA[", b"]]>"), (b"<?", b"?>")];
        if let Some((_, end)) = end.iter().find(|(begin, _)| text[start..].starts_with(begin)) {
            at = find(at, end)?;
            continue;
        }
        let mut values = 0;
        while let Some(quote) = text[at..].iter().position(|b| matches!(b, b'"' | b'\'' | b'>')).map(|k| at + k) {
            at = quote + 1;
            if text[quote] == b'>' {
                break;
            }
            at += text[at..].iter().position(|b| *b == text[quote])? + 1;
            values += 1;
            if values > ATTRIBUTES {
                return Some(start);
            }
        }
    }
    None
}

impl<'d, 'i> Element<'d, 'i> {
    /// The root of a document of `file`.
    pub fn root(document: &'d Document<'i>, file: &Arc<str>) -> Self {
        let places = Arc::new(Places::new(file, document.input_text()));
        Element { node: document.root_element(), places }
    }

    /// The tag.
    pub fn tag(&self) -> &'d str {
        self.node.tag_name().name()
    }

    /// The place of a byte of the document.
    pub fn place_at(&self, offset: usize) -> Place {
        self.places.at(offset)
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
        let places = self.places.clone();
        self.node.children().filter(|n| n.is_element()).map(move |node| Element { node, places: places.clone() })
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
        let what = "three numbers `x,y,z`";
        match self.numbers(name, what)?.as_deref() {
            None => Ok(None),
            Some(&[x, y, z]) => Ok(Some(Vec3::new(x, y, z))),
            Some(_) => Err(self.bad_value(name, what)),
        }
    }

    /// Finite numbers parted by commas or spaces, when the attribute is there.
    pub fn numbers(&self, name: &str, what: &str) -> Result<Option<Vec<f32>>, SceneError> {
        let Some(text) = self.node.attribute(name) else { return Ok(None) };
        let parts = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|part| !part.is_empty());
        let numbers: Option<Vec<f32>> = parts.map(|part| part.parse().ok().filter(|x: &f32| x.is_finite())).collect();
        numbers.map(Some).ok_or_else(|| self.bad_value(name, what))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_element_of_too_many_attributes_is_found_and_no_other_text() {
        let many: String = (0..=ATTRIBUTES).map(|i| format!(" a{i}='<b c=\">'")).collect();
        let few: String = (0..ATTRIBUTES).map(|i| format!(" a{i}=\"'\"")).collect();
        assert_eq!(crowded(format!("<a x='1'><b{many}/></a>").as_bytes()), Some(9));
        for text in [format!("<!--{many}-->"), format!("<?p{many}?>"), format!("<b{few}>{many}</b>"), "<a b='".into()] {
            assert_eq!(crowded(text.as_bytes()), None, "{text}");
        }
        let section = format!("<a><![CDATA[<b{many}>]]></a>");
        assert_eq!(crowded(section.as_bytes()), None);
    }
}
