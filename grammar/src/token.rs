//! The terminals of the grammar: what the lexer hands to the parser once the preprocessor is done.

use crate::ast::ShaderKind;

/// A terminal with its value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Token<'s> {
    /// A name that is no keyword.
    Ident(&'s str),
    /// An integer literal, decimal or hexadecimal.
    Int(i32),
    /// A float literal.
    Float(f32),
    /// A string literal; neighbours are joined and escapes resolved.
    Str(String),
    /// `shader`, `surface`, `displacement` or `volume` in front of a name.
    Kind(ShaderKind),
    /// A keyword, an operator or a bracket.
    Sym(Sym),
    /// Text for which a message has been reported already.
    Error,
}

/// Declares the fixed terminals: variant and spelling.
macro_rules! symbols {
    ($($name:ident $text:literal),* $(,)?) => {
        /// A terminal without a value.
        #[allow(missing_docs)] // the spelling beside each name says it all
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Sym { $($name),* }

        impl Sym {
            /// The text of the terminal.
            pub(crate) fn text(self) -> &'static str {
                match self { $(Sym::$name => $text),* }
            }
        }
    };
}

symbols! {
    Break "break", Closure "closure", Color "color", Continue "continue", Do "do", Else "else",
    FloatType "float", For "for", If "if", IntType "int", Matrix "matrix", Normal "normal",
    Output "output", Point "point", Return "return", StringType "string", Struct "struct",
    Vector "vector", Void "void", While "while",
    ParenOpen "(", ParenClose ")", BracketOpen "[", BracketClose "]", MetaOpen "[[",
    BraceOpen "{", BraceClose "}", ItemClose "}", ItemEnd ";", Semicolon ";", Comma ",", Dot ".",
    Question "?", Colon ":", Plus "+", Minus "-", Star "*", Slash "/", Percent "%",
    Shl "<<", Shr ">>", Less "<", LessEqual "<=", Greater ">", GreaterEqual ">=",
    EqualEqual "==", NotEqual "!=", And "&", Caret "^", Pipe "|", AndAnd "&&", OrOr "||",
    Not "!", Tilde "~", Increment "++", Decrement "--", Assign "=", AddAssign "+=",
    SubAssign "-=", MulAssign "*=", DivAssign "/=", AndAssign "&=", OrAssign "|=",
    XorAssign "^=", ShlAssign "<<=", ShrAssign ">>=",
}

impl Sym {
    /// The keyword that a word spells, if any. `and`, `or` and `not` are other spellings of operators.
    pub(crate) fn keyword(word: &str) -> Option<Sym> {
        Some(match word {
            "break" => Sym::Break,
            "closure" => Sym::Closure,
            "color" => Sym::Color,
            "continue" => Sym::Continue,
            "do" => Sym::Do,
            "else" => Sym::Else,
            "float" => Sym::FloatType,
            "for" => Sym::For,
            "if" => Sym::If,
            "int" => Sym::IntType,
            "matrix" => Sym::Matrix,
            "normal" => Sym::Normal,
            "output" => Sym::Output,
            "point" => Sym::Point,
            "return" => Sym::Return,
            "string" => Sym::StringType,
            "struct" => Sym::Struct,
            "vector" => Sym::Vector,
            "void" => Sym::Void,
            "while" => Sym::While,
            "and" => Sym::AndAnd,
            "or" => Sym::OrOr,
            "not" => Sym::Not,
            _ => return None,
        })
    }
}

/// The word that starts a shader of a kind.
pub(crate) fn shader_kind(word: &str) -> Option<ShaderKind> {
    Some(match word {
        "shader" => ShaderKind::Generic,
        "surface" => ShaderKind::Surface,
        "displacement" => ShaderKind::Displacement,
        "volume" => ShaderKind::Volume,
        _ => return None,
    })
}
