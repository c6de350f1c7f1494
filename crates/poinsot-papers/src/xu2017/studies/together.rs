//! A grasped target: one joint at a time, as in the paper, compared with all joints together.

use super::robot::{ALL, Data, Robot, errors};
use crate::study::statistics::{largest, rms};
use crate::study::{CaseText, Context, Digits, Findings, StudyError, Table};

use poinsot_identify::{BodyEstimate, Estimate, Number, linear};
use poinsot_model::Model;
use poinsot_spatial::MassProperties;

/// Draws of noise.
const TRIALS: u64 = 20;
const CASE: &str = "xu2017_target_all_joints.toml";
/// The last joint rotates by +-30 deg once in 60 s.
const ALONE: &str = r#"
[[joint_motion]]
joint = "joint6"
interpolation = "fourier"
base_frequency_hz = 0.016666666666666666
sine_rad = [0.5235987755982988]
cosine_rad = [0.0]

"#;
const AT_REST: &str = "[initial]\nmomentum_zero = true\n";
const MOTIONS: [&str; 4] = [
    "joint 6 alone, from rest (as C7)",
    "all joints, from rest",
    "joint 6 alone, drifting and turning",
    "all joints, drifting and turning",
];
/// The target.
const TARGET: usize = 6;

/// Both motions of the arm with the target: from rest, and with drift and rotation as in the shipped case.
///
/// # Errors
/// The shipped case cannot be read or has other parts.
pub fn cases(context: &Context) -> Result<[CaseText; 4], StudyError> {
    let shipped = context.case(CASE)?;
    let text = &shipped.text;
    let part = |mark: &str| text.find(mark).ok_or(format!("{CASE} has no part {mark}"));
    let [initial, joints, output] = ["[initial]", "[[joint_motion]]", "[output]"].map(part);
    let (initial, joints, output) = (initial?, joints?, output?);
    let (head, start) = (&text[..initial], &text[initial..joints]);
    let (all, tail) = (&text[joints..output], &text[output..]);
    let starts = [
        (AT_REST, ALONE),
        (AT_REST, all),
        (start, ALONE),
        (start, all),
    ];
    Ok(starts.map(|(start, motion)| CaseText {
        path: shipped.path.clone(),
        text: format!("{head}{start}\n{motion}\n{tail}"),
    }))
}

/// Condition number of the target's ten numbers in the method's equations.
pub fn condition(e: &Estimate) -> f64 {
    let mut numbers = e.method_report.iter().flat_map(|r| &r.numbers);
    let found = numbers.find(|n| n.name.ends_with("condition of these"));
    found.and_then(|n| n.value).unwrap_or(f64::NAN)
}

/// Errors of mass (relative), mass centre (m), tensor (kg m2, largest element); infinite without a number.
fn parts(found: &BodyEstimate, truth: &MassProperties) -> [f64; 3] {
    let (found, truth) = (found.numbers(), truth.to_array());
    let error = |k: usize| {
        let value = found[k].value;
        value.map_or(f64::INFINITY, |x| (x - truth[k]).abs())
    };
    let most = |range: std::ops::Range<usize>| largest(range.map(error));
    [error(0) / truth[0], most(1..4), most(4..10)]
}

/// The vehicle with errors of 20 to 30 % in the target's nominal numbers.
fn off(vehicle: &Model) -> Model {
    let mut model = vehicle.clone();
    let target = &mut model.bodies[TARGET].nominal;
    target.mass *= 1.2;
    target.p_BoBcm_B *= 0.8;
    target.I_BBcm_B *= 1.3;
    model
}

/// One answer with only the target unknown, with or without noise, and the truth.
///
/// # Errors
/// The case cannot be simulated, or does not suit the method.
pub fn answer(
    context: &Context,
    case: &CaseText,
    method: &str,
    trial: Option<u64>,
) -> Result<(Estimate, MassProperties), StudyError> {
    let vehicle = context.tools.vehicle(case)?;
    let mut flown = vehicle.clone();
    if trial.is_none() {
        flown.sensors.clear();
    }
    let table = context.tools.simulate(case, &flown, trial.unwrap_or(0))?;
    let variant = (method == "xu2017").then_some("linear");
    let tools = context.tools;
    let found = tools.identify(&off(&vehicle), vec![table], method, variant)?;
    Ok((found, vehicle.bodies[TARGET].nominal))
}

