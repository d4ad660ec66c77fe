//! The loops over lanes: one function a kind of instruction, compiled for several instruction sets.
//!
//! Each runs the scalar meaning of [`crate::ir::fold`] over columns. A column of one element stands for all lanes. The
//! set is chosen at run time, so a plain release build uses the machine's SIMD; results are the same bits on every set,
//! because nothing is contracted or reassociated.

use crate::ir::fold;
use crate::ir::op::*;
use crate::lanes;

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

/// Runs `f` over three columns, of which the first two are not both one number.
#[inline(always)]
fn map3(dst: &mut [f32], a: &[f32], b: &[f32], c: &[f32], f: impl Fn(f32, f32, f32) -> f32) {
    let n = dst.len();
    if c.len() == 1 {
        let c = c[0];
        return map2(dst, a, b, |a, b| f(a, b, c));
    }
    let c = &c[..n];
    if a.len() == 1 {
        let (a, b) = (a[0], &b[..n]);
        for i in 0..n {
            dst[i] = f(a, b[i], c[i]);
        }
    } else if b.len() == 1 {
        let (a, b) = (&a[..n], b[0]);
        for i in 0..n {
            dst[i] = f(a[i], b, c[i]);
        }
    } else {
        let (a, b) = (&a[..n], &b[..n]);
        for i in 0..n {
            dst[i] = f(a[i], b[i], c[i]);
        }
    }
}

/// Expands to a match with one lane loop a variant, so that each loop is compiled for its own operation.
macro_rules! per_variant {
    ($op:expr, $enum:ident [$($variant:ident)*], |$known:ident| $body:expr) => {
        match $op { $($enum::$variant => { const $known: $enum = $enum::$variant; $body })* }
    };
}

/// Expands to a match with one lane loop a pair of operations, and what is done with any other pair.
macro_rules! per_pair {
    ($op:expr, [$($first:ident)*] $seconds:tt, |$known:ident| $body:expr, $other:expr) => {
        match $op.first {
            $(Binary::$first => per_pair!($op, $first $seconds, |$known| $body, $other),)*
            _ => $other,
        }
    };
    ($op:expr, $first:ident [$($second:ident $swapped:literal)*], |$known:ident| $body:expr, $other:expr) => {
        match ($op.second, $op.swapped) {
            $((Binary::$second, $swapped) => {
                const $known: Pair = Pair { first: Binary::$first, second: Binary::$second, swapped: $swapped };
                $body
            })*
            _ => $other,
        }
    };
}

lanes! {
    /// `dst = op a`
    pub fn unary(op: Unary, dst: &mut [f32], a: &[f32]) {
        per_variant!(op, Unary [Neg Abs Sqrt InverseSqrt Cbrt Exp Exp2 Expm1 Log Log2 Log10 Logb Sin Cos Tan Asin Acos Atan
            Sinh Cosh Tanh Erf Erfc Floor Ceil Round Trunc Sign], |OP| map1(dst, a, |a| fold::unary(OP, a)));
    }
}

lanes! {
    /// `dst = a op b`
    pub fn binary(op: Binary, dst: &mut [f32], a: &[f32], b: &[f32]) {
        per_variant!(op, Binary [Add Sub Mul Div Mod Pow Atan2 Min Max Step], |OP| map2(dst, a, b, |a, b| fold::binary(OP, a, b)));
    }
}

lanes! {
    /// `dst = (a first b) second c`
    pub fn fused(op: Pair, dst: &mut [f32], a: &[f32], b: &[f32], c: &[f32]) {
        if a.len() == 1 && b.len() == 1 {
            return apart(op, &mut [0.0], dst, [a, b, c]);
        }
        per_pair!(op, [Add Sub Mul Div]
            [Add false Sub false Sub true Mul false Div false Div true Min false Min true Max false Max true],
            |OP| map3(dst, a, b, c, |a, b, c| fold::pair(OP, a, b, c)), apart(op, &mut vec![0.0; dst.len()], dst, [a, b, c]));
    }
}

/// The same as two instructions with `t` in between. Programs have no other pairs than those of [`Pair::has_loop`].
fn apart(op: Pair, t: &mut [f32], dst: &mut [f32], [a, b, c]: [&[f32]; 3]) {
    binary(op.first, t, a, b);
    if op.swapped { binary(op.second, dst, c, t) } else { binary(op.second, dst, t, c) }
}

