//! The evidence with every test, possible causes, and one row per sensor with its curves. Green is folded, red is open.

use super::Answer;
use super::curves::{Differences, named, over_time, picked, series};
use super::envelope::Envelope;
use crate::checks::{SIGNIFICANT, Verdict, causes};
use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::{Axis, Figure, Mark, PageError, Part, Plot, Series, Tone};
use poinsot_formats::{
    Channel, EvidenceFile, HALF_WIDTH_95, Segment, SegmentFitFile, SensorFitFile,
};
use statrs::distribution::{ContinuousCDF, Normal};
use std::cmp::Reverse;

/// Half-range of the histogram, sigmas.
const REACH: f64 = 4.0;
/// Chi-square per number for which a residual has the size of the declared noise.
const AS_DECLARED: std::ops::RangeInclusive<f64> = 0.5..=1.2;
const ARCSEC_PER_RAD: f64 = 180.0 * 3600.0 / std::f64::consts::PI;
const AXES: [&str; 3] = ["x", "y", "z"];

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let envelope = Envelope::of(&answer.data.segments);
    let mut figures = Vec::new();
    let mut records: Vec<Value> = Vec::new();
    for (k, fit) in e.fit.iter().enumerate() {
        let segment = answer.data.segments.get(k);
        records.push(record(k, fit, segment, &envelope, &mut figures)?);
    }
    let trace = convergence(&answer.data.costs).map(|plot| Figure::plot("convergence", plot));
    let steps = trace.as_ref().map(Figure::html).transpose()?;
    figures.extend(trace);
    let against = |row: &&EvidenceFile| row.is_against_answer();
    let body = TEMPLATES.html(
        "trust.html",
        context! {
            records,
            steps => steps.map(|html| html.value()),
            steps_taken => answer.data.costs.len().saturating_sub(1),
            causes => causes(e),
            evidence => e.evidence,
            against => e.evidence.iter().filter(against).count(),
            reduced => envelope.note(),
            validate => !e.is_withheld(),
        },
    )?;
    Ok(Part::new("trust", "Trust", body).with_figures(figures))
}

/// Cost of every step of the fit above the last; `None` without a higher one.
fn convergence(costs: &[f64]) -> Option<Plot> {
    let last = costs.last()?;
    let above = costs.iter().enumerate().map(|(k, x)| (k as f64, x - last));
    let (steps, above): (Vec<f64>, Vec<f64>) = above.filter(|p| p.1 > 0.0).unzip();
    let series = |mark| Series::new("", mark, 0, &steps, &above);
    (!steps.is_empty()).then(|| Plot {
        title: "cost above that of the last step".to_owned(),
        x: Axis::new("step", ""),
        whole: true,
        y: Axis::new("cost", ""),
        log: true,
        series: vec![series(Mark::Line), series(Mark::Points)],
        levels: vec![(1.0, "one sigma".to_owned())],
        half: true,
        note: "Cost: minus twice the log-likelihood. What lowers it by less than 1 moves the answer by less than one sigma.".to_owned(),
        ..Plot::default()
    })
}

/// A record with its sensors; adds its figures.
fn record(
    k: usize,
    fit: &SegmentFitFile,
    segment: Option<&Segment>,
    envelope: &Envelope,
    figures: &mut Vec<Figure>,
) -> Result<Value, PageError> {
    let mut sensors: Vec<Value> = Vec::new();
    for (name, s) in &fit.channels {
        let channel = segment.and_then(|d| d.channels.iter().find(|c| c.name == *name));
        let made = channel.map_or_else(Vec::new, |c| sensor(k, c, s, envelope));
        let (tone, word) = sensor_verdict(s);
        let (factor, unit) = shown_unit(name, &s.unit);
        sensors.push(context! {
            name, tone, word, factor, unit, declared => declared(s),
            figures => Figure::page(&made)?.value(), fit => s,
        });
        figures.extend(made);
    }
    let measured = segment.filter(|d| !d.momentum.time_s.is_empty());
    let drift = measured.map_or_else(Vec::new, |d| momentum(k, &d.momentum, envelope));
    let html = Figure::page(&drift)?;
    figures.extend(drift);
    let (tone, word) = record_verdict(fit);
    Ok(context! {
        tone, word, sensors, label => fit.segment, samples => fit.samples, chi2 => fit.chi2_per_dof,
        momentum => html.value(),
    })
}

