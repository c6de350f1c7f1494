//! One slew, and three slews about different axes in the same duration, with the sensors of the shipped model.

use super::printed::{COLUMNS, PRINTED, TRUE};
use crate::kim2010::{ELEMENTS, Kim2010, NAMES};
use crate::method::Method;
use crate::study::statistics::{largest, rms};
use crate::study::{Cell, Context, Findings, StudyError, Table, decimals, figures};
use poinsot_figures::{Axis, Mark, Plot, Series};
use poinsot_identify::{Estimate, tensor_index, tensor_name};

/// Noise trials.
const TRIALS: u64 = 20;
/// Name of the tables, title, case file.
const CASES: [(&str, [&str; 2], &str); 3] = [
    (
        "one slew of 17 deg",
        ["products_one", "errors_one"],
        "stsat3_kim2010.toml",
    ),
    (
        "three slews of 17 deg",
        ["products_17deg", "errors_17deg"],
        "stsat3_three_slews_17deg.toml",
    ),
    (
        "three slews of 90 deg",
        ["products_90deg", "errors_90deg"],
        "stsat3_three_slews.toml",
    ),
];

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
    for (title, names, case) in CASES {
        let answers = answers(context, case)?;
        findings.tables.extend([
            products(names[0], title, &answers),
            errors(names[1], title, &answers),
        ]);
        if case == CASES[2].2 {
            findings.plot("second_axis", second_axis(&answers));
        }
        state(case, &answers, &mut findings);
    }
    Ok(findings)
}

fn state(case: &str, answers: &[Answer], findings: &mut Findings) {
    let of = |name: &str, noisy| {
        answers
            .iter()
            .find(move |a| a.name == name && a.noisy == noisy)
    };
    let (Some(exact), Some(batch)) = (of("batch", false), of("batch", true)) else {
        return;
    };
    let (Some(suggested), Some(pre)) = (of("suggested", true), of("pre-estimate", true)) else {
        return;
    };
    let bias = 100.0 * (batch.mean[0] / TRUE[0] - 1.0).abs();
    if case == CASES[1].2 {
        findings.state(
            "no filter is needed",
            format!("bias of I_xx {bias:.2} % at 17 deg"),
        );
    }
    if case == CASES[2].2 {
        let worst = 100.0 * largest(exact.error);
        let text = format!("{worst:.0e} % on three axes");
        findings.state("(2)-(4) batch", text.clone());
        findings.state("batch fails because of other axes and noise", text);
        let three = |a: &Answer| {
            let [x, y, z] = [3, 4, 5].map(|k| figures(100.0 * a.error[k], 2).text());
            format!("{x}, {y}, {z}")
        };
        let text = format!("{} %, batch {} %", three(suggested), three(batch));
        findings.state("suggested is far better than batch and conventional", text);
        let nearer = (3..6)
            .filter(|k| pre.error[*k] < suggested.error[*k])
            .count();
        let text = format!("pre-estimate nearer on {nearer} of 3");
        findings.state("not using earlier products is better", text);
    }
}

/// Every column of Table 2, the iteration, the linear method and maximum likelihood for one case.
fn answers(context: &Context, case: &str) -> Result<Vec<Answer>, StudyError> {
    let own = Kim2010.about().name;
    let mut list = Vec::new();
    for noisy in [false, true] {
        for column in COLUMNS.into_iter().chain(["iterated"]) {
            list.push(answer(context, case, own, Some(column), noisy)?);
        }
        for method in ["linear", "maximum_likelihood"] {
            list.push(answer(context, case, method, None, noisy)?);
        }
    }
    Ok(list)
}

