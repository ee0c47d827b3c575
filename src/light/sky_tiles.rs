//! Tiles of a sky: parts of a picture at infinity of about the same importance, each about a direction.
//!
//! Where no formula joins a place to a direction at infinity, a tile is a light like others: it is chosen by its power, and
//! rays that leave in about its direction and end on it bring light.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::math::rescale::rescale;

/// Tiles of a latitude-longitude picture.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyTiles {
    nodes: Vec<TileNode>,
    tiles: Vec<SkyTile>,
    /// Probability of all tiles before each; then 1.
    cumulative: Vec<f64>,
}

/// A part of the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyTile {
    /// Unit direction to its middle, of the picture.
    pub middle: DVec3,
    /// Half of its width and of its height, radians, as vectors across the middle.
    pub half_axes: [DVec3; 2],
    /// Probability with which it is chosen.
    pub pmf: f64,
}

/// TileNode of the binary tree of parts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum TileNode {
    /// Texels below a row or a column, and those from it on, are in these nodes.
    Split { by_rows: bool, at: u32, parts: [u32; 2] },
    /// Number of a tile.
    Tile(u32),
}

/// Texels of a part: from the first row and column to beyond the last.
#[derive(Clone, Copy)]
struct SkyPart {
    rows: [usize; 2],
    columns: [usize; 2],
    power: f64,
    node: usize,
}

/// Tiles at most.
const MOST: usize = 256;
/// Angular radius that every tile is smaller than, radians: larger regions of directions are not worth while.
const LARGEST: f64 = 0.3;

impl SkyTiles {
    /// Tiles of a picture of this size, given the probability of any rectangle of texels: rows, then columns.
    pub fn new((width, height): (usize, usize), probability: impl Fn([usize; 2], [usize; 2]) -> f64) -> Self {
        let extent = |part: &SkyPart| angles((width, height), part);
        // Light from small parts is hard to find by chance, from large ones by this.
        let urgency = |part: &SkyPart| {
            let [across, down] = extent(part);
            let radius = 0.5 * libm::hypot(across, down);
            let is_single = part.rows[1] - part.rows[0] == 1 && part.columns[1] - part.columns[0] == 1;
            match (is_single, radius > LARGEST) {
                (true, _) => 0.0,
                (false, true) => f64::INFINITY,
                (false, false) => part.power * radius,
            }
        };
        let whole = SkyPart { rows: [0, height], columns: [0, width], power: 1.0, node: 0 };
        let (mut parts, mut nodes) = (vec![whole], vec![TileNode::Tile(0)]);
        loop {
            let (worst, urgent) = parts
                .iter()
                .map(urgency)
                .enumerate()
                .fold((0, 0.0), |worst, next| if next.1 > worst.1 { next } else { worst });
            if urgent == 0.0 || (urgent < f64::INFINITY && parts.len() >= MOST) {
                break;
            }
            let part = parts.swap_remove(worst);
            let [across, down] = extent(&part);
            let tall = part.rows[1] - part.rows[0] > 1;
            let by_rows = tall && (down > across || part.columns[1] - part.columns[0] == 1);
            let [low, high] = if by_rows { part.rows } else { part.columns };
            let at = low.midpoint(high);
            let halves = [[low, at], [at, high]].map(|half| {
                let (rows, columns) = if by_rows { (half, part.columns) } else { (part.rows, half) };
                nodes.push(TileNode::Tile(0));
                SkyPart { rows, columns, power: probability(rows, columns), node: nodes.len() - 1 }
            });
            nodes[part.node] =
                TileNode::Split { by_rows, at: at as u32, parts: halves.map(|half| half.node as u32) };
            parts.extend(halves);
        }
        let mut cumulative = vec![0.0];
        let mut tiles = Vec::with_capacity(parts.len());
        let sum: f64 = parts.iter().map(|part| part.power).sum();
        let mut below = 0.0;
        for part in &parts {
            nodes[part.node] = TileNode::Tile(tiles.len() as u32);
            below += part.power;
            cumulative.push((below / sum).min(1.0));
            tiles.push(tile((width, height), part, part.power / sum));
        }
        Self { nodes, tiles, cumulative }
    }

    /// The tile that a number in [0, 1) chooses by power, with its index, and what is left of the number; `None` if there is
    /// none.
    pub fn choose(&self, u: f64) -> Option<(u32, &SkyTile, f64)> {
        let after = self.cumulative.partition_point(|&below| below <= u).clamp(1, self.tiles.len());
        let (low, high) = (self.cumulative[after - 1], self.cumulative[after]);
        let tile = &self.tiles[after - 1];
        (high > low).then(|| (after as u32 - 1, tile, rescale(u, low, high - low)))
    }

