//! Shading frames of a batch: normals made fit to shade with, tangents, and directions in local coordinates.
//!
//! Normals: a zero normal becomes the geometric one. When the viewer is on the inner side of both normals (N and ng agree,
//! the viewer is behind), N is flipped and eta inverted, as OSL's Fresnel functions do. A shading normal that faces away
//! from a viewer in front of the surface is bent just so far that it does not.
//!
//! Decision (2026-11-22): such normals are bent instead of flipped, because a flipped one points into the surface and
//! turns black under the geometric test, and instead of rejected, which leaves black spots on bump maps.

use super::batch::localise_lanes;
use super::normals::{NormalColumns, any_low, normal_lanes, raised, tangent_lanes};
use super::source::Triples;
use super::store::NONE;
use super::tree::{Floats, Tree};
use crate::math::columns::Column3;
use crate::math::frame::Frame;
use glam::Vec3;

/// What a frame is made from: normal, tangent, coat, and whether its normals are raised to mirror the viewer.
type Key = ([Floats; 3], Option<[Floats; 3]>, u32, bool);

/// A shading frame a lane.
#[derive(Debug, Default)]
pub struct FrameColumns {
    key: Option<Key>,
    /// The coat its directions run in, or [`NONE`].
    pub coat: u32,
    /// Tangents.
    pub tangent: Column3,
    /// Bitangents.
    pub bitangent: Column3,
    /// Shading normals.
    pub normal: Column3,
    /// The viewer in local coordinates.
    pub wo: Column3,
    /// The light in local coordinates, as of the last evaluation.
    pub wi: Column3,
    /// 1 in lanes whose viewer is inside.
    pub inside: Vec<f32>,
    /// True when any lane is inside.
    pub any_inside: bool,
    /// 1 in lanes whose normal is not a number.
    pub broken: Vec<f32>,
    /// True when any lane is broken.
    pub any_broken: bool,
}

impl FrameColumns {
    /// The three axes as slices.
    pub fn axes(&self) -> [Triples<'_>; 3] {
        [Triples::of(&self.tangent), Triples::of(&self.bitangent), Triples::of(&self.normal)]
    }

    /// The axes of a lane.
    pub fn axes_at(&self, lane: usize) -> Frame {
        Frame { tangent: self.tangent.get(lane), bitangent: self.bitangent.get(lane), normal: self.normal.get(lane) }
    }

    /// Brings light directions into local coordinates.
    pub fn localise(&mut self, wi: &Column3) {
        let axes = [Triples::of(&self.tangent), Triples::of(&self.bitangent), Triples::of(&self.normal)];
        localise_lanes(axes, Triples::of(wi), &mut self.wi.x, &mut self.wi.y, &mut self.wi.z);
    }
}

/// How a surface is seen.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// The viewer, as its direction runs in the coat.
    pub wo: &'a Column3,
    /// Geometric normals.
    pub ng: &'a Column3,
    /// The coat over the surface, or [`NONE`].
    pub coat: u32,
    /// Not 0 in lanes whose normals were turned because the viewer is inside; empty when there is none.
    pub backfacing: &'a [i32],
}

/// How many of the newest frames are compared with a new one; a scene rarely has more normals than this.
const FRAMES_COMPARED: usize = 8;

/// All frames of a batch.
#[derive(Debug, Default)]
pub struct Frames {
    list: Vec<FrameColumns>,
    used: usize,
    given: Column3,
}

impl Frames {
    /// Empties the store.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// The frames in use.
    pub fn list(&self) -> &[FrameColumns] {
        &self.list[..self.used]
    }

    /// The frames in use, to bring directions into them.
    pub fn list_mut(&mut self) -> &mut [FrameColumns] {
        &mut self.list[..self.used]
    }

    /// The frame of a normal and tangent for lobes about the mirror direction: where that lies below the surface the normal is
    /// raised, see [`raised`]. Where none does, the frame that others have.
    ///
    /// Decision (2026-11-29): normals are raised for lobes about the mirror direction alone, as Cycles does, because light that a
    /// bent normal mirrors into the surface is lost and leaves black spots (a bumpy mirror in a white furnace: .904); a diffuse
    /// lobe loses little there, and would only lose the shape of its bumps.
    pub fn push_mirror(&mut self, tree: &Tree, normal: [Floats; 3], tangent: Option<[Floats; 3]>, seen: &Seen) -> u32 {
        let plain = self.push(tree, normal, tangent, seen, false);
        let frame = &self.list[plain as usize];
        // In a coat directions are bent, and the surface is where they leave it.
        let low = seen.coat == NONE && any_low(Triples::of(&frame.normal), Triples::of(seen.wo), Triples::of(seen.ng));
        if low { self.push(tree, normal, tangent, seen, true) } else { plain }
    }

