//! The loops over lanes: one function a kind of instruction, compiled for several instruction sets.
//!
//! Each runs the scalar meaning of [`crate::ir::fold`] over columns. A column of one element stands for all lanes. The
//! set is chosen at run time, so a plain release build uses the machine's SIMD; results are the same bits on every set,
//! because nothing is contracted or reassociated.

use crate::ir::fold;
use crate::ir::op::*;
use multiversion::multiversion;

/// Runs `f` over a column.
#[inline(always)]
fn map1<T: Copy, U: Copy>(dst: &mut [U], a: &[T], f: impl Fn(T) -> U) {
    if a.len() == 1 {
        let value = f(a[0]);
        dst.fill(value);
        return;
    }
    for (d, &a) in dst.iter_mut().zip(a) {
        *d = f(a);
    }
}

/// Runs `f` over two columns.
#[inline(always)]
fn map2<T: Copy, U: Copy>(dst: &mut [U], a: &[T], b: &[T], f: impl Fn(T, T) -> U) {
    match (a.len() == 1, b.len() == 1) {
        (true, true) => dst.fill(f(a[0], b[0])),
        (true, false) => {
            let a = a[0];
            for (d, &b) in dst.iter_mut().zip(b) {
                *d = f(a, b);
            }
        }
        (false, true) => {
            let b = b[0];
            for (d, &a) in dst.iter_mut().zip(a) {
                *d = f(a, b);
            }
        }
        (false, false) => {
            for ((d, &a), &b) in dst.iter_mut().zip(a).zip(b) {
                *d = f(a, b);
            }
        }
    }
}

/// Expands to a match with one lane loop a variant, so that each loop is compiled for its own operation.
macro_rules! per_variant {
    ($op:expr, $enum:ident [$($variant:ident)*], |$known:ident| $body:expr) => {
        match $op { $($enum::$variant => { const $known: $enum = $enum::$variant; $body })* }
    };
}

/// `dst = op a`
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn unary(op: Unary, dst: &mut [f32], a: &[f32]) {
    per_variant!(op, Unary [Neg Abs Sqrt InverseSqrt Cbrt Exp Exp2 Expm1 Log Log2 Log10 Logb Sin Cos Tan Asin Acos Atan
        Sinh Cosh Tanh Erf Erfc Floor Ceil Round Trunc Sign], |OP| map1(dst, a, |a| fold::unary(OP, a)));
}

/// `dst = a op b`
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn binary(op: Binary, dst: &mut [f32], a: &[f32], b: &[f32]) {
    per_variant!(op, Binary [Add Sub Mul Div Mod Pow Atan2 Min Max Step], |OP| map2(dst, a, b, |a, b| fold::binary(OP, a, b)));
}

/// `dst = a op b`, an int
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn compare(op: Compare, dst: &mut [i32], a: &[f32], b: &[f32]) {
    per_variant!(op, Compare [Lt Le Gt Ge Eq Ne], |OP| map2(dst, a, b, |a, b| fold::compare(OP, a, b)));
}

/// `dst = is a …`
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn test(test: Test, dst: &mut [i32], a: &[f32]) {
    per_variant!(test, Test [Nan Inf Finite], |OP| map1(dst, a, |a| fold::test(OP, a)));
}

/// `dst = op a`, ints
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn int_unary(op: IntUnary, dst: &mut [i32], a: &[i32]) {
    per_variant!(op, IntUnary [Neg Abs BitNot Not], |OP| map1(dst, a, |a| fold::int_unary(OP, a)));
}

/// `dst = a op b`, ints
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn int_binary(op: IntBinary, dst: &mut [i32], a: &[i32], b: &[i32]) {
    per_variant!(op, IntBinary [Add Sub Mul Div Mod Shl Shr BitAnd BitOr BitXor Min Max Lt Le Gt Ge Eq Ne And Or],
        |OP| map2(dst, a, b, |a, b| fold::int_binary(OP, a, b)));
}

/// `dst = (float) a`
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn int_to_float(dst: &mut [f32], a: &[i32]) {
    map1(dst, a, |a| a as f32);
}

/// `dst = (int) a`
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn float_to_int(dst: &mut [i32], a: &[f32]) {
    map1(dst, a, fold::float_to_int);
}

/// `dst = c != 0 ? a : b`
#[inline(always)]
fn choose<T: Copy>(dst: &mut [T], c: &[i32], a: &[T], b: &[T]) {
    let n = dst.len();
    if c.len() == 1 {
        let from = if c[0] != 0 { a } else { b };
        return if from.len() == 1 { dst.fill(from[0]) } else { dst.copy_from_slice(&from[..n]) };
    }
    // A loop for each shape: one that asks for shapes lane by lane does not become SIMD.
    let lanes = dst.iter_mut().zip(&c[..n]);
    match (a.len() == 1, b.len() == 1) {
        (true, true) => {
            let (a, b) = (a[0], b[0]);
            lanes.for_each(|(d, &c)| *d = if c != 0 { a } else { b });
        }
        (true, false) => {
            let a = a[0];
            lanes.zip(&b[..n]).for_each(|((d, &c), &b)| *d = if c != 0 { a } else { b });
        }
        (false, true) => {
            let b = b[0];
            lanes.zip(&a[..n]).for_each(|((d, &c), &a)| *d = if c != 0 { a } else { b });
        }
        (false, false) => {
            let (a, b, c) = (&a[..n], &b[..n], &c[..n]);
            for i in 0..n {
                dst[i] = if c[i] != 0 { a[i] } else { b[i] };
            }
        }
    }
}

/// `dst = c != 0 ? a : b`, floats
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn select(dst: &mut [f32], c: &[i32], a: &[f32], b: &[f32]) {
    choose(dst, c, a, b);
}

/// `dst = c != 0 ? a : b`, ints
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn select_int(dst: &mut [i32], c: &[i32], a: &[i32], b: &[i32]) {
    choose(dst, c, a, b);
}

/// `dst = a` where the mask is set
#[inline(always)]
fn blend<T: Copy>(dst: &mut [T], mask: &[i32], a: &[T]) {
    let single = a.len() == 1;
    for (i, (d, &m)) in dst.iter_mut().zip(mask).enumerate() {
        let new = if single { a[0] } else { a[i] };
        *d = if m != 0 { new } else { *d };
    }
}

/// `dst = a` where the mask is set, floats
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn masked_move(dst: &mut [f32], mask: &[i32], a: &[f32]) {
    blend(dst, mask, a);
}

/// `dst = a` where the mask is set, ints
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn masked_move_int(dst: &mut [i32], mask: &[i32], a: &[i32]) {
    blend(dst, mask, a);
}

/// `out = mask and (c != 0) == wanted`; gives the number of lanes set.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt"))]
pub fn narrow(out: &mut [i32], mask: &[i32], c: &[i32], wanted: bool) -> usize {
    let mut count = 0;
    for ((o, &m), &c) in out.iter_mut().zip(mask).zip(c) {
        *o = (m != 0 && (c != 0) == wanted) as i32;
        count += *o;
    }
    count as usize
}
