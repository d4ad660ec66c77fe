//! The lines that are written: code at its indentation, and comments behind it in one column.

use super::pieces::advanced;

/// A line.
#[derive(Debug, Default)]
struct Line {
    /// An empty line stands before it.
    apart: bool,
    indent: usize,
    code: String,
    /// The comment at its end, and its column in the text it comes from.
    comment: Option<(String, usize)>,
}

/// The lines so far; the last one may grow.
#[derive(Debug, Default)]
pub(super) struct Lines {
    lines: Vec<Line>,
    /// The column at the end of the last line's code.
    column: usize,
}

/// A comment further to the right than this many columns from the end of its own line's code is not drawn into line.
const MOST_FILL: usize = 40;

impl Lines {
    /// Begins a line.
    pub(super) fn begin(&mut self, indent: usize, apart: bool) {
        let apart = apart && !self.lines.is_empty();
        self.lines.push(Line { apart, indent, ..Line::default() });
        self.column = indent;
    }

    /// Adds code to the last line.
    pub(super) fn push(&mut self, text: &str) {
        if let Some(line) = self.lines.last_mut() {
            line.code.push_str(text);
            self.column = advanced(self.column, text);
        }
    }

    /// Adds a comment to the end of the last line.
    pub(super) fn comment(&mut self, text: &str, column: usize) {
        if let Some(line) = self.lines.last_mut() {
            line.comment = Some((text.to_owned(), column));
        }
    }

    /// The indentation of the last line.
    pub(super) fn indent(&self) -> usize {
        self.lines.last().map_or(0, |line| line.indent)
    }

    /// The column at which the next text of the last line begins.
    pub(super) fn column(&self) -> usize {
        self.column
    }

    /// Where the comment at the end of the last line stood in the text.
    pub(super) fn comment_column(&self) -> Option<usize> {
        self.lines.last().and_then(|line| line.comment.as_ref()).map(|(_, column)| *column)
    }

    /// The whole text.
    pub(super) fn finish(self) -> String {
        let mut out = String::new();
        let mut at = 0;
        while at < self.lines.len() {
            let end = (at + 1..self.lines.len()).find(|next| !follows(&self.lines, *next)).unwrap_or(self.lines.len());
            let block = &self.lines[at..end];
            let widest = block.iter().map(Line::width).max().unwrap_or(0);
            let narrowest = block.iter().filter(|line| !line.code.is_empty()).map(Line::width).min().unwrap_or(0);
            block.iter().for_each(|line| line.write(&mut out, (widest - narrowest <= MOST_FILL).then_some(widest)));
            at = end;
        }
        out
    }
}

/// Are the comments of a line and of the one before in one column?
fn follows(lines: &[Line], at: usize) -> bool {
    let (line, before) = (&lines[at], &lines[at - 1]);
    line.comment.is_some() && before.comment.is_some() && !line.apart
}

impl Line {
    /// Columns up to the end of the code.
    fn width(&self) -> usize {
        advanced(self.indent, &self.code)
    }

    fn write(&self, out: &mut String, column: Option<usize>) {
        if self.apart {
            out.push('\n');
        }
        if !self.code.is_empty() {
            out.extend(std::iter::repeat_n(' ', self.indent));
            out.push_str(&self.code);
        }
        if let Some((comment, _)) = &self.comment {
            let column = column.unwrap_or(0).max(self.width());
            let before = if self.code.is_empty() { 0 } else { self.width() };
            out.extend(std::iter::repeat_n(' ', column + 1 - before));
            out.push_str(comment);
        }
        out.push('\n');
    }
}
