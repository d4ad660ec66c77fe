//! Clusters of lights: what bounds them, what it costs to ask them as one, and how they are cut.
//!
//! Source: A. Conty Estevez and C. Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018. Light leaves
//! both sides of a surface here, so cones are about lines.

use crate::math::elementary::{acos, cos, sincos};
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// Parts that a cluster is cut into.
pub const WAYS: usize = 8;

/// Slots along each axis where a cluster may be cut.
const CUTS: usize = 12;

/// Clusters of more lights are cut along their longest side.
const FEW: usize = 1024;

/// What is known of a light or a cluster of lights.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// The corners of the box.
    pub low: Vec3,
    /// The corners of the box.
    pub high: Vec3,
    /// The line about which the normals lie, a unit vector of either sign.
    pub axis: Vec3,
    /// The cosine of the greatest angle between the line and a normal; 0 is all around.
    pub cos_cone: f32,
    /// Radiant power, to within a factor that is the same for all.
    pub power: f32,
}

impl Bounds {
    const NOTHING: Bounds =
        Bounds { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY, axis: Vec3::ZERO, cos_cone: 1.0, power: 0.0 };

    /// The bounds of both.
    fn with(&self, other: &Bounds) -> Bounds {
        let (low, high) = (self.low.min(other.low), self.high.max(other.high));
        let (axis, cos_cone) = cone_of_both((self.axis, self.cos_cone), (other.axis, other.cos_cone));
        Bounds { low, high, axis, cos_cone, power: self.power + other.power }
    }

    fn center(&self) -> Vec3 {
        0.5 * (self.low + self.high)
    }
}

/// A cluster as far as its cost is about it.
#[derive(Clone, Copy, Debug)]
struct Rough {
    low: Vec3,
    high: Vec3,
    /// The sum of the axes times power, each of the sign that makes it longer.
    axes: Vec3,
    power: f32,
}

impl Rough {
    const NOTHING: Rough = Rough { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY, axes: Vec3::ZERO, power: 0.0 };

    /// The cluster with one more light.
    fn with_light(&self, light: &Bounds) -> Rough {
        // A ball has no axis that would be worth keeping.
        let axis = light.axis * (light.power * light.cos_cone);
        let other = Rough { low: light.low, high: light.high, axes: axis, power: light.power };
        self.with(&other)
    }

    fn with(&self, other: &Rough) -> Rough {
        let along = if self.axes.dot(other.axes) < 0.0 { -other.axes } else { other.axes };
        Rough {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            axes: self.axes + along,
            power: self.power + other.power,
        }
    }

    /// What it costs to have these lights in one cluster.
    ///
    /// Source: Conty and Kulla 2018, eq. 1: power times area times the measure of the directions, which goes from pi where
    /// all lie in planes to 2 pi + pi^2 / 2 where they shine all around. Departs from source: between the two it goes by the
    /// length of the mean axis, because that takes no arc cosine a light.
    fn cost(&self) -> f32 {
        if self.power <= 0.0 {
            return 0.0;
        }
        let unlike = 1.0 - self.axes.length() / self.power;
        let size = self.high - self.low;
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        self.power * area * (PI + unlike * (PI + 0.5 * PI * PI))
    }
}

/// The narrowest cone about a line around two, as far as that is easy to say.
fn cone_of_both(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    if a.0 == Vec3::ZERO || b.0 == Vec3::ZERO {
        return if a.0 == Vec3::ZERO { b } else { a };
    }
    let (a, b) = if a.1 <= b.1 { (a, b) } else { (b, a) };
    let cos_between = a.0.dot(b.0).abs();
    // Most clusters of many lights are of one plane, or shine all around.
    if a.1 <= 0.0 || cos_between >= 1.0 - 1e-6 && a.1 >= 1.0 - 1e-6 {
        return a;
    }
    let [wide, narrow] = [a.1, b.1].map(|c| acos(c.clamp(0.0, 1.0)));
    // A line has no sign.
    let toward = if a.0.dot(b.0) < 0.0 { -b.0 } else { b.0 };
    let between = acos(cos_between.min(1.0));
    if between + narrow <= wide {
        return a;
    }
    let half = 0.5 * (wide + between + narrow);
    let side = (toward - a.0 * a.0.dot(toward)).normalize_or_zero();
    if half >= FRAC_PI_2 || side == Vec3::ZERO {
        return (a.0, 0.0);
    }
    let (sin_turn, cos_turn) = sincos(half - wide);
    let axis = (a.0 * cos_turn + side * sin_turn).normalize_or(a.0);
    // A little wider, for rounding.
    (axis, (cos(half) - 1e-6).max(0.0))
}

