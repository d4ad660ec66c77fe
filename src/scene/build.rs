//! Builds a scene, one XML element after another; what each tag and attribute means is written here and nowhere else.

use super::camera::{Camera, CameraFlaw};
use super::error::{Place, SceneError, SceneProblem};
use super::extent;
use super::flakes::Flakes;
use super::geometry::{Geometry, Shape};
use super::group::{GroupCompiler, GroupSpec, Usage};
use super::group_xml::read_group;
use super::mesh::{Added, MaterialNames, MeshFile, add_mesh};
use super::placement::Placement;
use super::scene::{Background, Material, Options, Scene};
use super::source::within;
use super::weave::Weave;
use super::xml::Element;
use crate::exec::Group;
use crate::lang::nearest::nearest;
use crate::limits::{PRIMITIVES, SCENE_VALUES};
use crate::texture::TextureFiles;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

const TAGS: [&str; 9] = ["Option", "Camera", "Sphere", "Quad", "Model", "Weave", "Flakes", "Background", "ShaderGroup"];
const OPTIONS: [&str; 5] = ["max_bounces", "rr_depth", "aa", "no_jitter", "show_globals"];

/// The side of the background's table when the scene does not say.
const DEFAULT_BACKGROUND_RESOLUTION: u32 = 1024;

/// A scene in the making.
pub struct Builder<'c> {
    scene: Scene,
    geometry: Geometry,
    folders: Vec<PathBuf>,
    compiler: &'c dyn GroupCompiler,
    by_name: HashMap<String, u32>,
    /// How many elements that are still to come name a file.
    later_models: HashMap<String, usize>,
    /// Meshes that another element will need.
    meshes: HashMap<PathBuf, MeshFile>,
    /// Triangles, spheres and quads that all elements make, as far as it is known.
    announced: u64,
    /// Numbers and texts of all parameters so far.
    values: usize,
    /// Materials that have a displacement group and no other yet.
    unshaded: Vec<u32>,
}

impl<'c> Builder<'c> {
    /// An empty scene.
    pub fn new(name: String, folders: Vec<PathBuf>, compiler: &'c dyn GroupCompiler) -> Self {
        let scene = Scene {
            name,
            camera: Camera::default(),
            options: Options::default(),
            materials: Vec::new(),
            geometry: Arc::default(),
            background: None,
            warnings: Vec::new(),
            textures: Arc::new(TextureFiles::new(folders.clone()).with_access(compiler.access())),
        };
        Builder {
            scene,
            geometry: Geometry::default(),
            folders,
            compiler,
            by_name: HashMap::new(),
            later_models: HashMap::new(),
            meshes: HashMap::new(),
            announced: 0,
            values: 0,
            unshaded: Vec::new(),
        }
    }

    /// Tells of an element that will be taken later: what it shares with others is then kept for it.
    ///
    /// # Errors
    /// All elements together make more triangles than a scene may have; said before any is made.
    pub fn announce(&mut self, e: &Element) -> Result<(), SceneError> {
        if let ("Model", Some(filename)) = (e.tag(), e.node.attribute("filename")) {
            *self.later_models.entry(filename.to_owned()).or_default() += 1;
        }
        self.announced = self.announced.saturating_add(match e.tag() {
            "Sphere" | "Quad" => 1,
            "Flakes" => Flakes::read(e).map_or(0, |flakes| flakes.triangles()),
            "Weave" => Weave::read(e).map_or(0, |weave| weave.triangles()),
            _ => 0,
        });
        self.check_size(e)
    }

    /// Refuses the element that makes the scene too large.
    fn check_size(&self, e: &Element) -> Result<(), SceneError> {
        if self.announced <= PRIMITIVES {
            return Ok(());
        }
        let problem = SceneProblem::TooManyPrimitives { count: self.announced, most: PRIMITIVES };
        Err(SceneError::at(e.place(), problem)
            .with_help("give <Flakes> a smaller `count`, <Weave> fewer yarns, meshes fewer faces"))
    }

