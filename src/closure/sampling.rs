//! Sampling: pick one lobe a lane, sample it, weigh the direction by the whole mixture.

use super::batch::{Triples, pick_lanes, rest_lanes, sample_lanes, weigh_lanes};
use super::kinds::Kind;
use super::kinds::with_source;
use super::lobes::{Evaluation, Lobes};
use super::surfaces::NONE;
use crate::bsdf::specular::{Specular, reflection, refraction};
use crate::math::columns::Column3;
use crate::math::frame::Frame;
use glam::Vec3;

/// What happened in a lane.
pub mod event {
    /// Absorbed.
    pub const NONE: u8 = 0;
    /// Scattered by a diffuse or sheen lobe.
    pub const DIFFUSE: u8 = 1;
    /// Scattered by a rough boundary.
    pub const GLOSSY: u8 = 2;
    /// Reflected by a mirror.
    pub const DELTA_REFLECT: u8 = 3;
    /// Refracted by a smooth boundary.
    pub const DELTA_REFRACT: u8 = 4;
    /// Passed straight on.
    pub const STRAIGHT: u8 = 5;
}

/// One sampled direction a lane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// Direction to the light, world, unit.
    pub wi: Column3,
    /// f |cos| / pdf of the whole mixture.
    pub weight: Column3,
    /// Density (solid angle, 1/sr); for lobes of one direction the discrete probability; 0 = absorbed.
    pub pdf: Vec<f32>,
    /// What happened, see [`event`].
    pub event: Vec<u8>,
}

/// Scratch memory of sampling.
#[derive(Debug, Default)]
pub struct SampleScratch {
    left: Vec<f32>,
    chosen: Vec<u32>,
    xi: Column3,
    parts: Column3,
    evaluation: Evaluation,
}

impl Lobes {
    /// Samples one direction a lane from three numbers in [0, 1) a lane.
    pub fn sample(&mut self, xi: &Column3, out: &mut Samples) {
        let n = self.lanes;
        out.weight.resize(n);
        out.wi.resize(n);
        for column in [&mut out.wi.x, &mut out.wi.y, &mut out.wi.z] {
            column.fill(0.0);
        }
        out.pdf.clear();
        out.pdf.resize(n, 0.0);
        out.event.clear();
        out.event.resize(n, event::NONE);
        self.choose(xi);
        self.draw(&mut out.wi);
        self.leave_media(&mut out.wi);
        let mut evaluation = std::mem::take(&mut self.scratch.evaluation);
        self.evaluate(&out.wi, &mut evaluation);
        let (x, y, z) = (&mut out.weight.x, &mut out.weight.y, &mut out.weight.z);
        weigh_lanes(Triples::of(&evaluation.f_cos), &evaluation.pdf, x, y, z, &mut out.pdf);
        self.scratch.evaluation = evaluation;
        let mut events = self.lobes.iter().map(|lobe| self.surfaces.list[lobe.surface as usize].kind.event());
        let first = events.next().unwrap_or(event::NONE);
        let scatters = matches!(first, event::DIFFUSE | event::GLOSSY);
        if scatters && events.all(|event| event == first) {
            // The common case: lobes of one kind, all of which have a density.
            for (event, pdf) in out.event.iter_mut().zip(&out.pdf) {
                *event = if *pdf > 0.0 { first } else { event::NONE };
            }
            return;
        }
        for lane in 0..n {
            self.settle(lane, out);
        }
    }

    /// Picks a lobe in every lane by the first number, whose remainder serves as a fresh one.
    ///
    /// Decision (2026-11-22): by the first and not by the third number, because a lobe then gets a strip of the square of
    /// the first two, which is filled as evenly as the whole: 7 % less squared error where sheen lies over a diffuse
    /// base with a white tint, 2 % in figure 1. The third is left to the models. What a lobe gets has as many bits fewer as its
    /// probability has: one that is picked a thousandth of the time has 2^13 directions along one side of the square.
    fn choose(&mut self, xi: &Column3) {
        let n = self.lanes;
        let scratch = &mut self.scratch;
        scratch.xi.clone_from(xi);
        scratch.left.clone_from(&xi.x);
        scratch.chosen.clear();
        scratch.chosen.resize(n, NONE);
        scratch.parts.resize(n);
        for index in 0..self.lobes.len() {
            let pick = &self.picks[index * n..(index + 1) * n];
            pick_lanes(index as u32, pick, &mut scratch.left, &mut scratch.xi.x, &mut scratch.chosen);
        }
        rest_lanes(NONE, &self.last, &mut scratch.xi.x, &mut scratch.chosen);
    }

