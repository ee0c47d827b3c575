//! A fan of rays in a plane through the hole, and its picture.

use std::f64::consts::PI;
use std::io::{self, Write};

use glam::{DVec2, DVec3};

use super::field_outlines::{FieldOutline, field_outlines};
use super::spinning_sections::SpinningHole;
use super::table::{Table, TableRow};
use crate::geodesic::{Control, Launch, Phase, Rkn6, Step, follow};
use crate::geometry::{CrossSection, Plane, PrimitiveId};
use crate::plot::{Axis, Color, DataSeries, Diagram, Figure, Style};
use crate::scene::Baked;
use crate::spacetime::{ConformallyFlat, Metric, Side, SpacetimeKind};
use crate::trace::{Polyline, Ray, RayEnd, polylines, transport::Outcome};

/// Rays of a fan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FanOptions {
    /// Number of rays, at least 1.
    pub count: u32,
    /// Angle between the first ray and the last, radians; `None`: the camera's horizontal field of view.
    pub angle: Option<f64>,
    /// World point from which the fan opens towards the hole; `None`: the camera's position and view direction.
    pub from: Option<DVec3>,
    /// World direction to which the fan's plane is perpendicular, as far as the hole in the plane allows; `None`: the
    /// plane also holds the view direction, or lies level in the image.
    pub up: Option<DVec3>,
}

/// Error: there is no such fan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FanError {
    /// Rays cannot start there.
    #[error("the fan starts inside the horizon")]
    InsideHorizon,
    /// Nothing is at rest there, nor the directions of the fan.
    #[error("the fan starts in the ergosphere, where nothing is at rest")]
    InErgosphere,
    /// No plane is perpendicular to that.
    #[error("the direction that is up from the plane points along the plane")]
    UpAlongPlane,
    /// Rays start at the camera's near plane.
    #[error("the fan reaches behind the camera's near plane, where its rays start")]
    BehindNearPlane,
}

/// A fan of rays, traced.
pub struct Fan {
    polylines: Vec<Polyline>,
    hole: Option<(DVec3, Metric)>,
    spinning: Option<SpinningHole>,
    /// What bends rays in a field of refraction.
    outlines: Vec<FieldOutline>,
    /// Side of a wormhole that is drawn: the camera's.
    side: Side,
    /// Centre and radius of a wormhole's throat on that side.
    throat: Option<(DVec3, f64)>,
    cuts: Vec<CrossSection>,
    view: FanPlane,
}

/// The plane of the fan as the picture shows it.
#[derive(Clone, Copy, Debug)]
struct FanPlane {
    origin: DVec3,
    right: DVec3,
    up: DVec3,
}

/// A box in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FanBounds {
    min: DVec2,
    max: DVec2,
}

/// Sine of an angle below which directions count as parallel.
const PARALLEL: f64 = 1e-6;
/// Around the hole, a frame shows this many photon spheres' radii at least.
const AROUND_HOLE: f64 = 5.0;
/// … and this part of the distance between the hole and the start of the fan.
const BESIDE_HOLE: f64 = 0.4;
/// Around each thing that bends rays in a field, a frame shows this many of its radii at least.
const BESIDE_OUTLINE: f64 = 2.0;
/// Room around what must be seen, relative to its larger side.
const ROOM: f64 = 0.05;
/// Smaller side of a frame, relative to the larger one, at least.
const SLIMMEST: f64 = 0.45;
/// Largest width and height of the diagram, points.
const DIAGRAM: [f64; 2] = [880.0, 620.0];
/// Corners of the polygon that stands for a circle.
const CORNERS: u32 = 256;
/// Angle by which a ray turns from one piece of its way out of the picture to the next, about, radians.
const CORNER: f64 = 0.005;
/// Error of that way, radians.
const PRECISION: f64 = 1e-7;

