//! The functions that have derivatives by a rule of their own, and those derivatives, in one lane.

use super::lane::Lane;
use crate::ir::op::Smooth;
use crate::ops::color::{self, ColorSpace};
use crate::ops::color_slope::transformc_slope;
use crate::ops::matrix;
use crate::ops::spline::{self, Basis};

/// How many knots of a spline count: as many as asked for, and as there are.
fn counted(a: &Lane, knots: u32) -> usize {
    (a.i(2).max(0) as usize).min(knots as usize)
}

fn spaces(a: &Lane) -> Option<(ColorSpace, ColorSpace)> {
    Some((ColorSpace::from_name(a.s(0))?, ColorSpace::from_name(a.s(1))?))
}

/// The factor from one unit of length to another.
fn units(a: &Lane, length: f32) -> f32 {
    length * unit(a.s(0)) / unit(a.s(1))
}

/// The value of a function.
pub(super) fn value(function: Smooth, a: &Lane, out: &mut [f32; 16]) {
    let space = a.run.group.program.working_space;
    match function {
        Smooth::Spline(knots) => {
            out[0] = spline::spline(Basis::from_name(a.s(0)), a.f(1), counted(a, knots), |i| a.f(3 + i));
        }
        Smooth::SplineInverse(knots) => {
            out[0] = spline::splineinverse(Basis::from_name(a.s(0)), a.f(1), counted(a, knots), |i| a.f(3 + i));
        }
        Smooth::MatrixInverse => *out = matrix::inverse(&a.matrix(0)),
        Smooth::Determinant => out[0] = matrix::determinant(&a.matrix(0)),
        Smooth::Blackbody => out[..3].copy_from_slice(&color::blackbody(space, a.f(0))),
        Smooth::WavelengthColor => out[..3].copy_from_slice(&color::wavelength_color(space, a.f(0))),
        Smooth::TransformColor => {
            let moved = spaces(a).map_or(a.triple(2), |(from, to)| color::transformc(space, from, to, a.triple(2)));
            out[..3].copy_from_slice(&moved);
        }
        Smooth::TransformUnit => out[0] = units(a, a.f(2)),
    }
}

/// The change of a function's value: its arguments, its value and the changes of its arguments are the lane's arguments.
pub(super) fn change(function: Smooth, a: &Lane, out: &mut [f32; 16]) {
    let space = a.run.group.program.working_space;
    match function {
        Smooth::Spline(knots) => {
            let (basis, count, changes) = (Basis::from_name(a.s(0)), counted(a, knots), 4 + knots as usize);
            let (knot, change) = (|i| a.f(3 + i), |i| a.f(changes + 1 + i));
            out[0] = spline::spline_change(basis, a.f(1), count, knot, a.f(changes), change);
        }
        Smooth::SplineInverse(knots) => {
            let (basis, count, x) = (Basis::from_name(a.s(0)), counted(a, knots), 3 + knots as usize);
            let (knot, change) = (|i| a.f(3 + i), |i| a.f(x + 2 + i));
            out[0] = spline::splineinverse_change(basis, a.f(x), count, knot, a.f(x + 1), change);
        }
        Smooth::MatrixInverse => *out = matrix::inverse_change(&a.matrix(0), &a.matrix(16), &a.matrix(32)),
        Smooth::Determinant => out[0] = matrix::determinant_change(&a.matrix(0), &a.matrix(17)),
        Smooth::Blackbody => {
            out[..3].copy_from_slice(&color::blackbody_slope(space, a.f(0)).map(|slope| slope * a.f(4)))
        }
        Smooth::WavelengthColor => {
            out[..3].copy_from_slice(&color::wavelength_color_slope(space, a.f(0)).map(|slope| slope * a.f(4)));
        }
        Smooth::TransformColor => {
            let (color, change) = (a.triple(2), a.triple(8));
            let moved = spaces(a).map_or(change, |(from, to)| transformc_slope(space, from, to, color, change));
            out[..3].copy_from_slice(&moved);
        }
        Smooth::TransformUnit => out[0] = units(a, a.f(4)),
    }
}

/// Length of a unit in metres; common space is in metres, unknown units count as common.
fn unit(name: &str) -> f32 {
    match name {
        "mm" => 1e-3,
        "cm" => 1e-2,
        "km" => 1e3,
        "in" => 0.0254,
        "ft" => 0.3048,
        "mi" => 1609.344,
        _ => 1.0,
    }
}
