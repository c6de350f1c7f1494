//! Panels of curves as SVG: axes with units, a legend, bands, marks. Black on white, readable in print.

use std::fmt::Write;

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 76.0;
const RIGHT: f64 = 200.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 50.0;

/// Colours that stay apart in grey and for colour-blind readers (Okabe and Ito 2008).
pub const COLOURS: [&str; 6] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9",
];

pub enum Shape {
    Line(Vec<(f64, f64)>),
    Dashed(Vec<(f64, f64)>),
    /// x, lower, upper.
    Band(Vec<(f64, f64, f64)>),
    Dots(Vec<(f64, f64)>),
}

pub struct Layer {
    /// Empty: not in the legend.
    pub name: String,
    pub colour: &'static str,
    pub shape: Shape,
}

pub struct Panel {
    pub title: String,
    pub x_label: String,
    pub y_label: String,
    pub layers: Vec<Layer>,
    pub log_y: bool,
    /// Names of the places 1, 2, ... in place of numbers.
    pub x_names: Vec<String>,
}

impl Panel {
    pub fn new(title: &str, x_label: &str, y_label: &str) -> Self {
        Self {
            title: title.to_owned(),
            x_label: x_label.to_owned(),
            y_label: y_label.to_owned(),
            layers: Vec::new(),
            log_y: false,
            x_names: Vec::new(),
        }
    }

    pub fn add(&mut self, name: &str, colour: &'static str, shape: Shape) {
        let name = name.to_owned();
        self.layers.push(Layer {
            name,
            colour,
            shape,
        });
    }
}

/// Panels below each other.
pub fn figure(panels: &[Panel]) -> String {
    let height = HEIGHT * panels.len() as f64;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{WIDTH}\" height=\"{height}\" fill=\"white\"/>\n"
    );
    for (i, panel) in panels.iter().enumerate() {
        let _ = writeln!(out, "<g transform=\"translate(0 {})\">", HEIGHT * i as f64);
        draw(panel, &mut out);
        out.push_str("</g>\n");
    }
    out.push_str("</svg>\n");
    out
}

/// A linear or logarithmic scale from data to the page.
struct Scale {
    from: f64,
    to: f64,
    start: f64,
    end: f64,
    log: bool,
}

impl Scale {
    fn at(&self, x: f64) -> f64 {
        let f = |x: f64| if self.log { x.max(1e-300).log10() } else { x };
        let share = (f(x) - f(self.from)) / (f(self.to) - f(self.from));
        self.start + (self.end - self.start) * share.clamp(-0.02, 1.02)
    }

    fn ticks(&self) -> Vec<f64> {
        if self.log {
            let (a, b) = (
                self.from.log10().ceil() as i32,
                self.to.log10().floor() as i32,
            );
            return (a..=b).map(|e| 10.0_f64.powi(e)).collect();
        }
        let rough = (self.to - self.from) / 5.0;
        let power = 10.0_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .iter()
            .map(|m| m * power)
            .find(|s| *s >= rough)
            .unwrap_or(rough);
        let (a, b) = (
            (self.from / step).ceil() as i64,
            (self.to / step).floor() as i64,
        );
        (a..=b).map(|k| k as f64 * step).collect()
    }
}

fn spread(values: impl Iterator<Item = f64>, log: bool) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite() && (!log || *v > 0.0))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
    if log {
        return (low / 1.5, high * 1.5);
    }
    let margin = 0.05 * (high - low).max(1e-9);
    (low - margin, high + margin)
}

fn draw(panel: &Panel, out: &mut String) {
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    for layer in &panel.layers {
        match &layer.shape {
            Shape::Line(p) | Shape::Dashed(p) | Shape::Dots(p) => {
                xs.extend(p.iter().map(|p| p.0));
                ys.extend(p.iter().map(|p| p.1));
            }
            Shape::Band(p) => {
                xs.extend(p.iter().map(|p| p.0));
                ys.extend(p.iter().flat_map(|p| [p.1, p.2]));
            }
        }
    }
    let (x0, x1) = spread(xs.into_iter(), false);
    let (y0, y1) = spread(ys.into_iter(), panel.log_y);
    let x = Scale {
        from: x0,
        to: x1,
        start: LEFT,
        end: WIDTH - RIGHT,
        log: false,
    };
    let y = Scale {
        from: y0,
        to: y1,
        start: HEIGHT - BOTTOM,
        end: TOP,
        log: panel.log_y,
    };
    axes(panel, &x, &y, out);
    for layer in &panel.layers {
        let colour = layer.colour;
        let path = |p: &[(f64, f64)]| {
            let points = p
                .iter()
                .map(|(a, b)| format!("{:.2},{:.2}", x.at(*a), y.at(*b)));
            points.collect::<Vec<_>>().join(" ")
        };
        let _ = match &layer.shape {
            Shape::Line(p) => writeln!(
                out,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"/>",
                path(p)
            ),
            Shape::Dashed(p) => writeln!(
                out,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.2\" stroke-dasharray=\"6 4\"/>",
                path(p)
            ),
            Shape::Band(p) => {
                let mut loop_: Vec<(f64, f64)> = p.iter().map(|p| (p.0, p.1)).collect();
                loop_.extend(p.iter().rev().map(|p| (p.0, p.2)));
                writeln!(
                    out,
                    "<polygon points=\"{}\" fill=\"{colour}\" fill-opacity=\"0.2\"/>",
                    path(&loop_)
                )
            }
            Shape::Dots(p) => {
                for (a, b) in p {
                    let _ = writeln!(
                        out,
                        "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"4\" fill=\"{colour}\" stroke=\"black\"/>",
                        x.at(*a),
                        y.at(*b)
                    );
                }
                Ok(())
            }
        };
    }
    legend(panel, out);
}

