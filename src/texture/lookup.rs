//! Looking a texture up: the ellipse that a pixel covers, probes along its long axis, and two levels of the pyramid.
//!
//! Decision (2026-11-29): probes with the weights of a Gaussian along the long axis (McCormack, Perry, Farkas and Jouppi 1999,
//! and as OpenImageIO has them), each of them bilinear in two levels that follow the short axis, and bicubic in the finest,
//! because against a Gaussian over the ellipse summed in f64 the error of oblique stripes is a small part of that of one
//! trilinear probe, which blurs by the long axis, and a look-up that is not oblique costs one probe; instead of summing every
//! texel of the ellipse (Heckbert 1989), whose cost grows with the ellipse.
//!
//! Decision (2026-11-29): ellipses, and where probes lie among texels, are worked out for eight places at once, while texels are fetched and
//! joined a probe at a time with the channels together, because a bilinear look-up then takes 15 ns instead of 40 and one of seven probes in two
//! levels 200 ns instead of 500, with the same bits; instead of all of it a probe at a time, or of texels gathered a channel at a time.
//!
//! Decision (2026-11-29): where levels are read whose texels are wider than two pixels, as `blur` and `width` ask for, those are joined
//! bicubically as the finest one is, because bilinear texels that large show as a plaid; as OpenImageIO's "smartcubic" has it, of whose
//! pictures ours then differ by .3/255 on average instead of 6.8/255 (a grid of 1024 texels under a width of 3 to 10 pixels).

use super::ellipse::{PLACES, Probes, Row};
use super::join::{Corners, Joined, Plane, folded};
use super::pyramid::Texture;
use super::sample::{Interpolation, Lookup, Sample};
use super::wrap::Wrap;
use crate::lanes;

lanes! {
    /// [`Texture::value`] of all lanes that are lit: columns of s, t and their slopes, each of all lanes or of one number for all; a column
    /// a channel.
    pub fn values(texture: &Texture, places: &[&[f32]; 6], how: &Lookup, lit: &[i32], out: &mut [Vec<f32>]) {
        let points = places[2..].iter().all(|slope| **slope == [0.0]) && how.blur == [0.0; 2];
        for (block, lit) in lit.chunks(PLACES).enumerate() {
            let first = block * PLACES;
            let mut rows = [[0.0; PLACES]; 6];
            for (row, column) in rows.iter_mut().zip(places) {
                match **column {
                    [one] => *row = [one; PLACES],
                    _ => row[..lit.len()].copy_from_slice(&column[first..first + lit.len()]),
                }
            }
            let [s, t, slopes @ ..] = rows;
            let found = if points { texture.points(s, t, how, lit) } else { texture.footprints(s, t, &slopes, how, lit) };
            for (i, _) in lit.iter().enumerate().filter(|(_, lit)| **lit != 0) {
                for (out, value) in out.iter_mut().zip(found[i]) {
                    out[first + i] = value;
                }
            }
        }
    }
}

/// The levels that a look-up reads.
struct Planes<'a> {
    /// What is outside of them.
    wrap: [Wrap; 2],
    coarse: Plane<'a>,
    /// The level before it; the same where one is enough.
    fine: Plane<'a>,
    /// The part of the coarser level where there are two.
    part: Option<f32>,
}

impl Planes<'_> {
    /// Where places lie in the coarser and in the finer level.
    #[inline(always)]
    fn corners(&self, s: Row, t: Row) -> [Corners; 2] {
        let (s, t) = (folded(s, self.wrap[0]), folded(t, self.wrap[1]));
        let fine = if self.part.is_some() { self.fine.corners(&s, &t) } else { Corners::default() };
        [self.coarse.corners(&s, &t), fine]
    }

    /// One probe between the levels.
    #[inline(always)]
    fn join<const G: bool>(&self, corners: &[Corners; 2], i: usize) -> Joined {
        let coarse = self.coarse.join::<G>(&corners[0], i);
        let Some(part) = self.part else { return coarse };
        let fine = self.fine.join::<G>(&corners[1], i);
        let mut out = fine;
        out.add::<G>(part, &fine, &coarse);
        out
    }
}

impl Texture {
    /// Looks up at (s, t), with t = 0 at the top; `slopes` are ds/dx, dt/dx, ds/dy, dt/dy of a pixel. Coordinates that are not finite give the
    /// fill.
    pub fn lookup(&self, s: f32, t: f32, slopes: [f32; 4], how: &Lookup) -> Sample {
        self.look_up::<true>(s, t, slopes, how)
    }

    /// The same without the changes along s and t, which are then zero.
    pub fn value(&self, s: f32, t: f32, slopes: [f32; 4], how: &Lookup) -> [f32; 4] {
        self.look_up::<false>(s, t, slopes, how).value
    }

    /// The values of lit places that cover no more than a point.
    #[inline(always)]
    fn points(&self, s: Row, t: Row, how: &Lookup, lit: &[i32]) -> [[f32; 4]; PLACES] {
        let mut out = [[how.fill; 4]; PLACES];
        let planes = self.planes(0.0, [0.0; 2], how);
        let corners = planes.corners(s, t);
        for (i, lit) in lit.iter().enumerate() {
            if *lit != 0 && s[i].is_finite() && t[i].is_finite() {
                out[i] = planes.join::<false>(&corners, i).sample().value;
            }
        }
        out
    }

