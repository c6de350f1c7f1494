//! Tables 2 and 3 and Fig. 1 to 4 compared with noisy records of several rates and lengths.

use super::one_axis::titles;
use super::printed::{COLUMNS, PRINTED, TRUE};
use super::records::{PAPER, RATE, SEEDS, Slew, chi_square, columns};
use crate::kim2010::NAMES;
use crate::study::statistics::{largest, median, quantile};
use crate::study::{Cell, Context, Findings, StudyError, Table, decimals, figures, word};
use poinsot_figures::{Axis, Mark, Plot, Series};
use poinsot_spatial::Vector3;

/// Row steps for 10, 5, 2, 1 and 0.5 Hz.
const STEPS: [usize; 5] = [1, 2, 5, 10, 20];
const LENGTHS: [usize; 7] = [60, 100, 200, 300, 350, 400, 600];
/// Quantiles of the band of trials.
const BAND: [f64; 2] = [0.05, 0.95];

/// All records of one rate and length.
struct Records {
    step: usize,
    length: usize,
    trials: Vec<[[f64; 6]; 4]>,
}

impl Records {
    fn rate(&self) -> f64 {
        RATE as f64 / self.step as f64
    }

    fn quantile(&self, column: usize, element: usize, share: f64) -> f64 {
        quantile(self.trials.iter().map(|t| t[column][element]), share)
    }

    fn holds_printed(&self, column: usize, element: usize) -> bool {
        let [low, high] = BAND.map(|q| self.quantile(column, element, q));
        (low..=high).contains(&PRINTED[column][element])
    }

    fn inside(&self, column: usize) -> usize {
        (0..6).filter(|k| self.holds_printed(column, *k)).count()
    }

