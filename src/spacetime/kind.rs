//! Table of all spacetimes: each has its name in [`media!`]; callers ask [`SpacetimeKind`] instead of matching.

use glam::DVec3;

use super::chart::Chart;
use super::conformally_flat::ConformallyFlat;
use super::ellis::Ellis;
use super::index_field::{IndexField, Sink};
use super::interstellar::Interstellar;
use super::kerr::Kerr;
use super::kerr_newman::KerrNewman;
use super::lenses::Lenses;
use super::mouths::Mouths;
use super::named::Named;
use super::parameter::{Parameter, Range, SCHWARZSCHILD_RADIUS};
use super::placement::Placement;
use super::reissner_nordstrom::ReissnerNordstrom;
use super::rest_frame::RestFrame;
use super::schwarzschild::Schwarzschild;
use super::several_holes::SeveralHoles;
use super::side::Side;
use crate::math::real::Real;

macro_rules! media {
    ($($(#[$doc:meta])* $Kinds:ident, $family:ident($place:ident: $Place:ty): $($name:ident),+;)+) => {
        $(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum $Kinds {
            $(
                /// The spacetime of this name.
                $name($name),
            )+
        }

        $(impl From<$name> for $Kinds {
            fn from(metric: $name) -> Self {
                Self::$name(metric)
            }
        })+

        impl $Kinds {
            fn entry(self) -> &'static Entry {
                match self {
                    $(Self::$name(_) => const { &Entry::$family::<$name>() },)+
                }
            }

            fn values(self) -> Vec<f64> {
                match self {
                    $(Self::$name(metric) => metric.values(),)+
                }
            }

            fn visit<V: SpacetimeVisitor>(self, $place: $Place, visitor: V) -> V::Output {
                match self {
                    $(Self::$name(metric) => visitor.$family($place, metric),)+
                }
            }
        }

        /// Chosen at every call: for all but the march, which is compiled for each spacetime.
        impl ConformallyFlat for $Kinds {
            fn index_squared<R: Real>(&self, w: R) -> R {
                match self { $(Self::$name(metric) => metric.index_squared(w),)+ }
            }

            fn index<R: Real>(&self, w: R) -> R {
                match self { $(Self::$name(metric) => metric.index(w),)+ }
            }

            fn pull<R: Real>(&self, w: R) -> R {
                match self { $(Self::$name(metric) => metric.pull(w),)+ }
            }

            fn projected_pull<R: Real>(&self, projected: R, secant2: R) -> R {
                match self { $(Self::$name(metric) => metric.projected_pull(projected, secant2),)+ }
            }

            fn lapse(&self, w: f64) -> f64 {
                match self { $(Self::$name(metric) => metric.lapse(w),)+ }
            }

            fn horizon(&self) -> f64 {
                match self { $(Self::$name(metric) => metric.horizon(),)+ }
            }

            fn throat(&self) -> f64 {
                match self { $(Self::$name(metric) => metric.throat(),)+ }
            }

            fn mouth(&self) -> f64 {
                match self { $(Self::$name(metric) => metric.mouth(),)+ }
            }

            fn proper_radius(&self, rho: f64) -> f64 {
                match self { $(Self::$name(metric) => metric.proper_radius(rho),)+ }
            }

            fn isotropic_radius(&self, l: f64) -> f64 {
                match self { $(Self::$name(metric) => metric.isotropic_radius(l),)+ }
            }

            fn photon_sphere(&self) -> f64 {
                match self { $(Self::$name(metric) => metric.photon_sphere(),)+ }
            }

            fn critical_impact_parameter(&self) -> f64 {
                match self { $(Self::$name(metric) => metric.critical_impact_parameter(),)+ }
            }

            fn motion(&self, x: DVec3, p: DVec3) -> (DVec3, DVec3) {
                match self { $(Self::$name(metric) => metric.motion(x, p),)+ }
            }
        }
        )+

        /// All spacetimes, in the order of the command line's help.
        pub static SPACETIMES: &[&Entry] = &[
            $($(const { &Entry::$family::<$name>() },)+)+
            &KERR,
            &KERR_NEWMAN,
            &FLAT,
        ];
    };
}

media! {
    /// Static, spherical spacetimes centred on the origin.
    Metric, spherical(center: DVec3): Schwarzschild, ReissnerNordstrom;

    /// Static, spherical wormholes centred on the origin.
    Wormhole, wormhole(mouths: Mouths): Ellis, Interstellar;
}

/// A spacetime and where its centre is placed.
#[derive(Clone, Debug, PartialEq)]
pub enum SpacetimeKind {
    /// Minkowski: rays are straight.
    Flat,
    /// Static and spherical, in isotropic coordinates.
    Spherical {
        /// World position of the centre.
        center: DVec3,
        /// The spacetime about its centre.
        metric: Metric,
    },
    /// A static, spherical wormhole between two worlds, in isotropic coordinates about the throat in each.
    Wormhole {
        /// Centres of the throat in both worlds.
        mouths: Mouths,
        /// The wormhole about its centre.
        metric: Wormhole,
    },
    /// A spinning hole, in Cartesian Kerr–Schild coordinates of the outgoing form, with the axis along `placement`'s.
    Spinning {
        /// Centre and axis in the world.
        placement: Placement,
        /// The hole about its centre, with the axis along z.
        hole: KerrNewman,
    },
    /// A static index of refraction in three dimensions, in isotropic coordinates.
    Indexed(IndexMedium),
}

/// Static indices of refraction in three dimensions.
#[derive(Clone, Debug, PartialEq)]
pub enum IndexMedium {
    /// Majumdar and Papapetrou's holes.
    SeveralHoles(SeveralHoles),
    /// Glass.
    Lenses(Lenses),
}

/// What a spacetime is a list of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listed {
    /// Holes.
    Holes,
    /// Lenses.
    Lenses,
}

