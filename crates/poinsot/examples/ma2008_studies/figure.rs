//! Small line figures as SVG: axes with units, a legend, bands, marks.

use std::fmt::Write;

/// One line, with a band around it where there is one.
pub struct Series {
    pub name: String,
    pub points: Vec<(f64, f64)>,
    /// Lower and upper edge at each point.
    pub band: Vec<(f64, f64)>,
}

/// One set of axes.
pub struct Panel {
    pub title: String,
    pub x_label: String,
    pub y_label: String,
    pub log_x: bool,
    pub log_y: bool,
    pub series: Vec<Series>,
    /// Vertical marks with a label.
    pub marks: Vec<(f64, String)>,
}

const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 280.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 46.0;
const COLOURS: [&str; 6] = [
    "#0b5fa5", "#c8511b", "#2c7a3f", "#7b3fa0", "#8a6d00", "#444444",
];

/// Panels side by side, `columns` in a row.
pub fn svg(panels: &[Panel], columns: usize) -> String {
    let rows = panels.len().div_ceil(columns);
    let (w, h) = (WIDTH * columns as f64, HEIGHT * rows as f64);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\" font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for (k, panel) in panels.iter().enumerate() {
        let (x, y) = (WIDTH * (k % columns) as f64, HEIGHT * (k / columns) as f64);
        let _ = writeln!(
            out,
            "<g transform=\"translate({x},{y})\">\n{}</g>",
            one(panel)
        );
    }
    out.push_str("</svg>\n");
    out
}

struct Axis {
    low: f64,
    high: f64,
    log: bool,
    from: f64,
    to: f64,
}

impl Axis {
    fn new(values: impl Iterator<Item = f64>, log: bool, from: f64, to: f64) -> Self {
        let good = values.filter(|v| v.is_finite() && (!log || *v > 0.0));
        let (mut low, mut high) = good.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
            (a.min(v), b.max(v))
        });
        if low > high {
            (low, high) = if log { (0.1, 1.0) } else { (0.0, 1.0) };
        }
        if log {
            (low, high) = (
                10.0_f64.powf(low.log10().floor()),
                10.0_f64.powf(high.log10().ceil()),
            );
        }
        if !log && high > low {
            let room = 0.06 * (high - low);
            (low, high) = (low - room, high + room);
        }
        if high <= low {
            (low, high) = if log {
                (low / 10.0, high * 10.0)
            } else {
                (low - 0.5, high + 0.5)
            };
        }
        Self {
            low,
            high,
            log,
            from,
            to,
        }
    }

    fn at(&self, v: f64) -> f64 {
        let share = if self.log {
            (v.max(self.low).ln() - self.low.ln()) / (self.high.ln() - self.low.ln())
        } else {
            (v - self.low) / (self.high - self.low)
        };
        self.from + (self.to - self.from) * share.clamp(0.0, 1.0)
    }

    fn ticks(&self) -> Vec<f64> {
        if self.log {
            let (a, b) = (
                self.low.log10().round() as i32,
                self.high.log10().round() as i32,
            );
            let step = ((b - a) / 7).max(1);
            return (a..=b)
                .step_by(step as usize)
                .map(|e| 10.0_f64.powi(e))
                .collect();
        }
        let raw = (self.high - self.low) / 5.0;
        let size = 10.0_f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .iter()
            .map(|m| m * size)
            .find(|s| *s >= raw)
            .unwrap_or(raw);
        let first = (self.low / step).ceil() as i64;
        let last = (self.high / step).floor() as i64;
        (first..=last).map(|k| k as f64 * step).collect()
    }
}

