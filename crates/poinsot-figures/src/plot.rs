//! A plot as SVG. A time plot is stored on the page as packed samples that `curves.js` draws.

use crate::axis::{exponent, superscript, tick_text, ticks, unit_text};
use crate::drawing::{Drawing, Key, px};
use crate::error::PageError;
use crate::series::{Axis, Mark, Plot, Series};
use minijinja::context;
use serde::Serialize;
use std::fmt::Write;

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 220.0;
/// Width of a letter of an axis name, including spacing, px.
const LETTER: f64 = 8.5;
/// Height of a slanted name (60 degrees) over its length with spacing.
const SLANTED: f64 = 0.75;
const LEFT: f64 = 76.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 8.0;
const BOTTOM: f64 = 44.0;

/// A tick or level: place, px, and text.
#[derive(Serialize)]
struct Place {
    at: f64,
    text: String,
}

/// Data range and its mapping to the plot area.
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
    scale: f64,
    log: bool,
    exponent: i32,
    /// Width and height of the area, px.
    size: [f64; 2],
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.fold(none, |r, x| [r[0].min(x), r[1].max(x)])
}

fn padded(r: [f64; 2], share: f64) -> [f64; 2] {
    let least = 1.0e-9 * r[0].abs().max(r[1].abs());
    let margin = share * (r[1] - r[0]).max(least).max(1.0e-300);
    [r[0] - margin, r[1] + margin]
}

impl Frame {
    /// `None` if there is nothing to draw.
    fn new(plot: &Plot, size: [f64; 2]) -> Option<Self> {
        let log = plot.log;
        let raised = |y: f64| if log { y.log10() } else { y };
        let points = plot.series.iter().flat_map(|s| &s.points);
        let points = points.filter(|p| p.0.is_finite() && raised(p.1).is_finite());
        let levels = plot.levels.iter().map(|l| raised(l.0));
        let levels = levels.chain(plot.from_zero.then_some(0.0));
        let x = range(points.clone().map(|p| p.0));
        let all = points.map(|p| raised(p.1)).chain(levels);
        let y = range(all.filter(|y| y.is_finite()));
        if !(x[0] <= x[1] && y[0] <= y[1]) {
            return None;
        }
        let exponent = match log {
            true => 0,
            false => exponent(y[0].abs().max(y[1].abs())),
        };
        let scale = 10.0_f64.powi(-exponent);
        let mut frame = Self {
            x: [x[0] - 0.5, x[1] + 0.5],
            y: padded(y.map(|y| y * scale), if log { 0.08 } else { 0.05 }),
            scale,
            log,
            exponent,
            size,
        };
        if x[0] < x[1] {
            frame.x = padded(x, side(plot));
        }
        if plot.from_zero && y[0] == 0.0 {
            frame.y[0] = 0.0;
        }
        Some(frame)
    }

    /// Horizontal place in the area, px.
    fn along(&self, x: f64) -> f64 {
        self.size[0] * (x - self.x[0]) / (self.x[1] - self.x[0])
    }

    /// Vertical place in the area from its top, px.
    fn down(&self, y: f64) -> f64 {
        self.raised(if self.log { y.log10() } else { y * self.scale })
    }

    /// The same of a number in units of the axis.
    fn raised(&self, y: f64) -> f64 {
        self.size[1] * (self.y[1] - y) / (self.y[1] - self.y[0])
    }
}

/// Margin at each side, relative to the range: half a step where the axis counts names or bars.
fn side(plot: &Plot) -> f64 {
    let bars = plot.series.iter().filter(|s| s.mark == Mark::Bars);
    let count = match plot.names.len() {
        0 => bars.map(|s| s.points.len()).max(),
        names => Some(names),
    };
    count.map_or(0.0, |count| 0.5 / (count.max(2) - 1) as f64)
}

