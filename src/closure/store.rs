//! Memory for the columns of a batch, which are written as soon as they are taken.

use std::ops::{Deref, DerefMut};

/// No index.
pub const NONE: u32 = u32::MAX;

/// Numbers, or blocks of them, that are taken from the front; what is given back is the end, or all. What is taken holds
/// anything: clearing it first would cost as much as writing it.
#[derive(Debug, Default)]
pub struct Store<T = f32> {
    items: Vec<T>,
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

    /// Takes `count` items and says where they start.
    pub fn take(&mut self, count: usize) -> usize {
        let start = self.used;
        self.used += count;
        if self.used > self.items.len() {
            self.items.resize(self.used, T::default());
        }
        start
    }
}

impl<T> Deref for Store<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.items[..self.used]
    }
}

impl<T> DerefMut for Store<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.items[..self.used]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_is_as_long_as_asked_for() {
        let mut store = Store::default();
        assert_eq!((store.take(3), store.take(2), store.len()), (0, 3, 5));
        store.fill(1.0);
        store.truncate(3);
        assert_eq!((store.len(), store.take(4)), (3, 3));
        assert_eq!(store[..3], [1.0; 3]);
        store.clear();
        assert_eq!((store.len(), store.take(1), store.len()), (0, 0, 1));
    }
}
