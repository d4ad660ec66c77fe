//! The renderer: a world and a film that whoever drives it fills round after round, and changes in between.

use super::accel::Accel;
use super::displace::displaced;
use super::error::RenderError;
use super::gathered::Gathered;
use super::image::{About, Image};
use super::part::{Part, PartError, Whole, counts, fingerprint};
use super::path::Dropped;
use super::plan::Plan;
use super::pool::Threads;
use super::progress::Progress;
use super::rounds::Task;
use super::settings::Settings;
use super::sky::Sky;
use super::stop::Stop;
use super::tile::Tile;
use super::trace::render_tile;
use super::wave::Wave;
use super::world::World;
use crate::exec::{Group, Report, ReportPlace};
use crate::scene::{Camera, Scene};
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Instant;

/// A scene that is being rendered.
///
/// [`round`](Renderer::round) adds samples, [`picture`](Renderer::picture) gives what there is so far. After all rounds the
/// picture is the one that [`render`] gives, to the last bit, whatever the rounds were. A change starts the picture anew; the
/// hierarchy over the geometry is built once and outlives all of them.
///
/// ```
/// use velour::render::{Renderer, Settings, Silent};
/// use velour::scene::{Scene, ShaderFiles};
///
/// let shaders = ShaderFiles::default()
///     .with_shader("surface glow(color c = 1) { Ci = c * emission(); }")?
///     .with_shader("surface matte() { Ci = 0.5 * diffuse(N); }")?;
/// let xml = r#"<World><Camera eye="0,0,4" look_at="0,0,0" fov="60"/>
///     <ShaderGroup name="ball">shader matte layer1;</ShaderGroup><Sphere center="0,0,0" radius="1"/>
///     <ShaderGroup name="lamp">shader glow layer1;</ShaderGroup><Sphere center="0,3,3" radius="1"/></World>"#;
/// let scene = Scene::load(xml, &[], &shaders)?;
/// let settings = Settings { width: 16, height: 16, samples: 16, ..Settings::default() };
/// let mut renderer = Renderer::new(&scene, &settings)?;
/// while renderer.round_of(4, &Silent)? {
///     let _so_far = renderer.picture();
/// }
/// let dim = renderer.picture().mean()[0];
/// // The ball is given the shader of the lamp.
/// let (ball, lamp) = (renderer.material("ball").unwrap(), renderer.material("lamp").unwrap());
/// renderer.set_material(ball, scene.materials[lamp].surface.clone())?;
/// renderer.finish(&Silent)?;
/// assert!(renderer.picture().mean()[0] > dim);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Renderer {
    world: World,
    pool: Threads,
    /// Each thread's memory.
    waves: Vec<Mutex<Option<Wave>>>,
    gathered: Mutex<Gathered>,
    /// What shaders said when surfaces were moved.
    said_moving: Vec<Report>,
    seconds_preparing: f64,
    /// What stands for the scene in the files of parts, once it was asked for.
    fingerprint: OnceLock<u64>,
}

impl fmt::Debug for Renderer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Renderer").field("scene", &self.world.scene.name).finish_non_exhaustive()
    }
}

impl Renderer {
    /// Prepares `scene`, of which it keeps a copy that shares geometry and programs; nothing is rendered yet.
    pub fn new(scene: &Scene, settings: &Settings) -> Result<Self, RenderError> {
        Self::stopped_by(scene, settings, Arc::default())
    }

    /// A renderer of another scene by the same settings, which the same flag stops, also while it prepares.
    ///
    /// # Errors
    /// The scene cannot be rendered, or it was stopped.
    pub fn anew(&self, scene: &Scene) -> Result<Self, RenderError> {
        Self::stopped_by(scene, self.settings(), self.stop().clone())
    }

