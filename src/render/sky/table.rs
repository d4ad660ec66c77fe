//! A quadtree over the square of directions that samples them by brightness.

use super::brightness::{Brightness, FINE};
use super::square::{direction, place};
use glam::Vec3;
use std::f32::consts::PI;

/// Parts whose densities are within this of each other, relative to their mean, become one.
const ALIKE: f32 = 0.1;

/// What is added to every direction, in parts of the mean, so that none is left out.
const FLOOR: f64 = 0.01;

/// Marks the number of a leaf.
const LEAF: u32 = 1 << 31;

/// Bits of a coordinate that the steps down the tree are told by; a tree is never that deep.
const BITS: u32 = 23;

/// A square cut into four.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// The probability of the left half.
    left: f32,
    /// The probability of the lower quarter, within the left half and within the right one.
    lower: [f32; 2],
    /// The quarters, x first: numbers of nodes, or of leaves with their mark.
    quarters: [u32; 4],
}

/// Samples directions by the brightness of the background, and knows the density.
#[derive(Clone, Debug)]
pub struct SkyTable {
    nodes: Vec<Node>,
    /// Over solid angle, leaf by leaf.
    densities: Vec<f32>,
    root: u32,
}

/// A part of the square, while the tree is made.
struct Part {
    /// The mean of its densities, the least and the greatest.
    mean: f64,
    range: [f32; 2],
    /// The node, for a part that is not alike all over.
    node: Option<u32>,
}

impl SkyTable {
    /// The table of a background; none when it is black, or when nothing is left to be sampled.
    ///
    /// With `combined`, for sampling beside scattering, the mean is left out, which scattering finds by itself. Source: O.
    /// Karlik et al., "MIS Compensation: Optimizing Sampling Techniques in Multiple Importance Sampling", 2019, eq. 14.
    pub fn new(seen: &Brightness, combined: bool) -> Option<Self> {
        let mut wanted = seen.spread();
        if combined {
            let mean = wanted.mean() as f32;
            // Of what is alike all over, rounding leaves less than this.
            let least = 1e-5 * mean;
            wanted.change(|b| if b - mean > least { b - mean } else { 0.0 });
        }
        let mean = wanted.mean();
        if !(mean > 0.0 && mean.is_finite()) {
            return None;
        }
        let scale = 1.0 / (4.0 * f64::from(PI) * mean * (1.0 + FLOOR));
        wanted.change(|b| ((f64::from(b) + FLOOR * mean) * scale) as f32);
        let mut table = SkyTable { nodes: Vec::new(), densities: Vec::new(), root: 0 };
        let root = table.part(&wanted, wanted.side(), [0, 0]);
        table.root = table.link(&root);
        Some(table)
    }

    /// Makes the part of `size` coarse cells a side whose corner is the given one.
    fn part(&mut self, wanted: &Brightness, size: usize, [x, y]: [usize; 2]) -> Part {
        if size > 1 {
            let half = size / 2;
            let quarters = [[0, 0], [1, 0], [0, 1], [1, 1]];
            let quarters = quarters.map(|[i, j]| self.part(wanted, half, [x + i * half, y + j * half]));
            return self.join(quarters);
        }
        match wanted.fine(x, y) {
            Some(cells) => self.fine_part(cells, FINE, 0),
            None => Part::alike(wanted.coarse(x, y)),
        }
    }

    /// The same within a cell that was looked at closely; `first` is the corner.
    fn fine_part(&mut self, cells: &[f32; FINE * FINE], size: usize, first: usize) -> Part {
        if size == 1 {
            return Part::alike(cells[first]);
        }
        let half = size / 2;
        let quarters = [0, half, half * FINE, half * FINE + half].map(|k| self.fine_part(cells, half, first + k));
        self.join(quarters)
    }

    fn join(&mut self, quarters: [Part; 4]) -> Part {
        let mean = quarters.iter().map(|q| q.mean).sum::<f64>() / 4.0;
        let least = quarters.iter().map(|q| q.range[0]).fold(f32::INFINITY, f32::min);
        let most = quarters.iter().map(|q| q.range[1]).fold(0.0, f32::max);
        let range = [least, most];
        if quarters.iter().all(|q| q.node.is_none()) && most - least <= ALIKE * mean as f32 {
            return Part { mean, range, node: None };
        }
        let [a, b, c, d] = quarters.each_ref().map(|q| q.mean);
        let share = |part: f64, other: f64| if part > 0.0 { (part / (part + other)) as f32 } else { 0.0 };
        let node = Node {
            left: share(a + c, b + d),
            lower: [share(a, c), share(b, d)],
            quarters: quarters.each_ref().map(|q| self.link(q)),
        };
        self.nodes.push(node);
        Part { mean, range, node: Some(self.nodes.len() as u32 - 1) }
    }

