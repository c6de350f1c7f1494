//! The manoeuvre on one time axis, and the vehicle of the model.

use super::Answer;
use super::curves::{named, over_time, picked, series};
use super::envelope::Envelope;
use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::{Axis, Figure, Mark, PageError, Part, Plot, Series};
use poinsot_formats::Segment;

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let mut figures = Vec::new();
    let envelope = Envelope::of(&answer.data.segments);
    let mut records: Vec<Value> = Vec::new();
    for (k, s) in answer.data.segments.iter().enumerate() {
        let plots = named(
            &format!("manoeuvre_segment{}_", k + 1),
            plots(k, s, &envelope),
        );
        records.push(context! { label => s.label, figures => Figure::page(&plots)?.value() });
        figures.extend(plots);
    }
    let vehicle = &answer.data.vehicle;
    let context = context! { records, vehicle };
    let body = TEMPLATES.html("flown.html", context)?;
    Ok(Part::new("flown", "What was flown", body).with_figures(figures))
}

fn plots(record: usize, s: &Segment, envelope: &Envelope) -> Vec<(&'static str, Plot)> {
    let step = envelope.stride(s.time_s.len());
    let kept: Vec<usize> = (0..s.time_s.len()).step_by(step).collect();
    let time = picked(&s.time_s, &kept, 1.0);
    let plot = |title: &str, y: Axis, rows: Vec<(&str, &[f64])>| {
        let rows = rows
            .into_iter()
            .map(|(name, row)| (name, picked(row, &kept, 1.0)));
        over_time(record, title.to_owned(), y, series(Mark::Line, &time, rows))
    };
    let mut all = Vec::new();
    if !time.is_empty() {
        let rates = [0, 1, 2].map(|k| s.omega_rad_s.iter().map(|w| w[k]).collect::<Vec<f64>>());
        let rows = ["x", "y", "z"]
            .into_iter()
            .zip(rates.iter().map(Vec::as_slice));
        let title = "angular velocity of the base, body axes";
        all.push((
            "rates",
            plot(title, Axis::new("omega", "rad/s"), rows.collect()),
        ));
    }
    for (rows, unit, name, title, symbol) in [
        (&s.joints, "rad", "joint_angles", "joint positions", "q"),
        (&s.joints, "m", "joint_travels", "joint positions", "q"),
        (&s.wheels, "rad/s", "wheel_speeds", "wheel speeds", "Omega"),
        (
            &s.modes,
            "kg05 m",
            "mode_amplitudes",
            "amplitudes of flexible modes",
            "y",
        ),
    ] {
        let alike = rows.iter().filter(|r| r.unit == unit);
        let alike: Vec<(&str, &[f64])> = alike
            .map(|r| (r.name.as_str(), r.values.as_slice()))
            .collect();
        if !alike.is_empty() {
            all.push((name, plot(title, Axis::new(symbol, unit), alike)));
        }
    }
    all.extend(thrust(record, s).map(|p| ("thrust", p)));
    all
}

/// Thrust as steps, one series per thruster.
fn thrust(record: usize, s: &Segment) -> Option<Plot> {
    let (first, last) = (*s.time_s.first()?, *s.time_s.last()?);
    let mut names: Vec<&str> = s.firings.iter().map(|f| f.0.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let line = |(k, name): (usize, &&str)| {
        let mut points = vec![(first, 0.0)];
        for (_, start, end, force) in s.firings.iter().filter(|f| f.0 == *name) {
            points.extend([(*start, 0.0), (*start, *force), (*end, *force), (*end, 0.0)]);
        }
        points.push((last, 0.0));
        let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        Series::new(name, Mark::Line, k, &x, &y)
    };
    let lines = names.iter().enumerate().map(line).collect();
    let y = Axis::new("force", "N");
    (!names.is_empty()).then(|| over_time(record, "thrust".to_owned(), y, lines))
}
