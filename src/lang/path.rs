//! Paths to a part of a parameter, as hosts and scenes write them: `name.field[2]`.

use super::types::{Base, Type};

/// One step from a value into a part of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// A field of a struct.
    Field(String),
    /// An element of an array or a component of a triple.
    Index(u32),
}

/// The parameter that a path starts from.
pub fn root(path: &str) -> &str {
    &path[..path.find(['.', '[']).unwrap_or(path.len())]
}

/// The steps of a path after its root; nothing when it is not written as `.field` and `[number]`.
pub fn steps(path: &str) -> Option<Vec<Step>> {
    let mut rest = &path[root(path).len()..];
    let mut steps = Vec::new();
    while !rest.is_empty() {
        if let Some(field) = rest.strip_prefix('.') {
            let name = root(field);
            if name.is_empty() {
                return None;
            }
            steps.push(Step::Field(name.to_owned()));
            rest = &field[name.len()..];
        } else {
            let (number, after) = rest.strip_prefix('[')?.split_once(']')?;
            steps.push(Step::Index(number.trim().parse().ok()?));
            rest = after;
        }
    }
    Some(steps)
}

/// The type of the part one step into a value, or why there is none, as the end of a sentence about the value.
///
/// # Errors
/// The value has no such part.
pub fn part(ty: &Type, step: &Step) -> Result<Type, String> {
    let triple = ty.base().is_some_and(Base::is_triple);
    match step {
        Step::Field(name) => {
            let structure = ty.structure().filter(|_| !ty.is_array());
            let field = structure.and_then(|s| s.fields.iter().find(|(field, _)| field == name));
            field.map(|(_, ty)| ty.clone()).ok_or_else(|| format!("{} has no field `{name}`", ty.named()))
        }
        Step::Index(_) if !ty.is_array() && !triple => Err(format!("{} has no elements", ty.named())),
        Step::Index(at) => {
            let count = if triple { 3 } else { ty.count() };
            if *at as usize >= count && count > 0 {
                return Err(format!("index {at} is outside 0..{}", count - 1));
            }
            Ok(if triple { Type::FLOAT } else { ty.element_type() })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lang::types::Length;

    #[test]
    fn paths_parse_or_are_refused() {
        let field = |name: &str| Step::Field(name.to_owned());
        assert_eq!(steps("a"), Some(Vec::new()));
        assert_eq!(steps("l[1].c[0]"), Some(vec![Step::Index(1), field("c"), Step::Index(0)]));
        for wrong in ["a[x]", "a[-1]", "a[", "a[1", "a[]", "a.", "a..b", "a[1]b", "a[99999999999]"] {
            assert!(steps(wrong).is_none(), "{wrong}");
        }
    }

    #[test]
    fn a_part_is_inside_its_whole() {
        let array = Type::FLOAT.array(Length::Fixed(3));
        assert_eq!(part(&array, &Step::Index(2)), Ok(Type::FLOAT));
        assert!(part(&array, &Step::Index(3)).is_err());
        assert!(part(&Type::of(Base::Color), &Step::Index(3)).is_err());
        assert!(part(&Type::FLOAT, &Step::Index(0)).is_err());
    }
}
