//! Splines through or near knots, their slope, and the search for the place where one has a given value.

use super::arithmetic::div;
use std::array;

/// How the knots shape the curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Through all knots but the first and the last.
    CatmullRom,
    /// Cubic segments that share every third knot.
    Bezier,
    /// Smooth and near the knots.
    BSpline,
    /// Values and tangents in turns.
    Hermite,
    /// Straight between the knots; the first and the last are not used.
    Linear,
    /// The value of the knot to the left; the first and the last are not used.
    Constant,
}

impl Basis {
    /// The basis of this name; linear for unknown names, as in OSL.
    pub fn from_name(name: &str) -> Basis {
        match name {
            "catmull-rom" => Basis::CatmullRom,
            "bezier" => Basis::Bezier,
            "bspline" => Basis::BSpline,
            "hermite" => Basis::Hermite,
            "constant" => Basis::Constant,
            _ => Basis::Linear,
        }
    }

    /// Knots from one segment to the next.
    fn stride(self) -> usize {
        match self {
            Basis::Bezier => 3,
            Basis::Hermite => 2,
            _ => 1,
        }
    }

    /// Coefficients of t^3, t^2, t and 1 for the four knots of a segment.
    fn matrix(self) -> [[f32; 4]; 4] {
        const S: f32 = 1.0 / 6.0;
        match self {
            Basis::CatmullRom => {
                [[-0.5, 1.5, -1.5, 0.5], [1.0, -2.5, 2.0, -0.5], [-0.5, 0.0, 0.5, 0.0], [0.0, 1.0, 0.0, 0.0]]
            }
            Basis::Bezier => {
                [[-1.0, 3.0, -3.0, 1.0], [3.0, -6.0, 3.0, 0.0], [-3.0, 3.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]
            }
            Basis::BSpline => [[-S, 0.5, -0.5, S], [0.5, -1.0, 0.5, 0.0], [-0.5, 0.0, 0.5, 0.0], [S, 4.0 * S, S, 0.0]],
            Basis::Hermite => {
                [[2.0, 1.0, -2.0, 1.0], [-3.0, -2.0, 3.0, -1.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]
            }
            Basis::Linear => [[0.0; 4], [0.0; 4], [0.0, -1.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0]],
            Basis::Constant => [[0.0; 4], [0.0; 4], [0.0; 4], [0.0, 1.0, 0.0, 0.0]],
        }
    }
}

/// Where in the knots a parameter falls.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// The first of the four knots of the segment.
    first: usize,
    /// The place within the segment, in [0, 1].
    t: f32,
    /// Segments in all.
    segments: usize,
}

fn segments(basis: Basis, count: usize) -> usize {
    count.saturating_sub(4) / basis.stride() + 1
}

fn place(basis: Basis, x: f32, count: usize) -> Place {
    let segments = segments(basis, count);
    // NaN goes to the start.
    let x = if x > 0.0 { x } else { 0.0 };
    let x = if x > 1.0 { 1.0 } else { x };
    let scaled = x * segments as f32;
    let segment = (scaled as usize).min(segments - 1);
    Place { first: segment * basis.stride(), t: scaled - segment as f32, segments }
}

/// The coefficients of the cubic of one segment, highest power first.
fn cubic(basis: Basis, first: usize, count: usize, knot: impl Fn(usize) -> f32) -> [f32; 4] {
    // Fewer than four knots are a mistake that the checker reports; here the last one stands for those that are missing.
    let p: [f32; 4] = array::from_fn(|k| if count == 0 { 0.0 } else { knot((first + k).min(count - 1)) });
    basis.matrix().map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3] * p[3])
}

/// The spline through `count` knots at `x` in [0, 1]; `knot` gives one component of one knot.
///
/// Source: OSL. Domain: x is limited to [0, 1], at least four knots. It is linear in the knots, so its derivative is the
/// spline of the derivatives of the knots plus [`spline_slope`] times that of `x`.
pub fn spline(basis: Basis, x: f32, count: usize, knot: impl Fn(usize) -> f32) -> f32 {
    let place = place(basis, x, count);
    let [a, b, c, d] = cubic(basis, place.first, count, knot);
    ((a * place.t + b) * place.t + c) * place.t + d
}

