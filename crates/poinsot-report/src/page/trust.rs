//! Tests of the residuals, the evidence with every test, and one row per sensor with its curves. Green is folded, red is
//! open; the evidence is always folded.

use super::Answer;
use super::envelope::Envelope;
use super::numbers::ninety_five;
use crate::checks::{SIGNIFICANT, causes, checks};
use minijinja::{Value, context};
use poinsot_figures::{Axis, Figure, Mark, PageError, Part, Plot, Series, render};
use poinsot_files::{probability, significant};
use poinsot_formats::Channel;
use poinsot_formats::{EstimateFile, EvidenceFile, SegmentFitFile, SensorFitFile};
use statrs::distribution::{ContinuousCDF, Normal};

/// Half-range of the histogram, sigmas.
const REACH: f64 = 4.0;
/// Chi-square per number for which a residual has the size of the declared noise.
const AS_DECLARED: std::ops::RangeInclusive<f64> = 0.5..=1.2;
/// Half-width of the band about a residual, sigmas.
pub(super) const BAND: f64 = 2.0;
const ARCSEC_PER_RAD: f64 = 180.0 * 3600.0 / std::f64::consts::PI;

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let tests: Vec<Value> = e
        .diagnostics
        .iter()
        .flat_map(|d| checks(d).into_iter().chain(causes(d)))
        .map(|c| context! { test => c.test, found => c.found, tone => c.tone.name(), verdict => c.verdict })
        .collect();
    let envelope = Envelope::of(&answer.data);
    let mut figures = Vec::new();
    let mut records: Vec<Value> = Vec::new();
    for (k, fit) in e.fit.iter().enumerate() {
        let segment = answer.data.segments.get(k);
        let mut sensors: Vec<Value> = Vec::new();
        for (name, s) in &fit.channels {
            let channel = segment.and_then(|d| d.channels.iter().find(|c| c.name == *name));
            let made = channel.map_or_else(Vec::new, |c| sensor(k, c, s, &envelope));
            sensors.push(sensor_row(name, s, &Figure::page(&made)?.value()));
            figures.extend(made);
        }
        let drift = segment
            .filter(|d| !d.momentum.time_s.is_empty())
            .map_or_else(Vec::new, |d| momentum(k, &d.momentum, &envelope));
        records.push(context! {
            label => fit.segment,
            samples => fit.samples,
            chi2 => fit.chi2_per_dof.map(|x| significant(x, 3)),
            verdict => record_verdict(fit),
            sensors,
            momentum => (!drift.is_empty()).then(|| Figure::page(&drift)).transpose()?.map(|h| h.value()),
        });
        figures.extend(drift);
    }
    let body = render(
        "trust.html",
        include_str!("templates/trust.html"),
        context! {
            tests, records,
            evidence => evidence(e),
            against => e.evidence.iter().filter(|row| row.is_against_answer()).count(),
            red => tests.iter().any(is_bad),
            reduced => envelope.words(),
            validate => !e.is_withheld(),
        },
    )?;
    Ok(Part {
        id: "trust",
        title: "Trust",
        body,
        figures,
    })
}

/// Every test with its effect on the answer.
fn evidence(e: &EstimateFile) -> Vec<Value> {
    let rows = e.evidence.iter();
    rows.map(|row| {
        let (tone, effect) = effect(row);
        context! {
            tone, effect,
            test => row.test,
            statistic => row.statistic,
            value => row.value.map(|x| significant(x, 3)),
            dof => row.degrees_of_freedom,
            p => row.p.map(probability),
            words => row.words,
        }
    })
    .collect()
}

/// Tone and words of the effect of a test.
fn effect(row: &EvidenceFile) -> (&'static str, String) {
    let factor = row.sigma_factor.filter(|factor| *factor > 1.0);
    let widened = factor.map(|factor| format!("sigmas times {}", significant(factor, 4)));
    let (tone, words) = match row.effect.as_str() {
        "none" => ("good", "none"),
        "widens_sigmas" => return ("fair", widened.unwrap_or_default()),
        "makes_partial" => ("fair", "partial"),
        "against_answer" => ("bad", "not reliable"),
        "withholds_numbers" => ("bad", "withheld"),
        "rejects_model" => ("bad", "rejected"),
        _ => ("fair", ""),
    };
    let parts = std::iter::once(words.to_owned()).chain(widened);
    (tone, parts.collect::<Vec<_>>().join(", "))
}

fn is_bad(row: &Value) -> bool {
    row.get_attr("tone")
        .is_ok_and(|t| t.as_str() == Some("bad"))
}

fn sensor_verdict(s: &SensorFitFile) -> (&'static str, &'static str) {
    let correlated = s.whiteness_p.is_some_and(|p| p < SIGNIFICANT);
    match s.chi2_per_number {
        Some(chi2) if chi2 > *AS_DECLARED.end() => ("bad", "larger than declared"),
        Some(chi2) if chi2 < *AS_DECLARED.start() => ("fair", "smaller than declared"),
        _ if correlated => ("bad", "correlated in time"),
        Some(_) => ("good", "as declared"),
        None => ("fair", "not tested"),
    }
}

/// Worst verdict among its sensors.
fn record_verdict(fit: &SegmentFitFile) -> Value {
    let all = || fit.channels.values().map(sensor_verdict);
    let worst = ["bad", "fair", "good"]
        .into_iter()
        .find_map(|tone| all().find(|v| v.0 == tone));
    let (tone, word) = worst.unwrap_or(("fair", "not tested"));
    context! { tone, word }
}

