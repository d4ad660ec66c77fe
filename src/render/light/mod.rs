//! Area lights: which primitives emit, how one is chosen, and how a point on it is.
//!
//! `shape` knows one light, `solid` places on it by solid angle, `tree` which light may bring how much to a point, and
//! `bounds` how lights are put together for that.
//!
//! Decision (2026-11-29): from three lights on a tree chooses by place and normal, and flat lights are sampled by solid angle
//! from close by; power and area stay to be compared with (`velour chart`). One light is chosen by nothing, so it costs
//! nothing; with two a look at both costs more than it gains.

mod bounds;
mod shape;
mod solid;
mod tree;

use super::block::{Row, WIDTH, load, store};
use super::segment::Segment;
use super::settings::{LightChoice, LightPoints};
use crate::math::columns::Column3;
use crate::scene::Geometry;
use glam::Vec3;
use shape::{LightBlock, LightForm, Outline, Outlines};
use tree::{Asking, LightTree, NONE, choose, marked};

/// So many lights are chosen by a tree, at the least.
const LEAST_FOR_TREE: usize = 3;

/// True when so many lights are chosen by a tree.
pub fn by_tree(lights: usize, choice: LightChoice) -> bool {
    choice == LightChoice::Tree && lights >= LEAST_FOR_TREE
}

/// Directions toward lights, one a lane.
#[derive(Clone, Debug, Default)]
pub struct LightLanes {
    /// The unit direction.
    pub direction: Column3,
    /// The distance to the light.
    pub distance: Vec<f32>,
    /// Density of the direction over solid angle, the choice of the light included; 0 when there is no sample.
    pub pdf_solid_angle: Vec<f32>,
    /// The light's primitive.
    pub primitive: Vec<u32>,
    /// Surface coordinates, as `accel::Hit` has them.
    pub u: Vec<f32>,
    /// Surface coordinates, as `accel::Hit` has them.
    pub v: Vec<f32>,
}

impl LightLanes {
    /// Makes room for `len` lanes.
    pub fn resize(&mut self, len: usize) {
        self.direction.resize(len);
        self.primitive.resize(len, 0);
        for column in [&mut self.distance, &mut self.pdf_solid_angle, &mut self.u, &mut self.v] {
            column.resize(len, 0.0);
        }
    }
}

/// How the light is chosen.
#[derive(Clone, Debug, Default)]
enum Chooser {
    /// There is one at most.
    #[default]
    Alone,
    /// By running sums of the probabilities, of which the last one is 1.
    Power(Vec<f32>),
    /// By place and normal.
    Tree(LightTree),
}

/// Who looks at lights, a lane each.
#[derive(Clone, Copy, Debug)]
pub struct Lookers<'a> {
    /// The points.
    pub p: &'a Column3,
    /// Their unit normals on the side that lights can reach, nothing where both can; read when [`Lights::reads_normals`].
    pub normal: &'a Column3,
    /// The primitives that the points lie on.
    pub from: &'a [u32],
}

/// The lights of a scene and the probability of each.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    primitives: Vec<u32>,
    chooser: Chooser,
    /// The number of each primitive among the lights, or `NONE`; empty when there is no light.
    numbers: Vec<u32>,
    /// The probability of each light, by power.
    chance: Vec<f32>,
    /// The shapes, beside `primitives`.
    forms: Vec<LightForm>,
    outlines: Outlines,
    points: LightPoints,
}

