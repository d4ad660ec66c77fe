//! The parts of an expression, for whoever looks through all of a shader.

use super::typed::{Access, Argument, Expr, ExprKind, Place};

impl Expr {
    /// Gives the expressions directly inside, in the order in which they are worked out; of a place that is written its indices.
    ///
    /// What calls itself by this goes as deep as the expression does, so the stack grows here.
    pub fn parts<'e>(&'e self, take: &mut dyn FnMut(&'e Expr)) {
        stacker::maybe_grow(64 << 10, 1 << 20, || self.each_part(take));
    }

    fn each_part<'e>(&'e self, take: &mut dyn FnMut(&'e Expr)) {
        match &self.kind {
            ExprKind::Int(_) | ExprKind::Float(_) | ExprKind::String(_) | ExprKind::Var(_) => {}
            ExprKind::Step { place, .. } => place.indices(take),
            ExprKind::Convert(a) | ExprKind::Unary(_, a) | ExprKind::Field(a, _) => take(a),
            ExprKind::Assign(place, a) | ExprKind::Update(_, place, a) => {
                place.indices(take);
                take(a);
            }
            ExprKind::Binary(_, a, b) | ExprKind::Index(a, b) | ExprKind::SpaceToSpace(a, b) => {
                [a, b].into_iter().for_each(|e| take(e));
            }
            ExprKind::Ternary(a, b, c) | ExprKind::MatrixElement(a, b, c) => {
                [a, b, c].into_iter().for_each(|e| take(e));
            }
            ExprKind::Comma(list) | ExprKind::Construct(list) | ExprKind::Aggregate(list) => list.iter().for_each(take),
            ExprKind::ConstructIn(space, list) => std::iter::once(&**space).chain(list).for_each(take),
            ExprKind::Call(_, arguments) | ExprKind::Builtin(_, arguments) => {
                for argument in arguments {
                    match argument {
                        Argument::In(expr) => take(expr),
                        Argument::Out(place) => place.indices(take),
                    }
                }
            }
            ExprKind::Closure(_, params, keywords) => {
                params.iter().chain(keywords.iter().map(|(_, value)| value)).for_each(take);
            }
        }
    }
}

impl Place {
    /// Gives the indices on the way to the place.
    pub fn indices<'e>(&'e self, take: &mut dyn FnMut(&'e Expr)) {
        for access in &self.path {
            match access {
                Access::Field(_) => {}
                Access::Element(a) | Access::Component(a) => take(a),
                Access::Matrix(a, b) => {
                    take(a);
                    take(b);
                }
            }
        }
    }
}
