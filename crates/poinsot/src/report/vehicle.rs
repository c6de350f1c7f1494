//! Section 6: the manoeuvre and the model, drawn from the model.

use super::Answer;
use super::data::{Pointer, Row, Segment, Vehicle};
use super::numbers::short;
use super::tensor::equivalent_ellipsoid;
use minijinja::{Value, context};
use poinsot_report::{
    Arrow, Axis, Curve, Ellipsoid, Figure, Mark, PageError, Part, Plot, Point, Scene, Series, Spot,
    render, significant,
};
use poinsot_spatial::{Matrix3, Vector3};

/// Segments whose manoeuvre is drawn.
const DRAWN: usize = 4;

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
    let all = &answer.data.segments;
    let drawn = Figure::scene("vehicle", scene(v));
    let picture = drawn.html()?;
    let mut drawings = vec![drawn];
    let mut manoeuvre: Vec<Value> = Vec::new();
    for (k, s) in all.iter().take(DRAWN).enumerate() {
        let made = figures(k, s);
        let html = Figure::page(&made)?;
        manoeuvre.push(context! { label => s.label, figures => html.value() });
        drawings.extend(made);
    }
    let body = render(
        "vehicle.html",
        include_str!("templates/vehicle.html"),
        context! {
            scene => picture.value(),
            bodies, joints, sensors, manoeuvre,
            more => all.len().saturating_sub(DRAWN),
        },
    )?;
    Ok(Part {
        id: "vehicle",
        title: "Manoeuvre and model",
        body,
        figures: drawings,
    })
}

fn sensor_unit(kind: &str) -> &str {
    match kind {
        "gyro" | "joint_rate" | "wheel_speed" => "rad/s",
        "attitude" | "joint_position" => "rad",
        "position" => "m",
        "velocity" | "velocity_increment" => "m/s",
        "accelerometer" => "m/s²",
        "thrust" => "N",
        _ => "",
    }
}

fn figures(at: usize, s: &Segment) -> Vec<Figure> {
    let group = format!("segment{at}");
    let mut plots = Vec::new();
    for (unit, kind) in [("rad", "joint_angles"), ("m", "joint_travels")] {
        let rows: Vec<&Row> = s.joints.iter().filter(|j| j.unit == unit).collect();
        let plot = rows_plot("joint positions", "q", unit, &rows, s, &group);
        plots.extend(plot.map(|p| (kind, p)));
    }
    let wheels: Vec<&Row> = s.wheels.iter().collect();
    let plot = rows_plot("wheel speeds", "Omega", "rad/s", &wheels, s, &group);
    plots.extend(plot.map(|p| ("wheel_speeds", p)));
    plots.extend(thrust(s, &group).map(|p| ("thrust", p)));
    plots
        .into_iter()
        .map(|(kind, p)| Figure::plot(&format!("manoeuvre_segment{}_{kind}", at + 1), p))
        .collect()
}

fn rows_plot(
    title: &str,
    symbol: &str,
    unit: &str,
    rows: &[&Row],
    s: &Segment,
    group: &str,
) -> Option<Plot> {
    (!rows.is_empty()).then(|| Plot {
        title: title.to_owned(),
        x: Axis::new("time", "s"),
        y: Axis::new(symbol, unit),
        series: rows
            .iter()
            .enumerate()
            .map(|(k, r)| Series::new(&r.name, Mark::Line, k, &s.time_s, &r.values))
            .collect(),
        group: group.to_owned(),
        height: 190.0,
        ..Plot::default()
    })
}

/// Thrust as steps, one series a thruster.
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

fn scene(v: &Vehicle) -> Scene {
    let mut scene = Scene {
        title: "the vehicle at the first sample, base axes, m".to_owned(),
        note: "Each body is drawn as the homogeneous ellipsoid with its mass and inertia (estimated where identified, else \
               nominal), with its mass centre; lines join the origins of the bodies through the joints."
            .to_owned(),
        ..Scene::default()
    };
    let place = |at: &Point| Vector3::from(*at);
    let mut size: f64 = 0.0;
    for (k, b) in v.bodies.iter().enumerate() {
        let [r0, r1, r2] = b.rotation;
        let R = Matrix3::from_row_slice(&[r0, r1, r2].concat());
        let centre = place(&b.origin_m) + R * place(&b.com_m);
        let [xx, xy, yy, xz, yz, zz] = b.inertia_kg_m2;
        let I = super::tensor::matrix(&[xx, yy, zz, xy, xz, yz]);
        let Some(axes) = equivalent_ellipsoid(b.mass_kg, &I) else {
            continue;
        };
        let axes = axes.map(|a| Point::from(R * place(&a)));
        size = axes.iter().map(|a| place(a).norm()).fold(size, f64::max);
        let colour = if b.estimated { 0 } else { 6 };
        let first = v.bodies.iter().position(|o| o.estimated == b.estimated) == Some(k);
        let role = if b.estimated { "estimated" } else { "known" };
        scene.ellipsoids.push(Ellipsoid {
            name: if first {
                role.to_owned()
            } else {
                String::new()
            },
            centre: centre.into(),
            axes,
            colour,
            faint: false,
        });
        scene.spots.push(Spot {
            at: centre.into(),
            label: b.name.clone(),
            colour,
        });
    }
    for j in &v.joints {
        let parent = v.bodies.iter().find(|b| b.name == j.parent);
        let from = parent.map_or([0.0; 3], |b| b.origin_m);
        scene.curves.push(Curve {
            name: String::new(),
            points: vec![Some(from), Some(j.origin_m)],
            colour: 6,
            dashed: false,
            faint: false,
        });
        if j.kind != "fixed" {
            let reach = place(&j.axis) * (0.15 * size);
            scene.arrows.push(arrow(&j.origin_m, &(-reach), "", 3));
            // Joints in one place share a word.
            let here = |o: &&super::data::DrawnJoint| o.origin_m == j.origin_m;
            let first = v.joints.iter().find(here).is_some_and(|o| o.name == j.name);
            let names: Vec<&str> = v
                .joints
                .iter()
                .filter(here)
                .map(|o| o.name.as_str())
                .collect();
            let label = if first {
                names.join(", ")
            } else {
                String::new()
            };
            scene.arrows.push(arrow(&j.origin_m, &reach, &label, 3));
        }
    }
    let pointers = |list: &[Pointer], colour, reach: f64, scene: &mut Scene| {
        for p in list {
            let to = place(&p.direction) * reach;
            scene.arrows.push(arrow(&p.at_m, &to, &p.name, colour));
        }
    };
    pointers(&v.wheels, 2, 1.1 * size, &mut scene);
    pointers(&v.thrusters, 1, 0.4 * size, &mut scene);
    scene
}

fn arrow(from: &Point, by: &Vector3, label: &str, colour: usize) -> Arrow {
    Arrow {
        from: *from,
        to: (Vector3::from(*from) + by).into(),
        label: label.to_owned(),
        colour,
    }
}
