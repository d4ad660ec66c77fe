//! The builtin functions: one line a family of overloads, in the notation of the language itself.
//!
//! Type names stand for themselves; `any` matches every type that is not an array, `any[]` every array, `...` any
//! further arguments, `[token,value]*` pairs of a string and a value. A name in braces stands for each of its members
//! in turn, everywhere on the line alike: `{t}` color point vector normal, `{f}` the same and float. `output` marks
//! what is written. Functions that the standard header defines in OSL are not here.

use super::types::{Base, Length, Type};
use std::sync::LazyLock;
use velour_grammar::names::NameMap;

const TABLE: &str = "
{f} cos({f}); {f} sin({f}); {f} tan({f}); {f} acos({f}); {f} asin({f}); {f} atan({f}); {f} atan2({f}, {f})
{f} cosh({f}); {f} sinh({f}); {f} tanh({f}); {f} pow({f}, {f}); {t} pow({t}, float)
{f} exp({f}); {f} exp2({f}); {f} expm1({f}); {f} log({f}); {f} log2({f}); {f} log10({f}); {f} logb({f})
{f} sqrt({f}); {f} inversesqrt({f}); {f} cbrt({f}); {f} abs({f}); int abs(int); {f} fabs({f}); int fabs(int)
{f} sign({f}); {f} floor({f}); {f} ceil({f}); {f} round({f}); {f} trunc({f})
{f} fmod({f}, {f}); {t} fmod({t}, float)
{f} min({f}, {f}); int min(int, int); {f} max({f}, {f}); int max(int, int)
{f} mix({f}, {f}, {f}); {t} mix({t}, {t}, float)
{f} select({f}, {f}, {f}); {t} select({t}, {t}, float); {f} select({f}, {f}, int)
{f} step({f}, {f}); float smoothstep(float, float, float)
int isnan(float); int isinf(float); int isfinite(float); float erf(float); float erfc(float)
vector cross(vector, vector); float dot(vector, vector); float length(vector); float distance(point, point)
vector normalize(vector); normal normalize(normal)
void sincos(float, output float, output float); void sincos({t}, output {t}, output {t})
normal transform(matrix, normal); vector transform(matrix, vector); point transform(matrix, point)
normal transform(string, string, normal); vector transform(string, string, vector); point transform(string, string, point)
float transformu(string, float); float transformu(string, string, float)
float luminance(color); color blackbody(float); color wavelength_color(float); color transformc(string, string, color)
float determinant(matrix); matrix transpose(matrix)
int hash(int); int hash(float); int hash(float, float); int hash(point); int hash(point, float); int hash(string)
int strlen(string); int getchar(string, int); int startswith(string, string); int endswith(string, string)
string substr(string, int, int); float stof(string); int stoi(string); string concat(string, string)
int backfacing(); int raytype(string); int getmatrix(string, string, output matrix)
float area(point); vector calculatenormal(point); float surfacearea()
int arraylength(any[]); int isconnected(any); int isconstant(any)
float Dx(float); vector Dx(point); vector Dx(vector); vector Dx(normal); color Dx(color)
float Dy(float); vector Dy(point); vector Dy(vector); vector Dy(normal); color Dy(color)
float Dz(float); vector Dz(point); vector Dz(vector); vector Dz(normal); color Dz(color)
float filterwidth(float); vector filterwidth(point); vector filterwidth(vector)
{n} cellnoise(float); {n} cellnoise(float, float); {n} cellnoise(point); {n} cellnoise(point, float)
{n} hashnoise(float); {n} hashnoise(float, float); {n} hashnoise(point); {n} hashnoise(point, float)
{n} noise(float); {n} noise(float, float); {n} noise(point); {n} noise(point, float)
{n} snoise(float); {n} snoise(float, float); {n} snoise(point); {n} snoise(point, float)
{n} noise(string, float, [token,value]*); {n} noise(string, float, float, [token,value]*)
{n} noise(string, point, [token,value]*); {n} noise(string, point, float, [token,value]*)
{n} pnoise(float, float); {n} pnoise(float, float, float, float); {n} pnoise(point, point)
{n} pnoise(point, float, point, float)
{n} psnoise(float, float); {n} psnoise(float, float, float, float); {n} psnoise(point, point)
{n} psnoise(point, float, point, float)
{n} pnoise(string, float, float, [token,value]*); {n} pnoise(string, float, float, float, float, [token,value]*)
{n} pnoise(string, point, point, [token,value]*); {n} pnoise(string, point, float, point, float, [token,value]*)
{f} spline(string, float, {f}[]); {f} spline(string, float, int, {f}[])
float splineinverse(string, float, float[]); float splineinverse(string, float, int, float[])
{r} random()
void printf(string, ...); void fprintf(string, string, ...); void error(string, ...); void warning(string, ...)
string format(string, ...); void exit()
int getattribute(string, output any); int getattribute(string, output any[])
int getattribute(string, string, output any); int getattribute(string, string, output any[])
int getattribute(string, int, output any); int getattribute(string, int, output any[])
int getattribute(string, string, int, output any); int getattribute(string, string, int, output any[])
int getmessage(string, output any); int getmessage(string, output any[])
int getmessage(string, string, output any); int getmessage(string, string, output any[])
void setmessage(string, any); void setmessage(string, any[])
int regex_match(string, string); int regex_match(string, output int[], string)
int regex_search(string, string); int regex_search(string, output int[], string)
int split(string, output string[], string, int); int split(string, output string[], string); int split(string, output string[])
void bump(float); void bump(string, float); void bump(vector); void displace(float); void displace(string, float); void displace(vector)
int dict_find(string, string); int dict_find(int, string); int dict_next(int); int dict_value(int, string, output any); int dict_value(int, string, output any[])
{n} environment(string, vector, [token,value]*); {n} environment(string, vector, vector, vector, [token,value]*)
{n} texture(string, float, float, [token,value]*); {n} texture(string, float, float, float, float, float, float, [token,value]*)
{n} texture3d(string, point, [token,value]*); {n} texture3d(string, point, vector, vector, vector, [token,value]*)
int gettextureinfo(string, string, output any); int gettextureinfo(string, string, output any[])
int gettextureinfo(string, float, float, string, output any); int gettextureinfo(string, float, float, string, output any[])
int pointcloud_search(string, point, float, int, [token,value]*); int pointcloud_search(string, point, float, int, int, [token,value]*)
int pointcloud_get(string, int[], int, string, output any[]); int pointcloud_write(string, point, [token,value]*)
int trace(point, vector, [token,value]*)
";

