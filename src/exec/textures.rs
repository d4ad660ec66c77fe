//! Looking up textures lane by lane: which file, how, and what is told when there is none.

use super::lane::Lane;
use super::report::Mistake;
use super::run::{Run, TextureFound as Found};
use crate::ir::op::{AttributeType, TextureCall};
use crate::ir::program::Reg;
use crate::lang::symbols::Symbol;
use crate::ops::color::{ColorSpace, transformc};
use crate::texture::{
    Interpolation, Lookup, Sample, Texture, Up, Wrap, is_tiled, latitude_longitude, tile_name, values,
};
use velour_grammar::Span;

/// Where the parts of a call's sources begin.
struct Layout {
    floats: usize,
    ints: usize,
    strings: usize,
}

impl Layout {
    fn of(call: TextureCall) -> Self {
        let floats = 1 + call.coordinates() as usize;
        Layout { floats, ints: floats + 9, strings: floats + 12 }
    }
}

/// The options of a call in a lane.
struct How {
    lookup: Lookup,
    missing: [Option<f32>; 4],
    space: Option<ColorSpace>,
}

impl Run<'_> {
    /// The texture of a name, as the host gave it in this batch.
    fn texture_of(&mut self, name: &str) -> Found {
        if let Some((_, known)) = self.s.textures.iter().find(|(known, _)| known == name) {
            return known.clone();
        }
        let found = self.host.texture(name);
        self.s.textures.push((name.to_owned(), found.clone()));
        found
    }

    /// The texture of a file and a place, which is then inside of it: of many files the one of the tile.
    fn texture_at(&mut self, symbol: i32, s: &mut f32, t: &mut f32) -> Found {
        if let Some((_, known)) = self.s.texture_symbols.iter().find(|(known, _)| *known == symbol) {
            return known.clone();
        }
        let name = self.tree.strings.text(Symbol(symbol)).to_owned();
        if is_tiled(&name) {
            let tile = tile_name(&name, s.floor(), t.floor());
            (*s, *t) = (*s - s.floor(), *t - t.floor());
            return match tile {
                Some(tile) => self.texture_of(&tile),
                None => Err(format!("there is no tile of `{name}` here")),
            };
        }
        let found = self.texture_of(&name);
        self.s.texture_symbols.push((symbol, found.clone()));
        found
    }

    /// Of a texture of many files one that there is, for what is asked of all of them.
    fn any_tile(&mut self, symbol: i32) -> Found {
        let name = self.tree.strings.text(Symbol(symbol)).to_owned();
        let tiles = (0..100).filter(|_| is_tiled(&name)).map(|i| ((i % 10) as f32, (i / 10) as f32));
        for tile in tiles.filter_map(|(u, v)| tile_name(&name, u, v)) {
            let found = self.texture_of(&tile);
            if found.is_ok() {
                return found;
            }
        }
        Err(format!("there is no tile of `{name}`"))
    }

    fn how(&self, call: TextureCall, src: &[Reg], lane: usize) -> How {
        let at = Layout::of(call);
        let args = Lane { run: self, src, lane };
        let f = |i: usize| args.f(at.floats + i);
        let environment = call.environment.then_some([Wrap::Periodic, Wrap::Clamp]);
        let wrap = |i: usize| environment.map(|wrap| wrap[i]).or_else(|| Wrap::from_name(args.s(at.strings + i)));
        let lookup = Lookup {
            wrap: [wrap(0), wrap(1)],
            interpolation: Interpolation::from_name(args.s(at.strings + 2)).unwrap_or_default(),
            width: [f(0), f(1)],
            blur: [f(2), f(3)],
            first: args.i(at.ints).max(0) as u32,
            fill: f(4),
        };
        let given = args.i(at.ints + 2);
        let color = |i: usize| (given & 1 != 0).then(|| f(5 + i));
        let missing = [color(0), color(1), color(2), (given & 2 != 0).then(|| f(8))];
        let space = args.s(at.strings + 4);
        How { lookup, missing, space: ColorSpace::from_name(space).filter(|_| !space.is_empty()) }
    }

    /// Looks all lanes up at once, where they ask one texture, in one way, for nothing but the value; false where they do not.
    fn texture_alike(&mut self, call: TextureCall, dst: &[Reg], src: &[Reg]) -> bool {
        let Some(first) = self.s.mask[..self.n].iter().position(|lit| *lit != 0) else { return true };
        if call.environment || call.slopes || !self.uniform(src[0]) {
            return false;
        }
        let args = Lane { run: self, src, lane: first };
        let (symbol, how) = (args.i(0), self.how(call, src, first));
        if how.space.is_some() || is_tiled(self.tree.strings.text(Symbol(symbol))) {
            return false;
        }
        let Ok(texture) = self.texture_at(symbol, &mut 0.0, &mut 0.0) else { return false };
        let (n, count) = (call.channels as usize, call.channels as usize + 1);
        let mut out: [Vec<f32>; 4] = Default::default();
        for (column, reg) in out.iter_mut().zip(&dst[..count]) {
            *column = std::mem::take(&mut self.regs.floats[reg.0 as usize]);
        }
        let places = [1, 2, 3, 4, 5, 6].map(|k| self.regs.f(src[k]));
        values(&texture, &places, &how.lookup, &self.s.mask[..self.n], &mut out[..count]);
        if covers(&texture, &how.lookup, n) {
            out[n].iter_mut().zip(&self.s.mask).filter(|(_, lit)| **lit != 0).for_each(|(value, _)| *value = 1.0);
        }
        for (column, reg) in out.iter_mut().zip(&dst[..count]) {
            self.regs.floats[reg.0 as usize] = std::mem::take(column);
        }
        for (reg, value) in dst[dst.len() - 2..].iter().zip([1, 0]) {
            // The empty text is symbol 0.
            let column = &mut self.regs.ints[reg.0 as usize];
            column.iter_mut().zip(&self.s.mask).filter(|(_, lit)| **lit != 0).for_each(|(out, _)| *out = value);
        }
        true
    }

    pub(super) fn texture(&mut self, call: TextureCall, dst: &[Reg], src: &[Reg], span: Span) {
        let n = call.channels as usize;
        let at = Layout::of(call);
        let alike = src[at.floats..].iter().all(|&reg| self.uniform(reg));
        if alike && self.texture_alike(call, dst, src) {
            return;
        }
        let mut shared = None;
        // Most batches look up one file: it is asked for once.
        let (mut latest, mut tiled): (Option<(i32, Found)>, bool) = (None, false);
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            let own;
            let how = if alike {
                &*shared.get_or_insert_with(|| self.how(call, src, lane))
            } else {
                own = self.how(call, src, lane);
                &own
            };
            let args = Lane { run: self, src, lane };
            let (mut place, slopes) = if call.environment { around(&args) } else { flat(&args) };
            let symbol = args.i(0);
            let [s, t] = &mut place;
            let known = latest.as_ref().is_some_and(|(known, _)| *known == symbol && !tiled);
            if !known {
                tiled = is_tiled(self.tree.strings.text(Symbol(symbol)));
                latest = Some((symbol, self.texture_at(symbol, s, t)));
            }
            let Some((_, found)) = &latest else { continue };
            let (value, dx, dy) = match found {
                Ok(texture) => sampled(texture, place, slopes, how, (n, call.slopes)),
                Err(_) => {
                    let value = std::array::from_fn(|c| how.missing[if c == n { 3 } else { c.min(2) }].unwrap_or(0.0));
                    (value, [0.0; 4], [0.0; 4])
                }
            };
            self.put_sample(call, dst, lane, [value, dx, dy]);
            let (ok, message) = (dst[dst.len() - 2], dst[dst.len() - 1]);
            self.regs.ints[ok.0 as usize][lane] = i32::from(found.is_ok());
            let text = found.as_ref().err().cloned().unwrap_or_default();
            // The empty text is symbol 0, which need not be looked for.
            let word = if text.is_empty() { 0 } else { self.tree.strings.symbol(&text).0 };
            self.regs.ints[message.0 as usize][lane] = word;
            if !text.is_empty() && !call.asks && how.missing.iter().all(Option::is_none) {
                let reason = text.clone();
                self.report_once(lane, span, Mistake::Texture { reason }, text);
            }
        }
    }

    /// Channels and alpha, then where derivatives are wanted those along x and along y.
    fn put_sample(&mut self, call: TextureCall, dst: &[Reg], lane: usize, rows: [[f32; 4]; 3]) {
        let count = call.channels as usize + 1;
        for (row, regs) in rows.iter().zip(dst[..dst.len() - 2].chunks(count)) {
            for (reg, value) in regs.iter().zip(row) {
                self.regs.floats[reg.0 as usize][lane] = *value;
            }
        }
    }

    pub(super) fn texture_info(&mut self, ty: AttributeType, dst: &[Reg], src: &[Reg]) {
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            let args = Lane { run: self, src, lane };
            let (symbol, name, mut s, mut t) = (args.i(0), args.s(1).to_owned(), args.f(2), args.f(3));
            let mut found = self.texture_at(symbol, &mut s, &mut t);
            if found.is_err() {
                found = self.any_tile(symbol);
            }
            let there = self.put_info(ty, &dst[1..], lane, &name, found.as_deref().ok());
            self.regs.ints[dst[0].0 as usize][lane] = i32::from(there);
        }
    }

    /// What is known of a texture, by the names that OSL gives; false for what is not known as this type.
    ///
    /// Differs from OSL: the data window is the display window, in which the data of a file have been placed.
    fn put_info(&mut self, ty: AttributeType, dst: &[Reg], lane: usize, name: &str, texture: Option<&Texture>) -> bool {
        if name == "exists" && ty == AttributeType::Ints(1) {
            self.regs.ints[dst[0].0 as usize][lane] = i32::from(texture.is_some());
            return true;
        }
        let Some(texture) = texture else { return false };
        let [width, height] = texture.size().map(|side| side as i32);
        let channels = texture.channels() as i32;
        let ints: Vec<i32> = match (name, ty) {
            ("resolution", AttributeType::Ints(2)) => vec![width, height],
            ("resolution", AttributeType::Ints(3)) => vec![width, height, 1],
            ("datawindow" | "displaywindow", AttributeType::Ints(4)) => vec![0, 0, width - 1, height - 1],
            ("datawindow" | "displaywindow", AttributeType::Ints(6)) => vec![0, 0, 0, width - 1, height - 1, 0],
            ("channels", AttributeType::Ints(1)) => vec![channels],
            ("subimages" | "miplevels", AttributeType::Ints(1)) => vec![1],
            _ => Vec::new(),
        };
        let text = match (name, ty) {
            ("type", AttributeType::Strings(1)) => "texture".to_owned(),
            ("texturetype", AttributeType::Strings(1)) => "Plain Texture".to_owned(),
            ("textureformat", AttributeType::Strings(1)) => "Plain Texture".to_owned(),
            ("wrapmodes", AttributeType::Strings(1)) => texture.wrap().map(Wrap::name).join(","),
            _ => String::new(),
        };
        let mean = texture.mean();
        let floats: Vec<f32> = match (name, ty) {
            ("channels", AttributeType::Floats(1)) => vec![channels as f32],
            ("averagecolor", AttributeType::Floats(count)) => {
                (0..count as usize).map(|c| mean.get(c).copied().unwrap_or(0.0)).collect()
            }
            ("averagealpha", AttributeType::Floats(1)) if channels == 4 => vec![mean[3]],
            _ => Vec::new(),
        };
        for (reg, value) in dst.iter().zip(&ints) {
            self.regs.ints[reg.0 as usize][lane] = *value;
        }
        for (reg, value) in dst.iter().zip(&floats) {
            self.regs.floats[reg.0 as usize][lane] = *value;
        }
        if !text.is_empty() {
            self.regs.ints[dst[0].0 as usize][lane] = self.tree.strings.symbol(&text).0;
        }
        !ints.is_empty() || !floats.is_empty() || !text.is_empty()
    }
}

