//! The typed shader: what the checker gives to the compiler. Every name is resolved and every conversion is written out.

use crate::lang::closures::ClosureId;
use crate::lang::globals::Global;
use crate::lang::types::Type;
use std::sync::Arc;
use velour_grammar::Span;
use velour_grammar::ast::{BinaryOp, ShaderKind, UnaryOp};
use velour_grammar::names::Name;

/// Index into [`Shader::variables`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct VarId(pub u32);

/// Index into [`Shader::functions`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FunctionId(pub u32);

/// A checked shader.
#[derive(Clone, Debug)]
pub struct Shader {
    /// Its kind.
    pub kind: ShaderKind,
    /// Its name.
    pub name: String,
    /// Where its head stands.
    pub span: Span,
    /// Its metadata.
    pub metadata: Vec<Metadata>,
    /// Its parameters, in order.
    pub params: Vec<ShaderParam>,
    /// Every variable of the shader and of the functions it calls.
    pub variables: Vec<Variable>,
    /// Every function it may call.
    pub functions: Vec<Arc<Function>>,
    /// Its statements.
    pub body: Vec<Stmt>,
}

impl Shader {
    /// Its parameters with the variables that hold them, in order.
    pub fn declared(&self) -> impl Iterator<Item = (&ShaderParam, &Variable)> {
        self.params.iter().map(|param| (param, &self.variables[param.var.0 as usize]))
    }

    /// The parameter of a name.
    pub fn param(&self, name: &str) -> Option<(&ShaderParam, &Variable)> {
        self.declared().find(|(_, variable)| variable.name == name)
    }
}

/// A shader parameter.
#[derive(Clone, Debug)]
pub struct ShaderParam {
    /// The variable that holds it.
    pub var: VarId,
    /// True when marked `output`.
    pub output: bool,
    /// True when declared with `[]`, so that whoever gives the value sets the length.
    pub open: bool,
    /// The default, of the parameter's type.
    pub default: Option<Expr>,
    /// Its metadata.
    pub metadata: Vec<Metadata>,
}

/// One checked metadata entry.
#[derive(Clone, Debug)]
pub struct Metadata {
    /// The type written.
    pub ty: Type,
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: Expr,
}

/// A variable.
#[derive(Clone, Debug)]
pub struct Variable {
    /// The name it was declared with.
    pub name: Name,
    /// Its type.
    pub ty: Type,
    /// Where it was declared.
    pub span: Span,
    /// The shader global it stands for.
    pub global: Option<Global>,
}

/// A checked function. Calls are expanded in place, so a function never calls itself.
#[derive(Clone, Debug)]
pub struct Function {
    /// Its name.
    pub name: String,
    /// What it returns.
    pub returns: Type,
    /// Its parameters and whether they are written.
    pub params: Vec<(VarId, bool)>,
    /// Its statements.
    pub body: Vec<Stmt>,
}

/// A checked statement.
#[derive(Clone, Debug)]
pub enum Stmt {
    /// An expression for its effect.
    Expr(Expr),
    /// A variable comes to life, with a value or without.
    Declare(VarId, Option<Expr>),
    /// Statements in a scope of their own.
    Block(Vec<Stmt>),
    /// A choice; the condition is an int.
    If(Box<Expr>, Vec<Stmt>, Vec<Stmt>),
    /// A loop.
    Loop {
        /// Runs once before the loop.
        init: Vec<Stmt>,
        /// Tested before each round (after it when `test_last`); an int. Missing means true.
        condition: Option<Box<Expr>>,
        /// Runs after each round.
        step: Option<Box<Expr>>,
        /// The body.
        body: Vec<Stmt>,
        /// True for `do … while`.
        test_last: bool,
        /// Where the loop stands.
        span: Span,
    },
    /// Leaves the innermost loop.
    Break,
    /// Goes on with the next round of the innermost loop.
    Continue,
    /// Leaves the function, or the shader.
    Return(Option<Expr>),
}

/// A checked expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// The type of its value.
    pub ty: Type,
    /// Where it was written.
    pub span: Span,
}

