//! Work: some samples of some pixels, one tile's share of a pass.

use super::edge_pixels::EdgePixels;
use super::path::Gathers;

/// Some samples of the pixels of a tile.
#[derive(Clone, Copy)]
pub struct Work<'a> {
    /// First column and row.
    pub origin: (usize, usize),
    /// Columns and rows.
    pub size: (usize, usize),
    /// Columns and rows that are taken.
    pub lattice: Lattice,
    /// First sample.
    pub first_sample: u32,
    /// Samples per pixel.
    pub samples: u32,
    /// Light that the paths gather, and the pixels in which they do.
    pub share: Share<'a>,
}

/// Columns, or rows, that are taken: the first `run` of every `every`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lattice {
    /// Neighbours that are taken.
    pub run: usize,
    /// From the first of them to the first of the next, at least `run`.
    pub every: usize,
}

impl Lattice {
    /// All of them.
    pub const ALL: Self = Self { run: 1, every: 1 };

    /// Number of the first `extent` that are taken.
    pub fn count(self, extent: usize) -> usize {
        extent / self.every * self.run + (extent % self.every).min(self.run)
    }

    /// The place of the taken one with this number.
    fn place(self, number: usize) -> usize {
        number / self.run * self.every + number % self.run
    }
}

/// Light that a piece of work gathers, and the pixels in which it does.
#[derive(Clone, Copy)]
pub enum Share<'a> {
    /// All light; in pixels at the edges of lamps, all but what the camera sees of lamps.
    Whole(&'a EdgePixels),
    /// Lamps as the camera sees them, in pixels at their edges.
    Edges(&'a EdgePixels),
    /// All but that, in the same pixels.
    Beyond(&'a EdgePixels),
    /// Lamps as the camera sees them, in all pixels.
    Lamps,
}

impl Work<'_> {
    /// Camera paths in all.
    pub fn paths(&self) -> u32 {
        let pixels = match self.share {
            Share::Edges(edges) | Share::Beyond(edges) => edges.numbers().len(),
            Share::Whole(_) | Share::Lamps => self.size.0 * self.size.1,
        };
        pixels as u32 * self.samples
    }

    /// Image column and row of path `index`, and what it gathers.
    pub fn path(&self, index: u32) -> ((usize, usize), Gathers) {
        let number = index / self.samples;
        let (pixel, gathers) = match self.share {
            Share::Whole(edges) if edges.holds(number) => (number, Gathers::Beyond),
            Share::Whole(_) => (number, Gathers::All),
            Share::Edges(edges) => (edges.numbers()[number as usize], Gathers::Lamps),
            Share::Beyond(edges) => (edges.numbers()[number as usize], Gathers::Beyond),
            Share::Lamps => (number, Gathers::Lamps),
        };
        let (column, row) = (pixel as usize % self.size.0, pixel as usize / self.size.0);
        let place = |number| self.lattice.place(number);
        ((self.origin.0 + place(column), self.origin.1 + place(row)), gathers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_takes_runs_at_even_distances() {
        let lattice = Lattice { run: 2, every: 5 };
        let places: Vec<usize> = (0..lattice.count(12)).map(|number| lattice.place(number)).collect();
        assert_eq!(places, [0, 1, 5, 6, 10, 11]);
        assert_eq!(lattice.count(11), 5);
        assert_eq!((Lattice::ALL.count(7), Lattice::ALL.place(3)), (7, 3));
    }
}
