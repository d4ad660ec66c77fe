//! What there is to see: the newest picture and the newest of each other piece of news, for whoever asks what is new.

use super::frame::Frame;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Whoever has asked within this time is still there.
const PATIENCE: Duration = Duration::from_secs(4);

/// The news of a session, numbered as they come. Older ones of a kind give way to newer ones, so that it stays small.
#[derive(Debug, Default)]
pub struct Board {
    state: Mutex<State>,
    bell: Condvar,
}

#[derive(Debug, Default)]
struct State {
    version: u64,
    pieces: BTreeMap<&'static str, (u64, Value)>,
    frame: Option<(u64, Arc<Frame>)>,
    waiting: usize,
    asked: Option<Instant>,
    closed: bool,
}

/// What is new since a version.
#[derive(Clone, Debug)]
pub struct News {
    /// The version to ask from next.
    pub version: u64,
    /// The pieces that have changed, by name.
    pub pieces: Map<String, Value>,
    /// The picture, if it has.
    pub frame: Option<Arc<Frame>>,
}

impl Board {
    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts up news, all at once.
    pub fn publish(&self, pieces: impl IntoIterator<Item = (&'static str, Value)>, frame: Option<Frame>) {
        let mut state = self.lock();
        state.version += 1;
        let version = state.version;
        for (name, value) in pieces {
            state.pieces.insert(name, (version, value));
        }
        if let Some(frame) = frame {
            state.frame = Some((version, Arc::new(frame)));
        }
        drop(state);
        self.bell.notify_all();
    }

    /// A text of a piece as it was put up last.
    pub fn text(&self, piece: &str, entry: &str) -> Option<String> {
        self.lock().pieces.get(piece)?.1.get(entry)?.as_str().map(str::to_owned)
    }

    /// What is new since `after`; waits until something is, `most` at the longest. A version from elsewhere is as good as none.
    pub fn wait(&self, after: u64, most: Duration) -> News {
        let mut state = self.lock();
        state.asked = Some(Instant::now());
        let after = if after > state.version { 0 } else { after };
        state.waiting += 1;
        let (mut state, _) = self
            .bell
            .wait_timeout_while(state, most, |state| state.version <= after && !state.closed)
            .unwrap_or_else(PoisonError::into_inner);
        state.waiting -= 1;
        state.asked = Some(Instant::now());
        let new = state.pieces.iter().filter(|(_, (version, _))| *version > after);
        News {
            version: state.version,
            pieces: new.map(|(name, (_, value))| ((*name).to_owned(), value.clone())).collect(),
            frame: state.frame.as_ref().filter(|(version, _)| *version > after).map(|(_, frame)| frame.clone()),
        }
    }

    /// Is there somebody to see it?
    pub fn watched(&self) -> bool {
        let state = self.lock();
        state.waiting > 0 || state.asked.is_some_and(|asked| asked.elapsed() < PATIENCE)
    }

    /// Lets all go who wait.
    pub fn close(&self) {
        self.lock().closed = true;
        self.bell.notify_all();
    }
}
