// velour's vector4.h: four floats, as OSL has them beside its own types.
//
// Each operation works component by component, so each is said once for all of its forms by a macro.

#ifndef VECTOR4_H
#define VECTOR4_H

struct vector4 { float x; float y; float z; float w; };

#define VECTOR4_OPERATOR(NAME, OP) \
    vector4 __operator__##NAME##__(vector4 a, vector4 b) { return vector4(a.x OP b.x, a.y OP b.y, a.z OP b.z, a.w OP b.w); } \
    vector4 __operator__##NAME##__(vector4 a, float b) { return vector4(a.x OP b, a.y OP b, a.z OP b, a.w OP b); } \
    vector4 __operator__##NAME##__(vector4 a, int b) { return vector4(a.x OP b, a.y OP b, a.z OP b, a.w OP b); } \
    vector4 __operator__##NAME##__(float a, vector4 b) { return vector4(a OP b.x, a OP b.y, a OP b.z, a OP b.w); } \
    vector4 __operator__##NAME##__(int a, vector4 b) { return vector4(a OP b.x, a OP b.y, a OP b.z, a OP b.w); }
VECTOR4_OPERATOR(add, +)
VECTOR4_OPERATOR(sub, -)
VECTOR4_OPERATOR(mul, *)
VECTOR4_OPERATOR(div, /)
#undef VECTOR4_OPERATOR

vector4 __operator__neg__(vector4 a) { return vector4(-a.x, -a.y, -a.z, -a.w); }
int __operator__eq__(vector4 a, vector4 b) { return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w; }
int __operator__neq__(vector4 a, vector4 b) { return a.x != b.x || a.y != b.y || a.z != b.z || a.w != b.w; }

#define VECTOR4_OF_ONE(F) \
    vector4 F(vector4 a) { return vector4(F(a.x), F(a.y), F(a.z), F(a.w)); }
VECTOR4_OF_ONE(abs)
VECTOR4_OF_ONE(ceil)
VECTOR4_OF_ONE(floor)
VECTOR4_OF_ONE(sqrt)
VECTOR4_OF_ONE(exp)
VECTOR4_OF_ONE(log)
VECTOR4_OF_ONE(log2)
VECTOR4_OF_ONE(sign)
VECTOR4_OF_ONE(sin)
VECTOR4_OF_ONE(cos)
VECTOR4_OF_ONE(tan)
VECTOR4_OF_ONE(asin)
VECTOR4_OF_ONE(acos)
#undef VECTOR4_OF_ONE

#define VECTOR4_OF_TWO(F) \
    vector4 F(vector4 a, vector4 b) { return vector4(F(a.x, b.x), F(a.y, b.y), F(a.z, b.z), F(a.w, b.w)); } \
    vector4 F(vector4 a, float b) { return vector4(F(a.x, b), F(a.y, b), F(a.z, b), F(a.w, b)); }
VECTOR4_OF_TWO(atan2)
VECTOR4_OF_TWO(fmod)
VECTOR4_OF_TWO(max)
VECTOR4_OF_TWO(min)
VECTOR4_OF_TWO(mod)
VECTOR4_OF_TWO(pow)
#undef VECTOR4_OF_TWO

vector4 clamp(vector4 a, vector4 low, vector4 high) { return vector4(clamp(a.x, low.x, high.x), clamp(a.y, low.y, high.y), clamp(a.z, low.z, high.z), clamp(a.w, low.w, high.w)); }
vector4 clamp(vector4 a, float low, float high) { return vector4(clamp(a.x, low, high), clamp(a.y, low, high), clamp(a.z, low, high), clamp(a.w, low, high)); }
vector4 mix(vector4 a, vector4 b, float x) { return vector4(mix(a.x, b.x, x), mix(a.y, b.y, x), mix(a.z, b.z, x), mix(a.w, b.w, x)); }
vector4 smoothstep(vector4 low, vector4 high, vector4 a)
{
    return vector4(smoothstep(low.x, high.x, a.x), smoothstep(low.y, high.y, a.y), smoothstep(low.z, high.z, a.z), smoothstep(low.w, high.w, a.w));
}
vector4 smoothstep(float low, float high, vector4 a) { return vector4(smoothstep(low, high, a.x), smoothstep(low, high, a.y), smoothstep(low, high, a.z), smoothstep(low, high, a.w)); }

float dot(vector4 a, vector4 b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }
float length(vector4 a) { return sqrt(dot(a, a)); }
vector4 normalize(vector4 a) { return a / length(a); }

// The direction, without w.
vector vec4ToVec3(vector4 a) { return vector(a.x, a.y, a.z) / a.w; }

// A row of four times a matrix.
vector4 transform(matrix m, vector4 a)
{
    return vector4(a.x * m[0][0] + a.y * m[1][0] + a.z * m[2][0] + a.w * m[3][0],
                   a.x * m[0][1] + a.y * m[1][1] + a.z * m[2][1] + a.w * m[3][1],
                   a.x * m[0][2] + a.y * m[1][2] + a.z * m[2][2] + a.w * m[3][2],
                   a.x * m[0][3] + a.y * m[1][3] + a.z * m[2][3] + a.w * m[3][3]);
}

vector4 transform(string from, string to, vector4 a) { return transform(matrix(from, to), a); }

#endif
