//! Curves over time.

use super::envelope::Envelope;
use poinsot_figures::{Axis, Figure, Mark, Plot, Series};

/// Half-width of the band about a residual, sigmas.
const BAND: f64 = 2.0;

/// Group of the plots of a record, which share cursor and zoom.
pub(super) fn group(record: usize) -> String {
    format!("record{}", record + 1)
}

/// Values at the kept samples, times a factor.
pub(super) fn picked(row: &[f64], kept: &[usize], factor: f64) -> Vec<f64> {
    let value = |k: &usize| row.get(*k).map_or(f64::NAN, |x| factor * x);
    kept.iter().map(value).collect()
}

/// A plot over time of a record.
pub(super) fn over_time(record: usize, title: String, y: Axis, series: Vec<Series>) -> Plot {
    Plot {
        title,
        x: Axis::new("time", "s"),
        y,
        series,
        group: group(record),
        height: 190.0,
        ..Plot::default()
    }
}

/// One line or set of dots per name and row.
pub(super) fn series<'a>(
    mark: Mark,
    time: &[f64],
    rows: impl Iterator<Item = (&'a str, Vec<f64>)>,
) -> Vec<Series> {
    let one = |(k, (name, y)): (usize, (&str, Vec<f64>))| Series::new(name, mark, k, time, &y);
    rows.enumerate().map(one).collect()
}

/// Differences over time about zero, with the band of their declared sigma if there is one.
pub(super) struct Differences<'a> {
    pub record: usize,
    pub title: String,
    pub y: Axis,
    pub factor: f64,
    pub declared: Option<f64>,
    pub names: &'a [&'a str],
    pub time_s: &'a [f64],
    pub rows: &'a [Vec<f64>],
}

impl Differences<'_> {
    pub fn plot(self, envelope: &Envelope) -> Plot {
        let kept = envelope.keep(self.time_s, self.rows);
        let time = picked(self.time_s, &kept, 1.0);
        let name = |k: usize| self.names.get(k).copied().unwrap_or_default();
        let rows = self.rows.iter().enumerate();
        let rows = rows.map(|(k, row)| (name(k), picked(row, &kept, self.factor)));
        let mut all = series(Mark::Dots, &time, rows);
        let mut title = self.title;
        if let (Some(sigma), [first, .., last]) = (self.declared, &time[..]) {
            let half = BAND * self.factor * sigma;
            let (x, low, high) = ([*first, *last], [-half; 2], [half; 2]);
            all.insert(0, Series::band("2 sigma declared", 2, &x, &low, &high));
            title.push_str("; band: 2 sigma as declared");
        }
        Plot {
            levels: vec![(0.0, String::new())],
            height: 180.0,
            ..over_time(self.record, title, self.y, all)
        }
    }
}

/// A figure per plot, with its name.
pub(super) fn named(prefix: &str, plots: Vec<(&str, Plot)>) -> Vec<Figure> {
    let figure = |(name, plot): (&str, Plot)| Figure::plot(&format!("{prefix}{name}"), plot);
    plots.into_iter().map(figure).collect()
}
