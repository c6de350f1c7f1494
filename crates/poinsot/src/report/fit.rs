//! Section 5: measured and predicted, residuals, their statistics, momentum over time.

use super::Answer;
use super::data::{Channel, Segment};
use minijinja::{Value, context};
use poinsot_formats::SegmentFitFile;
use poinsot_identify::HISTOGRAM_BARS;
use poinsot_report::{Axis, Figure, Mark, PageError, Part, Plot, Series, render, significant};

/// Segments drawn; the numbers of all stand in the table.
const DRAWN: usize = 8;
/// Half the reach of the histogram, sigmas.
const REACH: f64 = 4.0;

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let rows: Vec<Value> = e.fit.iter().flat_map(rows).collect();
    let mut all = Vec::new();
    let mut segments: Vec<Value> = Vec::new();
    for (k, s) in answer.data.segments.iter().take(DRAWN).enumerate() {
        if !s.time_s.is_empty() || !s.channels.is_empty() {
            let made = figures(k, s);
            let html = Figure::page(&made)?;
            segments.push(context! { label => s.label, figures => html.value() });
            all.extend(made);
        }
    }
    let body = render(
        "fit.html",
        include_str!("templates/fit.html"),
        context! { rows, diagnostics => super::diagnostics::table(answer)?.value(), segments, more => answer.data.segments.len().saturating_sub(DRAWN) },
    )?;
    Ok(Part {
        id: "fit",
        title: "SegmentFitFile",
        body,
        figures: all,
    })
}

fn rows(fit: &SegmentFitFile) -> Vec<Value> {
    let show = |x: Option<f64>, figures| x.map(|x| significant(x, figures));
    let channels = &fit.channels;
    channels
        .iter()
        .enumerate()
        .map(|(k, (name, c))| {
            let white = c.whiteness_p;
            let word = match (white, c.chi2_per_number) {
                (_, Some(chi2)) if chi2 < 0.01 => ("far below the noise", ""),
                (Some(p), _) if p < 0.001 => ("correlated in time", "fair"),
                (Some(_), _) => ("white", "good"),
                (None, _) => ("", ""),
            };
            context! {
                segment => if k == 0 { fit.segment.as_str() } else { "" },
                samples => (k == 0).then_some(fit.samples),
                chi2 => if k == 0 { show(fit.chi2_per_dof, 4) } else { None },
                name, unit => c.unit,
                rms => show(c.rms, 3),
                per_number => show(c.chi2_per_number, 4),
                white => white.map(|p| format!("{p:.2}")),
                word => word.0,
                tone => word.1,
            }
        })
        .collect()
}

fn figures(segment_at: usize, segment: &Segment) -> Vec<Figure> {
    let group = format!("segment{segment_at}");
    let mut all = Vec::new();
    let mut push = |what: &str, plot: Plot| {
        if !plot.series.is_empty() {
            let name = format!("fit_segment{}_{what}", segment_at + 1);
            all.push(Figure::plot(&name, plot));
        }
    };
    for c in &segment.channels {
        push(&c.name, curves(c, &group));
        push(&format!("{}_residual", c.name), residuals(c, &group));
        push(&format!("{}_histogram", c.name), histogram(c));
        push(&format!("{}_correlation", c.name), correlation(c));
    }
    if !segment.momentum.time_s.is_empty() {
        let m = &segment.momentum;
        let mut plot = curves(m, &group);
        plot.title = "angular momentum about the mass centre, inertial axes".to_owned();
        plot.y.label = "h".to_owned();
        plot.note = "Points: from the measured rates with the estimated mass properties. Lines: as the answer predicts. \
                     Without external torque they are constant, whatever wheels and joints do."
            .to_owned();
        push("momentum", plot);
        let mut plot = residuals(m, &group);
        plot.title = "angular momentum, measured less predicted".to_owned();
        plot.y.label = "difference".to_owned();
        push("momentum_residual", plot);
    }
    all
}

fn thinned(c: &Channel) -> String {
    let step = c.samples.div_ceil(c.time_s.len().max(1));
    if step > 1 {
        format!("Points measured (one of every {step} drawn; statistics use all), lines predicted.")
    } else {
        "Points measured, lines predicted.".to_owned()
    }
}

