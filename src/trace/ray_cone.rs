//! Ray cones: width and spread of the beam that a ray stands for, by which textures are filtered.
//!
//! \[Akenine-Möller, Crassin, Boksansky, Belcour, Panteleev, Wright 2021, "Improved Shader and Texture Level of Detail Using
//! Ray Cones"\], with two changes. In curved space a cone widens as narrow beams do, which [`Beams`] knows. And the n-th
//! sample of a pixel stands for an nth of its beam, as the first n of a sequence share the pixel among them: what few
//! samples would miss is filtered, many filter by themselves, and pictures converge to what they are without.

use glam::DVec3;

use super::transport::{Landing, Transport};
use crate::geometry::SupportingSurface;
use crate::light::{BeamRay, Beams};
use crate::scene::{Baked, PixelWidth};
use crate::shade::{Bounce, Footprint};
use crate::spacetime::Side;

/// Cone of a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayCone {
    /// World start of the ray.
    position: DVec3,
    /// Unit direction there.
    direction: DVec3,
    /// Side of a wormhole on which it starts.
    side: Side,
    /// Width at the start, scene units.
    width: f64,
    /// Angle by which it widens, radians; below 0 if it narrows.
    spread: f64,
    /// Width of what its sample stands for, in that of the sample's pixel.
    part: f64,
    /// True if nothing but mirrors and glass is between the camera and the ray.
    is_seen: bool,
}

/// What widens ray cones in a scene.
pub struct RayCones {
    pixel: PixelWidth,
    beams: Option<Box<dyn Beams>>,
}

/// Width of a scattered cone, in that of all directions which a sample stands for: wider ones blur over the seams of
/// textures.
const SCATTERED: f64 = 0.25;

impl RayCones {
    /// Those of a scene; `None` if no texture can be filtered.
    pub fn of<T: Transport>(scene: &Baked, transport: &T) -> Option<Self> {
        let can_be_filtered = scene.textures.iter().any(|texture| texture.image.levels() > 1);
        can_be_filtered.then(|| Self { pixel: scene.pixel(), beams: transport.beams() })
    }

    /// Cone of a camera ray of a sample.
    pub fn of_camera(&self, scene: &Baked, sample: u32, (position, direction): (DVec3, DVec3)) -> RayCone {
        let camera = &scene.camera;
        let PixelWidth { constant, angle } = self.pixel;
        let spread = angle * camera.projection.relative_angle(direction.dot(camera.forward));
        let (part, near) = (part_of(sample), position.distance(camera.position));
        RayCone {
            position,
            direction,
            side: camera.side,
            width: part * (constant + spread * near),
            spread: part * spread,
            part,
            is_seen: true,
        }
    }

    /// Width of a cone across its ray where that lands: the larger, if it is elliptic.
    pub fn width(&self, cone: &RayCone, landing: &Landing) -> f64 {
        let beams = self.beams.as_deref();
        cone.width_at(landing, beams.and_then(|beams| beams.widths(&cone.beam_to(landing))))
    }

    /// [`Self::width`] of many cones, in the place of `widths`, if rays are bent; else none: one by one is as fast.
    pub fn bent_widths<'a>(
        &self,
        mut landed: impl Iterator<Item = (&'a RayCone, &'a Landing)> + Clone,
        widths: &mut Vec<f64>,
    ) {
        widths.clear();
        let Some(beams) = &self.beams else { return };
        let rays: Vec<BeamRay> = landed.clone().map(|(cone, landing)| cone.beam_to(landing)).collect();
        beams.all_widths(&rays, &mut |_, bent| {
            widths.extend(landed.next().map(|(cone, landing)| cone.width_at(landing, bent)));
        });
    }

    /// Cone of a ray after a bounce where its cone is so wide, off a surface or through it to where the index of refraction
    /// is `eta` times as large.
    pub fn after(
        &self,
        cone: &RayCone,
        (landing, width): (&Landing, f64),
        (bounce, eta): (&Bounce, f64),
        scene: &Baked,
    ) -> RayCone {
        let is_specular = bounce.density == 0.0;
        let spread = if is_specular {
            let tilt = width * curvature(scene, landing);
            if bounce.crosses { (cone.spread + tilt) / eta - tilt } else { cone.spread + 2.0 * tilt }
        } else {
            let scattered = SCATTERED * cone.part;
            (cone.spread * cone.spread + scattered * scattered / bounce.density).sqrt()
        };
        RayCone {
            position: landing.position,
            direction: bounce.direction,
            side: landing.primitive.side(),
            width,
            spread,
            part: cone.part,
            is_seen: cone.is_seen && is_specular,
        }
    }
}

