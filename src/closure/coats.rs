//! Coats: the directions under a clear coat, which bends them, and what is lost on the way in and out.
//!
//! A coat has a refracting boundary and an absorbing inside. Each keeps the viewer's and the light's direction as they
//! run inside it, so the lobes below are evaluated there as if nothing lay above. Light that leaves on the other side of
//! the surface does not cross the coat again.
//!
//! Source: Weidlich and Wilkie 2007, eq. 6 to 9: f = f_coat + T_i T_o f_base(wi', wo') exp(-s (1/ci' + 1/co')), with the
//! optical depth s of the coat.
//! Departs from source: T is 1 less the albedo of the boundary's lobe, on both sides, which stands for their factor for
//! light that facets shadow (G): what a rough boundary does not reflect passes.
//!
//! Decision (2026-11-29): all lobes keep the energy of their lobe on the way out (f / eta²), and diffuse ones are brightened by what the
//! boundary throws back at them (`darkening`), because then a white base under a coat sends out all light and a grey one of 0.5 the
//! 0.32 that measured and simulated coats have, instead of the paper's f as it stands, which gives 0.48. A shader has the paper's
//! formula with `"darkening", 0`: diffuse lobes without either factor, all others with f / eta², since a glossy lobe taken as it
//! stands would send out eta² times too much.

use super::batch::LobeColumns;
use super::frames::FrameColumns;
use super::source::Triples;
use crate::bsdf::fresnel::{Dielectric, dielectric};
use crate::bsdf::microfacet::albedo::FacetTable;
use crate::bsdf::microfacet::{Geometry, Ggx, MIN_ALPHA};
use crate::bsdf::select;
use crate::lanes;
use crate::math::columns::Column3;
use crate::math::elementary::exp;
use glam::Vec3;

/// The largest ratio of solid angles or cosines that coats in coats may come to, far beyond any that light passes.
const MOST_RATIO: f32 = 1e8;

/// One coat over what lies under it.
#[derive(Debug, Default)]
pub struct Coat {
    /// The coat around it, or [`super::store::NONE`]; always an earlier one.
    pub parent: u32,
    /// The frame whose normal the coat has.
    frame: u32,
    /// Index of refraction inside over outside; at 0 and below nothing passes.
    eta: Vec<f32>,
    /// GGX width of the boundary, where it is rough.
    alpha: Option<Vec<f32>>,
    /// Optical depth of a perpendicular crossing, when it absorbs.
    depth: Option<Column3>,
    /// Where diffuse lobes are brightened by what the boundary throws back.
    darkens: Vec<bool>,
    /// The part of diffuse light inside that leaves, where that is so.
    escape: Vec<f32>,
    /// The viewer inside, world.
    pub wo: Column3,
    /// The light of the last evaluation inside, world.
    pub wi: Column3,
    /// Part of the light that passes the boundary on the viewer's side.
    pub pass_o: Vec<f32>,
    /// The same on the light's side.
    pub pass_i: Vec<f32>,
    /// What absorption leaves on the viewer's side, all coats around included.
    pub tint_o: Column3,
    /// The same on the light's side.
    pub tint_i: Column3,
    /// Solid angle inside over outside of the light's direction, all coats around included.
    pub density: Vec<f32>,
    /// What f cos of diffuse lobes is multiplied with: `density` over what escapes, whose part is in their weight, or where the
    /// coat does not darken the cosine outside over inside of the light's direction; all coats around included.
    pub spread: Vec<f32>,
    /// True when it, or a coat around it, absorbs.
    pub colored: bool,
}

/// What a coat is made from.
#[derive(Debug)]
pub struct Coating {
    /// The frame of its boundary.
    pub frame: u32,
    /// Index of refraction inside over outside.
    pub eta: Vec<f32>,
    /// GGX width of the boundary, where any lane is rough.
    pub alpha: Option<Vec<f32>>,
    /// Optical depth of a perpendicular crossing, when it absorbs.
    pub depth: Option<Column3>,
    /// Where diffuse lobes are brightened by what the boundary throws back.
    pub darkens: Vec<bool>,
}

/// What a coat's boundary is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Index of refraction inside over outside.
    pub eta: f32,
    /// GGX width, where it is rough.
    pub alpha: Option<f32>,
}

/// All coats of a batch.
#[derive(Debug, Default)]
pub struct Coats {
    list: Vec<Coat>,
}

impl Coats {
    /// Empties the store.
    pub fn clear(&mut self) {
        self.list.clear();
    }

    /// True when there is none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The coat of an index, unless it is [`super::store::NONE`].
    pub fn get(&self, coat: u32) -> Option<&Coat> {
        self.list.get(coat as usize)
    }

