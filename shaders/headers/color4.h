// velour's color4.h: a color and an alpha, as OSL has them beside its own types.
//
// Each operation works component by component, so each is said once for all of its forms by a macro.

#ifndef COLOR4_H
#define COLOR4_H

struct color4 { color rgb; float a; };

#define COLOR4_OPERATOR(NAME, OP) \
    color4 __operator__##NAME##__(color4 a, color4 b) { return color4(a.rgb OP b.rgb, a.a OP b.a); } \
    color4 __operator__##NAME##__(color4 a, float b) { return color4(a.rgb OP b, a.a OP b); } \
    color4 __operator__##NAME##__(color4 a, int b) { return color4(a.rgb OP b, a.a OP b); } \
    color4 __operator__##NAME##__(float a, color4 b) { return color4(a OP b.rgb, a OP b.a); } \
    color4 __operator__##NAME##__(int a, color4 b) { return color4(a OP b.rgb, a OP b.a); }
COLOR4_OPERATOR(add, +)
COLOR4_OPERATOR(sub, -)
COLOR4_OPERATOR(mul, *)
COLOR4_OPERATOR(div, /)
#undef COLOR4_OPERATOR

color4 __operator__neg__(color4 a) { return color4(-a.rgb, -a.a); }
int __operator__eq__(color4 a, color4 b) { return a.rgb == b.rgb && a.a == b.a; }
int __operator__neq__(color4 a, color4 b) { return a.rgb != b.rgb || a.a != b.a; }

#define COLOR4_OF_ONE(F) \
    color4 F(color4 a) { return color4(F(a.rgb), F(a.a)); }
COLOR4_OF_ONE(abs)
COLOR4_OF_ONE(ceil)
COLOR4_OF_ONE(floor)
COLOR4_OF_ONE(sqrt)
COLOR4_OF_ONE(exp)
COLOR4_OF_ONE(log)
COLOR4_OF_ONE(log2)
COLOR4_OF_ONE(sign)
COLOR4_OF_ONE(sin)
COLOR4_OF_ONE(cos)
COLOR4_OF_ONE(tan)
COLOR4_OF_ONE(asin)
COLOR4_OF_ONE(acos)
#undef COLOR4_OF_ONE

#define COLOR4_OF_TWO(F) \
    color4 F(color4 a, color4 b) { return color4(F(a.rgb, b.rgb), F(a.a, b.a)); } \
    color4 F(color4 a, float b) { return color4(F(a.rgb, color(b)), F(a.a, b)); }
COLOR4_OF_TWO(atan2)
COLOR4_OF_TWO(fmod)
COLOR4_OF_TWO(max)
COLOR4_OF_TWO(min)
COLOR4_OF_TWO(mod)
COLOR4_OF_TWO(pow)
#undef COLOR4_OF_TWO

color4 clamp(color4 a, color4 low, color4 high) { return color4(clamp(a.rgb, low.rgb, high.rgb), clamp(a.a, low.a, high.a)); }
color4 clamp(color4 a, float low, float high) { return color4(clamp(a.rgb, color(low), color(high)), clamp(a.a, low, high)); }
color4 mix(color4 a, color4 b, float x) { return color4(mix(a.rgb, b.rgb, x), mix(a.a, b.a, x)); }
color4 smoothstep(color4 low, color4 high, color4 a)
{
    return color4(smoothstep(low.rgb, high.rgb, a.rgb), smoothstep(low.a, high.a, a.a));
}
color4 smoothstep(float low, float high, color4 a) { return color4(smoothstep(low, high, a.rgb), smoothstep(low, high, a.a)); }

// The color goes from one space to another; the alpha stays.
color4 transformc(string from, string to, color4 c) { return color4(transformc(from, to, c.rgb), c.a); }

#endif
