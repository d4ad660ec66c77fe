//! One level of a texture: texels in blocks of 8 x 8, so that what lies close in the picture lies close in memory.

use glam::Vec4;

/// The numbers of a level, as its file has them.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// A byte, 0 to 1 spread over it.
    Bytes(Vec<u8>),
    /// Two bytes, 0 to 1 spread over them.
    Words(Vec<u16>),
    /// Floats.
    Floats(Vec<f32>),
}

/// A side of a block.
const SIDE: usize = 8;

/// Numbers after the last texel, so that four can be read where one is.
const AFTER: usize = 3;

/// One level.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    width: usize,
    height: usize,
    channels: usize,
    /// Blocks in a row.
    across: usize,
    texels: Texels,
}

impl Level {
    /// A level of rows from the top, `width * height * channels` numbers.
    pub fn of_rows(width: usize, height: usize, channels: usize, rows: &Texels) -> Self {
        let (across, down) = (width.div_ceil(SIDE), height.div_ceil(SIDE));
        let size = across * down * SIDE * SIDE * channels + AFTER;
        let empty = match rows {
            Texels::Bytes(_) => Texels::Bytes(vec![0; size]),
            Texels::Words(_) => Texels::Words(vec![0; size]),
            Texels::Floats(_) => Texels::Floats(vec![0.0; size]),
        };
        let mut level = Level { width, height, channels, across, texels: empty };
        for y in 0..height {
            for x in 0..width {
                let (to, from) = (level.row(y) + level.column(x), (y * width + x) * channels);
                let n = channels;
                match (&mut level.texels, rows) {
                    (Texels::Bytes(to_all), Texels::Bytes(all)) => {
                        to_all[to..to + n].copy_from_slice(&all[from..from + n])
                    }
                    (Texels::Words(to_all), Texels::Words(all)) => {
                        to_all[to..to + n].copy_from_slice(&all[from..from + n])
                    }
                    (Texels::Floats(to_all), Texels::Floats(all)) => {
                        to_all[to..to + n].copy_from_slice(&all[from..from + n])
                    }
                    _ => {}
                }
            }
        }
        level
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        match &self.texels {
            Texels::Bytes(all) => all.len(),
            Texels::Words(all) => 2 * all.len(),
            Texels::Floats(all) => 4 * all.len(),
        }
    }

    /// Channels.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// What a column adds to the place of a texel.
    #[inline(always)]
    pub fn column(&self, x: usize) -> usize {
        ((x / SIDE) * SIDE * SIDE + x % SIDE) * self.channels
    }

    /// What a row adds to the place of a texel.
    #[inline(always)]
    pub fn row(&self, y: usize) -> usize {
        ((y / SIDE) * self.across * SIDE * SIDE + (y % SIDE) * SIDE) * self.channels
    }

    /// The number that stands for 1.
    #[inline(always)]
    pub fn unit(&self) -> f32 {
        match &self.texels {
            Texels::Bytes(_) => 255.0,
            Texels::Words(_) => 65535.0,
            Texels::Floats(_) => 1.0,
        }
    }

    /// Places of texels that have a neighbour after them, from a channel on.
    #[inline(always)]
    pub(super) fn near(&self, first: u32) -> Near {
        let channels = self.channels as u32;
        let numbers = self.across as u64 * self.height.div_ceil(SIDE) as u64 * (SIDE * SIDE * self.channels) as u64;
        let counted = first < channels && numbers <= u64::from(u32::MAX);
        let before = |side: usize| if counted { side as u32 - 1 } else { 0 };
        let row = (self.across as u32).wrapping_mul((SIDE * SIDE) as u32);
        Near { columns: before(self.width), rows: before(self.height), channels, row, first }
    }

    /// Four numbers of the file from the sum of each row and column of [`Near`] on, as [`Level::fours`] has them.
    #[inline(always)]
    pub(super) fn near_fours(&self, rows: [u32; 2], columns: [u32; 2]) -> [[Vec4; 2]; 2] {
        let at = |row: usize, column: usize| rows[row].wrapping_add(columns[column]) as usize;
        let places = [[at(0, 0), at(0, 1)], [at(1, 0), at(1, 1)]];
        match &self.texels {
            Texels::Bytes(all) => four_each(all, places, f32::from),
            Texels::Words(all) => four_each(all, places, f32::from),
            Texels::Floats(all) => four_each(all, places, |x| x),
        }
    }

    /// Four numbers of the file from the sum of each row and column on, in [`Level::unit`]; beyond a texel's last channel they are of others.
    #[inline(always)]
    pub fn fours<const N: usize>(&self, rows: [usize; N], columns: [usize; N]) -> [[Vec4; N]; N] {
        match &self.texels {
            Texels::Bytes(all) => grid(rows, columns, |at| four(all, at, f32::from)),
            Texels::Words(all) => grid(rows, columns, |at| four(all, at, f32::from)),
            Texels::Floats(all) => grid(rows, columns, |at| four(all, at, |x| x)),
        }
    }

    /// Up to four channels from `first` on of a texel inside the level; those that there are not stay as they are.
    #[inline(always)]
    pub fn read(&self, x: usize, y: usize, first: usize, out: &mut [f32; 4]) {
        let count = self.channels.saturating_sub(first).min(4);
        if count > 0 {
            let [[numbers]] = self.fours([self.row(y)], [self.column(x) + first]);
            out[..count].copy_from_slice(&(numbers / self.unit()).to_array()[..count]);
        }
    }

