//! Samples of a time plot in the format of `curves.js`: times as 32-bit floats relative to the first, values as 16-bit
//! steps between minimum and maximum. A screen of 4,000 lines shows one step in sixteen.

use crate::markup::{escape, island};
use crate::series::{Mark, Plot, Series};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// Code of a value that is not finite.
const NONE: u16 = u16::MAX;
/// Largest code of a finite value.
const LAST: f64 = 65_534.0;

#[derive(Serialize)]
struct Curves<'a> {
    title: &'a str,
    group: &'a str,
    x: [&'a str; 2],
    y: [&'a str; 2],
    height: f64,
    levels: &'a [(f64, String)],
    series: Vec<Packed<'a>>,
    /// Half-height of a band about zero, or null.
    band: Option<f64>,
}

#[derive(Serialize)]
struct Packed<'a> {
    name: &'a str,
    mark: &'a str,
    colour: usize,
    /// Index of a series with the same times, or null.
    same: Option<usize>,
    start: f64,
    x: String,
    low: f64,
    step: f64,
    y: String,
}

/// Samples and an element for the plot; empty if they have no JSON form.
pub(crate) fn packed(plot: &Plot) -> String {
    let lines: Vec<&Series> = plot
        .series
        .iter()
        .filter(|s| s.mark != Mark::Band)
        .collect();
    let series = lines
        .iter()
        .enumerate()
        .map(|(k, s)| pack(s, lines[..k].iter().position(|o| same_times(o, s))))
        .collect();
    let band = plot.series.iter().find(|s| s.mark == Mark::Band);
    let data = Curves {
        title: &plot.title,
        group: &plot.group,
        x: [&plot.x.label, &plot.x.unit],
        y: [&plot.y.label, &plot.y.unit],
        height: plot.height,
        levels: &plot.levels,
        series,
        band: band.map(|s| s.points.iter().map(|p| p.1).fold(0.0, f64::max)),
    };
    let json = island(&data).unwrap_or_default();
    let json = json.as_str();
    let title = escape(&plot.title);
    format!(
        "<div class=\"canvas\" role=\"img\" tabindex=\"0\" aria-label=\"{title}\"></div>\
         <script type=\"application/json\" class=\"curves-data\">{json}</script>\
         <noscript><p class=\"empty\">Curves need JavaScript; <code>poinsot identify --figures svg</code> writes them as files.</p></noscript>"
    )
}

fn same_times(a: &Series, b: &Series) -> bool {
    a.points
        .iter()
        .map(|p| p.0)
        .eq(b.points.iter().map(|p| p.0))
}

fn pack<'a>(s: &'a Series, same: Option<usize>) -> Packed<'a> {
    let start = s.points.first().map_or(0.0, |p| p.0);
    let bytes: Vec<u8> = match same {
        Some(_) => Vec::new(),
        None => s
            .points
            .iter()
            .flat_map(|p| ((p.0 - start) as f32).to_le_bytes())
            .collect(),
    };
    let finite = || s.points.iter().map(|p| p.1).filter(|y| y.is_finite());
    let low = finite().fold(f64::INFINITY, f64::min);
    let span = finite().fold(f64::NEG_INFINITY, f64::max) - low;
    let step = if span > 0.0 { span / LAST } else { 1.0 };
    let values: Vec<u8> = s
        .points
        .iter()
        .map(|p| match p.1.is_finite() {
            true => ((p.1 - low) / step).round() as u16,
            false => NONE,
        })
        .flat_map(u16::to_le_bytes)
        .collect();
    Packed {
        name: &s.name,
        mark: match s.mark {
            Mark::Dots | Mark::Points => "dots",
            Mark::Dashed => "dashed",
            _ => "line",
        },
        colour: s.colour,
        same,
        start,
        x: STANDARD.encode(bytes),
        low: if low.is_finite() { low } else { 0.0 },
        step,
        y: STANDARD.encode(values),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn exact_values_come_back_to_half_a_step() {
        let x: Vec<f64> = (0..100).map(|k| 1.0e6 + 0.01 * f64::from(k)).collect();
        let mut y: Vec<f64> = x.iter().map(|x| (3.0 * x).sin()).collect();
        y[7] = f64::NAN;
        let series = Series::new("a", Mark::Line, 0, &x, &y);
        let packed = pack(&series, None);
        let bytes = STANDARD.decode(&packed.y).unwrap();
        for (k, pair) in bytes.chunks_exact(2).enumerate() {
            let step = u16::from_le_bytes([pair[0], pair[1]]);
            if k == 7 {
                assert_eq!(step, NONE);
            } else {
                let back = packed.low + packed.step * f64::from(step);
                assert!((back - y[k]).abs() <= 0.51 * packed.step);
            }
        }
        let times = STANDARD.decode(&packed.x).unwrap();
        let last = f32::from_le_bytes(times[396..].try_into().unwrap());
        assert!((packed.start + f64::from(last) - x[99]).abs() < 1.0e-6);
    }
}