    /// Takes one child of `<World>`.
    pub fn element(&mut self, e: &Element) -> Result<(), SceneError> {
        match e.tag() {
            "Option" => self.option(e),
            "Camera" => self.camera(e),
            "Sphere" => self.sphere(e),
            "Quad" => self.quad(e),
            "Model" => self.model(e),
            "Weave" => self.weave(e),
            "Flakes" => self.flakes(e),
            "Background" => self.background(e),
            "ShaderGroup" => self.shader_group(e),
            _ => Err(e.unknown_tag(&TAGS)),
        }
    }

    /// The finished scene; `root` is the place to blame for what is missing.
    pub fn finish(mut self, root: Place) -> Result<Scene, SceneError> {
        if self.geometry.primitives.is_empty() && self.scene.background.is_none() {
            return Err(SceneError::at(root, SceneProblem::NothingToSee)
                .with_help("add a <Sphere>, <Quad>, <Model> or <Background>"));
        }
        if let Some(oddity) = extent::oddity(&self.geometry) {
            self.scene.warnings.push(format!("{root}: warning: {oddity}"));
        }
        for &id in &self.unshaded {
            let Material { name, place, .. } = &self.scene.materials[id as usize];
            self.scene.warnings.push(format!(
                "{place}: warning: displacement group `{name}` is alone: give it and the group that shades its surfaces one `name`"
            ));
        }
        Ok(Scene { geometry: Arc::new(self.geometry), ..self.scene })
    }

    fn option(&mut self, e: &Element) -> Result<(), SceneError> {
        for attribute in e.attributes() {
            let name = attribute.name();
            if !OPTIONS.contains(&name) {
                let hint = nearest(name, &OPTIONS).map(|n| format!("; did you mean `{n}`?")).unwrap_or_default();
                let place = e.place_at(attribute.range().start);
                self.scene.warnings.push(format!("{place}: warning: unknown option `{name}` is ignored{hint}"));
                continue;
            }
            let value: Option<u32> = attribute.value().strip_prefix("int ").and_then(|v| v.trim().parse().ok());
            let Some(value) = value else {
                return Err(e.bad_value(name, "`int N` with N of at least 0"));
            };
            let options = &mut self.scene.options;
            match name {
                "max_bounces" => options.max_bounces = Some(value),
                "rr_depth" => options.rr_depth = Some(value),
                "aa" => options.aa = Some(value.clamp(1, 4096)),
                "no_jitter" => options.no_jitter = Some(value != 0),
                _ => options.show_globals = Some(value),
            }
        }
        Ok(())
    }

    fn camera(&mut self, e: &Element) -> Result<(), SceneError> {
        e.check_attributes(&["eye", "dir", "look_at", "up", "fov", "res"])?;
        let base = Camera::default();
        let eye = e.vector("eye")?.unwrap_or(base.eye);
        let look_at = e.vector("look_at")?;
        let dir = e.vector("dir")?.or(look_at.map(|at| at - eye)).unwrap_or(base.direction);
        let up = e.vector("up")?.unwrap_or(base.up);
        let fov = e.number::<f32>("fov", "an angle in degrees")?.unwrap_or(base.fov);
        // What has no length stays so, and is a flaw.
        let camera = Camera { eye, direction: dir.normalize_or_zero(), up, fov };
        if let Some(flaw) = camera.flaw() {
            let error = match flaw {
                CameraFlaw::Angle => e.bad_value("fov", "an angle between 0 and 180 degrees"),
                CameraFlaw::TooNarrow => SceneError::at(e.value_place("fov"), SceneProblem::Camera(flaw)),
                CameraFlaw::Eye | CameraFlaw::Direction | CameraFlaw::Up => {
                    SceneError::at(e.place(), SceneProblem::Camera(flaw))
                }
            };
            return Err(error.with_help(flaw.help()));
        }
        self.scene.camera = camera;
        self.scene.options.resolution = resolution(e)?.or(self.scene.options.resolution);
        Ok(())
    }

    /// The group that geometry takes: the last one before it.
    fn last_material(&self, e: &Element) -> Result<u32, SceneError> {
        match self.scene.materials.len() {
            0 => Err(SceneError::at(e.place(), SceneProblem::NoGroupAbove { tag: e.tag().to_owned() })
                .with_help("geometry and background take the last <ShaderGroup> above them")),
            n => Ok(n as u32 - 1),
        }
    }

