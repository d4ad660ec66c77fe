//! What fits a parameter: the paths that name one, the values and the connections it takes.

use super::error::{GroupError, GroupProblem, GroupSubject};
use crate::check::typed::{ExprKind, Metadata};
use crate::ir::lower::{Binding, Layer};
use crate::lang::path::{part, root, steps};
use crate::lang::types::{Base, Element, Length, Type};

/// The type of a parameter or of the part of it that a path names.
pub(super) fn find_type(layer: &Layer, path: &str) -> Result<Type, GroupError> {
    let Some((param, variable)) = layer.shader.param(root(path)) else {
        let shader = layer.shader.name.clone();
        return Err(param_error(layer, path, GroupProblem::NoParam { shader, path: path.to_owned() }));
    };
    let Some(steps) = steps(path) else {
        return Err(param_error(layer, path, GroupProblem::NotAPath { path: path.to_owned() }));
    };
    let mut ty = variable.ty.clone();
    if param.open {
        ty.length = open_length(layer, &variable.name, &ty, steps.is_empty());
    }
    let wrong = |reason| param_error(layer, path, GroupProblem::NoPart { path: path.to_owned(), reason });
    steps.iter().try_fold(ty, |ty, step| part(&ty, step)).map_err(wrong)
}

/// Does the shader let a parameter be fed? Not with `[[int allowconnect = 0]]`.
pub(super) fn allows_connection(layer: &Layer, path: &str) -> bool {
    let refuses = |entry: &Metadata| entry.name == "allowconnect" && matches!(entry.value.kind, ExprKind::Int(0));
    !layer.shader.param(root(path)).is_some_and(|(param, _)| param.metadata.iter().any(refuses))
}

/// How long a parameter is that takes any number of elements: as a whole it has no bound, and its parts are counted by
/// what it was given before, if anything.
fn open_length(layer: &Layer, name: &str, ty: &Type, whole: bool) -> Length {
    let given = layer.bindings.iter().rev().find(|(target, _)| target == name);
    let each = ty.element_type().base().map_or(1, Base::components).max(1);
    match given {
        _ if whole => Length::Unsized,
        None => ty.length,
        Some((_, Binding::Numbers(numbers))) => Length::Fixed((numbers.len().div_ceil(each) as u32).max(1)),
        Some((_, Binding::Strings(strings))) => Length::Fixed((strings.len() as u32).max(1)),
        Some((_, Binding::Connection(..))) => Length::Unsized,
    }
}

/// Says what is wrong with a value for a parameter, if anything.
pub(super) fn checked_binding(layer: &Layer, name: &str, binding: &Binding) -> Result<(), GroupError> {
    let ty = find_type(layer, name)?;
    let text = ty.element_type().base() == Some(Base::String);
    let structure = ty.structure().is_some();
    let (fits, count) = match binding {
        Binding::Numbers(numbers) => (!text && ty.element_type().base() != Some(Base::Closure), numbers.len()),
        Binding::Strings(strings) => (text || structure, strings.len()),
        Binding::Connection(..) => return Ok(()),
    };
    let what = if matches!(binding, Binding::Numbers(_)) { ("numbers", "numbers") } else { ("a string", "strings") };
    if !fits {
        let given = what.0.to_owned();
        return Err(param_error(layer, name, GroupProblem::WrongType { path: name.to_owned(), wanted: ty, given }));
    }
    // One number may stand for all; two are no color.
    let whole = ty.base().filter(|_| ty.length == Length::Single).map_or(0, Base::components);
    if matches!(binding, Binding::Numbers(_)) && count > 1 && count < whole {
        let given = format!("{count} {}", what.1);
        let problem = GroupProblem::TooFew { path: name.to_owned(), wanted: ty, room: whole, given };
        return Err(param_error(layer, name, problem));
    }
    if let Some(room) = capacity(&ty).filter(|room| count > *room) {
        let given = format!("{count} {}", what.1);
        return Err(param_error(layer, name, GroupProblem::TooMany { path: name.to_owned(), wanted: ty, room, given }));
    }
    if let Binding::Numbers(numbers) = binding
        && let Some(value) = not_an_int(&ty, &mut numbers.iter())
    {
        return Err(param_error(layer, name, GroupProblem::NotAnInt { path: name.to_owned(), wanted: ty, value }));
    }
    Ok(())
}

