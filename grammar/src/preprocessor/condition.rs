//! The integer expressions of `#if` and `#elif`.

use super::scan::{Kind, PpToken};
use super::state::Preprocessor;
use crate::diagnostic::Diagnostic;

/// How deep parentheses and operators on the right may be nested.
const MAX_DEPTH: usize = 200;

/// A mistake in an expression: the token it is about, or `None` for the end of the line; what is wrong; the way out.
type Mistake = (Option<PpToken>, String, &'static str);

impl Preprocessor<'_> {
    /// The value of the expression after `#if`; false after a mistake, which is reported.
    pub(super) fn condition(&mut self, directive: PpToken, tokens: &[PpToken]) -> bool {
        let value = self.resolve_defined(tokens).and_then(|tokens| {
            let tokens = self.expand_all(tokens);
            let mut reader = Reader { state: self, tokens: &tokens, at: 0, depth: 0 };
            let value = reader.ternary(true)?;
            match tokens.get(reader.at) {
                None => Ok(value),
                Some(t) => {
                    Err((Some(*t), "this expression goes on where it should end".into(), "an operator is missing"))
                }
            }
        });
        match value {
            Ok(value) => value != 0,
            Err((token, message, help)) => {
                let span = self.span(token.unwrap_or(directive));
                let label = if token.is_some() { "here" } else { "the expression of this directive" };
                self.diagnostics.push(Diagnostic::error("E0108", span, message).label(label).help(help));
                false
            }
        }
    }

    /// Replaces `defined NAME` and `defined(NAME)`, which must happen before macros are expanded.
    fn resolve_defined(&mut self, tokens: &[PpToken]) -> Result<Vec<PpToken>, Mistake> {
        let mut out = Vec::with_capacity(tokens.len());
        let mut rest = tokens;
        while let Some((first, after)) = rest.split_first() {
            rest = after;
            if first.kind != Kind::Name || self.text(*first) != "defined" {
                out.push(*first);
                continue;
            }
            let (name, used) = match rest {
                [open, name, close, ..] if open.kind == Kind::ParenOpen && close.kind == Kind::ParenClose => (*name, 3),
                [name, ..] => (*name, 1),
                [] => (*first, 0),
            };
            if used == 0 || name.kind != Kind::Name {
                let help = "write `defined(NAME)`";
                return Err((Some(name), "`defined` needs the name of a macro".into(), help));
            }
            rest = &rest[used..];
            let value = if self.macros.contains_key(self.text(name)) { "1" } else { "0" };
            let place = self.table.invent(value);
            out.push(PpToken { kind: Kind::Number, place, ..*first });
        }
        Ok(out)
    }
}

/// Reads an expression from left to right. `live` is false in the half of `&&`, `||` and `?:` that does not count,
/// where a division by zero is no mistake.
struct Reader<'a, 'o> {
    state: &'a Preprocessor<'o>,
    tokens: &'a [PpToken],
    at: usize,
    depth: usize,
}

impl Reader<'_, '_> {
    fn next(&mut self) -> Option<PpToken> {
        let token = self.tokens.get(self.at).copied();
        self.at += 1;
        token
    }

