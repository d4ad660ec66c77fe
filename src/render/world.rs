//! A scene made ready: hierarchy, lights with their powers, background with its table, and the plan.

use super::accel::Accel;
use super::camera::RayCamera;
use super::light::Lights;
use super::plan::{MaterialPlan, Plan};
use super::radiance;
use super::settings::{Filter, Settings};
use super::shading::Shading;
use super::sky::Sky;
use super::stop::Stop;
use super::window::Window;
use crate::exec::{Group, Host, Report};
use crate::scene::Scene;
use glam::Vec3;
use std::sync::Arc;

/// Everything that tiles share.
pub struct World {
    /// The scene.
    pub scene: Scene,
    /// The settings.
    pub settings: Settings,
    /// What is needed.
    pub plan: Plan,
    /// The camera.
    pub camera: RayCamera,
    /// Where samples go around their pixels, when not evenly into them.
    pub window: Option<Window>,
    /// The hierarchy, which depends on the scene's geometry alone.
    pub accel: Arc<Accel>,
    /// The lights.
    pub lights: Lights,
    /// What shaders may ask.
    pub host: Arc<dyn Host>,
    /// The background.
    pub sky: Sky,
    /// The radiance of each object, where it is one constant; zero for objects that do not emit.
    pub object_emission: Vec<Option<Vec3>>,
    /// When to stop.
    pub stop: Arc<Stop>,
    /// What shaders said while lights were prepared.
    pub reports: Vec<Report>,
    /// Lights and background are known; else `stop` came first, and nothing can be traced.
    pub ready: bool,
}

impl World {
    /// Prepares `scene`; runs shaders where emission has to be known beforehand.
    ///
    /// `accel` is over the scene's geometry. A `sky` that is given is taken as it is. Shaders give up when `stop` says so, which leaves a
    /// world that is not ready.
    pub fn new(accel: Arc<Accel>, scene: Scene, settings: Settings, sky: Option<Sky>, stop: Arc<Stop>) -> Self {
        let plan = Plan::new(&scene, &settings);
        let host: Arc<dyn Host> =
            Arc::new(super::host::host(&scene.camera, &settings, &scene.textures, Some(accel.clone())).until(&stop));
        let mut shading = Shading::new(settings.closure, host.clone());
        let ((object_emission, powers, sky), ready) = stop.whole(|| {
            let constant = radiance::constant_emission(&scene, &plan, &mut shading);
            let powers = radiance::light_powers(&scene, &plan, &mut shading, &constant);
            let sky = sky.unwrap_or_else(|| radiance::sky(&scene, &plan, &settings, &mut shading, &host));
            (constant, powers, sky)
        });
        World {
            camera: RayCamera::new(&scene.camera, settings.whole_frame().size),
            window: (settings.filter == Filter::BlackmanHarris && settings.jitter).then(Window::new),
            accel,
            stop,
            lights: Lights::new(&scene.geometry, &powers, settings.light_choice, settings.light_points),
            host,
            sky,
            object_emission,
            reports: shading.take_reports(),
            ready,
            plan,
            scene,
            settings,
        }
    }

    /// The material of a primitive.
    #[inline(always)]
    pub fn material_of(&self, primitive: u32) -> usize {
        let object = self.scene.geometry.primitives[primitive as usize].object;
        self.scene.geometry.objects[object as usize].material as usize
    }

    /// The constant radiance of a primitive, if it has one.
    #[inline(always)]
    pub fn emission_of(&self, primitive: u32) -> Option<Vec3> {
        self.object_emission[self.scene.geometry.primitives[primitive as usize].object as usize]
    }

    /// The group and the plan of a material.
    #[inline(always)]
    pub fn material(&self, index: usize) -> (&Group, &MaterialPlan) {
        (&self.scene.materials[index].surface, &self.plan.materials[index])
    }
}