impl Fan {
    /// Traces the fan.
    ///
    /// # Errors
    /// If no rays can start so.
    pub fn trace(scene: &Baked, options: &FanOptions) -> Result<Self, FanError> {
        let camera = &scene.camera;
        let hole = scene.spacetime.medium();
        let start = options.from.unwrap_or(camera.position);
        if hole.is_some_and(|(center, medium)| center.distance(start) <= medium.horizon()) {
            return Err(FanError::InsideHorizon);
        }
        let spinning = match scene.spacetime {
            SpacetimeKind::Spinning { placement, hole } => Some(SpinningHole { placement, hole }),
            SpacetimeKind::Flat
            | SpacetimeKind::Spherical { .. }
            | SpacetimeKind::Wormhole { .. }
            | SpacetimeKind::Indexed(_) => None,
        };
        let outlines = match &scene.spacetime {
            SpacetimeKind::Indexed(medium) => field_outlines(medium),
            SpacetimeKind::Flat
            | SpacetimeKind::Spherical { .. }
            | SpacetimeKind::Wormhole { .. }
            | SpacetimeKind::Spinning { .. } => Vec::new(),
        };
        if spinning.is_some() && scene.spacetime.drags(start) {
            return Err(FanError::InErgosphere);
        }
        let throat = scene.spacetime.wormhole();
        let throat = throat.map(|(mouths, metric)| (mouths.center(camera.side), metric.throat()));
        let center = throat.map(|(center, _)| center).or(scene.spacetime.center());
        let in_plane = center.map(|center| center - start).unwrap_or(camera.forward).normalize();
        let middle = if options.from.is_some() { in_plane } else { camera.forward };
        let normal = normal(options.up, in_plane, middle, camera.up).ok_or(FanError::UpAlongPlane)?;
        let right = middle.reject_from_normalized(normal).try_normalize().unwrap_or(in_plane);
        let view = FanPlane { origin: center.unwrap_or(start), right, up: normal.cross(right) };

        let half_width = camera.tan_half_fov * scene.settings.width as f64 / scene.settings.height as f64;
        let angle = options.angle.unwrap_or(2.0 * libm::atan(half_width));
        let near = if options.from.is_some() { 0.0 } else { camera.near };
        let rays: Option<Vec<Ray>> = directions(angle, options.count)
            .map(|direction| {
                let direction = direction.x * view.right + direction.y * view.up;
                let forward = direction.dot(camera.forward);
                let clear = near == 0.0 || forward > PARALLEL;
                let position = if near > 0.0 { start + near / forward * direction } else { start };
                let origin_prim = PrimitiveId::none_on(camera.side);
                clear.then_some(Ray { position, direction, origin_prim })
            })
            .collect();
        let rays = rays.ok_or(FanError::BehindNearPlane)?;
        let plane = Plane { point: view.origin, normal };
        let cuts =
            scene.geometry.of(camera.side).map_or_else(Vec::new, |around| around.cross_section(&plane));
        let (polylines, side) = (polylines(scene, &rays), camera.side);
        Ok(Self { polylines, hole, spinning, outlines, side, throat, cuts, view })
    }

    /// Number of rays of each fate that occurs, by name.
    pub fn fates(&self) -> Vec<(&'static str, usize)> {
        let count =
            |fate: RayEnd| self.polylines.iter().filter(|polyline| RayEnd::of(&polyline.end) == fate).count();
        let counts = RayEnd::ALL.map(|fate| (fate.name(), count(fate)));
        counts.into_iter().filter(|(_, count)| *count > 0).collect()
    }

    /// Writes the rays as rows of ray, point, world position and fate.
    ///
    /// # Errors
    /// Errors of `out`.
    pub fn write_csv(&self, out: impl Write) -> io::Result<()> {
        let reach = self.frame().reach();
        let mut rows = Vec::new();
        for (ray, polyline) in self.polylines.iter().enumerate() {
            let fate = RayEnd::of(&polyline.end).name();
            for (point, DVec3 { x, y, z }) in self.drawn(polyline, reach).into_iter().enumerate() {
                let row = TableRow::default().cell("ray", ray).cell("point", point);
                rows.push(row.cell("x", x).cell("y", y).cell("z", z).cell("fate", fate));
            }
        }
        Table::of(rows).write_csv(out)
    }

