//! Directions of light from infinity, by luminance.

use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

use glam::{DMat3, DVec3, Vec3};

use super::emitter::luminance;
use super::sky_tiles::{SkyTile, SkyTiles};
use crate::math::frame::tangents;
use crate::math::rescale::rescale;
use crate::shade::{Environment, LatLong, SunDisk};

/// The luminance of a latitude-longitude picture as a distribution of directions, and the disk of a sun before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    sun: Option<SunDisk>,
    width: usize,
    height: usize,
    /// World direction → image direction.
    from_world: DMat3,
    /// Per row: the probability of all rows before it; then 1.
    rows: Vec<f64>,
    /// Per row, per column: the probability within the row of all columns before it; then 1.
    columns: Vec<f64>,
    /// Made when they are first asked for.
    tiles: OnceLock<SkyTiles>,
}

/// A direction drawn from a sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkySample {
    /// Unit direction, world.
    pub direction: DVec3,
    /// Its density in solid angle.
    pub density: f64,
    /// A number in [0, 1) for use again.
    pub left: f64,
}

/// Digits of a number that a direction takes, as their count; the rest is as random as they are.
const DIGITS: f64 = (1u64 << 26) as f64;
/// Probability with which the disk of a sun is chosen: in its shadow, all light is the sky's.
const SUN_SHARE: f64 = 0.5;
/// Rows of the picture by which directions of a clear sky are drawn.
const ROWS: usize = 128;
/// Index of the tile that the disk is.
const SUN_TILE: u32 = u32::MAX;

impl Sky {
    /// The distribution of light from infinity; `None` where it varies so little, if at all, that chance finds it as well.
    pub fn of(environment: &Environment) -> Option<Self> {
        match environment {
            Environment::Black | Environment::Constant(_) | Environment::Gradient { .. } => None,
            Environment::Image(image) => Self::new(image),
            Environment::SunSky(sky) => {
                let mut picture = coarse_picture(|direction| sky.around_sun(direction));
                if sky.disk().is_some() && picture.pixels.iter().all(|pixel| *pixel == Vec3::ZERO) {
                    // No air, no ground: the sun alone.
                    picture.pixels.fill(Vec3::ONE);
                }
                Some(Self { sun: sky.disk(), ..Self::new(&picture)? })
            }
        }
    }

    /// The distribution of `image`; `None` if it is black.
    pub fn new(image: &LatLong) -> Option<Self> {
        let (width, height) = (image.width, image.height);
        // Look-up is bilinear, so that a pixel shines into its neighbours.
        let brightness = |x: usize, y: usize| {
            let above = y.saturating_sub(1)..=(y + 1).min(height - 1);
            let around = [(x + width - 1) % width, x, (x + 1) % width];
            let pixels = above.flat_map(|y| around.map(|x| luminance(image.pixels[y * width + x])));
            pixels.sum::<f64>() / 9.0
        };
        let mut columns = Vec::with_capacity((width + 1) * height);
        let mut sums = Vec::with_capacity(height);
        for y in 0..height {
            let row: Vec<f64> = (0..width).map(|x| brightness(x, y)).collect();
            let sum = cumulate(&row, &mut columns);
            sums.push(sum * libm::sin(PI * (y as f64 + 0.5) / height as f64));
        }
        let mut rows = Vec::with_capacity(height + 1);
        let total = cumulate(&sums, &mut rows);
        let is_usable = total > 0.0 && total.is_finite();
        is_usable.then_some(Self {
            sun: None,
            width,
            height,
            from_world: image.from_world,
            rows,
            columns,
            tiles: OnceLock::new(),
        })
    }

    /// A direction, from two numbers in [0, 1).
    pub fn sample(&self, u: f64, v: f64) -> Option<SkySample> {
        let digits = (v * DIGITS).fract();
        let Some(sun) = &self.sun else {
            let (direction, density) = self.sample_picture(u, v)?;
            return Some(SkySample { direction, density, left: digits });
        };
        // Where the disk is hit matters less than by which way it is reached.
        let (direction, left) = if v < SUN_SHARE {
            (sun.direction(u, digits), rescale(v, 0.0, SUN_SHARE))
        } else {
            (self.sample_picture(u, rescale(v, SUN_SHARE, 1.0 - SUN_SHARE))?.0, digits)
        };
        Some(SkySample { direction, density: self.density(direction), left })
    }

    /// A unit direction, world, and its density in solid angle, from two numbers in [0, 1).
    fn sample_picture(&self, u: f64, v: f64) -> Option<(DVec3, f64)> {
        let (row, y) = find(&self.rows, v);
        let (column, x) = find(self.row(row), u);
        let longitude = TAU * ((column as f64 + x) / self.width as f64 - 0.5);
        let (sin, cos) = libm::sincos(PI * (row as f64 + y) / self.height as f64);
        let direction = DVec3::new(sin * libm::sin(longitude), cos, -sin * libm::cos(longitude));
        let density = self.texel_density(row, column, sin);
        (density > 0.0 && density.is_finite()).then(|| (self.from_world.transpose() * direction, density))
    }