    fn stopped_by(scene: &Scene, settings: &Settings, asked: Arc<AtomicBool>) -> Result<Self, RenderError> {
        let start = Instant::now();
        settings.check().map_err(RenderError::Settings)?;
        check_camera(&scene.camera)?;
        let pool = Threads::new(settings.threads)?;
        let stop = Arc::new(Stop::new(asked));
        stop.begin(settings, start);
        let make = || {
            let (moved, whole) = stop.whole(|| displaced(scene, settings, &stop));
            let (scene, reports) = moved?;
            if !whole {
                return Err(RenderError::Late);
            }
            let accel = Arc::new(Accel::new(&scene.geometry));
            let mut world = World::new(accel, scene, settings.clone(), None, stop.clone());
            world.reports.extend(reports.iter().cloned());
            Ok((world, reports))
        };
        let (world, said_moving) = pool.install(make)?;
        Ok(Self::of_world(world, pool, said_moving, start))
    }

    /// Nothing is rendered yet of a world that was begun at `start`.
    fn of_world(world: World, pool: Threads, said_moving: Vec<Report>, start: Instant) -> Self {
        Renderer {
            waves: empty_waves(&pool),
            gathered: Mutex::new(Gathered::new(&world)),
            said_moving,
            seconds_preparing: start.elapsed().as_secs_f64(),
            fingerprint: OnceLock::new(),
            world,
            pool,
        }
    }

    /// Another renderer of the scene as it is now, over the same hierarchy.
    ///
    /// # Errors
    /// The settings cannot be rendered by.
    pub fn beside(&self, settings: &Settings) -> Result<Self, RenderError> {
        let start = Instant::now();
        settings.check().map_err(RenderError::Settings)?;
        let pool = Threads::new(settings.threads)?;
        let stop = Arc::new(Stop::new(Arc::default()));
        stop.begin(settings, start);
        let (accel, scene) = (self.world.accel.clone(), self.world.scene.clone());
        let mut world = pool.install(|| World::new(accel, scene, settings.clone(), None, stop));
        world.reports.extend(self.said_moving.iter().cloned());
        Ok(Self::of_world(world, pool, self.said_moving.clone(), start))
    }

    /// The scene as it is rendered now.
    pub fn scene(&self) -> &Scene {
        &self.world.scene
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.world.settings
    }

    pub(super) fn world(&self) -> &World {
        &self.world
    }

    /// What the scene needs.
    pub fn plan(&self) -> &Plan {
        &self.world.plan
    }

    /// The hierarchy over the scene's geometry: the same one from `new` on.
    pub fn accel(&self) -> &Arc<Accel> {
        &self.world.accel
    }

    /// Ends the round that is running once it is set: from another thread, or by a signal. What is unfinished in the middle of a shader
    /// is left out.
    ///
    /// It stays set until whoever sets it stores `false`; no change of the scene does, or a signal that comes with a change would be lost.
    /// Meanwhile rounds add nothing, and changes take hold, but what shaders have to say of lights and of the background for them is asked
    /// at the next round that may go on. So the picture after a stop is the one without it, whatever was changed in between. Whoever sets it
    /// to have changes taken stores `false` first and then looks for changes, so that one that comes meanwhile stops the next round.
    pub fn stop(&self) -> &Arc<AtomicBool> {
        self.world.stop.asked()
    }

    /// Renders the next round; true says that something is left to do, also when `progress` has stopped the round.
    ///
    /// A render of a fixed number of samples is one round. One that stops by noise or time has as many as it takes.
    pub fn round(&mut self, progress: &dyn Progress) -> Result<bool, RenderError> {
        self.round_of(u32::MAX, progress)
    }

    /// The same, with at most `samples` more of each pixel.
    ///
    /// How a fixed number of samples is cut into rounds does not show in the picture. A render that stops by noise or
    /// time looks at its error after each round, so there it does.
    pub fn round_of(&mut self, samples: u32, progress: &dyn Progress) -> Result<bool, RenderError> {
        let gathered = self.gathered.get_mut().map_err(|_| RenderError::ThreadFailed)?;
        gathered.check()?;
        gathered.check_time()?;
        if !self.prepare()? {
            return Ok(true);
        }
        let gathered = self.gathered.get_mut().map_err(|_| RenderError::ThreadFailed)?;
        let tasks = gathered.rounds.next(&self.world.settings, samples);
        let start = Instant::now();
        self.trace(&tasks, progress);
        let gathered = self.gathered.get_mut().map_err(|_| RenderError::ThreadFailed)?;
        gathered.seconds_tracing += start.elapsed().as_secs_f64();
        gathered.check()?;
        gathered.check_time()?;
        let settings = &self.world.settings;
        Ok(self.pool.install(|| gathered.rounds.look(settings, &gathered.film)))
    }