impl Lights {
    /// Lights from primitives and an estimate of the power of each.
    ///
    /// The estimate comes from a few points of a shader that may vary, so it may be too low; a tenth of the mean is
    /// added to each so that no light is starved.
    pub fn new(geometry: &Geometry, powers: &[(u32, f32)], choice: LightChoice, points: LightPoints) -> Self {
        if powers.is_empty() {
            return Self::default();
        }
        let count = powers.len() as f64;
        let clean = |p: f32| if p.is_finite() && p > 0.0 { f64::from(p) } else { 0.0 };
        let total: f64 = powers.iter().map(|(_, p)| clean(*p)).sum();
        let floor = if total > 0.0 { 0.1 * total / count } else { 1.0 };
        let sum = total + floor * count;
        let mut lights = Lights { numbers: vec![NONE; geometry.primitives.len()], points, ..Lights::default() };
        let mut shares = Vec::with_capacity(powers.len());
        for (number, &(primitive, power)) in powers.iter().enumerate() {
            let form = LightForm::new(&geometry.primitives[primitive as usize].shape);
            lights.numbers[primitive as usize] = number as u32;
            lights.primitives.push(primitive);
            lights.outlines = lights.outlines.with(form.outline());
            lights.forms.push(form);
            shares.push((clean(power) + floor) / sum);
        }
        if by_tree(shares.len(), choice) {
            let bounds: Vec<_> = lights.forms.iter().zip(&shares).map(|(form, s)| form.bounds(*s as f32)).collect();
            lights.chooser = Chooser::Tree(LightTree::new(&bounds));
        } else {
            let sums = lights.take_chances(&shares);
            lights.chooser = if sums.len() > 1 { Chooser::Power(sums) } else { Chooser::Alone };
        }
        lights
    }

    /// Keeps the chances of the lights, as they come out; gives their running sums.
    fn take_chances(&mut self, shares: &[f64]) -> Vec<f32> {
        let (mut running, mut sums) = (0.0f64, Vec::with_capacity(shares.len()));
        for share in shares {
            running += share;
            // Random numbers are multiples of 2^-23. With sums that are too, a light's chance, which is their difference,
            // is exactly how often the search gives it; one of less than that may never be chosen, and has none.
            let rounded = ((running * 8_388_608.0).round() / 8_388_608.0) as f32;
            self.chance.push(rounded - sums.last().unwrap_or(&0.0));
            sums.push(rounded);
        }
        if let Some(last) = sums.last_mut() {
            *last = 1.0;
        }
        sums
    }

    /// True when there is nothing to sample.
    pub fn is_empty(&self) -> bool {
        self.primitives.is_empty()
    }

    /// True when the choice depends on normals.
    pub fn reads_normals(&self) -> bool {
        matches!(self.chooser, Chooser::Tree(_))
    }

    /// How many random numbers [`Lights::sample`] takes.
    pub fn numbers(&self) -> usize {
        match self.chooser {
            Chooser::Alone => 2,
            Chooser::Power(_) => 3,
            Chooser::Tree(_) => 4,
        }
    }

    /// Chooses a light a lane and a point on it. The first two numbers of a lane choose the point, the others the light.
    pub fn sample(&self, lookers: Lookers, numbers: &[Vec<f32>; 4], out: &mut LightLanes) {
        let len = lookers.from.len();
        out.resize(len);
        let mut block = LightBlock::new();
        let mut chosen = Chosen { light: [0; WIDTH], chance: [0.0; WIDTH] };
        // A light that is alone is the same for all blocks.
        let alone = match (&self.chooser, self.forms.as_slice()) {
            (Chooser::Alone, [form]) => {
                (0..WIDTH).for_each(|k| block.load(k, form, self.chance[0]));
                Some(self.primitives[0])
            }
            (Chooser::Alone | Chooser::Power(_) | Chooser::Tree(_), _) => None,
        };
        for start in (0..len).step_by(WIDTH) {
            let count = WIDTH.min(len - start);
            block.look(lookers.p, [&numbers[0], &numbers[1]], start, count);
            let mut on = [false; WIDTH];
            let (from, primitives) = (&lookers.from[start..start + count], &mut out.primitive[start..start + count]);
            if let Some(alone) = alone {
                primitives.fill(alone);
            } else {
                self.choose(&block, lookers, numbers, start, count, &mut chosen);
                self.load(&chosen, &mut block, primitives);
            }
            for (k, (primitive, from)) in primitives.iter().zip(from).enumerate() {
                on[k] = primitive == from;
                block.allow(k, !on[k]);
            }
            block.sample(count, self.points, self.outlines, &on);
            let (direction, [distance, pdf, u, v]) = block.results();
            store(&mut out.direction, start, count, direction);
            let columns = [&mut out.distance, &mut out.pdf_solid_angle, &mut out.u, &mut out.v];
            for (column, row) in columns.into_iter().zip([distance, pdf, u, v]) {
                column[start..start + count].copy_from_slice(&row[..count]);
            }
        }
    }

