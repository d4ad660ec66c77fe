//! Arguments of a leaf: a struct with a field each, whose declaration is the closure's signature as well.
//!
//! [`arguments!`](crate::arguments) makes both at once, so an argument is read by its name, a wrong name does not compile, and its
//! place is counted by the compiler.

use super::tree::{Floats, Ints, Keyword, NodeId, Param, Tree};
use super::words::Words;
use crate::lang::closures::{ParamKind, ParamSpec};

/// Declares the arguments of a closure: a struct with a field for each, and from the same list its signature.
///
/// Fields are of the types of [`crate::closure::arguments`]; what follows `=` is their documentation, with the values that
/// `velour verify` tries. Keyword arguments become options.
///
/// ```
/// use velour::closure::{Color, Float, Normal, Int, ReadArguments};
/// use velour::lang::closures::ParamSpec;
///
/// velour::arguments! {
///     /// The arguments of `dusty(N, albedo, amount, "bounded", 1)`.
///     struct Dusty {
///         N: Normal = ParamSpec::about("shading normal, unit length"),
///         albedo: Color = ParamSpec::about("color of the reflection, 0..1"),
///         amount: Float = ParamSpec::about("how much dust there is, 0..1").tried(&[0.5, 0.0, 1.0]),
///     }
///     keywords {
///         bounded: Int = ParamSpec::about("1 (default) keeps energy").tried(&[1.0, 0.0]),
///     }
/// }
/// let names: Vec<&str> = Dusty::params().iter().map(|param| param.name).collect();
/// assert_eq!(names, ["N", "albedo", "amount"]);
/// assert_eq!(Dusty::keywords()[0].name, "bounded");
/// ```
///
/// An argument that was not declared is no field:
///
/// ```compile_fail,E0609
/// velour::arguments! {
///     struct Plain {
///         exponent: velour::closure::Float = velour::lang::closures::ParamSpec::about("power of the cosine"),
///     }
/// }
/// fn read(plain: Plain) -> velour::closure::Float {
///     plain.exponnet
/// }
/// ```
#[macro_export]
macro_rules! arguments {
    (
        $(#[$meta:meta])*
        $vis:vis struct $Name:ident { $($field:ident : $Type:ty = $about:expr),* $(,)? }
        $(keywords { $($word:ident : $Word:ty = $tells:expr),* $(,)? })?
    ) => {
        $(#[$meta])*
        #[allow(non_snake_case, missing_docs, dead_code)]
        #[derive(Clone, Copy, Debug)]
        $vis struct $Name {
            $($vis $field: $Type,)*
            $($($vis $word: Option<$Word>,)*)?
        }

        impl $crate::closure::ReadArguments for $Name {
            fn params() -> Vec<$crate::lang::closures::ParamSpec> {
                vec![$($crate::closure::arguments::declared::<$Type>(stringify!($field), $about)),*]
            }

            fn keywords() -> Vec<$crate::lang::closures::ParamSpec> {
                vec![$($($crate::closure::arguments::declared::<$Word>(stringify!($word), $tells)),*)?]
            }

            #[allow(unused_variables, unused_mut)]
            fn read(arguments: &$crate::closure::Arguments<'_>) -> Self {
                // The fields are filled in the order they are declared in, which is that of the signature.
                let (mut param, mut keyword) = (0, 0);
                $Name {
                    $($field: arguments.param(&mut param),)*
                    $($($word: arguments.keyword(&mut keyword),)*)?
                }
            }
        }
    };
}

/// The arguments of a closure; [`arguments!`](crate::arguments) implements it.
pub trait ReadArguments: Sized {
    /// The positional parameters, in order.
    fn params() -> Vec<ParamSpec>;
    /// The keyword parameters, in order.
    fn keywords() -> Vec<ParamSpec>;
    /// The values of a leaf.
    fn read(arguments: &Arguments<'_>) -> Self;
}

/// What a leaf of the tree was given.
#[derive(Clone, Copy, Debug)]
pub struct Arguments<'a> {
    tree: &'a Tree,
    params: &'a [Param],
    keywords: &'a [Keyword],
}

impl<'a> Arguments<'a> {
    /// Those of a leaf of this tree.
    pub(super) fn new(tree: &'a Tree, params: &'a [Param], keywords: &'a [Keyword]) -> Self {
        Arguments { tree, params, keywords }
    }

    /// The positional argument at an index, which is counted on.
    pub fn param<T: Argument>(&self, index: &mut usize) -> T {
        let param = self.params.get(*index).copied();
        *index += 1;
        T::of(param, self.tree)
    }

    /// The keyword argument at an index, which is counted on; the last one given of a name counts.
    pub fn keyword<T: Argument>(&self, index: &mut u32) -> Option<T> {
        let given = self.keywords.iter().rev().find(|(at, _)| at == index);
        *index += 1;
        given.map(|&(_, param)| T::of(Some(param), self.tree))
    }
}

/// Something an argument can be.
pub trait Argument: Copy {
    /// Its type in the language.
    const KIND: ParamKind;
    /// The words it may be, the default first.
    fn choices() -> Vec<&'static str> {
        Vec::new()
    }
    /// Its value; zero, or nothing, where it is missing.
    fn of(param: Option<Param>, tree: &Tree) -> Self;
    /// May it differ between lanes?
    fn varies(&self) -> bool;
}

/// The spec of a parameter of a type under its name.
pub fn declared<T: Argument>(name: &'static str, about: ParamSpec) -> ParamSpec {
    ParamSpec { name, kind: T::KIND, choices: T::choices(), ..about }
}

/// A float argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Float(pub Floats);

/// An integer argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Int(pub Ints);

/// A string argument that means nothing to velour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Text(pub Ints);

/// A color argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color(pub [Floats; 3]);

/// A vector argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector(pub [Floats; 3]);

/// A normal argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normal(pub [Floats; 3]);

/// A closure argument; nothing for `0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nested(pub(super) Option<NodeId>);

/// A string argument that chooses a value of an enum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Word<E> {
    /// The same in every lane; nothing where the string is no word of the enum.
    Same(Option<E>),
    /// One a lane, as symbols.
    Each(Ints),
}