fn axes(panel: &Panel, x: &Scale, y: &Scale, out: &mut String) {
    let (left, right, top, bottom) = (LEFT, WIDTH - RIGHT, TOP, HEIGHT - BOTTOM);
    let named = panel.x_names.iter().enumerate();
    let mut ticks: Vec<(f64, String)> = named.map(|(i, n)| ((i + 1) as f64, n.clone())).collect();
    if ticks.is_empty() {
        ticks = x.ticks().into_iter().map(|t| (t, number(t))).collect();
    }
    for (tick, name) in ticks {
        let at = x.at(tick);
        let _ = writeln!(
            out,
            "<line x1=\"{at:.2}\" y1=\"{top}\" x2=\"{at:.2}\" y2=\"{bottom}\" stroke=\"#e5e5e5\"/><text x=\"{at:.2}\" y=\"{}\" text-anchor=\"middle\">{name}</text>",
            bottom + 16.0,
        );
    }
    for tick in y.ticks() {
        let at = y.at(tick);
        let _ = writeln!(
            out,
            "<line x1=\"{left}\" y1=\"{at:.2}\" x2=\"{right}\" y2=\"{at:.2}\" stroke=\"#e5e5e5\"/><text x=\"{}\" y=\"{:.2}\" text-anchor=\"end\">{}</text>",
            left - 6.0,
            at + 4.0,
            number(tick)
        );
    }
    let middle = 0.5 * (top + bottom);
    let _ = writeln!(
        out,
        "<rect x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"black\"/>\n<text x=\"{left}\" y=\"{}\" font-size=\"13\" font-weight=\"bold\">{}</text>\n<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n<text transform=\"translate(16 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        right - left,
        bottom - top,
        top - 12.0,
        panel.title,
        0.5 * (left + right),
        bottom + 36.0,
        panel.x_label,
        panel.y_label
    );
}

fn number(x: f64) -> String {
    if x != 0.0 && !(1e-4..1e6).contains(&x.abs()) {
        return format!("{x:.0e}");
    }
    let text = format!("{x:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

fn legend(panel: &Panel, out: &mut String) {
    let x = WIDTH - RIGHT + 14.0;
    let named = panel.layers.iter().filter(|l| !l.name.is_empty());
    for (i, layer) in named.enumerate() {
        let y = TOP + 12.0 + 18.0 * i as f64;
        let (colour, end) = (layer.colour, x + 24.0);
        let _ = match &layer.shape {
            Shape::Line(_) => writeln!(
                out,
                "<line x1=\"{x}\" y1=\"{y}\" x2=\"{end}\" y2=\"{y}\" stroke=\"{colour}\" stroke-width=\"1.6\"/>"
            ),
            Shape::Dashed(_) => writeln!(
                out,
                "<line x1=\"{x}\" y1=\"{y}\" x2=\"{end}\" y2=\"{y}\" stroke=\"{colour}\" stroke-width=\"1.2\" stroke-dasharray=\"6 4\"/>"
            ),
            Shape::Band(_) => writeln!(
                out,
                "<rect x=\"{x}\" y=\"{}\" width=\"24\" height=\"10\" fill=\"{colour}\" fill-opacity=\"0.2\"/>",
                y - 5.0
            ),
            Shape::Dots(_) => writeln!(
                out,
                "<circle cx=\"{}\" cy=\"{y}\" r=\"4\" fill=\"{colour}\" stroke=\"black\"/>",
                x + 12.0
            ),
        };
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\">{}</text>",
            x + 30.0,
            y + 4.0,
            layer.name
        );
    }
}
