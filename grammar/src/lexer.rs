//! Preprocessing tokens to the terminals of the grammar: keywords, reserved words, numbers and strings.
//!
//! The lexer never fails. What is wrong is reported here and replaced by what was most likely meant, or by
//! [`Token::Error`], about which the parser stays silent.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::literal::{self, Number};
use crate::preprocessor::Terminal;
use crate::preprocessor::scan::Kind;
use crate::source::Sources;
use crate::span::Span;
use crate::token::{Sym, Token, shader_kind};

/// A terminal between the indices of its first and last expanded token.
pub(crate) type Spanned<'s> = (u32, Token<'s>, u32);

/// Lexes everything.
pub(crate) fn lex<'s>(tokens: &[Terminal], sources: &'s Sources, diagnostics: &mut Diagnostics) -> Vec<Spanned<'s>> {
    let mut lexer = Lexer { sources, tokens, at: 0, out: Vec::with_capacity(tokens.len()), diagnostics };
    while lexer.at < tokens.len() {
        lexer.step();
    }
    lexer.out
}

struct Lexer<'s, 't> {
    sources: &'s Sources,
    tokens: &'t [Terminal],
    at: usize,
    out: Vec<Spanned<'s>>,
    diagnostics: &'t mut Diagnostics,
}

impl<'s> Lexer<'s, '_> {
    fn step(&mut self) {
        let token = self.tokens[self.at];
        let index = token.index;
        if token.kind == Kind::Text {
            return self.strings();
        }
        self.at += 1;
        let span = Span { first: index, last: index };
        let terminal = match token.kind {
            Kind::Name => self.word(token, span),
            Kind::Number => Some(self.number(token, span)),
            Kind::UnclosedText => Some(self.unclosed(token, span)),
            Kind::Broken | Kind::UnclosedComment => Some(Token::Error),
            kind => Some(match symbol(kind) {
                Some(symbol) => Token::Sym(symbol),
                None => self.stray(token, span),
            }),
        };
        if let Some(terminal) = terminal {
            self.out.push((index, terminal, index));
        }
    }

    fn text(&self, token: Terminal) -> &'s str {
        self.sources.token(token.index).map_or("", |token| self.sources.spelling(token.place))
    }

    /// Neighbouring strings are one.
    fn strings(&mut self) {
        let first = self.tokens[self.at].index;
        let mut last = first;
        let mut value = String::new();
        while let Some(token) = self.tokens.get(self.at).copied().filter(|token| token.kind == Kind::Text) {
            let text = self.text(token);
            let inner = text.get(1..text.len() - 1).unwrap_or("");
            value.push_str(&self.unescaped(inner, token.index));
            last = token.index;
            self.at += 1;
        }
        self.out.push((first, Token::Str(value), last));
    }

    fn unescaped(&mut self, inner: &str, index: u32) -> String {
        literal::string(inner, |start, end| {
            let escape = &inner[start..end];
            let span = Span { first: index, last: index };
            self.diagnostics.push(
                Diagnostic::warning("W0203", span, format!("`{escape}` is not an escape sequence"))
                    .label("the backslash is dropped")
                    .help("write `\\\\` for a backslash"),
            );
        })
    }

    fn unclosed(&mut self, token: Terminal, span: Span) -> Token<'s> {
        self.diagnostics.push(
            Diagnostic::error("E0202", span, "this string is never closed")
                .label("the string starts here")
                .help("add `\"` before the end of the line"),
        );
        Token::Str(self.text(token).trim_start_matches('"').to_string())
    }

    fn stray(&mut self, token: Terminal, span: Span) -> Token<'s> {
        let text = self.text(token);
        let help = match text {
            _ if text.starts_with('\'') => "strings are written with double quotes",
            "#" => "a directive must be the first thing on its line",
            "##" => "`##` has a meaning only inside #define",
            "@" | "$" | "`" | "\\" => "remove it",
            "..." => "OSL has no functions with a variable number of arguments",
            _ => "outside of strings and comments only ASCII is allowed",
        };
        let shown =
            text.chars().map(|c| if matches!(c, '\'' | '\\') { c.to_string() } else { c.escape_debug().to_string() });
        let message = format!("`{}` has no meaning in OSL", shown.collect::<String>());
        self.diagnostics.push(Diagnostic::error("E0201", span, message).label("not expected anywhere").help(help));
        Token::Error
    }

    fn number(&mut self, token: Terminal, span: Span) -> Token<'s> {
        let text = self.text(token);
        match literal::number(text) {
            Number::Int(value) => Token::Int(value),
            Number::Float(value) => Token::Float(value),
            Number::Wrapped(value) => {
                let negated = matches!(self.out.last(), Some((_, Token::Sym(Sym::Minus), _)));
                if !negated {
                    self.diagnostics.push(
                        Diagnostic::warning("W0201", span, format!("{text} is too large for an int"))
                            .label(format!("becomes {value}"))
                            .help("write it in hexadecimal if the bits are meant, or as a float"),
                    );
                }
                Token::Int(value)
            }
            Number::TooLarge => {
                self.diagnostics.push(
                    Diagnostic::error("E0206", span, format!("{text} is too large for an int"))
                        .label("ints go up to 2147483647")
                        .help("write it as a float, with a decimal point, or in hexadecimal if the bits are meant"),
                );
                Token::Int(0)
            }
            Number::Infinite(value) => {
                self.diagnostics.push(
                    Diagnostic::warning("W0202", span, format!("{text} is too large for a float"))
                        .label("becomes infinite")
                        .help("the largest float is about 3.4e38"),
                );
                Token::Float(value)
            }
            Number::Malformed => self.malformed(text, span),
        }
    }

    fn malformed(&mut self, text: &'s str, span: Span) -> Token<'s> {
        let plain = text.trim_end_matches(['f', 'F']);
        let (help, guess) = match (literal::number(plain), text.len() > plain.len()) {
            (Number::Float(v), true) => (format!("OSL has no suffix `f`: write `{plain}`"), Token::Float(v)),
            (Number::Int(v), true) => (format!("OSL has no suffix `f`: write `{plain}.0`"), Token::Float(v as f32)),
            _ => ("numbers look like 12, 0x1f, 1.5, .5 or 1e-3; names do not start with a digit".into(), Token::Int(0)),
        };
        self.diagnostics
            .push(Diagnostic::error("E0203", span, format!("`{text}` is not a number")).label("malformed").help(help));
        guess
    }

    /// A keyword, a reserved word, the kind of a shader, or else a name. Nothing for a word best ignored.
    fn word(&mut self, token: Terminal, span: Span) -> Option<Token<'s>> {
        let text = self.text(token);
        if let Some(keyword) = Sym::keyword(text) {
            return Some(Token::Sym(keyword));
        }
        if let Some(kind) = shader_kind(text) {
            let named = self.tokens.get(self.at).is_some_and(|next| next.kind == Kind::Name);
            let free = !matches!(self.out.last(), Some((_, Token::Sym(Sym::Struct), _)));
            return Some(if named && free { Token::Kind(kind) } else { Token::Ident(text) });
        }
        let Some((meant, help)) = reserved(text) else {
            return Some(Token::Ident(text));
        };
        self.diagnostics.push(
            Diagnostic::error("E0204", span, format!("`{text}` is a reserved word"))
                .label("has no meaning in OSL, and cannot be a name")
                .help(help),
        );
        match meant {
            Meant::Nothing => None,
            Meant::Symbol(symbol) => Some(Token::Sym(symbol)),
            Meant::Int(value) => Some(Token::Int(value)),
            Meant::Name => Some(Token::Ident(text)),
        }
    }
}

