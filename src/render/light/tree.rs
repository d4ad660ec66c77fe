//! A hierarchy of lights: which light a point asks, by how much each may bring there.
//!
//! Source: A. Conty Estevez and C. Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018: the cost
//! of a cluster, its bounds, and what it may bring. Light leaves both sides of a surface here, so cones are about lines.
//!
//! Decision (2026-11-29): a node has eight children, whose importances are found side by side, because that is one step of SIMD
//! where a binary tree takes seven one after the other, and the choice among eight is by their own bounds; instead of
//! pairs.

use super::bounds::{Bounds, WAYS, around, parts};
use crate::lanes;
use crate::render::block::{Row, Row3, WIDTH, get};
use glam::Vec3;

/// Marks the number of a light.
const LIGHT: u32 = 1 << 31;

/// A place in the tree that is empty; no light has that number.
const EMPTY: u32 = LIGHT - 1;

/// No light, and no parent.
pub const NONE: u32 = u32::MAX;

/// What is added to the cosine at a surface that does not face away altogether: grazing lobes bring more than it says.
const GRAZING: f32 = 0.05;

/// Eight children side by side; those that are not there have no power.
#[derive(Clone, Debug)]
struct Node {
    center: [[f32; WAYS]; 3],
    /// The square of the radius of the ball around the box.
    radius2: [f32; WAYS],
    axis: [[f32; WAYS]; 3],
    cos_cone: [f32; WAYS],
    sin_cone: [f32; WAYS],
    power: [f32; WAYS],
    /// Numbers of nodes, or of lights with their mark.
    children: [u32; WAYS],
    /// The node above, and which child of it this one is.
    home: [u32; 2],
}

/// Who asks for lights: a few points.
#[derive(Clone, Debug)]
pub struct Asking {
    /// The points.
    pub p: Row3,
    /// Their normals.
    pub n: Row3,
    /// The flat lights that they lie on, by [`marked`].
    pub own: [u32; WIDTH],
    /// How many there are.
    pub len: usize,
}

/// The number of a light as a child of the tree; `NONE` stays.
#[inline(always)]
pub fn marked(light: u32) -> u32 {
    light | LIGHT
}

/// The hierarchy.
#[derive(Clone, Debug, Default)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// By light, its node and which child of it it is.
    homes: Vec<[u32; 2]>,
}

impl LightTree {
    /// A tree over lights, by their bounds.
    pub fn new(lights: &[Bounds]) -> Self {
        let mut tree = LightTree { nodes: Vec::new(), homes: vec![[NONE; 2]; lights.len()] };
        let mut order: Vec<u32> = (0..lights.len() as u32).collect();
        if !order.is_empty() {
            tree.grow(lights, &mut order, [NONE; 2]);
        }
        tree
    }

    /// Makes the node of some lights, at `home`, with all below it; gives its number.
    fn grow(&mut self, lights: &[Bounds], order: &mut [u32], home: [u32; 2]) -> u32 {
        let number = self.nodes.len() as u32;
        self.nodes.push(Node::empty(home));
        for (slot, part) in parts(lights, order).into_iter().enumerate() {
            let bounds = around(lights, part);
            let place = [number, slot as u32];
            let child = match part {
                [light] => {
                    self.homes[*light as usize] = place;
                    *light | LIGHT
                }
                _ => self.grow(lights, part, place),
            };
            self.nodes[number as usize].set(slot, &bounds, child);
        }
        number
    }

    /// The probability with which `choose` gives a light at `p` with normal `n`, which lies on the light `own`.
    pub fn probability(&self, light: u32, p: Vec3, n: Vec3, own: u32) -> f32 {
        let mut probability = 1.0;
        let mut home = self.homes.get(light as usize).copied().unwrap_or([NONE; 2]);
        while let Some(node) = self.nodes.get(home[0] as usize) {
            let importance = node.importance(p, n, own);
            let sum: f32 = sum(&importance);
            if !(sum > 0.0 && sum < f32::INFINITY) {
                return 0.0;
            }
            probability *= importance[home[1] as usize] / sum;
            home = node.home;
        }
        probability
    }
}

