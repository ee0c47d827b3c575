//! A fan of rays in a plane through the hole, and its picture.

use std::f64::consts::PI;
use std::io::{self, Write};

use glam::{DVec2, DVec3};

use super::fan_frame::{FanBounds, FanPlane, circle, unit};
use super::field_outlines::{FieldOutline, field_outlines};
use super::spinning_sections::SpinningHole;
use super::table::{Table, TableRow};
use crate::geodesic::{Control, Launch, Phase, Rkn6, Step, follow};
use crate::geometry::{CrossSection, Plane, PrimitiveId};
use crate::plot::{Axis, Color, DataSeries, Diagram, Figure, Style};
use crate::scene::Baked;
use crate::spacetime::{ConformallyFlat, Metric, Mouths, Side, SpacetimeKind, Wormhole};
use crate::trace::{Polyline, PolylinePiece, Ray, RayEnd, polylines, transport::Outcome};

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
    /// Parallel rays span no angle.
    #[error("the rays of an orthographic camera are parallel, so they span no angle")]
    NoFieldOfView,
}

/// A fan of rays, traced.
pub struct Fan {
    polylines: Vec<Polyline>,
    hole: Option<(DVec3, Metric)>,
    spinning: Option<SpinningHole>,
    wormhole: Option<(Mouths, Wormhole)>,
    /// What bends rays in a field of refraction.
    outlines: Vec<FieldOutline>,
    /// The camera's side of a wormhole, and the other.
    views: Vec<FanView>,
}

/// What a fan meets on one side of a wormhole.
struct FanView {
    side: Side,
    plane: FanPlane,
    cuts: Vec<CrossSection>,
}