/// The derivative of [`spline`] with respect to `x`; 0 outside [0, 1], where `x` is limited.
pub fn spline_slope(basis: Basis, x: f32, count: usize, knot: impl Fn(usize) -> f32) -> f32 {
    let place = place(basis, x, count);
    let [a, b, c, _] = cubic(basis, place.first, count, knot);
    let slope = ((3.0 * a * place.t + 2.0 * b) * place.t + c) * place.segments as f32;
    if (0.0..=1.0).contains(&x) { slope } else { 0.0 }
}

/// How [`spline`] changes when `x` changes by `dx` and the knots by `change`.
pub fn spline_change(
    basis: Basis,
    x: f32,
    count: usize,
    knot: impl Fn(usize) -> f32,
    dx: f32,
    change: impl Fn(usize) -> f32,
) -> f32 {
    spline_slope(basis, x, count, knot) * dx + spline(basis, x, count, change)
}

/// The `x` at which the spline through monotonic knots has the value `y`.
///
/// Source: OSL; within a segment, false position and then bisection. Domain: monotonic knots. Gives: [0, 1], to 1e-6.
/// Degenerate cases: an end of the interval for values beyond the knots; without knots 0. Departs from source: the Illinois
/// rule (Dowell and Jarratt 1971) keeps false position from stalling, where OSL's search ends far from the place.
pub fn splineinverse(basis: Basis, y: f32, count: usize, knot: impl Fn(usize) -> f32) -> f32 {
    if count < 4 {
        return 0.0;
    }
    let inner = usize::from(basis.stride() == 1);
    let (low, high) = (knot(inner), knot(count - 1 - inner));
    let increasing = knot(1) < knot(count - 2);
    if (increasing && y <= low) || (!increasing && y >= low) {
        return 0.0;
    }
    if (increasing && y >= high) || (!increasing && y <= high) {
        return 1.0;
    }
    // Monotonic knots can still give a curve that is not, so each segment is searched by itself.
    let inverse = 1.0 / segments(basis, count) as f32;
    let value = |x| spline(basis, x, count, &knot);
    let mut x = 0.0;
    for segment in 0..segments(basis, count) {
        let (found, at) = solve(value, y, inverse * segment as f32, inverse * (segment + 1) as f32);
        x = at;
        if found {
            break;
        }
    }
    x
}

/// How [`splineinverse`] changes, where it gave `x`, when the value changes by `dy` and the knots by `change`.
///
/// The spline at `x` keeps having the value: `S'(x) dx + S(x; change) = dy`. Degenerate cases: 0 at an end of the interval, where
/// values beyond the knots land, and where the spline is level.
pub fn splineinverse_change(
    basis: Basis,
    x: f32,
    count: usize,
    knot: impl Fn(usize) -> f32,
    dy: f32,
    change: impl Fn(usize) -> f32,
) -> f32 {
    if !(x > 0.0 && x < 1.0) {
        return 0.0;
    }
    div(dy - spline(basis, x, count, change), spline_slope(basis, x, count, knot))
}

