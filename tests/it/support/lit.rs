//! Random scenes with lights, and how pictures of them are compared.

use glam::DVec3;
use warpfront::film::{Aov, Image};
use warpfront::scene::{Baked, LightSampling, SamplerKind};
use warpfront::study::compare::PicturePair;
use warpfront::trace::Run;

use super::{Random, camera, film, hole, obj, scene_with, sphere, vector};

/// What is special about a random scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Twist {
    /// Everything anywhere.
    Nothing,
    /// No hole.
    Flat,
    /// A light straight behind the hole, seen from the middle of the floor.
    Behind,
    /// The hole within a sphere that is a light.
    HoleInLight,
    /// The hole within a glass ball.
    HoleInGlass,
    /// A diffuse sphere close around the horizon.
    NearHorizon,
    /// A disk around the hole that is a light, as gas is.
    Disk,
    /// A light between the middle of the room and the hole, which it nearly touches.
    Close,
}

/// All of them.
pub const TWISTS: [Twist; 8] = [
    Twist::Nothing,
    Twist::Flat,
    Twist::Behind,
    Twist::HoleInLight,
    Twist::HoleInGlass,
    Twist::NearHorizon,
    Twist::Disk,
    Twist::Close,
];

/// `[[entity]]` with an annulus.
pub fn disk(center: DVec3, normal: DVec3, inner: f64, outer: f64, material: &str) -> String {
    format!(
        "[[entity]]\ndisk = {{ center = {}, normal = {}, inner = {inner:?}, outer = {outer:?} }}\n\
         material = \"{material}\"\n",
        vector(center),
        vector(normal)
    )
}

/// A closed room, or one without a ceiling, about 24 wide, with a hole, lights, and other things at random places;
/// `size` is a factor on the lights, which are large enough for rays that nothing aims to find them.
pub fn room(random: &mut Random, twist: Twist, size: f64) -> Baked {
    let r_s = if twist == Twist::Flat { 0.0 } else { random.log_between(0.3, 8.0).max(0.8) };
    let center = 4.0 * random.in_cube();
    let corner = DVec3::splat(12.0) + 3.0 * random.in_cube().abs();
    let mut text = String::new();
    if r_s > 0.0 {
        text += &hole(center, r_s);
    }
    let eye = DVec3::new(9.0, 8.0, 10.0) * (random.in_cube() + 3.0) / 4.0;
    text += &camera(eye, center + 3.0 * random.in_cube(), 85.0);
    text += &film(32, 32);
    text += "[render]\nmax_depth = 5\nroulette_depth = 3\nsampler = \"independent\"\n";
    for name in ["wall", "one", "two", "mirror", "glass"] {
        let colour = 0.45 + 0.35 * random.in_cube().abs();
        let kind = match name {
            "mirror" => "mirror",
            "glass" => "dielectric",
            _ => "diffuse",
        };
        text += &format!(
            "[[material]]\nname = \"{name}\"\nkind = \"{kind}\"\nalbedo = {}\nior = 1.5\n",
            vector(colour)
        )
        .replace("ior = 1.5\n", if kind == "dielectric" { "ior = 1.5\n" } else { "" });
        if name == "one" || name == "two" {
            let sides = if name == "one" { "front" } else { "both" };
            let emission = 1.0 + 2.0 * random.in_cube().abs();
            text += &format!("emission = {}\nemits = \"{sides}\"\n", vector(emission));
        }
    }
    let mut files = Vec::new();
    let ceiling = random.between(0.0, 1.0) < 0.3;
    let walls = super::closed_box(-corner, corner);
    let open: String =
        walls.lines().take(if ceiling { 8 + 8 } else { 8 + 12 }).map(|l| format!("{l}\n")).collect();
    files.push(("room.obj".to_owned(), open));
    text += "[[entity]]\nmesh = \"room.obj\"\nmaterial = \"wall\"\n";
    let side = |random: &mut Random| if random.between(0.0, 1.0) < 0.5 { "one" } else { "two" };
    match twist {
        Twist::Nothing | Twist::Flat => {}
        Twist::Behind => {
            let floor = DVec3::new(0.0, -corner.y, 0.0);
            let light = center + (center - floor).normalize() * (0.4 * r_s + 3.0);
            text += &sphere(light, size * 1.2, "two");
        }
        Twist::HoleInLight => {
            let radius = 0.4 * r_s + 1.5;
            text += &sphere(center + 0.3 * radius * random.in_cube(), radius, "one");
        }
        Twist::HoleInGlass => text += &sphere(center, r_s + 1.0, "glass"),
        Twist::NearHorizon => {
            text += &sphere(center, 0.25 * r_s * random.between(1.02, 2.0), "wall");
        }
        Twist::Disk => text += &disk(center, random.direction(), 0.9 * r_s, 1.2 * r_s + 3.0, "two"),
        Twist::Close => {
            let radius = size * 1.2;
            text += &sphere(center + (0.4 * r_s + radius) * random.direction(), radius, "one");
        }
    }
    let count = 1 + (random.between(0.0, 3.0) as usize);
    for number in 0..count {
        let place = 9.0 * random.in_cube();
        let material = side(random);
        match random.between(0.0, 3.0) as u32 {
            0 => text += &sphere(place, size * random.between(1.0, 2.5), material),
            1 => {
                let inner = random.between(0.0, 1.0);
                text += &disk(place, random.direction(), size * inner, size * (inner + 2.0), material);
            }
            _ => {
                let corners: Vec<DVec3> = (0..4).map(|_| 3.0 * size * random.in_cube()).collect();
                let name = format!("light{number}.obj");
                files.push((name.clone(), obj(&corners, &[[0, 1, 2], [1, 3, 2]])));
                text += &super::mesh(&name, place, material);
            }
        }
    }
    for material in ["mirror", "glass", "wall", "wall"] {
        text += &sphere(9.0 * random.in_cube(), random.between(0.5, 2.5), material);
    }
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    scene_with(&text, &files)
}