/// Sine of an angle below which directions count as parallel.
const PARALLEL: f64 = 1e-6;
/// Around the hole, a frame shows this many photon spheres' radii at least.
const AROUND_HOLE: f64 = 5.0;
/// … and this part of the distance between the hole and the start of the fan.
const BESIDE_HOLE: f64 = 0.4;
/// Around each thing that bends rays in a field, a frame shows this many of its radii at least.
const BESIDE_OUTLINE: f64 = 2.0;
/// Largest width and height of the diagram, points.
const DIAGRAM: [f64; 2] = [880.0, 620.0];
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
        let wormhole = scene.spacetime.wormhole();
        let center = wormhole.map(|(mouths, _)| mouths.center(camera.side)).or(scene.spacetime.center());
        let in_plane = center.map(|center| center - start).unwrap_or(camera.forward).normalize();
        let middle = if options.from.is_some() { in_plane } else { camera.forward };
        let normal = normal(options.up, in_plane, middle, camera.up).ok_or(FanError::UpAlongPlane)?;
        let right = middle.reject_from_normalized(normal).try_normalize().unwrap_or(in_plane);
        let up = normal.cross(right);
        let across = || camera.projection.horizontal_fov(scene.settings.aspect());
        let angle = options.angle.or_else(across).ok_or(FanError::NoFieldOfView)?;
        let rays: Option<Vec<Ray>> = directions(angle, options.count)
            .map(|direction| {
                let direction = direction.x * right + direction.y * up;
                let position = options.from.or_else(|| camera.start(direction))?;
                Some(Ray { position, direction, origin_prim: PrimitiveId::none_on(camera.side) })
            })
            .collect();
        let rays = rays.ok_or(FanError::BehindNearPlane)?;
        let view = |side: Side, origin: DVec3, [right, up]: [DVec3; 2]| {
            let plane = Plane { point: origin, normal: right.cross(up) };
            let cuts = scene.geometry.of(side).map_or_else(Vec::new, |around| around.cross_section(&plane));
            FanView { side, plane: FanPlane { origin, right, up }, cuts }
        };
        let mut views = vec![view(camera.side, center.unwrap_or(start), [right, up])];
        if let Some((mouths, _)) = wormhole {
            let other = camera.side.other();
            let axes = [right, up].map(|axis| mouths.turned(camera.side, axis));
            views.push(view(other, mouths.center(other), axes));
        }
        Ok(Self { polylines: polylines(scene, &rays), hole, spinning, wormhole, outlines, views })
    }

    /// Number of rays of each fate that occurs, by name.
    pub fn fates(&self) -> Vec<(&'static str, usize)> {
        let count =
            |fate: RayEnd| self.polylines.iter().filter(|polyline| RayEnd::of(&polyline.end) == fate).count();
        let counts = RayEnd::ALL.map(|fate| (fate.name(), count(fate)));
        counts.into_iter().filter(|(_, count)| *count > 0).collect()
    }

    /// Writes the rays as rows of ray, point, world position and fate; with the side if there are two.
    ///
    /// # Errors
    /// Errors of `out`.
    pub fn write_csv(&self, out: impl Write) -> io::Result<()> {
        let reaches = self.views.iter().map(|view| self.frame(view).reach());
        let reach = reaches.fold(0.0, f64::max);
        let mut rows = Vec::new();
        for (ray, polyline) in self.polylines.iter().enumerate() {
            let fate = RayEnd::of(&polyline.end).name();
            let points = polyline.pieces.iter().flat_map(|piece| {
                let points = self.drawn(polyline, piece, reach);
                points.into_iter().map(|point| (piece.side, point))
            });
            for (point, (side, DVec3 { x, y, z })) in points.enumerate() {
                let row = TableRow::default().cell("ray", ray).cell("point", point);
                let row = row.cell("x", x).cell("y", y).cell("z", z).cell("fate", fate);
                rows.push(if self.wormhole.is_some() { row.cell("side", side.name()) } else { row });
            }
        }
        Table::of(rows).write_csv(out)
    }

    /// The points of a piece of a polyline, and if the ray escapes from its end, the way on until that is `reach` away from
    /// the hole: out of the picture.
    fn drawn(&self, polyline: &Polyline, piece: &PolylinePiece, reach: f64) -> Vec<DVec3> {
        let mut points = piece.points.clone();
        if let (Outcome::Escaped(there), Some(&last)) = (polyline.end, points.last())
            && there.side == piece.side
        {
            let heading = polyline.heading;
            match (&self.hole, &self.spinning, &self.wormhole) {
                (Some((center, metric)), _, _) => {
                    points.extend(way_out(metric, *center, last, heading, reach))
                }
                (None, Some(spinning), _) => points.extend(spinning.way_out(last, heading, reach)),
                (None, None, Some((mouths, metric))) => {
                    points.extend(way_out(metric, mouths.center(piece.side), last, heading, reach));
                }
                (None, None, None) => points.push(last + reach * there.direction),
            }
        }
        points
    }

    /// The picture: a diagram for each side.
    pub fn figure(&self, title: &str) -> Figure {
        Figure { diagrams: self.views.iter().map(|view| self.diagram(view, title)).collect() }
    }

    /// The picture of a side.
    fn diagram(&self, view: &FanView, title: &str) -> Diagram {
        let (frame, plane) = (self.frame(view), &view.plane);
        let has_cuts = self.views.iter().any(|view| !view.cuts.is_empty());
        let mut series = vec![DataSeries {
            name: if has_cuts { "geometry".to_owned() } else { String::new() },
            style: Style::line(Color::GREY, 3.0),
            curves: view.cuts.iter().filter_map(|cut| plane.outline(cut, &frame)).collect(),
        }];
        for fate in RayEnd::ALL {
            let rays: Vec<&Polyline> =
                self.polylines.iter().filter(|polyline| RayEnd::of(&polyline.end) == fate).collect();
            if rays.is_empty() {
                continue;
            }
            let curves = rays.iter().flat_map(|polyline| {
                let pieces = polyline.pieces.iter().filter(|piece| piece.side == view.side);
                pieces.map(|piece| {
                    let points = self.drawn(polyline, piece, frame.reach());
                    points.into_iter().map(|point| plane.place(point)).collect()
                })
            });
            series.push(DataSeries {
                name: format!("{} ({})", fate.name(), rays.len()),
                style: Style::line(color(fate), 1.6),
                curves: curves.collect(),
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
            let axes = [plane.right, plane.up];
            let mut add = |name: &str, style: Style, curves: Vec<Vec<[f64; 2]>>| {
                series.push(DataSeries { name: name.to_owned(), style, curves });
            };
            add("photon orbits", Style::dashed(Color::BLACK, 1.6), spinning.photon_orbits(axes));
            add("ergosphere", Style::line(Color::GREY, 1.6), vec![spinning.ergosphere(axes)]);
            add("horizon", Style::area(Color::BLACK), vec![spinning.horizon(axes)]);
        }
        for alike in self.outlines.chunk_by(|a, b| a.name == b.name) {
            let curve =
                |outline: &FieldOutline| circle(plane.place(outline.center).into(), outline.radius, 0.0, PI);
            series.push(DataSeries {
                name: alike[0].name.to_owned(),
                style: alike[0].style,
                curves: alike.iter().map(curve).collect(),
            });
        }
        if let Some((_, metric)) = self.wormhole {
            series.push(DataSeries {
                name: "throat".to_owned(),
                style: Style::area(Color::BLACK),
                curves: vec![circle(DVec2::ZERO, metric.throat(), 0.0, PI)],
            });
        }
        let has_hole = self.hole.is_some() || self.spinning.is_some();
        let origin = match self.wormhole {
            _ if has_hole => "the hole",
            Some(_) => "the throat",
            None if !self.outlines.is_empty() => "the middle",
            None => "the start",
        };
        let title = match self.wormhole {
            Some(_) => format!("{title}, {} side", view.side.name()),
            None => title.to_owned(),
        };
        let FanBounds { min, max } = frame;
        let side = max - min;
        let scale = (DIAGRAM[0] / side.x).min(DIAGRAM[1] / side.y);
        Diagram {
            title,
            x: Axis::linear(format!("from {origin} along the view (scene units)"), [min.x, max.x]),
            y: Axis::linear("across (scene units)", [min.y, max.y]),
            size: [scale * side.x, scale * side.y],
            series,
        }
    }

    /// Frame of a side's picture, around the ends of rays and the hole; or the geometry; or a piece of a straight ray.
    fn frame(&self, view: &FanView) -> FanBounds {
        let (mut frame, plane) = (FanBounds::NOTHING, &view.plane);
        let mut hold = |point: DVec3, radius: f64| frame.hold(plane.place(point).into(), radius);
        let mut farthest = 0.0f64;
        for polyline in &self.polylines {
            let lands = matches!(polyline.end, Outcome::Landed(_));
            for (number, piece) in polyline.pieces.iter().enumerate() {
                if piece.side == view.side {
                    let seen = if lands { piece.points.len() } else { usize::from(number == 0) };
                    piece.points[..seen].iter().for_each(|&point| hold(point, 0.0));
                    if number == 0 {
                        farthest = farthest.max(DVec2::from(plane.place(piece.points[0])).length());
                    }
                }
            }
        }
        let body = self.hole.map(|(_, metric)| metric.photon_sphere());
        let body = body.or(self.spinning.map(|spinning| spinning.hole.outermost_photon_orbit()));
        if let Some(radius) = body.or(self.wormhole.map(|(_, metric)| metric.throat())) {
            hold(plane.origin, (AROUND_HOLE * radius).max(BESIDE_HOLE * farthest));
        }
        for outline in &self.outlines {
            hold(outline.center, BESIDE_OUTLINE * outline.radius);
        }
        if frame.reach() == 0.0 {
            for cut in &view.cuts {
                match *cut {
                    CrossSection::Line(ends) => {
                        ends.into_iter().for_each(|end| frame.hold(plane.place(end).into(), 0.0))
                    }
                    CrossSection::Circle { center, radius } => frame.hold(plane.place(center).into(), radius),
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

/// Unit directions evenly over `angle` around +X.
fn directions(angle: f64, count: u32) -> impl Iterator<Item = DVec2> {
    (0..count).map(move |index| {
        let s = if count > 1 { f64::from(index) / f64::from(count - 1) - 0.5 } else { 0.0 };
        unit(s * angle)
    })
}

/// World points of the ray that leaves `start` outwards in the unit direction `heading`, up to the radius `reach` about
/// `center`.
fn way_out(
    medium: &impl ConformallyFlat,
    center: DVec3,
    start: DVec3,
    heading: DVec3,
    reach: f64,
) -> Vec<DVec3> {
    let launch = Launch::new(medium, start - center, heading, f64::EPSILON);
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
            center + launch.position(part.end.w, swept + angle(h))
        }));
        swept += angle(step.h);
    });
    points
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