    /// The points of a polyline, and for an escaped one its way on until it is `reach` away from the hole: out of the
    /// picture.
    fn drawn(&self, polyline: &Polyline, reach: f64) -> Vec<DVec3> {
        let mut points = polyline.points.clone();
        if let (Outcome::Escaped(there), Some(&last)) = (polyline.end, points.last()) {
            match (&self.hole, &self.spinning) {
                (Some((center, medium)), _) => {
                    let way_out = way_out(medium, last - center, polyline.heading, reach);
                    points.extend(way_out.into_iter().map(|point| center + point));
                }
                (None, Some(spinning)) => points.extend(spinning.way_out(last, polyline.heading, reach)),
                (None, None) if there.side != self.side => {}
                (None, None) => points.push(last + reach * there.direction),
            }
        }
        points
    }

    /// The picture.
    pub fn figure(&self, title: &str) -> Figure {
        let frame = self.frame();
        let mut series = vec![DataSeries {
            name: if self.cuts.is_empty() { String::new() } else { "geometry".to_owned() },
            style: Style::line(Color::GREY, 3.0),
            curves: self.cuts.iter().filter_map(|cut| self.view.outline(cut, &frame)).collect(),
        }];
        for fate in RayEnd::ALL {
            let rays: Vec<&Polyline> =
                self.polylines.iter().filter(|polyline| RayEnd::of(&polyline.end) == fate).collect();
            if rays.is_empty() {
                continue;
            }
            let curve = |polyline: &&Polyline| {
                self.drawn(polyline, frame.reach()).iter().map(|&p| self.view.place(p)).collect()
            };
            series.push(DataSeries {
                name: format!("{} ({})", fate.name(), rays.len()),
                style: Style::line(color(fate), 1.6),
                curves: rays.iter().map(curve).collect(),
            });
        }
        if let Some((_, medium)) = self.hole {
            let circle = |radius: f64| vec![circle(DVec2::ZERO, radius, 0.0, PI)];
            series.push(DataSeries {
                name: "photon sphere".to_owned(),
                style: Style::dashed(Color::BLACK, 1.6),
                curves: circle(medium.photon_sphere()),
            });
            series.push(DataSeries {
                name: "horizon".to_owned(),
                style: Style::area(Color::BLACK),
                curves: circle(medium.horizon()),
            });
        }
        if let Some(spinning) = self.spinning {
            let axes = [self.view.right, self.view.up];
            let mut add = |name: &str, style: Style, curves: Vec<Vec<[f64; 2]>>| {
                series.push(DataSeries { name: name.to_owned(), style, curves });
            };
            add("photon orbits", Style::dashed(Color::BLACK, 1.6), spinning.photon_orbits(axes));
            add("ergosphere", Style::line(Color::GREY, 1.6), vec![spinning.ergosphere(axes)]);
            add("horizon", Style::area(Color::BLACK), vec![spinning.horizon(axes)]);
        }
        for alike in self.outlines.chunk_by(|a, b| a.name == b.name) {
            let curve = |outline: &FieldOutline| {
                circle(self.view.place(outline.center).into(), outline.radius, 0.0, PI)
            };
            series.push(DataSeries {
                name: alike[0].name.to_owned(),
                style: alike[0].style,
                curves: alike.iter().map(curve).collect(),
            });
        }
        if let Some((_, radius)) = self.throat {
            series.push(DataSeries {
                name: "throat".to_owned(),
                style: Style::area(Color::BLACK),
                curves: vec![circle(DVec2::ZERO, radius, 0.0, PI)],
            });
        }
        let has_hole = self.hole.is_some() || self.spinning.is_some();
        let origin = match self.throat {
            _ if has_hole => "the hole",
            Some(_) => "the throat",
            None if !self.outlines.is_empty() => "the middle",
            None => "the start",
        };
        let FanBounds { min, max } = frame;
        let side = max - min;
        let scale = (DIAGRAM[0] / side.x).min(DIAGRAM[1] / side.y);
        Figure {
            diagrams: vec![Diagram {
                title: title.to_owned(),
                x: Axis::linear(format!("from {origin} along the view (scene units)"), [min.x, max.x]),
                y: Axis::linear("across (scene units)", [min.y, max.y]),
                size: [scale * side.x, scale * side.y],
                series,
            }],
        }
    }

