// velour's color2.h: a gray and an alpha, as OSL has them beside its own types.
//
// Each operation works component by component, so each is said once for all of its forms by a macro.

#ifndef COLOR2_H
#define COLOR2_H

struct color2 { float r; float a; };

#define COLOR2_OPERATOR(NAME, OP) \
    color2 __operator__##NAME##__(color2 a, color2 b) { return color2(a.r OP b.r, a.a OP b.a); } \
    color2 __operator__##NAME##__(color2 a, float b) { return color2(a.r OP b, a.a OP b); } \
    color2 __operator__##NAME##__(color2 a, int b) { return color2(a.r OP b, a.a OP b); } \
    color2 __operator__##NAME##__(float a, color2 b) { return color2(a OP b.r, a OP b.a); } \
    color2 __operator__##NAME##__(int a, color2 b) { return color2(a OP b.r, a OP b.a); }
COLOR2_OPERATOR(add, +)
COLOR2_OPERATOR(sub, -)
COLOR2_OPERATOR(mul, *)
COLOR2_OPERATOR(div, /)
#undef COLOR2_OPERATOR

color2 __operator__neg__(color2 a) { return color2(-a.r, -a.a); }
int __operator__eq__(color2 a, color2 b) { return a.r == b.r && a.a == b.a; }
int __operator__neq__(color2 a, color2 b) { return a.r != b.r || a.a != b.a; }

#define COLOR2_OF_ONE(F) \
    color2 F(color2 a) { return color2(F(a.r), F(a.a)); }
COLOR2_OF_ONE(abs)
COLOR2_OF_ONE(ceil)
COLOR2_OF_ONE(floor)
COLOR2_OF_ONE(sqrt)
COLOR2_OF_ONE(exp)
COLOR2_OF_ONE(log)
COLOR2_OF_ONE(log2)
COLOR2_OF_ONE(sign)
COLOR2_OF_ONE(sin)
COLOR2_OF_ONE(cos)
COLOR2_OF_ONE(tan)
COLOR2_OF_ONE(asin)
COLOR2_OF_ONE(acos)
#undef COLOR2_OF_ONE

#define COLOR2_OF_TWO(F) \
    color2 F(color2 a, color2 b) { return color2(F(a.r, b.r), F(a.a, b.a)); } \
    color2 F(color2 a, float b) { return color2(F(a.r, b), F(a.a, b)); }
COLOR2_OF_TWO(atan2)
COLOR2_OF_TWO(fmod)
COLOR2_OF_TWO(max)
COLOR2_OF_TWO(min)
COLOR2_OF_TWO(mod)
COLOR2_OF_TWO(pow)
#undef COLOR2_OF_TWO

color2 clamp(color2 a, color2 low, color2 high) { return color2(clamp(a.r, low.r, high.r), clamp(a.a, low.a, high.a)); }
color2 clamp(color2 a, float low, float high) { return color2(clamp(a.r, low, high), clamp(a.a, low, high)); }
color2 mix(color2 a, color2 b, float x) { return color2(mix(a.r, b.r, x), mix(a.a, b.a, x)); }
color2 smoothstep(color2 low, color2 high, color2 a)
{
    return color2(smoothstep(low.r, high.r, a.r), smoothstep(low.a, high.a, a.a));
}
color2 smoothstep(float low, float high, color2 a) { return color2(smoothstep(low, high, a.r), smoothstep(low, high, a.a)); }

#endif