/// How many numbers or strings a type holds; nothing when there is no bound.
fn capacity(ty: &Type) -> Option<usize> {
    if ty.length == Length::Unsized {
        return None;
    }
    let each = match &ty.element {
        Element::Base(base) => base.components(),
        Element::Struct(s) => s.fields.iter().map(|(_, ty)| capacity(ty)).sum::<Option<usize>>()?,
    };
    Some(each.saturating_mul(ty.count()))
}

/// The first of the numbers that stands for an int and is none. Numbers are used up in the order of the parts.
fn not_an_int(ty: &Type, numbers: &mut std::slice::Iter<f64>) -> Option<f64> {
    let count = if ty.length == Length::Unsized { usize::MAX } else { ty.count() };
    for _ in 0..count {
        if numbers.as_slice().is_empty() {
            return None;
        }
        let wrong = match &ty.element {
            Element::Base(Base::Int) => numbers.next().copied().filter(|&x| f64::from(x as i32) != x),
            Element::Base(base) => {
                numbers.by_ref().take(base.components()).for_each(drop);
                None
            }
            Element::Struct(s) => s.fields.iter().find_map(|(_, ty)| not_an_int(ty, numbers)),
        };
        if wrong.is_some() || matches!(&ty.element, Element::Struct(s) if s.fields.is_empty()) {
            return wrong;
        }
    }
    None
}

/// Says when a value that was written with a type is clearly not meant for a parameter.
pub(super) fn checked_type(layer: &Layer, name: &str, written: &Type) -> Result<(), GroupError> {
    let ty = find_type(layer, name)?;
    let (Some(given), Some(wanted)) = (written.element_type().base(), ty.element_type().base()) else { return Ok(()) };
    let suits = match (given, wanted) {
        _ if given == wanted || (given.is_triple() && wanted.is_triple()) => true,
        (Base::Int, Base::Float) => true,
        (Base::Int | Base::Float, _) => wanted.is_triple(),
        // Floats in a row are the same numbers under another name.
        (_, Base::Float) => ty.is_array() && given != Base::String,
        _ => false,
    };
    if suits {
        return Ok(());
    }
    let problem = GroupProblem::WrongType { path: name.to_owned(), wanted: ty, given: written.named() };
    Err(param_error(layer, name, problem))
}

/// May an output of one type feed a parameter of another?
pub(super) fn connects(from: &Type, to: &Type) -> bool {
    if from == to || (from.element == to.element && from.is_array() && to.length == Length::Unsized) {
        return true;
    }
    let numeric = |base: Base| base.is_number() || base.is_triple();
    match (from.base(), to.base()) {
        (Some(Base::Closure), Some(Base::Closure)) | (Some(Base::String), Some(Base::String)) => true,
        (Some(a), Some(b)) => numeric(a) && numeric(b),
        _ => false,
    }
}

/// An error about a parameter, with the names of those there are.
pub(super) fn param_error(layer: &Layer, name: &str, problem: GroupProblem) -> GroupError {
    let shader = &layer.shader;
    let names: Vec<&str> = shader.declared().map(|(_, variable)| variable.name.as_str()).collect();
    let help = if names.is_empty() {
        "the shader has no parameters".to_owned()
    } else {
        format!("its parameters are {}", names.join(", "))
    };
    let subject = GroupSubject::Param { layer: layer.name.clone(), name: name.to_owned() };
    GroupError { problem: Box::new(problem), help, subject }
}

#[cfg(test)]
mod tests {
    use crate::compile::{Compiler, GroupBuilder};
    use crate::exec::{Machine, Points};

    /// A shader with parameters of every shape, which prints them all.
    const SHAPES: &str = "struct T { color c; float w[2]; }; \
        shader shapes(color k = 0, float a[3] = {1, 2, 3}, int n = 7, T l[2] = {{1, {1, 2}}, {2, {3, 4}}}, string s = \"\", \
            float o[] = {1, 2}) { \
            printf(\"%g; %g %g %g; %d; %g %g %g %g; %s; %g %g/\", k, a[0], a[1], a[2], n, l[0].c, l[1].c, l[1].w[0], l[1].w[1], \
                s, o[0], o[1]); }";

    /// What the shader of every shape prints, or why its group cannot be built.
    fn shapes(set: impl Fn(GroupBuilder) -> GroupBuilder) -> Result<String, String> {
        let compiler = Compiler::new();
        let source = "shader source(output color c = color(1, 2, 6), output float f = 2.5) {}";
        let (source, shader) = (compiler.compile("a.osl", source).unwrap(), compiler.compile("b.osl", SHAPES).unwrap());
        let builder = GroupBuilder::new(compiler.closures.clone());
        let builder = builder.layer("source", &source).layer("shapes", &shader);
        let group = set(builder).build().map_err(|error| error.problem.to_string())?;
        let mut machine = Machine::new();
        machine.shade(&group, &Points::new(1));
        Ok(machine.take_reports().into_iter().map(|report| report.text).collect())
    }

