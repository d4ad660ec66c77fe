//! The one meaning of every arithmetic operation: the builder folds constants with it, and the machine's loops run it.

use super::op::*;
use crate::math::elementary as e;
use crate::ops::arithmetic as o;

/// A float operation.
#[inline(always)]
pub fn unary(op: Unary, a: f32) -> f32 {
    match op {
        Unary::Neg => -a,
        Unary::Abs => a.abs(),
        Unary::Sqrt => o::sqrt(a),
        Unary::InverseSqrt => o::inversesqrt(a),
        Unary::Cbrt => e::cbrt(a),
        Unary::Exp => e::exp(a),
        Unary::Exp2 => e::exp2(a),
        Unary::Expm1 => e::expm1(a),
        Unary::Log => o::log(a),
        Unary::Log2 => o::log2(a),
        Unary::Log10 => o::log10(a),
        Unary::Logb => o::logb(a),
        Unary::Sin => e::sin(a),
        Unary::Cos => e::cos(a),
        Unary::Tan => e::tan(a),
        Unary::Asin => o::asin(a),
        Unary::Acos => o::acos(a),
        Unary::Atan => e::atan(a),
        Unary::Sinh => e::sinh(a),
        Unary::Cosh => e::cosh(a),
        Unary::Tanh => e::tanh(a),
        Unary::Erf => e::erf(a),
        Unary::Erfc => e::erfc(a),
        Unary::Floor => e::floor(a),
        Unary::Ceil => e::ceil(a),
        Unary::Round => e::round(a),
        Unary::Trunc => e::trunc(a),
        Unary::Sign => o::sign(a),
    }
}

/// An operation of two floats. A division by zero gives zero, as the language has it.
#[inline(always)]
pub fn binary(op: Binary, a: f32, b: f32) -> f32 {
    match op {
        Binary::Add => a + b,
        Binary::Sub => a - b,
        Binary::Mul => a * b,
        Binary::Div => o::div(a, b),
        Binary::Mod => o::fmod(a, b),
        Binary::Pow => o::pow(a, b),
        Binary::Atan2 => e::atan2(a, b),
        Binary::Min => o::min(a, b),
        Binary::Max => o::max(a, b),
        Binary::Step => o::step(a, b),
    }
}

/// Two operations of two floats, the second of the first one's result.
#[inline(always)]
pub fn pair(op: Pair, a: f32, b: f32, c: f32) -> f32 {
    let t = binary(op.first, a, b);
    if op.swapped { binary(op.second, c, t) } else { binary(op.second, t, c) }
}

/// A comparison, 1 for true.
#[inline(always)]
pub fn compare(op: Compare, a: f32, b: f32) -> i32 {
    (match op {
        Compare::Lt => a < b,
        Compare::Le => a <= b,
        Compare::Gt => a > b,
        Compare::Ge => a >= b,
        Compare::Eq => a == b,
        Compare::Ne => a != b,
    }) as i32
}

/// A test, 1 for true.
#[inline(always)]
pub fn test(test: Test, a: f32) -> i32 {
    (match test {
        Test::Nan => a.is_nan(),
        Test::Inf => a.is_infinite(),
        Test::Finite => a.is_finite(),
    }) as i32
}

/// An int operation.
#[inline(always)]
pub fn int_unary(op: IntUnary, a: i32) -> i32 {
    match op {
        IntUnary::Neg => a.wrapping_neg(),
        IntUnary::Abs => a.wrapping_abs(),
        IntUnary::BitNot => !a,
        IntUnary::Not => (a == 0) as i32,
    }
}

/// An operation of two ints. Overflow wraps; a division by zero gives zero; shifts use the low five bits.
#[inline(always)]
pub fn int_binary(op: IntBinary, a: i32, b: i32) -> i32 {
    use IntBinary::*;
    match op {
        Add => a.wrapping_add(b),
        Sub => a.wrapping_sub(b),
        Mul => a.wrapping_mul(b),
        Div => o::int_div(a, b),
        Mod => o::int_mod(a, b),
        Shl => o::shl(a, b),
        Shr => o::shr(a, b),
        BitAnd => a & b,
        BitOr => a | b,
        BitXor => a ^ b,
        Min => a.min(b),
        Max => a.max(b),
        Lt => (a < b) as i32,
        Le => (a <= b) as i32,
        Gt => (a > b) as i32,
        Ge => (a >= b) as i32,
        Eq => (a == b) as i32,
        Ne => (a != b) as i32,
        And => (a != 0 && b != 0) as i32,
        Or => (a != 0 || b != 0) as i32,
    }
}

/// A float cut to an int; out of range it saturates, not-a-number gives 0.
#[inline(always)]
pub fn float_to_int(a: f32) -> i32 {
    o::to_int(a)
}