impl Plot {
    /// The plot without title and legend; `None` if there is nothing to draw. A nested SVG clips the curves.
    pub(crate) fn drawing(&self) -> Result<Option<Drawing>, PageError> {
        let width = if self.half { WIDTH / 2.0 } else { WIDTH };
        let chosen = if self.height > 0.0 {
            self.height
        } else {
            HEIGHT
        };
        let [w, h] = [width - LEFT - RIGHT, chosen - TOP - BOTTOM];
        let slant = self.slant(w);
        let height = chosen + slant;
        let Some(frame) = Frame::new(self, [w, h]) else {
            return Ok(None);
        };
        let level = |(y, text): &(f64, String)| Place {
            at: px(frame.down(*y)),
            text: text.clone(),
        };
        let levels: Vec<Place> = self.levels.iter().map(level).collect();
        let series = self.series.iter().map(|s| {
            context! { class => s.mark.class(), colour => s.colour, path => path(&frame, s) }
        });
        let mut x = labelled(&self.x, 0);
        if let Some(owner) = self.common_prefix().strip_suffix('.') {
            x = format!("{x} of {owner}");
        }
        let context = context! {
            x, w, h, height, levels, slant,
            y => labelled(&self.y, frame.exponent),
            left => LEFT, top => TOP,
            along => self.along(&frame),
            up => self.up(&frame),
            series => series.collect::<Vec<_>>(),
        };
        Drawing::new([width, height], "plot.svg", context).map(Some)
    }

    /// Every legend entry.
    pub(crate) fn legend(&self) -> Vec<Key<'_>> {
        let named = self.series.iter().filter(|s| !s.name.is_empty());
        let key = |s: &'_ Series| (s.mark.key(), s.colour);
        named.map(|s| Key::new(&s.name, key(s))).collect()
    }

    /// Common prefix of all names up to its last dot; it is written once on the axis.
    fn common_prefix(&self) -> &str {
        let Some((first, others)) = self.names.split_first() else {
            return "";
        };
        let mut prefix = first.rfind('.').map_or("", |at| &first[..=at]);
        while !others.iter().all(|n| n.starts_with(prefix)) {
            let inner = prefix.strip_suffix('.').unwrap_or_default();
            prefix = inner.rfind('.').map_or("", |at| &first[..=at]);
        }
        prefix
    }

    /// Horizontal ticks: numbers, or names.
    fn along(&self, frame: &Frame) -> Vec<Place> {
        let mark = |x: f64, text: &str| Place {
            at: px(LEFT + frame.along(x)),
            text: text.to_owned(),
        };
        if self.names.is_empty() {
            let mut all = ticks(frame.x[0], frame.x[1], if self.half { 5 } else { 9 });
            all.retain(|t| !self.whole || t.fract() == 0.0);
            let text = |t: &f64| mark(*t, &tick_text(*t, &all));
            return all.iter().map(text).collect();
        }
        let common = self.common_prefix().len();
        let names = self.names.iter().enumerate();
        names
            .map(|(k, name)| mark((k + 1) as f64, &name[common..]))
            .collect()
    }

    /// Height that names take below their ticks, px, if they are slanted; zero where they fit side by side.
    fn slant(&self, wide: f64) -> f64 {
        let common = self.common_prefix().len();
        let longest = self.names.iter().map(|n| n.len() - common).max();
        let longest = longest.unwrap_or(0) as f64 * LETTER;
        let slanted = longest * self.names.len() as f64 > wide;
        if slanted { SLANTED * longest } else { 0.0 }
    }

    /// Vertical ticks.
    fn up(&self, frame: &Frame) -> Vec<Place> {
        let wanted = (frame.size[1] / 36.0).max(3.0) as usize;
        let mut all = ticks(frame.y[0], frame.y[1], wanted);
        all.retain(|t| !self.log || t.fract().abs() < 1.0e-9);
        let mark = |at: f64, text: String| Place {
            at: px(TOP + frame.raised(at)),
            text,
        };
        if self.log && all.len() < 2 {
            // Fewer than two powers of ten: round numbers between them.
            let [low, high] = frame.y.map(|y| 10.0_f64.powf(y));
            let all = ticks(low, high, wanted);
            let round = all.iter().map(|t| mark(t.log10(), tick_text(*t, &all)));
            return round.collect();
        }
        let text = |t: f64| match self.log {
            true => format!("10{}", superscript(t.round() as i32)),
            false => tick_text(t, &all),
        };
        all.iter().map(|t| mark(*t, text(*t))).collect()
    }
}

