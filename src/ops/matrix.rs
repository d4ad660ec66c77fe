//! 4x4 matrices by rows, with points as rows on the left: p M, translation in the last row, as OSL and Imath have it.

/// A matrix, row after row.
pub type Matrix = [f32; 16];

/// The matrix that changes nothing.
pub const IDENTITY: Matrix = diagonal(1.0);

/// A matrix with `d` on the diagonal, as a float becomes a matrix in OSL.
pub const fn diagonal(d: f32) -> Matrix {
    [d, 0.0, 0.0, 0.0, 0.0, d, 0.0, 0.0, 0.0, 0.0, d, 0.0, 0.0, 0.0, 0.0, d]
}

/// The product a b: first `a`, then `b`, on a row vector.
#[inline(always)]
pub fn multiply(a: &Matrix, b: &Matrix) -> Matrix {
    let mut product = [0.0; 16];
    for row in 0..4 {
        for column in 0..4 {
            let mut sum = a[4 * row] * b[column];
            for k in 1..4 {
                sum += a[4 * row + k] * b[4 * k + column];
            }
            product[4 * row + column] = sum;
        }
    }
    product
}

/// Rows for columns.
#[inline(always)]
pub fn transpose(m: &Matrix) -> Matrix {
    let mut t = [0.0; 16];
    for row in 0..4 {
        for column in 0..4 {
            t[4 * column + row] = m[4 * row + column];
        }
    }
    t
}

/// The twelve 2x2 minors of the upper and of the lower two rows, from which determinant and inverse follow.
#[inline(always)]
fn minors(m: &Matrix) -> ([f64; 6], [f64; 6]) {
    let at = |row: usize, i: usize, j: usize| {
        let (a, b) = (4 * row, 4 * row + 4);
        m[a + i] as f64 * m[b + j] as f64 - m[a + j] as f64 * m[b + i] as f64
    };
    let of = |row| [at(row, 0, 1), at(row, 0, 2), at(row, 0, 3), at(row, 1, 2), at(row, 1, 3), at(row, 2, 3)];
    (of(0), of(2))
}

#[inline(always)]
fn laplace(s: &[f64; 6], c: &[f64; 6]) -> f64 {
    s[0] * c[5] - s[1] * c[4] + s[2] * c[3] + s[3] * c[2] - s[4] * c[1] + s[5] * c[0]
}

/// The determinant, by Laplace expansion over two rows in `f64`.
#[inline(always)]
pub fn determinant(m: &Matrix) -> f32 {
    let (s, c) = minors(m);
    laplace(&s, &c) as f32
}

/// The inverse, by the adjugate in `f64`; the identity when `m` is singular, as Imath has it.
#[inline(always)]
pub fn inverse(m: &Matrix) -> Matrix {
    let (s, c) = minors(m);
    let det = laplace(&s, &c);
    let singular = !(det.abs() > 0.0 && det.abs() < f64::INFINITY);
    let scale = 1.0 / det;
    let e = |i: usize| m[i] as f64;
    let adjugate = [
        e(5) * c[5] - e(6) * c[4] + e(7) * c[3],
        -e(1) * c[5] + e(2) * c[4] - e(3) * c[3],
        e(13) * s[5] - e(14) * s[4] + e(15) * s[3],
        -e(9) * s[5] + e(10) * s[4] - e(11) * s[3],
        -e(4) * c[5] + e(6) * c[2] - e(7) * c[1],
        e(0) * c[5] - e(2) * c[2] + e(3) * c[1],
        -e(12) * s[5] + e(14) * s[2] - e(15) * s[1],
        e(8) * s[5] - e(10) * s[2] + e(11) * s[1],
        e(4) * c[4] - e(5) * c[2] + e(7) * c[0],
        -e(0) * c[4] + e(1) * c[2] - e(3) * c[0],
        e(12) * s[4] - e(13) * s[2] + e(15) * s[0],
        -e(8) * s[4] + e(9) * s[2] - e(11) * s[0],
        -e(4) * c[3] + e(5) * c[1] - e(6) * c[0],
        e(0) * c[3] - e(1) * c[1] + e(2) * c[0],
        -e(12) * s[3] + e(13) * s[1] - e(14) * s[0],
        e(8) * s[3] - e(9) * s[1] + e(10) * s[0],
    ];
    if singular { IDENTITY } else { adjugate.map(|a| (a * scale) as f32) }
}

