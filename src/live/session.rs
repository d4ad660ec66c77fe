//! The session: one thread that sees to wishes, and renders in between.

use super::board::Board;
use super::controls::{controls, label};
use super::frame::Frame;
use super::inbox::{Inbox, Knob, Wish};
use super::pixel::{DIRECTIONS, pixel};
use super::showing::Showing;
use super::source::Source;
use super::stages::Stages;
use super::subject::{Overrides, Subject};
use super::tev::Tev;
use super::trial::Trial;
use super::values::Given;
use super::watch::Watched;
use crate::exec::Report;
use crate::limits::{PRINTED, PRINTED_BYTES};
use crate::render::{Image, Progress, Screen, Settings, View};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

/// Quiet time after a file has changed: editors write more than once.
const QUIET: Duration = Duration::from_millis(4);

/// The longest time to wait for that.
const RESTLESS: Duration = Duration::from_millis(40);

/// How long a file that has gone, or has nothing in it, may be on its way back.
const BACK: Duration = Duration::from_millis(60);

/// Seconds from one picture to the next.
const PACE: f64 = 0.15;

/// Samples of each pixel in a round, at most.
const MOST_AT_ONCE: u32 = 32;

/// What is rendered, and how it stands.
enum Work {
    /// A coarse picture, then the whole one.
    Coarse,
    /// The whole picture.
    Whole,
    /// Nothing is left to do, or nothing can be done before something changes.
    None,
}

/// Everything that the thread of a session holds.
pub struct Session {
    source: Source,
    settings: Settings,
    resolution: Option<[u32; 2]>,
    inbox: Arc<Inbox>,
    board: Arc<Board>,
    watched: Watched,
    trial: Trial,
    subject: Option<Subject>,
    stages: Option<Stages>,
    overrides: Overrides,
    screen: Screen,
    tev: Option<Tev>,
    image: Option<Image>,
    work: Work,
    /// Groups whose text or values have changed and that do not compile yet.
    dirty: BTreeSet<usize>,
    /// All is to be loaded anew.
    reload: bool,
    /// What is wrong.
    trouble: Option<String>,
    /// How many changes there were.
    change: u64,
    /// When the last one came, until its first picture is there.
    since: Option<Instant>,
    /// Milliseconds from the last change to its first picture.
    waited: Option<f64>,
    followed: usize,
    /// When the last picture was put up.
    shown: Instant,
}

/// Ends a round when there is a wish.
struct Interrupt<'a>(&'a Inbox);

impl Progress for Interrupt<'_> {
    fn tiles(&self, _done: usize, _total: usize) {}

    fn cancelled(&self) -> bool {
        self.0.waiting()
    }
}

impl Session {
    /// A session that has loaded nothing yet.
    pub fn new(
        source: Source,
        settings: Settings,
        showing: Showing,
        (inbox, board, watched): (Arc<Inbox>, Arc<Board>, Watched),
    ) -> Self {
        Session {
            source,
            settings,
            resolution: showing.resolution,
            inbox,
            board,
            watched,
            trial: Trial::default(),
            subject: None,
            stages: None,
            overrides: Overrides::new(),
            screen: showing.screen,
            tev: showing.tev,
            image: None,
            work: Work::None,
            dirty: BTreeSet::new(),
            reload: true,
            trouble: None,
            change: 0,
            since: Some(Instant::now()),
            waited: None,
            followed: 0,
            shown: Instant::now(),
        }
    }

    /// Says how the picture is shown, with its bytes where they are others now.
    fn put_screen(&self, frame: Option<Frame>) {
        let view = View::ALL.iter().find(|(_, view)| *view == self.screen.view).map(|(name, _)| *name);
        self.board.publish([("screen", json!({"stops": self.screen.exposure, "view": view}))], frame);
    }

