//! Memory for the columns of a batch, which are written as soon as they are taken.

use std::ops::{Deref, DerefMut};

/// Numbers, or blocks of them, that are taken from the front and given back together. What is taken holds anything: clearing it first would cost
/// as much as writing it.
#[derive(Debug, Default)]
pub struct Store<T = f32> {
    numbers: Vec<T>,
    used: usize,
}

impl<T: Clone + Default> Store<T> {
    /// Gives everything back.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// Gives back what was taken after the first `used`.
    pub fn truncate(&mut self, used: usize) {
        self.used = self.used.min(used);
    }

    /// Takes `count` numbers and says where they start.
    pub fn take(&mut self, count: usize) -> usize {
        let start = self.used;
        self.used += count;
        if self.used > self.numbers.len() {
            self.numbers.resize(self.used, T::default());
        }
        start
    }
}

impl<T> Deref for Store<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.numbers[..self.used]
    }
}

impl<T> DerefMut for Store<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.numbers[..self.used]
    }
}