    /// Frame of the picture, around the ends of rays and the hole; or the geometry; or a piece of a straight ray.
    fn frame(&self) -> FanBounds {
        let mut frame = FanBounds::NOTHING;
        for polyline in &self.polylines {
            let seen = if matches!(polyline.end, Outcome::Landed(_)) { polyline.points.len() } else { 1 };
            polyline.points[..seen].iter().for_each(|&point| frame.hold(self.view.place(point).into(), 0.0));
        }
        let body = self.hole.map(|(_, medium)| medium.photon_sphere());
        let body = body.or(self.spinning.map(|spinning| spinning.hole.outermost_photon_orbit()));
        if let (Some(radius), Some(polyline)) =
            (body.or(self.throat.map(|(_, radius)| radius)), self.polylines.first())
        {
            let distance = DVec2::from(self.view.place(polyline.points[0])).length();
            frame.hold(DVec2::ZERO, (AROUND_HOLE * radius).max(BESIDE_HOLE * distance));
        }
        for outline in &self.outlines {
            frame.hold(self.view.place(outline.center).into(), BESIDE_OUTLINE * outline.radius);
        }
        if frame.reach() == 0.0 {
            for cut in &self.cuts {
                match *cut {
                    CrossSection::Line(ends) => {
                        ends.into_iter().for_each(|end| frame.hold(self.view.place(end).into(), 0.0))
                    }
                    CrossSection::Circle { center, radius } => {
                        frame.hold(self.view.place(center).into(), radius)
                    }
                }
            }
        }
        if frame.reach() == 0.0 {
            frame.hold(frame.min + DVec2::X, 0.0);
        }
        frame.roomy()
    }
}

/// The unit normal of the plane that holds `in_plane` and, without `up`, `middle`.
fn normal(up: Option<DVec3>, in_plane: DVec3, middle: DVec3, camera_up: DVec3) -> Option<DVec3> {
    let beside = |up: DVec3| {
        let across = up.normalize_or_zero().reject_from_normalized(in_plane);
        (across.length() > PARALLEL).then(|| across.normalize())
    };
    if up.is_some() {
        return up.and_then(beside);
    }
    let tilted = middle.cross(in_plane);
    let normal = if tilted.length() > PARALLEL { tilted.normalize() } else { beside(camera_up)? };
    // Up in the image is up in the picture.
    Some(if normal.cross(in_plane).dot(camera_up) < -PARALLEL { -normal } else { normal })
}

/// The unit vector at an angle from +X, radians.
fn unit(angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(cos, sin)
}

/// Unit directions evenly over `angle` around +X.
fn directions(angle: f64, count: u32) -> impl Iterator<Item = DVec2> {
    (0..count).map(move |index| {
        let s = if count > 1 { f64::from(index) / f64::from(count - 1) - 0.5 } else { 0.0 };
        unit(s * angle)
    })
}