    /// Density in solid angle of a unit direction, world.
    pub fn density(&self, direction: DVec3) -> f64 {
        let (row, column, sin) = self.texel(direction);
        let of_picture = if sin > 0.0 { self.texel_density(row, column, sin) } else { 0.0 };
        match &self.sun {
            None => of_picture,
            Some(sun) => {
                let of_sun = if sun.covers(direction) { 1.0 / sun.solid_angle() } else { 0.0 };
                SUN_SHARE * of_sun + (1.0 - SUN_SHARE) * of_picture
            }
        }
    }

    /// The tile that a number in [0, 1) chooses, with its index, in the world, and what is left of the number.
    pub fn choose_tile(&self, u: f64) -> Option<(u32, SkyTile, f64)> {
        let u = match &self.sun {
            None => u,
            Some(sun) if u < SUN_SHARE => return Some((SUN_TILE, sun_tile(sun), rescale(u, 0.0, SUN_SHARE))),
            Some(_) => rescale(u, SUN_SHARE, 1.0 - SUN_SHARE),
        };
        let (index, tile, left) = self.tiles().choose(u)?;
        Some((index, self.in_world(tile), left))
    }

    /// The tile that holds a unit direction of the world, with its index, in the world: the disk before what is behind it.
    pub fn tile_of(&self, direction: DVec3) -> (u32, SkyTile) {
        if let Some(sun) = self.sun.as_ref().filter(|sun| sun.covers(direction)) {
            return (SUN_TILE, sun_tile(sun));
        }
        let (row, column, _) = self.texel(direction);
        let (index, tile) = self.tiles().of(row, column);
        (index, self.in_world(tile))
    }

    fn in_world(&self, tile: &SkyTile) -> SkyTile {
        let to_world = self.from_world.transpose();
        SkyTile {
            middle: to_world * tile.middle,
            half_axes: tile.half_axes.map(|axis| to_world * axis),
            pmf: if self.sun.is_some() { (1.0 - SUN_SHARE) * tile.pmf } else { tile.pmf },
        }
    }

    fn tiles(&self) -> &SkyTiles {
        self.tiles.get_or_init(|| {
            SkyTiles::new((self.width, self.height), |[top, bottom], [left, right]| {
                let row = |row: usize| {
                    let columns = self.row(row);
                    (self.rows[row + 1] - self.rows[row]) * (columns[right] - columns[left])
                };
                (top..bottom).map(row).sum()
            })
        })
    }

    /// Row and column of a unit direction of the world, and the sine of its angle to the picture's poles.
    fn texel(&self, direction: DVec3) -> (usize, usize, f64) {
        let d = self.from_world * direction;
        let u = 0.5 + libm::atan2(d.x, -d.z) / TAU;
        let v = libm::acos(d.y.clamp(-1.0, 1.0)) / PI;
        let column = ((u * self.width as f64) as usize).min(self.width - 1);
        let row = ((v * self.height as f64) as usize).min(self.height - 1);
        (row, column, (1.0 - d.y * d.y).max(0.0).sqrt())
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.columns[row * (self.width + 1)..(row + 1) * (self.width + 1)]
    }

    fn texel_density(&self, row: usize, column: usize, sin: f64) -> f64 {
        let columns = self.row(row);
        let share = (self.rows[row + 1] - self.rows[row]) * (columns[column + 1] - columns[column]);
        share * (self.width * self.height) as f64 / (TAU * PI * sin)
    }
}

/// A picture of what is in each direction, by its middle.
fn coarse_picture(radiance: impl Fn(DVec3) -> Vec3) -> LatLong {
    let (width, height) = (2 * ROWS, ROWS);
    let pixel = |index: usize| {
        let [x, y] = [index % width, index / width].map(|place| place as f64 + 0.5);
        let (sin, cos) = libm::sincos(PI * y / height as f64);
        let (across, along) = libm::sincos(TAU * (x / width as f64 - 0.5));
        radiance(DVec3::new(sin * across, cos, -sin * along))
    };
    let pixels = (0..width * height).map(pixel).collect();
    LatLong { width, height, pixels, from_world: DMat3::IDENTITY }
}

/// The disk as a tile.
fn sun_tile(sun: &SunDisk) -> SkyTile {
    let (x, y) = tangents(sun.middle);
    SkyTile { middle: sun.middle, half_axes: [x, y].map(|axis| sun.radius * axis), pmf: SUN_SHARE }
}

/// Appends the cumulative distribution of `weights` to `out`, even if all are 0; gives their sum.
fn cumulate(weights: &[f64], out: &mut Vec<f64>) -> f64 {
    let sum: f64 = weights.iter().sum();
    let mut below = 0.0;
    out.push(0.0);
    for (index, weight) in weights.iter().enumerate() {
        below += weight;
        let even = (index + 1) as f64 / weights.len() as f64;
        out.push(if index + 1 == weights.len() {
            1.0
        } else if sum > 0.0 {
            below / sum
        } else {
            even
        });
    }
    sum
}

/// The interval of a cumulative distribution in which `u` falls, and how far in.
fn find(cumulative: &[f64], u: f64) -> (usize, f64) {
    let after = cumulative.partition_point(|&below| below <= u).clamp(1, cumulative.len() - 1);
    let (low, high) = (cumulative[after - 1], cumulative[after]);
    (after - 1, if high > low { ((u - low) / (high - low)).min(1.0) } else { 0.5 })
}