    fn eat(&mut self, kind: Kind) -> bool {
        let found = self.tokens.get(self.at).is_some_and(|t| t.kind == kind);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, kind: Kind, shown: &str) -> Result<(), Mistake> {
        if self.eat(kind) {
            return Ok(());
        }
        let token = self.tokens.get(self.at).copied();
        Err((token, format!("`{shown}` is missing in this expression"), "every `(` needs a `)` and every `?` a `:`"))
    }

    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T, Mistake>) -> Result<T, Mistake> {
        if self.depth == MAX_DEPTH {
            let token = self.tokens.get(self.at).copied();
            return Err((token, format!("this expression is nested more than {MAX_DEPTH} deep"), "split it up"));
        }
        self.depth += 1;
        let result = read(self);
        self.depth -= 1;
        result
    }

    fn ternary(&mut self, live: bool) -> Result<i64, Mistake> {
        let test = self.binary(1, live)?;
        if !self.eat(Kind::Question) {
            return Ok(test);
        }
        let a = self.deeper(|r| r.ternary(live && test != 0))?;
        self.expect(Kind::Colon, ":")?;
        let b = self.deeper(|r| r.ternary(live && test == 0))?;
        Ok(if test != 0 { a } else { b })
    }

    /// Operators of at least a strength, by precedence climbing.
    fn binary(&mut self, least: u8, live: bool) -> Result<i64, Mistake> {
        let mut left = self.deeper(|r| r.unary(live))?;
        while let Some(operator) = self.tokens.get(self.at).copied() {
            let strength = strength(operator.kind);
            if strength < least {
                break;
            }
            self.at += 1;
            let counts = match operator.kind {
                Kind::AndAnd => live && left != 0,
                Kind::OrOr => live && left == 0,
                _ => live,
            };
            let right = self.deeper(|r| r.binary(strength + 1, counts))?;
            let dividing = matches!(operator.kind, Kind::Slash | Kind::Percent);
            if dividing && right == 0 && live {
                let help = "test the divisor first, as in `N != 0 && 8 / N > 1`";
                return Err((Some(operator), "division by zero".into(), help));
            }
            left = apply(operator.kind, left, right);
        }
        Ok(left)
    }

    fn unary(&mut self, live: bool) -> Result<i64, Mistake> {
        let help = "an expression is made of integers, names of macros and operators";
        let Some(token) = self.next() else {
            return Err((None, "this expression ends too early".into(), help));
        };
        match token.kind {
            Kind::Not => Ok(i64::from(self.deeper(|r| r.unary(live))? == 0)),
            Kind::Minus => Ok(self.deeper(|r| r.unary(live))?.wrapping_neg()),
            Kind::Plus => self.deeper(|r| r.unary(live)),
            Kind::Tilde => Ok(!self.deeper(|r| r.unary(live))?),
            Kind::ParenOpen => {
                let value = self.deeper(|r| r.ternary(live))?;
                self.expect(Kind::ParenClose, ")")?;
                Ok(value)
            }
            Kind::Number => match number(self.state.text(token)) {
                Some(value) => Ok(value),
                None => Err((Some(token), "this is not an integer".into(), "#if counts with integers only")),
            },
            Kind::Character => match character(self.state.text(token)) {
                Some(code) => Ok(code),
                None => Err((Some(token), "this is no character".into(), "write one as 'a' or '\\n'")),
            },
            // A name that is no macro counts as 0.
            Kind::Name => Ok(0),
            _ => Err((Some(token), format!("`{}` does not belong in #if", self.state.text(token)), help)),
        }
    }
}

/// The code of a character between single quotes.
fn character(text: &str) -> Option<i64> {
    let mut inner = text.strip_prefix('\'')?.strip_suffix('\'')?.chars();
    let code = match (inner.next()?, inner.next()) {
        ('\\', Some(escaped)) => match escaped {
            'n' => '\n',
            't' => '\t',
            'r' => '\r',
            '0' => '\0',
            'a' => '\u{7}',
            'b' => '\u{8}',
            'f' => '\u{c}',
            'v' => '\u{b}',
            '\\' | '\'' | '"' | '?' => escaped,
            _ => return None,
        },
        (plain, None) => plain,
        _ => return None,
    };
    Some(i64::from(u32::from(code)))
}

/// How tightly an operator binds; 0 for what is none.
fn strength(kind: Kind) -> u8 {
    match kind {
        Kind::OrOr => 1,
        Kind::AndAnd => 2,
        Kind::Pipe => 3,
        Kind::Caret => 4,
        Kind::And => 5,
        Kind::EqualEqual | Kind::NotEqual => 6,
        Kind::Less | Kind::LessEqual | Kind::Greater | Kind::GreaterEqual => 7,
        Kind::Shl | Kind::Shr => 8,
        Kind::Plus | Kind::Minus => 9,
        Kind::Star | Kind::Slash | Kind::Percent => 10,
        _ => 0,
    }
}

fn apply(operator: Kind, a: i64, b: i64) -> i64 {
    match operator {
        Kind::OrOr => i64::from(a != 0 || b != 0),
        Kind::AndAnd => i64::from(a != 0 && b != 0),
        Kind::Pipe => a | b,
        Kind::Caret => a ^ b,
        Kind::And => a & b,
        Kind::EqualEqual => i64::from(a == b),
        Kind::NotEqual => i64::from(a != b),
        Kind::Less => i64::from(a < b),
        Kind::LessEqual => i64::from(a <= b),
        Kind::Greater => i64::from(a > b),
        Kind::GreaterEqual => i64::from(a >= b),
        Kind::Shl => a.wrapping_shl(b as u32),
        Kind::Shr => a.wrapping_shr(b as u32),
        Kind::Plus => a.wrapping_add(b),
        Kind::Minus => a.wrapping_sub(b),
        Kind::Star => a.wrapping_mul(b),
        // A zero divisor gets here only in a half that does not count.
        Kind::Slash => a.checked_div(b).unwrap_or(0),
        Kind::Percent => a.checked_rem(b).unwrap_or(0),
        _ => 0,
    }
}

/// A decimal, hexadecimal or octal integer with C's suffixes.
fn number(text: &str) -> Option<i64> {
    let digits = text.trim_end_matches(['u', 'U', 'l', 'L']);
    if let Some(hex) = digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")) {
        return u64::from_str_radix(hex, 16).ok().map(|v| v as i64);
    }
    if digits.len() > 1 && digits.starts_with('0') {
        return i64::from_str_radix(digits, 8).ok();
    }
    digits.parse().ok()
}