    /// Keeps the steps that the element of the next primitive states.
    fn resolution(&mut self, e: &Element) -> Result<(), SceneError> {
        if let Some(steps) = e.number::<u32>("resolution", "a whole number")? {
            self.geometry.resolutions.push((self.geometry.primitives.len() as u32, steps));
        }
        Ok(())
    }

    fn sphere(&mut self, e: &Element) -> Result<(), SceneError> {
        e.check_attributes(&["center", "radius", "resolution"])?;
        let material = self.last_material(e)?;
        let center = e.required_vector("center")?;
        e.required("radius")?;
        let radius = e.number::<f32>("radius", "a number above 0")?.unwrap_or(0.0);
        self.resolution(e)?;
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(e.bad_value("radius", "a number above 0"));
        }
        self.geometry.add_single(Shape::Sphere { center, radius }, material, e.place());
        Ok(())
    }

    fn quad(&mut self, e: &Element) -> Result<(), SceneError> {
        e.check_attributes(&["corner", "edge_x", "edge_y", "resolution"])?;
        let material = self.last_material(e)?;
        let corner = e.required_vector("corner")?;
        let edge_x = e.required_vector("edge_x")?;
        let edge_y = e.required_vector("edge_y")?;
        self.resolution(e)?;
        let shape = Shape::Quad { corner, edge_x, edge_y };
        // Edges parallel up to rounding have no normal either.
        if shape.area() <= 1e-6 * edge_x.length() * edge_y.length() {
            return Err(SceneError::at(e.place(), SceneProblem::NoArea { tag: e.tag().to_owned() })
                .with_help("`edge_x` and `edge_y` must both have a length and not be parallel"));
        }
        self.geometry.add_single(shape, material, e.place());
        Ok(())
    }

    fn model(&mut self, e: &Element) -> Result<(), SceneError> {
        e.check_attributes(&[&["filename"], &Placement::ATTRIBUTES[..]].concat())?;
        let last = self.last_material(e)?;
        let filename = e.required("filename")?;
        let placement = Placement::read(e)?;
        let place = e.value_place("filename");
        let access = self.compiler.access();
        let Some(path) = self.folders.iter().map(|f| within(f, filename)).find(|p| access.is_file(p)) else {
            let looked: Vec<String> = self.folders.iter().map(|f| f.display().to_string()).collect();
            return Err(SceneError::at(place, SceneProblem::MeshNotFound { file: filename.to_owned() })
                .with_help(format!("looked in {}", looked.join(", "))));
        };
        let wrong = |flaw| SceneError::at(place.clone(), SceneProblem::Mesh { file: path.display().to_string(), flaw });
        let mut file = match self.meshes.remove(&path) {
            Some(file) => file,
            None => MeshFile::read(&path, &access).map_err(wrong)?,
        };
        // Those of a file are told once.
        self.scene.warnings.append(&mut file.warnings);
        self.announced = self.announced.saturating_add(file.triangles());
        self.check_size(e)?;
        let names = MaterialNames { by_name: &self.by_name, last };
        let added = add_mesh(&mut self.geometry, &file, placement.as_ref(), &names, &place);
        self.warn_of_mesh(filename, &place, &added.map_err(wrong)?);
        // Kept for the next element of this file; none comes, and it goes with the last one that is told of.
        if self.later_models.get_mut(filename).is_some_and(|left| std::mem::replace(left, left.saturating_sub(1)) > 1) {
            self.meshes.insert(path, file);
        }
        Ok(())
    }

    fn warn_of_mesh(&mut self, filename: &str, place: &Place, added: &Added) {
        let warnings = &mut self.scene.warnings;
        if added.kept == 0 {
            warnings.push(format!("{place}: warning: no triangle of `{filename}` has an area; it is left out"));
        } else if added.degenerate > 0 {
            let count = added.degenerate;
            warnings.push(format!("{place}: warning: {count} triangles of `{filename}` have no area and are left out"));
        }
        if added.hurried {
            warnings.push(format!("{place}: warning: polygons of `{filename}` have too many corners to be cut well"));
        }
        if let [first, others @ ..] = &added.unmatched[..] {
            let more = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
            let what = "has no <ShaderGroup> of its name and takes the last one";
            warnings.push(format!("{place}: warning: material `{first}`{more} of `{filename}` {what}"));
        }
    }

    fn weave(&mut self, e: &Element) -> Result<(), SceneError> {
        e.check_attributes(&Weave::ATTRIBUTES)?;
        let warp = self.last_material(e)?;
        let weft = match e.node.attribute("weft_group") {
            None => warp,
            Some(name) => *self.by_name.get(name).ok_or_else(|| {
                let names: Vec<&str> = self.by_name.keys().map(String::as_str).collect();
                let error = e.bad_value("weft_group", "the name of a <ShaderGroup> above");
                match nearest(name, &names) {
                    Some(near) => error.with_help(format!("did you mean `{near}`?")),
                    None => error.with_help("give the <ShaderGroup> of the weft a `name`"),
                }
            })?,
        };
        Weave::read(e)?.add(&mut self.geometry, warp, weft, &e.place());
        Ok(())
    }

    fn flakes(&mut self, e: &Element) -> Result<(), SceneError> {
        e.check_attributes(&Flakes::ATTRIBUTES)?;
        let material = self.last_material(e)?;
        Flakes::read(e)?.add(&mut self.geometry, material, &e.place());
        Ok(())
    }

    fn background(&mut self, e: &Element) -> Result<(), SceneError> {
        e.check_attributes(&["resolution"])?;
        let material = self.last_material(e)?;
        let resolution = e.number::<i32>("resolution", "a whole number")?;
        let resolution = resolution.map_or(DEFAULT_BACKGROUND_RESOLUTION, |r| r.clamp(0, 8192) as u32);
        self.scene.background = Some(Background { material, resolution });
        Ok(())
    }

    fn shader_group(&mut self, e: &Element) -> Result<(), SceneError> {
        let spec = read_group(e, &self.folders)?;
        self.values +=
            spec.layers.iter().flat_map(|layer| &layer.params).map(|param| param.values.len()).sum::<usize>();
        if self.values > SCENE_VALUES {
            return Err(SceneError::at(e.place(), SceneProblem::TooManyValues { most: SCENE_VALUES }));
        }
        let group = self.compiler.compile(&spec).map_err(|error| error.or_at(&spec.layers[0].place))?;
        self.scene.warnings.extend(self.compiler.take_warnings());
        self.add_material(e.node.attribute("name"), spec, group);
        Ok(())
    }

    /// A second group of the same name replaces the surface or the displacement of the first.
    fn add_material(&mut self, name: Option<&str>, spec: GroupSpec, group: Group) {
        let (displaces, spec) = (spec.usage == Usage::Displacement, Arc::new(spec));
        if let Some(&id) = name.and_then(|n| self.by_name.get(n)) {
            let material = &mut self.scene.materials[id as usize];
            if displaces {
                (material.displacement, material.displacement_spec) = (Some(group), Some(spec));
            } else {
                (material.surface, material.surface_spec) = (group, spec);
                self.unshaded.retain(|unshaded| *unshaded != id);
            }
            return;
        }
        if displaces {
            self.unshaded.push(self.scene.materials.len() as u32);
        }
        if let Some(name) = name {
            self.by_name.insert(name.to_owned(), self.scene.materials.len() as u32);
        }
        self.scene.materials.push(Material {
            name: spec.name.clone(),
            displacement: displaces.then(|| group.clone()),
            displacement_spec: displaces.then(|| spec.clone()),
            surface: group,
            is_light: spec.is_light,
            place: spec.place.clone(),
            surface_spec: spec,
        });
    }
}

/// The width and height that a camera states.
fn resolution(e: &Element) -> Result<Option<[u32; 2]>, SceneError> {
    let what = "width and height in pixels, such as `640 480`,";
    let Some(numbers) = e.numbers("res", what)? else { return Ok(None) };
    let whole = |x: &f32| *x >= 1.0 && *x <= 65536.0 && x.fract() == 0.0;
    match numbers[..] {
        [width, height] if numbers.iter().all(whole) => Ok(Some([width as u32, height as u32])),
        _ => Err(e.bad_value("res", what)),
    }
}
