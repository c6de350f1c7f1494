//! What a plot shows: axes and series.

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Points joined.
    Line,
    /// Points joined, dashed.
    Dashed,
    /// Points alone.
    Dots,
    /// Points alone, large.
    Points,
    /// Bars from the floor of the plot, one unit wide times the spacing.
    Bars,
    /// A filled outline, see [`Series::band`].
    Band,
}

impl Mark {
    /// How the legend shows it.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::Dashed => "dashed",
            Self::Dots | Self::Points => "dots",
            Self::Bars | Self::Band => "bars",
        }
    }
}

/// One series.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; empty for none.
    pub name: String,
    /// Mark.
    pub mark: Mark,
    /// Colour, 0 to 7.
    pub colour: usize,
    /// Points; one that is not finite breaks the line.
    pub points: Vec<(f64, f64)>,
}

/// What an axis shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// Quantity.
    pub label: String,
    /// Unit; `1` or empty for none.
    pub unit: String,
}

/// A plot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plot {
    /// Title.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Logarithmic vertical axis.
    pub log: bool,
    /// Whether the horizontal axis counts things.
    pub whole: bool,
    /// Words at 1, 2, 3 ... instead of numbers on the horizontal axis.
    pub names: Vec<String>,
    /// Whether zero belongs to the picture.
    pub from_zero: bool,
    /// Series.
    pub series: Vec<Series>,
    /// Horizontal lines across, with a word each.
    pub levels: Vec<(f64, String)>,
    /// Drawn on the page by `curves.js`; plots of one group share zoom and cursor. Empty for a still plot.
    pub group: String,
    /// Height, px.
    pub height: f64,
    /// Half as wide as others.
    pub half: bool,
    /// A remark under the plot.
    pub note: String,
}

impl Axis {
    /// Quantity and unit.
    pub fn new(label: &str, unit: &str) -> Self {
        Self {
            label: label.to_owned(),
            unit: unit.to_owned(),
        }
    }
}

impl Series {
    /// The band between two curves over the same places.
    pub fn band(name: &str, colour: usize, x: &[f64], low: &[f64], high: &[f64]) -> Self {
        let edge =
            |y: &[f64]| -> Vec<(f64, f64)> { x.iter().copied().zip(y.iter().copied()).collect() };
        let mut points = edge(low);
        points.extend(edge(high).into_iter().rev());
        Self {
            points,
            ..Self::new(name, Mark::Band, colour, &[], &[])
        }
    }

    /// A series from columns.
    pub fn new(name: &str, mark: Mark, colour: usize, x: &[f64], y: &[f64]) -> Self {
        Self {
            name: name.to_owned(),
            mark,
            colour: colour % 8,
            points: x.iter().copied().zip(y.iter().copied()).collect(),
        }
    }
}
