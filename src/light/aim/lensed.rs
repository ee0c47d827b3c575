//! Lensed aim: exact in static, spherical spacetimes, with all windings around the centre.
//!
//! Through the throat of a wormhole, too: the lens sees its far world from the near side, and its rays there are turned into
//! the chart of the far world.

use glam::{DMat3, DVec3};

use super::beams::{BeamRay, Beams};
use super::{Aim, Approach, Link};
use crate::geodesic::{Lens, LensRay, RayDirections, Site};
use crate::math::columns::{LANES, Row};
use crate::spacetime::{AtInfinity, ConformallyFlat, Mouths, Side};

/// Rays around the centre of a spacetime.
pub struct Lensed<M> {
    medium: M,
    /// Centres on both sides of a throat; but for a wormhole, only the near one counts.
    mouths: Mouths,
    lens: Lens,
    windings: u32,
}

/// An end of a ray around a centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensedPlace {
    /// World position; at infinity the unit direction.
    position: DVec3,
    is_infinite: bool,
    side: Side,
    /// As seen from the near side.
    site: Site,
}

/// Relative error of connections: far below what their rays are traced with.
const TOLERANCE: f64 = 1e-5;
/// Largest distance of a ray's end from its target, relative to the distance from the centre: far more than its error
/// and far less than there is between two crossings of a surface.
const NEAR: f64 = 0.01;
/// Least weight, beside that of the near way, of a ray that goes around: it is weak but easily missed otherwise.
const LEAST_AROUND: f64 = 0.02;

impl<M: ConformallyFlat> Lensed<M> {
    /// Rays around `center` with winding numbers up to `max_winding`; `None` if `medium` has no photon sphere.
    pub fn new(medium: M, center: DVec3, max_winding: u32) -> Option<Self> {
        Self::through(medium, Mouths { near: center, far: center, rotation: DMat3::IDENTITY }, max_winding)
    }

    /// Rays around both mouths of a wormhole, and through it.
    pub fn through(medium: M, mouths: Mouths, max_winding: u32) -> Option<Self> {
        let lens = Lens::new(&medium, TOLERANCE)?;
        Some(Self { medium, mouths, lens, windings: max_winding + 1 })
    }

    /// True of a place within the horizon, where no ray ends, or upon it.
    fn is_hidden(&self, place: &LensedPlace) -> bool {
        !place.is_infinite && self.radius(place) <= self.medium.horizon()
    }

    /// Isotropic radius of a place in the world, in its own chart.
    fn radius(&self, place: &LensedPlace) -> f64 {
        place.position.distance(self.mouths.center(place.side))
    }

    /// A place in the world of a side, with its site there.
    fn place_at(&self, (side, position): (Side, DVec3), site: Site) -> LensedPlace {
        let radial = || (position - self.mouths.center(side)).normalize_or_zero();
        LensedPlace { position, is_infinite: false, side, site: self.seen_near(side, site, radial) }
    }

    /// The site of a side, as seen from the near side.
    fn seen_near(&self, side: Side, site: Site, radial: impl FnOnce() -> DVec3) -> Site {
        match side {
            Side::Near => site,
            Side::Far => site.beyond_throat(-self.mouths.turned(Side::Far, radial())),
        }
    }

    /// [`Aim::approach`], given how the ray arrives, roughly, in the chart of the near side.
    #[inline(always)]
    fn approach_by(
        &self,
        x: &LensedPlace,
        y: &LensedPlace,
        winding: u32,
        estimated_arrival: impl FnOnce() -> DVec3,
    ) -> Approach {
        let is_hidden = self.is_hidden(y);
        let distance = if (winding == 0 && x.side == y.side) || is_hidden {
            x.position.distance(y.position)
        } else {
            self.radius(x) + self.radius(y)
        };
        let direction = if x.side != y.side || x.site.is_at_other_depth(&y.site) {
            // No formula is near enough: rays through a throat go any way.
            self.link(x, y, winding).map_or(DVec3::ZERO, |link| link.arrival)
        } else if is_hidden {
            (y.position - x.position).normalize_or_zero()
        } else {
            self.own(y, estimated_arrival())
        };
        Approach { distance, direction, is_exact: false }
    }

    /// The link along a ray of the lens between two places.
    fn link_along(&self, x: &LensedPlace, y: &LensedPlace, ray: &LensRay) -> Link {
        let (direction, arrival) = (self.own(x, ray.direction), self.own(y, ray.arrival));
        Link { direction, arrival, geometry_factor: ray.geometry_factor }
    }

    /// A unit direction at a place, from the chart of the near side to that of the place's own.
    fn own(&self, place: &LensedPlace, direction: DVec3) -> DVec3 {
        match place.side {
            Side::Near => direction,
            Side::Far => self.mouths.across(Side::Near, place.site.radial(), direction),
        }
    }

    /// A unit direction at a place, from the place's own chart to that of the near side.
    fn as_near(&self, place: &LensedPlace, direction: DVec3) -> DVec3 {
        match place.side {
            Side::Near => direction,
            Side::Far => {
                let radial = self.mouths.turned(Side::Near, place.site.radial());
                self.mouths.across(Side::Far, radial, direction)
            }
        }
    }
}

impl<M: ConformallyFlat> Aim for Lensed<M> {
    type Place = LensedPlace;
    const SIDE_BY_SIDE: bool = true;

    fn place(&self, side: Side, x: DVec3) -> LensedPlace {
        let from = x - self.mouths.center(side);
        self.place_at((side, x), self.lens.site(&self.medium, from))
    }

