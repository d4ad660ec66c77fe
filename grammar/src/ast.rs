//! The syntax tree of one translation unit, as the grammar builds it and before any name or type is looked up.
//!
//! An [`Expr`] drops its children without recursion, however deep the tree; so its fields cannot be moved out by a
//! pattern: borrow them, or take them with `std::mem::take` and the like. See the crate's page for the depth to expect.
//!
//! Decision (2026-11-30): a name shares its text with all others of its spelling, and what is large and rare is boxed, because the tree of
//! ten thousand lines then takes 9 MB instead of 15 and a third less instructions to make and check; instead of a string a name, and of an arena,
//! whose indices every reader would have to look up.
//!
//! Nodes own their children. Every node that a message may point at carries a [`Span`]; parentheses leave no node.

use crate::names::Name;
use crate::span::Span;

/// One translation unit: the standard header, whatever it includes, and the user's file, in reading order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct File {
    /// The declarations in the order of the text.
    pub items: Vec<Item>,
}

/// A declaration at global scope.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// `struct Name { … };`
    Struct(StructDecl),
    /// A function, or its prototype when it has no body.
    Function(FunctionDecl),
    /// `surface name ( … ) { … }`
    Shader(ShaderDecl),
}

/// An identifier and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Ident {
    /// The text of the name.
    pub name: Name,
    /// Where it was written.
    pub span: Span,
}

/// A type as written, without array brackets.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeSpec {
    /// True for `closure color` (a `closure` before any other type is an error the parser reports).
    pub closure: bool,
    /// The type named.
    pub base: TypeName,
    /// Where it was written.
    pub span: Span,
}

/// The name of a type.
#[derive(Clone, Debug, PartialEq)]
pub enum TypeName {
    /// `int`
    Int,
    /// `float`
    Float,
    /// `color`
    Color,
    /// `point`
    Point,
    /// `vector`
    Vector,
    /// `normal`
    Normal,
    /// `matrix`
    Matrix,
    /// `string`
    String,
    /// `void`
    Void,
    /// `struct Name` or a bare struct name.
    Struct(Name),
}

/// The brackets after a declared name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrayLen {
    /// No brackets: a single value.
    Single,
    /// `[]`: the length comes from the argument or from the initialiser.
    Unsized,
    /// `[n]`.
    Sized(i32),
}

/// `struct Name { type field, …; };`
#[derive(Clone, Debug, PartialEq)]
pub struct StructDecl {
    /// The name of the type.
    pub name: Ident,
    /// The fields in order.
    pub fields: Vec<Field>,
    /// The whole declaration.
    pub span: Span,
}

/// A field of a struct.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its type.
    pub ty: TypeSpec,
    /// Its name.
    pub name: Ident,
    /// Its array brackets.
    pub array: ArrayLen,
}

/// A function or a prototype.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionDecl {
    /// The type of the value it returns.
    pub return_type: TypeSpec,
    /// Its name.
    pub name: Ident,
    /// The formal parameters.
    pub params: Vec<Param>,
    /// `[[ … ]]` after the formals.
    pub metadata: Vec<Metadata>,
    /// The statements, or `None` for a prototype.
    pub body: Option<Vec<Stmt>>,
    /// From the return type to the closing parenthesis.
    pub span: Span,
}

/// What kind of shader a declaration makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShaderKind {
    /// `shader`
    Generic,
    /// `surface`
    Surface,
    /// `displacement`
    Displacement,
    /// `volume`
    Volume,
}

/// A shader.
#[derive(Clone, Debug, PartialEq)]
pub struct ShaderDecl {
    /// `shader`, `surface`, `displacement` or `volume`.
    pub kind: ShaderKind,
    /// Its name.
    pub name: Ident,
    /// `[[ … ]]` before or after the formals.
    pub metadata: Vec<Metadata>,
    /// The parameters, in order.
    pub params: Vec<Param>,
    /// The statements.
    pub body: Vec<Stmt>,
    /// From the kind to the closing parenthesis.
    pub span: Span,
}

/// A formal parameter of a shader or a function.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// True when marked `output`.
    pub output: bool,
    /// Its type.
    pub ty: TypeSpec,
    /// Its name.
    pub name: Ident,
    /// Its array brackets.
    pub array: ArrayLen,
    /// The default value (required for a shader parameter; an [`ExprKind::InitList`] for `= { … }`).
    pub default: Option<Box<Expr>>,
    /// `[[ … ]]` after the parameter.
    pub metadata: Vec<Metadata>,
}

/// One `type name = value` inside `[[ … ]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Metadata {
    /// Its type.
    pub ty: TypeSpec,
    /// Its name.
    pub name: Ident,
    /// Its array brackets.
    pub array: ArrayLen,
    /// Its value.
    pub value: Expr,
}

/// A statement and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Stmt {
    /// What it is.
    pub kind: StmtKind,
    /// Where it was written.
    pub span: Span,
}

