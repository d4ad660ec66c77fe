//! One level of a texture: texels in blocks of 8 x 8, so that what lies close in the picture lies close in memory.

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

/// What each byte stands for, x / 255: a look in a table costs less than a division.
const BYTES: [f32; 256] = {
    let mut table = [0.0; 256];
    let mut i = 0;
    while i < 256 {
        table[i] = i as f32 / 255.0;
        i += 1;
    }
    table
};

/// A side of a block.
const SIDE: usize = 8;

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
        let size = across * down * SIDE * SIDE * channels;
        let empty = match rows {
            Texels::Bytes(_) => Texels::Bytes(vec![0; size]),
            Texels::Words(_) => Texels::Words(vec![0; size]),
            Texels::Floats(_) => Texels::Floats(vec![0.0; size]),
        };
        let mut level = Level { width, height, channels, across, texels: empty };
        for y in 0..height {
            for x in 0..width {
                let (to, from) = (level.place(x, y), (y * width + x) * channels);
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

    #[inline(always)]
    fn place(&self, x: usize, y: usize) -> usize {
        let block = (y / SIDE) * self.across + x / SIDE;
        (block * SIDE * SIDE + (y % SIDE) * SIDE + x % SIDE) * self.channels
    }

    /// Up to four channels from `first` on of a texel inside the level; those that there are not stay as they are.
    #[inline(always)]
    pub fn read(&self, x: usize, y: usize, first: usize, out: &mut [f32; 4]) {
        let (from, count) = (self.place(x, y) + first, self.channels.saturating_sub(first).min(4));
        match &self.texels {
            Texels::Bytes(all) => take(all, from, count, |x| BYTES[usize::from(x)], out),
            Texels::Words(all) => take(all, from, count, |x| f32::from(x) / 65535.0, out),
            Texels::Floats(all) => take(all, from, count, |x| x, out),
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

/// Takes so many numbers, in one step where there are four, as a loop of unknown length costs more than it reads.
#[inline(always)]
fn take<T: Copy>(all: &[T], from: usize, count: usize, number: impl Fn(T) -> f32, out: &mut [f32; 4]) {
    match (all.get(from..).and_then(<[T]>::first_chunk::<4>), count) {
        (Some(four), 4) => *out = four.map(number),
        (Some(four), 3) => (out[0], out[1], out[2]) = (number(four[0]), number(four[1]), number(four[2])),
        (_, count) => out.iter_mut().zip(&all[from..from + count]).for_each(|(out, &x)| *out = number(x)),
    }
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
