//! A grasped target: one joint at a time, as in the paper, compared with all joints together.

use super::robot::{ALL, Data, Robot, errors};
use crate::method::Method;
use crate::study::statistics::{largest, rms};
use crate::study::{
    CaseText, Cell, Context, Digits, Findings, StudyError, Table, decimals, figures, word,
};
use crate::xu2017::Xu2017;
use poinsot_identify::{BodyEstimate, Estimate, Number, TENSOR, linear};
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
    let (initial, joints, output) = (
        part("[initial]")?,
        part("[[joint_motion]]")?,
        part("[output]")?,
    );
    let (head, start) = (&text[..initial], &text[initial..joints]);
    let (all, tail) = (&text[joints..output], &text[output..]);
    let make = |start: &str, motion: &str| CaseText {
        path: shipped.path.clone(),
        text: format!("{head}{start}\n{motion}\n{tail}"),
    };
    Ok([
        make(AT_REST, ALONE),
        make(AT_REST, all),
        make(start, ALONE),
        make(start, all),
    ])
}

/// Condition number of the target's ten numbers in the method's equations.
pub fn condition(e: &Estimate) -> f64 {
    let numbers = e.method_report.iter().flat_map(|r| &r.numbers);
    let found = numbers
        .into_iter()
        .find(|n| n.name.ends_with("condition of these"));
    found.and_then(|n| n.number.value).unwrap_or(f64::NAN)
}

/// Errors of mass (relative), mass centre (m), tensor (kg m2, largest element).
fn parts(b: &BodyEstimate, t: &MassProperties) -> [f64; 3] {
    let off = |n: &Number, x: f64| n.value.map_or(f64::INFINITY, |v| (v - x).abs());
    let tensor = b.inertia.iter().zip(TENSOR);
    [
        off(&b.mass, t.mass) / t.mass,
        largest(
            b.com
                .iter()
                .zip(t.p_BoBcm_B.iter())
                .map(|(n, x)| off(n, *x)),
        ),
        largest(tensor.map(|(n, e)| off(n, t.I_BBcm_B[e]))),
    ]
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
    let variant = (method == Xu2017.about().name).then_some("linear");
    let found = context
        .tools
        .identify(&off(&vehicle), vec![table], method, variant)?;
    Ok((found, vehicle.bodies[TARGET].nominal))
}

/// One joint compared with all joints.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let own = Xu2017.about().name;
    let mut exact = Table::new(
        "exact",
        "Grasped target, 60 s at 10 Hz, no noise: condition of its ten numbers, largest error",
        "motion | condition | error",
    );
    let title = format!("Rms error with the sensors of the case, {TRIALS} draws of noise");
    let head = "motion | method | mass, % | mass centre, mm | tensor, kg m2";
    let mut noisy = Table::new("noisy", &title, head);
    let mut conditions = Vec::new();
    for (name, case) in MOTIONS.into_iter().zip(cases(context)?) {
        let (e, truth) = answer(context, &case, own, None)?;
        conditions.push(figures(condition(&e), 2).text());
        let (worst, _) = errors(&e.bodies[TARGET], &truth);
        exact.row(name, [figures(condition(&e), 2), figures(worst, 1)]);
        for (method, title) in [
            (own, "linear steps"),
            ("maximum_likelihood", "maximum likelihood"),
        ] {
            let mut found = Vec::new();
            for trial in 0..TRIALS {
                let (e, truth) = answer(context, &case, method, Some(trial))?;
                found.push(parts(&e.bodies[TARGET], &truth));
            }
            let [m, c, i] = [0, 1, 2].map(|k| rms(found.iter().map(|f| f[k])));
            let cells = [100.0 * m, 1000.0 * c, i].map(|x| figures(x, 2));
            noisy.row(name, std::iter::once(word(title)).chain(cells));
        }
    }
    let mut findings = Findings::of(exact);
    findings.tables.push(noisy);
    findings.tables.push(every_body(context)?);
    let text = format!(
        "condition {} alone, {} together",
        conditions[0], conditions[1]
    );
    findings.state("one joint at a time", text);
    Ok(findings)
}