/// What a reserved word is read as after it has been reported.
enum Meant {
    Nothing,
    Symbol(Sym),
    Int(i32),
    Name,
}

/// Is a word a keyword, or reserved?
pub(crate) fn is_taken(word: &str) -> bool {
    Sym::keyword(word).is_some() || reserved(word).is_some()
}

fn reserved(word: &str) -> Option<(Meant, &'static str)> {
    Some(match word {
        "bool" => (Meant::Symbol(Sym::IntType), "write `int`; conditions are 0 or 1"),
        "char" | "enum" | "long" | "short" | "signed" | "unsigned" => {
            (Meant::Symbol(Sym::IntType), "the only integer type is `int`")
        }
        "double" => (Meant::Symbol(Sym::FloatType), "the only floating-point type is `float`"),
        "true" => (Meant::Int(1), "write `1`, or put `#define true 1` at the top"),
        "false" => (Meant::Int(0), "write `0`, or put `#define false 0` at the top"),
        "const" | "extern" | "friend" | "inline" | "private" | "protected" | "public" | "static" | "uniform"
        | "varying" | "virtual" => (Meant::Nothing, "leave it out"),
        "class" | "union" | "typedef" | "template" => (Meant::Name, "the only types to declare are `struct`s"),
        "switch" | "case" | "default" => (Meant::Name, "write `if … else if …`; otherwise choose another name"),
        "illuminance" | "illuminate" => (Meant::Name, "light is gathered by the renderer: return closures in `Ci`"),
        "sizeof" => (Meant::Name, "`arraylength(a)` gives the length of an array"),
        "this" => (Meant::Name, "choose another name"),
        _ => return None,
    })
}

/// The terminal of an operator or bracket.
fn symbol(kind: Kind) -> Option<Sym> {
    macro_rules! alike {
        ($($name:ident)*) => { match kind { $(Kind::$name => Some(Sym::$name),)* _ => None } };
    }
    alike!(ParenOpen ParenClose BracketOpen BracketClose MetaOpen BraceOpen BraceClose Semicolon Comma Dot Question
        Colon Plus Minus Star Slash Percent Shl Shr Less LessEqual Greater GreaterEqual EqualEqual NotEqual And Caret
        Pipe AndAnd OrOr Not Tilde Increment Decrement Assign AddAssign SubAssign MulAssign DivAssign AndAssign
        OrAssign XorAssign ShlAssign ShrAssign)
}