impl RayCone {
    /// The ray in its middle, from its start to where that lands.
    fn beam_to(&self, landing: &Landing) -> BeamRay {
        BeamRay {
            from: (self.side, self.position),
            leaving: self.direction,
            to: (landing.primitive.side(), landing.position),
            arriving: landing.direction,
        }
    }

    /// Width where its ray lands, given those of a beam of one radian if rays are bent.
    fn width_at(&self, landing: &Landing, bent: Option<[f64; 2]>) -> f64 {
        let bent = bent.map(|[along, across]| along.max(across)).filter(|width| width.is_finite());
        let is_near = landing.primitive.side() == self.side;
        let straight = || is_near.then(|| self.position.distance(landing.position));
        let straight = || straight().filter(|length| *length > 0.0);
        (self.width + bent.or_else(straight).unwrap_or(0.0) * self.spread).abs()
    }

    /// Footprint on a surface that a cone of a width meets, at an angle of cosine `cos` to its normal.
    pub fn footprint(&self, width: f64, cos: f64) -> Footprint {
        let scattering = width / cos.abs();
        Footprint { scattering, emission: if self.is_seen { scattering } else { 0.0 } }
    }
}

/// Width of what a sample stands for, in that of its pixel.
fn part_of(sample: u32) -> f64 {
    1.0 / (f64::from(sample) + 1.0).sqrt()
}