lanes! {
    /// `dst = a op b`, an int
    pub fn compare(op: Compare, dst: &mut [i32], a: &[f32], b: &[f32]) {
        per_variant!(op, Compare [Lt Le Gt Ge Eq Ne], |OP| map2(dst, a, b, |a, b| fold::compare(OP, a, b)));
    }
}

lanes! {
    /// `dst = is a …`
    pub fn test(test: Test, dst: &mut [i32], a: &[f32]) {
        per_variant!(test, Test [Nan Inf Finite], |OP| map1(dst, a, |a| fold::test(OP, a)));
    }
}

lanes! {
    /// `dst = op a`, ints
    pub fn int_unary(op: IntUnary, dst: &mut [i32], a: &[i32]) {
        per_variant!(op, IntUnary [Neg Abs BitNot Not], |OP| map1(dst, a, |a| fold::int_unary(OP, a)));
    }
}

lanes! {
    /// `dst = a op b`, ints
    pub fn int_binary(op: IntBinary, dst: &mut [i32], a: &[i32], b: &[i32]) {
        per_variant!(op, IntBinary [Add Sub Mul Div Mod Shl Shr BitAnd BitOr BitXor Min Max Lt Le Gt Ge Eq Ne And Or],
            |OP| map2(dst, a, b, |a, b| fold::int_binary(OP, a, b)));
    }
}

lanes! {
    /// `dst = (float) a`
    pub fn int_to_float(dst: &mut [f32], a: &[i32]) {
        map1(dst, a, |a| a as f32);
    }
}

lanes! {
    /// `dst = (int) a`
    pub fn float_to_int(dst: &mut [i32], a: &[f32]) {
        map1(dst, a, fold::float_to_int);
    }
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

lanes! {
    /// `dst = c != 0 ? a : b`, floats
    pub fn select(dst: &mut [f32], c: &[i32], a: &[f32], b: &[f32]) {
        choose(dst, c, a, b);
    }
}

lanes! {
    /// `dst = c != 0 ? a : b`, ints
    pub fn select_int(dst: &mut [i32], c: &[i32], a: &[i32], b: &[i32]) {
        choose(dst, c, a, b);
    }
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

lanes! {
    /// `dst = a` where the mask is set, floats
    pub fn masked_move(dst: &mut [f32], mask: &[i32], a: &[f32]) {
        blend(dst, mask, a);
    }
}

lanes! {
    /// `dst = a` where the mask is set, ints
    pub fn masked_move_int(dst: &mut [i32], mask: &[i32], a: &[i32]) {
        blend(dst, mask, a);
    }
}

lanes! {
    /// `out = mask and (c != 0) == wanted`; gives the number of lanes set.
    pub fn narrow(out: &mut [i32], mask: &[i32], c: &[i32], wanted: bool) -> usize {
        let mut count = 0;
        for ((o, &m), &c) in out.iter_mut().zip(mask).zip(c) {
            *o = (m != 0 && (c != 0) == wanted) as i32;
            count += *o;
        }
        count as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_gives_the_bits_of_its_operations_one_after_the_other() {
        use Binary::*;
        let ends = [0.0, -0.0, 1.0, -3.5, 1e-40, f32::MAX, f32::INFINITY, -f32::INFINITY, f32::NAN, 0.1, 7.0];
        let (n, all) = (ends.len().pow(3), |stride: usize| move |i: usize| ends[i / stride % ends.len()]);
        let columns = [1, ends.len(), ends.len().pow(2)].map(|stride| (0..n).map(all(stride)).collect::<Vec<f32>>());
        for (first, second) in
            [Add, Sub, Mul, Div, Pow].into_iter().flat_map(|f| [Add, Sub, Mul, Div, Min, Max].map(|s| (f, s)))
        {
            // Which columns are one number for all lanes.
            for (swapped, shape) in [false, true].into_iter().flat_map(|s| (0..8).map(move |shape| (s, shape))) {
                let op = Pair { first, second, swapped };
                let [a, b, c] =
                    [0, 1, 2].map(|i| if shape >> i & 1 == 1 { &columns[i][5 * n / 7..][..1] } else { &columns[i] });
                let (mut together, mut t, mut one_by_one) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
                fused(op, &mut together, a, b, c);
                apart(op, &mut t, &mut one_by_one, [a, b, c]);
                // Which not-a-number an operation gives is not defined.
                let same = |x: f32, y: f32| x.to_bits() == y.to_bits() || x.is_nan() && y.is_nan();
                assert!(together.iter().zip(&one_by_one).all(|(&x, &y)| same(x, y)), "{op:?}, shape {shape}");
            }
        }
    }
}
