//! Tables 2 and 3 and Fig. 1 to 4 compared with noisy records of several rates and lengths.

use super::records::{COLUMNS, PAPER, PRINTED, RATE, SEEDS, Slew, TRUE, chi_square, columns};
use crate::kim2010::NAMES;
use crate::study::statistics::{largest, quantile};
use crate::study::{Context, Findings, StudyError, Table, curves};
use poinsot_figures::{Mark, Series};
use poinsot_spatial::Vector3;

/// Row steps for 10, 5, 2, 1 and 0.5 Hz.
const STEPS: [usize; 5] = [1, 2, 5, 10, 20];
const LENGTHS: [usize; 5] = [200, 300, 350, 400, 600];
/// Quantiles of the band of trials.
const BAND: [f64; 2] = [0.05, 0.95];

/// All records of one rate and length.
struct Records {
    step: usize,
    length: usize,
    trials: Vec<[[f64; 6]; 4]>,
}

fn rate(step: usize) -> String {
    format!("{} Hz", RATE as f64 / step as f64)
}

impl Records {
    fn quantile(&self, column: usize, element: usize, share: f64) -> f64 {
        quantile(self.trials.iter().map(|t| t[column][element]), share)
    }

    /// Number of printed values of a column in its band.
    fn inside(&self, column: usize) -> f64 {
        let holds = |k: &usize| {
            let [low, high] = BAND.map(|q| self.quantile(column, *k, q));
            (low..=high).contains(&PRINTED[column][*k])
        };
        (0..6).filter(holds).count() as f64
    }

    /// Chi-square of the suggested column.
    fn chi_square(&self) -> f64 {
        let suggested: Vec<[f64; 6]> = self.trials.iter().map(|t| t[3]).collect();
        chi_square(&suggested)
    }
}

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let slew = Slew::of(context)?;
    let mut all = Vec::new();
    for step in STEPS {
        for (length, list) in LENGTHS.into_iter().zip(slew.noisy(step, &LENGTHS)?) {
            let trials = list.iter().map(columns).collect::<Result<_, _>>()?;
            all.push(Records {
                step,
                length,
                trials,
            });
        }
    }
    let of = |step: usize, length: usize| {
        let mut all = all.iter();
        let found = all.find(|r| r.step == step && r.length == length);
        found.ok_or("no such records")
    };
    let (one, half) = (of(10, PAPER.0)?, of(20, PAPER.0)?);
    let title = "Printed numbers inside the 5 to 95 % band of 200 records of 350 s, of 6 each";
    let head = format!(" | {} :.0", COLUMNS.join(" :.0 | "));
    let mut inside = Table::new("inside", title, &head);
    for records in [one, half] {
        inside.row(rate(records.step), (0..4).map(|c| records.inside(c)));
    }
    let title = "Chi-square of the six suggested numbers on 6, by rate and length of the record";
    let head = " | 200 s | 300 s | 350 s | 400 s | 600 s";
    let mut distances = Table::new("chi_square", title, head);
    for step in STEPS {
        let of_rate = all.iter().filter(|r| r.step == step);
        distances.row(rate(step), of_rate.map(Records::chi_square));
    }
    let errors = [errors("1hz", one), errors("half_hz", half)];
    let mut findings = Findings::of([distances, inside].into_iter().chain(errors));
    let middle = |k: usize| one.quantile(3, k, 0.5);
    let [x, y, z] = [0, 1, 2].map(|k| 100.0 * (middle(k) / TRUE[k] - 1.0));
    findings.state("Table 3", format!("moments {x:.1}, {y:.1}, {z:.1} % off"));
    let [a, b, c] = [3, 4, 5].map(middle);
    let text = format!("{a:.2}, {b:.2}, {c:.2} kg m2, true 0.085, 0.590, 0.133");
    findings.state("I_yz suffers from I_yy and I_zz", text);
    let [a, b] = [of(10, 200)?, of(10, 400)?].map(|r| r.quantile(3, 3, 0.5));
    let text = format!("I_xy {a:.3} at 200 s, {b:.3} kg m2 at 400 s");
    findings.state("Fig. 3, 4", text);
    let fastest = largest(slew.w.iter().map(|w| w.norm())).to_degrees();
    findings.state("Fig. 1, 2", format!("one axis, at most {fastest:.3} deg/s"));
    histories(&slew, &mut findings);
    draw(&slew, &mut findings)?;
    Ok(findings.say(&[
        "Table 2, Batch = {inside.1.1} of 6 in the band",
        "Table 2, Conventional = {inside.1.2} of 6 in the band",
        "Table 2, Suggested = {inside.1.4} of 6 in the band",
    ]))
}

