//! One slew, and three slews about different axes in the same duration, with the sensors of the shipped model.

use super::records::{COLUMNS, PRINTED, TRUE};
use crate::kim2010::{ELEMENTS, NAMES};
use crate::study::statistics::{largest, rms};
use crate::study::{Context, Findings, StudyError, Table, curves, without_translation};
use poinsot_figures::{Mark, Plot, Series};
use poinsot_identify::{Estimate, tensor_index};
use poinsot_spatial::MASS_PROPERTY_NAMES;

/// Noise trials.
const TRIALS: u64 = 20;
/// Name of the tables, title, case file.
const CASES: [(&str, &str, &str); 3] = [
    ("one", "one slew of 17 deg", "stsat3_kim2010.toml"),
    (
        "17deg",
        "three slews of 17 deg",
        "stsat3_three_slews_17deg.toml",
    ),
    ("90deg", "three slews of 90 deg", "stsat3_three_slews.toml"),
];
/// Rows of the answers of these methods in the tables of a case: noise-free batch, noisy batch, pre-estimate, suggested.
const ROWS: [usize; 4] = [0, 7, 9, 10];

/// Result of one method, elements in the order of the paper's tables.
struct Answer {
    name: String,
    noisy: bool,
    /// Mean over the trials, kg m2; NaN if the method withholds the number.
    mean: [f64; 6],
    /// RMS error over the trials, relative to the element.
    error: [f64; 6],
    /// Mean of the method's sigma, relative to the element; NaN for the paper's estimators.
    sigma: [f64; 6],
}

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    for (name, title, case) in CASES {
        let answers = answers(context, case)?;
        findings.tables.push(errors(name, title, &answers));
        let [exact, batch, pre, suggested] = ROWS.map(|k| &answers[k]);
        if name == "17deg" {
            let bias = 100.0 * (batch.mean[0] / TRUE[0] - 1.0).abs();
            let text = format!("bias of I_xx {bias:.2} % at 17 deg");
            findings.state("no filter is needed", text);
        }
        if name == "90deg" {
            findings.plot("second_axis", second_axis(&answers));
            let worst = 100.0 * largest(exact.error);
            let text = format!("{worst:.0e} % on three axes");
            findings.state("(2)-(4) batch", text.clone());
            findings.state("batch fails because of other axes and noise", text);
            let nearer = (3..6).filter(|k| pre.error[*k] < suggested.error[*k]);
            let text = format!("pre-estimate nearer on {} of 3", nearer.count());
            findings.state("not using earlier products is better", text);
        }
    }
    Ok(findings.say(&[
        "suggested is far better than batch and conventional = {errors_90deg.10.4}, {errors_90deg.10.5}, {errors_90deg.10.6} %, batch {errors_90deg.7.4}, {errors_90deg.7.5}, {errors_90deg.7.6} %",
    ]))
}

/// Every column of Table 2, the iteration, the linear method and maximum likelihood for one case.
fn answers(context: &Context, case: &str) -> Result<Vec<Answer>, StudyError> {
    let published = COLUMNS.into_iter().chain(["iterated"]);
    let published = published.map(|column| ("kim2010", Some(column)));
    let own = ["linear", "maximum_likelihood"].map(|method| (method, None));
    let all: Vec<_> = published.chain(own).collect();
    let mut list = Vec::new();
    for noisy in [false, true] {
        for by in &all {
            list.push(answer(context, case, *by, noisy)?);
        }
    }
    Ok(list)
}

fn answer(
    context: &Context,
    case: &str,
    (method, variant): (&str, Option<&str>),
    noisy: bool,
) -> Result<Answer, StudyError> {
    let tools = context.tools;
    let mut case = context.case(case)?;
    let mut vehicle = tools.vehicle(&case)?;
    let nominal = context.model("stsat3/model.toml")?;
    let wanted = ELEMENTS.map(|e| vehicle.bodies[0].nominal.I_BBcm_B[e]);
    if !noisy {
        // Without sensors, the channels are the exact motion.
        vehicle.sensors.clear();
        case = case.with(&[("sensors_only = true", "sensors_only = false")]);
    }
    let mut found = Vec::new();
    for trial in 0..if noisy { TRIALS } else { 1 } {
        let mut tables = vec![tools.simulate(&case, &vehicle, trial)?];
        without_translation(&mut tables);
        let estimate = tools.identify(&nominal, tables, method, variant)?;
        found.push(numbers(&estimate));
    }
    let share = 1.0 / found.len() as f64;
    let mean = |k: usize, of: usize| found.iter().map(|f| f[k][of]).sum::<f64>() * share;
    Ok(Answer {
        name: variant.unwrap_or(method).replace('_', " "),
        noisy,
        mean: std::array::from_fn(|k| mean(k, 0)),
        error: std::array::from_fn(|k| rms(found.iter().map(|f| f[k][0] / wanted[k] - 1.0))),
        sigma: std::array::from_fn(|k| mean(k, 1) / wanted[k]),
    })
}

/// The six numbers of a method with their sigmas.
fn numbers(estimate: &Estimate) -> [[f64; 2]; 6] {
    NAMES.map(|name| {
        let element = tensor_index(name);
        let mut printed = estimate.method_report.iter().flat_map(|r| &r.numbers);
        let number = printed.find(|n| n.name == MASS_PROPERTY_NAMES[4 + element]);
        let answer = estimate.bodies[0].inertia[element];
        let pair = number.map_or([answer.value, answer.sigma], |n| [n.value, n.sigma]);
        pair.map(|x| x.unwrap_or(f64::NAN))
    })
}

fn errors(name: &str, title: &str, answers: &[Answer]) -> Table {
    let title = format!("Rms error in % of each element, {TRIALS} noisy records: {title}");
    let head = " | xx | yy | zz | xy | yz | zx";
    let mut table = Table::new(format!("errors_{name}"), title, head);
    for a in answers {
        let exact = if a.noisy { "" } else { ", no noise" };
        table.row(format!("{}{exact}", a.name), a.error.map(|x| 100.0 * x));
        if a.noisy && a.sigma.iter().all(|s| s.is_finite()) {
            table.row(format!("{}, its sigma", a.name), a.sigma.map(|x| 100.0 * x));
        }
    }
    table
}

/// Errors with a second and third axis, and the printed ones.
fn second_axis(answers: &[Answer]) -> Plot {
    let places = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let points = |name: &str, colour, errors: [f64; 6]| {
        let percent = errors.map(|x| 100.0 * x);
        Series::new(name, Mark::Points, colour, &places, &percent)
    };
    let printed = std::array::from_fn(|k| (PRINTED[3][k] / TRUE[k] - 1.0).abs());
    let noisy = answers.iter().filter(|a| a.noisy).enumerate();
    let found = noisy.map(|(k, a)| points(&a.name, if k < 6 { k } else { 7 }, a.error));
    let first = points("printed, one slew", 6, printed);
    Plot {
        log: true,
        names: NAMES.map(str::to_owned).to_vec(),
        ..curves(
            "Error of each element: one slew as printed, three slews of 90 deg",
            "element of the tensor",
            "error, %",
            [first].into_iter().chain(found).collect(),
        )
    }
}
