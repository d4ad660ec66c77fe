//! What a file says of its picture besides texels.

use crate::limits::ABOUT_BYTES;

/// What a file says of its picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// Columns and rows of which the file has texels, first and last ones both in: x, y, x, y. Nothing where that is all of them.
    pub data: Option<[i32; 4]>,
    /// Names and texts, as OpenImageIO names them.
    pub texts: Vec<(String, String)>,
}

impl About {
    /// Adds a text, unless there are more than a file may have.
    pub fn add(&mut self, name: &str, text: String) {
        if self.bytes() + name.len() + text.len() <= ABOUT_BYTES {
            self.texts.push((name.to_owned(), text));
        }
    }

    /// Bytes that the names and texts take.
    pub fn bytes(&self) -> usize {
        self.texts.iter().map(|(name, text)| name.len() + text.len()).sum()
    }

    /// The text of a name, whatever its case.
    pub fn text(&self, name: &str) -> Option<&str> {
        let known = self.texts.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        known.map(|(_, text)| text.as_str())
    }

    /// The numbers of a name, which commas separate.
    pub fn numbers(&self, name: &str) -> Option<Vec<f32>> {
        self.text(name)?.split(',').map(|part| part.trim().parse().ok()).collect()
    }

    /// Takes `name=value` out of a description, where `maketx` writes what a TIFF has no tags for.
    pub fn describe(&mut self, description: &str) {
        for name in ["oiio:AverageColor", "oiio:ConstantColor"] {
            let value = description.split_once(name).and_then(|(_, rest)| rest.strip_prefix('='));
            let value = value.and_then(|rest| rest.split_whitespace().next());
            value.into_iter().for_each(|value| self.add(name, value.to_owned()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_description_says_what_colors_there_are() {
        let mut about = About { data: None, texts: vec![("DateTime".to_owned(), "2026:11:29 00:00:00".to_owned())] };
        about.describe("words oiio:ConstantColor=.5,1,0.25,1 oiio:AverageColor=a,b oiio:SHA-1=FF");
        assert_eq!(about.text("datetime"), Some("2026:11:29 00:00:00"));
        assert_eq!(about.numbers("oiio:ConstantColor"), Some(vec![0.5, 1.0, 0.25, 1.0]));
        assert_eq!((about.numbers("oiio:AverageColor"), about.numbers("other")), (None, None));
        let bytes = about.bytes();
        about.add("long", "x".repeat(ABOUT_BYTES));
        about.add("short", "x".to_owned());
        assert_eq!((about.text("long"), about.text("short"), about.bytes()), (None, Some("x"), bytes + 6));
    }
}
