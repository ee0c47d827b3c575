//! The principled lobe and its parts: albedo by sampling and by quadrature, energy, reciprocity.

use std::f64::consts::PI;

use crate::support::Random;
use crate::support::chi_square::Directions;
use glam::{DVec3, Vec3};
use warpfront::shade::{Bsdf, Incidence, Lacquered, Lobe, Principled, SortedHits};

const ROUGHNESSES: [f32; 5] = [0.0, 0.1, 0.3, 0.6, 1.0];
/// Cosines to the normal, from grazing to normal incidence.
const COSINES: [f64; 4] = [0.05, 0.2, 0.6, 1.0];

const METAL: Principled = Principled { metallic: 1.0, ..Principled::PLAIN };
const GLASS: Principled = Principled { transmission: 1.0, is_thin: false, ..Principled::PLAIN };

/// Light that comes to a surface of normal z at this cosine.
fn incidence(cos: f64, eta: f64) -> Incidence {
    let direction = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, -cos);
    Incidence { direction, normal: DVec3::Z, shading_normal: DVec3::Z, eta }
}

/// Numbers in [0, 1) that are well spread over the cube: Halton's.
fn numbers(index: u32) -> [f32; 4] {
    let inverse = |base: u32| {
        let (mut rest, mut digit, mut sum) = (index + 1, 1.0, 0.0);
        while rest > 0 {
            digit /= f64::from(base);
            sum += digit * f64::from(rest % base);
            rest /= base;
        }
        (sum as f32).min(1f32.next_down())
    };
    [inverse(2), inverse(3), inverse(5), 0.0]
}

/// Scattered share of light by sampling: of what leaves in single directions, and of what spreads.
fn by_sampling(lobe: &impl Bsdf, incidence: &Incidence, count: u32) -> [Vec3; 2] {
    let mut sums = [DVec3::ZERO; 2];
    for index in 0..count {
        let bounce = lobe.sample(incidence, numbers(index));
        assert!(bounce.direction.is_normalized() && bounce.weight.is_finite(), "{bounce:?}");
        sums[usize::from(bounce.density > 0.0)] += bounce.weight.as_dvec3() / f64::from(count);
    }
    sums.map(|sum| sum.as_vec3())
}

/// Scattered share of light that spreads, by quadrature around the directions of mirror image and refraction.
fn by_quadrature(lobe: &Principled, incidence: &Incidence) -> Vec3 {
    by_quadrature_of(lobe, lobe, incidence)
}

/// That of a lobe which is as rough as a principled one.
fn by_quadrature_of(of: &impl Bsdf, lobe: &Principled, incidence: &Incidence) -> Vec3 {
    const RINGS: usize = 800;
    const SECTORS: usize = 400;
    let coat = if lobe.clearcoat > 0.0 { lobe.clearcoat_roughness } else { 1.0 };
    let near = f64::from(lobe.roughness.min(coat).max(0.05)).powi(4) / 40.0;
    let (direction, eta) = (incidence.direction, incidence.eta);
    let image = DVec3 { z: -direction.z, ..direction };
    let refracted = DVec3::new(direction.x / eta, 0.0, -(1.0 - (direction.x / eta).powi(2)).max(0.0).sqrt());
    let through = if lobe.is_thin { direction } else { refracted };
    let mut sum = DVec3::ZERO;
    let sides = [(image, 1.0), (through, -1.0)];
    for (axis, side) in sides.into_iter().take(1 + usize::from(lobe.transmits())) {
        let around = Directions { near, ..Directions::even(axis.normalize()) };
        for cell in 0..RINGS * SECTORS {
            let place = [(cell / SECTORS) as f64 + 0.5, (cell % SECTORS) as f64 + 0.5];
            let (out, stretch) = around.at([place[0] / RINGS as f64, place[1] / SECTORS as f64]);
            if side * out.z > 0.0 {
                let measure = 4.0 * PI * stretch / (RINGS * SECTORS) as f64;
                sum += of.evaluate(incidence, out).bsdf.as_dvec3() * measure;
            }
        }
    }
    sum.as_vec3()
}

/// Lobes by name at a roughness.
fn variants(roughness: f32) -> Vec<(&'static str, Principled)> {
    let anisotropic = Principled { anisotropy: 0.7, tangent: DVec3::new(0.6, 0.8, 0.0), ..METAL };
    let coated = Principled { clearcoat: 1.0, clearcoat_roughness: 0.3, ..METAL };
    let lacquered = Principled { clearcoat: 0.7, ..Principled::PLAIN };
    let cloth = Principled { sheen_color: Vec3::new(1.0, 0.6, 0.2), ..Principled::PLAIN };
    let thin = Principled { transmission: 1.0, base: Vec3::new(1.0, 0.5, 0.2), ..Principled::PLAIN };
    let film = Principled { iridescence: 1.0, iridescence_thickness: 350.0, ..METAL };
    let mixed = Principled { metallic: 0.4, transmission: 0.5, specular_color: Vec3::X, ..Principled::PLAIN };
    [
        ("metal", METAL),
        ("single scattering", Principled { multiscatter: false, ..METAL }),
        ("anisotropic", anisotropic),
        ("plastic", Principled::PLAIN),
        ("coated", coated),
        ("lacquered", lacquered),
        ("cloth", Principled { sheen_roughness: roughness.max(0.3), roughness: 0.6, ..cloth }),
        ("thin", thin),
        ("glass", GLASS),
        ("film", film),
        ("mixed", mixed),
    ]
    .map(|(name, lobe)| {
        let roughness = if name == "cloth" { lobe.roughness } else { roughness };
        let least = if name == "anisotropic" { 0.3 } else { 0.0 };
        (name, Principled { roughness: roughness.max(least), ..lobe })
    })
    .to_vec()
}

