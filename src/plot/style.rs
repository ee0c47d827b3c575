//! Styles of curves.

/// An sRGB colour as SVG writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color(pub &'static str);

/// The palette of M. Okabe and K. Ito, "Color Universal Design" (2008), without its yellow, which white drowns.
impl Color {
    /// Black.
    pub const BLACK: Color = Color("#000000");
    /// Blue.
    pub const BLUE: Color = Color("#0072B2");
    /// Vermilion.
    pub const VERMILION: Color = Color("#D55E00");
    /// Bluish green.
    pub const GREEN: Color = Color("#009E73");
    /// Reddish purple.
    pub const PURPLE: Color = Color("#CC79A7");
    /// Orange.
    pub const ORANGE: Color = Color("#E69F00");
    /// Sky blue.
    pub const SKY: Color = Color("#56B4E9");
    /// Wine, of P. Tol's muted palette, "Colour Schemes" (2021).
    pub const WINE: Color = Color("#882255");
    /// Grey for what is not a curve: not of the palette.
    pub const GREY: Color = Color("#666666");
    /// Grey to lie under curves.
    pub const PALE: Color = Color("#D9D9D9");
}

/// The shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// Disc.
    Circle,
    /// Square.
    Square,
    /// Triangle that points up.
    Triangle,
    /// Square on its corner.
    Diamond,
    /// Triangle that points down.
    TriangleDown,
    /// Upright cross.
    Plus,
    /// Diagonal cross.
    Cross,
}

/// Style in which a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Of line, markers and area.
    pub color: Color,
    /// Line width in points; 0 for none.
    pub width: f64,
    /// True if the line is broken.
    pub dashed: bool,
    /// True if the area within the curve is filled.
    pub filled: bool,
    /// At every point of the curve.
    pub marker: Option<Marker>,
}

impl Style {
    /// A solid line.
    pub const fn line(color: Color, width: f64) -> Self {
        Self { color, width, dashed: false, filled: false, marker: None }
    }

    /// A broken line.
    pub const fn dashed(color: Color, width: f64) -> Self {
        Self { dashed: true, ..Self::line(color, width) }
    }

    /// A filled area.
    pub const fn area(color: Color) -> Self {
        Self { filled: true, ..Self::line(color, 0.0) }
    }

    /// A line with markers, unlike any other among the first 56.
    pub fn nth(index: usize) -> Self {
        const COLORS: [Color; 8] = [
            Color::BLUE,
            Color::VERMILION,
            Color::GREEN,
            Color::PURPLE,
            Color::ORANGE,
            Color::SKY,
            Color::WINE,
            Color::BLACK,
        ];
        const MARKERS: [Marker; 7] = [
            Marker::Circle,
            Marker::Square,
            Marker::Triangle,
            Marker::Diamond,
            Marker::TriangleDown,
            Marker::Plus,
            Marker::Cross,
        ];
        let dashed = (index / COLORS.len()) % 2 == 1;
        let marker = Some(MARKERS[index % MARKERS.len()]);
        Self { dashed, marker, ..Self::line(COLORS[index % COLORS.len()], 2.0) }
    }
}