fn one(panel: &Panel) -> String {
    let points = || panel.series.iter().flat_map(|s| &s.points);
    let bands = panel
        .series
        .iter()
        .flat_map(|s| &s.band)
        .flat_map(|b| [b.0, b.1]);
    let x = Axis::new(points().map(|p| p.0), panel.log_x, LEFT, WIDTH - RIGHT);
    let y = Axis::new(
        points().map(|p| p.1).chain(bands),
        panel.log_y,
        HEIGHT - BOTTOM,
        TOP,
    );
    let mut out = format!(
        "<text x=\"{LEFT}\" y=\"18\" font-weight=\"bold\">{}</text>\n<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#333\"/>\n",
        panel.title,
        WIDTH - RIGHT - LEFT,
        HEIGHT - BOTTOM - TOP
    );
    for t in x.ticks() {
        let at = x.at(t);
        let _ = writeln!(
            out,
            "<line x1=\"{at:.1}\" y1=\"{TOP}\" x2=\"{at:.1}\" y2=\"{}\" stroke=\"#ddd\"/><text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            HEIGHT - BOTTOM,
            HEIGHT - BOTTOM + 14.0,
            short(t)
        );
    }
    for t in y.ticks() {
        let at = y.at(t);
        let _ = writeln!(
            out,
            "<line x1=\"{LEFT}\" y1=\"{at:.1}\" x2=\"{}\" y2=\"{at:.1}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            WIDTH - RIGHT,
            LEFT - 4.0,
            at + 4.0,
            short(t)
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
        (LEFT + WIDTH - RIGHT) / 2.0,
        HEIGHT - 10.0,
        panel.x_label
    );
    let middle = (TOP + HEIGHT - BOTTOM) / 2.0;
    let _ = writeln!(
        out,
        "<text x=\"14\" y=\"{middle}\" text-anchor=\"middle\" transform=\"rotate(-90 14 {middle})\">{}</text>",
        panel.y_label
    );
    for (at, label) in &panel.marks {
        let at = x.at(*at);
        let _ = writeln!(
            out,
            "<line x1=\"{at:.1}\" y1=\"{TOP}\" x2=\"{at:.1}\" y2=\"{}\" stroke=\"#999\" stroke-dasharray=\"3 3\"/><text x=\"{:.1}\" y=\"{}\">{label}</text>",
            HEIGHT - BOTTOM,
            at + 3.0,
            HEIGHT - BOTTOM - 4.0
        );
    }
    let corner = legend_corner(panel, &x, &y);
    for (k, s) in panel.series.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let place = |p: &(f64, f64)| format!("{:.1},{:.1}", x.at(p.0), y.at(p.1));
        if !s.band.is_empty() {
            let lower = s.points.iter().zip(&s.band).map(|(p, b)| (p.0, b.0));
            let upper = s.points.iter().zip(&s.band).rev().map(|(p, b)| (p.0, b.1));
            let edge: Vec<String> = lower.chain(upper).map(|p| place(&p)).collect();
            let _ = writeln!(
                out,
                "<polygon points=\"{}\" fill=\"{colour}\" opacity=\"0.15\"/>",
                edge.join(" ")
            );
        }
        let line: Vec<String> = s
            .points
            .iter()
            .filter(|p| p.1.is_finite())
            .map(place)
            .collect();
        let _ = writeln!(
            out,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"/>",
            line.join(" ")
        );
        let at = corner + 14.0 * k as f64;
        let _ = writeln!(
            out,
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"{colour}\" stroke-width=\"2\"/><text x=\"{}\" y=\"{at}\">{}</text>",
            LEFT + 8.0,
            at - 4.0,
            LEFT + 26.0,
            at - 4.0,
            LEFT + 30.0,
            s.name
        );
    }
    out
}

/// First line of the legend: at the top, in the middle or at the bottom, where the fewest points are.
fn legend_corner(panel: &Panel, x: &Axis, y: &Axis) -> f64 {
    let height = 14.0 * panel.series.len() as f64;
    let places = [
        TOP + 14.0,
        (TOP + HEIGHT - BOTTOM - height) / 2.0 + 14.0,
        HEIGHT - BOTTOM - height,
    ];
    let crowd = |top: f64| {
        panel
            .series
            .iter()
            .flat_map(|s| &s.points)
            .filter(|p| x.at(p.0) < LEFT + 180.0)
            .filter(|p| (top - 20.0..top + height).contains(&y.at(p.1)))
            .count()
    };
    places
        .into_iter()
        .min_by_key(|top| crowd(*top))
        .unwrap_or(TOP + 14.0)
}

fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let a = x.abs();
    if (1.0e-3..1.0e4).contains(&a) {
        format!("{}", (x * 1.0e6).round() / 1.0e6)
    } else {
        format!("{x:.0e}")
    }
}
