//! Expressions as text, with the fewest parentheses. It works on a list of what is left to print and not by
//! recursion, since a chain of operators can be very deep.

use super::types::print_type;
use crate::ast::*;
use std::borrow::Cow;

/// How tightly an expression binds, loosest first.
mod level {
    pub(super) const COMMA: u8 = 0;
    pub(super) const ASSIGN: u8 = 1;
    pub(super) const TERNARY: u8 = 2;
    pub(super) const OR: u8 = 3;
    pub(super) const UNARY: u8 = 13;
    pub(super) const POSTFIX: u8 = 14;
    pub(super) const PRIMARY: u8 = 15;
}

enum Piece<'a> {
    Text(Cow<'a, str>),
    /// An expression that is put in parentheses when it binds more loosely than the level.
    Expr(&'a Expr, u8),
}

/// Prints an expression where the comma operator is allowed.
pub(super) fn write(expr: &Expr, out: &mut String) {
    run(vec![Piece::Expr(expr, level::COMMA)], out);
}

/// Prints an expression where a comma would separate list items.
pub(super) fn write_item(expr: &Expr, out: &mut String) {
    run(vec![Piece::Expr(expr, level::ASSIGN)], out);
}

fn run(mut todo: Vec<Piece<'_>>, out: &mut String) {
    while let Some(piece) = todo.pop() {
        match piece {
            Piece::Text(text) => out.push_str(&text),
            Piece::Expr(expr, least) => {
                let mut pieces = pieces(expr);
                if strength(expr) < least {
                    pieces.insert(0, text("("));
                    pieces.push(text(")"));
                }
                todo.extend(pieces.into_iter().rev());
            }
        }
    }
}

fn text<'a>(text: impl Into<Cow<'a, str>>) -> Piece<'a> {
    Piece::Text(text.into())
}

fn strength(expr: &Expr) -> u8 {
    match &expr.kind {
        ExprKind::Comma(_) => level::COMMA,
        ExprKind::Assign(..) => level::ASSIGN,
        ExprKind::Ternary(..) => level::TERNARY,
        ExprKind::Binary(op, ..) => binary_strength(*op),
        ExprKind::Unary(..) | ExprKind::Cast(..) | ExprKind::Step { prefix: true, .. } => level::UNARY,
        ExprKind::Step { .. } | ExprKind::Index(..) | ExprKind::Field(..) => level::POSTFIX,
        _ => level::PRIMARY,
    }
}

fn binary_strength(op: BinaryOp) -> u8 {
    level::OR + op.tightness()
}

fn pieces(expr: &Expr) -> Vec<Piece<'_>> {
    match &expr.kind {
        // The text has no negative literals, but hexadecimal ones reach all 32 bits.
        ExprKind::Int(value) if *value < 0 => vec![text(format!("{value:#x}"))],
        ExprKind::Int(value) => vec![text(value.to_string())],
        ExprKind::Float(value) if value.is_infinite() => vec![text("1e99")],
        ExprKind::Float(value) => vec![text(format!("{value:?}"))],
        ExprKind::String(value) => vec![text(quoted(value))],
        ExprKind::Name(name) => vec![text(name.as_str())],
        ExprKind::Unary(op, a) => prefixed(op.symbol(), a),
        ExprKind::Binary(op, a, b) => {
            let level = binary_strength(*op);
            vec![Piece::Expr(a, level), text(format!(" {} ", op.symbol())), Piece::Expr(b, level + 1)]
        }
        ExprKind::Assign(op, a, b) => {
            let symbol = op.map_or("", BinaryOp::symbol);
            vec![Piece::Expr(a, level::POSTFIX), text(format!(" {symbol}= ")), Piece::Expr(b, level::ASSIGN)]
        }
        ExprKind::Step { increment, prefix, target } => {
            let symbol = if *increment { "++" } else { "--" };
            match prefix {
                true => prefixed(symbol, target),
                false => vec![Piece::Expr(target, level::POSTFIX), text(symbol)],
            }
        }
        ExprKind::Ternary(c, a, b) => vec![
            Piece::Expr(c, level::OR),
            text(" ? "),
            Piece::Expr(a, level::ASSIGN),
            text(" : "),
            Piece::Expr(b, level::ASSIGN),
        ],
        ExprKind::Comma(list) => listed("", list, ""),
        ExprKind::Cast(ty, a) => vec![text(format!("({})", print_type(ty))), Piece::Expr(a, level::UNARY)],
        ExprKind::Construct(ty, list) => listed(&format!("{}(", print_type(ty)), list, ")"),
        ExprKind::Call(name, list) => listed(&format!("{}(", name.name), list, ")"),
        ExprKind::Index(a, i) => {
            vec![Piece::Expr(a, level::POSTFIX), text("["), Piece::Expr(i, level::COMMA), text("]")]
        }
        ExprKind::Field(a, name) => {
            // `1.x` would be a malformed number.
            let number = matches!(a.kind, ExprKind::Int(_) | ExprKind::Float(_));
            let (open, close) = if number { ("(", ")") } else { ("", "") };
            vec![text(open), Piece::Expr(a, level::POSTFIX), text(close), text("."), text(name.name.as_str())]
        }
        ExprKind::InitList(list) => listed("{", list, "}"),
        ExprKind::Error => vec![text("<error>")],
    }
}

/// An operator in front of an operand, with a space where `- -x` must not become `--x`.
fn prefixed<'a>(symbol: &'static str, operand: &'a Expr) -> Vec<Piece<'a>> {
    let apart = matches!(operand.kind, ExprKind::Unary(..) | ExprKind::Step { prefix: true, .. });
    let space = if apart { " " } else { "" };
    vec![text(symbol), text(space), Piece::Expr(operand, level::UNARY)]
}

fn listed<'a>(open: &str, list: &'a [Expr], close: &'static str) -> Vec<Piece<'a>> {
    let mut pieces = vec![text(open.to_string())];
    for (i, expr) in list.iter().enumerate() {
        if i > 0 {
            pieces.push(text(", "));
        }
        pieces.push(Piece::Expr(expr, level::ASSIGN));
    }
    pieces.push(text(close));
    pieces
}

/// A string literal.
fn quoted(value: &str) -> String {
    let mut out = String::from("\"");
    for c in value.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            '\r' => out.push_str("\\r"),
            c if c.is_ascii_control() => out.push_str(&format!("\\{:03o}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