fn answer(
    context: &Context,
    case: &str,
    method: &str,
    variant: Option<&str>,
    noisy: bool,
) -> Result<Answer, StudyError> {
    let tools = context.tools;
    let mut case = context.case(case)?;
    let mut vehicle = tools.vehicle(&case)?;
    let nominal = context.model("stsat3/model.toml")?;
    let I = vehicle.bodies[0].nominal.I_BBcm_B;
    let wanted = ELEMENTS.map(|e| I[e]);
    if !noisy {
        // Without sensors, the channels are the exact motion.
        vehicle.sensors.clear();
        case = case.with(&[("sensors_only = true", "sensors_only = false")]);
    }
    let mut found = Vec::new();
    for trial in 0..if noisy { TRIALS } else { 1 } {
        let mut table = tools.simulate(&case, &vehicle, trial)?;
        let kept = |name: &str| !name.starts_with("r_") && !name.starts_with("v_");
        table.channels.retain(|c| kept(&c.name));
        found.push(numbers(&tools.identify(
            &nominal,
            vec![table],
            method,
            variant,
        )?));
    }
    let share = 1.0 / found.len() as f64;
    let mean = |pick: &dyn Fn(&(f64, f64)) -> f64| -> [f64; 6] {
        std::array::from_fn(|k| found.iter().map(|f| pick(&f[k])).sum::<f64>() * share)
    };
    let sigma = mean(&|n| n.1);
    Ok(Answer {
        name: variant.unwrap_or(method).replace('_', " "),
        noisy,
        mean: mean(&|n| n.0),
        error: std::array::from_fn(|k| rms(found.iter().map(|f| f[k].0 / wanted[k] - 1.0))),
        sigma: std::array::from_fn(|k| sigma[k] / wanted[k]),
    })
}

/// The six numbers of a method with their sigmas.
fn numbers(estimate: &Estimate) -> [(f64, f64); 6] {
    std::array::from_fn(|k| {
        let printed = estimate.method_report.iter().flat_map(|r| &r.numbers);
        let element = tensor_index(NAMES[k]);
        let name = format!("inertia_{}", tensor_name(element));
        let number = printed.into_iter().find(|n| n.name == name);
        let number = number.map_or(estimate.bodies[0].inertia[element], |n| n.number);
        (
            number.value.unwrap_or(f64::NAN),
            number.sigma.unwrap_or(f64::NAN),
        )
    })
}

fn products(name: &'static str, title: &str, answers: &[Answer]) -> Table {
    let title = format!("Products, kg m2: {title}; noisy values are means of {TRIALS} records");
    let mut table = Table::new(name, &title, " | I_xy | I_yz | I_zx");
    table.row("true", TRUE[3..].iter().map(|x| decimals(*x, 4)));
    for a in answers {
        let kind = if a.noisy { "noisy" } else { "noise-free" };
        let title = format!("{}, {kind}", a.name);
        table.row(title, a.mean[3..].iter().map(|x| decimals(*x, 4)));
    }
    table
}

fn errors(name: &'static str, title: &str, answers: &[Answer]) -> Table {
    let title = format!("Rms error in % of each element, {TRIALS} noisy records: {title}");
    let mut table = Table::new(name, &title, " | xx | yy | zz | xy | yz | zx");
    for a in answers {
        let percent = |x: [f64; 6]| -> [Cell; 6] { x.map(|x| figures(100.0 * x, 2)) };
        let title = if a.noisy {
            a.name.clone()
        } else {
            format!("{}, no noise", a.name)
        };
        table.row(title, percent(a.error));
        if a.noisy && a.sigma.iter().all(|s| s.is_finite()) {
            table.row(format!("{}, its sigma", a.name), percent(a.sigma));
        }
    }
    table
}

/// Errors with a second and third axis, and the printed ones.
fn second_axis(answers: &[Answer]) -> Plot {
    let places = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let printed: [f64; 6] = std::array::from_fn(|k| 100.0 * (PRINTED[3][k] / TRUE[k] - 1.0).abs());
    let mut series = vec![Series::new(
        "printed, one slew",
        Mark::Points,
        6,
        &places,
        &printed,
    )];
    for (k, a) in answers.iter().filter(|a| a.noisy).enumerate() {
        let percent = a.error.map(|x| 100.0 * x);
        let colour = if k < 6 { k } else { 7 };
        series.push(Series::new(
            &a.name,
            Mark::Points,
            colour,
            &places,
            &percent,
        ));
    }
    Plot {
        title: "Error of each element: one slew as printed, three slews of 90 deg".to_owned(),
        x: Axis::new("element of the tensor", ""),
        y: Axis::new("error", "%"),
        log: true,
        names: NAMES.map(str::to_owned).to_vec(),
        series,
        ..Plot::default()
    }
}
