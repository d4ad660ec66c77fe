//! Looking up textures lane by lane: which file, how, and what is told when there is none.

use super::lane::Lane;
use super::report::Mistake;
use super::run::{Run, TextureFound as Found};
use crate::ir::op::{AttributeType, TextureCall};
use crate::ir::program::Reg;
use crate::lang::symbols::Symbol;
use crate::ops::color::{ColorSpace, transformc};
use crate::ops::working_space::WorkingSpace;
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
    /// What its colors are in, and what they become.
    space: Option<(ColorSpace, WorkingSpace)>,
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
        let space = ColorSpace::from_name(space).map(|space| (space, self.group.program.working_space));
        How { lookup, missing, space }
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

    pub(super) fn texture_info(&mut self, ty: AttributeType, dst: &[Reg], src: &[Reg], span: Span) {
        for lane in 0..self.n {
            if self.s.mask[lane] == 0 {
                continue;
            }
            let args = Lane { run: self, src, lane };
            let (symbol, name, mut s, mut t) = (args.i(0), args.s(1).to_owned(), args.f(2), args.f(3));
            let anywhere = s.is_nan() && t.is_nan();
            let mut found = self.texture_at(symbol, &mut s, &mut t);
            if found.is_err() && anywhere && is_tiled(self.tree.strings.text(Symbol(symbol))) {
                found = self.any_tile(symbol);
            }
            // A tile that there is not is no mistake.
            let tiled = is_tiled(self.tree.strings.text(Symbol(symbol)));
            if let (Err(reason), false) = (&found, name == "exists" || tiled) {
                let (reason, text) = (reason.clone(), reason.clone());
                self.report_once(lane, span, Mistake::TextureInfo { reason }, text);
            }
            let there = self.put_info(ty, &dst[1..], lane, &name, found.as_deref().ok());
            self.regs.ints[dst[0].0 as usize][lane] = i32::from(there);
        }
    }

    /// What is known of a texture, by the names that OSL gives, and by those of its file; false for what is not known as this type.
    fn put_info(&mut self, ty: AttributeType, dst: &[Reg], lane: usize, name: &str, texture: Option<&Texture>) -> bool {
        if name == "exists" && ty == AttributeType::Ints(1) {
            self.regs.ints[dst[0].0 as usize][lane] = i32::from(texture.is_some());
            return true;
        }
        let Some(texture) = texture else { return false };
        let ints = known_ints(texture, name, ty);
        for (reg, value) in dst.iter().zip(&ints) {
            self.regs.ints[reg.0 as usize][lane] = *value;
        }
        let floats = known_floats(texture, name, ty);
        for (reg, value) in dst.iter().zip(&floats) {
            self.regs.floats[reg.0 as usize][lane] = *value;
        }
        let text = (ty == AttributeType::Strings(1)).then(|| known_text(texture, name)).flatten();
        if let Some(text) = &text {
            self.regs.ints[dst[0].0 as usize][lane] = self.tree.strings.symbol(text).0;
        }
        !ints.is_empty() || !floats.is_empty() || text.is_some()
    }
}

/// Whole numbers that are known of a texture; none where that is none of them. `resolution` is that of the texels that the file has.
fn known_ints(texture: &Texture, name: &str, ty: AttributeType) -> Vec<i32> {
    let [width, height] = texture.size().map(|side| side as i32);
    let data = texture.about().data.unwrap_or([0, 0, width - 1, height - 1]);
    let size = [data[2] - data[0] + 1, data[3] - data[1] + 1];
    let flat = |[a, b, c, d]: [i32; 4]| vec![a, b, 0, c, d, 0];
    let display = [0, 0, width - 1, height - 1];
    match (name, ty) {
        ("resolution", AttributeType::Ints(2)) => size.to_vec(),
        ("resolution", AttributeType::Ints(3)) => vec![size[0], size[1], 1],
        ("datawindow", AttributeType::Ints(4)) => data.to_vec(),
        ("datawindow", AttributeType::Ints(6)) => flat(data),
        ("displaywindow", AttributeType::Ints(4)) => display.to_vec(),
        ("displaywindow", AttributeType::Ints(6)) => flat(display),
        ("channels", AttributeType::Ints(1)) => vec![texture.channels() as i32],
        ("subimages" | "miplevels", AttributeType::Ints(1)) => vec![1],
        _ => Vec::new(),
    }
}

/// Numbers that are known of a texture; none where that is none of them. The mean color is what the file says it is, or else that of the
/// picture; a constant one only what the file says.
fn known_floats(texture: &Texture, name: &str, ty: AttributeType) -> Vec<f32> {
    let channels = texture.channels();
    let average = || texture.about().numbers("oiio:AverageColor").unwrap_or_else(|| texture.mean().to_vec());
    let constant = || texture.about().numbers("oiio:ConstantColor").unwrap_or_default();
    let color = |numbers: Vec<f32>, count: u32| match numbers.is_empty() {
        true => numbers,
        false => (0..count as usize).map(|c| numbers.get(c).copied().unwrap_or(0.0)).collect(),
    };
    let alpha = |numbers: Vec<f32>| numbers.get(3).copied().into_iter().collect();
    match (name, ty) {
        ("channels", AttributeType::Floats(1)) => vec![channels as f32],
        ("averagecolor", AttributeType::Floats(count)) => color(average(), count),
        ("averagealpha", AttributeType::Floats(1)) if channels == 4 => alpha(average()),
        ("constantcolor", AttributeType::Floats(count)) => color(constant(), count),
        ("constantalpha", AttributeType::Floats(1)) if channels == 4 => alpha(constant()),
        _ => Vec::new(),
    }
}

/// A text that is known of a texture.
fn known_text(texture: &Texture, name: &str) -> Option<String> {
    match name {
        "type" => Some("texture".to_owned()),
        "texturetype" | "textureformat" => Some("Plain Texture".to_owned()),
        "wrapmodes" => Some(texture.wrap().map(Wrap::name).join(",")),
        _ => texture.about().text(name).map(str::to_owned),
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
    if let Some((space, rgb)) = how.space.filter(|_| n == 3) {
        let linear = |c: [f32; 3]| transformc(rgb, space, ColorSpace::Rgb, c);
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