    /// Chi-square of the suggested column.
    fn chi_square(&self) -> f64 {
        let suggested: Vec<Vec<f64>> = self.trials.iter().map(|t| t[3].to_vec()).collect();
        chi_square(&suggested, 3, 0)
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
    let mut findings = Findings::of(distances(&all));
    let paper = |step: usize| {
        all.iter()
            .filter(move |r| r.length == PAPER.0 && r.step == step)
    };
    let mut inside = Table::new(
        "inside",
        "Printed numbers inside the 5 to 95 % band of 200 records of 350 s, of 6 each",
        &titles(),
    );
    for records in [10, 20].into_iter().flat_map(paper) {
        let cells = (0..4).map(|c| decimals(records.inside(c) as f64, 0));
        inside.row(format!("{} Hz", records.rate()), cells);
        findings.tables.push(errors(records));
    }
    findings.tables.insert(1, inside);
    findings.tables.push(band(&all));
    for records in paper(20) {
        let of = |c: usize| format!("{} of 6 in the band", records.inside(c));
        findings.state("Table 2, Batch", of(0));
        findings.state("Table 2, Conventional", of(1));
        findings.state("Table 2, Suggested", of(3));
    }
    for records in paper(10) {
        let off = |k: usize| 100.0 * (records.quantile(3, k, 0.5) / TRUE[k] - 1.0);
        let text = format!("moments {:.1}, {:.1}, {:.1} % off", off(0), off(1), off(2));
        findings.state("Table 3", text);
        let [a, b, c] = [3, 4, 5].map(|k| records.quantile(3, k, 0.5));
        let text = format!("{a:.2}, {b:.2}, {c:.2} kg m2, true 0.085, 0.590, 0.133");
        findings.state("I_yz suffers from I_yy and I_zz", text);
    }
    let at = |length: usize| {
        all.iter()
            .filter(move |r| r.length == length && r.step == 10)
    };
    for (short, long) in at(200).zip(at(400)) {
        let [a, b] = [short, long].map(|r| r.quantile(3, 3, 0.5));
        let text = format!("I_xy {a:.3} at 200 s, {b:.3} kg m2 at 400 s");
        findings.state("Fig. 3, 4", text);
    }
    let fastest = largest(slew.w.iter().map(|w| w.norm())).to_degrees();
    findings.state("Fig. 1, 2", format!("one axis, at most {fastest:.3} deg/s"));
    histories(&slew, &mut findings);
    draw(&slew, &all, &mut findings)?;
    Ok(findings)
}

fn distances(all: &[Records]) -> Table {
    let mut table = Table::new(
        "chi_square",
        "Chi-square of the six suggested numbers on 6, by rate and length of the record",
        " | 200 s | 300 s | 350 s | 400 s | 600 s",
    );
    for step in STEPS {
        let of_rate = all.iter().filter(|r| r.step == step && r.length >= 200);
        let cells: Vec<Cell> = of_rate.map(|r| figures(r.chi_square(), 2)).collect();
        table.row(format!("{} Hz", RATE as f64 / step as f64), cells);
    }
    table
}

/// Table 3 and the records of one rate.
fn errors(records: &Records) -> Table {
    let (name, title) = match records.step {
        10 => ("table3_1hz", "1 Hz"),
        _ => ("table3_half_hz", "0.5 Hz"),
    };
    let title =
        format!("Table 3 at 350 s, {title}: error of the median, and printed, % of the element");
    let head = format!(" | {} | printed", COLUMNS.join(" | printed | "));
    let mut table = Table::new(name, &title, &head);
    for (k, element) in NAMES.iter().enumerate() {
        let off = |x: f64| figures(100.0 * (x / TRUE[k] - 1.0).abs(), 3);
        let pair = |c: usize| [records.quantile(c, k, 0.5), PRINTED[c][k]].map(off);
        table.row(*element, (0..4).flat_map(pair));
    }
    table
}

/// Bands of every number for every rate and length.
fn band(all: &[Records]) -> Table {
    let mut table = Table::new(
        "bands",
        "Median and 5 to 95 % of 200 records, kg m2",
        "rate, Hz | length, s | column | element | median | 5 to 95 % | printed | inside",
    );
    for r in all.iter().filter(|r| r.length == PAPER.0) {
        for (c, column) in COLUMNS.iter().enumerate() {
            for (k, element) in NAMES.iter().enumerate() {
                let [low, high] = BAND.map(|q| r.quantile(c, k, q));
                let digits = crate::study::Digits::Decimals(4);
                table.row(
                    format!("{}", r.rate()),
                    [
                        decimals(r.length as f64, 0),
                        word(*column),
                        word(*element),
                        decimals(r.quantile(c, k, 0.5), 4),
                        Cell::Pair(low, "to", high, digits),
                        decimals(PRINTED[c][k], 4),
                        word(if r.holds_printed(c, k) { "yes" } else { "no" }),
                    ],
                );
            }
        }
    }
    table
}

/// Fig. 1 and 2.
fn histories(slew: &Slew, findings: &mut Findings) {
    let history = |title: &str, unit: &str, names: [&str; 3], value: &dyn Fn(usize) -> Vector3| {
        let rows: Vec<usize> = (0..=PAPER.0 * RATE).step_by(RATE / 2).collect();
        let time: Vec<f64> = rows.iter().map(|k| slew.time[*k]).collect();
        let curve = |axis: usize| {
            let values: Vec<f64> = rows.iter().map(|k| value(*k)[axis]).collect();
            // Two of the three curves coincide: the last is dashed.
            let mark = if axis == 2 { Mark::Dashed } else { Mark::Line };
            Series::new(names[axis], mark, axis, &time, &values)
        };
        Plot {
            title: title.to_owned(),
            x: Axis::new("time", "s"),
            y: Axis::new(title.split(": ").last().unwrap_or_default(), unit),
            series: (0..3).map(curve).collect(),
            ..Plot::default()
        }
    };
    let angles = |k: usize| {
        let (roll, pitch, yaw) = slew.R_NB[k].euler_angles();
        Vector3::new(roll, pitch, yaw).map(f64::to_degrees)
    };
    let (euler, axes) = (["roll", "pitch", "yaw"], ["x", "y", "z"]);
    let rates = |k: usize| slew.w[k].map(f64::to_degrees);
    findings.plot(
        "fig1_euler_angles",
        history("Fig. 1: Euler angles", "deg", euler, &angles),
    );
    findings.plot(
        "fig2_rates",
        history("Fig. 2: body rates", "deg/s", axes, &rates),
    );
    let torque = |k: usize| slew.u[k];
    findings.plot(
        "fig2_torques",
        history("Fig. 2: control torque on the body", "N m", axes, &torque),
    );
}

/// Fig. 3 and 4, and the effect of noise at other rates.
fn draw(slew: &Slew, all: &[Records], findings: &mut Findings) -> Result<(), StudyError> {
    let lengths: Vec<usize> = (2..=30).map(|k| 20 * k).collect();
    let mut suggested: Vec<Vec<[f64; 6]>> = Vec::new();
    for list in slew.noisy(PAPER.1, &lengths)? {
        let answers = list.iter().map(|s| s.suggested().map(|a| a.printed));
        suggested.push(answers.collect::<Result<_, _>>()?);
    }
    let time: Vec<f64> = lengths.iter().map(|t| *t as f64).collect();
    for k in 0..6 {
        let at = |q: f64| -> Vec<f64> {
            let each = suggested.iter();
            each.map(|list| quantile(list.iter().map(|x| x[k]), q))
                .collect()
        };
        let band = format!("5 to 95 % of {SEEDS} records");
        let mut series = vec![
            Series::band(&band, 0, &time, &at(BAND[0]), &at(BAND[1])),
            Series::new("median", Mark::Line, 0, &time, &at(0.5)),
        ];
        series.extend(truth_and_printed(k));
        findings.plot(
            &format!("fig{}_{}", 3 + k / 3, NAMES[k]),
            evolution(
                &format!("Fig. {}: I_{}, suggested, 1 Hz", 3 + k / 3, NAMES[k]),
                series,
            ),
        );
    }
    for k in 3..6 {
        let curve = |(i, step): (usize, usize)| {
            let of_rate = all.iter().filter(|r| r.step == step);
            let (x, y): (Vec<f64>, Vec<f64>) = of_rate
                .map(|r| (r.length as f64, median(r.trials.iter().map(|t| t[3][k]))))
                .unzip();
            let name = format!("{} Hz", RATE as f64 / step as f64);
            Series::new(&name, Mark::Line, i, &x, &y)
        };
        let mut series: Vec<Series> = STEPS.into_iter().enumerate().map(curve).collect();
        series.extend(truth_and_printed(k));
        let title = format!("I_{} of the suggested method at several rates", NAMES[k]);
        findings.plot(&format!("ridge_{}", NAMES[k]), evolution(&title, series));
    }
    Ok(())
}

fn truth_and_printed(k: usize) -> [Series; 2] {
    [
        Series::new("true", Mark::Dashed, 6, &[40.0, 600.0], &[TRUE[k]; 2]),
        Series::new(
            "printed",
            Mark::Points,
            1,
            &[PAPER.0 as f64],
            &[PRINTED[3][k]],
        ),
    ]
}

/// A plot over the record length.
fn evolution(title: &str, series: Vec<Series>) -> Plot {
    Plot {
        title: title.to_owned(),
        x: Axis::new("length of the record", "s"),
        y: Axis::new("inertia", "kg m2"),
        series,
        ..Plot::default()
    }
}