    /// Takes the lights that were chosen; where there is none, one that has no chance.
    #[inline(always)]
    fn load(&self, chosen: &Chosen, block: &mut LightBlock, primitives: &mut [u32]) {
        for (k, primitive) in primitives.iter_mut().enumerate() {
            let light = chosen.light[k] as usize;
            let (light, chance) = if light < self.forms.len() { (light, chosen.chance[k]) } else { (0, 0.0) };
            block.load(k, &self.forms[light], chance);
            *primitive = self.primitives[light];
        }
    }

    /// The flat light that a primitive is, as a child of the tree; it brings nothing to points on itself.
    #[inline]
    fn own(&self, primitive: u32) -> u32 {
        let light = self.numbers.get(primitive as usize).copied().unwrap_or(NONE);
        let flat = self.forms.get(light as usize).is_some_and(|form| form.outline() != Outline::Sphere);
        if flat { marked(light) } else { NONE }
    }

    fn choose(
        &self,
        block: &LightBlock,
        lookers: Lookers,
        numbers: &[Vec<f32>; 4],
        start: usize,
        count: usize,
        out: &mut Chosen,
    ) {
        match &self.chooser {
            Chooser::Alone => {}
            Chooser::Power(sums) => {
                for k in 0..count {
                    let light = sums.partition_point(|sum| *sum <= numbers[2][start + k]).min(sums.len() - 1);
                    (out.light[k], out.chance[k]) = (light as u32, self.chance[light]);
                }
            }
            Chooser::Tree(tree) => {
                let own = |from: &u32| self.own(*from);
                let mut asking = Asking { p: *block.points(), n: [[0.0; WIDTH]; 3], own: [NONE; WIDTH], len: count };
                load(&mut asking.n, start, count, lookers.normal);
                asking.own.iter_mut().zip(lookers.from[start..].iter().map(own)).for_each(|(to, own)| *to = own);
                let mut rows: [Row; 2] = [[0.0; WIDTH]; 2];
                rows[0][..count].copy_from_slice(&numbers[2][start..start + count]);
                rows[1][..count].copy_from_slice(&numbers[3][start..start + count]);
                choose(tree, &asking, &rows, &mut out.light, &mut out.chance);
            }
        }
    }

    /// Density with which `sample` would have chosen the hit that a ray has made from a point with that normal; 0 for what is
    /// no light.
    #[inline]
    pub fn pdf(&self, segment: &Segment, from: u32, normal: Vec3) -> f32 {
        let Segment { origin, direction, hit, .. } = *segment;
        let light = match self.numbers.get(hit.primitive as usize) {
            Some(light) if *light != NONE => *light,
            _ => return 0.0,
        };
        let chance = match &self.chooser {
            Chooser::Alone | Chooser::Power(_) => self.chance[light as usize],
            Chooser::Tree(tree) => tree.probability(light, origin, normal, self.own(from)),
        };
        if chance <= 0.0 {
            return 0.0;
        }
        chance * self.forms[light as usize].pdf(self.points, origin, direction, hit.t, hit.primitive == from)
    }
}

/// The lights that a few lanes have chosen, and the probability of each.
struct Chosen {
    light: [u32; WIDTH],
    chance: Row,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::accel::{Hit, NOTHING};
    use crate::render::form::Form;
    use crate::render::random;
    use crate::scene::{Primitive, Shape};

    fn vector(i: u32, k: u32) -> Vec3 {
        let number = |j| random::sample(random::pixel_seed(31, i, k + j), 0, 0)[0];
        Vec3::new(number(0), number(1), number(2)) * 2.0 - 1.0
    }

    /// Lights of all outlines, big and small.
    fn lit(count: u32) -> Geometry {
        let shape = |i: u32| {
            let (a, b, c) = (4.0 * vector(i, 0), vector(i, 3), vector(i, 6));
            let size = [0.05, 0.5, 2.0][i as usize % 3];
            match i % 4 {
                0 => Shape::Sphere { center: a, radius: 0.2 * size },
                1 => Shape::Quad { corner: a, edge_x: size * b, edge_y: size * b.cross(c) },
                2 => Shape::Quad { corner: a, edge_x: size * b, edge_y: size * c },
                _ => Shape::Triangle { a, b: a + size * b, c: a + size * c },
            }
        };
        let primitive = |i| Primitive { shape: shape(i), object: 0, normals: Primitive::NONE, uvs: Primitive::NONE };
        Geometry { primitives: (0..count).map(primitive).collect(), ..Geometry::default() }
    }