/// Work on a spacetime of any family: a new family does not compile until every visitor handles it.
pub trait SpacetimeVisitor {
    /// Result.
    type Output;

    /// In flat space.
    fn flat(self) -> Self::Output;

    /// In a static, spherical spacetime about `center`.
    fn spherical<M: ConformallyFlat>(self, center: DVec3, medium: M) -> Self::Output;

    /// Through a static, spherical wormhole.
    fn wormhole<M: ConformallyFlat>(self, mouths: Mouths, medium: M) -> Self::Output;

    /// Around a spinning hole.
    fn spinning(self, placement: Placement, hole: KerrNewman) -> Self::Output;

    /// In a static index of refraction in three dimensions.
    fn indexed<F: IndexField>(self, field: &F) -> Self::Output;
}

/// A spacetime's entry in the table of all.
#[derive(Debug)]
pub struct Entry {
    /// Name in scene files and on the command line.
    pub name: &'static str,
    /// Name in descriptions.
    pub title: &'static str,
    /// One line for the command line's help.
    pub summary: &'static str,
    /// Parameters in the order of values.
    pub parameters: &'static [Parameter],
    /// True if it has an axis that can be tilted.
    pub has_axis: bool,
    /// True if it joins two worlds.
    pub has_far_side: bool,
    /// What it is a list of, beside its parameters.
    pub listed: Option<Listed>,
    conflict: fn(&[f64]) -> Option<(String, String)>,
    make: fn(Placement, &[f64]) -> SpacetimeKind,
}

