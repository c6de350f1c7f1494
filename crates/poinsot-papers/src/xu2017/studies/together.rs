//! A grasped target: one joint at a time, as in the paper, compared with all joints together.

use super::robot::errors;
use crate::study::{CaseText, Context, Findings, StudyError, Table};
use poinsot_identify::Estimate;
use poinsot_spatial::MassProperties;

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
const MOTIONS: [&str; 2] = ["joint 6 alone (as C7)", "all joints"];
/// The target.
const TARGET: usize = 6;

/// Both motions of the arm with the target, from rest.
///
/// # Errors
/// The shipped case cannot be read or has other parts.
pub fn cases(context: &Context) -> Result<[CaseText; 2], StudyError> {
    let shipped = context.case(CASE)?;
    let text = &shipped.text;
    let part = |mark: &str| text.find(mark).ok_or(format!("{CASE} has no part {mark}"));
    let [start, joints, output] = ["[initial]", "[[joint_motion]]", "[output]"].map(part);
    let (joints, output) = (joints?, output?);
    let (head, tail) = (&text[..start?], &text[output..]);
    Ok([ALONE, &text[joints..output]].map(|motion| CaseText {
        path: shipped.path.clone(),
        text: format!("{head}{AT_REST}\n{motion}\n{tail}"),
    }))
}

/// Condition number of the target's ten numbers in the method's equations.
pub fn condition(e: &Estimate) -> f64 {
    let mut numbers = e.method_report.iter().flat_map(|r| &r.numbers);
    let found = numbers.find(|n| n.name.ends_with("condition of these"));
    found.and_then(|n| n.value).unwrap_or(f64::NAN)
}

/// The answer of the linear steps with only the target unknown, without noise and with errors of 20 to 30 % in its nominal
/// numbers, and the truth.
///
/// # Errors
/// The case cannot be simulated, or does not suit the method.
pub fn answer(
    context: &Context,
    case: &CaseText,
) -> Result<(Estimate, MassProperties), StudyError> {
    let mut model = context.tools.vehicle(case)?;
    let truth = model.bodies[TARGET].nominal;
    let mut exact = model.clone();
    exact.sensors.clear();
    let table = context.tools.simulate(case, &exact, 0)?;
    model.bodies[TARGET].nominal = MassProperties {
        mass: 1.2 * truth.mass,
        p_BoBcm_B: 0.8 * truth.p_BoBcm_B,
        I_BBcm_B: 1.3 * truth.I_BBcm_B,
    };
    let tools = context.tools;
    let found = tools.identify(&model, vec![table], "xu2017", Some("linear"))?;
    Ok((found, truth))
}

/// One joint compared with all joints.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let mut table = Table::new(
        "target",
        "Grasped target, 60 s at 10 Hz from rest: condition of its ten numbers and largest error without noise; sigma of the mass by maximum likelihood, %",
        "motion | condition | error :1 | mass",
    );
    for (name, case) in MOTIONS.into_iter().zip(cases(context)?) {
        let (e, truth) = answer(context, &case)?;
        let (worst, _) = errors(&e.bodies[TARGET], &truth);
        let vehicle = context.tools.vehicle(&case)?;
        let bound = context.tools.bound(&case, &vehicle)?;
        let sigma = bound.bodies[TARGET].mass.sigma.unwrap_or(f64::NAN);
        table.row(name, [condition(&e), worst, 100.0 * sigma / truth.mass]);
    }
    Ok(Findings::of([table])
        .say(&["one joint at a time = condition {target.0.1} alone, {target.1.1} together"]))
}