    /// Runs until it is asked to close.
    pub fn run(mut self) {
        self.put_screen(None);
        loop {
            let (wishes, since) = self.inbox.take();
            if !self.see_to(wishes, since) {
                return;
            }
            let idle = matches!(self.work, Work::None)
                || !(self.since.is_some() || self.board.watched() || self.tev.is_some());
            if idle {
                // Whoever comes to see rings, and may do so a moment too early.
                let unseen = !matches!(self.work, Work::None);
                self.inbox.wait(Duration::from_secs(if unseen { 1 } else { 3600 }));
            } else {
                self.advance();
            }
        }
    }

    /// Sees to wishes; false when one of them is to close.
    fn see_to(&mut self, wishes: Vec<Wish>, since: Instant) -> bool {
        let (mut changed, mut looks) = (BTreeSet::new(), Vec::new());
        for wish in wishes {
            match wish {
                Wish::Close => return false,
                Wish::Changed(path) => drop(changed.insert(path)),
                Wish::Set(knob, given) => self.set(&knob, given),
                Wish::Reset => {
                    self.dirty.extend(self.overrides.keys().map(|knob| knob.group));
                    self.overrides.clear();
                }
                Wish::Screen(screen) => {
                    self.screen = screen;
                    let frame = self.image.as_ref().map(|image| Frame::of(image, screen));
                    self.put_screen(frame);
                }
                Wish::Verify(group) => {
                    if let Some(subject) = &self.subject {
                        let settings = (self.settings.closure, self.trouble.is_some());
                        self.trial.begin(subject, group, &self.overrides, settings, &self.board);
                    }
                }
                Wish::Look(at, answer) => looks.push((at, answer)),
                Wish::Watch => {}
            }
        }
        if !changed.is_empty() {
            self.note_changes(changed);
        }
        if self.reload || !self.dirty.is_empty() {
            self.since.get_or_insert(since);
            self.renew();
        }
        looks.into_iter().for_each(|(at, answer)| self.look(at, &answer));
        true
    }

    /// Gives a parameter a value, if it is there and the value fits.
    fn set(&mut self, knob: &Knob, given: Option<Given>) {
        let Some(subject) = &self.subject else { return };
        for knob in subject.alike(knob) {
            let changed = match &given {
                Some(given) if subject.fits(&knob, given) => {
                    self.overrides.insert(knob.clone(), given.clone());
                    true
                }
                Some(_) => false,
                None => self.overrides.remove(&knob).is_some(),
            };
            if changed {
                self.dirty.insert(knob.group);
            }
        }
    }

    /// Waits until the files are quiet, and finds out what they are to the picture.
    fn note_changes(&mut self, mut changed: BTreeSet<PathBuf>) {
        let begin = Instant::now();
        let mut later = Vec::new();
        let mut collect = |changed: &mut BTreeSet<PathBuf>| {
            for wish in self.inbox.take().0 {
                match wish {
                    Wish::Changed(path) => drop(changed.insert(path)),
                    other => later.push(other),
                }
            }
        };
        while self.inbox.wait(QUIET) && begin.elapsed() < RESTLESS {
            collect(&mut changed);
        }
        let empty = |path: &PathBuf| std::fs::metadata(path).map_or(true, |about| about.len() == 0);
        let mut away = changed.iter().any(empty);
        while away && begin.elapsed() < BACK {
            self.inbox.wait(BACK.saturating_sub(begin.elapsed()));
            collect(&mut changed);
            away = changed.iter().any(empty);
        }
        later.into_iter().for_each(|wish| self.inbox.push(wish));
        let groups = self.subject.as_ref().and_then(|subject| subject.affected(&changed));
        match groups {
            Some(groups) => self.dirty.extend(groups),
            // Something else than a text of a shader, or what an error asks for.
            None if self.dirty.is_empty() || self.trouble.is_none() => self.reload = true,
            None => {}
        }
    }

