//! A clear sky with the sun in it, over a plain.
//!
//! Sunlight is scattered once by air and aerosols (Nishita et al. 1993, see [`atmosphere`]). Radiance is in W m⁻² sr⁻¹ as the
//! eye weighs it, luminance over 683 lm/W: outside the atmosphere, the sun brings 184. The model is that of Blender's sky
//! texture with "Single Scattering", so that scenes may keep their strength.

mod atmosphere;
mod disk;
mod spectrum;

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::math::quadrature::gauss_legendre;
use atmosphere::{Atmosphere, aerosol_phase, air_phase};
pub use disk::SunDisk;

/// A sky, as it is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearSky {
    /// Angle of the sun above the horizon, radians, −π/2 to π/2.
    pub elevation: f64,
    /// Angle of the sun from −Z towards +X, radians.
    pub azimuth: f64,
    /// Amounts of air, aerosols and ozone, relative to a clear day's.
    pub amounts: DVec3,
    /// Reflectance of the ground.
    pub ground: Vec3,
    /// Angular diameter of the sun's disk, radians; `None` without one.
    pub disk: Option<f64>,
    /// Factor on the radiance of the disk.
    pub disk_strength: f32,
    /// Factor on all radiance.
    pub strength: f32,
}

/// The sky of a clear day.
#[derive(Clone, Debug, PartialEq)]
pub struct SunSky {
    /// What it was made from.
    pub clear_sky: ClearSky,
    /// Unit vector to the sun.
    towards_sun: DVec3,
    /// What air and aerosols scatter over their phase functions, in [`ROWS`] from the horizon up of [`COLUMNS`] from the
    /// sun's azimuth away.
    dome: Vec<[Vec3; 2]>,
    /// Radiance of the ground.
    ground: Vec3,
    /// The sun's disk, if it has one that is not all below the horizon.
    disk: Option<SunDisk>,
}

/// Rows and columns of the dome: angles above the horizon are squares of even steps.
const ROWS: usize = 64;
const COLUMNS: usize = 33;

impl SunSky {
    /// Follows the sunlight through the atmosphere.
    pub fn new(clear_sky: ClearSky) -> Self {
        let ClearSky { elevation, azimuth, amounts, ground, disk, disk_strength, strength } = clear_sky;
        let atmosphere = Atmosphere::new(amounts);
        let towards_sun = direction(elevation, azimuth);
        let sun = direction(elevation, 0.0);
        let node = |index: usize| {
            let height = (index / COLUMNS) as f64 / (ROWS - 1) as f64;
            let away = PI * (index % COLUMNS) as f64 / (COLUMNS - 1) as f64;
            let parts = atmosphere.scattered(direction(FRAC_PI_2 * height * height, away), sun);
            parts.map(|part| strength * part.as_vec3())
        };
        let dome = (0..ROWS * COLUMNS).into_par_iter().map(node).collect();
        // Of a sun that is setting, the light of the horizon.
        let sunlight = atmosphere.sunlight(direction(elevation.max(0.0), 0.0)).as_vec3().max(Vec3::ZERO);
        let lit = disk.filter(|diameter| elevation + 0.5 * diameter > 0.0);
        let disk = lit
            .map(|diameter| SunDisk::new(towards_sun, 0.5 * diameter, sunlight * (strength * disk_strength)))
            .filter(|disk| disk.radiance != Vec3::ZERO);
        let mut sky = Self { clear_sky, towards_sun, dome, ground: Vec3::ZERO, disk };
        let direct = disk.map_or(Vec3::ZERO, |disk| disk.irradiance());
        let irradiance = sky.irradiance() + direct * towards_sun.y.max(0.0) as f32;
        sky.ground = ground * irradiance / std::f32::consts::PI;
        sky
    }

    /// Radiance seen when looking along a unit direction.
    pub fn radiance(&self, direction: DVec3) -> Vec3 {
        let is_sun = |disk: &SunDisk| direction.y >= 0.0 && disk.covers(direction);
        let disk = self.disk.filter(is_sun).map_or(Vec3::ZERO, |disk| disk.radiance);
        disk + self.around_sun(direction)
    }

