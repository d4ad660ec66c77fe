// velour's vector2.h: pairs of floats, as OSL has them beside its own types.
//
// Each operation works component by component, so each is said once for all of its forms by a macro.

#ifndef VECTOR2_H
#define VECTOR2_H

struct vector2 { float x; float y; };

#define VECTOR2_OPERATOR(NAME, OP) \
    vector2 __operator__##NAME##__(vector2 a, vector2 b) { return vector2(a.x OP b.x, a.y OP b.y); } \
    vector2 __operator__##NAME##__(vector2 a, float b) { return vector2(a.x OP b, a.y OP b); } \
    vector2 __operator__##NAME##__(vector2 a, int b) { return vector2(a.x OP b, a.y OP b); } \
    vector2 __operator__##NAME##__(float a, vector2 b) { return vector2(a OP b.x, a OP b.y); } \
    vector2 __operator__##NAME##__(int a, vector2 b) { return vector2(a OP b.x, a OP b.y); }
VECTOR2_OPERATOR(add, +)
VECTOR2_OPERATOR(sub, -)
VECTOR2_OPERATOR(mul, *)
VECTOR2_OPERATOR(div, /)
#undef VECTOR2_OPERATOR

vector2 __operator__neg__(vector2 a) { return vector2(-a.x, -a.y); }
int __operator__eq__(vector2 a, vector2 b) { return a.x == b.x && a.y == b.y; }
int __operator__neq__(vector2 a, vector2 b) { return a.x != b.x || a.y != b.y; }

#define VECTOR2_OF_ONE(F) \
    vector2 F(vector2 a) { return vector2(F(a.x), F(a.y)); }
VECTOR2_OF_ONE(abs)
VECTOR2_OF_ONE(ceil)
VECTOR2_OF_ONE(floor)
VECTOR2_OF_ONE(sqrt)
VECTOR2_OF_ONE(exp)
VECTOR2_OF_ONE(log)
VECTOR2_OF_ONE(log2)
VECTOR2_OF_ONE(sign)
VECTOR2_OF_ONE(sin)
VECTOR2_OF_ONE(cos)
VECTOR2_OF_ONE(tan)
VECTOR2_OF_ONE(asin)
VECTOR2_OF_ONE(acos)
#undef VECTOR2_OF_ONE

#define VECTOR2_OF_TWO(F) \
    vector2 F(vector2 a, vector2 b) { return vector2(F(a.x, b.x), F(a.y, b.y)); } \
    vector2 F(vector2 a, float b) { return vector2(F(a.x, b), F(a.y, b)); }
VECTOR2_OF_TWO(atan2)
VECTOR2_OF_TWO(fmod)
VECTOR2_OF_TWO(max)
VECTOR2_OF_TWO(min)
VECTOR2_OF_TWO(mod)
VECTOR2_OF_TWO(pow)
#undef VECTOR2_OF_TWO

vector2 clamp(vector2 a, vector2 low, vector2 high) { return vector2(clamp(a.x, low.x, high.x), clamp(a.y, low.y, high.y)); }
vector2 clamp(vector2 a, float low, float high) { return vector2(clamp(a.x, low, high), clamp(a.y, low, high)); }
vector2 mix(vector2 a, vector2 b, float x) { return vector2(mix(a.x, b.x, x), mix(a.y, b.y, x)); }
vector2 smoothstep(vector2 low, vector2 high, vector2 a)
{
    return vector2(smoothstep(low.x, high.x, a.x), smoothstep(low.y, high.y, a.y));
}
vector2 smoothstep(float low, float high, vector2 a) { return vector2(smoothstep(low, high, a.x), smoothstep(low, high, a.y)); }

float dot(vector2 a, vector2 b) { return a.x * b.x + a.y * b.y; }
float length(vector2 a) { return sqrt(dot(a, a)); }
vector2 normalize(vector2 a) { return a / length(a); }

#endif