impl<E: Words> Word<E> {
    /// The value in a lane; nothing where the string is no word of the enum.
    pub fn at(&self, tree: &Tree, lane: usize) -> Option<E> {
        match *self {
            Word::Same(value) => value,
            Word::Each(column) => E::parse(tree.text(column, lane)),
        }
    }
}

/// Do any of these floats differ between lanes?
pub fn floats_vary(values: &[Floats]) -> bool {
    values.iter().any(|value| matches!(value, Floats::Varying(_)))
}

impl Argument for Float {
    const KIND: ParamKind = ParamKind::Float;

    fn of(param: Option<Param>, _: &Tree) -> Self {
        Float(if let Some(Param::Float(value)) = param { value } else { Floats::Uniform(0.0) })
    }

    fn varies(&self) -> bool {
        floats_vary(&[self.0])
    }
}

impl Argument for Int {
    const KIND: ParamKind = ParamKind::Int;

    fn of(param: Option<Param>, _: &Tree) -> Self {
        Int(if let Some(Param::Int(value)) = param { value } else { Ints::Uniform(0) })
    }

    fn varies(&self) -> bool {
        matches!(self.0, Ints::Varying(_))
    }
}

impl Argument for Text {
    const KIND: ParamKind = ParamKind::String;

    fn of(param: Option<Param>, _: &Tree) -> Self {
        Text(if let Some(Param::String(value)) = param { value } else { Ints::Uniform(0) })
    }

    fn varies(&self) -> bool {
        matches!(self.0, Ints::Varying(_))
    }
}

/// The three types of triples, which differ in the language only.
macro_rules! triples {
    ($($Type:ident)*) => {
        $(impl Argument for $Type {
            const KIND: ParamKind = ParamKind::$Type;

            fn of(param: Option<Param>, _: &Tree) -> Self {
                $Type(if let Some(Param::Triple(value)) = param { value } else { [Floats::Uniform(0.0); 3] })
            }

            fn varies(&self) -> bool {
                floats_vary(&self.0)
            }
        })*
    };
}

triples!(Color Vector Normal);

impl Argument for Nested {
    const KIND: ParamKind = ParamKind::Closure;

    fn of(param: Option<Param>, _: &Tree) -> Self {
        Nested(if let Some(Param::Closure(value)) = param { value } else { None })
    }

    fn varies(&self) -> bool {
        false
    }
}

impl<E: Words> Argument for Word<E> {
    const KIND: ParamKind = ParamKind::String;

    fn choices() -> Vec<&'static str> {
        E::ALL.iter().map(|(word, _)| *word).collect()
    }

    fn of(param: Option<Param>, tree: &Tree) -> Self {
        match param {
            Some(Param::String(column @ Ints::Uniform(_))) => Word::Same(E::parse(tree.text(column, 0))),
            Some(Param::String(column)) => Word::Each(column),
            _ => Word::Same(None),
        }
    }

    fn varies(&self) -> bool {
        matches!(self, Word::Each(_))
    }
}

impl<T: Argument> Argument for Option<T> {
    const KIND: ParamKind = T::KIND;

    fn of(param: Option<Param>, tree: &Tree) -> Self {
        param.map(|_| T::of(param, tree))
    }

    fn varies(&self) -> bool {
        self.is_some_and(|value| value.varies())
    }
}