/// s, t and their slopes.
fn flat(args: &Lane) -> ([f32; 2], [f32; 4]) {
    ([args.f(1), args.f(2)], [args.f(3), args.f(4), args.f(5), args.f(6)])
}

/// The s and t of a direction, and their slopes by differences, which go the short way around.
fn around(args: &Lane) -> ([f32; 2], [f32; 4]) {
    let [r, dx, dy] = [1, 4, 7].map(|at| args.triple(at));
    let here = latitude_longitude(r, Up::Y);
    let slope = |d: [f32; 3]| {
        let there = latitude_longitude(std::array::from_fn(|i| r[i] + d[i]), Up::Y);
        let ds = there[0] - here[0];
        [ds - crate::math::elementary::round(ds), there[1] - here[1]]
    };
    let ([a, b], [c, d]) = (slope(dx), slope(dy));
    (here, [a, b, c, d])
}

/// Is there no channel after those that are wanted? Such a texture covers everything.
fn covers(texture: &Texture, lookup: &Lookup, channels: usize) -> bool {
    lookup.first as usize + channels >= texture.channels()
}

/// The channels and alpha of a look-up, and how they change along x and y.
fn sampled(
    texture: &Texture,
    place: [f32; 2],
    slopes: [f32; 4],
    how: &How,
    (n, changes): (usize, bool),
) -> ([f32; 4], [f32; 4], [f32; 4]) {
    let covers = covers(texture, &how.lookup, n);
    if !changes && how.space.is_none() {
        let mut value = texture.value(place[0], place[1], slopes, &how.lookup);
        if covers {
            value[n] = 1.0;
        }
        return (value, [0.0; 4], [0.0; 4]);
    }
    let Sample { mut value, ds, dt } = texture.lookup(place[0], place[1], slopes, &how.lookup);
    let along = |x: f32, y: f32| -> [f32; 4] { std::array::from_fn(|c| ds[c] * x + dt[c] * y) };
    let (mut dx, mut dy) = (along(slopes[0], slopes[1]), along(slopes[2], slopes[3]));
    if covers {
        (value[n], dx[n], dy[n]) = (1.0, 0.0, 0.0);
    }
    if let Some(space) = how.space.filter(|_| n == 3) {
        let to = ColorSpace::from_name("linear").unwrap_or(space);
        let linear = |c: [f32; 3]| transformc(space, to, c);
        let old = [value[0], value[1], value[2]];
        let new = linear(old);
        for slope in [&mut dx, &mut dy] {
            let moved = linear(std::array::from_fn(|c| old[c] + slope[c]));
            (0..3).for_each(|c| slope[c] = moved[c] - new[c]);
        }
        value[..3].copy_from_slice(&new);
    }
    (value, dx, dy)
}
