//! Dielectrics around a place: a camera may be in glass, in a glass of water, or in the water.

use glam::DVec3;

use super::stages::meet::meet;
use super::transport::Landing;
use crate::geometry::{Geometry, Line, PrimitiveId, Segment};
use crate::scene::Baked;
use crate::shade::Media;
use crate::spacetime::Side;

/// Unit directions from the place to the starts of the lines that are followed to it, none of them special: if the
/// lines do not agree, glass is not closed.
const FROM: [DVec3; 5] = [
    DVec3::new(0.361, 0.803, 0.474),
    DVec3::new(-0.532, 0.277, -0.8),
    DVec3::new(0.719, -0.613, -0.327),
    DVec3::new(-0.271, -0.533, 0.802),
    DVec3::new(-0.887, 0.121, 0.446),
];
/// Most surfaces that a line may cross.
const MOST: usize = 1000;

/// The dielectrics around `place` on a side; none where glass is not closed.
pub fn media_around(scene: &Baked, side: Side, place: DVec3) -> Media {
    let has_glass = scene.materials.iter().any(|material| material.is_dielectric());
    let Some((min, max)) = scene.geometry.of(side).and_then(Geometry::bounds).filter(|_| has_glass) else {
        return Media::VACUUM;
    };
    let reach = min.distance(max) + place.distance(0.5 * (min + max));
    let [first, others @ ..] = FROM.map(|from| media_after(scene, side, place + reach * from, place));
    first.filter(|_| others.iter().all(|other| *other == first)).unwrap_or_default()
}

/// The dielectrics around a line at its end, if it starts in none; `None` if it crosses too much.
fn media_after(scene: &Baked, side: Side, start: DVec3, end: DVec3) -> Option<Media> {
    let direction = (end - start).try_normalize()?;
    let (mut position, mut origin_prim, mut media) = (start, PrimitiveId::none_on(side), Media::VACUUM);
    for _ in 0..MOST {
        let line = Line { p0: position, p2: end };
        let Some(hit) = scene.geometry.intersect(&line, origin_prim) else { return Some(media) };
        position = line.point(hit.s);
        let landing = Landing::conformal(position, direction, hit.primitive);
        let meeting = meet(scene, &landing, media);
        (origin_prim, media) = (meeting.primitive, meeting.beyond);
    }
    None
}
