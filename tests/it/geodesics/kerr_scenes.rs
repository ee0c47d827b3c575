//! Rays around spinning holes through the renderer against exact tables: the map from scenes, whose rays are traced into
//! the past in the outgoing chart, to future-directed photons in the ingoing one of a hole that spins the other way.

use crate::support::{Row, table};
use glam::DVec3;
use rayon::prelude::*;
use warpfront::geodesic::kerr::{KerrLaunch, KerrPhoton, UnitHole};
use warpfront::geometry::{Geometry, PrimitiveId, Primitives, Sphere, Surface};
use warpfront::scene::{Baked, Settings};
use warpfront::shade::Material;
use warpfront::spacetime::{KerrNewman, Placement, SpacetimeKind};
use warpfront::trace::transport::Outcome;
use warpfront::trace::{Ray, shoot};

/// Mass of the scene's hole.
const MASS: f64 = 1.7;

/// Error of a row's ray in the renderer over what is allowed, if it starts where things can be at rest; `Err` if its end
/// is another one.
fn share(row: &Row, charge: f64, tolerance: f64) -> Option<Result<f64, String>> {
    let name = format!("row {} ({}, a = {})", row.text("id"), row.text("kind"), row.text("a"));
    let hole = UnitHole::new(row.number("a"), charge);
    let placement = Placement { axis: DVec3::new(0.6, 0.0, 0.8), ..DVec3::new(3.0, -2.0, 5.0).into() };
    let to_world = placement.rotation().transpose();
    let place = |x: DVec3| placement.center + MASS * (to_world * x);
    let spacetime = SpacetimeKind::Spinning { placement, hole: KerrNewman::new(2.0 * MASS, -hole.a, charge) };
    let frame = spacetime.rest_frame();
    // Tangent in the chart and direction at rest of a photon of the table.
    let seen = |x: DVec3, p: DVec3| {
        let photon = KerrPhoton::new(&hole, x, p)?;
        let launch = KerrLaunch::with_momentum(&hole, photon.x, photon.p);
        let [velocity, _] = launch.state.motion(&hole, &launch.constants);
        let tangent = to_world * velocity.normalize();
        Some((tangent, frame.direction(place(x), tangent)))
    };
    let x = row.vector(["x0", "y0", "z0"]);
    if spacetime.drags(place(x)) {
        return None;
    }
    let (_, direction) = seen(x, row.vector(["px0", "py0", "pz0"]))?;
    let sens = row.maybe("sens").unwrap_or(1.0).max(1.0);
    let captured = row.text("status") == "captured";
    // A small sphere about the end: a ray that is off by more than is allowed passes beside it.
    let r_out = MASS * row.number("r_out");
    let allowed = 4.0 * tolerance * sens;
    let radius = r_out * allowed.max(1e-5);
    if radius > 0.05 * r_out {
        return None;
    }
    let exact = if captured { 1e4 * DVec3::X } else { row.vector(["x1", "y1", "z1"]) };
    let target = Sphere { center: place(exact), radius };
    let scene = Baked {
        spacetime,
        geometry: Geometry::build(Primitives {
            spheres: vec![(target, Surface { material: 0, entity: 0 })],
            ..Primitives::default()
        }),
        materials: vec![Material::default()],
        entities: vec!["target".to_owned()],
        settings: Settings { tolerance, arc_tolerance: Some(0.1 * tolerance * r_out), ..Settings::default() },
        ..Baked::default()
    };
    let ray = Ray { position: place(x), direction, origin_prim: PrimitiveId::NONE };
    let end = shoot(&scene, &[ray])[0].end;
    Some(match end {
        Outcome::Captured if captured => Ok(0.0),
        Outcome::Landed(landing) if !captured => {
            let (tangent, expected) = seen(exact, row.vector(["px1", "py1", "pz1"]))?;
            // Within the sphere the ray bends, too.
            let part = radius / r_out;
            let off = (landing.position - place(exact)).reject_from_normalized(tangent).length() / r_out;
            let turned = landing.direction.distance(expected);
            Ok((off / (allowed + part * part)).max(turned / (4.0 * allowed + 2.0 * part)))
        }
        end => Err(format!("{name}, sens {sens:.2e}: {end:?}")),
    })
}

fn check(tolerance: f64) {
    let rows = [("kerr_rays.csv", false), ("kerr_newman_rays.csv", true)]
        .into_iter()
        .flat_map(|(name, charged)| table(name).into_iter().map(move |row| (row, charged)));
    let rows: Vec<(Row, bool)> = rows.collect();
    let shares: Vec<Result<f64, String>> = rows
        .par_iter()
        .filter_map(|(row, charged)| share(row, if *charged { row.number("q") } else { 0.0 }, tolerance))
        .collect();
    let wrong: Vec<&String> = shares.iter().filter_map(|share| share.as_ref().err()).collect();
    assert!(wrong.is_empty(), "{} of {}: {wrong:#?}", wrong.len(), shares.len());
    let worst = shares.iter().flatten().fold(0.0, |worst: f64, &share| worst.max(share));
    println!("{} rays at {tolerance:e}: worst {worst:.3} of what is allowed", shares.len());
    assert!(shares.len() > 150 && worst < 1.0, "{} {worst}", shares.len());
}

#[test]
fn rays_of_the_tables_reach_their_ends_in_scenes() {
    check(1e-5);
    check(1e-8);
}