/// Curvature of a sphere where a ray lands, above 0 if it bulges towards the ray; triangles count as flat.
fn curvature(scene: &Baked, landing: &Landing) -> f64 {
    let SupportingSurface { anchor, radius, .. } = scene.geometry.support(landing.primitive);
    let bulge = if landing.direction.dot(landing.position - anchor) < 0.0 { 1.0 } else { -1.0 };
    if radius > 0.0 { bulge / radius } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DVec2, Vec3, swizzles::Vec3Swizzles};
    use rand::rngs::Xoshiro256PlusPlus;
    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::geometry::{Attributes, Geometry, Instance, Mesh, PrimitiveId, Primitives, Sphere, Surface};
    use crate::light::Lensed;
    use crate::scene::{Camera, Settings};
    use crate::shade::{MipImage, Raster, Texture, UvTransform, Wrap};
    use crate::spacetime::{ConformallyFlat, Schwarzschild, SpacetimeKind};
    use crate::trace::transport::Outcome;
    use crate::trace::{Ray, Shot, shoot};

    /// Schwarzschild radius.
    const RADIUS: f64 = 1.0;
    const SURFACE: Surface = Surface { material: 0, entity: 0 };

    /// Landings of rays that leave free space.
    fn land(scene: &Baked, rays: &[(DVec3, DVec3)]) -> Vec<Option<Landing>> {
        let ray = |&(position, direction)| Ray { position, direction, origin_prim: PrimitiveId::NONE };
        let rays: Vec<Ray> = rays.iter().map(ray).collect();
        let landing = |shot: &Shot| match shot.end {
            Outcome::Landed(landing) => Some(landing),
            _ => None,
        };
        shoot(scene, &rays).iter().map(landing).collect()
    }

    #[test]
    fn in_flat_space_a_footprint_is_distance_times_angle_over_cosine() {
        let scene = Baked::default();
        let cones = RayCones { pixel: scene.pixel(), beams: None };
        let angle = 1.0 / scene.settings.height as f64;
        let footprint = |film: DVec2, sample: u32, distance: &dyn Fn(f64) -> f64, normal: DVec3| {
            let ray = scene.camera.ray(film, 1.0, DVec2::splat(0.5)).unwrap();
            let (position, direction) = ray;
            let cone = cones.of_camera(&scene, sample, ray);
            let at = position + distance(-direction.z) * direction;
            let width = cones.width(&cone, &Landing::conformal(at, direction, PrimitiveId::NONE));
            cone.footprint(width, direction.dot(normal)).scattering
        };
        let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-14, "{found}");
        for (distance, cos) in [(0.1, 1.0), (7.0, 0.3), (1e5, 0.01)] {
            let normal = DVec3::new(0.0, (1.0f64 - cos * cos).sqrt(), cos);
            let middle = |sample| footprint(DVec2::splat(0.5), sample, &|_| distance, normal);
            close(middle(0), distance * angle / cos);
            close(middle(3), 0.5 * distance * angle / cos);
            // A plane across the view is as finely seen everywhere.
            for film in [DVec2::ZERO, DVec2::new(0.9, 0.2)] {
                close(footprint(film, 0, &|cos| distance / cos, DVec3::Z), distance * angle);
            }
        }
    }

    #[test]
    fn spheres_reflect_and_refract_cones_as_neighbouring_rays() {
        const SPREAD: f64 = 1e-4;
        let ball = Sphere { center: DVec3::new(0.0, 0.0, 1.0), radius: 2.0 };
        let geometry =
            Geometry::build(Primitives { spheres: vec![(ball, SURFACE)], ..Primitives::default() });
        let scene = Baked { geometry, ..Baked::default() };
        let cones = RayCones { pixel: scene.pixel(), beams: None };
        // From outside, and from inside on both sides of its centre.
        for (eye, crosses) in [8.0, 1.5, 0.2].into_iter().flat_map(|eye| [(eye, false), (eye, true)]) {
            let position = eye * DVec3::Z;
            let eta = if eye > 3.0 { 1.5 } else { 1.0 / 1.5 };
            let onward = |angle: f64| {
                let direction = DVec3::new(angle.sin(), 0.0, -angle.cos());
                let landing = land(&scene, &[(position, direction)])[0].unwrap();
                let normal = (landing.position - ball.center).normalize();
                let normal = -normal.dot(direction).signum() * normal;
                let next =
                    if crosses { direction.refract(normal, 1.0 / eta) } else { direction.reflect(normal) };
                (landing, next)
            };
            let (landing, direction) = onward(0.0);
            let cone = RayCone { position, direction: -DVec3::Z, spread: SPREAD, ..RayCone::default() };
            let bounce = Bounce { direction, weight: Vec3::ONE, density: 0.0, crosses };
            let width = cones.width(&cone, &landing);
            let after = cones.after(&cone, (&landing, width), (&bounce, eta), &scene);
            for way in [0.5, 5.0] {
                let end =
                    Landing::conformal(landing.position + way * direction, direction, PrimitiveId::NONE);
                let across = [-0.5, 0.5].map(|share| {
                    let (start, next) = onward(share * SPREAD);
                    start.position.x + next.x / next.z * (end.position.z - start.position.z)
                });
                let (found, apart) = (cones.width(&after, &end), (across[1] - across[0]).abs());
                assert!(
                    (found - apart).abs() < 1e-3 * (apart + width),
                    "{eye} {crosses}: {found} for {apart}"
                );
            }
        }
    }

    /// A room around a hole, whose walls are checkers.
    fn checkered_room() -> Baked {
        const HALF: f64 = 24.0;
        const TEXELS: usize = 64;
        let mut mesh = Mesh::default();
        let mut uvs = Vec::new();
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let (right, up) = (axis.yzx(), axis.zxy());
            for side in [-1.0, 1.0] {
                let first = mesh.positions.len() as u32;
                for (u, v) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                    let place = side * axis + (2.0 * u - 1.0) * right + (2.0 * v - 1.0) * up;
                    mesh.positions.push((HALF * place).as_vec3().to_array());
                    uvs.push([u as f32, v as f32]);
                }
                mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|corners| corners.map(|at| first + at)));
            }
        }
        mesh.attributes = Attributes { uvs: vec![uvs], ..Attributes::default() };
        let texels = (0..TEXELS * TEXELS).map(|at| [((at + at / TEXELS) % 2 * 65535) as u16; 4]);
        let image = Arc::new(MipImage::new(TEXELS, TEXELS, Raster::Linear(texels.collect())));
        let transform = UvTransform::IDENTITY;
        let instance = Instance { mesh: 0, to_world: DAffine3::IDENTITY };
        Baked {
            spacetime: SpacetimeKind::black_hole(DVec3::ZERO, RADIUS),
            camera: Camera::new(20.0 * DVec3::Z, DVec3::NEG_Z, DVec3::Y, 0.5, 0.0).unwrap(),
            geometry: Geometry::build(Primitives {
                meshes: vec![mesh],
                instances: vec![(instance, SURFACE)],
                ..Primitives::default()
            }),
            textures: vec![Texture {
                image,
                uv_set: 0,
                transform,
                wrap: [Wrap::Repeat; 2],
                is_nearest: false,
            }],
            settings: Settings { width: 48, height: 48, ..Settings::default() },
            ..Baked::default()
        }
    }

    #[test]
    fn beside_the_photon_ring_single_samples_do_not_shimmer() {
        const SAMPLES: usize = 16;
        let hole = Schwarzschild::new(RADIUS);
        let scene = checkered_room();
        let size = scene.settings.width;
        let lensed: Box<dyn Beams> = Box::new(Lensed::new(hole, DVec3::ZERO, 0).unwrap());
        let by_distance = RayCones { pixel: scene.pixel(), beams: None };
        let by_beams = RayCones { pixel: scene.pixel(), beams: Some(lensed) };
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let critical = hole.critical_impact_parameter();
        let index = hole.index(1.0 / scene.camera.position.length());
        // Of the mean of a pixel, from points without filters: squared errors of one sample, by beams and by distance.
        let (mut errors, mut count) = ([0.0; 2], 0);
        for pixel in 0..size * size {
            let corner = DVec2::new((pixel % size) as f64, (pixel / size) as f64);
            let ray = |x: f64, y: f64| {
                let film = (corner + DVec2::new(x, y)) / size as f64;
                scene.camera.ray(film, 1.0, DVec2::splat(0.5)).unwrap()
            };
            let (position, direction) = ray(0.5, 0.5);
            let b = index * position.cross(direction).length() / critical;
            if !(1.0..1.12).contains(&b) {
                continue;
            }
            let rays = [(); SAMPLES].map(|()| ray(random.random::<f64>(), random.random::<f64>()));
            let looks = rays.iter().zip(land(&scene, &rays)).filter_map(|(ray, landing)| {
                let landing = landing?;
                let point = scene.geometry.mesh_point(landing.primitive, landing.position)?;
                let normal = scene.geometry.surface_point(landing.primitive, landing.position).normal;
                let seen = |cones: &RayCones| {
                    let cone = cones.of_camera(&scene, 0, *ray);
                    let width = cones.width(&cone, &landing);
                    let Footprint { scattering, .. } = cone.footprint(width, landing.direction.dot(normal));
                    f64::from(scene.textures[0].at(&point, scattering).x)
                };
                Some([seen(&by_beams), seen(&by_distance), f64::from(scene.textures[0].at(&point, 0.0).x)])
            });
            let looks: Vec<[f64; 3]> = looks.collect();
            if looks.len() < SAMPLES {
                continue;
            }
            let mean = looks.iter().map(|look| look[2]).sum::<f64>() / SAMPLES as f64;
            for (error, which) in errors.iter_mut().zip(0..) {
                *error += looks.iter().map(|look| (look[which] - mean).powi(2)).sum::<f64>() / SAMPLES as f64;
            }
            count += 1;
        }
        let [beams, distance] = errors.map(|error| error / f64::from(count));
        assert!(
            count > 50 && beams < 0.1 * distance,
            "{count} pixels: {beams} by beams, {distance} by distance"
        );
    }
}
