//! Axes and series of a plot.

/// Drawing style of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Mark {
    /// Joined points.
    Line,
    /// Joined points, dashed.
    Dashed,
    /// Separate points.
    Dots,
    /// Separate points, large.
    Points,
    /// Bars from the bottom of the plot, one unit wide times the spacing.
    Bars,
    /// A filled outline, see [`Series::band`].
    Band,
}

impl Mark {
    /// Class of its path in SVG.
    pub(crate) fn class(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::Dashed => "line dashed",
            Self::Dots => "dots",
            Self::Points => "dots large",
            Self::Bars => "bars",
            Self::Band => "bars band",
        }
    }

    /// Legend symbol.
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
    /// Name in the legend, or empty.
    pub name: String,
    /// Mark.
    pub mark: Mark,
    /// Colour, 0 to 7.
    pub colour: usize,
    /// Points; a value that is not finite is a gap.
    pub points: Vec<(f64, f64)>,
}

/// Quantity of an axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// Quantity.
    pub label: String,
    /// Unit; `1` or empty if dimensionless.
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
    /// Whether the horizontal axis counts items.
    pub whole: bool,
    /// Labels at 1, 2, 3 ... instead of numbers on the horizontal axis.
    pub names: Vec<String>,
    /// Whether the range includes zero.
    pub from_zero: bool,
    /// Series.
    pub series: Vec<Series>,
    /// Labelled horizontal lines.
    pub levels: Vec<(f64, String)>,
    /// Plots of one group share zoom and cursor, drawn by `curves.js`. Empty for a static plot.
    pub group: String,
    /// Height, px.
    pub height: f64,
    /// Half width.
    pub half: bool,
    /// Remark below the plot.
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
    /// Band between two curves over the same abscissae.
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