/// What a formal parameter of a builtin accepts.
#[derive(Clone, Debug, PartialEq)]
pub enum Formal {
    /// A value of this type, or one that converts to it.
    Type(Type),
    /// Any value that is not an array.
    Any,
    /// Any array.
    AnyArray,
}

/// One overload of a builtin.
#[derive(Clone, Debug, PartialEq)]
pub struct Signature {
    /// The type of the value.
    pub returns: Type,
    /// What each argument must be and whether it is written.
    pub formals: Vec<(Formal, bool)>,
    /// True when further arguments of any type may follow.
    pub variadic: bool,
    /// True when pairs of a name and a value may follow.
    pub options: bool,
}

static SIGNATURES: LazyLock<NameMap<&'static str, Vec<Signature>>> = LazyLock::new(|| {
    let mut map: NameMap<&'static str, Vec<Signature>> = NameMap::default();
    let lines = TABLE.lines().flat_map(|line| line.split(';'));
    for text in lines.map(str::trim).filter(|text| !text.is_empty()) {
        for expanded in expand(text) {
            let (name, signature) = parse(&expanded);
            let start = text.find(name.as_str()).unwrap_or(0);
            map.entry(&text[start..start + name.len()]).or_default().push(signature);
        }
    }
    map
});

/// All overloads of a builtin, or nothing when there is no such builtin.
pub fn signatures(name: &str) -> Option<&'static [Signature]> {
    SIGNATURES.get(name).map(Vec::as_slice)
}

/// The table's own copy of a builtin's name, or nothing when there is no such builtin.
pub fn static_name(name: &str) -> Option<&'static str> {
    SIGNATURES.get_key_value(name).map(|(name, _)| *name)
}

/// The names of all builtins, in no particular order.
pub fn names() -> impl Iterator<Item = &'static str> {
    SIGNATURES.keys().copied()
}

/// Replaces the brace of a line by each of its members.
fn expand(text: &str) -> Vec<String> {
    let sets: [(&str, &[&str]); 4] = [
        ("{f}", &["float", "color", "point", "vector", "normal"]),
        ("{t}", &["color", "point", "vector", "normal"]),
        ("{n}", &["float", "color", "vector"]),
        ("{r}", &["float", "color", "point", "vector", "normal"]),
    ];
    match sets.iter().find(|(brace, _)| text.contains(brace)) {
        Some((brace, members)) => members.iter().map(|m| text.replace(brace, m)).collect(),
        None => vec![text.to_owned()],
    }
}

fn parse(text: &str) -> (String, Signature) {
    let (head, rest) = text.split_once('(').unwrap_or((text, ")"));
    let (returns, name) = head.split_once(' ').unwrap_or(("void", head));
    let mut signature =
        Signature { returns: parse_type(returns), formals: Vec::new(), variadic: false, options: false };
    let rest = rest.replace("[token,value]*", "options");
    for formal in rest.trim_end_matches(')').split(',').map(str::trim).filter(|f| !f.is_empty()) {
        let (output, formal) = formal.strip_prefix("output ").map_or((false, formal), |f| (true, f));
        match formal {
            "..." => signature.variadic = true,
            "options" => signature.options = true,
            "any" => signature.formals.push((Formal::Any, output)),
            "any[]" => signature.formals.push((Formal::AnyArray, output)),
            other => signature.formals.push((Formal::Type(parse_type(other)), output)),
        }
    }
    (name.to_owned(), signature)
}

fn parse_type(text: &str) -> Type {
    let (name, array) = text.strip_suffix("[]").map_or((text, false), |name| (name, true));
    let bases =
        [Base::Int, Base::Float, Base::Color, Base::Point, Base::Vector, Base::Normal, Base::Matrix, Base::String];
    let base = bases.into_iter().find(|base| base.name() == name).unwrap_or(Base::Void);
    Type::of(base).array(if array { Length::Unsized } else { Length::Single })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_reads_as_it_is_meant() {
        let pow = signatures("pow").unwrap();
        assert_eq!(pow.len(), 9);
        assert_eq!(signatures("noise").unwrap().len(), 24);
        let printf = &signatures("printf").unwrap()[0];
        assert!(printf.variadic && printf.formals == vec![(Formal::Type(Type::STRING), false)]);
        let sincos = &signatures("sincos").unwrap()[0];
        assert_eq!(sincos.formals[1], (Formal::Type(Type::FLOAT), true));
        assert!(names().all(|name| !name.is_empty() && !name.contains(' ')));
    }
}