    /// Loads or compiles what has changed, and begins the picture anew.
    fn renew(&mut self) {
        let moves = self.subject.as_ref().is_some_and(|subject| self.dirty.iter().any(|&k| subject.moves(k)));
        self.change += 1;
        let renewed = if self.reload || moves || self.subject.is_none() { self.load() } else { self.compile() };
        match renewed {
            Ok(()) => {
                self.trouble = None;
                self.begin();
            }
            Err(text) => {
                // What mends it may be a file that nobody has asked for yet.
                self.watched.any(true);
                self.fail(text);
            }
        }
        self.follow();
    }

    fn load(&mut self) -> Result<(), String> {
        self.reload = true;
        self.board.publish([("status", self.status("loading"))], None);
        let subject = match self.source.load(self.subject.as_ref(), &mut self.overrides) {
            Ok(subject) => subject,
            Err((text, noted)) => {
                // What a mended text needs is watched as well as what the last good one needed.
                let mut paths = noted.paths();
                paths.extend(self.subject.iter().flat_map(Subject::paths));
                self.watched.follow(&paths, true);
                return Err(text);
            }
        };
        (self.reload, self.dirty) = (false, BTreeSet::new());
        let mut settings = self.settings.clone().with_options(&subject.scene.options);
        if let Some([width, height]) = self.resolution.or(subject.scene.options.resolution) {
            (settings.width, settings.height) = (width, height);
        }
        let rate = self.stages.as_ref().map(Stages::rate);
        // The old one goes first: a large scene need not fit twice.
        (self.stages, self.work) = (None, Work::None);
        let stages = Stages::new(&subject.scene, &settings, rate).map_err(|error| error.told());
        self.subject = Some(subject);
        self.stages = Some(stages?);
        Ok(())
    }

    fn compile(&mut self) -> Result<(), String> {
        let Some(subject) = &mut self.subject else { return Ok(()) };
        let Some(renewed) = subject.compile(&self.source, &self.dirty, &mut self.overrides)? else {
            return self.load();
        };
        let groups = subject.take(&self.source, renewed);
        self.dirty.clear();
        self.stages.iter_mut().for_each(|stages| stages.change(groups.clone()));
        Ok(())
    }

    /// Puts up how it stands, with the controls as they are now: at once, so that a page asks once.
    fn put_all(&self, state: &str) {
        let controls = self.subject.as_ref().map(|subject| ("controls", controls(subject, &self.overrides)));
        self.board.publish([("status", self.status(state))].into_iter().chain(controls), None);
    }

    /// Begins the picture anew.
    fn begin(&mut self) {
        let Some(stages) = &mut self.stages else { return };
        let begun = stages.begin();
        self.inbox.stops(stages.stops());
        self.work = if stages.divisor() > 1 { Work::Coarse } else { Work::Whole };
        if let Err(error) = begun {
            return self.fail(error.told());
        }
        self.put_all("rendering");
    }

    /// Says what is wrong; the picture stays as it is.
    fn fail(&mut self, text: String) {
        self.work = Work::None;
        self.trouble = Some(text);
        self.since = None;
        self.put_all("wrong");
    }

    /// Watches what has been read since.
    fn follow(&mut self) {
        let Some(subject) = &self.subject else { return };
        let count = subject.path_count();
        if count != self.followed && self.trouble.is_none() {
            self.watched.follow(&subject.paths(), false);
            self.followed = count;
        } else if self.trouble.is_none() {
            self.watched.any(false);
        }
    }

    /// Renders a round and shows what there is.
    fn advance(&mut self) {
        let Some(stages) = &mut self.stages else {
            self.work = Work::None;
            return;
        };
        let coarse = matches!(self.work, Work::Coarse);
        let pixels: u64 = stages.size().iter().map(|&side| u64::from(side)).product();
        let fast = (PACE * stages.rate() / pixels as f64) as u32;
        let before = stages.renderer().taken()[0];
        let samples = if coarse || before == 0 { 1 } else { fast.clamp(1, MOST_AT_ONCE) };
        let (paths, start) = (stages.renderer().about().paths, Instant::now());
        let outcome = stages.renderer().round_of(samples, &Interrupt(&self.inbox));
        let paths = stages.renderer().about().paths - paths;
        stages.timed(paths, start.elapsed().as_secs_f64());
        let left = match outcome {
            Ok(left) => left,
            Err(error) => return self.fail(error.told()),
        };
        let taken = stages.renderer().taken();
        // The first picture of a size is shown at once, later ones now and then.
        let due = before == 0 || !left || self.shown.elapsed().as_secs_f64() >= PACE;
        if taken[0] == 0 || !due {
            return;
        }
        let image = stages.renderer().picture();
        if coarse {
            self.work = Work::Whole;
        } else if !left {
            self.work = Work::None;
        }
        self.show(image, coarse);
        if coarse
            && let Some(stages) = &mut self.stages
            && let Err(error) = stages.refine()
        {
            self.fail(error.told());
        }
        self.follow();
    }