/// How [`determinant`] changes when `m` changes by `d`: it is linear in each row.
pub fn determinant_change(m: &Matrix, d: &Matrix) -> f32 {
    let with_row = |row: usize| {
        let mut changed = *m;
        changed[4 * row..4 * row + 4].copy_from_slice(&d[4 * row..4 * row + 4]);
        determinant(&changed)
    };
    with_row(0) + with_row(1) + with_row(2) + with_row(3)
}

/// How [`inverse`] changes, where it gave `inverse`, when `m` changes by `d`: `-m⁻¹ d m⁻¹`; nothing for a singular `m`.
pub fn inverse_change(m: &Matrix, inverse: &Matrix, d: &Matrix) -> Matrix {
    let det = determinant(m);
    if det == 0.0 || !det.is_finite() {
        return [0.0; 16];
    }
    multiply(&multiply(inverse, d), inverse).map(|x| -x)
}

/// A point, with the division by w; the origin when w is 0, as OSL has it.
#[inline(always)]
pub fn transform_point(m: &Matrix, p: [f32; 3]) -> [f32; 3] {
    let at = |c: usize| p[0] * m[c] + p[1] * m[4 + c] + p[2] * m[8 + c] + m[12 + c];
    let w = at(3);
    let divided = |c: usize| if w == 0.0 { 0.0 } else { at(c) / w };
    [divided(0), divided(1), divided(2)]
}

/// A vector: no translation and no division.
#[inline(always)]
pub fn transform_vector(m: &Matrix, v: [f32; 3]) -> [f32; 3] {
    let at = |c: usize| v[0] * m[c] + v[1] * m[4 + c] + v[2] * m[8 + c];
    [at(0), at(1), at(2)]
}

/// A normal, given the *inverse* of the matrix: it is multiplied by the transpose of that.
#[inline(always)]
pub fn transform_normal_by_inverse(inverse: &Matrix, n: [f32; 3]) -> [f32; 3] {
    let at = |c: usize| n[0] * inverse[4 * c] + n[1] * inverse[4 * c + 1] + n[2] * inverse[4 * c + 2];
    [at(0), at(1), at(2)]
}

/// A normal: multiplied by the transposed inverse, so that it stays perpendicular to the surface.
#[inline(always)]
pub fn transform_normal(m: &Matrix, n: [f32; 3]) -> [f32; 3] {
    transform_normal_by_inverse(&inverse(m), n)
}

#[cfg(test)]
mod tests {
    use super::*;

    const M: Matrix = [2.0, 0.5, 0.0, 0.0, -1.0, 3.0, 0.25, 0.0, 0.0, 1.0, 1.5, 0.0, 4.0, -5.0, 6.0, 1.0];

    #[test]
    fn inverse_undoes_a_matrix() {
        let product = multiply(&M, &inverse(&M));
        for (got, want) in product.iter().zip(IDENTITY) {
            assert!((got - want).abs() < 1e-6, "{product:?}");
        }
        assert_eq!(inverse(&diagonal(0.0)), IDENTITY);
        assert_eq!(inverse(&diagonal(4.0)), diagonal(0.25));
    }

    #[test]
    fn every_cofactor_counts() {
        let m = [3.0, 1.0, -2.0, 5.0, 0.5, 7.0, 1.0, -1.0, 2.0, 2.0, 9.0, 0.25, -4.0, 1.5, 3.0, 6.0];
        for (got, want) in multiply(&inverse(&m), &m).iter().zip(IDENTITY) {
            assert!((got - want).abs() < 1e-5);
        }
        let (a, b) = (determinant(&multiply(&m, &M)), determinant(&m) * determinant(&M));
        assert!((a - b).abs() < 1e-5 * b.abs());
        assert_eq!(determinant(&transpose(&m)), determinant(&m));
    }

    #[test]
    fn points_vectors_and_normals_differ() {
        assert_eq!(transform_point(&M, [1.0, 1.0, 1.0]), [5.0, -0.5, 7.75]);
        assert_eq!(transform_vector(&M, [1.0, 1.0, 1.0]), [1.0, 4.5, 1.75]);
        let (a, b) = (transform_vector(&M, [1.0, 2.0, 0.0]), transform_normal(&M, [-2.0, 1.0, 3.0]));
        assert!((a[0] * b[0] + a[1] * b[1] + a[2] * b[2]).abs() < 1e-6, "a normal stays perpendicular");
        let mut projective = IDENTITY;
        projective[15] = 0.0;
        assert_eq!(transform_point(&projective, [1.0, 2.0, 3.0]), [0.0; 3]);
    }
}
