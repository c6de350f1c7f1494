//! Samples of a time plot in the format of `curves.js`: times as 32-bit floats relative to the first, values as 16-bit
//! steps between minimum and maximum. A screen of 4,000 lines shows one step in sixteen.

use crate::error::PageError;
use crate::series::{Mark, Plot, Series};
use crate::template::{Html, island};
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

/// Samples of the plot, as JSON.
pub(crate) fn packed(plot: &Plot) -> Result<Html, PageError> {
    let is_band = |s: &&Series| s.mark == Mark::Band;
    let lines: Vec<&Series> = plot.series.iter().filter(|s| !is_band(s)).collect();
    let same = |k: usize| lines[..k].iter().position(|o| same_times(o, lines[k]));
    let band = plot.series.iter().find(is_band);
    island(&Curves {
        title: &plot.title,
        group: &plot.group,
        x: [&plot.x.label, &plot.x.unit],
        y: [&plot.y.label, &plot.y.unit],
        height: plot.height,
        levels: &plot.levels,
        series: (0..lines.len()).map(|k| pack(lines[k], same(k))).collect(),
        band: band.map(|s| s.points.iter().map(|p| p.1).fold(0.0, f64::max)),
    })
}

fn same_times(a: &Series, b: &Series) -> bool {
    let mut pairs = a.points.iter().zip(&b.points);
    a.points.len() == b.points.len() && pairs.all(|(a, b)| a.0 == b.0)
}

fn pack<'a>(s: &'a Series, same: Option<usize>) -> Packed<'a> {
    let start = s.points.first().map_or(0.0, |p| p.0);
    let times = s.points.iter().map(|p| (p.0 - start) as f32);
    let bytes: Vec<u8> = match same {
        Some(_) => Vec::new(),
        None => times.flat_map(f32::to_le_bytes).collect(),
    };
    let values = || s.points.iter().map(|p| p.1);
    let finite = || values().filter(|y| y.is_finite());
    let low = finite().fold(f64::INFINITY, f64::min);
    let span = finite().fold(f64::NEG_INFINITY, f64::max) - low;
    let step = if span > 0.0 { span / LAST } else { 1.0 };
    let code = |y: f64| match y.is_finite() {
        true => ((y - low) / step).round() as u16,
        false => NONE,
    };
    let codes: Vec<u8> = values().flat_map(|y| code(y).to_le_bytes()).collect();
    Packed {
        name: &s.name,
        mark: s.mark.key(),
        colour: s.colour,
        same,
        start,
        x: STANDARD.encode(bytes),
        low: if low.is_finite() { low } else { 0.0 },
        step,
        y: STANDARD.encode(codes),
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