#[test]
fn albedo_by_sampling_is_that_by_quadrature_and_never_above_one() {
    let (mut worst, mut most) = ((0.0f32, String::new()), (0.0f32, String::new()));
    for roughness in ROUGHNESSES {
        for (name, lobe) in variants(roughness) {
            for cos in COSINES {
                for eta in if name == "glass" { vec![1.5, 1.0 / 1.5] } else { vec![1.0] } {
                    let incidence = incidence(cos, eta);
                    let [single, spread] = by_sampling(&lobe, &incidence, 1 << 18);
                    let exact = by_quadrature(&lobe, &incidence);
                    let what = format!("{name}, roughness {roughness}, cos {cos}: {spread} {exact} {single}");
                    let error = (spread - exact).abs().max_element();
                    if error > 1e-3 {
                        println!("{what}");
                    }
                    if error > worst.0 {
                        worst = (error, what.clone());
                    }
                    if (exact + single).max_element() > most.0 {
                        most = ((exact + single).max_element(), what);
                    }
                }
            }
        }
    }
    println!("{worst:?}\n{most:?}");
    assert!(worst.0 < 1e-3, "{worst:?}");
    assert!(most.0 < 1.0 + 1e-3, "{most:?}");
}

#[test]
fn a_coat_with_a_normal_of_its_own_scatters_as_it_says_and_gains_nothing() {
    let coated = Principled { clearcoat: 1.0, clearcoat_roughness: 0.3, roughness: 0.5, ..METAL };
    let (mut worst, mut most) = ((0.0f32, String::new()), 0.0f32);
    for clearcoat_normal in [DVec3::new(0.3, 0.1, 1.0), DVec3::new(-0.2, 0.7, 1.0)].map(DVec3::normalize) {
        for principled in [
            coated,
            Principled { metallic: 0.0, ..coated },
            Principled { clearcoat_roughness: 0.0, ..coated },
            Principled { base: Vec3::ZERO, ..coated },
            Principled { base: Vec3::ZERO, clearcoat_roughness: 0.0, ..coated },
        ] {
            for cos in COSINES {
                let (lobe, incidence) = (Lacquered { principled, clearcoat_normal }, incidence(cos, 1.0));
                let [single, spread] = by_sampling(&lobe, &incidence, 1 << 18);
                let exact = by_quadrature_of(&lobe, &principled, &incidence);
                let error = (spread - exact).abs().max_element();
                most = most.max((exact + single).max_element());
                if error > worst.0 {
                    worst = (error, format!("{lobe:?}, cos {cos}: {spread} {exact} {single}"));
                }
            }
        }
    }
    println!("{worst:?} {most}");
    assert!(worst.0 < 1e-3, "{worst:?}");
    assert!(most < 1.0 + 1e-3, "{most}");
    // With the normal of the surface it is the principled lobe.
    let incidence = incidence(0.4, 1.0);
    let plain = Lacquered { principled: coated, clearcoat_normal: DVec3::ZERO };
    for index in 0..100 {
        let out = coated.sample(&incidence, numbers(index)).direction;
        let [one, other] = [plain.evaluate(&incidence, out), coated.evaluate(&incidence, out)];
        assert!(
            (one.bsdf - other.bsdf).abs().max_element() <= 1e-5 * other.bsdf.max_element(),
            "{one:?} {other:?}"
        );
    }
}

#[test]
fn metals_that_reflect_everything_and_clear_thin_walls_lose_nothing() {
    let mut worst = (0.0, String::new());
    for index in 0..=20 {
        let roughness = index as f32 / 20.0;
        for cos in COSINES.into_iter().chain([0.001, 0.03, 0.35, 0.65]) {
            for lobe in [METAL, Principled { transmission: 1.0, ..Principled::PLAIN }] {
                let lobe = Principled { roughness, ..lobe };
                let [single, spread] = by_sampling(&lobe, &incidence(cos, 1.0), 1 << 15);
                let error = f64::from((single + spread - 1.0).abs().max_element());
                if error > worst.0 {
                    worst = (error, format!("{lobe:?}, cos {cos}: {}", single + spread));
                }
            }
        }
    }
    println!("{worst:?}");
    assert!(worst.0 < 1e-3, "{worst:?}");
}

