//! Pixels of a window that see edges of lamps.

/// A set of pixels, by their numbers in a window of the picture, row by row.
#[derive(Clone, Debug, Default)]
pub struct EdgePixels {
    /// The numbers, ascending.
    numbers: Vec<u32>,
    /// Membership of each pixel of the window; empty if no pixel is in the set.
    marks: Vec<bool>,
}

impl EdgePixels {
    /// The pixels that are marked, of all in the window.
    pub fn marked(marks: Vec<bool>) -> Self {
        let numbers: Vec<u32> =
            (0..).zip(&marks).filter(|(_, mark)| **mark).map(|(number, _)| number).collect();
        Self { marks: if numbers.is_empty() { Vec::new() } else { marks }, numbers }
    }

    /// The pixels' numbers, ascending.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// Membership of the pixel `number`.
    #[inline]
    pub fn holds(&self, number: u32) -> bool {
        self.marks.get(number as usize).is_some_and(|mark| *mark)
    }
}