    #[inline(always)]
    fn places(&self, at: impl Fn(usize) -> (Side, DVec3)) -> [LensedPlace; LANES] {
        let sites = self.lens.sites(&self.medium, |lane| {
            let (side, x) = at(lane);
            x - self.mouths.center(side)
        });
        std::array::from_fn(|lane| self.place_at(at(lane), Site::get(&sites, lane)))
    }

    fn infinity(&self, AtInfinity { side, direction }: AtInfinity) -> LensedPlace {
        let site = self.seen_near(side, self.lens.infinity(direction), || direction);
        LensedPlace { position: direction, is_infinite: true, side, site }
    }

    fn windings(&self) -> u32 {
        self.windings
    }

    fn around(&self, x: &LensedPlace, y: &LensedPlace) -> f64 {
        let ratio = if x.side == y.side {
            self.lens.magnification_ratio(&x.site, &y.site)
        } else {
            self.lens.ratio_beyond_throat(&x.site, &y.site)
        };
        ratio.max(LEAST_AROUND)
    }

    fn arounds(&self, x: &[LensedPlace; LANES], y: &[LensedPlace; LANES]) -> [f64; LANES] {
        let ratios = self.lens.magnification_ratios(|lane| (x[lane].site, y[lane].site));
        std::array::from_fn(|lane| match x[lane].side == y[lane].side {
            true => ratios[lane].max(LEAST_AROUND),
            false => self.around(&x[lane], &y[lane]),
        })
    }

    fn approach(&self, x: &LensedPlace, y: &LensedPlace, winding: u32) -> Approach {
        self.approach_by(x, y, winding, || self.lens.estimated_arrival(&x.site, &y.site, winding))
    }

    #[inline(always)]
    fn approaches(
        &self,
        x: &[LensedPlace; LANES],
        y: &[LensedPlace; LANES],
        winding: impl Fn(usize) -> Option<u32>,
    ) -> [Option<Approach>; LANES] {
        if (0..LANES).all(|lane| winding(lane).is_none()) {
            return [None; LANES];
        }
        let any = |lane| winding(lane).unwrap_or_default();
        let arrivals = self.lens.estimated_arrivals(|lane| (x[lane].site, y[lane].site), any);
        std::array::from_fn(|lane| {
            Some(self.approach_by(&x[lane], &y[lane], winding(lane)?, || arrivals[lane]))
        })
    }

    fn link(&self, x: &LensedPlace, y: &LensedPlace, winding: u32) -> Option<Link> {
        let mut link = None;
        if !self.is_hidden(y) {
            let pair = [(x.site, y.site, winding)];
            self.lens.join_all(&pair, |_, ray| link = ray.map(|ray| self.link_along(x, y, &ray)));
        }
        link
    }

    fn links(&self, pairs: &[(LensedPlace, LensedPlace, u32)]) -> [Option<Link>; LANES] {
        let (mut links, mut lanes, mut sites) = ([None; LANES], [0; LANES], [Default::default(); LANES]);
        let mut visible = 0;
        for (lane, (x, y, winding)) in pairs.iter().enumerate().filter(|(_, (_, y, _))| !self.is_hidden(y)) {
            (lanes[visible], sites[visible]) = (lane, (x.site, y.site, *winding));
            visible += 1;
        }
        self.lens.join_all(&sites[..visible], |number, ray| {
            let (x, y, _) = &pairs[lanes[number]];
            links[lanes[number]] = ray.map(|ray| self.link_along(x, y, &ray));
        });
        links
    }

    fn classify(
        &self,
        x: &LensedPlace,
        direction: DVec3,
        y: &LensedPlace,
        arrival: DVec3,
    ) -> Option<(u32, f64)> {
        let (direction, arrival) = (self.as_near(x, direction), self.as_near(y, arrival));
        self.lens.classify(&x.site, direction, &y.site, arrival)
    }

    fn is_reached(&self, side: Side, at: DVec3, end: DVec3) -> bool {
        at.distance_squared(end) <= NEAR * NEAR * end.distance_squared(self.mouths.center(side))
    }

    fn area_scale(&self, y: &LensedPlace) -> f64 {
        if y.is_infinite {
            return 1.0;
        }
        let w = 1.0 / self.radius(y);
        self.medium.index_squared(w) * self.medium.lapse(w).powi(2)
    }
}

impl<M: ConformallyFlat> Lensed<M> {
    /// A ray that a beam surrounds, between its places, as the lens sees it.
    fn beam(&self, ray: &BeamRay, [x, y]: [&LensedPlace; 2]) -> (Site, Site, RayDirections) {
        let (leaving, arriving) = (self.as_near(x, ray.leaving), self.as_near(y, ray.arriving));
        (x.site, y.site, RayDirections { leaving, arriving })
    }
}

impl<M: ConformallyFlat> Beams for Lensed<M> {
    fn widths(&self, ray: &BeamRay) -> Option<[f64; 2]> {
        let [x, y] = [ray.from, ray.to].map(|(side, position)| self.place(side, position));
        let mut found = None;
        self.lens.all_beam_widths(&[self.beam(ray, [&x, &y])], |_, widths| found = widths);
        found
    }

    fn all_widths(&self, rays: &[BeamRay], each: &mut dyn FnMut(usize, Option<[f64; 2]>)) {
        for (number, rays) in rays.chunks(LANES).enumerate() {
            let of = |lane: usize| &rays[lane.min(rays.len() - 1)];
            let (from, to) = (self.places(|lane| of(lane).from), self.places(|lane| of(lane).to));
            let beams: [_; LANES] = std::array::from_fn(|lane| self.beam(of(lane), [&from[lane], &to[lane]]));
            let first = number * LANES;
            self.lens.all_beam_widths(&beams[..rays.len()], |lane, widths| each(first + lane, widths));
        }
    }
}
