//! A figure of the page as a separate file: SVG with its style, or PNG. Output is deterministic: independent of time,
//! machine and installed fonts.

use crate::error::PageError;
use crate::markup::{Html, escape};
#[cfg(feature = "png")]
use crate::pixels::pixels;
use crate::scene::Scene;
use crate::series::Plot;
use std::fmt::Write;

const STYLE: &str = include_str!("../assets/figure.css");
/// Height of the title and of each legend row, px.
const TITLE: f64 = 26.0;
const ROW: f64 = 17.0;
/// Approximate width of a legend letter, px, for breaking rows.
const LETTER: f64 = 6.6;
const EDGE: f64 = 12.0;

/// Refusal of a PNG by a program without the feature.
pub const WITHOUT_PNG: &str = "this program was built without PNG (feature `png`); use svg";

/// Content of a figure.
#[derive(Debug, Clone, PartialEq)]
pub enum Picture {
    /// Curves.
    Plot(Box<Plot>),
    /// Scene in space.
    Scene(Box<Scene>),
}

/// A picture with its file name.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Letters, digits, `_` and `-` only.
    pub name: String,
    /// Content.
    pub picture: Picture,
}

/// File format of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureFormat {
    /// Scalable.
    Svg,
    /// Pixels, twice the resolution of the SVG.
    Png,
}

impl FigureFormat {
    /// Ending of the file's name.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }

    /// Whether this program writes the format.
    pub fn is_built(self) -> bool {
        self != Self::Png || cfg!(feature = "png")
    }
}

impl Figure {
    /// A figure of a plot; letters that are not safe in file names become `_`.
    pub fn plot(name: &str, plot: Plot) -> Self {
        Self {
            name: file_name(name),
            picture: Picture::Plot(Box::new(plot)),
        }
    }

    /// A figure of a scene.
    pub fn scene(name: &str, scene: Scene) -> Self {
        Self {
            name: file_name(name),
            picture: Picture::Scene(Box::new(scene)),
        }
    }

    /// HTML on the page.
    ///
    /// # Errors
    /// Its numbers have no JSON form.
    pub fn html(&self) -> Result<Html, PageError> {
        match &self.picture {
            Picture::Plot(plot) => Ok(plot.html()),
            Picture::Scene(scene) => scene.html(),
        }
    }

    fn is_half(&self) -> bool {
        matches!(&self.picture, Picture::Plot(p) if p.half)
    }

    /// HTML of several figures; half-width ones are side by side.
    ///
    /// # Errors
    /// As [`Self::html`].
    pub fn page(figures: &[Self]) -> Result<Html, PageError> {
        let mut parts = Vec::new();
        for group in figures.chunk_by(|a, b| a.is_half() && b.is_half()) {
            let made = group
                .iter()
                .map(Self::html)
                .collect::<Result<Vec<_>, _>>()?;
            if group.first().is_some_and(Self::is_half) {
                parts.push(Html::pair(&made));
            } else {
                parts.extend(made);
            }
        }
        Ok(Html::join(&parts))
    }

    /// The file in a format; `None` if there is nothing to draw.
    ///
    /// # Errors
    /// The SVG cannot be rendered.
    pub fn file(&self, format: FigureFormat) -> Result<Option<Vec<u8>>, PageError> {
        let Some(svg) = self.svg() else {
            return Ok(None);
        };
        Ok(Some(match format {
            FigureFormat::Svg => svg.into_bytes(),
            FigureFormat::Png => pixels(&svg)?,
        }))
    }

    /// The stand-alone SVG; `None` if there is nothing to draw.
    pub fn svg(&self) -> Option<String> {
        let (title, note, legend, drawing) = match &self.picture {
            Picture::Plot(p) => (&p.title, &p.note, p.legend(), p.drawing()?),
            Picture::Scene(s) => (&s.title, &s.note, s.legend(), s.drawing()),
        };
        let ([width, height], elements) = drawing;
        let (rows, keys) = keys(&legend, width);
        let top = TITLE + ROW * rows as f64;
        let whole = height + top;
        let (title, note) = (escape(title), escape(note));
        let mut out = String::new();
        let _ = write!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{whole}\" viewBox=\"0 0 {width} {whole}\">\
             <title>{title}</title><desc>{note}</desc><style>\n{STYLE}</style>\
             <rect width=\"{width}\" height=\"{whole}\" fill=\"#ffffff\"/>\
             <text class=\"title\" x=\"{EDGE}\" y=\"18\">{title}</text>{keys}\
             <g transform=\"translate(0 {top})\">{elements}</g></svg>\n"
        );
        Some(out)
    }
}