/// The checked expressions. What is rare and large is boxed: a shader of ten thousand lines is made of a hundred thousand of these.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// An integer.
    Int(i32),
    /// A float.
    Float(f32),
    /// A string.
    String(String),
    /// The value of a variable.
    Var(VarId),
    /// The operand as another type: number to number, number to triple or matrix, triple to triple, 0 to closure.
    Convert(Box<Expr>),
    /// An operator with one operand. `Not` takes any base type and gives an int.
    Unary(UnaryOp, Box<Expr>),
    /// An operator with two operands of fitting types; a mixed float operand is spread by the compiler.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `c ? a : b`, condition an int, both sides of the expression's type.
    Ternary(Box<Expr>, Box<Expr>, Box<Expr>),
    /// Values in order; the last one is the value.
    Comma(Vec<Expr>),
    /// Assignment; the value is the new one.
    Assign(Box<Place>, Box<Expr>),
    /// Read, change and write back: `a op= b`.
    Update(BinaryOp, Box<Place>, Box<Expr>),
    /// `++` and `--`: the amount (1 or -1), and whether the value is the new one.
    Step {
        /// What is changed.
        place: Box<Place>,
        /// True for `++`.
        increment: bool,
        /// True when the value is the new one.
        prefix: bool,
    },
    /// A call of a user function.
    Call(FunctionId, Vec<Argument>),
    /// A call of a builtin.
    Builtin(&'static str, Vec<Argument>),
    /// A closure with its positional and keyword parameters.
    Closure(ClosureId, Box<[Expr]>, Box<[(u32, Expr)]>),
    /// A triple or a matrix made of floats.
    Construct(Vec<Expr>),
    /// A triple or matrix made of floats that are given in a named space.
    ConstructIn(Box<Expr>, Vec<Expr>),
    /// The matrix from one named space to another.
    SpaceToSpace(Box<Expr>, Box<Expr>),
    /// A struct or an array made of its parts, in order.
    Aggregate(Vec<Expr>),
    /// An element of an array, a component of a triple or a row of a matrix (`Index` of an `Index`).
    Index(Box<Expr>, Box<Expr>),
    /// `m[row][column]`
    MatrixElement(Box<Expr>, Box<Expr>, Box<Expr>),
    /// A field of a struct, by position.
    Field(Box<Expr>, u32),
}

/// Something that can be assigned: a variable and the way into it.
#[derive(Clone, Debug)]
pub struct Place {
    /// The variable.
    pub var: VarId,
    /// The way from the variable to the part.
    pub path: Vec<Access>,
    /// The type of the part.
    pub ty: Type,
}

/// One step into a variable.
#[derive(Clone, Debug)]
pub enum Access {
    /// A field of a struct.
    Field(u32),
    /// An element of an array.
    Element(Expr),
    /// A component of a triple.
    Component(Expr),
    /// An element of a matrix.
    Matrix(Expr, Expr),
}

/// An argument of a call.
#[derive(Clone, Debug)]
pub enum Argument {
    /// Read only.
    In(Expr),
    /// Read and written.
    Out(Place),
}

impl Place {
    /// The value at this place; `root` is the type of its variable.
    pub fn reading(&self, root: &Type, span: Span) -> Expr {
        let mut value = Expr::new(ExprKind::Var(self.var), root.clone(), span);
        for access in &self.path {
            let ty = match access {
                Access::Field(at) => value.ty.structure().map_or(Type::VOID, |s| s.fields[*at as usize].1.clone()),
                Access::Element(_) => value.ty.element_type(),
                Access::Component(_) | Access::Matrix(..) => Type::FLOAT,
            };
            let (whole, boxed) = (Box::new(value), |index: &Expr| Box::new(index.clone()));
            let kind = match access {
                Access::Field(at) => ExprKind::Field(whole, *at),
                Access::Element(at) | Access::Component(at) => ExprKind::Index(whole, boxed(at)),
                Access::Matrix(row, column) => ExprKind::MatrixElement(whole, boxed(row), boxed(column)),
            };
            value = Expr::new(kind, ty, span);
        }
        value
    }
}

impl Argument {
    /// The expression of an argument that is only read.
    pub fn read(&self) -> Option<&Expr> {
        match self {
            Argument::In(expr) => Some(expr),
            Argument::Out(_) => None,
        }
    }

    /// The type of the argument.
    pub fn ty(&self) -> &Type {
        match self {
            Argument::In(expr) => &expr.ty,
            Argument::Out(place) => &place.ty,
        }
    }
}

impl Expr {
    /// An expression.
    pub fn new(kind: ExprKind, ty: Type, span: Span) -> Self {
        Expr { kind, ty, span }
    }

    /// A stand-in after a mistake has been reported; its type is `void`, which no further message complains about.
    pub fn error(span: Span) -> Self {
        Expr::new(ExprKind::Int(0), Type::VOID, span)
    }

    /// True for the stand-in after a mistake.
    pub fn is_error(&self) -> bool {
        self.ty == Type::VOID && matches!(self.kind, ExprKind::Int(0))
    }
}
