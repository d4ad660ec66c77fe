//! What instructions cost, so that a budget is a time: in simple instructions over a whole batch, some 50 ns.
//!
//! The figures are measured on an AMD EPYC with AVX2 and rounded up; a factor of three more or less is no matter here.

use crate::ir::op::{Noise, NoiseKind, Routine, Smooth, Unary};

/// Lanes of an elementary function that cost as much as a simple instruction.
pub(super) const LANES_A_FUNCTION: u64 = 32;

/// The same for powers and quotients' remainders.
pub(super) const LANES_A_POWER: u64 = 12;

/// The same for elements of arrays that are chosen lane by lane.
pub(super) const LANES_AN_ELEMENT: u64 = 48;

/// Bytes of text that are read or made in the time of a simple instruction.
pub(super) const BYTES: u64 = 64;

/// Parts of a simple instruction that the cost of routines is given in.
pub(super) const PARTS: u64 = 64;

/// Is it more than a few multiplications?
#[inline(always)]
pub(super) fn is_costly(op: Unary) -> bool {
    !matches!(
        op,
        Unary::Neg | Unary::Abs | Unary::Sqrt | Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc | Unary::Sign
    )
}

/// The cost of a routine in one lane, in [`PARTS`], without that of its texts.
pub(super) fn of(routine: &Routine) -> u64 {
    match routine {
        Routine::Noise(noise) => of_noise(noise),
        Routine::Smooth(function) | Routine::Slope(function) => match function {
            Smooth::Spline(_) => 100,
            // Found by bisection.
            Smooth::SplineInverse(knots) => 200 + 400 * u64::from(*knots),
            Smooth::MatrixInverse | Smooth::Determinant => 100,
            Smooth::Blackbody | Smooth::WavelengthColor | Smooth::TransformColor | Smooth::TransformUnit => 300,
        },
        Routine::SpaceMatrix => 100,
        Routine::ClampIndex { .. } | Routine::RayType => 2,
        Routine::CheckFinite(watch) => 2 * u64::from(watch.count),
        Routine::HashInt | Routine::HashFloats(_) | Routine::Random(_) => 16,
        Routine::HashString | Routine::Strlen | Routine::GetChar | Routine::StartsWith | Routine::EndsWith => 50,
        Routine::Substr | Routine::Concat | Routine::Stof | Routine::Stoi => 150,
        Routine::Regex { .. } => 1500,
        Routine::Split(parts) => 150 + 60 * u64::from(*parts),
        Routine::Format(format) | Routine::Print(_, format) => 400 + 200 * format.args.len() as u64,
        Routine::Attribute(_) | Routine::SetMessage(_) | Routine::GetMessage(_) => 100,
        Routine::Trace => 2000,
        Routine::DictFind | Routine::DictFindBelow | Routine::DictNext | Routine::DictValue(_) => 1000,
        Routine::Texture(_) => 300,
        Routine::TextureInfo(_) => 200,
    }
}

fn of_noise(noise: &Noise) -> u64 {
    let one = match noise.kind {
        NoiseKind::Gabor => 2500,
        NoiseKind::Cell | NoiseKind::Hash => 8,
        _ => 20,
    };
    one * u64::from(noise.outputs.max(1)) * if noise.gradient || noise.filtered { 2 } else { 1 }
}