    /// Makes up for what a stop has kept from being prepared; false when it does so again.
    fn prepare(&mut self) -> Result<bool, RenderError> {
        if self.world.ready || self.world.stop.now() {
            return Ok(self.world.ready);
        }
        let start = Instant::now();
        let World { accel, scene, settings, stop, .. } = &self.world;
        let make = || World::new(accel.clone(), scene.clone(), settings.clone(), None, stop.clone());
        let world = self.pool.install(make);
        self.take(world);
        self.seconds_preparing += start.elapsed().as_secs_f64();
        // Samples of a part that was gone on from stay.
        let gathered = self.gathered.get_mut().map_err(|_| RenderError::ThreadFailed)?;
        gathered.reports.clone_from(&self.world.reports);
        gathered.check()?;
        gathered.check_time()?;
        Ok(self.world.ready)
    }

    /// Takes a world over the same geometry in place of the one there is.
    fn take(&mut self, world: World) {
        self.world = world;
        self.world.reports.extend(self.said_moving.iter().cloned());
        self.waves = empty_waves(&self.pool);
    }

    /// Renders round after round until nothing is left to do or `progress` asks to stop.
    pub fn finish(&mut self, progress: &dyn Progress) -> Result<(), RenderError> {
        while self.round(progress)? && !progress.cancelled() && !self.world.stop.now() {}
        Ok(())
    }

    /// Does the tasks; each thread takes the next one until none is left.
    fn trace(&self, tasks: &[Task], progress: &dyn Progress) {
        let Renderer { world, waves, gathered, .. } = self;
        let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        if progress.cancelled() {
            return;
        }
        let (stop, pause) = (|| world.stop.now(), || world.stop.now() || progress.cancelled());
        self.pool.broadcast(|thread| {
            let Ok(mut wave) = waves[thread.index()].lock() else { return };
            let wave = wave.get_or_insert_with(|| Wave::new(world));
            // A pause that is always due would else keep everything from going on.
            let mut fresh = true;
            let goes_on = |fresh: &mut bool| !stop() && (std::mem::take(fresh) || !pause());
            while let Some(task) = tasks.get(next.fetch_add(1, Ordering::Relaxed)).filter(|_| goes_on(&mut fresh)) {
                let tile = Tile::number(&world.settings, task.tile);
                let Ok(mut sums) = gathered.lock().map(|mut all| all.film.take(task.tile)) else { return };
                let end = render_tile(world, wave, &tile, task.first..task.end, &mut sums, [&stop, &pause]);
                let Ok(mut all) = gathered.lock() else { return };
                all.film.give(task.tile, sums);
                all.keep(&world.settings, &Task { end, ..*task }, wave);
                if wave.shading.failed() {
                    next.store(tasks.len(), Ordering::Relaxed);
                }
                drop(all);
                progress.tiles(done.fetch_add(1, Ordering::Relaxed) + 1, tasks.len());
            }
        });
    }

    /// The picture so far; black where there is no sample yet.
    pub fn picture(&self) -> Image {
        let all = self.gathered.lock().unwrap_or_else(PoisonError::into_inner);
        let settings = &self.world.settings;
        let channels = if settings.alpha { 4 } else { 3 };
        let pixels = self.pool.install(|| all.film.picture(settings, 0..settings.halves(), channels));
        Image { width: settings.width, height: settings.height, channels, pixels, about: self.about_of(&all) }
    }

