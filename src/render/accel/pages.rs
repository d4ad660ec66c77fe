//! A list in memory that the system is asked to map in large pages.
//!
//! Decision (2026-11-22): the hierarchy lies in large pages because a ray touches it all over and most of its misses
//! were of the table of pages, instead of a `Vec`, whose pages are small unless the system makes all of them large.

use bytemuck::{Pod, cast_slice, cast_slice_mut};
use memmap2::MmapMut;
use std::marker::PhantomData;

/// A list of as many items as it was made for, all zero at first. What is not written takes no memory.
#[derive(Debug)]
pub struct Pages<T> {
    memory: Memory<T>,
    length: usize,
}

#[derive(Debug)]
enum Memory<T> {
    Mapped(MmapMut, PhantomData<T>),
    Owned(Vec<T>),
}

impl<T: Pod> Pages<T> {
    /// An empty list with room for `capacity` items.
    pub fn new(capacity: usize) -> Self {
        let map = MmapMut::map_anon((capacity * size_of::<T>()).max(1));
        let memory = match map {
            Ok(map) => {
                // Only a wish: small pages give the same answers.
                #[cfg(target_os = "linux")]
                let _ = map.advise(memmap2::Advice::HugePage);
                Memory::Mapped(map, PhantomData)
            }
            // The list then grows as it is written.
            Err(_) => Memory::Owned(Vec::new()),
        };
        Pages { memory, length: 0 }
    }

    /// The items.
    pub fn items(&self) -> &[T] {
        match &self.memory {
            Memory::Mapped(map, _) => cast_slice(&map[..self.length * size_of::<T>()]),
            Memory::Owned(items) => items,
        }
    }

    /// The items, to be changed.
    pub fn items_mut(&mut self) -> &mut [T] {
        match &mut self.memory {
            Memory::Mapped(map, _) => cast_slice_mut(&mut map[..self.length * size_of::<T>()]),
            Memory::Owned(items) => items,
        }
    }

    /// Appends an item, for which there must be room; gives its index.
    pub fn push(&mut self, item: T) -> u32 {
        self.length += 1;
        if let Memory::Owned(items) = &mut self.memory {
            items.push(item);
        } else {
            let last = self.length - 1;
            self.items_mut()[last] = item;
        }
        self.length as u32 - 1
    }
}