#[test]
fn layers_by_themselves_are_reciprocal_and_refraction_is_up_to_the_square_of_the_index() {
    let mut random = Random::new(1);
    let single =
        |lobe: Principled| Principled { multiscatter: false, base: Vec3::new(0.9, 0.5, 0.1), ..lobe };
    let black = Principled { base: Vec3::ZERO, ..Principled::PLAIN };
    let sheen = Principled { sheen_color: Vec3::ONE, sheen_roughness: 0.2, specular: 0.0, ..black };
    let film = Principled { iridescence: 0.6, ..METAL };
    let anisotropic = Principled { anisotropy: 0.8, tangent: DVec3::X, ..METAL };
    let thin = Principled { transmission: 1.0, ..Principled::PLAIN };
    let lobes = [METAL, anisotropic, film, thin, GLASS].map(single);
    for lobe in lobes.into_iter().chain([sheen, Principled { multiscatter: false, ..black }]) {
        let lobe = Principled { roughness: 0.6, ..lobe };
        let mut count = 0;
        for _ in 0..2000 {
            let (from, to) = (random.direction(), random.direction());
            let towards = |from: DVec3, to: DVec3| {
                let normal = if from.z > 0.0 { DVec3::Z } else { DVec3::NEG_Z };
                let eta = if lobe.is_thin {
                    1.0
                } else if from.z > 0.0 {
                    1.5
                } else {
                    1.0 / 1.5
                };
                let incidence = Incidence { direction: -from, normal, shading_normal: normal, eta };
                // Of the radiance inside, which is not scaled.
                let square = if from.z * to.z < 0.0 { eta } else { 1.0 };
                lobe.evaluate(&incidence, to).bsdf.as_dvec3() / (to.z.abs() * square)
            };
            let (there, back) = (towards(from, to), towards(to, from));
            let both = there.max_element().max(back.max_element());
            count += u32::from(both > 0.0);
            let error = (there - back).abs().max_element();
            // BSDFs are added up in f32.
            assert!(error <= 1e-5 * both + 1e-30, "{lobe:?} from {from} to {to}: {there} and {back}");
        }
        assert!(count > 300, "{lobe:?}: {count}");
    }
}

#[test]
fn many_hits_side_by_side_are_scattered_as_one_by_one() {
    let mut random = Random::new(2);
    let lobes: Vec<Lobe> = ROUGHNESSES
        .into_iter()
        .flat_map(|roughness| variants(roughness).into_iter().map(|(_, lobe)| Lobe::Principled(lobe)))
        .collect();
    let lacquer = ROUGHNESSES.map(|roughness| {
        let principled =
            Principled { roughness, clearcoat: 0.9, clearcoat_roughness: 0.2, ..Principled::PLAIN };
        Lobe::Lacquered(Lacquered { principled, clearcoat_normal: random.direction() })
    });
    let lobes: Vec<Lobe> = lobes.into_iter().chain(lacquer).collect();
    let hits: Vec<(Incidence, [f32; 4], DVec3)> = (0..lobes.len())
        .map(|index| {
            let normal = random.direction();
            let shading_normal = (normal + 0.5 * random.in_cube()).normalize();
            let incidence = Incidence::new(random.direction(), normal, shading_normal, 1.3);
            (incidence, numbers(index as u32), random.direction())
        })
        .collect();
    let mut sorted = SortedHits::default();
    for (lobe, (incidence, u, _)) in lobes.iter().zip(&hits) {
        sorted.push(lobe, incidence, *u);
    }
    let mut count = 0;
    sorted.scatter(
        |number| hits[number].2,
        |number, bounce, response| {
            let (incidence, u, out) = &hits[number];
            let alone = lobes[number].sample(incidence, *u);
            let towards = lobes[number].evaluate(incidence, *out);
            assert_eq!((alone.direction, alone.density), (bounce.direction, bounce.density), "{number}");
            assert_eq!((alone.weight, alone.crosses), (bounce.weight, bounce.crosses), "{number}");
            assert_eq!((towards.bsdf, towards.density), (response.bsdf, response.density), "{number}");
            count += 1;
        },
    );
    assert_eq!(count, lobes.len());
}

#[test]
fn lobes_of_single_directions_say_so() {
    let smooth = |lobe: Principled| Principled { roughness: 0.0, ..lobe }.is_specular();
    assert!(smooth(METAL) && smooth(GLASS));
    assert!(!smooth(Principled::PLAIN) && !METAL.is_specular() && !GLASS.is_specular());
    assert!(!smooth(Principled { clearcoat: 1.0, clearcoat_roughness: 0.2, ..METAL }));
    assert!(smooth(Principled { clearcoat: 1.0, ..METAL }));
    assert_eq!((GLASS.ior(), METAL.ior()), (Some(1.5), None));
    let pane = Principled { is_thin: true, ..GLASS };
    assert!(pane.ior().is_none() && pane.transmits() && GLASS.transmits() && !METAL.transmits());
}
