//! A plot as SVG. A time plot is stored on the page as packed samples that `curves.js` draws.

use crate::axis::{exponent, superscript, tick_text, ticks, unit_text};
use crate::markup::{Html, escape};
use crate::packed::packed;
use crate::series::{Axis, Mark, Plot, Series};
use std::fmt::Write;

const WIDTH: f64 = 860.0;
/// Width of a letter of an axis name, including spacing, px.
const LETTER: f64 = 8.5;
const LEFT: f64 = 76.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 8.0;
const BOTTOM: f64 = 44.0;

/// Data range and its mapping to the plot area.
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
    scale: f64,
    log: bool,
    exponent: i32,
}

impl Frame {
    fn new(plot: &Plot) -> Option<Self> {
        let all = plot.series.iter().flat_map(|s| &s.points);
        let finite = all.filter(|p| p.0.is_finite() && p.1.is_finite());
        let raised = |y: f64| if plot.log { y.log10() } else { y };
        let mut x = [f64::INFINITY, f64::NEG_INFINITY];
        let mut y = x;
        for p in finite.filter(|p| !plot.log || p.1 > 0.0) {
            x = [x[0].min(p.0), x[1].max(p.0)];
            y = [y[0].min(raised(p.1)), y[1].max(raised(p.1))];
        }
        for level in plot
            .levels
            .iter()
            .map(|l| raised(l.0))
            .filter(|l| l.is_finite())
        {
            y = [y[0].min(level), y[1].max(level)];
        }
        if plot.from_zero {
            y = [y[0].min(0.0), y[1].max(0.0)];
        }
        if !(x[0] <= x[1] && y[0] <= y[1]) {
            return None;
        }
        let exponent = if plot.log {
            0
        } else {
            exponent(y[0].abs().max(y[1].abs()))
        };
        let scale = 10.0_f64.powi(-exponent);
        let bars = plot.series.iter().any(|s| s.mark == Mark::Bars);
        let margin = if plot.log { 0.08 } else { 0.05 };
        let pad = |r: [f64; 2], share: f64| {
            let span = (r[1] - r[0])
                .max(1.0e-9 * r[0].abs().max(r[1].abs()))
                .max(1.0e-300);
            [r[0] - share * span, r[1] + share * span]
        };
        let mut padded = pad([y[0] * scale, y[1] * scale], margin);
        if plot.from_zero && y[0] == 0.0 {
            padded[0] = 0.0;
        }
        let count = plot
            .series
            .iter()
            .map(|s| s.points.len())
            .max()
            .unwrap_or(1);
        let side = if !plot.names.is_empty() {
            0.5 / (plot.names.len().max(2) - 1) as f64
        } else if bars {
            0.5 / (count.max(2) - 1) as f64
        } else {
            0.0
        };
        Some(Self {
            x: if x[0] < x[1] {
                pad(x, side)
            } else {
                [x[0] - 0.5, x[1] + 0.5]
            },
            y: padded,
            scale,
            log: plot.log,
            exponent,
        })
    }

    /// Horizontal position, as a fraction from the left.
    fn share_x(&self, x: f64) -> f64 {
        (x - self.x[0]) / (self.x[1] - self.x[0])
    }

    /// Vertical position, as a fraction from the top.
    fn share_y(&self, y: f64) -> f64 {
        let y = if self.log { y.log10() } else { y * self.scale };
        (self.y[1] - y) / (self.y[1] - self.y[0])
    }
}

