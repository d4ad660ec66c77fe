//! How a render tells how far it is.

/// Receives news of a running render; called from many threads.
pub trait Progress: Sync {
    /// `done` of `total` tiles are finished.
    fn tiles(&self, done: usize, total: usize);

    /// True asks the render to stop; it does so after a wave of paths at the least, and the picture then holds what was finished.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Tells nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn tiles(&self, _done: usize, _total: usize) {}
}
