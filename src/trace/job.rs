//! The job: a scene and all that a render knows of it while it takes samples.

use glam::Vec3;

use super::halt::Halt;
use super::illumination::Illumination;
use super::lamp_halos::LampHalos;
use super::ray_cone::RayCones;
use super::surroundings::media_around;
use crate::film::Needs;
use crate::scene::{Baked, SamplerKind, Settings};
use crate::shade::{Media, Sampler};

/// Data that every kernel may read.
pub struct Job<'a> {
    /// The baked scene.
    pub scene: &'a Baked,
    /// Its settings.
    pub settings: &'a Settings,
    /// Random numbers.
    pub sampler: Sampler,
    /// Dielectrics around the camera.
    pub media: Media,
    /// True if textures or vertex colours vary a material.
    pub has_maps: bool,
    /// True if a surface's light depends on where exactly a ray lands on it.
    pub has_details: bool,
    /// True if there are surfaces that rays may pass through.
    pub has_passages: bool,
    /// True if there is glass that absorbs.
    pub absorbs: bool,
    /// What textures are filtered by, if any can be.
    pub cones: Option<RayCones>,
    /// Halos of small lamps, if there are any.
    pub halos: Option<LampHalos>,
    /// Light sampling, if any.
    pub illumination: Option<Illumination>,
    /// Interruption and deadline, at which to give up.
    pub halt: Halt<'a>,
}

impl<'a> Job<'a> {
    /// A render of `scene` under `settings`, before anything is known of its lights and ray cones, that gives up when
    /// `halt` is due.
    pub fn new(scene: &'a Baked, settings: &'a Settings, halt: Halt<'a>) -> Self {
        let sampler = match settings.sampler {
            SamplerKind::Sobol => Sampler::sobol(settings.seed),
            SamplerKind::Independent => Sampler::independent(settings.seed),
        };
        let camera = &scene.camera;
        let media = media_around(scene, camera.side, camera.position + camera.near * camera.forward);
        let has_maps = scene.materials.iter().any(|material| !material.maps.is_empty());
        let has_passages = scene.materials.iter().any(|material| material.opacity.is_some());
        let has_details = !scene.materials.iter().all(|material| material.only_emits());
        let absorbs = scene.materials.iter().any(|material| material.attenuation != Vec3::ZERO);
        Self {
            scene,
            settings,
            sampler,
            media,
            has_maps,
            has_details,
            has_passages,
            absorbs,
            cones: None,
            halos: LampHalos::of(scene),
            illumination: None,
            halt,
        }
    }

    /// True if it matters where exactly rays land that are no light rays: to a surface, or to what `needs` tell.
    #[inline(always)]
    pub fn lands_exactly(&self, needs: Needs) -> bool {
        self.has_details || needs.camera_ray
    }
}