impl Plot {
    /// The plot as a figure; a note if there is nothing to draw.
    pub fn html(&self) -> Html {
        let mut out = String::new();
        let class = match (self.group.is_empty(), self.half) {
            (false, _) => "plot curves",
            (true, true) => "plot half",
            (true, false) => "plot",
        };
        let title = escape(&self.title);
        let _ = write!(out, "<figure class=\"{class}\"><figcaption><b>{title}</b>");
        if self.group.is_empty() {
            for (name, key, colour) in self.legend() {
                let name = escape(name);
                let _ = write!(out, "<span class=\"key {key} c{colour}\">{name}</span>");
            }
        }
        out.push_str("</figcaption>");
        match self.drawing() {
            None => out.push_str("<p class=\"empty\">nothing to draw</p>"),
            Some(_) if !self.group.is_empty() => out.push_str(&packed(self)),
            Some(([width, height], elements)) => {
                let _ = write!(
                    out,
                    "<svg class=\"chart\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}\">{elements}</svg>"
                );
            }
        }
        if !self.note.is_empty() {
            let _ = write!(out, "<p class=\"note\">{}</p>", escape(&self.note));
        }
        out.push_str("</figure>");
        Html(out)
    }

    /// Width and height, px.
    fn size(&self) -> [f64; 2] {
        let width = if self.half { WIDTH / 2.0 } else { WIDTH };
        let height = if self.height > 0.0 {
            self.height
        } else {
            220.0
        };
        [width, height]
    }

    /// The plot without legend: size and elements. A nested SVG clips the curves.
    pub(crate) fn drawing(&self) -> Option<([f64; 2], String)> {
        let frame = Frame::new(self)?;
        let [width, height] = self.size();
        let (w, h) = (width - LEFT - RIGHT, height - TOP - BOTTOM);
        let mut out = String::new();
        self.draw_ticks(&frame, w, h, &mut out);
        let _ = write!(
            out,
            "<svg x=\"{LEFT}\" y=\"{TOP}\" width=\"{w}\" height=\"{h}\">"
        );
        for (level, _) in &self.levels {
            let y = h * frame.share_y(*level);
            let _ = write!(out, "<path class=\"level\" d=\"M0 {y:.2}H{w}\"/>");
        }
        for s in &self.series {
            draw_series(&frame, [w, h], s, &mut out);
        }
        out.push_str("</svg>");
        self.draw_frame(&frame, [width, height], &mut out);
        Some(([width, height], out))
    }

    /// Name, mark and colour of each legend entry.
    pub(crate) fn legend(&self) -> Vec<(&str, &'static str, usize)> {
        let named = self.series.iter().filter(|s| !s.name.is_empty());
        named
            .map(|s| (s.name.as_str(), s.mark.key(), s.colour))
            .collect()
    }

