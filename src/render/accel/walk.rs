//! One ray through the tree: eight boxes at a time, four triangles at a time, nearest child first.
//!
//! **Boxes** are tested in a way that never loses one. A slab's distance (plane - origin) / direction carries three
//! roundings, so the far side is put off by four. A direction component of zero is taken for 1e-18, so that no zero
//! meets an infinity; what that moves is far less than the padding of the boxes.
//!
//! **Triangles** are tested as Woop, Benthin and Wald 2013 have it ("Watertight Ray/Triangle Intersection"): corners
//! are moved and sheared so that the ray is an axis, and three edge functions of what is left, each the difference of
//! two products, must agree in sign. Rounding is monotone, so a difference may become zero but never change its sign,
//! and zero counts as inside: two triangles that share an edge share its corners, and no ray slips between them.
//! Departs from source: no second try in double precision; a zero is a hit for both sides, never for none.
//!
//! **Ties** go to the primitive that comes first in the scene, whatever the order in which leaves are met.

use super::prefetch::prefetch;
use super::ray::{Hit, NOTHING, Ray};
use super::shape::Analytic;
use super::tree::{ANALYTIC, BLOCK, Block, LANES, Node, Tree, WIDTH};
use crate::lanes;

/// Four roundings and a little: how much later than computed a ray may leave a box.
const LATE: f32 = 1.0 + 4.0 * f32::EPSILON;

/// A ray with what the tests need of it.
struct Traveller {
    origin: [f32; 3],
    inverse: [f32; 3],
    /// Of each axis, the row of a node's planes that the ray meets first.
    near: [usize; 3],
    /// The axes, the steepest last.
    axes: [usize; 3],
    /// Shear along the first two axes, and scale along the last.
    shear: [f32; 3],
    skip: u32,
    target: u32,
}

impl Traveller {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let inverse = d.map(|x| if x.abs() < 1e-18 { 1e18f32.copysign(x) } else { 1.0 / x });
        let near = [0, 1, 2].map(|axis| 2 * axis + usize::from(inverse[axis] < 0.0));
        let size = d.map(f32::abs);
        let z = if size[0] > size[1] && size[0] > size[2] {
            0
        } else if size[1] > size[2] {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let scale = 1.0 / d[z];
        let shear = [d[x] * scale, d[y] * scale, scale];
        let origin = ray.origin.to_array();
        Traveller { origin, inverse, near, axes: [x, y, z], shear, skip: ray.skip, target: ray.target }
    }
}

/// The boxes of `node` that the ray is in before `limit`, a bit each, and where it comes into them.
#[inline(always)]
fn boxes(node: &Node, ray: &Traveller, limit: f32) -> (u32, [f32; WIDTH]) {
    let [nx, ny, nz] = ray.near.map(|row| &node.planes[row % 6]);
    let [fx, fy, fz] = ray.near.map(|row| &node.planes[(row ^ 1) % 6]);
    let ([ox, oy, oz], [ix, iy, iz]) = (ray.origin, ray.inverse);
    let mut entry = [0.0f32; WIDTH];
    let mut inside = [0u32; WIDTH];
    for k in 0..WIDTH {
        let near = greater(greater((nx[k] - ox) * ix, (ny[k] - oy) * iy), greater((nz[k] - oz) * iz, 0.0));
        let far = lesser(lesser((fx[k] - ox) * ix, (fy[k] - oy) * iy), (fz[k] - oz) * iz) * LATE;
        entry[k] = near;
        inside[k] = if near <= lesser(far, limit) { 1 << k } else { 0 };
    }
    (inside.iter().fold(0, |a, b| a | b), entry)
}

/// The greater of two numbers, in one instruction.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The lesser of two numbers, in one instruction.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// What a block's test gives for its four triangles.
struct Meeting {
    t: [f32; LANES],
    u: [f32; LANES],
    v: [f32; LANES],
    /// A bit for each triangle that is hit within the limit.
    hit: u32,
}

#[inline(always)]
fn triangles(block: &Block, ray: &Traveller, limit: f32) -> Meeting {
    let [x, y, z] = ray.axes.map(|axis| axis % 3);
    let [a, b, c] = &block.corners;
    let (ox, oy, oz) = (ray.origin[x], ray.origin[y], ray.origin[z]);
    let [sx, sy, sz] = ray.shear;
    let zero = [0.0; LANES];
    let mut m = Meeting { t: zero, u: zero, v: zero, hit: 0 };
    let mut hit = [0u32; LANES];
    for k in 0..LANES {
        let (az, bz, cz) = (a[z][k] - oz, b[z][k] - oz, c[z][k] - oz);
        let (ax, ay) = ((a[x][k] - ox) - sx * az, (a[y][k] - oy) - sy * az);
        let (bx, by) = ((b[x][k] - ox) - sx * bz, (b[y][k] - oy) - sy * bz);
        let (cx, cy) = ((c[x][k] - ox) - sx * cz, (c[y][k] - oy) - sy * cz);
        let ea = cx * by - cy * bx;
        let eb = ax * cy - ay * cx;
        let ec = bx * ay - by * ax;
        let least = lesser(ea, lesser(eb, ec));
        let most = greater(ea, greater(eb, ec));
        let inverse = 1.0 / (ea + eb + ec);
        let (wa, wb, wc) = (ea * inverse, eb * inverse, ec * inverse);
        // A sum of zero makes this NaN or infinite, which is no hit.
        let t = (wa * az + wb * bz + wc * cz) * sz;
        let meets = ((least >= 0.0) | (most <= 0.0)) & (t > 0.0) & (t <= limit);
        let counts = (block.ids[k] != ray.skip) & (block.ids[k] != ray.target);
        (m.t[k], m.u[k], m.v[k]) = (t, wb, wc);
        hit[k] = if meets & counts { 1 << k } else { 0 };
    }
    m.hit = hit.iter().fold(0, |a, b| a | b);
    m
}