fn sensor_verdict(s: &SensorFitFile) -> Verdict {
    let correlated = s.whiteness_p.is_some_and(|p| p < SIGNIFICANT);
    match s.chi2_per_number {
        Some(chi2) if chi2 > *AS_DECLARED.end() => (Tone::Bad, "larger than declared"),
        Some(chi2) if chi2 < *AS_DECLARED.start() => (Tone::Fair, "smaller than declared"),
        _ if correlated => (Tone::Bad, "correlated in time"),
        Some(_) => (Tone::Good, "as declared"),
        None => (Tone::Fair, "not tested"),
    }
}

/// Worst verdict among its sensors.
fn record_verdict(fit: &SegmentFitFile) -> Verdict {
    let all = fit.channels.values().map(sensor_verdict);
    let worst = all.min_by_key(|v| Reverse(v.0));
    worst.unwrap_or((Tone::Fair, "not tested"))
}

/// Declared sigma used in chi-square.
fn declared(s: &SensorFitFile) -> Option<f64> {
    let chi2 = s.chi2_per_number.filter(|c| *c > 0.0)?;
    Some(s.rms? / chi2.sqrt())
}

/// Kind of the sensor `<kind>` or `<kind>.<name>`.
fn kind(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}

/// Display factor and unit of a residual.
fn shown_unit<'a>(name: &str, unit: &'a str) -> (f64, &'a str) {
    match (kind(name), unit) {
        ("attitude", "rad") => (ARCSEC_PER_RAD, "arcsec"),
        _ => (1.0, unit),
    }
}

fn sensor(record: usize, c: &Channel, s: &SensorFitFile, envelope: &Envelope) -> Vec<Figure> {
    let mut all = Vec::new();
    if kind(&c.name) != "attitude" {
        all.push(("", curves(record, c, envelope)));
    }
    all.push(("_residual", residuals(record, c, declared(s), envelope)));
    all.extend(quantiles(c).map(|p| ("_quantiles", p)));
    all.extend(correlation(c).map(|p| ("_correlation", p)));
    named(&format!("fit_segment{}_{}", record + 1, c.name), all)
}

fn momentum(record: usize, m: &Channel, envelope: &Envelope) -> Vec<Figure> {
    let mut plot = curves(record, m, envelope);
    plot.title = "angular momentum about the mass centre, inertial axes".to_owned();
    plot.y.label = "h".to_owned();
    plot.note =
        "Points: from the measured rates with the estimated mass properties. Lines: predicted."
            .to_owned();
    let mut gap = residuals(record, m, None, envelope);
    gap.title = "angular momentum, measured minus predicted".to_owned();
    let prefix = format!("fit_segment{}_momentum", record + 1);
    named(&prefix, vec![("", plot), ("_residual", gap)])
}

/// Title and symbol of what a sensor measures.
fn quantity(name: &str) -> (String, &str) {
    let word = kind(name);
    let seen = word.strip_prefix("relative_");
    let (what, axes, symbol) = match seen.unwrap_or(word) {
        "gyro" => ("angular velocity", "body axes", "omega"),
        "velocity" => ("velocity of the sensor point", "inertial axes", "v"),
        "position" => ("position of the sensor point", "inertial axes", "r"),
        "accelerometer" => (
            "specific force at the sensor point",
            "axes of its body",
            "f",
        ),
        "velocity_increment" => (
            "velocity increments of the sensor point",
            "inertial axes",
            "dv",
        ),
        _ => return (word.replace('_', " "), word),
    };
    let axes = seen.map_or(axes, |_| "axes of the observing body");
    (format!("{what}, {axes}"), symbol)
}

