//! What parts of one picture have in common: everything that decides what a sample is.

use super::super::settings::Settings;
use crate::exec::Group;
use crate::ir::print::listing;
use crate::scene::{Geometry, Scene, Shape};
use crate::texture::{is_tiled, tile_name};
use glam::{Vec2, Vec3};
use std::fmt::Write;
use std::io::Read;

/// A number that stands for what `scene` and `settings` make of a sample: two that differ have other samples, two of one number have
/// the same but for chance (2^-64).
///
/// It covers geometry, materials, camera, background, the files of textures and dictionaries that shaders name in their text, and the
/// settings that change a sample. It does not cover the content of files whose names shaders put together while they run, but for the tiles of
/// `<UDIM>`: whoever changes such a texture between two parts merges samples of two pictures unnoticed.
/// How many samples there are, threads, and the sizes of batches and tiles do not change a sample.
pub fn fingerprint(scene: &Scene, settings: &Settings) -> u64 {
    let mut digest = Digest::default();
    let _ = write!(digest, "{:?} {:?}", scene.camera, scene.background);
    let Settings { width, height, seed, max_bounces, rr_depth, jitter, alpha, .. } = *settings;
    let _ = write!(digest, "{:?}", (width, height, seed, max_bounces, rr_depth, jitter, alpha));
    let _ = write!(digest, "{:?}", (settings.frame, settings.filter));
    let Settings { lights, light_choice, light_points, terminator, show_globals, closure, .. } = *settings;
    let _ = write!(digest, "{:?}", (lights, light_choice, light_points, terminator, show_globals, closure));
    for material in &scene.materials {
        let _ = write!(digest, "material {} ", material.is_light);
        [Some(&material.surface), material.displacement.as_ref()].into_iter().flatten().for_each(|group| {
            digest.group(scene, group);
        });
    }
    digest.geometry(&scene.geometry);
    digest.finish()
}

/// Bytes that are hashed a piece at a time. The hash of a piece is FarmHash's (Google 2014), which is the same on every machine.
#[derive(Default)]
struct Digest {
    state: u64,
    piece: Vec<u8>,
}

/// Bytes of a piece.
const PIECE: usize = 1 << 16;

impl Digest {
    /// Takes bytes; how they come in pieces does not show.
    fn bytes(&mut self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            let (now, later) = bytes.split_at(bytes.len().min(PIECE - self.piece.len()));
            self.piece.extend_from_slice(now);
            bytes = later;
            if self.piece.len() == PIECE {
                self.turn();
            }
        }
    }

    fn turn(&mut self) {
        self.piece.extend_from_slice(&self.state.to_le_bytes());
        self.state = farmhash::fingerprint64(&self.piece);
        self.piece.clear();
    }

    fn finish(mut self) -> u64 {
        self.turn();
        self.state
    }

    fn numbers(&mut self, numbers: &[u32]) {
        numbers.iter().for_each(|number| self.bytes(&number.to_le_bytes()));
    }

    fn point(&mut self, point: Vec3) {
        self.numbers(&point.to_array().map(f32::to_bits));
    }

    fn group(&mut self, scene: &Scene, group: &Group) {
        self.bytes(listing(group.program(), group.table()).as_bytes());
        for text in group.program().texts() {
            self.file(scene, text);
            if is_tiled(text) {
                let tiles = (0..100).map(|i| [(i % 10) as f32 + 0.5, (i / 10) as f32 + 0.5]);
                tiles.filter_map(|[s, t]| tile_name(text, s, t)).for_each(|name| self.file(scene, &name));
            }
        }
    }

    /// The content of the file that a shader's text names, if it names one.
    fn file(&mut self, scene: &Scene, name: &str) {
        // What cannot be read, or is too large, is told by the render.
        let Some((file, size)) = scene.textures.open(name) else { return };
        let _ = write!(self, "file {name:?} {size} ");
        let mut file = file.take(size);
        let mut piece = vec![0; PIECE];
        while let Ok(count @ 1..) = file.read(&mut piece) {
            self.bytes(&piece[..count]);
        }
    }

    fn geometry(&mut self, geometry: &Geometry) {
        for primitive in &geometry.primitives {
            match primitive.shape {
                Shape::Sphere { center, radius } => {
                    self.point(center);
                    self.numbers(&[radius.to_bits()]);
                }
                Shape::Quad { corner: a, edge_x: b, edge_y: c } | Shape::Triangle { a, b, c } => {
                    [a, b, c].into_iter().for_each(|point| self.point(point));
                }
            }
            let kind = match primitive.shape {
                Shape::Sphere { .. } => 0,
                Shape::Quad { .. } => 1,
                Shape::Triangle { .. } => 2,
            };
            self.numbers(&[kind, primitive.object, primitive.normals, primitive.uvs]);
        }
        for object in &geometry.objects {
            self.numbers(&[object.material, object.surface_area.to_bits()]);
        }
        geometry.normals.iter().flatten().for_each(|normal| self.point(*normal));
        let uv = |uv: &Vec2| uv.to_array().map(f32::to_bits);
        geometry.uvs.iter().flatten().for_each(|place| self.numbers(&uv(place)));
        geometry.resolutions.iter().for_each(|(primitive, steps)| self.numbers(&[*primitive, *steps]));
    }
}

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.bytes(text.as_bytes());
        Ok(())
    }
}