/// Takes a hit if it is nearer, or as near and of an earlier primitive.
#[inline(always)]
fn take(best: &mut Hit, t: f32, primitive: u32, u: f32, v: f32) {
    if t < best.t || (t == best.t && primitive < best.primitive) {
        *best = Hit { t, primitive, u, v };
    }
}

/// Takes what a ray meets of a block; for `ANY`, true says that something is short of its reach.
#[inline(always)]
fn meet<const ANY: bool>(best: &mut Hit, block: &Block, mut m: Meeting) -> bool {
    while m.hit != 0 {
        let k = m.hit.trailing_zeros() as usize % LANES;
        m.hit &= m.hit - 1;
        if !ANY {
            take(best, m.t[k], block.ids[k], m.u[k], m.v[k]);
        } else if m.t[k] < best.t {
            *best = Hit { t: m.t[k], primitive: block.ids[k], u: m.u[k], v: m.v[k] };
            return true;
        }
    }
    false
}

/// True for a ray that can meet something: a NaN would be in every box, also where a node has no child.
#[inline(always)]
fn goes_somewhere(ray: &Ray) -> bool {
    ray.origin.is_finite() && ray.direction.is_finite() && !ray.reach.is_nan()
}

/// The lists of a tree.
struct Parts<'a> {
    nodes: &'a [Node],
    blocks: &'a [Block],
    analytic: &'a [Analytic],
}

impl<'a> Parts<'a> {
    fn new(tree: &'a Tree) -> Self {
        Parts { nodes: tree.nodes.items(), blocks: tree.blocks.items(), analytic: &tree.analytic }
    }

    /// Has a child on its way from memory while others are looked at.
    #[inline(always)]
    fn ask_for(&self, child: u32) {
        if child < ANALYTIC {
            prefetch(&self.nodes[child as usize]);
        } else if child & BLOCK != 0 {
            prefetch(&self.blocks[(child ^ BLOCK) as usize]);
        }
    }
}

/// The closest hit of one ray; or, for `ANY`, any hit short of its reach.
#[inline(always)]
fn walk<const ANY: bool>(tree: &Parts, ray: &Ray, stack: &mut [u64]) -> Hit {
    let traveller = Traveller::new(ray);
    // No hit is at infinity, so the largest number stands for it.
    let mut best = Hit { t: lesser(ray.reach, f32::MAX), primitive: NOTHING, u: 0.0, v: 0.0 };
    let mut limit = best.t * LATE;
    let mut top = 0;
    let mut current = 0u32;
    loop {
        if current < ANALYTIC {
            let node = &tree.nodes[current as usize];
            let (mut inside, entry) = boxes(node, &traveller, limit);
            if inside != 0 {
                let first = inside.trailing_zeros() as usize;
                inside &= inside - 1;
                tree.ask_for(node.children[first]);
                if inside == 0 {
                    current = node.children[first];
                    continue;
                }
                let base = top;
                stack[top] = key(entry[first], node.children[first]);
                top += 1;
                while inside != 0 {
                    let k = inside.trailing_zeros() as usize;
                    inside &= inside - 1;
                    tree.ask_for(node.children[k]);
                    let new = key(entry[k], node.children[k]);
                    let mut at = top;
                    if !ANY {
                        while at > base && stack[at - 1] < new {
                            stack[at] = stack[at - 1];
                            at -= 1;
                        }
                    }
                    stack[at] = new;
                    top += 1;
                }
                top -= 1;
                current = stack[top] as u32;
                continue;
            }
        } else if current & BLOCK != 0 {
            let block = &tree.blocks[(current ^ BLOCK) as usize];
            let meeting = triangles(block, &traveller, best.t);
            if meet::<ANY>(&mut best, block, meeting) {
                return best;
            }
            limit = best.t * LATE;
        } else {
            let leaf = &tree.analytic[(current ^ ANALYTIC) as usize];
            let (t, u, v) = leaf.intersect(ray.origin, ray.direction, ray.skip);
            // What the ray goes to is not in its way, as in `triangles`.
            if leaf.id != ray.target {
                if !ANY {
                    take(&mut best, t, leaf.id, u, v);
                    limit = best.t * LATE;
                } else if t < best.t {
                    return Hit { t, primitive: leaf.id, u, v };
                }
            }
        }
        loop {
            if top == 0 {
                return best;
            }
            top -= 1;
            if f32::from_bits((stack[top] >> 32) as u32) <= limit {
                current = stack[top] as u32;
                break;
            }
        }
    }
}

/// An entry of the stack: distances are not negative, so their bits are in the order of their values.
#[inline(always)]
fn key(entry: f32, child: u32) -> u64 {
    u64::from(entry.to_bits()) << 32 | u64::from(child)
}

lanes! {
    /// Gives `hits` the closest hit of each ray.
    pub fn closest(tree: &Tree, rays: &[Ray], hits: &mut [Hit]) {
        let mut stack = vec![0u64; tree.stack];
        let parts = Parts::new(tree);
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = if goes_somewhere(ray) { walk::<false>(&parts, ray, &mut stack) } else { Hit::NONE };
            if hit.primitive == NOTHING {
                hit.t = f32::INFINITY;
            }
        }
    }
}

lanes! {
    /// Gives `blocked` whether anything is in the way of each ray.
    pub fn any(tree: &Tree, rays: &[Ray], blocked: &mut [bool]) {
        let mut stack = vec![0u64; tree.stack];
        let parts = Parts::new(tree);
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = goes_somewhere(ray) && walk::<true>(&parts, ray, &mut stack).primitive != NOTHING;
        }
    }
}