/// A picture with variances from independent random numbers.
pub fn picture(scene: &mut Baked, sampling: LightSampling, spp: u32, seed: u64) -> Image {
    let settings = &mut scene.settings;
    (settings.light_sampling, settings.spp, settings.seed) = (sampling, spp, seed);
    settings.sampler = SamplerKind::Independent;
    super::render(scene, &Run { aovs: vec![Aov::Variance], ..Run::default() }).image
}

/// How far two pictures are from each other.
#[derive(Clone, Copy, Debug)]
pub struct Agreement {
    /// Of the mean, the worst of three colours, in standard errors.
    pub z: f64,
    /// Relative standard error of the difference of the means.
    pub error: f64,
    /// Of the whole picture or a block of it, in standard errors.
    pub largest: f64,
    /// Of so large a deviation among all of them, by chance.
    pub probability: f64,
}

impl Agreement {
    /// Of `a` with `b`.
    pub fn of(a: &Image, b: &Image) -> Self {
        let noise = PicturePair::new(("a", a), ("b", b)).unwrap().compare().noise.expect("variances");
        assert_eq!(noise.non_finite, 0);
        let sum = |image: &Image, name: &str| -> f64 {
            image.channel(name).expect(name).iter().map(|&v| f64::from(v)).sum()
        };
        let variance = sum(a, "variance.G") + sum(b, "variance.G");
        let z = noise
            .means
            .iter()
            .flatten()
            .fold(0.0f64, |worst, z| if z.abs() > worst.abs() { *z } else { worst });
        Self {
            z,
            error: variance.sqrt() / sum(b, "G"),
            largest: noise.largest.map_or(0.0, |deviation| deviation.z),
            probability: noise.probability,
        }
    }

    /// Complains about what chance does not explain: three colours and nine blocks are many tests, and so are all
    /// scenes.
    pub fn check(&self, what: &str) {
        println!(
            "{what}: z of the mean {:+.2} at {:.2} %, largest of blocks {:+.2}, probability {:.3}",
            self.z,
            100.0 * self.error,
            self.largest,
            self.probability
        );
        assert!(self.error < 0.05, "{what}: too dark, too noisy: {self:?}");
        assert!(self.z.abs() < 3.5 && self.probability > 1e-3, "{what}: {self:?}");
    }
}

/// Sum of the variances of the green plane's pixels, for one sample each.
pub fn variance(image: &Image, spp: u32) -> f64 {
    image.channel("variance.G").expect("variance.G").iter().map(|&v| f64::from(v) * f64::from(spp)).sum()
}