/// Measured points and predicted lines.
fn curves(record: usize, c: &Channel, envelope: &Envelope) -> Plot {
    let kept = envelope.keep(&c.time_s, &c.residual);
    let time = picked(&c.time_s, &kept, 1.0);
    let rows = |values: &[Vec<f64>]| -> Vec<Vec<f64>> {
        values.iter().map(|row| picked(row, &kept, 1.0)).collect()
    };
    let measured = rows(&c.measured).into_iter().map(|row| ("", row));
    let names = c.components.iter().map(String::as_str);
    let predicted = names.zip(rows(&c.predicted));
    let points = series(Mark::Dots, &time, measured);
    let lines = series(Mark::Line, &time, predicted);
    let (title, symbol) = quantity(&c.name);
    let title = format!("{title}: points measured, lines predicted");
    let both = points.into_iter().zip(lines).flat_map(|(p, l)| [p, l]);
    let plot = over_time(record, title, Axis::new(symbol, &c.unit), both.collect());
    Plot {
        height: 210.0,
        ..plot
    }
}

fn residuals(record: usize, c: &Channel, declared: Option<f64>, envelope: &Envelope) -> Plot {
    let (factor, unit) = shown_unit(&c.name, &c.residual_unit);
    let title = match kind(&c.name) {
        "attitude" => "rotation error from predicted to measured, body axes",
        _ => "residual, measured minus predicted",
    };
    let differences = Differences {
        record,
        title: title.to_owned(),
        y: Axis::new("residual", unit),
        factor,
        declared,
        names: &AXES,
        time_s: &c.time_s,
        rows: &c.residual,
    };
    differences.plot(envelope)
}

/// Whitened residuals of all axes against normal quantiles, at the edges of the histogram bins.
fn quantiles(c: &Channel) -> Option<Plot> {
    let bars = c.histogram.iter().map(Vec::len).max()?;
    let mut counts = vec![0_u64; bars];
    for row in &c.histogram {
        for (sum, n) in counts.iter_mut().zip(row) {
            *sum += n;
        }
    }
    let total: u64 = counts.iter().sum();
    let width = 2.0 * REACH / bars as f64;
    let normal = Normal::standard();
    let (mut x, mut y, mut below) = (Vec::new(), Vec::new(), 0);
    for (k, n) in counts.iter().enumerate().take(bars.saturating_sub(1)) {
        below += n;
        if below > 0 && below < total {
            x.push(normal.inverse_cdf(below as f64 / total as f64));
            y.push(-REACH + (k + 1) as f64 * width);
        }
    }
    let ends = [-REACH, REACH];
    (!x.is_empty()).then(|| Plot {
        title: format!("{} residual against the normal distribution", c.name),
        x: Axis::new("normal quantile", "sigma"),
        y: Axis::new("residual", "sigma"),
        series: vec![
            Series::new("as declared", Mark::Dashed, 6, &ends, &ends),
            Series::new("found", Mark::Points, 0, &x, &y),
        ],
        half: true,
        ..Plot::default()
    })
}

fn correlation(c: &Channel) -> Option<Plot> {
    let series: Vec<Series> = c
        .autocorrelation
        .iter()
        .enumerate()
        .filter(|(_, row)| !row.is_empty())
        .map(|(k, row)| {
            let lags: Vec<f64> = (1..=row.len()).map(|l| l as f64).collect();
            Series::new(AXES.get(k).unwrap_or(&""), Mark::Line, k, &lags, row)
        })
        .collect();
    let edge = HALF_WIDTH_95 / (c.samples.max(1) as f64).sqrt();
    (!series.is_empty()).then(|| Plot {
        title: format!("{} residual, autocorrelation", c.name),
        x: Axis::new("lag", "samples"),
        whole: true,
        y: Axis::new("correlation", ""),
        series,
        levels: vec![(edge, "95 % if white".to_owned()), (-edge, String::new())],
        half: true,
        ..Plot::default()
    })
}
