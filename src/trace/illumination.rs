//! Light sampling as a scene asks for it: its lights, the rays to them, and how found light is shared.

use crate::light::{Heuristic, Lensed, Lights, Sight, Straight};
use crate::scene::{Baked, LightSampling, SpacetimeKind};
use crate::spacetime::Schwarzschild;

/// What light sampling needs.
pub struct Illumination {
    /// The lights.
    pub lights: Lights,
    /// The rays to them.
    pub sight: Box<dyn Sight>,
    /// How light is shared; `None`: all of it belongs to light sampling, as in the paper.
    heuristic: Option<Heuristic>,
}

/// Least orientation factor of lights where the straight direction to them is a guess.
const FLOOR: f64 = 0.1;

impl Illumination {
    /// Light sampling for `scene`; `None` where it is off or of no use.
    pub fn of(scene: &Baked) -> Option<Self> {
        let settings = &scene.settings;
        let is_lit =
            scene.materials.iter().any(|material| material.spreads_light()) && settings.max_depth > 1;
        if settings.light_sampling == LightSampling::Off || !is_lit {
            return None;
        }
        let straight = settings.light_sampling == LightSampling::Straight;
        let sight: Box<dyn Sight> = match scene.spacetime {
            SpacetimeKind::Schwarzschild { center, schwarzschild_radius } if !straight => {
                Box::new(Lensed::new(Schwarzschild::new(schwarzschild_radius), center, settings.max_winding)?)
            }
            _ => Box::new(Straight),
        };
        let floor = if scene.spacetime == SpacetimeKind::Flat { 0.0 } else { FLOOR };
        let lights =
            Lights::new(&scene.geometry, &scene.materials, &scene.environment, &scene.punctual, floor);
        let heuristic = (!straight).then_some(settings.heuristic);
        (!lights.is_empty()).then_some(Self { lights, sight, heuristic })
    }

    /// Share of a light sample of density `sampled` that a surface would find with density `found`.
    #[inline]
    pub fn share_of_sample(&self, sampled: f64, found: f64) -> f64 {
        self.heuristic.map_or(1.0, |heuristic| heuristic.share(sampled, found))
    }

    /// Share of light that a surface found with density `found` and light sampling would with density `sampled`.
    #[inline]
    pub fn share_of_find(&self, sampled: f64, found: f64) -> f64 {
        match self.heuristic {
            Some(heuristic) => heuristic.share(found, sampled),
            None => f64::from(u8::from(sampled == 0.0)),
        }
    }
}