    /// The mean of texels by their weights: sums of differences from one, so that of equal ones it is what each is.
    fn mean_of(&self, rows: &[(usize, f32)], columns: &[(usize, f32)], first: usize) -> [f32; 4] {
        let (mut base, mut sum) = ([0.0; 4], [0.0; 4]);
        self.read(columns[0].0, rows[0].0, first, &mut base);
        for &(row, wy) in rows {
            for &(column, wx) in columns {
                let mut texel = base;
                self.read(column, row, first, &mut texel);
                (0..4).for_each(|c| sum[c] += wx * wy * (texel[c] - base[c]));
            }
        }
        std::array::from_fn(|c| base[c] + sum[c])
    }

    /// The level of half the size, each texel the mean of those it covers. Of an odd number of columns or rows each new one covers a
    /// little more than two, so that the mean of all stays what it is.
    pub fn halved(&self) -> Level {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let columns: Vec<Vec<(usize, f32)>> = (0..width).map(|x| covered(x, width, self.width)).collect();
        let n = self.channels;
        let mut sums = vec![0.0f32; width * height * n];
        for y in 0..height {
            let rows = covered(y, height, self.height);
            for (x, columns) in columns.iter().enumerate() {
                for first in (0..n).step_by(4) {
                    let mean = self.mean_of(&rows, columns, first);
                    sums[(y * width + x) * n..][..n][first..].iter_mut().zip(mean).for_each(|(sum, x)| *sum = x);
                }
            }
        }
        let rows = match &self.texels {
            Texels::Bytes(_) => Texels::Bytes(sums.iter().map(|x| (x * 255.0 + 0.5) as u8).collect()),
            Texels::Words(_) => Texels::Words(sums.iter().map(|x| (x * 65535.0 + 0.5) as u16).collect()),
            Texels::Floats(_) => Texels::Floats(sums),
        };
        Level::of_rows(width, height, n, &rows)
    }
}

/// Places of the texels of a level in 32 bits, which a loop over many works out in SIMD.
pub(super) struct Near {
    /// How many columns have a neighbour after them; none where 32 bits are not enough or there is no such channel.
    pub columns: u32,
    /// The same of rows.
    pub rows: u32,
    channels: u32,
    /// Texels of a row of blocks.
    row: u32,
    /// The first channel.
    first: u32,
}

impl Near {
    const SIDE: u32 = SIDE as u32;

    /// What a column adds to the place of a texel.
    #[inline(always)]
    pub fn column(&self, x: u32) -> u32 {
        let texels = (x / Self::SIDE).wrapping_mul(Self::SIDE * Self::SIDE).wrapping_add(x % Self::SIDE);
        texels.wrapping_mul(self.channels).wrapping_add(self.first)
    }

    /// What a row adds to the place of a texel.
    #[inline(always)]
    pub fn row(&self, y: u32) -> u32 {
        let texels = (y / Self::SIDE).wrapping_mul(self.row).wrapping_add(y % Self::SIDE * Self::SIDE);
        texels.wrapping_mul(self.channels)
    }
}

/// Four numbers from each place on; written out like `grid`.
#[inline(always)]
fn four_each<T: Copy>(all: &[T], places: [[usize; 2]; 2], number: impl Fn(T) -> f32 + Copy) -> [[Vec4; 2]; 2] {
    let [[a, b], [c, d]] = places;
    [[four(all, a, number), four(all, b, number)], [four(all, c, number), four(all, d, number)]]
}

/// A value for each row and column; written out, because the array functions of the standard library are not inlined here.
#[inline(always)]
fn grid<const N: usize>(rows: [usize; N], columns: [usize; N], read: impl Fn(usize) -> Vec4) -> [[Vec4; N]; N] {
    let mut out = [[Vec4::ZERO; N]; N];
    for (out, row) in out.iter_mut().zip(rows) {
        for (out, column) in out.iter_mut().zip(columns) {
            *out = read(row + column);
        }
    }
    out
}

/// Four numbers in one step, as a loop of unknown length costs more than it reads.
#[inline(always)]
fn four<T: Copy>(all: &[T], from: usize, number: impl Fn(T) -> f32) -> Vec4 {
    let four = all.get(from..from.wrapping_add(4)).and_then(<[T]>::first_chunk::<4>);
    four.map_or(Vec4::ZERO, |&[x, y, z, w]| Vec4::new(number(x), number(y), number(z), number(w)))
}

/// The texels that one of a smaller level covers, with their parts of it.
fn covered(at: usize, small: usize, large: usize) -> Vec<(usize, f32)> {
    let scale = large as f64 / small as f64;
    let (from, to) = (at as f64 * scale, (at + 1) as f64 * scale);
    let last = (to.ceil() as usize).min(large);
    let part = |i: usize| ((i + 1) as f64).min(to) - (i as f64).max(from);
    (from as usize..last).map(|i| (i, (part(i) / scale) as f32)).filter(|(_, part)| *part > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_keeps_the_mean() {
        for (width, height) in [(8, 8), (7, 5), (1, 9), (17, 1), (3, 3)] {
            let values: Vec<f32> = (0..width * height * 2).map(|i| ((i * 37) % 101) as f32 / 100.0).collect();
            let mut level = Level::of_rows(width, height, 2, &Texels::Floats(values.clone()));
            while level.width() > 1 || level.height() > 1 {
                level = level.halved();
            }
            let mut mean = [0.0; 4];
            level.read(0, 0, 0, &mut mean);
            let count = (width * height) as f32;
            for c in 0..2 {
                let wanted = values.iter().skip(c).step_by(2).sum::<f32>() / count;
                assert!((mean[c] - wanted).abs() < 1e-5, "{width} x {height}: {} {wanted}", mean[c]);
            }
        }
    }
}