    /// Adds the coat under a coat, with what the viewer decides, and gives its index.
    pub fn push(&mut self, parent: u32, coating: Coating, frames: &[FrameColumns], wo: &Column3) -> u32 {
        let n = wo.len();
        let Coating { frame, mut eta, alpha, depth, darkens } = coating;
        for value in &mut eta {
            *value = if value.is_finite() { value.min(1e3) } else { 1.0 };
        }
        let outer = self.get(parent);
        let colored = depth.is_some() || outer.is_some_and(|m| m.colored);
        let mut coat = Coat { parent, frame, eta, alpha, depth, darkens, colored, ..Coat::default() };
        for column in [&mut coat.wo, &mut coat.wi, &mut coat.tint_o, &mut coat.tint_i] {
            column.resize(n);
        }
        for column in [&mut coat.escape, &mut coat.pass_o, &mut coat.pass_i, &mut coat.density, &mut coat.spread] {
            column.resize(n, 1.0);
        }
        let from = Crossing { normal: Triples::of(&frames[frame as usize].normal), eta: &coat.eta };
        let above = Triples::of(outer.map_or(wo, |m| &m.wo));
        let w = &mut coat.wo;
        // The viewer's solid angle and spread are not needed; their columns are filled anew with every light.
        let (density, spread) = (&mut coat.density, &mut coat.spread);
        enter_lanes(from, above, &mut w.x, &mut w.y, &mut w.z, &mut coat.pass_o, density, spread);
        pass_facets(from, above, coat.alpha.as_deref(), &mut coat.pass_o);
        for lane in 0..n {
            let around = outer.filter(|m| m.colored).map_or(Vec3::ONE, |m| m.tint_o.get(lane));
            let cos = frames[frame as usize].normal.get(lane).dot(coat.wo.get(lane));
            coat.tint_o.set(lane, around * absorption(coat.depth.as_ref(), lane, cos));
        }
        self.list.push(coat);
        self.list.len() as u32 - 1
    }

    /// Says what part of diffuse light leaves a coat from inside, above 0.
    pub fn set_escape(&mut self, coat: u32, parts: &[f32]) {
        if let Some(coat) = self.list.get_mut(coat as usize) {
            coat.escape.copy_from_slice(parts);
        }
    }

    /// Brings the light's directions into every coat.
    pub fn light(&mut self, frames: &[FrameColumns], wi: &Column3) {
        for index in 0..self.list.len() {
            let (before, rest) = self.list.split_at_mut(index);
            let coat = &mut rest[0];
            let Coat {
                parent,
                frame,
                eta,
                alpha,
                depth,
                darkens,
                escape,
                wi: inside,
                tint_i,
                pass_i,
                density,
                spread,
                colored,
                ..
            } = coat;
            let outer = before.get(*parent as usize);
            let from = Crossing { normal: Triples::of(&frames[*frame as usize].normal), eta };
            let above = Triples::of(outer.map_or(wi, |m| &m.wi));
            enter_lanes(from, above, &mut inside.x, &mut inside.y, &mut inside.z, pass_i, density, spread);
            pass_facets(from, above, alpha.as_deref(), pass_i);
            for lane in (0..wi.len()).filter(|&lane| darkens[lane]) {
                spread[lane] = density[lane] / escape[lane];
            }
            if let Some(outer) = outer {
                for lane in 0..wi.len() {
                    density[lane] = (density[lane] * outer.density[lane]).min(MOST_RATIO);
                    spread[lane] = (spread[lane] * outer.spread[lane]).min(MOST_RATIO);
                }
            }
            for lane in (0..wi.len()).filter(|_| *colored) {
                let around = outer.filter(|m| m.colored).map_or(Vec3::ONE, |m| m.tint_i.get(lane));
                let cos = frames[*frame as usize].normal.get(lane).dot(inside.get(lane));
                tint_i.set(lane, around * absorption(depth.as_ref(), lane, cos));
            }
        }
    }

    /// The direction outside of all coats that a direction in one becomes; zero when a boundary throws it back.
    pub fn leave(&self, coat: u32, frames: &[FrameColumns], lane: usize, wi: Vec3) -> Vec3 {
        let (mut wi, mut at) = (wi, coat);
        while let Some(coat) = self.get(at) {
            let n = frames[coat.frame as usize].normal.get(lane);
            let (cos, eta) = (n.dot(wi), coat.eta[lane].max(1e-3));
            if cos > 0.0 {
                let outside = 1.0 - eta * eta * (1.0 - cos * cos).max(0.0);
                if outside <= 0.0 {
                    return Vec3::ZERO;
                }
                wi = (wi - n * cos) * eta + n * outside.sqrt();
                wi *= 1.0 / wi.length();
            }
            at = coat.parent;
        }
        wi
    }
}

impl Coat {
    /// Its boundary in a lane.
    pub fn boundary(&self, lane: usize) -> Boundary {
        let alpha = self.alpha.as_ref().map(|alpha| alpha[lane]).filter(|&alpha| alpha >= MIN_ALPHA);
        Boundary { eta: self.eta[lane], alpha }
    }

    /// The optical depth of a perpendicular crossing, when it absorbs.
    pub fn depth(&self, lane: usize) -> Option<Vec3> {
        self.depth.as_ref().map(|depth| depth.get(lane))
    }

    /// True where diffuse lobes are brightened by what the boundary throws back.
    pub fn darkens(&self, lane: usize) -> bool {
        self.darkens[lane]
    }

