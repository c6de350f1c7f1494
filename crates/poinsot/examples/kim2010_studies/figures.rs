//! The figures.

use crate::manoeuvres::Answer;
use crate::slew::{RATE, Slew};
use crate::svg::{COLOURS, Panel, Shape, figure};
use crate::trials::{self, PRINTED, quantile};
use crate::{Cell, Failure, TRUE};
use poinsot_papers::kim2010::NAMES;
use poinsot_spatial::Vector3;
use std::path::Path;

const TIME: &str = "time, s";
const LENGTH: &str = "record length, s";
const INERTIA: &str = "kg m²";

pub fn draw(slew: &Slew, cells: &[Cell], out: &Path) -> Result<(), Failure> {
    let angles: Vec<Vector3> = slew
        .R_NB
        .iter()
        .map(|R| {
            let (roll, pitch, yaw) = R.euler_angles();
            Vector3::new(roll, pitch, yaw).map(f64::to_degrees)
        })
        .collect();
    let series = |title: &str, unit: &str, names: [&str; 3], values: &[Vector3]| {
        let mut panel = Panel::new(title, TIME, unit);
        for axis in 0..3 {
            let rows = slew.time.iter().zip(values).step_by(RATE / 2).take(701);
            let points = rows.map(|(t, v)| (*t, v[axis])).collect();
            // Two of the three lie on each other: the last is dashed.
            let shape = if axis == 2 {
                Shape::Dashed(points)
            } else {
                Shape::Line(points)
            };
            panel.add(names[axis], COLOURS[[0, 1, 3][axis]], shape);
        }
        panel
    };
    let first = series(
        "Fig. 1: Euler angles (3-2-1)",
        "deg",
        ["roll", "pitch", "yaw"],
        &angles,
    );
    let degrees: Vec<Vector3> = slew.w.iter().map(|w| w.map(f64::to_degrees)).collect();
    let axes = ["x", "y", "z"];
    let rates = series("Fig. 2a: body rates", "deg/s", axes, &degrees);
    let torques = series("Fig. 2b: control torque on the body", "N m", axes, &slew.u);
    std::fs::write(out.join("fig1_euler_angles.svg"), figure(&[first]))?;
    std::fs::write(
        out.join("fig2_rates_and_torques.svg"),
        figure(&[rates, torques]),
    )?;
    let lengths: Vec<usize> = (2..=30).map(|k| 20 * k).collect();
    let by_length = trials::sums(slew, 10, &lengths)?;
    let mut suggested: Vec<Vec<[f64; 6]>> = Vec::new();
    for list in &by_length {
        let answers = list.iter().map(|s| s.suggested().map(|a| a.printed));
        suggested.push(answers.collect::<Result<_, _>>()?);
    }
    let evolution = |k: usize, title: String| {
        let mut panel = Panel::new(&title, LENGTH, INERTIA);
        let at = |p: f64| -> Vec<(f64, f64)> {
            let each = lengths.iter().zip(&suggested);
            each.map(|(t, list)| {
                let values: Vec<f64> = list.iter().map(|x| x[k]).collect();
                (*t as f64, quantile(&values, p))
            })
            .collect()
        };
        let (low, high) = (at(0.05), at(0.95));
        let band = low
            .iter()
            .zip(&high)
            .map(|(a, b)| (a.0, a.1, b.1))
            .collect();
        let across = |y: f64| vec![(40.0, y), (600.0, y)];
        panel.add("5-95 % of 200 seeds", COLOURS[0], Shape::Band(band));
        panel.add("median", COLOURS[0], Shape::Line(at(0.5)));
        panel.add("true", "#000000", Shape::Dashed(across(TRUE[k])));
        let limit = slew.sums(350, 10, &[])?.suggested()?.printed[k];
        panel.add("without noise", COLOURS[1], Shape::Dashed(across(limit)));
        panel.add(
            "printed, at 350 s",
            "#ffffff",
            Shape::Dots(vec![(350.0, PRINTED[3][k])]),
        );
        Ok::<_, Failure>(panel)
    };
    let panel =
        |k: usize, figure: &str| evolution(k, format!("{figure}: I_{}, suggested, 1 Hz", NAMES[k]));
    let moments = [
        panel(0, "Fig. 3")?,
        panel(1, "Fig. 3")?,
        panel(2, "Fig. 3")?,
    ];
    let products = [
        panel(3, "Fig. 4")?,
        panel(4, "Fig. 4")?,
        panel(5, "Fig. 4")?,
    ];
    std::fs::write(out.join("fig3_moments.svg"), figure(&moments))?;
    std::fs::write(out.join("fig4_products.svg"), figure(&products))?;
    std::fs::write(out.join("ridge.svg"), ridge(cells))?;
    Ok(())
}

/// The suggested products against record length at several rates.
fn ridge(cells: &[Cell]) -> String {
    let panels = [3, 4, 5].map(|k| {
        let title = format!("I_{} of the suggested method: noise, not inertia", NAMES[k]);
        let mut panel = Panel::new(&title, LENGTH, INERTIA);
        for (i, step) in crate::STEPS.into_iter().enumerate() {
            let at = |p: f64| -> Vec<(f64, f64)> {
                let of_rate = cells.iter().filter(|c| c.step == step);
                of_rate
                    .map(|c| (c.length as f64, quantile(&c.of(3, k), p)))
                    .collect()
            };
            let name = format!("{} Hz, median", RATE as f64 / step as f64);
            panel.add(&name, COLOURS[i], Shape::Line(at(0.5)));
        }
        panel.add(
            "true",
            "#000000",
            Shape::Dashed(vec![(60.0, TRUE[k]), (600.0, TRUE[k])]),
        );
        panel.add(
            "printed, at 350 s",
            "#ffffff",
            Shape::Dots(vec![(350.0, PRINTED[3][k])]),
        );
        panel
    });
    figure(&panels)
}

/// Errors with a second and third axis beside the printed ones.
pub fn second_axis(list: &[Answer]) -> String {
    let mut panel = Panel::new(
        "Error of each element in percent: one slew as printed, three slews in the same 350 s",
        "element of the inertia tensor",
        "percent",
    );
    panel.log_y = true;
    panel.x_names = NAMES.map(str::to_owned).to_vec();
    let percent = |x: &[f64; 6]| -> Vec<(f64, f64)> {
        (0..6)
            .map(|k| ((k + 1) as f64, 100.0 * x[k] / TRUE[k]))
            .collect()
    };
    let printed: [f64; 6] = std::array::from_fn(|k| (PRINTED[3][k] - TRUE[k]).abs());
    panel.add(
        "printed, one slew",
        "#ffffff",
        Shape::Dots(percent(&printed)),
    );
    let noisy = list.iter().filter(|e| e.noisy);
    for (i, errors) in noisy.enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        panel.add(
            &errors.name.replace("maximum_likelihood", "max. likelihood"),
            colour,
            Shape::Dots(percent(&errors.rms)),
        );
    }
    figure(&[panel])
}
