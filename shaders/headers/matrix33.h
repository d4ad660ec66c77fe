// velour's matrix33.h: matrices of three rows, kept in the upper left of one of four, as OSL has them beside its own types.

#ifndef MATRIX33_H
#define MATRIX33_H

struct matrix33 { matrix m; };

// True when the rest of the matrix is that of the identity, so that three rows say all.
int isValidAs33(matrix m)
{
    return m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][0] == 0 && m[3][1] == 0 && m[3][2] == 0 && m[3][3] == 1;
}

matrix matrix33To44(matrix33 a) { return a.m; }

matrix33 matrix44To33(matrix m)
{
    matrix33 upper;
    upper.m = matrix(m[0][0], m[0][1], m[0][2], 0, m[1][0], m[1][1], m[1][2], 0, m[2][0], m[2][1], m[2][2], 0, 0, 0, 0, 1);
    return upper;
}

#define MATRIX33_OPERATOR(NAME, OP) \
    matrix33 __operator__##NAME##__(matrix33 a, matrix33 b) { return matrix44To33(a.m OP b.m); } \
    matrix33 __operator__##NAME##__(matrix33 a, float b) { return matrix44To33(a.m OP b); } \
    matrix33 __operator__##NAME##__(matrix33 a, int b) { return matrix44To33(a.m OP b); } \
    matrix33 __operator__##NAME##__(float a, matrix33 b) { return matrix44To33(a OP b.m); } \
    matrix33 __operator__##NAME##__(int a, matrix33 b) { return matrix44To33(a OP b.m); }
MATRIX33_OPERATOR(mul, *)
MATRIX33_OPERATOR(div, /)
#undef MATRIX33_OPERATOR

matrix33 __operator__neg__(matrix33 a) { return matrix44To33(-a.m); }
int __operator__eq__(matrix33 a, matrix33 b) { return a.m == b.m; }
int __operator__neq__(matrix33 a, matrix33 b) { return a.m != b.m; }
int __operator__ne__(matrix33 a, matrix33 b) { return a.m != b.m; }

float determinant(matrix33 a) { return determinant(a.m); }
matrix33 transpose(matrix33 a) { return matrix44To33(transpose(a.m)); }
point transform(matrix33 a, point b) { return transform(a.m, b); }
vector transform(matrix33 a, vector b) { return transform(a.m, b); }
normal transform(matrix33 a, normal b) { return transform(a.m, b); }

#endif