    /// True when that is so in any lane.
    pub fn darkens_any(&self) -> bool {
        self.darkens.contains(&true)
    }

    /// What absorption leaves on the viewer's side, all coats around included.
    pub fn viewer_tint(&self, lane: usize) -> Vec3 {
        if self.colored { self.tint_o.get(lane) } else { Vec3::ONE }
    }

    /// What absorption leaves on the way in and out, all coats around included.
    pub fn tint(&self, lane: usize) -> Vec3 {
        if self.colored { self.tint_o.get(lane) * self.tint_i.get(lane) } else { Vec3::ONE }
    }

    /// The weight, scale and probability of a lobe, brought from this coat to the outside, as five columns.
    pub fn carry(&self, from: &LobeColumns, diffuse: bool, out: &mut Vec<f32>) {
        let n = self.density.len();
        out.resize(5 * n, 0.0);
        let (weight, rest) = out.split_at_mut(3 * n);
        for (k, given) in [from.weight.x, from.weight.y, from.weight.z].into_iter().enumerate() {
            let tints =
                [(&self.tint_o.x, &self.tint_i.x), (&self.tint_o.y, &self.tint_i.y), (&self.tint_o.z, &self.tint_i.z)];
            let here = &mut weight[k * n..(k + 1) * n];
            here.copy_from_slice(&given[..n]);
            for lane in (0..n).filter(|_| self.colored) {
                here[lane] *= tints[k].0[lane] * tints[k].1[lane];
            }
        }
        let (scale, pick) = rest.split_at_mut(n);
        let spread = if diffuse { &self.spread } else { &self.density };
        for lane in 0..n {
            scale[lane] = from.scale[lane] * spread[lane];
            pick[lane] = from.pick[lane] * self.density[lane];
        }
    }
}

/// What absorption leaves on a path through a coat at this inner cosine; light that leaves below does not cross it.
fn absorption(depth: Option<&Column3>, lane: usize, cos: f32) -> Vec3 {
    match depth {
        Some(depth) if cos > 0.0 => {
            let path = -depth.get(lane) / cos.max(1e-6);
            Vec3::new(exp(path.x), exp(path.y), exp(path.z))
        }
        _ => Vec3::ONE,
    }
}

/// The boundary that [`enter_lanes`] crosses.
#[derive(Clone, Copy)]
struct Crossing<'a> {
    normal: Triples<'a>,
    eta: &'a [f32],
}

/// What a rough boundary lets through where it lets any through: all that its facets do not reflect.
fn pass_facets(from: Crossing, outside: Triples, alpha: Option<&[f32]>, pass: &mut [f32]) {
    let Some(alpha) = alpha else { return };
    for (lane, pass) in pass.iter_mut().enumerate() {
        let cos = from.normal.at(lane).dot(outside.at(lane));
        if alpha[lane] >= MIN_ALPHA && cos > 0.0 && *pass > 0.0 {
            let fresnel = Dielectric::of(from.eta[lane]);
            let reflected = FacetTable::of::<Ggx>(Geometry::Smith).color(&fresnel, alpha[lane].min(1.0), cos.min(1.0));
            *pass = 1.0 - reflected.x;
        }
    }
}

lanes! {
    /// Directions inside a coat from those outside, what part of the light passes the boundary, the ratio of the solid angles
    /// (inside over outside) and that of the cosines (outside over inside). Directions below stay as they are.
    fn enter_lanes(
        from: Crossing<'_>,
        outside: Triples<'_>,
        x: &mut [f32],
        y: &mut [f32],
        z: &mut [f32],
        pass: &mut [f32],
        density: &mut [f32],
        spread: &mut [f32],
    ) {
        let n = x.len();
        let (y, z, pass) = (&mut y[..n], &mut z[..n], &mut pass[..n]);
        let (density, spread, eta) = (&mut density[..n], &mut spread[..n], &from.eta[..n]);
        let (normal, outside) = (from.normal.narrow(n), outside.narrow(n));
        for i in 0..n {
            let (m, w, eta) = (normal.at(i), outside.at(i), eta[i]);
            let cos = m.dot(w);
            let above = cos > 0.0;
            let inverse = 1.0 / eta.max(1e-3);
            let inner2 = 1.0 - inverse * inverse * (1.0 - cos * cos).max(0.0);
            // Into a lighter coat some light does not come in at all.
            let lost = above && inner2 <= 1e-6;
            let inner = inner2.max(1e-6).sqrt();
            let bent = (w - m * cos) * inverse + m * inner;
            let bent = bent * (1.0 / bent.dot(bent).max(1e-12).sqrt());
            x[i] = select(above, bent.x, w.x);
            y[i] = select(above, bent.y, w.y);
            z[i] = select(above, bent.z, w.z);
            pass[i] = select(lost, 0.0, select(above, 1.0 - dielectric(cos, eta), 1.0));
            spread[i] = select(lost, 0.0, select(above, cos / inner, 1.0));
            density[i] = select(lost, 0.0, select(above, inverse * inverse * cos / inner, 1.0));
        }
    }
}