    fn link(&mut self, part: &Part) -> u32 {
        part.node.unwrap_or_else(|| {
            self.densities.push(part.mean as f32);
            (self.densities.len() as u32 - 1) | LEAF
        })
    }

    /// A direction and its density over solid angle; `x` and `y` are in [0, 1).
    #[inline]
    pub fn sample(&self, x: f32, y: f32) -> (Vec3, f32) {
        let (mut x, mut y) = (x, y);
        let (mut corner, mut size, mut link) = ([0.0f32; 2], 1.0f32, self.root);
        while link & LEAF == 0 {
            let node = &self.nodes[link as usize];
            size *= 0.5;
            let right = choose(&mut x, node.left);
            let upper = choose(&mut y, node.lower[right]);
            corner[0] += size * right as f32;
            corner[1] += size * upper as f32;
            link = node.quarters[right + 2 * upper];
        }
        (direction(corner[0] + x * size, corner[1] + y * size), self.densities[(link ^ LEAF) as usize])
    }

    /// The density with which `sample` gives `direction`.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        const TOP: f32 = (1u32 << BITS) as f32;
        let [x, y] = place(direction).map(|a| ((a * TOP) as u32).min((1 << BITS) - 1));
        let (mut bit, mut link) = (BITS, self.root);
        while link & LEAF == 0 {
            bit -= 1;
            let quarter = (x >> bit & 1) + 2 * (y >> bit & 1);
            link = self.nodes[link as usize].quarters[quarter as usize];
        }
        self.densities[(link ^ LEAF) as usize]
    }
}

impl Part {
    fn alike(value: f32) -> Self {
        Part { mean: f64::from(value), range: [value, value], node: None }
    }
}

