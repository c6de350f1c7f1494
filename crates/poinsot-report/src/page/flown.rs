//! The manoeuvre on one time axis, and the vehicle of the model.

use super::Answer;
use super::envelope::Envelope;
use super::trust::group;
use super::vehicle::drawn;
use minijinja::{Value, context};
use poinsot_figures::{Axis, Figure, Mark, PageError, Part, Plot, Series, render};
use poinsot_files::{short, significant};
use poinsot_formats::{Row, Segment};

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let v = &answer.data.vehicle;
    let bodies: Vec<Value> = v
        .bodies
        .iter()
        .map(|b| {
            let i = b.inertia_kg_m2;
            context! {
                name => b.name,
                mass => short(b.mass_kg),
                com => b.com_m.map(short).join(", "),
                inertia => [i[0], i[2], i[5]].map(short).join(", "),
                role => if b.estimated { "estimated" } else { "known" },
            }
        })
        .collect();
    let joints: Vec<Value> = v
        .joints
        .iter()
        .map(|j| context! { name => j.name, kind => j.kind, parent => j.parent, child => j.child })
        .collect();
    let sensors: Vec<Value> = v
        .sensors
        .iter()
        .map(|s| {
            let unit = sensor_unit(&s.kind);
            context! {
                name => s.name,
                kind => s.kind.replace('_', " "),
                body => s.body,
                sigma => s.sigma.map(|x| format!("{} {unit}", significant(x, 3))),
                lsb => (s.quantisation > 0.0).then(|| format!("{} {unit}", significant(s.quantisation, 3))),
            }
        })
        .collect();
    let vehicle = drawn(answer);
    let picture = vehicle.html()?;
    let mut made = vec![vehicle];
    let envelope = Envelope::of(&answer.data);
    let mut records: Vec<Value> = Vec::new();
    for (k, s) in answer.data.segments.iter().enumerate() {
        let plots = figures(k, s, &envelope);
        let html = Figure::page(&plots)?;
        records.push(context! { label => s.label, figures => html.value() });
        made.extend(plots);
    }
    let body = render(
        "flown.html",
        include_str!("templates/flown.html"),
        context! { picture => picture.value(), bodies, joints, sensors, records },
    )?;
    Ok(Part {
        id: "flown",
        title: "What was flown",
        body,
        figures: made,
    })
}

fn sensor_unit(kind: &str) -> &str {
    // A sensor that sees one body from another one has the unit of that in inertial axes.
    match kind.strip_prefix("relative_").unwrap_or(kind) {
        "gyro" | "joint_rate" | "wheel_speed" => "rad/s",
        "attitude" | "direction" | "joint_position" => "rad",
        "position" => "m",
        "velocity" | "velocity_increment" => "m/s",
        "accelerometer" => "m/s²",
        "thrust" => "N",
        _ => "",
    }
}

fn figures(at: usize, s: &Segment, envelope: &Envelope) -> Vec<Figure> {
    let group = group(at);
    let kept: Vec<usize> = (0..s.time_s.len())
        .step_by(envelope.stride(s.time_s.len()))
        .collect();
    let time: Vec<f64> = kept.iter().map(|k| s.time_s[*k]).collect();
    let mut plots = Vec::new();
    plots.extend(rates(s, &kept, &time, &group).map(|p| ("rates", p)));
    for (unit, kind) in [("rad", "joint_angles"), ("m", "joint_travels")] {
        let rows: Vec<&Row> = s.joints.iter().filter(|j| j.unit == unit).collect();
        let plot = rows_plot("joint positions", ["q", unit], &rows, &kept, &time, &group);
        plots.extend(plot.map(|p| (kind, p)));
    }
    let wheels: Vec<&Row> = s.wheels.iter().collect();
    let plot = rows_plot(
        "wheel speeds",
        ["Omega", "rad/s"],
        &wheels,
        &kept,
        &time,
        &group,
    );
    plots.extend(plot.map(|p| ("wheel_speeds", p)));
    plots.extend(thrust(s, &group).map(|p| ("thrust", p)));
    plots
        .into_iter()
        .map(|(kind, p)| Figure::plot(&format!("manoeuvre_segment{}_{kind}", at + 1), p))
        .collect()
}

/// Predicted angular velocity of the base.
fn rates(s: &Segment, kept: &[usize], time: &[f64], group: &str) -> Option<Plot> {
    let axis = |k: usize| -> Vec<f64> {
        let rate = |i: &usize| s.omega_rad_s.get(*i).map_or(f64::NAN, |w| w[k]);
        kept.iter().map(rate).collect()
    };
    let axes = ["x", "y", "z"].into_iter().enumerate();
    (!time.is_empty()).then(|| Plot {
        title: "angular velocity of the base, body axes".to_owned(),
        x: Axis::new("time", "s"),
        y: Axis::new("omega", "rad/s"),
        series: axes
            .map(|(k, name)| Series::new(name, Mark::Line, k, time, &axis(k)))
            .collect(),
        group: group.to_owned(),
        height: 190.0,
        ..Plot::default()
    })
}

fn rows_plot(
    title: &str,
    [symbol, unit]: [&str; 2],
    rows: &[&Row],
    kept: &[usize],
    time: &[f64],
    group: &str,
) -> Option<Plot> {
    let values = |r: &Row| -> Vec<f64> {
        let value = |k: &usize| r.values.get(*k).copied().unwrap_or(f64::NAN);
        kept.iter().map(value).collect()
    };
    (!rows.is_empty()).then(|| Plot {
        title: title.to_owned(),
        x: Axis::new("time", "s"),
        y: Axis::new(symbol, unit),
        series: rows
            .iter()
            .enumerate()
            .map(|(k, r)| Series::new(&r.name, Mark::Line, k, time, &values(r)))
            .collect(),
        group: group.to_owned(),
        height: 190.0,
        ..Plot::default()
    })
}

/// Thrust as steps, one series per thruster.
fn thrust(s: &Segment, group: &str) -> Option<Plot> {
    let (first, last) = (*s.time_s.first()?, *s.time_s.last()?);
    let mut names: Vec<&str> = s.firings.iter().map(|f| f.0.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    if names.is_empty() {
        return None;
    }
    let series = names
        .iter()
        .enumerate()
        .map(|(k, name)| {
            let mut points = vec![(first, 0.0)];
            for (_, start, end, force) in s.firings.iter().filter(|f| f.0 == *name) {
                points.extend([(*start, 0.0), (*start, *force), (*end, *force), (*end, 0.0)]);
            }
            points.push((last, 0.0));
            let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
            Series::new(name, Mark::Line, k, &x, &y)
        })
        .collect();
    Some(Plot {
        title: "thrust".to_owned(),
        x: Axis::new("time", "s"),
        y: Axis::new("force", "N"),
        series,
        group: group.to_owned(),
        height: 160.0,
        ..Plot::default()
    })
}