static FLAT: Entry = Entry {
    name: "flat",
    title: "flat",
    summary: "No hole: straight rays",
    parameters: &[],
    has_axis: false,
    has_far_side: false,
    listed: None,
    conflict: |_| None,
    make: |_, _| SpacetimeKind::Flat,
};
static SEVERAL_HOLES: Entry = Entry {
    name: "several-holes",
    title: "Majumdar–Papapetrou",
    summary: "Any number of extremally charged holes at rest; isotropic coordinates",
    listed: Some(Listed::Holes),
    ..FLAT
};
static LENSES: Entry = Entry {
    name: "lenses",
    title: "graded glass",
    summary: "Lenses of a graded index in flat space",
    listed: Some(Listed::Lenses),
    ..FLAT
};
/// Spacetimes that are lists of things, which only scene files can write.
pub static LISTED: &[&Entry] = &[&SEVERAL_HOLES, &LENSES];
static KERR: Entry = Entry::spinning::<Kerr>();
static KERR_NEWMAN: Entry = Entry::spinning::<KerrNewman>();

impl Entry {
    const fn of<N: Named>(has_axis: bool, make: fn(Placement, &[f64]) -> SpacetimeKind) -> Self {
        Self {
            name: N::NAME,
            title: N::TITLE,
            summary: N::SUMMARY,
            parameters: N::PARAMETERS,
            has_axis,
            has_far_side: false,
            listed: None,
            conflict: N::conflict,
            make,
        }
    }

    const fn spherical<M: Named + Into<Metric>>() -> Self {
        Self::of::<M>(false, |placement, values| SpacetimeKind::Spherical {
            center: placement.center,
            metric: M::new(values).into(),
        })
    }

    const fn wormhole<M: Named + Into<Wormhole>>() -> Self {
        let entry = Self::of::<M>(false, |placement, values| SpacetimeKind::Wormhole {
            mouths: placement.mouths(),
            metric: M::new(values).into(),
        });
        Self { has_far_side: true, ..entry }
    }

    const fn spinning<M: Named + Into<KerrNewman>>() -> Self {
        Self::of::<M>(true, |placement, values| SpacetimeKind::Spinning {
            placement,
            hole: M::new(values).into(),
        })
    }

    /// The entry of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SPACETIMES.iter().chain(LISTED).find(|entry| entry.name == name).copied()
    }

    /// Problem with values that are each within bounds but not together, and its remedy.
    pub fn conflict(&self, values: &[f64]) -> Option<(String, String)> {
        (self.conflict)(values)
    }

    /// The spacetime of this name in its place, with a value for each parameter; flat space if a length is 0.
    pub fn with(&self, placement: impl Into<Placement>, values: &[f64]) -> SpacetimeKind {
        let is_length = |parameter: &Parameter| parameter.range == Range::Length;
        let mut lengths = self.parameters.iter().zip(values).filter(|(parameter, _)| is_length(parameter));
        if lengths.any(|(_, length)| *length == 0.0) {
            return SpacetimeKind::Flat;
        }
        (self.make)(placement.into(), values)
    }

    /// One of them, about the origin: parameters do not change the family, but for a length of 0.
    pub fn example(&self) -> SpacetimeKind {
        let values = self.parameters.iter().map(|parameter| match parameter.range {
            Range::Length | Range::Extent => 1.0,
            Range::Ratio { least, most, .. } => 0.5 * (least + most),
        });
        let values: Vec<f64> = values.collect();
        self.with(DVec3::ZERO, &values)
    }
}

impl SpacetimeKind {
    /// A Schwarzschild hole; flat space if the radius is 0.
    pub const fn black_hole(center: DVec3, schwarzschild_radius: f64) -> Self {
        if schwarzschild_radius == 0.0 {
            return Self::Flat;
        }
        Self::Spherical { center, metric: Metric::Schwarzschild(Schwarzschild::new(schwarzschild_radius)) }
    }

    /// A hole of this Schwarzschild radius and spin a/M: Schwarzschild's without spin, flat space if the radius is 0.
    pub fn spinning(placement: Placement, schwarzschild_radius: f64, spin: f64) -> Self {
        if spin == 0.0 {
            return Self::black_hole(placement.center, schwarzschild_radius);
        }
        KERR.with(placement, &[schwarzschild_radius, spin])
    }