/// Number of rows of a legend, and its elements.
fn keys(legend: &[(&str, &str, usize)], width: f64) -> (usize, String) {
    let mut out = String::new();
    let (mut x, mut row) = (EDGE, 0);
    for (name, kind, colour) in legend {
        let wide = 24.0 + LETTER * name.chars().count() as f64 + 14.0;
        if x > EDGE && x + wide > width - EDGE {
            x = EDGE;
            row += 1;
        }
        let y = TITLE + ROW * row as f64 + 5.0;
        let (word, low, end) = (x + 24.0, y + 4.0, x + 18.0);
        let _ = match *kind {
            "dots" => {
                let middle = x + 9.0;
                write!(
                    out,
                    "<path class=\"dots large c{colour}\" d=\"M{middle:.1} {y}h0\"/>"
                )
            }
            "bars" | "solid" | "ramp" => {
                let high = y - 4.5;
                write!(
                    out,
                    "<rect class=\"bars c{colour}\" x=\"{x:.1}\" y=\"{high}\" width=\"18\" height=\"9\"/>"
                )
            }
            kind => write!(
                out,
                "<path class=\"line {kind} c{colour}\" d=\"M{x:.1} {y}H{end:.1}\"/>"
            ),
        };
        let name = escape(name);
        let _ = write!(
            out,
            "<text class=\"word\" x=\"{word:.1}\" y=\"{low}\">{name}</text>"
        );
        x += wide;
    }
    (if legend.is_empty() { 0 } else { row + 1 }, out)
}

#[cfg(not(feature = "png"))]
fn pixels(_: &str) -> Result<Vec<u8>, PageError> {
    Err(PageError::Figure(WITHOUT_PNG.to_owned()))
}

fn file_name(name: &str) -> String {
    let plain: String = name
        .chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() || c == '-' {
                c.to_ascii_lowercase()
            } else {
                '_'
            }
        })
        .take(80)
        .collect();
    plain.trim_matches('_').to_owned()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::series::{Axis, Mark, Series};
    #[cfg(feature = "png")]
    use resvg::tiny_skia::Pixmap;

    fn figure(name: &str, series: &str) -> Figure {
        let x: Vec<f64> = (0..50).map(|k| 0.1 * f64::from(k)).collect();
        let y: Vec<f64> = x.iter().map(|x| x.sin()).collect();
        Figure::plot(
            name,
            Plot {
                title: "a <title>".to_owned(),
                x: Axis::new("time", "s"),
                y: Axis::new("Ω", "rad/s"),
                series: vec![
                    Series::new(series, Mark::Line, 0, &x, &y),
                    Series::new("points", Mark::Dots, 1, &x, &y),
                    Series::new("bars", Mark::Bars, 2, &x, &y),
                ],
                ..Plot::default()
            },
        )
    }

    #[cfg(feature = "png")]
    #[test]
    fn unit_equal_pictures_give_equal_bytes() {
        for format in [FigureFormat::Svg, FigureFormat::Png] {
            let make = || figure("a", "line").file(format).unwrap().unwrap();
            assert!(make() == make());
        }
    }

    #[cfg(feature = "png")]
    #[test]
    fn unit_a_png_holds_ink_in_the_colours_of_its_series() {
        let png = figure("a", "line")
            .file(FigureFormat::Png)
            .unwrap()
            .unwrap();
        let pixmap = Pixmap::decode_png(&png).unwrap();
        let has = |r, g, b| {
            pixmap
                .pixels()
                .iter()
                .any(|p| [p.red(), p.green(), p.blue()] == [r, g, b])
        };
        assert!(has(0x00, 0x72, 0xb2), "the line");
        assert!(has(0x1b, 0x23, 0x2c), "the title");
        assert!(
            pixmap
                .pixels()
                .iter()
                .filter(|p| p.red() > 150 && p.green() < 170 && p.blue() < 140)
                .count()
                > 100,
            "the dots"
        );
    }

    #[test]
    fn unit_names_from_files_are_text() {
        let svg = figure("../e vil/Näme", "</svg><script>").svg().unwrap();
        assert!(!svg.contains("<script"));
        assert!(svg.contains("&lt;script&gt;"));
        assert_eq!(figure("../e vil/Näme", "").name, "e_vil_n_me");
    }

    #[test]
    fn unit_nothing_to_draw_is_no_file() {
        let empty = Figure::plot("a", Plot::default());
        assert_eq!(empty.file(FigureFormat::Png).unwrap(), None);
    }
}