lanes! {
    /// Chooses a light for each of a few lanes, by two numbers in [0, 1), the second of which only refines the first. A lane
    /// whose normal is nothing is reached from all around. Gives lights and their probabilities; `NONE` and 0 where
    /// nothing reaches.
    pub fn choose(
        tree: &LightTree,
        asking: &Asking,
        numbers: &[Row; 2],
        out: &mut [u32; WIDTH],
        probability: &mut Row,
    ) {
        for lane in 0..asking.len {
            let (p, n, own) = (get(&asking.p, lane), get(&asking.n, lane), asking.own[lane]);
            // Numbers are multiples of 2^-23, which is too coarse for a million lights.
            let mut x = f64::from(numbers[0][lane]) + f64::from(numbers[1][lane]) / 8_388_608.0;
            (out[lane], probability[lane]) = (NONE, 0.0);
            let (mut at, mut chance) = (0u32, 1.0f32);
            while let Some(node) = tree.nodes.get(at as usize) {
                let importance = node.importance(p, n, own);
                let sum: f32 = sum(&importance);
                if !(sum > 0.0 && sum < f32::INFINITY) {
                    break;
                }
                let (slot, rest) = pick(&importance, sum, x);
                chance *= importance[slot] / sum;
                x = rest;
                at = node.children[slot];
                if at & LIGHT != 0 {
                    (out[lane], probability[lane]) = (at ^ LIGHT, chance);
                    break;
                }
            }
        }
    }
}