    /// Entry in the table of all.
    pub fn entry(&self) -> &'static Entry {
        match self {
            Self::Flat => &FLAT,
            Self::Spherical { metric, .. } => metric.entry(),
            Self::Wormhole { metric, .. } => metric.entry(),
            Self::Spinning { hole, .. } if hole.charge() == 0.0 => &KERR,
            Self::Spinning { .. } => &KERR_NEWMAN,
            Self::Indexed(IndexMedium::SeveralHoles(_)) => &SEVERAL_HOLES,
            Self::Indexed(IndexMedium::Lenses(_)) => &LENSES,
        }
    }

    /// Test for flat space.
    pub fn is_flat(&self) -> bool {
        *self == Self::Flat
    }

    /// World position of the centre, or of the middle of several things, if there is one; of a wormhole in the near world.
    pub fn center(&self) -> Option<DVec3> {
        match self {
            Self::Flat => None,
            Self::Spherical { center, .. } => Some(*center),
            Self::Wormhole { mouths, .. } => Some(mouths.near),
            Self::Spinning { placement, .. } => Some(placement.center),
            Self::Indexed(medium) => Some(medium.middle()),
        }
    }

    /// Centre and axis; those of the origin where there are none.
    fn placement(&self) -> Placement {
        match self {
            Self::Flat | Self::Indexed(_) => Placement::default(),
            Self::Spherical { center, .. } => (*center).into(),
            Self::Spinning { placement, .. } => *placement,
            Self::Wormhole { mouths, .. } => (*mouths).into(),
        }
    }

    /// Centre and optical medium of a static, spherical spacetime.
    pub fn medium(&self) -> Option<(DVec3, Metric)> {
        match self {
            Self::Flat | Self::Wormhole { .. } | Self::Spinning { .. } | Self::Indexed(_) => None,
            Self::Spherical { center, metric } => Some((*center, *metric)),
        }
    }

    /// Mouths and optical medium of a wormhole.
    pub fn wormhole(&self) -> Option<(Mouths, Wormhole)> {
        match self {
            Self::Flat | Self::Spherical { .. } | Self::Spinning { .. } | Self::Indexed(_) => None,
            Self::Wormhole { mouths, metric } => Some((*mouths, *metric)),
        }
    }

    /// Largest chart radius of the horizon, 0 if there is none.
    pub fn horizon(&self) -> f64 {
        match self {
            Self::Flat | Self::Wormhole { .. } | Self::Indexed(_) => 0.0,
            Self::Spherical { metric, .. } => metric.horizon(),
            Self::Spinning { hole, .. } => hole.equatorial_radius(hole.horizon()),
        }
    }

    /// Places of all holes, each with the largest impact parameter of rays from afar that it captures or lets through a
    /// throat, 0 if none is.
    pub fn shadows(&self) -> Vec<(DVec3, f64)> {
        match self {
            Self::Flat => Vec::new(),
            Self::Spherical { center, metric } => vec![(*center, metric.critical_impact_parameter())],
            Self::Wormhole { mouths, metric } => vec![(mouths.near, metric.critical_impact_parameter())],
            Self::Spinning { placement, hole } => vec![(placement.center, hole.shadow())],
            Self::Indexed(medium) => medium.sinks().iter().map(|sink| (sink.center, sink.shadow)).collect(),
        }
    }

    /// Frames of things at rest.
    pub fn rest_frame(&self) -> RestFrame {
        match *self {
            Self::Flat | Self::Spherical { .. } | Self::Wormhole { .. } | Self::Indexed(_) => {
                RestFrame::Conformal
            }
            Self::Spinning { placement, hole } => RestFrame::spinning(placement, hole),
        }
    }

    /// True within the throat of a wormhole on a side: such places belong to neither world.
    pub fn is_in_throat(&self, side: Side, point: DVec3) -> bool {
        self.wormhole().is_some_and(|(mouths, metric)| point.distance(mouths.center(side)) < metric.throat())
    }

    /// True where nothing can be at rest: within a horizon, or in the ergosphere of a spinning hole.
    pub fn drags(&self, point: DVec3) -> bool {
        match self {
            Self::Flat | Self::Wormhole { .. } => false,
            Self::Spherical { center, metric } => point.distance(*center) <= metric.horizon(),
            Self::Spinning { placement, hole } => hole.drags(placement.local(point)),
            Self::Indexed(_) => self.hides(point),
        }
    }

    /// True so near the horizon, or within, that no ray is followed there.
    pub fn hides(&self, point: DVec3) -> bool {
        match self {
            Self::Flat | Self::Wormhole { .. } => false,
            Self::Spherical { center, metric } => point.distance(*center) <= Chart::innermost(metric),
            Self::Spinning { .. } => self.drags(point),
            Self::Indexed(medium) => {
                medium.sinks().iter().any(|sink| point.distance(sink.center) <= sink.innermost)
            }
        }
    }

    /// Parameters and their values.
    pub fn parameters(&self) -> impl Iterator<Item = (&'static Parameter, f64)> {
        let values = match self {
            Self::Flat | Self::Indexed(_) => Vec::new(),
            Self::Spherical { metric, .. } => metric.values(),
            Self::Wormhole { metric, .. } => metric.values(),
            Self::Spinning { hole, .. } => hole.values(),
        };
        self.entry().parameters.iter().zip(values)
    }

    /// Schwarzschild radius 2M, 0 if there is no mass.
    pub fn schwarzschild_radius(&self) -> f64 {
        self.parameters().find(|(p, _)| p.key == SCHWARZSCHILD_RADIUS.key).map_or(0.0, |(_, value)| value)
    }

    /// Replaces the Schwarzschild radius; a spacetime without one is unchanged.
    pub fn with_schwarzschild_radius(&self, radius: f64) -> Self {
        if self.parameters().next().is_none() {
            return self.clone();
        }
        let value =
            |(p, old): (&Parameter, f64)| if p.key == SCHWARZSCHILD_RADIUS.key { radius } else { old };
        let values: Vec<f64> = self.parameters().map(value).collect();
        self.entry().with(self.placement(), &values)
    }

    /// The spacetime about the origin in units of its first length, and that length: what scales with it is computed once.
    /// `None` of flat space.
    pub fn in_units(&self) -> Option<(Self, f64)> {
        let is_length = |parameter: &Parameter| matches!(parameter.range, Range::Length | Range::Extent);
        let (_, unit) = self.parameters().find(|(parameter, _)| is_length(parameter))?;
        let scaled = |(parameter, value)| if is_length(parameter) { value / unit } else { value };
        let values: Vec<f64> = self.parameters().map(scaled).collect();
        Some((self.entry().with(DVec3::ZERO, &values), unit))
    }

    /// Does `visitor`'s work in the family that the spacetime is of.
    pub fn visit<V: SpacetimeVisitor>(&self, visitor: V) -> V::Output {
        match self {
            Self::Flat => visitor.flat(),
            Self::Spherical { center, metric } => metric.visit(*center, visitor),
            Self::Wormhole { mouths, metric } => metric.visit(*mouths, visitor),
            Self::Spinning { placement, hole } => visitor.spinning(*placement, *hole),
            Self::Indexed(IndexMedium::SeveralHoles(holes)) => visitor.indexed(holes),
            Self::Indexed(IndexMedium::Lenses(lenses)) => visitor.indexed(lenses),
        }
    }
}

impl IndexMedium {
    /// World position of the middle.
    fn middle(&self) -> DVec3 {
        match self {
            Self::SeveralHoles(holes) => holes.middle(),
            Self::Lenses(lenses) => lenses.middle(),
        }
    }

    /// Places where rays end.
    pub fn sinks(&self) -> &[Sink] {
        match self {
            Self::SeveralHoles(holes) => holes.sinks(),
            Self::Lenses(lenses) => lenses.sinks(),
        }
    }
}