    /// Draws the labels of levels, the frame and the axis labels.
    fn draw_frame(&self, frame: &Frame, [width, height]: [f64; 2], out: &mut String) {
        let (w, h) = (width - LEFT - RIGHT, height - TOP - BOTTOM);
        for (level, word) in self.levels.iter().filter(|l| !l.1.is_empty()) {
            let line = TOP + h * frame.share_y(*level);
            let y = if line < TOP + 14.0 {
                line + 11.0
            } else {
                line - 3.0
            };
            let x = width - RIGHT - 4.0;
            let word = escape(word);
            let _ = write!(
                out,
                "<text class=\"level-word\" x=\"{x}\" y=\"{y:.1}\">{word}</text>"
            );
        }
        let _ = write!(
            out,
            "<rect class=\"frame\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{w}\" height=\"{h}\"/>"
        );
        let label = |axis: &Axis, exponent| match unit_text(&axis.unit, exponent) {
            unit if unit.is_empty() => escape(&axis.label),
            unit => format!("{} [{}]", escape(&axis.label), escape(&unit)),
        };
        let (mut x, y) = (label(&self.x, 0), label(&self.y, frame.exponent));
        if let Some(owner) = self.common_prefix().strip_suffix('.') {
            x = format!("{x} of {}", escape(owner));
        }
        let (middle, floor, half) = (LEFT + w / 2.0, height - 6.0, TOP + h / 2.0);
        if !x.is_empty() {
            let _ = write!(
                out,
                "<text class=\"axis\" x=\"{middle}\" y=\"{floor}\">{x}</text>"
            );
        }
        let _ = write!(
            out,
            "<text class=\"axis\" transform=\"translate(13 {half}) rotate(-90)\">{y}</text>"
        );
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

    fn draw_ticks(&self, frame: &Frame, w: f64, h: f64, out: &mut String) {
        let floor = TOP + h + 14.0;
        let mut along = ticks(frame.x[0], frame.x[1], if self.half { 5 } else { 9 });
        if self.whole {
            along.retain(|t| t.fract() == 0.0);
        }
        out.push_str("<g class=\"ticks x\">");
        if !self.names.is_empty() {
            along = (1..=self.names.len()).map(|k| k as f64).collect();
        }
        let common = self.common_prefix().len();
        let longest = self.names.iter().map(|n| n.len() - common).max();
        let needed = (longest.unwrap_or(0) * self.names.len()) as f64 * LETTER;
        let step = (needed / w).ceil().max(1.0) as usize;
        for (k, t) in along.iter().enumerate() {
            let x = LEFT + w * frame.share_x(*t);
            let text = match self.names.get(k) {
                Some(name) if k % step == 0 => escape(&name[common..]),
                Some(_) => String::new(),
                None => tick_text(*t, &along),
            };
            let _ = write!(
                out,
                "<path d=\"M{x:.1} {TOP}v{h}\"/><text x=\"{x:.1}\" y=\"{floor}\">{text}</text>"
            );
        }
        out.push_str("</g><g class=\"ticks y\">");
        let mut up = ticks(frame.y[0], frame.y[1], (h / 36.0).max(3.0) as usize);
        if self.log {
            up.retain(|t| t.fract().abs() < 1.0e-9);
        }
        for t in &up {
            let y = TOP + h * (frame.y[1] - t) / (frame.y[1] - frame.y[0]);
            let text = if self.log {
                format!("10{}", superscript(t.round() as i32))
            } else {
                tick_text(*t, &up)
            };
            let (edge, low) = (LEFT - 6.0, y + 3.5);
            let _ = write!(
                out,
                "<path d=\"M{LEFT} {y:.1}h{w}\"/><text x=\"{edge}\" y=\"{low:.1}\">{text}</text>"
            );
        }
        out.push_str("</g>");
    }
}

fn draw_series(frame: &Frame, [w, h]: [f64; 2], series: &Series, out: &mut String) {
    let class = match series.mark {
        Mark::Line => "line",
        Mark::Dashed => "line dashed",
        Mark::Dots => "dots",
        Mark::Points => "dots large",
        Mark::Bars => "bars",
        Mark::Band => "bars band",
    };
    let _ = write!(out, "<path class=\"{class} c{}\" d=\"", series.colour);
    let mut broken = true;
    let half = 0.42 * w / series.points.len().max(1) as f64;
    for (x, y) in &series.points {
        let (px, py) = (w * frame.share_x(*x), h * frame.share_y(*y));
        if !(px.is_finite() && py.is_finite()) {
            broken = true;
            continue;
        }
        let _ = match series.mark {
            Mark::Dots | Mark::Points => write!(out, "M{px:.2} {py:.2}h0"),
            Mark::Bars => {
                let (from, wide) = (px - half, 2.0 * half);
                write!(out, "M{from:.2} {h}V{py:.2}h{wide:.2}V{h}z")
            }
            _ if broken => write!(out, "M{px:.2} {py:.2}"),
            _ => write!(out, "L{px:.2} {py:.2}"),
        };
        broken = false;
    }
    if series.mark == Mark::Band && !broken {
        out.push('z');
    }
    out.push_str("\"/>");
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let html = plot.html();
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
        let html = plot.html();
        assert!(html.as_str().contains(">number of bus.inertia_kg_m2<"));
        assert!(html.as_str().contains(">yy</text>"));
        let mixed = Plot {
            names: vec!["bus.mass_kg".to_owned(), "arm.mass_kg".to_owned()],
            ..plot
        };
        assert!(mixed.html().as_str().contains(">arm.mass_kg</text>"));
    }

    #[test]
    fn unit_nothing_finite_is_said() {
        let plot = Plot {
            series: vec![Series::new("", Mark::Line, 0, &[f64::NAN], &[1.0])],
            ..Plot::default()
        };
        assert!(plot.html().as_str().contains("nothing to draw"));
    }
}