    fn drawn(lanes: u32) -> [Vec<f32>; 4] {
        let column = |k: usize| (0..lanes).map(|i| random::sample(7, i, 0)[k]).collect();
        std::array::from_fn(column)
    }

    /// Whatever the method, what is sampled has the density that a ray would be told which hits it there.
    #[test]
    fn the_density_of_a_hit_is_that_of_the_sample() {
        const LANES: u32 = 4000;
        for (count, choice, points) in [
            (1, LightChoice::Power, LightPoints::Area),
            (2, LightChoice::Tree, LightPoints::Solid),
            (40, LightChoice::Power, LightPoints::Solid),
            (40, LightChoice::Tree, LightPoints::Area),
            (40, LightChoice::Tree, LightPoints::Solid),
        ] {
            let geometry = lit(count);
            let powers: Vec<(u32, f32)> = (0..count).map(|i| (i, 1.0 + (i % 5) as f32)).collect();
            let lights = Lights::new(&geometry, &powers, choice, points);
            let (mut p, mut normal) = (Column3::zeros(LANES as usize), Column3::zeros(LANES as usize));
            for lane in 0..LANES as usize {
                p.set(lane, 5.0 * vector(lane as u32, 10));
                normal.set(lane, if lane % 2 == 0 { vector(lane as u32, 20).normalize() } else { Vec3::ZERO });
            }
            let from = vec![NOTHING; LANES as usize];
            let mut out = LightLanes::default();
            lights.sample(Lookers { p: &p, normal: &normal, from: &from }, &drawn(LANES), &mut out);
            let mut sampled = 0;
            for lane in 0..LANES as usize {
                let pdf = out.pdf_solid_angle[lane];
                if pdf <= 0.0 {
                    continue;
                }
                sampled += 1;
                let (origin, direction, t) = (p.get(lane), out.direction.get(lane), out.distance[lane]);
                let hit = Hit { t, primitive: out.primitive[lane], u: out.u[lane], v: out.v[lane] };
                let segment = Segment { origin, direction, hit, width: 0.0, spread: 0.0, ray_type: 0 };
                let told = lights.pdf(&segment, NOTHING, normal.get(lane));
                assert!((told / pdf - 1.0).abs() < 2e-3, "{choice:?}, {points:?}: {told} against {pdf}");
                // The place on the light is where the ray goes.
                let form = Form::new(&geometry.primitives[hit.primitive as usize].shape);
                if !form.round {
                    let place = form.a + hit.u * form.b + hit.v * form.c;
                    assert!((origin + t * direction - place).length() < 1e-4, "{place}");
                }
            }
            assert!(sampled > LANES / 4, "{sampled}");
        }
    }

    /// A lane on a flat light never chooses it, unless it is alone; one inside a ball does.
    #[test]
    fn a_light_does_not_light_itself() {
        let geometry = lit(40);
        let powers: Vec<(u32, f32)> = (0..40).map(|i| (i, 1.0)).collect();
        let lights = Lights::new(&geometry, &powers, LightChoice::Tree, LightPoints::Solid);
        let mut out = LightLanes::default();
        for own in 0..40u32 {
            let form = Form::new(&geometry.primitives[own as usize].shape);
            let (mut p, normal) = (Column3::zeros(256), Column3::zeros(256));
            (0..256)
                .for_each(|lane| p.set(lane, form.a + if form.round { Vec3::ZERO } else { 0.3 * (form.b + form.c) }));
            lights.sample(Lookers { p: &p, normal: &normal, from: &[own; 256] }, &drawn(256), &mut out);
            let chosen = (0..256).filter(|lane| out.primitive[*lane] == own).count();
            assert!(form.round || chosen == 0, "{own}: {chosen}");
            assert!(!form.round || chosen > 0, "{own}");
        }
    }
}