/// The statements.
#[derive(Clone, Debug, PartialEq)]
pub enum StmtKind {
    /// `;`
    Empty,
    /// An expression evaluated for its effect.
    Expr(Box<Expr>),
    /// `type a = x, b[3];`
    Declare(Vec<VarDecl>),
    /// A function declared inside a function or shader.
    Function(Box<FunctionDecl>),
    /// `{ … }`
    Block(Vec<Stmt>),
    /// `if (cond) then else other`
    If {
        /// The condition.
        condition: Box<Expr>,
        /// Taken when it is true.
        then: Box<Stmt>,
        /// Taken when it is false.
        otherwise: Option<Box<Stmt>>,
    },
    /// `while (cond) body`
    While {
        /// The condition.
        condition: Box<Expr>,
        /// The body.
        body: Box<Stmt>,
    },
    /// `do body while (cond);`
    DoWhile {
        /// The body.
        body: Box<Stmt>,
        /// The condition.
        condition: Box<Expr>,
    },
    /// `for (init; cond; step) body`
    For {
        /// A declaration or expression statement (or `Empty`).
        init: Box<Stmt>,
        /// The condition; missing means true.
        condition: Option<Box<Expr>>,
        /// Evaluated after each round.
        step: Option<Box<Expr>>,
        /// The body.
        body: Box<Stmt>,
    },
    /// `break;`
    Break,
    /// `continue;`
    Continue,
    /// `return;` or `return value;`
    Return(Option<Box<Expr>>),
    /// Text that did not parse; a diagnostic has been reported for it.
    Error,
}

/// One declared variable. A declaration statement repeats the type for each of its names.
#[derive(Clone, Debug, PartialEq)]
pub struct VarDecl {
    /// Its type.
    pub ty: TypeSpec,
    /// Its name.
    pub name: Ident,
    /// Its array brackets.
    pub array: ArrayLen,
    /// Its initialiser.
    pub init: Option<Box<Expr>>,
}

/// An expression and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it was written.
    pub span: Span,
}

/// The expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// An integer literal.
    Int(i32),
    /// A float literal.
    Float(f32),
    /// A string literal, with escapes resolved and neighbours joined.
    String(String),
    /// A variable.
    Name(Name),
    /// `-x`, `+x`, `!x`, `~x`
    Unary(UnaryOp, Box<Expr>),
    /// `a op b`
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `a = b`, or `a op= b` when an operator is given.
    Assign(Option<BinaryOp>, Box<Expr>, Box<Expr>),
    /// `++x`, `--x`, `x++`, `x--`
    Step {
        /// True for `++`.
        increment: bool,
        /// True when the operator stands before the operand (the value is the new one).
        prefix: bool,
        /// What is changed.
        target: Box<Expr>,
    },
    /// `c ? a : b`
    Ternary(Box<Expr>, Box<Expr>, Box<Expr>),
    /// `a, b, c`; the value is the last one. At least two elements.
    Comma(Vec<Expr>),
    /// `(type) x`
    Cast(Box<TypeSpec>, Box<Expr>),
    /// `color(…)`, `point(…)`, `matrix(…)`, `float(…)`, `int(…)`, `string(…)`: a type used as a function.
    Construct(Box<TypeSpec>, Vec<Expr>),
    /// `name(…)`: a function, a closure or a struct constructor.
    Call(Ident, Vec<Expr>),
    /// `a[i]`
    Index(Box<Expr>, Box<Expr>),
    /// `a.name`
    Field(Box<Expr>, Ident),
    /// `{ a, b, … }`
    InitList(Vec<Expr>),
    /// Text that did not parse; a diagnostic has been reported for it.
    Error,
}

/// Operators with one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnaryOp {
    /// `-`
    Neg,
    /// `+`
    Plus,
    /// `!` and `not`
    Not,
    /// `~`
    BitNot,
}

/// Operators with two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
    /// `+`
    Add,
    /// `-`
    Sub,
    /// `*`
    Mul,
    /// `/`
    Div,
    /// `%`
    Mod,
    /// `<<`
    Shl,
    /// `>>`
    Shr,
    /// `<`
    Lt,
    /// `<=`
    Le,
    /// `>`
    Gt,
    /// `>=`
    Ge,
    /// `==`
    Eq,
    /// `!=`
    Ne,
    /// `&`
    BitAnd,
    /// `^`
    BitXor,
    /// `|`
    BitOr,
    /// `&&` and `and`
    And,
    /// `||` and `or`
    Or,
}

impl UnaryOp {
    /// The operator as written.
    pub fn symbol(self) -> &'static str {
        match self {
            UnaryOp::Neg => "-",
            UnaryOp::Plus => "+",
            UnaryOp::Not => "!",
            UnaryOp::BitNot => "~",
        }
    }
}

impl BinaryOp {
    /// How tightly it binds, from 0: the levels of C. Operators of one level are joined from the left.
    pub fn tightness(self) -> u8 {
        use BinaryOp::*;
        match self {
            Or => 0,
            And => 1,
            BitOr => 2,
            BitXor => 3,
            BitAnd => 4,
            Eq | Ne => 5,
            Lt | Le | Gt | Ge => 6,
            Shl | Shr => 7,
            Add | Sub => 8,
            Mul | Div | Mod => 9,
        }
    }

    /// The operator as written.
    pub fn symbol(self) -> &'static str {
        use BinaryOp::*;
        match self {
            Add => "+",
            Sub => "-",
            Mul => "*",
            Div => "/",
            Mod => "%",
            Shl => "<<",
            Shr => ">>",
            Lt => "<",
            Le => "<=",
            Gt => ">",
            Ge => ">=",
            Eq => "==",
            Ne => "!=",
            BitAnd => "&",
            BitXor => "^",
            BitOr => "|",
            And => "&&",
            Or => "||",
        }
    }
}
