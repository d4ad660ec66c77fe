//! The shader globals: the variables every shader sees without declaring them.

use super::types::{Base, Type};

/// A shader global.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Global {
    /// `P`: the point being shaded, common space.
    P,
    /// `I`: the direction of view, from the eye to `P`.
    I,
    /// `N`: the shading normal, unit length.
    N,
    /// `Ng`: the true normal, unit length.
    Ng,
    /// `u`: first surface parameter.
    U,
    /// `v`: second surface parameter.
    V,
    /// `dPdu`: derivative of `P` along `u`.
    DPdu,
    /// `dPdv`: derivative of `P` along `v`.
    DPdv,
    /// `Ps`: the point whose light is computed (equal to `P` here).
    Ps,
    /// `time`: the time of the sample.
    Time,
    /// `dtime`: the length of the shutter interval.
    Dtime,
    /// `dPdtime`: how fast `P` moves.
    DPdtime,
    /// `Ci`: the closure the shader computes.
    Ci,
}

/// All globals with name, type, and whether a shader may assign them.
pub const GLOBALS: &[(&str, Global, Base, bool)] = &[
    ("P", Global::P, Base::Point, true),
    ("I", Global::I, Base::Vector, true),
    ("N", Global::N, Base::Normal, true),
    ("Ng", Global::Ng, Base::Normal, false),
    ("u", Global::U, Base::Float, false),
    ("v", Global::V, Base::Float, false),
    ("dPdu", Global::DPdu, Base::Vector, false),
    ("dPdv", Global::DPdv, Base::Vector, false),
    ("Ps", Global::Ps, Base::Point, false),
    ("time", Global::Time, Base::Float, false),
    ("dtime", Global::Dtime, Base::Float, false),
    ("dPdtime", Global::DPdtime, Base::Vector, false),
    ("Ci", Global::Ci, Base::Closure, true),
];

impl Global {
    /// The type of the global.
    pub fn ty(self) -> Type {
        let entry = GLOBALS.iter().find(|entry| entry.1 == self);
        Type::of(entry.map_or(Base::Void, |entry| entry.2))
    }

    /// The name of the global.
    pub fn name(self) -> &'static str {
        GLOBALS.iter().find(|entry| entry.1 == self).map_or("", |entry| entry.0)
    }
}