/// The bounds of some lights.
pub fn around(lights: &[Bounds], order: &[u32]) -> Bounds {
    order.iter().fold(Bounds::NOTHING, |all, i| all.with(&lights[*i as usize]))
}

/// Cuts lights into up to eight parts: again and again the one that costs most.
pub fn parts<'o>(lights: &[Bounds], order: &'o mut [u32]) -> Vec<&'o mut [u32]> {
    let mut parts = vec![(0.0f32, order)];
    while parts.len() < WAYS {
        let worst =
            (0..parts.len()).filter(|k| parts[*k].1.len() > 1).max_by(|a, b| parts[*a].0.total_cmp(&parts[*b].0));
        let Some(worst) = worst else { break };
        let (_, part) = parts.swap_remove(worst);
        let (at, costs) = cut(lights, part);
        let (left, right) = part.split_at_mut(at);
        parts.extend([(costs[0], left), (costs[1], right)]);
    }
    parts.into_iter().map(|(_, part)| part).collect()
}

/// Where a cluster is cut: an axis, the first slot of the second part, and what both cost.
struct Cut {
    axis: usize,
    at: usize,
    costs: [f32; 2],
}

/// Sorts lights into two parts where the two cost least together; gives where the second begins, which is neither end, and what
/// each costs.
fn cut(lights: &[Bounds], order: &mut [u32]) -> (usize, [f32; 2]) {
    let centers = order.iter().map(|i| lights[*i as usize].center());
    let (low, high) = centers.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), c| (l.min(c), h.max(c)));
    let scale = CUTS as f32 / (high - low);
    let slot =
        |axis: usize, i: u32| (((lights[i as usize].center()[axis] - low[axis]) * scale[axis]) as usize).min(CUTS - 1);
    // Of many lights the longest side alone is looked at: they will be cut often enough.
    let longest = (high - low).max_position();
    let axes = (0..3).filter(|axis| if order.len() > FEW { *axis == longest } else { high[*axis] > low[*axis] });
    let best = axes.filter_map(|axis| best_along(lights, order, axis, &slot)).min_by(|a, b| {
        // Long sides first: thin slices are no good clusters.
        let weighed = |cut: &Cut| (cut.costs[0] + cut.costs[1]) * scale[cut.axis] / scale[longest];
        weighed(a).total_cmp(&weighed(b))
    });
    if let Some(Cut { axis, at, costs }) = best {
        let mut first = 0;
        for k in 0..order.len() {
            if slot(axis, order[k]) < at {
                order.swap(first, k);
                first += 1;
            }
        }
        if first > 0 && first < order.len() {
            return (first, costs);
        }
    }
    // Lights in one place, or nowhere: any half will do.
    (order.len() / 2, [1.0, 1.0])
}

/// The best cut along one axis, where `slot` says in which slot a light lies.
fn best_along(lights: &[Bounds], order: &[u32], axis: usize, slot: &dyn Fn(usize, u32) -> usize) -> Option<Cut> {
    let mut slots = [Rough::NOTHING; CUTS];
    for i in order {
        let own = &mut slots[slot(axis, *i)];
        *own = own.with_light(&lights[*i as usize]);
    }
    let cut = |at: usize| {
        let sides = [&slots[..at], &slots[at..]].map(|side| side.iter().fold(Rough::NOTHING, |all, b| all.with(b)));
        let costs = sides.map(|side| side.cost());
        sides.iter().all(|side| side.power > 0.0).then_some(Cut { axis, at, costs })
    };
    (1..CUTS).filter_map(cut).min_by(|a, b| (a.costs[0] + a.costs[1]).total_cmp(&(b.costs[0] + b.costs[1])))
}