    /// Radiance without that of the sun's disk.
    pub fn around_sun(&self, direction: DVec3) -> Vec3 {
        if direction.y < 0.0 { self.ground } else { self.scattered(direction) }
    }

    /// The sun's disk, if there is one in the sky.
    pub fn disk(&self) -> Option<SunDisk> {
        self.disk
    }

    /// True if no light comes from it.
    pub fn is_black(&self) -> bool {
        let is_dark = self.dome.iter().flatten().all(|part| *part == Vec3::ZERO);
        is_dark && self.ground == Vec3::ZERO && self.disk.is_none()
    }

    /// Memory of the dome, bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.dome.as_slice())
    }

    /// Radiance of scattered light from a direction that does not point down.
    fn scattered(&self, direction: DVec3) -> Vec3 {
        let sun = self.towards_sun;
        let (across, along) =
            (direction.x * sun.z - direction.z * sun.x, direction.x * sun.x + direction.z * sun.z);
        let away = libm::atan2(across.abs(), along) / PI * (COLUMNS - 1) as f64;
        let height = (libm::asin(direction.y.min(1.0)) / FRAC_PI_2).sqrt() * (ROWS - 1) as f64;
        let (row, column) = ((height as usize).min(ROWS - 2), (away as usize).min(COLUMNS - 2));
        let (up, out) = ((height - row as f64) as f32, (away - column as f64) as f32);
        let node = |row: usize, column: usize| &self.dome[row * COLUMNS + column];
        let part = |part: usize| {
            let across = |row: usize| node(row, column)[part].lerp(node(row, column + 1)[part], out);
            across(row).lerp(across(row + 1), up)
        };
        let cos = direction.dot(sun);
        let light = part(0) * air_phase(cos) as f32 + part(1) * aerosol_phase(cos) as f32;
        // Some blues are beyond what Rec. 709 has.
        light.max(Vec3::ZERO)
    }

    /// Irradiance of the ground by scattered light.
    fn irradiance(&self) -> Vec3 {
        let rule = gauss_legendre(64);
        let mut sum = Vec3::ZERO;
        for &(x, weight) in &rule {
            // By the square of the sine of the elevation, as that is the measure of the projected solid angle.
            let sin2 = 0.5 + 0.5 * x;
            let elevation = libm::asin(sin2.sqrt());
            for &(y, share) in &rule {
                let azimuth = self.clear_sky.azimuth + 0.5 * PI * (1.0 + y);
                let radiance = self.scattered(direction(elevation, azimuth));
                sum += radiance * (0.25 * PI * weight * share) as f32;
            }
        }
        sum
    }
}