    /// The values of lit places that cover ellipses.
    #[inline(always)]
    fn footprints(&self, s: Row, t: Row, slopes: &[Row; 4], how: &Lookup, lit: &[i32]) -> [[f32; 4]; PLACES] {
        let mut out = [[how.fill; 4]; PLACES];
        let probes = Probes::of(slopes, self.size(), how);
        for (i, lit) in lit.iter().enumerate() {
            if *lit != 0 && s[i].is_finite() && t[i].is_finite() {
                out[i] = self.probe::<false>([s[i], t[i]], &probes, i, how).value;
            }
        }
        out
    }

    fn look_up<const G: bool>(&self, s: f32, t: f32, slopes: [f32; 4], how: &Lookup) -> Sample {
        if !s.is_finite() || !t.is_finite() {
            return Sample { value: [how.fill; 4], ..Sample::default() };
        }
        let [a, b, c, d] = slopes;
        let probes = Probes::of(&[[a; PLACES], [b; PLACES], [c; PLACES], [d; PLACES]], self.size(), how);
        self.probe::<G>([s, t], &probes, 0, how)
    }

    /// The sum of the probes of a place.
    #[inline(always)]
    fn probe<const G: bool>(&self, [s, t]: [f32; 2], probes: &Probes, place: usize, how: &Lookup) -> Sample {
        let (count, step) = (probes.count[place], [probes.step[0][place], probes.step[1][place]]);
        let planes = self.planes(probes.short[place], [probes.pixel[0][place], probes.pixel[1][place]], how);
        if count == 1 {
            return planes.join::<G>(&planes.corners([s; PLACES], [t; PLACES]), 0).sample();
        }
        let mut bell = probes.bell(place);
        let (mut first, mut sum, mut total) = (Joined::default(), Joined::default(), 0.0);
        for from in (0..count).step_by(PLACES) {
            let (mut along_s, mut along_t) = ([0.0; PLACES], [0.0; PLACES]);
            for i in 0..PLACES {
                let x = (2.0 * (from + i as u32) as f32 + 1.0) / count as f32 - 1.0;
                (along_s[i], along_t[i]) = (s + x * step[0], t + x * step[1]);
            }
            let corners = planes.corners(along_s, along_t);
            for i in 0..PLACES.min((count - from) as usize) {
                let probe = planes.join::<G>(&corners, i);
                // Sums of differences from one probe, so that a constant stays one to the last bit.
                first = if from as usize + i == 0 { probe } else { first };
                let weight = bell.next();
                sum.add::<G>(weight, &first, &probe);
                total += weight;
            }
        }
        let mut out = first;
        out.add::<G>(1.0 / total, &Joined::default(), &sum);
        out.sample()
    }

    /// The two levels between whose texels a half axis lies, and the part of the coarser; that alone where the half axis is a texel of it.
    /// `pixel` is as in [`Probes`].
    #[inline(always)]
    fn planes<'a>(&'a self, half_axis: f32, pixel: [f32; 2], how: &'a Lookup) -> Planes<'a> {
        let (level, part) = self.level_of(half_axis);
        let wrap = [how.wrap[0].unwrap_or(self.wrap()[0]), how.wrap[1].unwrap_or(self.wrap()[1])];
        let coarse = Plane::new(self.level(level), self.is_large(level, pixel, how), wrap, how);
        if level == 0 || part >= 1.0 {
            return Planes { wrap, coarse, fine: coarse, part: None };
        }
        let fine = Plane::new(self.level(level - 1), self.is_large(level - 1, pixel, how), wrap, how);
        Planes { wrap, coarse, fine, part: Some(part) }
    }

    /// Is a level the finest, or one whose texels are wider than two pixels along s or t? The second is found only where a look-up asks.
    #[inline(always)]
    fn is_large(&self, level: usize, pixel: [f32; 2], how: &Lookup) -> bool {
        let [width, height] = self.size();
        // Fewer texels than whole pairs of pixels.
        let few = |texels: usize, pixel: f32| ((texels >> level).max(1) + 1) as f32 * (2.0 * pixel) <= 1.0;
        let [s, t] = pixel;
        level == 0 || how.interpolation == Interpolation::Smart && (few(width, s) || few(height, t))
    }

    /// The coarser of the two levels between whose texels a half axis lies, and its part: all of it where the half axis is a texel of it.
    #[inline(always)]
    fn level_of(&self, half_axis: f32) -> (usize, f32) {
        let last = self.level_count() - 1;
        let mut texels = half_axis;
        for level in 0..=last {
            if texels <= 1.0 {
                return if level == 0 { (0, 1.0) } else { (level, (2.0 * texels - 1.0).clamp(0.0, 1.0)) };
            }
            texels *= 0.5;
        }
        (last, 1.0)
    }
}