/// Chooses 0 with probability `first`, else 1, and makes a new number of what is left of `x`.
#[inline(always)]
fn choose(x: &mut f32, first: f32) -> usize {
    let second = *x >= first;
    let (before, share) = if second { (first, 1.0 - first) } else { (0.0, first) };
    *x = ((*x - before) / share).min(1.0 - f32::EPSILON / 2.0);
    usize::from(second)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::sky::LEAST_SIDE;
    use crate::render::{counts, random};

    /// The radiance of a sky with a hard sun of .53 degrees.
    fn sun(toward: Vec3, direction: Vec3) -> f32 {
        let inside = (direction - toward).length() < 2.0 * (0.25 * 0.53f32.to_radians()).sin();
        if inside { 1e4 } else { 0.1 + 0.05 * direction.z }
    }

    fn seen(side: usize, radiance: impl Fn(Vec3) -> f32) -> Brightness {
        let middle =
            |side: usize, [x, y]: [u32; 2]| direction((x as f32 + 0.5) / side as f32, (y as f32 + 0.5) / side as f32);
        Brightness::new(side, &|side, cells| cells.iter().map(|cell| radiance(middle(side, *cell))).collect())
    }

    fn numbers(count: u32) -> impl Iterator<Item = [f32; 2]> {
        (0..count).map(|i| {
            let r = random::sample(random::pixel_seed(5, i, 0), 0, 0);
            [r[0], r[1]]
        })
    }

    fn directions(count: u32) -> impl Iterator<Item = Vec3> {
        numbers(count).map(|[x, y]| direction(x, y))
    }

    /// Tables of all kinds, on grids of 64, with finer cells of 512: an edge, a gradient, a sun, and noise.
    fn tables() -> Vec<SkyTable> {
        let toward = Vec3::new(0.3, -0.5, 0.81).normalize();
        let skies: [&dyn Fn(Vec3) -> f32; 4] = [
            &|d| if d.y > 0.2 { 5.0 } else { 0.0 },
            &|d| 1.0 + 0.5 * d.x + d.z * d.z,
            &|d| if d.dot(toward) > 0.995 { 500.0 } else { 1.0 },
            &|d| (1e3 * d.x).sin().max(0.0) + (700.0 * d.y).cos().max(0.0),
        ];
        let both =
            |sky: &&dyn Fn(Vec3) -> f32| [false, true].map(|combined| SkyTable::new(&seen(64, sky), combined).unwrap());
        skies.iter().flat_map(both).collect()
    }

    #[test]
    fn the_density_is_that_of_the_sample_and_integrates_to_one() {
        for table in tables() {
            let mut wrong = 0;
            for [x, y] in numbers(20_000) {
                let (direction, density) = table.sample(x, y);
                assert!((direction.length() - 1.0).abs() < 1e-5 && density > 0.0);
                // A direction on a cell's edge may round into its neighbour.
                wrong += u32::from(table.pdf(direction) != density);
            }
            assert!(wrong < 20, "{wrong}");
            const SIDE: usize = 64 * FINE;
            let cells = (0..SIDE * SIDE).map(|i| [i % SIDE, i / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32));
            let sum: f64 = cells.map(|[x, y]| f64::from(table.pdf(direction(x, y)))).sum();
            let whole = sum * 4.0 * std::f64::consts::PI / (SIDE * SIDE) as f64;
            assert!((whole - 1.0).abs() < 1e-5, "{whole}");
        }
    }

    /// How far the counts of samples in 32 x 32 bins are from what `pdf` says, and from that by a twentieth more in every
    /// other bin.
    fn deviations(table: &SkyTable) -> [f64; 2] {
        const BINS: usize = 32;
        const SIDE: usize = 64 * FINE;
        let count = 1 << 18;
        let (mut expected, mut observed) = (vec![0.0f64; BINS * BINS], vec![0.0f64; BINS * BINS]);
        let bin = |[x, y]: [f32; 2]| {
            let [x, y] = [x, y].map(|a| ((a * BINS as f32) as usize).min(BINS - 1));
            y * BINS + x
        };
        for i in 0..SIDE * SIDE {
            let at = [i % SIDE, i / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32);
            let area = 4.0 * std::f64::consts::PI / (SIDE * SIDE) as f64;
            expected[bin(at)] += f64::from(table.pdf(direction(at[0], at[1]))) * area * f64::from(count);
        }
        numbers(count).for_each(|[x, y]| observed[bin(place(table.sample(x, y).0))] += 1.0);
        let right = counts::deviation(&observed, &expected);
        expected.iter_mut().step_by(2).for_each(|e| *e *= 1.05);
        [right, counts::deviation(&observed, &expected)]
    }

    #[test]
    fn directions_come_as_often_as_the_density_says() {
        for (i, table) in tables().iter().enumerate() {
            let [right, wrong] = deviations(table);
            assert!(right < 4.0, "sky {i}: {right}");
            assert!(wrong > 4.0, "sky {i}: a density that is wrong by a twentieth must be found, {wrong}");
        }
    }

    #[test]
    fn no_sun_is_missed_and_none_has_a_dark_rim() {
        let axes = [Vec3::Z, -Vec3::Z, Vec3::X, -Vec3::Y, Vec3::new(1.0, 1.0, 0.0).normalize()];
        for toward in axes.into_iter().chain(directions(10)) {
            let table = SkyTable::new(&seen(LEAST_SIDE as usize, |d| sun(toward, d)), true).unwrap();
            let hits = numbers(1000).filter(|[x, y]| sun(toward, table.sample(*x, *y).0) > 1.0).count();
            assert!(hits > 700, "{toward}: {hits} of 1000 samples are in the sun");
            // All over the sun the density is much the same, but for the rim, which is never dark.
            let (t, b) = toward.any_orthonormal_pair();
            let most = table.pdf(toward);
            for [x, y] in numbers(2000) {
                let (sin, cos) = crate::math::elementary::sincos(2.0 * PI * x);
                let r = y.sqrt() * (0.5 * 0.53f32.to_radians());
                let inside = (toward + r * (cos * t + sin * b)).normalize();
                if sun(toward, inside) > 1.0 {
                    assert!(table.pdf(inside) > 0.05 * most, "{toward}: {} of {most}", table.pdf(inside));
                }
            }
        }
    }

    #[test]
    fn what_is_alike_all_over_needs_no_table_beside_scattering() {
        assert!(SkyTable::new(&seen(64, |_| 0.3), true).is_none());
        assert!(SkyTable::new(&seen(64, |_| 0.0), false).is_none());
        let plain = SkyTable::new(&seen(64, |_| 0.3), false).unwrap();
        assert_eq!(plain.densities.len(), 1);
        assert!((plain.pdf(Vec3::X) * 4.0 * PI - 1.0).abs() < 1e-6);
        // A gradient is a small tree: it is no finer than it has to be.
        let gradient = SkyTable::new(&seen(LEAST_SIDE as usize, |d| 1.0 + 0.5 * d.x), false).unwrap();
        assert!(gradient.densities.len() < 1000, "{}", gradient.densities.len());
    }
}