/// The unit vector at angles above the horizon and from −Z towards +X.
fn direction(elevation: f64, azimuth: f64) -> DVec3 {
    let ((up, out), (x, z)) = (libm::sincos(elevation), libm::sincos(azimuth));
    DVec3::new(out * x, up, -out * z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clear_sky(elevation: f64, amounts: [f64; 3]) -> ClearSky {
        ClearSky {
            elevation: elevation.to_radians(),
            azimuth: 0.0,
            amounts: amounts.into(),
            ground: Vec3::splat(0.3),
            disk: Some(0.545f64.to_radians()),
            disk_strength: 1.0,
            strength: 1.0,
        }
    }

    /// Largest relative error of a channel; one that is dark beside the others may be off by as much as these.
    fn off(got: Vec3, expected: Vec3) -> f32 {
        let scale = expected + 0.02 * expected.max_element() + 2e-3;
        ((got - expected).abs() / scale).max_element()
    }

    /// Radiances by an evaluation of its own of Nishita's equation 7 in Python, in 300 × 600 steps: elevation and azimuth of a
    /// direction, degrees, and its colour.
    type Rows = [([f64; 2], [f32; 3]); 5];
    const REFERENCE: [(f64, [f64; 3], Rows); 5] = [
        (
            60.0,
            [1.0, 1.0, 1.0],
            [
                ([0.5, 10.0], [7.76402, 7.57271, 7.20788]),
                ([5.0, 150.0], [4.33679, 5.78761, 7.00171]),
                ([20.0, 60.0], [2.30456, 3.37588, 5.40762]),
                ([45.0, 180.0], [0.908354, 1.43578, 2.6017]),
                ([80.0, 30.0], [3.36638, 3.70675, 4.97253]),
            ],
        ),
        (
            15.0,
            [1.0, 1.0, 1.0],
            [
                ([0.5, 10.0], [69.8738, 46.8653, 22.4598]),
                ([5.0, 150.0], [5.13404, 6.58221, 6.53695]),
                ([20.0, 60.0], [1.93125, 2.76856, 3.90427]),
                ([45.0, 180.0], [0.824564, 1.33429, 2.20343]),
                ([80.0, 30.0], [0.620917, 0.963499, 1.59363]),
            ],
        ),
        (
            15.0,
            [1.5, 4.0, 2.0],
            [
                ([0.5, 10.0], [53.57, 35.1597, 15.5311]),
                ([5.0, 150.0], [2.85553, 3.18319, 2.48848]),
                ([20.0, 60.0], [2.34425, 2.91491, 3.33192]),
                ([45.0, 180.0], [0.91785, 1.45418, 2.1956]),
                ([80.0, 30.0], [0.802857, 1.15771, 1.71964]),
            ],
        ),
        (
            2.0,
            [1.0, 1.0, 1.0],
            [
                ([0.5, 10.0], [36.9662, 12.743, 0.271234]),
                ([5.0, 150.0], [2.24662, 1.97557, 0.875777]),
                ([20.0, 60.0], [0.824704, 1.01792, 1.06441]),
                ([45.0, 180.0], [0.458924, 0.638552, 0.798681]),
                ([80.0, 30.0], [0.250083, 0.346296, 0.45154]),
            ],
        ),
        (
            -4.0,
            [1.0, 1.0, 1.0],
            [
                ([0.5, 10.0], [0.120098, 0.032368, 0.0]),
                ([5.0, 150.0], [0.000003, 0.0, 0.0]),
                ([20.0, 60.0], [0.027245, 0.033181, 0.045678]),
                ([45.0, 180.0], [0.011028, 0.013348, 0.020509]),
                ([80.0, 30.0], [0.007324, 0.009595, 0.015978]),
            ],
        ),
    ];

    #[test]
    fn scattered_light_is_that_of_the_published_equations() {
        let mut worst = 0.0f32;
        for (elevation, amounts, rows) in REFERENCE {
            let sky = SunSky::new(clear_sky(elevation, amounts));
            for ([up, away], expected) in rows {
                for away in [away, -away] {
                    let got = sky.around_sun(direction(up.to_radians(), away.to_radians()));
                    let expected = Vec3::from(expected);
                    let error = off(got, expected);
                    worst = worst.max(error);
                    assert!(error < 0.015, "{elevation} {up} {away}: {got} is not {expected}");
                }
            }
        }
        println!("worst {worst}");
    }

    #[test]
    fn the_disk_brings_what_the_air_leaves_of_sunlight() {
        let outside = Vec3::new(204.233, 179.153, 166.728);
        for (elevation, amounts, expected) in [
            (60.0, [1.0; 3], [178.529, 150.152, 123.145]),
            (15.0, [1.0; 3], [131.99, 99.8968, 61.3726]),
            (15.0, [1.5, 4.0, 2.0], [76.8772, 54.9273, 28.9371]),
            (2.0, [1.0; 3], [26.0788, 9.63276, 0.464859]),
            (30.0, [0.0; 3], outside.to_array()),
        ] {
            for size in [0.545, 20.0] {
                let asked = ClearSky { disk: Some(f64::to_radians(size)), ..clear_sky(elevation, amounts) };
                let sky = SunSky::new(asked);
                let disk = sky.disk().expect("a disk");
                let solid_angle = 2.0 * PI * (1.0 - (0.5 * size).to_radians().cos());
                assert!((disk.solid_angle() / solid_angle - 1.0).abs() < 1e-9, "{size}");
                let projected = PI * (0.5 * size).to_radians().sin().powi(2);
                let irradiance = disk.radiance * projected as f32;
                assert!(
                    off(irradiance, expected.into()) < 6e-3,
                    "{elevation} {size}: {irradiance} is not {expected:?}"
                );
                let behind = sky.around_sun(disk.middle);
                assert_eq!(sky.radiance(disk.middle), behind + disk.radiance);
            }
        }
    }

    #[test]
    fn the_sun_sets_behind_the_ground_and_strengths_and_azimuth_do_what_they_say() {
        let of = |change: &dyn Fn(&mut ClearSky)| {
            let mut asked = clear_sky(15.0, [1.0; 3]);
            change(&mut asked);
            SunSky::new(asked)
        };
        let plain = of(&|_| ());
        let at = |up: f64, away: f64| direction(up.to_radians(), away.to_radians());
        assert!(plain.disk().unwrap().middle.distance(DVec3::new(0.0, 0.258819, -0.965926)) < 1e-6);
        let turned = of(&|sky| sky.azimuth = 90f64.to_radians());
        assert!(turned.disk().unwrap().middle.distance(DVec3::new(0.965926, 0.258819, 0.0)) < 1e-6);
        assert!(turned.radiance(at(30.0, 130.0)).abs_diff_eq(plain.radiance(at(30.0, 40.0)), 1e-4));
        let strong = of(&|sky| sky.strength = 2.0);
        for direction in [at(15.0, 0.0), at(40.0, 70.0), at(-40.0, 0.0)] {
            let ratio = strong.radiance(direction) / plain.radiance(direction);
            assert!(ratio.abs_diff_eq(Vec3::splat(2.0), 1e-5), "{ratio}");
        }
        let bright = of(&|sky| sky.disk_strength = 3.0);
        assert_eq!(bright.radiance(at(40.0, 70.0)), plain.radiance(at(40.0, 70.0)));
        let disks = [&bright, &plain].map(|sky| sky.disk().unwrap().radiance);
        assert!((disks[0] / disks[1]).abs_diff_eq(Vec3::splat(3.0), 1e-5));
        let setting = of(&|sky| sky.elevation = -0.1f64.to_radians());
        let seen = [0.1, -0.2].map(|up| setting.radiance(at(up, 0.0)) - setting.around_sun(at(up, 0.0)));
        assert!(seen[0].x > 1000.0 && seen[1] == Vec3::ZERO, "{seen:?}");
        assert!(of(&|sky| sky.elevation = -0.3f64.to_radians()).disk().is_none());
        assert!(of(&|sky| sky.disk = None).radiance(at(15.0, 0.0)).max_element() < 100.0);
        let night = of(&|sky| sky.elevation = -FRAC_PI_2);
        assert_eq!(night.radiance(at(40.0, 0.0)), Vec3::ZERO);
        assert!(night.dome.iter().flatten().all(|part| part.is_finite()));
        assert!(of(&|sky| sky.strength = 0.0).is_black() && !plain.is_black());
    }

    #[test]
    fn the_ground_is_as_bright_as_its_albedo_makes_the_light_that_falls_on_it() {
        let sky = SunSky::new(clear_sky(35.0, [1.0; 3]));
        let (rows, columns) = (400, 400);
        let mut irradiance = Vec3::ZERO;
        for index in 0..rows * columns {
            let up = FRAC_PI_2 * ((index / columns) as f64 + 0.5) / rows as f64;
            let away = 2.0 * PI * ((index % columns) as f64 + 0.5) / columns as f64;
            let measure = up.sin() * up.cos() * FRAC_PI_2 * 2.0 * PI / (rows * columns) as f64;
            irradiance += sky.around_sun(direction(up, away)) * measure as f32;
        }
        let disk = sky.disk().unwrap();
        irradiance += disk.irradiance() * 35f64.to_radians().sin() as f32;
        let ratio = sky.radiance(DVec3::NEG_Y) * std::f32::consts::PI / (0.3 * irradiance);
        assert!(ratio.abs_diff_eq(Vec3::ONE, 2e-3), "{ratio}");
    }
}
