//! The brackets that are open, and the statements without braces that hang on each other in them.

use super::pieces::STEP;

/// What a bracket holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The file.
    File,
    /// Statements or fields.
    Block,
    /// What stands in round or square brackets, or the values of a list.
    List,
    /// `[[ … ]]`
    Metadata,
}

/// What waits for its statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Head {
    /// `if (…)`
    If,
    /// `else`
    Else,
    /// `for (…)` or `while (…)`
    Loop,
    /// `do`
    Do,
    /// The `while` of a `do`, after which nothing is waited for.
    DoEnd,
}

/// An open bracket.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// What it holds.
    pub kind: Kind,
    /// The indentation of what it hangs on, which its end returns to.
    pub base: usize,
    /// The steps from there to what it holds.
    pub steps: usize,
    /// The columns, in the text and as written, of what follows the bracket, or the `=` of a statement, on its line.
    pub align: Option<(usize, usize)>,
    /// The next token begins a statement, or an element of a list.
    pub fresh: bool,
    /// The indentation of the line on which that began.
    pub start: usize,
    /// Whether it was the first of its line.
    pub first: bool,
    /// What waits for its statement, with the indentation of each.
    pub waiting: Vec<(Head, usize)>,
    /// The indentation of the `if` or `do` that the next word goes on.
    pub resumed: Option<usize>,
    /// The word whose condition is next, with its indentation.
    pub head: Option<(Head, usize)>,
    /// The condition of a statement.
    pub condition: bool,
    /// The type of a cast.
    pub cast: bool,
    /// Spaces count in it.
    pub exact: bool,
    /// The first of two brackets that end metadata has been seen.
    pub half_closed: bool,
}

impl Frame {
    /// What a bracket holds, which hangs on a line of this indentation.
    pub(super) fn new(kind: Kind, base: usize) -> Self {
        Frame {
            kind,
            base,
            steps: usize::from(kind != Kind::File),
            align: None,
            fresh: true,
            start: base,
            first: false,
            waiting: Vec::new(),
            resumed: None,
            head: None,
            condition: false,
            cast: false,
            exact: false,
            half_closed: false,
        }
    }

    /// Does it hold statements?
    pub(super) fn is_block(&self) -> bool {
        matches!(self.kind, Kind::File | Kind::Block)
    }

    /// Where a line is written that begins in the text in the column of what it goes on.
    pub(super) fn aligned(&self, column: usize) -> Option<usize> {
        self.align.filter(|(there, _)| *there == column).map(|(_, written)| written)
    }

    /// The indentation of what it holds.
    pub(super) fn inner(&self) -> usize {
        self.base + self.steps * STEP
    }

    /// The indentation of a statement that begins a line.
    pub(super) fn statement(&self, brace: bool) -> usize {
        match (self.resumed, self.waiting.last()) {
            (Some(indent), _) => indent,
            (None, Some((_, indent))) => indent + if brace { 0 } else { STEP },
            (None, None) => self.inner(),
        }
    }

    /// A statement has ended before this word: an `else` goes on the nearest `if`, a `while` the `do` it belongs to.
    pub(super) fn end_statement(&mut self, next: &str) {
        let wanted = match next {
            "else" => Some(Head::If),
            "while" => Some(Head::Do),
            _ => None,
        };
        let at = wanted.and_then(|wanted| self.waiting.iter().rposition(|(head, _)| *head == wanted));
        match at {
            Some(at) => {
                self.resumed = Some(self.waiting[at].1);
                self.head = (next == "while").then_some((Head::DoEnd, self.waiting[at].1));
                self.waiting.truncate(at);
            }
            None => {
                (self.resumed, self.head) = (None, None);
                self.waiting.clear();
            }
        }
        self.fresh = true;
    }
}