    /// What is known of the picture so far, without the picture.
    pub fn about(&self) -> About {
        self.about_of(&self.gathered.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn about_of(&self, all: &Gathered) -> About {
        let settings = &self.world.settings;
        About {
            scene: file_name(&self.world.scene.name),
            samples: settings.samples,
            taken: counts(all.rounds.held()),
            noise: all.rounds.noise().filter(|_| settings.adapts()),
            seed: settings.seed,
            paths: all.paths,
            rays: all.rays,
            seconds_preparing: self.seconds_preparing,
            seconds_tracing: all.seconds_tracing,
            reports: self.reports(all),
        }
    }

    /// The fewest and the most samples of a pixel so far.
    pub fn taken(&self) -> [u32; 2] {
        counts(self.gathered.lock().unwrap_or_else(PoisonError::into_inner).rounds.held())
    }

    /// The samples so far, to be kept in a file and gone on from.
    pub fn part(&self) -> Part {
        let all = self.gathered.lock().unwrap_or_else(PoisonError::into_inner);
        let settings = &self.world.settings;
        let sums = self.pool.install(|| all.film.sums(settings, 0..settings.halves()));
        Part::new(self.whole(), all.rounds.held().to_vec(), sums)
    }

    /// Goes on from a part of this picture, whose samples take the place of all there are. Those of it that lie between
    /// `first_sample` and `samples` are not made again; those that do not are kept as well.
    ///
    /// # Errors
    /// It is of another picture, or the render stops by noise or time.
    pub fn resume(&mut self, part: Part) -> Result<(), PartError> {
        if self.world.settings.adapts() {
            return Err(PartError::Adapts);
        }
        part.is_of(&self.whole())?;
        self.restart();
        let all = self.gathered.get_mut().unwrap_or_else(PoisonError::into_inner);
        let (held, sums) = part.into_sums();
        all.rounds.resume(held);
        all.film.keep(sums);
        Ok(())
    }

    /// What its parts are parts of.
    fn whole(&self) -> Whole {
        let (scene, settings) = (&self.world.scene, &self.world.settings);
        let Settings { width, height, alpha, seed, tile_size, .. } = *settings;
        Whole {
            scene: file_name(&scene.name),
            fingerprint: *self.fingerprint.get_or_init(|| fingerprint(scene, settings)),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            width,
            height,
            alpha,
            seed,
            tile_size,
        }
    }

    /// What was said, and what is missing.
    fn reports(&self, all: &Gathered) -> Vec<Report> {
        let mut reports = reports(&self.world.scene, all.reports.clone(), &all.dropped);
        let empty = all.rounds.taken().filter(|samples| *samples == 0).count();
        if empty > 0 && all.rounds.late() {
            let share = 100.0 * empty as f64 / all.rounds.held().len() as f64;
            let text =
                format!("warning: the time was up before {share:.0} % of the picture had a sample; that part is black");
            reports.push(Report::warning(text));
        }
        reports
    }

    /// Starts the picture anew.
    pub fn restart(&mut self) {
        for wave in &mut self.waves {
            match wave.get_mut() {
                Ok(Some(wave)) => wave.shading.start_over(),
                Ok(None) | Err(_) => *wave = Mutex::new(None),
            }
        }
        self.world.stop.begin(&self.world.settings, Instant::now());
        self.gathered = Mutex::new(Gathered::new(&self.world));
    }

    /// Looks through another camera; the picture starts anew.
    pub fn set_camera(&mut self, camera: Camera) -> Result<(), RenderError> {
        check_camera(&camera)?;
        let scene = Scene { camera, ..self.world.scene.clone() };
        self.remake(scene, self.world.settings.clone(), None);
        Ok(())
    }

    /// Renders by other settings; the picture starts anew.
    pub fn set_settings(&mut self, settings: &Settings) -> Result<(), RenderError> {
        settings.check().map_err(RenderError::Settings)?;
        if settings.threads != self.world.settings.threads {
            self.pool = Threads::new(settings.threads)?;
        }
        self.remake(self.world.scene.clone(), settings.clone(), None);
        Ok(())
    }

    /// The index of the material of a name, the first one if there are several.
    pub fn material(&self, name: &str) -> Option<usize> {
        self.world.scene.materials.iter().position(|material| material.name == name)
    }

    /// Has another group shade the surfaces of a material; the picture starts anew.
    ///
    /// What depends on the group is renewed: the plan, emission, lights, the background and its table if they are of this
    /// material.
    pub fn set_material(&mut self, index: usize, group: Group) -> Result<(), RenderError> {
        self.set_materials(vec![(index, group)])
    }

    /// The same for several materials at once, by their indices.
    pub fn set_materials(&mut self, groups: Vec<(usize, Group)>) -> Result<(), RenderError> {
        let mut scene = self.world.scene.clone();
        let count = scene.materials.len();
        let mut of_background = false;
        for (index, group) in groups {
            let material = scene.materials.get_mut(index).ok_or(RenderError::Material { index, count })?;
            material.surface = group;
            of_background |= scene.background.is_some_and(|background| background.material as usize == index);
        }
        // A constant is found anew at once; it is the table that is worth keeping.
        let ready = self.world.ready;
        let sky = match &mut self.world.sky {
            Sky::Shader { material, table } if ready && !of_background => {
                Some(Sky::Shader { material: *material, table: table.take() })
            }
            Sky::Shader { .. } | Sky::Constant(_) => None,
        };
        self.remake(scene, self.world.settings.clone(), sky);
        Ok(())
    }

    /// Makes the world anew but for its hierarchy, and for its background where one is given.
    fn remake(&mut self, scene: Scene, settings: Settings, sky: Option<Sky>) {
        let start = Instant::now();
        let (accel, stop) = (self.world.accel.clone(), self.world.stop.clone());
        stop.begin(&settings, start);
        let world = self.pool.install(|| World::new(accel, scene, settings, sky, stop));
        self.take(world);
        self.seconds_preparing = start.elapsed().as_secs_f64();
        self.fingerprint = OnceLock::new();
        self.gathered = Mutex::new(Gathered::new(&self.world));
    }
}

/// The last name of a path: where a scene lies on this machine is nothing that a picture should tell.
fn file_name(path: &str) -> String {
    std::path::Path::new(path).file_name().map_or(path.to_owned(), |name| name.to_string_lossy().into_owned())
}

fn check_camera(camera: &Camera) -> Result<(), RenderError> {
    camera.flaw().map_or(Ok(()), |flaw| Err(RenderError::Camera(flaw)))
}

fn empty_waves(pool: &Threads) -> Vec<Mutex<Option<Wave>>> {
    (0..pool.current_num_threads()).map(|_| Mutex::new(None)).collect()
}

/// Each report once, in an order that does not depend on threads.
///
/// Differs from OSL: what shaders print while rendering comes out sorted and each text once, since lanes, tiles and
/// threads have no order of their own. `velour tree` prints as written.
fn reports(scene: &Scene, mut reports: Vec<Report>, dropped: &Dropped) -> Vec<Report> {
    reports.sort_by_key(Report::key);
    reports.dedup_by_key(|report| report.key());
    if dropped.count > 0 {
        let material = dropped.material.checked_sub(1).and_then(|m| scene.materials.get(m));
        let (file, name) = material.map_or((String::new(), "?"), |m| (m.place.to_string(), m.name.as_str()));
        let what = "gave light that is not a finite number";
        let text = format!("shader group `{name}` {what}; {} contributions were dropped", dropped.count);
        reports.push(Report::mistake(ReportPlace { file, ..ReportPlace::default() }, text));
    }
    reports
}

/// Renders `scene` in one go; tells `progress` of every finished tile.
pub fn render(scene: &Scene, settings: &Settings, progress: &dyn Progress) -> Result<Image, RenderError> {
    let mut renderer = Renderer::new(scene, settings)?;
    renderer.finish(progress)?;
    Ok(renderer.picture())
}