    /// Puts a picture up.
    fn show(&mut self, image: Image, coarse: bool) {
        if let Some(since) = self.since.take() {
            self.waited = Some(since.elapsed().as_secs_f64() * 1e3);
        }
        self.shown = Instant::now();
        let frame = Frame::of(&image, self.screen);
        if let Some(tev) = self.tev.as_ref().filter(|_| !coarse) {
            tev.show(image.clone());
        }
        let size = self.stages.as_ref().map_or([image.width, image.height], Stages::size);
        let about = &image.about;
        let picture = json!({
            "width": frame.width,
            "height": frame.height,
            "whole": size,
            "coarse": coarse,
            "samples": about.taken,
            "error": about.noise,
            "goal": self.settings.noise,
            "seconds": about.seconds_tracing,
            "change": self.change,
            "waited": self.waited,
        });
        self.image = Some(image);
        let state = if matches!(self.work, Work::None) { "done" } else { "rendering" };
        self.board.publish([("picture", picture), ("status", self.status(state))], Some(frame));
    }

    /// How it stands: `loading`, `rendering`, `done` or `wrong`, with all there is to say.
    fn status(&self, state: &str) -> Value {
        let scene = self.subject.iter().flat_map(|subject| subject.scene.warnings.iter().cloned());
        let remarks = self.subject.iter().map(|subject| subject.remarks.clone()).filter(|text| !text.is_empty());
        let reports = self.image.iter().flat_map(|image| &image.about.reports).map(Report::to_string);
        let (mut bytes, mut notes) = (0, Vec::new());
        let viewer = self.tev.iter().filter_map(Tev::trouble);
        for note in viewer.chain(remarks).chain(scene).chain(reports).take(PRINTED) {
            bytes += note.len();
            if bytes > PRINTED_BYTES / 16 {
                break;
            }
            notes.push(note);
        }
        // A group that another one stands for is not counted twice.
        let shown = |knob: &&Knob| self.subject.iter().all(|subject| subject.stands_for(knob.group) == knob.group);
        json!({
            "state": state,
            "change": self.change,
            "file": self.source.argument.chars().take(300).collect::<String>(),
            "trouble": self.trouble,
            "notes": notes,
            "set": self.overrides.keys().filter(shown).count(),
        })
    }

    /// Looks at a pixel of the whole picture.
    fn look(&mut self, [x, y]: [u32; 2], answer: &Sender<Value>) {
        let (Some(subject), Some(stages)) = (&self.subject, &mut self.stages) else { return };
        let [width, height] = stages.size();
        if x >= width || y >= height || self.trouble.is_some() {
            let _ = answer.send(json!({"x": x, "y": y, "trouble": self.trouble.is_some()}));
            return;
        }
        let divisor = stages.divisor();
        let renderer = stages.renderer();
        let inside = [x / divisor, y / divisor];
        let value = match renderer.look(inside[0], inside[1], DIRECTIONS) {
            Some(look) => {
                let group = subject.group_of(look.material).map(|group| (group, label(subject, group)));
                pixel(&look, [x, y], group)
            }
            None => json!({"x": x, "y": y, "nothing": true}),
        };
        // Whoever has asked may have gone.
        let _ = answer.send(value);
    }
}