    /// Draws the directions, lobe by lobe; lobes that no lane chose cost nothing.
    fn draw(&mut self, wi: &mut Column3) {
        let SampleScratch { chosen, xi, parts, left, .. } = &mut self.scratch;
        // The remainders are done with: their column now counts, by lobe, whether a lane chose it.
        left.clear();
        left.resize(self.lobes.len(), 0.0);
        for &lobe in chosen.iter().filter(|&&lobe| lobe != NONE) {
            left[lobe as usize] = 1.0;
        }
        for index in 0..self.lobes.len() {
            if left[index] == 0.0 {
                continue;
            }
            let surface = &self.surfaces.list[self.lobes[index].surface as usize];
            if surface.kind.is_delta() {
                for lane in (0..self.lanes).filter(|&lane| chosen[lane] == index as u32) {
                    if surface.kind == Kind::Transparent {
                        wi.set(lane, -self.wo.get(lane));
                        parts.set(lane, Vec3::ONE);
                        continue;
                    }
                    let frame = &self.surfaces.frames()[surface.frame as usize];
                    let (local, params) = (frame.wo.get(lane), self.surfaces.params(surface, lane));
                    let Specular { wi: to, part } = match surface.kind {
                        Kind::Refraction(term) => refraction(local, term, params),
                        Kind::Reflection(term) => reflection(local, term, params),
                        _ => continue,
                    };
                    let axes = Frame {
                        tangent: frame.tangent.get(lane),
                        bitangent: frame.bitangent.get(lane),
                        normal: frame.normal.get(lane),
                    };
                    wi.set(lane, axes.to_world(to));
                    parts.set(lane, part);
                }
                continue;
            }
            let frame = &self.surfaces.frames()[surface.frame as usize];
            let viewer = (Triples::of(&frame.wo), self.surfaces.views(surface));
            let (axes, xi, mine) = (frame.axes(), Triples::of(xi), (chosen.as_slice(), index as u32));
            let (x, y, z) = (&mut wi.x, &mut wi.y, &mut wi.z);
            with_source!(self.surfaces, surface, |M, source| sample_lanes::<M, _>(
                source, viewer, axes, xi, mine, x, y, z
            ));
        }
    }

    /// Brings the directions that were drawn inside a medium to the outside.
    fn leave_media(&self, wi: &mut Column3) {
        for lane in (0..self.lanes).filter(|_| !self.media.is_empty()) {
            let Some(lobe) = self.lobes.get(self.scratch.chosen[lane] as usize) else { continue };
            let frame = self.surfaces.list[lobe.surface as usize].frame;
            if let Some(frame) = self.surfaces.frames().get(frame as usize) {
                wi.set(lane, self.media.leave(frame.medium, self.surfaces.frames(), lane, wi.get(lane)));
            }
        }
    }

    /// Names the event of a lane, and weighs lobes of one direction, which the evaluation knows nothing of.
    fn settle(&self, lane: usize, out: &mut Samples) {
        let chosen = self.scratch.chosen[lane];
        if chosen == NONE {
            return;
        }
        let (n, lobe) = (self.lanes, self.lobes[chosen as usize]);
        let kind = self.surfaces.list[lobe.surface as usize].kind;
        if kind.is_delta() {
            let visible = match kind {
                Kind::Reflection(_) => self.side[lane] > 0.0,
                Kind::Refraction(_) => self.side[lane] < 0.0,
                _ => true,
            };
            let pick = self.picks[chosen as usize * n + lane];
            let scale = self.layers.scale_of(lobe.layer, &self.ones)[lane];
            let part = if visible { self.scratch.parts.get(lane) * (scale / pick) } else { Vec3::ZERO };
            let at = 3 * n * chosen as usize + lane;
            let weight = Vec3::new(self.weights[at], self.weights[at + n], self.weights[at + 2 * n]) * part;
            let tint = self.media.get(self.layers.medium(lobe.layer)).map_or(Vec3::ONE, |medium| medium.tint(lane));
            let weight = weight * tint;
            let good = weight.is_finite() && weight != Vec3::ZERO;
            out.weight.set(lane, if good { weight } else { Vec3::ZERO });
            out.pdf[lane] = if good { pick } else { 0.0 };
        }
        if out.pdf[lane] > 0.0 {
            out.event[lane] = kind.event();
        }
    }
}