/// One joint compared with all joints.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let mut exact = Table::new(
        "exact",
        "Grasped target, 60 s at 10 Hz, no noise: condition of its ten numbers, largest error",
        "motion | condition | error :1",
    );
    let title = format!("Rms error with the sensors of the case, {TRIALS} draws of noise");
    let head = "motion | method | mass, % | mass centre, mm | tensor, kg m2";
    let mut noisy = Table::new("noisy", title, head);
    for (name, case) in MOTIONS.into_iter().zip(cases(context)?) {
        let (e, truth) = answer(context, &case, "xu2017", None)?;
        let (worst, _) = errors(&e.bodies[TARGET], &truth);
        exact.row(name, [condition(&e), worst]);
        let best = ("maximum_likelihood", "maximum likelihood");
        for (method, title) in [("xu2017", "linear steps"), best] {
            let mut found = Vec::new();
            for trial in 0..TRIALS {
                let (e, truth) = answer(context, &case, method, Some(trial))?;
                found.push(parts(&e.bodies[TARGET], &truth));
            }
            let [m, c, i] = [0, 1, 2].map(|k| rms(found.iter().map(|f| f[k])));
            let words = format!("{name} | {title}");
            noisy.row(words, [100.0 * m, 1000.0 * c, i]);
        }
    }
    Ok(Findings::of([exact, noisy, every_body(context)?])
        .say(&["one joint at a time = condition {exact.0.1} alone, {exact.1.1} together"]))
}

/// Every body unknown: sigma of the least determined of the 52 combinations.
fn every_body(context: &Context) -> Result<Table, StudyError> {
    let robot = Robot::new(context)?;
    let mut table = Table::new(
        "every_body",
        "Every body unknown: sigma of the least determined of the 52 combinations, natural units",
        "runs | rank | sigma",
    );
    let mut exact = context.tools.vehicle(&context.case("xu2017_c1.toml")?)?;
    exact.sensors.clear();
    let mut tables = robot.runs(&robot.model, &["C1"])?;
    let [_, all, ..] = cases(context)?;
    tables.push(context.tools.simulate(&all, &exact, 0)?);
    let both = Data::new(context, robot.model.clone(), &tables)?;
    let each = ("C1 and C2 to C7, 62 s each", robot.data(&ALL)?);
    for (title, data) in [each, ("C1 and all joints at once, 60 s", both)] {
        let found = linear(&data.problem())?.identifiability;
        let sigma = found.sigmas_natural.get(51).copied().unwrap_or(f64::NAN);
        table.row(format!("{title} | {} of 70", found.rank), [sigma]);
    }
    Ok(table)
}

/// The grasped target with all joints moving, drift and rotation.
pub fn target(context: &Context) -> Result<Findings, StudyError> {
    let case = context.case(CASE)?;
    let mut table = Table::new(
        "target_errors",
        "Largest errors: mass in kg with sigma, mass centre in m, tensor in kg m2, in sigmas",
        " | mass :.4 | mass centre | tensor | worst in sigmas",
    );
    for (method, title) in [("xu2017", "linear steps"), ("auto", "maximum likelihood")] {
        let (e, truth) = answer(context, &case, method, Some(0))?;
        let body = &e.bodies[TARGET];
        let [_, c, i] = parts(body, &truth);
        let numbers = body.numbers().into_iter().zip(truth.to_array());
        let number = |x: Option<f64>| x.unwrap_or(f64::NAN);
        let sigmas = |(n, x): (Number, f64)| ((number(n.value) - x) / number(n.sigma)).abs();
        table.row(title, []);
        table.pair([body.mass.value, body.mass.sigma].map(number), "+-");
        for x in [c, i, largest(numbers.map(sigmas))] {
            table.with(x, Digits::Figures(2));
        }
    }
    Ok(Findings::of([table]))
}
