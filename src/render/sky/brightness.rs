//! How bright the background is: one value a cell of a grid, and finer ones where neighbours differ much.

use super::square::wrapped;
use rayon::prelude::*;

/// Cells of the fine grid in one of the coarse grid, each way.
pub const FINE: usize = 8;

/// A cell whose neighbours differ from it by more than this part of all light is looked at more closely.
const ROUGH: f64 = 1e-4;

/// The most cells that are looked at more closely: as many looks as a quarter of the coarse grid of 1024 x 1024.
const MOST_FINE: usize = 4096;

/// Rounds of looking closer. A second one catches what the first has found at the edge of what it looked at.
const ROUNDS: usize = 3;

/// No closer look at this cell.
const NONE: u32 = u32::MAX;

/// Gives the brightness of cells of a grid of so many a side, by column and row.
pub type Look<'a> = dyn Fn(usize, &[[u32; 2]]) -> Vec<f32> + 'a;

/// The brightness of a background, cell by cell.
#[derive(Clone, Debug)]
pub struct Brightness {
    side: usize,
    /// Rows first; of a cell that was looked at closely, the mean of what was seen.
    coarse: Vec<f32>,
    /// Which of `fine` belongs to each cell.
    closer: Vec<u32>,
    fine: Vec<[f32; FINE * FINE]>,
}

impl Brightness {
    /// Looks at all cells of a grid of `side` a side, a power of two, and closer where that is worth while.
    pub fn new(side: usize, look: &Look) -> Self {
        let cells: Vec<[u32; 2]> = (0..side * side).map(|i| [(i % side) as u32, (i / side) as u32]).collect();
        let mut coarse = look(side, &cells);
        coarse.iter_mut().for_each(clean);
        let mut seen = Brightness { side, closer: vec![NONE; coarse.len()], coarse, fine: Vec::new() };
        for _ in 0..ROUNDS {
            let rough = seen.rough();
            if rough.is_empty() {
                break;
            }
            seen.look_closer(&rough, look);
        }
        seen
    }

    /// Cells a side of the coarse grid.
    pub fn side(&self) -> usize {
        self.side
    }

    /// The values of the cells closer than `x`, `y`, rows first; none where it was not looked closer.
    pub fn fine(&self, x: usize, y: usize) -> Option<&[f32; FINE * FINE]> {
        self.fine.get(self.closer[y * self.side + x] as usize)
    }

    /// The value of a cell of the coarse grid.
    pub fn coarse(&self, x: usize, y: usize) -> f32 {
        self.coarse[y * self.side + x]
    }

    /// The mean over all directions.
    pub fn mean(&self) -> f64 {
        self.coarse.iter().map(|b| f64::from(*b)).sum::<f64>() / self.coarse.len() as f64
    }

    /// Applies `change` to all values.
    pub fn change(&mut self, change: impl Fn(f32) -> f32 + Sync) {
        self.fine.par_iter_mut().for_each(|cells| cells.iter_mut().for_each(|b| *b = change(*b)));
        self.coarse.par_iter_mut().for_each(|b| *b = change(*b));
        self.renew_means();
    }

    /// Spreads each value over its neighbours with weights 1, 2, 1 each way, so that a cell that its centre judges wrongly,
    /// as the rim of a sun, is never dark.
    pub fn spread(&self) -> Self {
        let side = self.side;
        let weighed = |x: usize, y: usize, of: &dyn Fn(isize, isize) -> f32| -> f32 {
            let at = |k: isize| of(x as isize + k % 3 - 1, y as isize + k / 3 - 1);
            const WEIGHTS: [f32; 9] = [1.0, 2.0, 1.0, 2.0, 4.0, 2.0, 1.0, 2.0, 1.0];
            (0..9).zip(WEIGHTS).map(|(k, weight)| weight / 16.0 * at(k)).sum()
        };
        let mut out = self.clone();
        out.coarse.par_iter_mut().enumerate().for_each(|(i, value)| {
            let own = self.coarse[i];
            // What was looked at closely ends within the cells that were, so it is not spread out of them.
            *value = weighed(i % side, i / side, &|x, y| {
                let [x, y] = wrapped(side, x, y);
                if self.fine(x, y).is_some() { own } else { self.coarse(x, y) }
            });
        });
        let closely = (0..self.closer.len()).filter(|i| self.closer[*i] != NONE);
        for i in closely {
            let at = |k: usize| [i % side * FINE + k % FINE, i / side * FINE + k / FINE];
            out.fine[self.closer[i] as usize] =
                std::array::from_fn(|k| weighed(at(k)[0], at(k)[1], &|x, y| self.at_fine(wrapped(side * FINE, x, y))));
        }
        out.renew_means();
        out
    }

    /// The value at a cell of the fine grid.
    fn at_fine(&self, [x, y]: [usize; 2]) -> f32 {
        match self.fine(x / FINE, y / FINE) {
            Some(cells) => cells[y % FINE * FINE + x % FINE],
            None => self.coarse(x / FINE, y / FINE),
        }
    }

    /// Cells that are worth a closer look, the worst ones if there are too many.
    fn rough(&self) -> Vec<u32> {
        let threshold = (ROUGH * self.mean() * self.coarse.len() as f64) as f32;
        let lacking = (0..self.coarse.len()).into_par_iter().filter(|i| self.closer[*i] == NONE);
        let rough = lacking.map(|i| (self.step(i), i as u32)).filter(|(step, _)| *step > threshold);
        let mut rough: Vec<(f32, u32)> = rough.collect();
        rough.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        rough.truncate(MOST_FINE - self.fine.len().min(MOST_FINE));
        rough.into_iter().map(|(_, i)| i).collect()
    }

    /// The greatest difference between values in a cell and its neighbours.
    fn step(&self, i: usize) -> f32 {
        let (x, y) = ((i % self.side) as isize, (i / self.side) as isize);
        let (mut least, mut most) = (f32::INFINITY, 0.0f32);
        for k in 0..9 {
            let [x, y] = wrapped(self.side, x + k % 3 - 1, y + k / 3 - 1);
            let value = [self.coarse(x, y)];
            for b in self.fine(x, y).map_or(&value[..], |cells| cells) {
                (least, most) = (least.min(*b), most.max(*b));
            }
        }
        most - least
    }

    fn look_closer(&mut self, cells: &[u32], look: &Look) {
        let side = self.side;
        let within = |i: &u32| {
            let (x, y) = (*i as usize % side * FINE, *i as usize / side * FINE);
            (0..FINE * FINE).map(move |k| [(x + k % FINE) as u32, (y + k / FINE) as u32])
        };
        let fine: Vec<[u32; 2]> = cells.iter().flat_map(within).collect();
        let seen = look(side * FINE, &fine);
        for (i, seen) in cells.iter().zip(seen.chunks_exact(FINE * FINE)) {
            self.closer[*i as usize] = self.fine.len() as u32;
            self.fine.push(std::array::from_fn(|k| {
                let mut value = seen[k];
                clean(&mut value);
                value
            }));
        }
        self.renew_means();
    }

    fn renew_means(&mut self) {
        for (value, closer) in self.coarse.iter_mut().zip(&self.closer) {
            if let Some(cells) = self.fine.get(*closer as usize) {
                *value = cells.iter().sum::<f32>() / cells.len() as f32;
            }
        }
    }
}

/// Light that is no number or below nothing is not sampled.
fn clean(value: &mut f32) {
    *value = if value.is_finite() { value.max(0.0) } else { 0.0 };
}
