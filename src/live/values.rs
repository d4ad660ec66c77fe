//! Values that the page gives to parameters.

use crate::check::Constant;
use crate::lang::types::{Base, Type};
use crate::scene::{Hints, Layer, ParamType, ParamValue, Values};
use serde_json::Value;

/// Numbers or a text, as a page sends them.
#[derive(Clone, Debug, PartialEq)]
pub enum Given {
    /// One number a component.
    Numbers(Vec<f64>),
    /// A text.
    Text(String),
}

impl Given {
    /// A list of finite numbers, at most sixteen of them, or a list of one text.
    pub fn of_json(value: &Value) -> Option<Given> {
        let list = value.as_array().filter(|list| (1..=16).contains(&list.len()))?;
        if let [Value::String(text)] = &list[..] {
            return Some(Given::Text(text.clone()));
        }
        let finite = |value: &Value| value.as_f64().filter(|x| x.is_finite());
        list.iter().map(finite).collect::<Option<Vec<f64>>>().map(Given::Numbers)
    }

    /// The value as JSON: a list.
    pub fn json(&self) -> Value {
        match self {
            Given::Numbers(numbers) => Value::from(numbers.clone()),
            Given::Text(text) => Value::from(vec![text.clone()]),
        }
    }

    /// The value as a scene would give it to a parameter of this type; nothing where it does not fit.
    pub fn param(&self, name: &str, ty: &Type, layer: &Layer) -> Option<ParamValue> {
        let kind = kind(ty)?;
        let values = match self {
            Given::Text(text) if kind == ParamType::String => Values::Strings(vec![text.clone()]),
            Given::Text(_) => return None,
            Given::Numbers(numbers) if kind == ParamType::String || numbers.len() != kind.components() => return None,
            Given::Numbers(numbers) if kind == ParamType::Int => Values::Ints(vec![numbers[0] as i32]),
            Given::Numbers(numbers) => Values::Floats(numbers.iter().map(|&x| x as f32).collect()),
        };
        let (name, place, hints) = (name.to_owned(), layer.place.clone(), Hints::default());
        Some(ParamValue { kind, array: None, name, values, hints, place })
    }

    /// The value as the command line takes it: numbers with commas between, or the text.
    pub fn text(&self) -> String {
        match self {
            Given::Numbers(numbers) => numbers.iter().map(|&x| (x as f32).to_string()).collect::<Vec<_>>().join(","),
            Given::Text(text) => text.clone(),
        }
    }

    /// The value of a constant; nothing for a triple in a named space.
    pub fn of_constants(constants: &[Constant]) -> Option<Given> {
        match constants {
            [Constant::String(text)] => Some(Given::Text(text.clone())),
            all => all.iter().map(Constant::number).collect::<Option<Vec<f64>>>().map(Given::Numbers),
        }
    }

    /// The value that a scene has written.
    pub fn of_values(values: &Values) -> Option<Given> {
        Some(match values {
            Values::Floats(values) => Given::Numbers(values.iter().map(|&x| f64::from(x)).collect()),
            Values::Ints(values) => Given::Numbers(values.iter().map(|&x| f64::from(x)).collect()),
            Values::Strings(values) => Given::Text(values.first()?.clone()),
        })
    }
}

/// The type that a page can show a control for; nothing for arrays, structs and closures.
pub fn kind(ty: &Type) -> Option<ParamType> {
    if ty.is_array() {
        return None;
    }
    Some(match ty.base()? {
        Base::Int => ParamType::Int,
        Base::Float => ParamType::Float,
        Base::Color => ParamType::Color,
        Base::Point => ParamType::Point,
        Base::Vector => ParamType::Vector,
        Base::Normal => ParamType::Normal,
        Base::Matrix => ParamType::Matrix,
        Base::String => ParamType::String,
        _ => return None,
    })
}