/// Points of the ray that leaves `start` outwards in the unit direction `heading`, up to the radius `reach`; relative
/// to the hole.
fn way_out(medium: &Metric, start: DVec3, heading: DVec3, reach: f64) -> Vec<DVec3> {
    let launch = Launch::new(medium, start, heading, f64::EPSILON);
    let ray = (launch.b, Phase::new(medium, launch.w, launch.v), launch.fate);
    let control = Control::new(medium, PRECISION, f64::INFINITY);
    // From the radius to the ray.
    let slant = |phase: &Phase<f64>| libm::atan2(launch.b * phase.w, -phase.v);
    let (mut points, mut swept) = (Vec::new(), 0.0);
    follow(medium, &Rkn6, &control, ray, 1.0 / reach, |step| {
        let angle = |h: f64| libm::atan(step.b * h);
        let turn = angle(step.h) + slant(&step.end) - slant(&step.start);
        let pieces = (turn.abs() / CORNER).ceil().max(1.0);
        points.extend((1..=pieces as u32).map(|piece| {
            let h = step.h * f64::from(piece) / pieces;
            let part = Step::new(medium, &Rkn6, step.b, step.start, h);
            launch.position(part.end.w, swept + angle(h))
        }));
        swept += angle(step.h);
    });
    points
}

/// A circle between two angles either side of `middle`, as a polygon.
fn circle(center: DVec2, radius: f64, middle: f64, half: f64) -> Vec<[f64; 2]> {
    let angle = |i: u32| middle + half * (2.0 * f64::from(i) / f64::from(CORNERS) - 1.0);
    (0..=CORNERS).map(|i| (center + radius * unit(angle(i))).into()).collect()
}

impl FanPlane {
    fn place(&self, point: DVec3) -> [f64; 2] {
        let from = point - self.origin;
        [from.dot(self.right), from.dot(self.up)]
    }

    /// The part of a cut that the frame may show.
    fn outline(&self, cut: &CrossSection, frame: &FanBounds) -> Option<Vec<[f64; 2]>> {
        match *cut {
            CrossSection::Line(ends) => {
                let [a, b] = ends.map(|end| self.place(end));
                let (low, high) = (DVec2::from(a).min(b.into()), DVec2::from(a).max(b.into()));
                let seen = low.cmple(frame.max).all() && high.cmpge(frame.min).all();
                seen.then(|| vec![a, b])
            }
            CrossSection::Circle { center, radius } => {
                // The circle meets the disc around the frame within this angle: walls may be huge spheres.
                let center = DVec2::from(self.place(center));
                let to_frame = 0.5 * (frame.min + frame.max) - center;
                let (distance, reach) = (to_frame.length(), 0.5 * frame.reach());
                let cosine =
                    (distance * distance + radius * radius - reach * reach) / (2.0 * distance * radius);
                let half = if cosine.is_nan() { PI } else { libm::acos(cosine.clamp(-1.0, 1.0)) };
                (half > 0.0).then(|| circle(center, radius, libm::atan2(to_frame.y, to_frame.x), half))
            }
        }
    }
}

impl FanBounds {
    const NOTHING: Self = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };

    /// Takes in a disc.
    fn hold(&mut self, center: DVec2, radius: f64) {
        self.min = self.min.min(center - radius);
        self.max = self.max.max(center + radius);
    }

    /// Its diagonal.
    fn reach(&self) -> f64 {
        self.min.distance(self.max)
    }

    /// Widened to have a margin and not be slim.
    fn roomy(self) -> Self {
        let middle = 0.5 * (self.min + self.max);
        let half = 0.5 * (self.max - self.min);
        let longer = half.max_element();
        let half = (half + ROOM * longer).max(DVec2::splat(SLIMMEST * longer));
        Self { min: middle - half, max: middle + half }
    }
}

/// The colour of rays that end so.
fn color(fate: RayEnd) -> Color {
    match fate {
        RayEnd::Hit => Color::BLUE,
        RayEnd::Escaped => Color::GREEN,
        RayEnd::Captured => Color::VERMILION,
        RayEnd::StepLimit | RayEnd::NonFinite => Color::PURPLE,
    }
}