fn sensor_row(name: &str, s: &SensorFitFile, figures: &Value) -> Value {
    let (tone, word) = sensor_verdict(s);
    let (factor, unit) = shown_unit(name, &s.unit);
    let declared = declared(s).map(|sigma| significant(factor * sigma, 3));
    context! {
        name, tone, word, figures, unit, declared,
        rms => s.rms.map(|x| significant(factor * x, 3)),
        chi2 => s.chi2_per_number.map(|x| significant(x, 3)),
        p => s.whiteness_p.map(probability),
    }
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
    let name = |what: &str| format!("fit_segment{}_{}{what}", record + 1, c.name);
    let kept = envelope.keep(c);
    let mut all = Vec::new();
    if kind(&c.name) != "attitude" {
        all.push(Figure::plot(&name(""), curves(record, c, &kept)));
    }
    all.push(Figure::plot(
        &name("_residual"),
        residuals(record, c, declared(s), &kept),
    ));
    all.extend(quantiles(c).map(|p| Figure::plot(&name("_quantiles"), p)));
    all.extend(correlation(c).map(|p| Figure::plot(&name("_correlation"), p)));
    all
}

fn momentum(record: usize, m: &Channel, envelope: &Envelope) -> Vec<Figure> {
    let kept = envelope.keep(m);
    let name = |what: &str| format!("fit_segment{}_momentum{what}", record + 1);
    let mut plot = curves(record, m, &kept);
    plot.title = "angular momentum about the mass centre, inertial axes".to_owned();
    plot.y.label = "h".to_owned();
    plot.note =
        "Points: from the measured rates with the estimated mass properties. Lines: predicted."
            .to_owned();
    let mut gap = residuals(record, m, None, &kept);
    gap.title = "angular momentum, measured minus predicted".to_owned();
    vec![
        Figure::plot(&name(""), plot),
        Figure::plot(&name("_residual"), gap),
    ]
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
    let axes = seen.map_or(axes, |_| "axes of the body from which it is seen");
    (format!("{what}, {axes}"), symbol)
}

fn picked(row: &[f64], kept: &[usize], factor: f64) -> Vec<f64> {
    let value = |k: &usize| row.get(*k).map_or(f64::NAN, |x| factor * x);
    kept.iter().map(value).collect()
}

fn curves(record: usize, c: &Channel, kept: &[usize]) -> Plot {
    let time = picked(&c.time_s, kept, 1.0);
    let mut series = Vec::new();
    for (k, name) in c.components.iter().enumerate() {
        if let (Some(m), Some(p)) = (c.measured.get(k), c.predicted.get(k)) {
            series.push(Series::new("", Mark::Dots, k, &time, &picked(m, kept, 1.0)));
            series.push(Series::new(
                name,
                Mark::Line,
                k,
                &time,
                &picked(p, kept, 1.0),
            ));
        }
    }
    let (title, symbol) = quantity(&c.name);
    Plot {
        title: format!("{title}: points measured, lines predicted"),
        x: Axis::new("time", "s"),
        y: Axis::new(symbol, &c.unit),
        series,
        group: group(record),
        height: 210.0,
        ..Plot::default()
    }
}

/// Group of the plots of a record, which share cursor and zoom.
pub(super) fn group(record: usize) -> String {
    format!("record{}", record + 1)
}

fn residuals(record: usize, c: &Channel, declared: Option<f64>, kept: &[usize]) -> Plot {
    let axes = ["x", "y", "z"];
    let (factor, unit) = shown_unit(&c.name, &c.residual_unit);
    let time = picked(&c.time_s, kept, 1.0);
    let mut series: Vec<Series> = c
        .residual
        .iter()
        .enumerate()
        .map(|(k, row)| {
            let name = axes.get(k).unwrap_or(&"");
            Series::new(name, Mark::Dots, k, &time, &picked(row, kept, factor))
        })
        .collect();
    if let (Some(sigma), Some(first), Some(last)) = (declared, time.first(), time.last()) {
        let half = BAND * factor * sigma;
        let ends = [*first, *last];
        series.insert(
            0,
            Series::band("2 sigma declared", 2, &ends, &[-half; 2], &[half; 2]),
        );
    }
    let what = match kind(&c.name) {
        "attitude" => "rotation error from predicted to measured, body axes",
        _ => "residual, measured minus predicted",
    };
    Plot {
        title: match declared {
            Some(_) => format!("{what}; band: {BAND} sigma as declared"),
            None => what.to_owned(),
        },
        x: Axis::new("time", "s"),
        y: Axis::new("residual", unit),
        series,
        levels: vec![(0.0, String::new())],
        group: group(record),
        height: 180.0,
        ..Plot::default()
    }
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
    let axes = ["x", "y", "z"];
    let series: Vec<Series> = c
        .autocorrelation
        .iter()
        .enumerate()
        .filter(|(_, row)| !row.is_empty())
        .map(|(k, row)| {
            let lags: Vec<f64> = (1..=row.len()).map(|l| l as f64).collect();
            Series::new(axes.get(k).unwrap_or(&""), Mark::Line, k, &lags, row)
        })
        .collect();
    let edge = ninety_five() / (c.samples.max(1) as f64).sqrt();
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