/// Quantity and unit of an axis.
fn labelled(axis: &Axis, exponent: i32) -> String {
    match unit_text(&axis.unit, exponent).as_str() {
        "" => axis.label.clone(),
        unit => format!("{} [{unit}]", axis.label),
    }
}

/// Path of a series; a point that is not finite is a gap.
fn path(frame: &Frame, series: &Series) -> String {
    let mut out = String::new();
    let mut pen = 'M';
    let [w, h] = frame.size;
    let half = 0.42 * w / series.points.len().max(1) as f64;
    for (x, y) in &series.points {
        let (x, y) = (frame.along(*x), frame.down(*y));
        if !(x.is_finite() && y.is_finite()) {
            pen = 'M';
            continue;
        }
        let _ = match series.mark {
            Mark::Dots | Mark::Points => write!(out, "M{x:.2} {y:.2}h0"),
            Mark::Bars => {
                let (from, wide) = (x - half, 2.0 * half);
                write!(out, "M{from:.2} {h}V{y:.2}h{wide:.2}V{h}z")
            }
            _ => write!(out, "{pen}{x:.2} {y:.2}"),
        };
        pen = 'L';
    }
    if series.mark == Mark::Band && pen == 'L' {
        out.push('z');
    }
    out
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::figure::Figure;

    #[test]
    fn unit_axes_carry_units_and_powers() {
        let plot = Plot {
            title: "rate".to_owned(),
            x: Axis::new("time", "s"),
            y: Axis::new("omega", "rad/s"),
            series: vec![Series::new(
                "a<b",
                Mark::Line,
                0,
                &[0.0, 1.0],
                &[0.0, 2.0e-5],
            )],
            ..Plot::default()
        };
        let html = Figure::plot("", plot.clone()).html().unwrap();
        assert!(html.as_str().contains("omega [10⁻⁶ rad/s]"));
        assert!(html.as_str().contains("time [s]"));
        assert!(html.as_str().contains("a&lt;b"));
    }

    #[test]
    fn unit_what_all_names_begin_with_is_said_once_on_the_axis() {
        let names = ["bus.inertia_kg_m2.xx", "bus.inertia_kg_m2.yy"].map(str::to_owned);
        let plot = Plot {
            x: Axis::new("number", ""),
            names: names.to_vec(),
            series: vec![Series::new("", Mark::Points, 0, &[1.0, 2.0], &[1.0, 3.0])],
            ..Plot::default()
        };
        let html = Figure::plot("", plot.clone()).html().unwrap();
        assert!(html.as_str().contains(">number of bus.inertia_kg_m2<"));
        assert!(html.as_str().contains(">yy</text>"));
        let mixed = Plot {
            names: vec!["bus.mass_kg".to_owned(), "arm.mass_kg".to_owned()],
            ..plot
        };
        let mixed = Figure::plot("", mixed).html().unwrap();
        assert!(mixed.as_str().contains(">arm.mass_kg</text>"));
    }

    #[test]
    fn unit_nothing_finite_is_said() {
        let plot = Plot {
            series: vec![Series::new("", Mark::Line, 0, &[f64::NAN], &[1.0])],
            ..Plot::default()
        };
        let html = Figure::plot("", plot).html().unwrap();
        assert!(html.as_str().contains("nothing to draw"));
    }
}