/// Table 3 and the records of one rate.
fn errors(name: &str, records: &Records) -> Table {
    let rate = rate(records.step);
    let title =
        format!("Table 3 at 350 s, {rate}: error of the median, and printed, % of the element");
    let head = format!(" | {} :3 | printed :3", COLUMNS.join(" :3 | printed :3 | "));
    let mut table = Table::new(format!("table3_{name}"), title, &head);
    for (k, element) in NAMES.iter().enumerate() {
        let off = |x: f64| 100.0 * (x / TRUE[k] - 1.0).abs();
        let pair = |c: usize| [records.quantile(c, k, 0.5), PRINTED[c][k]].map(off);
        table.row(element, (0..4).flat_map(pair));
    }
    table
}

/// Fig. 1 and 2.
fn histories(slew: &Slew, findings: &mut Findings) {
    let rows: Vec<usize> = (0..=PAPER.0 * RATE).step_by(RATE / 2).collect();
    let time: Vec<f64> = rows.iter().map(|k| slew.time[*k]).collect();
    let angles = |k: &usize| {
        let (roll, pitch, yaw) = slew.R_NB[*k].euler_angles();
        Vector3::new(roll, pitch, yaw).map(f64::to_degrees)
    };
    let angles: Vec<Vector3> = rows.iter().map(angles).collect();
    let rates = rows.iter().map(|k| slew.w[*k].map(f64::to_degrees));
    let torques = rows.iter().map(|k| slew.u[*k]).collect();
    let (euler, axes) = (["roll", "pitch", "yaw"], ["x", "y", "z"]);
    let control = "control torque on the body, N m";
    for (name, figure, y, names, vectors) in [
        ("fig1_euler_angles", 1, "Euler angles, deg", euler, angles),
        ("fig2_rates", 2, "body rates, deg/s", axes, rates.collect()),
        ("fig2_torques", 2, control, axes, torques),
    ] {
        let curve = |axis: usize| {
            let values: Vec<f64> = vectors.iter().map(|v| v[axis]).collect();
            // Two of the three curves coincide: the last is dashed.
            let mark = if axis == 2 { Mark::Dashed } else { Mark::Line };
            Series::new(names[axis], mark, axis, &time, &values)
        };
        let label = y.split(", ").next().unwrap_or_default();
        let title = format!("Fig. {figure}: {label}");
        let plot = curves(title, "time, s", y, (0..3).map(curve).collect());
        findings.plot(name, plot);
    }
}

/// Fig. 3 and 4.
fn draw(slew: &Slew, findings: &mut Findings) -> Result<(), StudyError> {
    let lengths: Vec<usize> = (2..=30).map(|k| 20 * k).collect();
    let mut suggested: Vec<Vec<[f64; 6]>> = Vec::new();
    for list in slew.noisy(PAPER.1, &lengths)? {
        let answers = list.iter().map(|s| s.suggested().map(|a| a.printed));
        suggested.push(answers.collect::<Result<_, _>>()?);
    }
    let time: Vec<f64> = lengths.iter().map(|t| *t as f64).collect();
    for (k, name) in NAMES.iter().enumerate() {
        let of = |list: &Vec<[f64; 6]>, q| quantile(list.iter().map(|x| x[k]), q);
        let at = |q: f64| -> Vec<f64> { suggested.iter().map(|list| of(list, q)).collect() };
        let band = format!("5 to 95 % of {SEEDS} records");
        let (length, printed) = ([PAPER.0 as f64], [PRINTED[3][k]]);
        let series = vec![
            Series::band(&band, 0, &time, &at(BAND[0]), &at(BAND[1])),
            Series::new("median", Mark::Line, 0, &time, &at(0.5)),
            Series::new("true", Mark::Dashed, 6, &[40.0, 600.0], &[TRUE[k]; 2]),
            Series::new("printed", Mark::Points, 1, &length, &printed),
        ];
        let figure = 3 + k / 3;
        let title = format!("Fig. {figure}: I_{name}, suggested, 1 Hz");
        let plot = curves(title, "length of the record, s", "inertia, kg m2", series);
        findings.plot(&format!("fig{figure}_{name}"), plot);
    }
    Ok(())
}