/// Looks for `value(x) = y` in [low, high]; says whether the ends bracket `y`, and the place or the nearer end.
fn solve(value: impl Fn(f32) -> f32, y: f32, mut low: f32, mut high: f32) -> (bool, f32) {
    const STEPS: usize = 32;
    const CLOSE: f32 = 1e-6;
    let (mut at_low, mut at_high) = (value(low), value(high));
    let increasing = at_low < at_high;
    let (least, greatest) = if increasing { (at_low, at_high) } else { (at_high, at_low) };
    if !(least <= y && y <= greatest) {
        return (false, if (y < least) == increasing { low } else { high });
    }
    if (at_low - at_high).abs() < CLOSE {
        return (true, low);
    }
    let mut x = low;
    let mut moved_low = None;
    for step in 0..STEPS {
        let t = (y - at_low) / (at_high - at_low);
        // Should false position stall all the same, the last quarter of the steps halves the interval.
        let t = if step < STEPS * 3 / 4 && t > 0.0 && t < 1.0 { t } else { 0.5 };
        x = low * (1.0 - t) + high * t;
        let v = value(x);
        if (high - low).abs() < CLOSE || (v - y).abs() < CLOSE {
            break;
        }
        let move_low = (v < y) == increasing;
        // The end that stays for the second time pulls with half its weight: the Illinois rule.
        let weight = if moved_low == Some(move_low) { 0.5 } else { 1.0 };
        if move_low {
            (low, at_low, at_high) = (x, v, y + weight * (at_high - y));
        } else {
            (high, at_high, at_low) = (x, v, y + weight * (at_low - y));
        }
        moved_low = Some(move_low);
    }
    (true, x)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOTS: [f32; 7] = [0.0, 0.0, 0.2, 0.9, 1.0, 1.5, 2.0];
    const ALL: [&str; 6] = ["catmull-rom", "bezier", "bspline", "hermite", "linear", "constant"];

    fn at(basis: Basis, x: f32) -> f32 {
        spline(basis, x, 7, |k| KNOTS[k])
    }

    #[test]
    fn splines_pass_through_their_knots() {
        assert_eq!(at(Basis::CatmullRom, 0.0), 0.0);
        assert!((at(Basis::CatmullRom, 0.5) - 0.9).abs() < 1e-6);
        assert_eq!(at(Basis::CatmullRom, 1.0), 1.5);
        assert_eq!(at(Basis::Bezier, 0.5), 0.9);
        assert!((at(Basis::Bezier, 2.0) - 2.0).abs() < 1e-6);
        assert!((at(Basis::Linear, 0.125) - 0.1).abs() < 1e-6);
        assert_eq!(at(Basis::Constant, 0.3), 0.2);
        assert!((at(Basis::BSpline, 0.0) - 0.2 / 6.0).abs() < 1e-6);
        assert_eq!(at(Basis::Hermite, 0.0), 0.0);
    }

    #[test]
    fn slopes_are_those_of_the_values() {
        for basis in ALL.map(Basis::from_name) {
            for k in 1..40 {
                let x = k as f32 / 40.3;
                let difference = (at(basis, x + 1e-3) - at(basis, x - 1e-3)) / 2e-3;
                let slope = spline_slope(basis, x, 7, |k| KNOTS[k]);
                assert!(basis == Basis::Constant || (slope - difference).abs() < 0.02, "{basis:?} at {x}");
            }
            assert_eq!(spline_slope(basis, 1.5, 7, |k| KNOTS[k]), 0.0);
        }
    }

    #[test]
    fn inverse_finds_the_place() {
        for name in ["catmull-rom", "linear", "bspline", "bezier"] {
            let basis = Basis::from_name(name);
            for k in 1..20 {
                let x = k as f32 / 20.0;
                let y = at(basis, x);
                assert!((at(basis, splineinverse(basis, y, 7, |k| KNOTS[k])) - y).abs() < 1e-4, "{name} at {x}");
            }
        }
        assert_eq!(splineinverse(Basis::Linear, -1.0, 7, |k| KNOTS[k]), 0.0);
        assert_eq!(splineinverse(Basis::Linear, 9.0, 7, |k| KNOTS[k]), 1.0);
        assert_eq!(splineinverse(Basis::Linear, 0.5, 1, |_| 1.0), 0.0);
    }

    #[test]
    fn too_few_knots_do_no_harm() {
        for basis in ALL.map(Basis::from_name) {
            for count in 0..5 {
                let _ = spline(basis, 0.7, count, |k| KNOTS[k]);
                let _ = spline(basis, f32::NAN, count, |k| KNOTS[k]);
            }
        }
    }
}