    /// The frame of a normal and tangent; one that was made for the same columns is used again.
    pub fn push(
        &mut self,
        tree: &Tree,
        normal: [Floats; 3],
        tangent: Option<[Floats; 3]>,
        seen: &Seen,
        raise: bool,
    ) -> u32 {
        let newest = self.used.saturating_sub(FRAMES_COMPARED);
        let key = Some((normal, tangent, seen.coat, raise));
        if let Some(found) = (newest..self.used).find(|&i| self.list[i].key == key) {
            return found as u32;
        }
        if self.used == self.list.len() {
            self.list.push(FrameColumns::default());
        }
        let (index, n) = (self.used, tree.lanes);
        self.used += 1;
        let frame = &mut self.list[index];
        frame.key = key;
        frame.coat = seen.coat;
        for column in [&mut frame.tangent, &mut frame.bitangent, &mut frame.normal, &mut frame.wo, &mut frame.wi] {
            column.resize(n);
        }
        frame.inside.resize(n, 0.0);
        frame.broken.resize(n, 0.0);
        for (k, column) in [&mut self.given.x, &mut self.given.y, &mut self.given.z].into_iter().enumerate() {
            if let Floats::Uniform(value) = normal[k] {
                column.clear();
                column.resize(n, value);
            }
        }
        let given = Triples {
            x: column_of(tree, normal[0], &self.given.x),
            y: column_of(tree, normal[1], &self.given.y),
            z: column_of(tree, normal[2], &self.given.z),
        };
        fill(frame, tree, given, tangent, seen, raise);
        index as u32
    }
}

/// Fills a frame whose columns are as long as the batch.
fn fill(frame: &mut FrameColumns, tree: &Tree, given: Triples, tangent: Option<[Floats; 3]>, seen: &Seen, raise: bool) {
    let from = NormalColumns { given, wo: Triples::of(seen.wo), ng: Triples::of(seen.ng) };
    let normals = &mut frame.normal;
    normal_lanes(from, &mut normals.x, &mut normals.y, &mut normals.z, &mut frame.inside, &mut frame.broken);
    (frame.any_inside, frame.any_broken) = (any(&frame.inside), any(&frame.broken));
    for lane in (0..tree.lanes).filter(|_| raise) {
        let normal = raised(frame.normal.get(lane), seen.wo.get(lane), seen.ng.get(lane));
        frame.normal.set(lane, normal);
    }
    let (t, b) = (&mut frame.tangent, &mut frame.bitangent);
    tangent_lanes(Triples::of(&frame.normal), &mut t.x, &mut t.y, &mut t.z, &mut b.x, &mut b.y, &mut b.z);
    if let Some(u) = tangent {
        for lane in 0..tree.lanes {
            let u = Vec3::from_array(u.map(|c| tree.float(c, lane)));
            let axes = Frame::from_normal_and_tangent(frame.normal.get(lane), u);
            frame.tangent.set(lane, axes.tangent);
            frame.bitangent.set(lane, axes.bitangent);
        }
    }
    let axes = [Triples::of(&frame.tangent), Triples::of(&frame.bitangent), Triples::of(&frame.normal)];
    localise_lanes(axes, Triples::of(seen.wo), &mut frame.wo.x, &mut frame.wo.y, &mut frame.wo.z);
}

/// Is any number not +0? Words need no order, as a sum of floats would.
fn any(values: &[f32]) -> bool {
    values.iter().fold(0, |bits, value| bits | value.to_bits()) != 0
}

/// A column of the tree, or another in place of a single number.
fn column_of<'a>(tree: &'a Tree, from: Floats, single: &'a [f32]) -> &'a [f32] {
    match from {
        Floats::Uniform(_) => single,
        Floats::Varying(at) => tree.column(at),
    }
}