/// Every body unknown: sigma of the least determined of the 52 combinations.
fn every_body(context: &Context) -> Result<Table, StudyError> {
    let robot = Robot::new(context)?;
    let mut table = Table::new(
        "every_body",
        "Every body unknown: sigma of the least determined of the 52 combinations, natural units",
        "runs | rank | sigma",
    );
    let worst = |d: &Data| -> Result<[Cell; 2], StudyError> {
        let found = linear(&d.problem())?.identifiability;
        let sigma = found.sigmas_natural.get(51).copied().unwrap_or(f64::NAN);
        Ok([word(format!("{} of 70", found.rank)), figures(sigma, 2)])
    };
    table.row("C1 and C2 to C7, 62 s each", worst(&robot.data(&ALL)?)?);
    let mut exact = context.tools.vehicle(&context.case("xu2017_c1.toml")?)?;
    exact.sensors.clear();
    let mut tables = robot.runs(&robot.model, &["C1"])?;
    let [_, all, ..] = cases(context)?;
    tables.push(context.tools.simulate(&all, &exact, 0)?);
    let both = Data::new(context, robot.model.clone(), &tables)?;
    table.row("C1 and all joints at once, 60 s", worst(&both)?);
    Ok(table)
}

/// The grasped target with all joints moving, drift and rotation: results by number.
pub fn target(context: &Context) -> Result<Findings, StudyError> {
    let own = Xu2017.about().name;
    let case = context.case(CASE)?;
    let mut table = Table::new(
        "target",
        "Grasped target, all six joints in motion: values and sigmas",
        " | true | linear steps | maximum likelihood",
    );
    let mut sigmas = Table::new(
        "target_sigmas",
        "Error over the stated sigma",
        " | linear steps | maximum likelihood",
    );
    let mut summary = Table::new(
        "target_errors",
        "Largest errors: mass in kg with sigma, mass centre in m, tensor in kg m2, in sigmas",
        " | mass | mass centre | tensor | worst in sigmas",
    );
    let mut columns = Vec::new();
    for (method, title) in [(own, "linear steps"), ("auto", "maximum likelihood")] {
        let (e, truth) = answer(context, &case, method, Some(0))?;
        let rows = rows(&e.bodies[TARGET], &truth);
        let worst = largest(rows.iter().map(|r| (r.2 - r.1).abs() / r.3));
        let [_, c, i] = parts(&e.bodies[TARGET], &truth);
        let mass = Cell::Pair(rows[0].2, "+-", rows[0].3, Digits::Decimals(4));
        summary.row(
            title,
            [mass, figures(c, 2), figures(i, 2), figures(worst, 2)],
        );
        columns.push(rows);
    }
    let number = |r: &(&str, f64, f64, f64)| Cell::Pair(r.2, "+-", r.3, Digits::Decimals(5));
    for (a, b) in columns[0].iter().zip(&columns[1]) {
        table.row(a.0, [decimals(a.1, 4), number(a), number(b)]);
        sigmas.row(a.0, [a, b].map(|r| decimals((r.2 - r.1) / r.3, 2)));
    }
    let mut findings = Findings::of(summary);
    findings.tables.extend([table, sigmas]);
    Ok(findings)
}

/// Name, truth, value and sigma of the ten numbers.
fn rows(b: &BodyEstimate, t: &MassProperties) -> Vec<(&'static str, f64, f64, f64)> {
    let row = |name, n: &Number, x| {
        (
            name,
            x,
            n.value.unwrap_or(f64::NAN),
            n.sigma.unwrap_or(f64::NAN),
        )
    };
    let mut list = vec![row("mass, kg", &b.mass, t.mass)];
    let names = ["com_x, m", "com_y, m", "com_z, m"];
    list.extend((0..3).map(|k| row(names[k], &b.com[k], t.p_BoBcm_B[k])));
    let names = [
        "I_xx, kg m2",
        "I_xy, kg m2",
        "I_yy, kg m2",
        "I_xz, kg m2",
        "I_yz, kg m2",
        "I_zz, kg m2",
    ];
    let tensor = b.inertia.iter().zip(TENSOR).zip(names);
    list.extend(tensor.map(|((n, e), name)| row(name, n, t.I_BBcm_B[e])));
    list
}