    #[test]
    fn parts_of_parameters_are_found_or_refused() {
        let says = |path: &str, numbers: &[f64]| shapes(|b| b.param(path, numbers));
        for (path, numbers, printed) in [
            ("k[1]", &[5.0][..], "0 5 0; 1 2 3; 7; 1 1 1 2 2 2 3 4; ; 1 2/"),
            ("a[2]", &[5.0], "0 0 0; 1 2 5; 7; 1 1 1 2 2 2 3 4; ; 1 2/"),
            ("l[1].c", &[7.0, 8.0, 9.0], "0 0 0; 1 2 3; 7; 1 1 1 7 8 9 3 4; ; 1 2/"),
            ("l[1].c[2]", &[9.0], "0 0 0; 1 2 3; 7; 1 1 1 2 2 9 3 4; ; 1 2/"),
            ("l[1].w[1]", &[9.0], "0 0 0; 1 2 3; 7; 1 1 1 2 2 2 3 9; ; 1 2/"),
            ("l[1].w", &[8.0, 9.0], "0 0 0; 1 2 3; 7; 1 1 1 2 2 2 8 9; ; 1 2/"),
            ("l[1]", &[5.0, 6.0, 7.0, 8.0], "0 0 0; 1 2 3; 7; 1 1 1 5 6 7 8 0; ; 1 2/"),
            ("a", &[5.0], "0 0 0; 5 0 0; 7; 1 1 1 2 2 2 3 4; ; 1 2/"),
            ("o", &[5.0, 6.0, 7.0], "0 0 0; 1 2 3; 7; 1 1 1 2 2 2 3 4; ; 5 6/"),
        ] {
            assert_eq!(says(path, numbers).as_deref(), Ok(printed), "{path}");
        }
        for (path, numbers, message) in [
            ("k[1][2]", &[5.0][..], "there is no `k[1][2]`: a float has no elements"),
            ("k[3]", &[5.0], "there is no `k[3]`: index 3 is outside 0..2"),
            ("a[7]", &[5.0], "there is no `a[7]`: index 7 is outside 0..2"),
            ("a[x]", &[5.0], "`a[x]` is no part of a parameter: write `name.field` or `name[0]`"),
            ("a[-1]", &[5.0], "`a[-1]` is no part of a parameter: write `name.field` or `name[0]`"),
            ("l.c", &[5.0], "there is no `l.c`: a struct T[2] has no field `c`"),
            ("o[2]", &[5.0], "there is no `o[2]`: index 2 is outside 0..1"),
            ("k", &[1.0, 2.0, 3.0, 4.0], "parameter `k` is a color and holds 3, not 4 numbers"),
            ("n", &[1.5], "parameter `n` is an int, and 1.5 is no int"),
            ("k", &[1.0, 2.0], "parameter `k` is a color and takes 3 numbers, or one, not 2 numbers"),
            ("l[1].c", &[1.0, 2.0], "parameter `l[1].c` is a color and takes 3 numbers, or one, not 2 numbers"),
        ] {
            assert_eq!(says(path, numbers), Err(message.to_owned()), "{path}");
        }
        assert_eq!(shapes(|b| b.text("s", "5")).as_deref(), Ok("0 0 0; 1 2 3; 7; 1 1 1 2 2 2 3 4; 5; 1 2/"));
        assert_eq!(shapes(|b| b.text("n", "nan")), Err("parameter `n` is an int, and NaN is no int".to_owned()));
        let fed = |from, to| shapes(|b| b.connect(("source", from), ("shapes", to)));
        assert_eq!(fed("c", "n").as_deref(), Ok("0 0 0; 1 2 3; 3; 1 1 1 2 2 2 3 4; ; 1 2/"), "a triple is averaged");
        assert_eq!(fed("f", "n").as_deref(), Ok("0 0 0; 1 2 3; 2; 1 1 1 2 2 2 3 4; ; 1 2/"));
        assert_eq!(fed("c", "l[1].c").as_deref(), Ok("0 0 0; 1 2 3; 7; 1 1 1 1 2 6 3 4; ; 1 2/"));
        assert_eq!(fed("c[1]", "a[0]").as_deref(), Ok("0 0 0; 2 2 3; 7; 1 1 1 2 2 2 3 4; ; 1 2/"));
    }
}
