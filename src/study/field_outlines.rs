//! Outlines of what bends rays in a field of refraction, for a fan: holes, their photon spheres, lenses.

use glam::DVec3;

use crate::plot::{Color, Style};
use crate::spacetime::{GradedLens, IndexMedium, Sink};

/// A sphere that is drawn by its outline.
#[derive(Clone, Debug)]
pub(super) struct FieldOutline {
    /// Name in the key; alike for all of a kind.
    pub(super) name: &'static str,
    pub(super) style: Style,
    /// World position.
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

/// Radius of the disk that stands for a hole, which is a point of the chart, in radii of its photon sphere.
const DISK: f64 = 0.15;

/// All outlines.
pub(super) fn field_outlines(medium: &IndexMedium) -> Vec<FieldOutline> {
    let spheres = |name, style: fn() -> Style, radius: fn(&Sink) -> f64| {
        medium.sinks().iter().map(move |sink| {
            let (center, radius) = (sink.center, radius(sink));
            FieldOutline { name, style: style(), center, radius }
        })
    };
    let photon_spheres =
        spheres("photon sphere, about", || Style::dashed(Color::BLACK, 1.6), |sink| sink.photon_sphere);
    let holes =
        spheres("hole (not to scale)", || Style::area(Color::BLACK), |sink| DISK * sink.photon_sphere);
    let lens = |lens: &GradedLens| {
        let (name, radius) = match *lens {
            GradedLens::Gaussian { width, .. } => ("lens, to its width", width),
            GradedLens::Luneburg { radius, .. } => ("lens", radius),
        };
        FieldOutline { name, style: Style::dashed(Color::BLACK, 1.6), center: lens.center(), radius }
    };
    let lenses: &[GradedLens] = match medium {
        IndexMedium::SeveralHoles(_) => &[],
        IndexMedium::Lenses(lenses) => lenses.lenses(),
    };
    photon_spheres.chain(holes).chain(lenses.iter().map(lens)).collect()
}