    /// Index of the tile of a texel, and the tile.
    pub fn of(&self, row: usize, column: usize) -> (u32, &SkyTile) {
        let mut node = 0;
        loop {
            match self.nodes[node] {
                TileNode::Tile(index) => return (index, &self.tiles[index as usize]),
                TileNode::Split { by_rows, at, parts: [before, beyond] } => {
                    let is_before = (if by_rows { row } else { column }) < at as usize;
                    node = (if is_before { before } else { beyond }) as usize;
                }
            }
        }
    }
}

/// Angles that a part spans along and across its circle of latitude, radians.
fn angles((width, height): (usize, usize), part: &SkyPart) -> [f64; 2] {
    let [top, bottom] = part.rows.map(|row| PI * row as f64 / height as f64);
    // Where the circles of latitude are longest.
    let widest =
        if top < 0.5 * PI && bottom > 0.5 * PI { 1.0 } else { libm::sin(top).max(libm::sin(bottom)) };
    [TAU * (part.columns[1] - part.columns[0]) as f64 / width as f64 * widest, bottom - top]
}

/// The tile of a part.
fn tile((width, height): (usize, usize), part: &SkyPart, pmf: f64) -> SkyTile {
    let middle = |[low, high]: [usize; 2]| 0.5 * (low as f64 + high as f64);
    let polar = PI * middle(part.rows) / height as f64;
    let longitude = TAU * (middle(part.columns) / width as f64 - 0.5);
    let ((sin, cos), (across, along)) = (libm::sincos(polar), libm::sincos(longitude));
    let middle = DVec3::new(sin * across, cos, -sin * along);
    let east = DVec3::new(along, 0.0, across);
    let [wide, high] = angles((width, height), part).map(|angle| 0.5 * angle);
    SkyTile { middle, half_axes: [wide * east, high * middle.cross(east)], pmf }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tiles of a sky of `width` × `height` texels whose power is even but for a bright texel.
    fn tiles((width, height): (usize, usize), bright: (usize, usize), share: f64) -> SkyTiles {
        SkyTiles::new((width, height), |[top, bottom], [left, right]| {
            let even = ((bottom - top) * (right - left)) as f64 / (width * height) as f64;
            let holds = (top..bottom).contains(&bright.0) && (left..right).contains(&bright.1);
            (1.0 - share) * even + if holds { share } else { 0.0 }
        })
    }

    #[test]
    fn every_texel_is_in_the_tile_that_is_chosen_as_often_as_its_light_says() {
        let size = (64, 32);
        let tiles = tiles(size, (9, 40), 0.5);
        let mut sums = vec![0; tiles.tiles.len()];
        for row in 0..size.1 {
            for column in 0..size.0 {
                sums[tiles.of(row, column).0 as usize] += 1;
            }
        }
        assert!(sums.iter().all(|&texels| texels > 0));
        let sum: f64 = tiles.tiles.iter().map(|tile| tile.pmf).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        let (bright, tile) = tiles.of(9, 40);
        assert!(sums[bright as usize] == 1 && tile.pmf > 0.5, "{} {}", sums[bright as usize], tile.pmf);
        for i in 0..1000 {
            let u = (f64::from(i) + 0.5) / 1000.0;
            let (index, tile, left) = tiles.choose(u).unwrap();
            let below = tiles.cumulative[index as usize];
            assert!((0.0..1.0).contains(&left) && (below + left * tile.pmf - u).abs() < 1e-9, "{u}");
        }
    }

    #[test]
    fn tiles_are_small_and_their_axes_lie_across_their_middles() {
        for size in [(1, 1), (2, 1), (3, 2), (64, 32), (1024, 512)] {
            let tiles = tiles(size, (0, 0), 0.1);
            assert!(tiles.tiles.len() <= MOST || size == (1024, 512), "{}", tiles.tiles.len());
            for tile in &tiles.tiles {
                let [x, y] = tile.half_axes;
                assert!((tile.middle.length() - 1.0).abs() < 1e-12);
                assert!(x.dot(tile.middle).abs() < 1e-12 && y.dot(tile.middle).abs() < 1e-12);
                let texel = 0.5 * libm::hypot(TAU / size.0 as f64, PI / size.1 as f64);
                assert!(libm::hypot(x.length(), y.length()) <= LARGEST.max(texel) + 1e-12, "{tile:?}");
            }
        }
    }
}