fn quantity(name: &str) -> &str {
    match name {
        "gyro" => "angular velocity, body axes",
        "attitude" => "attitude quaternion, body to inertial",
        "velocity" => "velocity of the sensor point, inertial axes",
        "position" => "position of the sensor point, inertial axes",
        "accelerometer" => "specific force at the sensor point, axes of its body",
        "velocity_increment" => "velocity increments of the sensor point, inertial axes",
        other => other,
    }
}

fn symbol(name: &str) -> &str {
    match name {
        "gyro" => "omega",
        "attitude" => "q",
        "velocity" => "v",
        "position" => "r",
        "accelerometer" => "f",
        "velocity_increment" => "dv",
        other => other,
    }
}

fn curves(c: &Channel, group: &str) -> Plot {
    let mut series = Vec::new();
    for (k, name) in c.components.iter().enumerate() {
        if let (Some(m), Some(p)) = (c.measured.get(k), c.predicted.get(k)) {
            series.push(Series::new("", Mark::Dots, k, &c.time_s, m));
            series.push(Series::new(name, Mark::Line, k, &c.time_s, p));
        }
    }
    Plot {
        title: quantity(&c.name).to_owned(),
        x: Axis::new("time", "s"),
        y: Axis::new(symbol(&c.name), &c.unit),
        series,
        group: group.to_owned(),
        height: 230.0,
        note: thinned(c),
        ..Plot::default()
    }
}

fn residuals(c: &Channel, group: &str) -> Plot {
    let axes = ["x", "y", "z"];
    let series = c
        .residual
        .iter()
        .enumerate()
        .map(|(k, row)| Series::new(axes.get(k).unwrap_or(&""), Mark::Dots, k, &c.time_s, row))
        .collect();
    Plot {
        title: match c.name.as_str() {
            "attitude" => {
                "attitude residual: small rotation from predicted to measured, body axes".to_owned()
            }
            name => format!("{name} residual: measured less predicted"),
        },
        x: Axis::new("time", "s"),
        y: Axis::new("residual", &c.residual_unit),
        series,
        levels: vec![(0.0, String::new())],
        group: group.to_owned(),
        height: 180.0,
        ..Plot::default()
    }
}

/// Whitened residuals of all axes against the normal curve.
fn histogram(c: &Channel) -> Plot {
    let mut counts = vec![0_u64; HISTOGRAM_BARS];
    for row in &c.histogram {
        for (sum, n) in counts.iter_mut().zip(row) {
            *sum += n;
        }
    }
    let total: u64 = counts.iter().sum();
    if total == 0 {
        return Plot::default();
    }
    let width = 2.0 * REACH / HISTOGRAM_BARS as f64;
    let middle = |k: usize| -REACH + (k as f64 + 0.5) * width;
    let x: Vec<f64> = (0..HISTOGRAM_BARS).map(middle).collect();
    let density: Vec<f64> = counts
        .iter()
        .map(|n| *n as f64 / (total as f64 * width))
        .collect();
    let fine: Vec<f64> = (0..=80).map(|k| -REACH + 0.1 * f64::from(k)).collect();
    let normal: Vec<f64> = fine
        .iter()
        .map(|z| (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt())
        .collect();
    Plot {
        title: format!("{} residual, whitened", c.name),
        x: Axis::new("residual over declared noise", "sigma"),
        y: Axis::new("density", ""),
        from_zero: true,
        series: vec![
            Series::new("found", Mark::Bars, 0, &x, &density),
            Series::new("declared noise", Mark::Line, 1, &fine, &normal),
        ],
        half: true,
        ..Plot::default()
    }
}

fn correlation(c: &Channel) -> Plot {
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
    let edge = super::numbers::NINETY_FIVE / (c.samples.max(1) as f64).sqrt();
    Plot {
        title: format!("{} residual, autocorrelation", c.name),
        x: Axis::new("lag", "samples"),
        whole: true,
        y: Axis::new("correlation", ""),
        series,
        levels: vec![(edge, "95 % if white".to_owned()), (-edge, String::new())],
        half: true,
        ..Plot::default()
    }
}