#[inline(always)]
fn sum(importance: &[f32; WAYS]) -> f32 {
    let [a, b, c, d, e, f, g, h] = *importance;
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

/// Chooses among children with `x` in [0, 1), and makes a new number of what is left of it.
#[inline(always)]
fn pick(importance: &[f32; WAYS], sum: f32, x: f64) -> (usize, f64) {
    let target = x * f64::from(sum);
    let shares = importance.map(f64::from);
    // What lies before each child, with few sums one after the other.
    let pairs = [shares[0] + shares[1], shares[2] + shares[3], shares[4] + shares[5]];
    let half = pairs[0] + pairs[1];
    let third = half + pairs[2];
    let before = [0.0, shares[0], pairs[0], pairs[0] + shares[2], half, half + shares[4], third, third + shares[6]];
    // The last child that has a share and begins at or below the target.
    let mut slot = 0;
    for k in 0..WAYS {
        slot = if (shares[k] > 0.0) & (before[k] <= target) { k } else { slot };
    }
    (slot, ((target - before[slot]) / shares[slot]).clamp(0.0, 1.0 - f64::EPSILON))
}

impl Node {
    fn empty(home: [u32; 2]) -> Self {
        let (row, rows) = ([0.0; WAYS], [[0.0; WAYS]; 3]);
        Node {
            center: rows,
            radius2: [1.0; WAYS],
            axis: rows,
            cos_cone: row,
            sin_cone: [1.0; WAYS],
            power: row,
            children: [EMPTY; WAYS],
            home,
        }
    }

    fn set(&mut self, slot: usize, bounds: &Bounds, child: u32) {
        let center = 0.5 * (bounds.low + bounds.high);
        for k in 0..3 {
            self.center[k][slot] = center[k];
            self.axis[k][slot] = bounds.axis[k];
        }
        self.radius2[slot] = (bounds.high - center).length_squared().max(f32::MIN_POSITIVE);
        self.cos_cone[slot] = bounds.cos_cone;
        self.sin_cone[slot] = (1.0 - bounds.cos_cone * bounds.cos_cone).max(0.0).sqrt();
        self.power[slot] = bounds.power;
        self.children[slot] = child;
    }

    /// How much each child may bring to `p`, whose normal is `n`; nothing for a normal says that light counts from all
    /// around. The light `own`, with its mark, brings nothing.
    ///
    /// Source: Conty and Kulla 2018, eq. 3, with the distance bounded by the ball's radius; sines and cosines of
    /// differences of angles instead of angles.
    #[inline(always)]
    fn importance(&self, p: Vec3, n: Vec3, own: u32) -> [f32; WAYS] {
        let faces = n != Vec3::ZERO;
        let mut out = [0.0; WAYS];
        for k in 0..WAYS {
            let to = Vec3::new(self.center[0][k], self.center[1][k], self.center[2][k]) - p;
            let d2 = to.length_squared();
            let radius2 = self.radius2[k];
            let outside = d2 > radius2;
            let inverse = if outside { 1.0 / d2.sqrt() } else { 1.0 };
            // The ball as seen from the point.
            let sin2_ball = radius2 * inverse * inverse;
            let (sin_ball, cos_ball) = (sin2_ball.sqrt(), (1.0 - sin2_ball).max(0.0).sqrt());
            let axis = Vec3::new(self.axis[0][k], self.axis[1][k], self.axis[2][k]);
            let along = to.dot(axis).abs() * inverse;
            let (cos, sin) = less([along, sine(along)], [self.cos_cone[k], self.sin_cone[k]]);
            let (leaving, _) = less([cos, sin], [cos_ball, sin_ball]);
            let up = to.dot(n) * inverse;
            let (arriving, _) = less([up, sine(up)], [cos_ball, sin_ball]);
            let arriving = if arriving > 0.0 { arriving + GRAZING } else { 0.0 };
            let arriving = if faces { arriving } else { 1.0 };
            let cosines = if outside { leaving * arriving } else { 1.0 };
            let importance = self.power[k] * cosines / d2.max(radius2);
            out[k] = if self.children[k] == own { 0.0 } else { importance };
        }
        out
    }
}

#[inline(always)]
fn sine(cos: f32) -> f32 {
    (1.0 - cos * cos).max(0.0).sqrt()
}

/// Cosine and sine of an angle less another one, but not below 0, both given by cosine and sine.
#[inline(always)]
fn less([cos, sin]: [f32; 2], [cos_by, sin_by]: [f32; 2]) -> (f32, f32) {
    let within = cos >= cos_by;
    (if within { 1.0 } else { cos * cos_by + sin * sin_by }, if within { 0.0 } else { sin * cos_by - cos * sin_by })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{counts, random};

    fn number(i: u32, k: u32) -> f32 {
        random::sample(random::pixel_seed(21, i, k), 0, 0)[0]
    }

    fn vector(i: u32, k: u32) -> Vec3 {
        Vec3::new(number(i, k), number(i, k + 1), number(i, k + 2)) * 2.0 - 1.0
    }

    /// Triangles and balls of all sizes, scattered in a box, or all in one place.
    fn lights(count: u32, spread: f32) -> Vec<Bounds> {
        let light = |i: u32| {
            let (center, size) = (spread * vector(i, 0), 0.3 * number(i, 3));
            let (b, c) = (size * vector(i, 4), size * vector(i, 7));
            let corners = [center, center + b, center + c];
            let low = corners.into_iter().fold(Vec3::INFINITY, Vec3::min);
            let high = corners.into_iter().fold(Vec3::NEG_INFINITY, Vec3::max);
            let cos_cone = if i.is_multiple_of(7) { 0.0 } else { 1.0 };
            Bounds { low, high, axis: b.cross(c).normalize_or(Vec3::Y), cos_cone, power: 0.05 + number(i, 10) }
        };
        (0..count).map(light).collect()
    }

    /// Scenes of different sizes, each seen from inside and outside, with and without a normal.
    fn scenes() -> impl Iterator<Item = (LightTree, usize, Vec3, Vec3)> {
        let sizes = [(3, 5.0), (8, 5.0), (9, 0.0), (100, 5.0), (1000, 5.0), (1500, 0.0)];
        sizes.into_iter().flat_map(|(count, spread)| {
            let tree = LightTree::new(&lights(count, spread));
            (0..4).map(move |k| {
                let p = vector(k, 20) * if k < 2 { 4.0 } else { 20.0 };
                let n = if k % 2 == 0 { Vec3::ZERO } else { vector(k, 30).normalize() };
                (tree.clone(), count as usize, p, n)
            })
        })
    }

    fn probabilities(tree: &LightTree, count: usize, p: Vec3, n: Vec3) -> Vec<f64> {
        (0..count).map(|light| f64::from(tree.probability(light as u32, p, n, NONE))).collect()
    }

    #[test]
    fn probabilities_sum_to_one() {
        for (tree, count, p, n) in scenes() {
            let sum: f64 = probabilities(&tree, count, p, n).iter().sum();
            // With a normal, a cluster that seemed to be above may turn out to be below.
            let whole = if n == Vec3::ZERO { sum > 0.99999 } else { sum >= 0.0 };
            assert!(whole && sum < 1.00001, "{count} lights from {p}: {sum}");
        }
    }

    #[test]
    fn lights_come_as_often_as_their_probability_says() {
        const BLOCKS: u32 = 16_000;
        let mut state = 1u32;
        let mut next = move || {
            // Source: G. Marsaglia, "Xorshift RNGs", 2003.
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            (state >> 9) as f32 / 8_388_608.0
        };
        for (tree, count, p, n) in scenes() {
            let expected = probabilities(&tree, count, p, n);
            let rows = |v: Vec3| [[v.x; WIDTH], [v.y; WIDTH], [v.z; WIDTH]];
            let asking = Asking { p: rows(p), n: rows(n), own: [NONE; WIDTH], len: WIDTH };
            let mut observed = vec![0.0; count + 1];
            for _ in 0..BLOCKS {
                let drawn: [Row; 2] = std::array::from_fn(|_| std::array::from_fn(|_| next()));
                let (mut chosen, mut chance) = ([0; WIDTH], [0.0; WIDTH]);
                choose(&tree, &asking, &drawn, &mut chosen, &mut chance);
                for (light, chance) in chosen.into_iter().zip(chance) {
                    let light = if light == NONE { count } else { light as usize };
                    observed[light] += 1.0;
                    let known = expected.get(light).copied().unwrap_or(0.0);
                    assert!((f64::from(chance) - known).abs() <= 1e-5 * known, "{chance} against {known}");
                }
            }
            let samples = f64::from(BLOCKS) * WIDTH as f64;
            let scaled = |lie: f64| -> Vec<f64> {
                let none = 1.0 - expected.iter().sum::<f64>();
                let all = expected.iter().copied().chain([none.max(0.0)]);
                all.enumerate().map(|(i, e)| e * samples * if i % 2 == 0 { lie } else { 1.0 }).collect()
            };
            let [right, wrong] = [1.0, 1.05].map(|lie| counts::deviation(&observed, &scaled(lie)));
            assert!(right < 4.0, "{count} lights from {p}: {right}");
            // One that is all in one light has no other half to be wrong against.
            let shared = expected.iter().all(|e| *e < 0.6) && count > 3 && observed[count] < 0.5 * samples;
            assert!(wrong > right + 2.0 || !shared, "{count} lights: wrong by a twentieth is found: {wrong}, {right}");
        }
    }

    /// The point of it all: the variance of one choice, without visibility, is far below that by power.
    #[test]
    fn lights_that_bring_more_are_chosen_more_often() {
        let all = lights(1000, 5.0);
        let tree = LightTree::new(&all);
        let (p, n) = (Vec3::new(0.3, -1.0, 0.2), Vec3::Y);
        let brings = |light: &Bounds| {
            let to = 0.5 * (light.low + light.high) - p;
            let w = to.normalize();
            let leaving = if light.cos_cone > 0.0 { w.dot(light.axis).abs() } else { 1.0 };
            f64::from(light.power * leaving * w.dot(n).max(0.0) / to.length_squared())
        };
        let total: f64 = all.iter().map(brings).sum();
        let power: f64 = all.iter().map(|light| f64::from(light.power)).sum();
        let variance = |chance: &dyn Fn(usize) -> f64| {
            let square = |i: usize| brings(&all[i]).powi(2) / chance(i).max(1e-12);
            (0..all.len()).map(square).sum::<f64>() / (total * total) - 1.0
        };
        let by_tree = variance(&|i| f64::from(tree.probability(i as u32, p, n, NONE)));
        let by_power = variance(&|i| f64::from(all[i].power) / power);
        assert!(6.0 * by_tree < by_power, "{by_tree} against {by_power}");
    }
}
