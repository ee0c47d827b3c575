use std::f64::consts::PI;

use glam::DVec3;

use super::{InwardBending, Lens};
use crate::geodesic::{Control, Dop853, Launch, OrbitEnd, Phase, follow};
use crate::math::quadrature::gauss_legendre;
use crate::spacetime::{ConformallyFlat, Fate, Schwarzschild};

fn lens() -> (Schwarzschild, Lens) {
    let hole = Schwarzschild::new(1.0);
    (hole, Lens::new(&hole, 1e-15).unwrap())
}

/// Random places in all directions from a hole, from its horizon to some hundred radii, their radii spread evenly in the
/// logarithm.
pub(super) fn offsets_from(hole: Schwarzschild) -> impl FnMut() -> DVec3 {
    let mut state = 5u64;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        2.0 * ((state >> 11) as f64 / (1u64 << 53) as f64) - 1.0
    };
    move || {
        let x = DVec3::new(random(), random(), random());
        let radius = libm::exp(3.0 * (1.0 + random()));
        (hole.horizon() + radius) * x.normalize()
    }
}

/// The unit vector at an angle in a plane.
fn at(angle: f64) -> DVec3 {
    DVec3::new(angle.cos(), angle.sin(), 0.0)
}

#[test]
fn light_from_infinity_is_deflected_as_einstein_and_the_next_order_say() {
    let (hole, lens) = lens();
    for bend in [1e-2, 1e-3, 1e-4] {
        // Far behind the hole, swept π + bend.
        let (x, y) = (lens.infinity(at(0.0)), lens.site(&hole, 1e9 * at(PI + bend)));
        let ray = lens.connect(&x, &y, 1).unwrap();
        // bend = 2 r_s/b + 15π/16 (r_s/b)², less the angle b/ρ that is left.
        let expected = 2.0 / ray.b + 15.0 * PI / 16.0 / (ray.b * ray.b) - ray.b / 1e9;
        assert!((expected / bend - 1.0).abs() < 3.0 * bend * bend + 1e-8, "{bend}: {expected}");
        assert!(ray.direction.distance(-at(0.0)) < 1e-15 && ray.arrival.distance(at(PI + bend)) < 1e-4);
    }
}

#[test]
fn the_photon_sphere_joins_its_points_by_circles() {
    let (hole, lens) = lens();
    let rho = hole.photon_sphere();
    for angle in [0.1, 1.0, 3.0] {
        let [x, y] = [0.0, angle].map(|angle| lens.site(&hole, rho * at(angle)));
        for winding in 0..3 {
            let ray = lens.connect(&x, &y, winding).unwrap();
            assert!((ray.b / lens.critical - 1.0).abs() < 1e-14, "{ray:?}");
            let way = if winding == 1 { -1.0 } else { 1.0 };
            assert!(ray.direction.distance(way * at(0.5 * PI)) < 1e-6, "{ray:?}");
            // Rays beside it part like sin φ across its plane, like sinh φ in it.
            let exact = 1.0 / (rho * rho * (ray.swept.sin() * ray.swept.sinh()).abs());
            assert!((ray.geometry_factor / exact - 1.0).abs() < 1e-12, "{ray:?}, exactly {exact}");
            let time = lens.time(&x, &y, &ray);
            assert!((time / (ray.b * ray.swept) - 1.0).abs() < 1e-12, "{time}");
        }
    }
}

#[test]
fn one_place_is_joined_to_itself_only_around_the_hole() {
    let (hole, lens) = lens();
    let x = lens.site(&hole, DVec3::new(1.0, 2.0, -3.0));
    assert_eq!(lens.connect(&x, &x, 0), None);
    let ring = lens.connect(&x, &x, 1).unwrap();
    assert_eq!((ring.swept, ring.geometry_factor), (2.0 * PI, f64::INFINITY));
}

#[test]
fn the_way_to_infinity_in_closed_form_is_the_one_in_steps() {
    let hole = Schwarzschild::new(1.0);
    let lens = Lens::new(&hole, 1e-6).unwrap();
    let control = Control::<f64>::new(&hole, 1e-11, f64::INFINITY);
    let mut known = [0; 2];
    for (distance, angle) in (0..30).flat_map(|i| (1..60).map(move |j| (1.3f64.powi(i), 0.05 * f64::from(j))))
    {
        let launch = Launch::new(&hole, distance * DVec3::X, at(angle), f64::EPSILON);
        let start = Phase::new(&hole, launch.w, launch.v);
        let n = start.index(launch.b);
        let place = [-launch.v / n, launch.b * launch.w / n];
        let ([cos, sin], is_known) = lens.weak_bending().unwrap().to_infinity(launch.b, launch.w / n, place);
        if !is_known || launch.fate == Fate::Falls {
            continue;
        }
        let journey = follow(&hole, &Dop853, &control, (launch.b, start, launch.fate), 0.0, |_| {});
        let OrbitEnd::Crosses(_, swept) = journey.end else { panic!("{distance} {angle}: {journey:?}") };
        let off = at(swept).distance(DVec3::new(cos, sin, 0.0));
        assert!(off < 1e-7, "from {distance} at {angle}: {off:e}");
        known[usize::from(angle > 0.5 * PI)] += 1;
    }
    // On the way out, and on the way in first.
    assert!(known[0] > 300 && known[1] > 300, "{known:?}");
    assert!(Lens::new(&hole, 1e-12).unwrap().weak_bending().is_none());
}

#[test]
fn rays_from_outside_sweep_the_integral_of_their_orbit_on_the_way_inwards() {
    let hole = Schwarzschild::new(1.0);
    let rule = gauss_legendre(16);
    for tolerance in [1e-5, 1e-7, 1e-9] {
        let (mut known, mut fits) = (0, 0);
        for (rho, near) in [(20.0, 6.5), (60.0, 10.0), (1e4, 6.5), (1e4, 50.0), (1e9, 6.5)] {
            let [w0, w1] = [1.0 / rho, 1.0 / near];
            let Some(bending) = InwardBending::new(&hole, w1, tolerance) else { continue };
            fits += 1;
            let grazing = hole.index(w1) / w1;
            for part in [0.0, 1e-9, 0.03, 0.1, 0.3, 0.5, 0.9, 0.975, 1.1] {
                let b = part * grazing;
                let rate = |w: f64| (hole.index_squared(w) - (b * w) * (b * w)).sqrt();
                const PANELS: usize = 64;
                let width = (w1 - w0) / PANELS as f64;
                let exact: f64 = (0..PANELS)
                    .flat_map(|i| rule.iter().map(move |&(x, weight)| (i, x, weight)))
                    .map(|(i, x, weight)| {
                        let w = w0 + width * (i as f64 + 0.5 * (1.0 + x));
                        0.5 * width * weight * b / rate(w)
                    })
                    .sum();
                let n = hole.index(w0);
                let ([cos, sin], cosine, is_known) = bending.swept(b, w0 / n, rate(w0) / n);
                if is_known {
                    known += 1;
                    let error = (sin * exact.cos() - cos * exact.sin()).abs();
                    assert!(error < tolerance && cos > 0.0, "{rho} to {near}, {part}: {error}");
                    assert!((cosine - rate(w1) / hole.index(w1)).abs() < 1e-12);
                    assert!((cos * cos + sin * sin - 1.0).abs() < 1e-14);
                }
            }
        }
        assert!(fits > 0 && known > 4 * fits, "{tolerance}: {known} of {fits}");
    }
}
