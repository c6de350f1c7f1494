//! A figure on a page or as a separate file: SVG with its style, or PNG. Output is deterministic: independent of time,
//! machine and installed fonts.

use crate::drawing::{Drawing, Key, TEMPLATES, px};
use crate::error::PageError;
use crate::packed::packed;
#[cfg(feature = "png")]
use crate::pixels::pixels;
use crate::scene::Scene;
use crate::series::Plot;
use crate::template::Html;
use minijinja::{Value, context};

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
        let (class, curves, scene) = match &self.picture {
            Picture::Plot(p) if !p.group.is_empty() => ("plot curves", Some(packed(p)?), None),
            Picture::Plot(p) if p.half => ("plot half", None, None),
            Picture::Plot(_) => ("plot", None, None),
            Picture::Scene(s) => ("scene", None, Some(s.data()?)),
        };
        let drawing = self.drawing()?;
        let curves = curves.filter(|_| drawing.is_some());
        let value = |html: Html| html.value();
        let more = context! {
            class, legend => self.legend(), curves => curves.map(value), scene => scene.map(value),
        };
        TEMPLATES.html("figure.html", self.context(drawing, more))
    }

    /// HTML of several figures; half-width ones are side by side.
    ///
    /// # Errors
    /// As [`Self::html`].
    pub fn page(figures: &[Self]) -> Result<Html, PageError> {
        let is_half = |f: &Self| matches!(&f.picture, Picture::Plot(p) if p.half);
        let mut out = String::new();
        for group in figures.chunk_by(|a, b| is_half(a) && is_half(b)) {
            let made = group.iter().map(|f| Ok(f.html()?.0));
            let made = made.collect::<Result<String, PageError>>()?;
            out.push_str(&match is_half(&group[0]) {
                true => format!("<div class=\"pair\">{made}</div>"),
                false => made,
            });
        }
        Ok(Html(out))
    }

    /// The file in a format; `None` if there is nothing to draw.
    ///
    /// # Errors
    /// The SVG cannot be rendered.
    pub fn file(&self, format: FigureFormat) -> Result<Option<Vec<u8>>, PageError> {
        let Some(svg) = self.svg()? else {
            return Ok(None);
        };
        Ok(Some(match format {
            FigureFormat::Svg => svg.into_bytes(),
            FigureFormat::Png => pixels(&svg)?,
        }))
    }

    /// The stand-alone SVG; `None` if there is nothing to draw.
    ///
    /// # Errors
    /// A template is faulty.
    pub fn svg(&self) -> Result<Option<String>, PageError> {
        let Some(drawing) = self.drawing()? else {
            return Ok(None);
        };
        let legend = self.legend();
        let (rows, keys) = keys(&legend, drawing.size[0]);
        let style = Html(STYLE.to_owned());
        let more = context! { keys, style => style.value(), top => TITLE + ROW * rows as f64 };
        let svg = TEMPLATES.html("figure.svg", self.context(Some(drawing), more))?;
        Ok(Some(svg.0))
    }

    fn drawing(&self) -> Result<Option<Drawing>, PageError> {
        match &self.picture {
            Picture::Plot(p) => p.drawing(),
            Picture::Scene(s) => s.drawing().map(Some),
        }
    }

    fn legend(&self) -> Vec<Key<'_>> {
        match &self.picture {
            Picture::Plot(p) => p.legend(),
            Picture::Scene(s) => s.legend(),
        }
    }

    fn context(&self, drawing: Option<Drawing>, more: Value) -> Value {
        let (title, note) = match &self.picture {
            Picture::Plot(p) => (&p.title, &p.note),
            Picture::Scene(s) => (&s.title, &s.note),
        };
        let [width, height] = drawing.as_ref().map_or([0.0; 2], |d| d.size);
        let elements = drawing.map(|d| d.elements.value());
        context! { title, note, width, height, elements, ..more }
    }
}

/// Number of rows of a legend, and its entries with their places.
fn keys(legend: &[Key], width: f64) -> (usize, Vec<Value>) {
    let mut out = Vec::new();
    let (mut x, mut row) = (EDGE, 0);
    for key in legend {
        let wide = 24.0 + LETTER * key.name.chars().count() as f64 + 14.0;
        if x > EDGE && x + wide > width - EDGE {
            x = EDGE;
            row += 1;
        }
        let y = TITLE + ROW * row as f64 + 5.0;
        out.push(context! { x => px(x), y, ..Value::from_serialize(key) });
        x += wide;
    }
    (if legend.is_empty() { 0 } else { row + 1 }, out)
}

#[cfg(not(feature = "png"))]
fn pixels(_: &str) -> Result<Vec<u8>, PageError> {
    Err(PageError::Figure(WITHOUT_PNG.to_owned()))
}

fn file_name(name: &str) -> String {
    let safe = |c: char| match c.is_ascii_alphanumeric() || c == '-' {
        true => c.to_ascii_lowercase(),
        false => '_',
    };
    let plain: String = name.chars().map(safe).take(80).collect();
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
        let svg = figure("../e vil/Näme", "</svg><script>")
            .svg()
            .unwrap()
            .unwrap();
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
