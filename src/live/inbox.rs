//! What the session is asked for: by the page, and by files that change.

use super::values::Given;
use crate::render::Screen;
use serde_json::Value;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A parameter of a layer of a group, by their numbers in the order of the scene.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Knob {
    /// The group.
    pub group: usize,
    /// The layer.
    pub layer: usize,
    /// The parameter's name.
    pub name: String,
}

/// One wish.
#[derive(Debug)]
pub enum Wish {
    /// A file has changed, or come, or gone.
    Changed(PathBuf),
    /// A parameter is given a value, or again the one that its text says.
    Set(Knob, Option<Given>),
    /// All parameters are again what their texts say.
    Reset,
    /// The picture is shown in another way.
    Screen(Screen),
    /// The shader of a group is verified.
    Verify(usize),
    /// A pixel of the whole picture is looked at.
    Look([u32; 2], Sender<Value>),
    /// Somebody has come to see.
    Watch,
    /// It is over.
    Close,
}

impl Wish {
    /// Does what is being rendered lose its use?
    fn ends_round(&self) -> bool {
        match self {
            Wish::Changed(_) | Wish::Set(..) | Wish::Reset | Wish::Close => true,
            Wish::Screen(_) | Wish::Verify(_) | Wish::Look(..) | Wish::Watch => false,
        }
    }
}

/// Wishes that nobody has seen to yet.
#[derive(Debug, Default)]
pub struct Inbox {
    state: Mutex<State>,
    bell: Condvar,
    waiting: AtomicBool,
}

#[derive(Debug, Default)]
struct State {
    wishes: Vec<Wish>,
    /// When the first of them came.
    since: Option<Instant>,
    /// What ends the rounds of the renderers there are.
    stops: Vec<Arc<AtomicBool>>,
}

/// So many wishes wait; of more the latest are left out.
const MOST: usize = 10_000;

impl Inbox {
    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a wish; a value of a parameter takes the place of one that nobody has seen yet.
    pub fn push(&self, wish: Wish) {
        let mut state = self.lock();
        if wish.ends_round() {
            state.stops.iter().for_each(|stop| stop.store(true, Ordering::Relaxed));
        }
        state.since.get_or_insert_with(Instant::now);
        let known = |other: &&mut Wish| match (&wish, &**other) {
            (Wish::Set(a, _), Wish::Set(b, _)) => a == b,
            (Wish::Changed(a), Wish::Changed(b)) => a == b,
            (Wish::Screen(_), Wish::Screen(_)) | (Wish::Watch, Wish::Watch) => true,
            _ => false,
        };
        let room = state.wishes.len() < MOST;
        match state.wishes.iter_mut().find(known) {
            Some(other) => *other = wish,
            None if room => state.wishes.push(wish),
            None => {}
        }
        drop(state);
        self.waiting.store(true, Ordering::Relaxed);
        self.bell.notify_all();
    }

    /// All wishes, and when the first of them came. Rounds may go on from now on.
    pub fn take(&self) -> (Vec<Wish>, Instant) {
        let mut state = self.lock();
        self.waiting.store(false, Ordering::Relaxed);
        state.stops.iter().for_each(|stop| stop.store(false, Ordering::Relaxed));
        (std::mem::take(&mut state.wishes), state.since.take().unwrap_or_else(Instant::now))
    }

    /// Waits until there is a wish, `most` at the longest; true when there is one.
    pub fn wait(&self, most: Duration) -> bool {
        let state = self.lock();
        let waited = self.bell.wait_timeout_while(state, most, |state| state.wishes.is_empty());
        !waited.unwrap_or_else(PoisonError::into_inner).0.wishes.is_empty()
    }

    /// Is there a wish?
    pub fn waiting(&self) -> bool {
        self.waiting.load(Ordering::Relaxed)
    }

    /// What wishes stop from now on, in the place of what they have stopped before.
    pub fn stops(&self, stops: Vec<Arc<AtomicBool>>) {
        self.lock().stops = stops;
    }
}
