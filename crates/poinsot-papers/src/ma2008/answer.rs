//! From model and telemetry to the answer: the certificate, then the numbers of both steps.
//!
//! The paper has bounds of errors and no covariance. The linear method certifies the numbers (see [`crate::certified`]).

use super::Variant;
use super::arm::{Reading, Vehicle};
use super::bounds::{Bound, Limits};
use super::data::{check, raws};
use super::equations::{Given, TwoStep, two_step};
use crate::certified::{certificate, put};
use crate::method::Named;
use crate::numbers::printed;
use crate::study::statistics::largest;
use nalgebra::SymmetricEigen;
use poinsot_files::{Faults, Place};
use poinsot_identify::{
    BodyEstimate, Effect, Estimate, MethodReport, Number, Problem, Remark, ReportedNumber, Status,
};
use poinsot_model::{Model, MomentumKnowledge, Nuisance, SensorKind};
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, Vector3, elements, tensor};

/// Chi-square per degree of freedom above which the given momentum is compared with an unknown one.
const MISFIT: f64 = 9.0;
/// Its reduction without the given momentum from which the data contradict it.
const CONTRADICTED: f64 = 4.0;
/// Range of mass ratios that the paper studied.
const STUDIED: [f64; 2] = [0.005, 0.5];

/// Identifies the base of a vehicle by its arm.
///
/// # Errors
/// The method cannot be applied. Undetermined numbers are part of the answer, not an error.
///
/// ```
#[doc = include_str!("../../doc/record.txt")]
/// use poinsot_papers::ma2008::{Variant, identify};
///
/// let input = record("ma2008", "ma2008/model.toml", "ma2008/traj1/telemetry.parquet")?;
/// let estimate = identify(&problem(&input), Variant::UnknownMomentum)?;
/// // The true moments of the base are 166.67 kg m2.
/// let [I_xx, ..] = estimate.bodies[0].inertia;
/// assert!((I_xx.value.unwrap() - 166.67).abs() < 3.0 * I_xx.sigma.unwrap());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify(problem: &Problem, variant: Variant) -> Result<Estimate, Faults> {
    let given = check(problem, variant)?;
    let mut vehicle = Vehicle::new(problem.model, problem.tree);
    let mut segments: Vec<Vec<Reading>> = Vec::new();
    let mut step = None;
    for segment in problem.segments {
        let (raws, summed) = raws(problem, segment, &given)?;
        segments.push(raws.iter().map(|raw| vehicle.reading(raw)).collect());
        step = step.or(summed);
    }
    let solved = two_step(&segments, given);
    if solved.linear.singular[0].is_nan() {
        let what = "the equations hold a number that is not finite";
        let advice = "check units and magnitudes of the telemetry";
        return Err(Faults::one("E0529", Place::default(), what, advice));
    }
    // The mass centre is that of step 1: angular momentum about one that is open says nothing of it.
    let first = Given {
        h_C_N: None,
        ..given
    };
    let mut estimate = certified(problem, first)?;
    let mut bodies = estimate.bodies.iter().take(1);
    let is_centred = bodies.all(|b| b.com.iter().all(|n| n.value.is_some()));
    if given != first && is_centred {
        estimate = certified(problem, given)?;
    }
    let limits = limits(problem, &segments, given, &solved, step);
    if solved.linear.singular[3] <= limits.linear.0 {
        keep_mass(&mut estimate);
    }
    for momentum in &mut estimate.momentum {
        let known = |p: Vector3| [p.x, p.y, p.z].map(Number::known);
        momentum.linear = given.p_C_N.map_or(momentum.linear, known);
        momentum.angular = given.h_C_N.map_or(momentum.angular, known);
    }
    let contradicted = contradiction(problem, given, &estimate)?;
    let (base, impossible) = base(problem, &solved, &estimate);
    estimate.method = "ma2008".to_owned();
    estimate.variant = Some(variant.name().to_owned());
    let warnings = warnings(problem.model, &solved, impossible);
    estimate.add_all(warnings.into_iter().map(Remark::warning));
    if step.is_some() {
        estimate.add(Remark::assumption("velocity: summed from the first sample over velocity increments or specific force; its unknown constant is eliminated"));
    }
    let bodies = problem.model.bodies.iter().skip(1);
    let bodies = bodies.map(|b| b.nominal.parameters());
    let bodies: Vec<InertialParameters> =
        std::iter::once(base.parameters()).chain(bodies).collect();
    let rejected = impossible || contradicted.is_some();
    put(problem, &mut estimate, &bodies, rejected);
    // The cause of whatever else the certificate doubts.
    let cause = contradicted.map(Remark::warning);
    estimate.remarks.splice(0..0, cause);
    if rejected {
        let words = "the data are inconsistent with the given momentum, or leave no positive mass";
        estimate.add(Remark::test("rigid model", Effect::RejectsModel, words));
    }
    estimate.method_report = Some(report(limits.bounds(&solved)));
    Ok(estimate)
}

/// The certificate with this momentum known, and only that.
fn certified(problem: &Problem, given: Given) -> Result<Estimate, Faults> {
    let mut model = problem.model.clone();
    let known = |x| match x {
        Some(x) => MomentumKnowledge::Known(x),
        None => MomentumKnowledge::Estimate,
    };
    model.momentum.linear = known(given.p_C_N);
    model.momentum.angular = known(given.h_C_N);
    certificate(&Problem {
        model: &model,
        ..*problem
    })
}

/// Says that the given momentum contradicts the data, where they fit far better without it.
fn contradiction(
    problem: &Problem,
    given: Given,
    found: &Estimate,
) -> Result<Option<String>, Faults> {
    let misfit = |e: &Estimate| largest(e.fit.iter().map(|f| f.chi2_per_dof));
    let chi2 = misfit(found);
    if given == Given::default() || chi2 <= MISFIT {
        return Ok(None);
    }
    let free = misfit(&certified(problem, Given::default())?);
    Ok((chi2 > CONTRADICTED * free).then(|| {
        format!(
            "the declared momentum is inconsistent with the data: residuals are {:.1} times the declared noise with it and {:.1} times without; give linear_N_s and angular_N_m_s in N, angular about the system mass centre, at the first sample, or use --variant unknown-momentum",
            chi2.sqrt(),
            free.sqrt()
        )
    }))
}

/// The base by both steps, with nominal numbers along directions that they do not determine; whether its mass is impossible.
fn base(problem: &Problem, solved: &TwoStep, certified: &Estimate) -> (MassProperties, bool) {
    let nominal = problem
        .model
        .bodies
        .first()
        .map_or(MassProperties::ZERO, |b| b.nominal);
    let c = nominal.p_BoBcm_B;
    let x = [solved.arm_mass / nominal.mass, c.x, c.y, c.z];
    let x = solved.linear.completed(&x.into());
    let asked = certified
        .bodies
        .first()
        .is_some_and(|b| b.mass.value.is_some());
    let mass = solved.arm_mass / x[0];
    let possible = mass.is_finite() && mass > 0.0;
    let y = elements(&nominal.I_BBcm_B).into();
    let y = solved.angular.as_ref().map_or(y, |step| step.completed(&y));
    let base = MassProperties {
        mass: if possible { mass } else { nominal.mass },
        p_BoBcm_B: x.fixed_rows::<3>(1).into_owned(),
        I_BBcm_B: tensor(y.into()),
    };
    (base, asked && !possible)
}

fn warnings(model: &Model, solved: &TwoStep, impossible: bool) -> Vec<String> {
    let ratio = solved.linear.x[0];
    let mut gyros = model.sensors_of(SensorKind::Gyro);
    let mut list = Vec::new();
    if solved.angular.is_some() && ratio > 0.0 && !(STUDIED[0]..=STUDIED[1]).contains(&ratio) {
        list.push(format!(
            "the arm has {:.1} % of the base's mass; the paper studied 0.5 to 50 %",
            100.0 * ratio
        ));
    }
    for (holds, words) in [
        (
            impossible,
            "step 1 gives a negative mass: noise or a wrong model dominates it; no number is given",
        ),
        (
            gyros.any(|s| s.bias != Nuisance::Known),
            "the gyro's bias is declared unknown: ma2008 assumes zero; --method auto estimates it",
        ),
        (
            model.bodies.first().is_some_and(|b| b.prior.is_some()),
            "the base's prior is not used by ma2008",
        ),
    ] {
        list.extend(holds.then(|| words.to_owned()));
    }
    list
}

/// Withholds what step 1 does not tell apart from noise: the mass centre, and with it the tensor, even if other data show them.
fn keep_mass(estimate: &mut Estimate) {
    let open = |n: &Number| Number::undetermined(n.nominal);
    if let Some(base) = estimate.bodies.first_mut() {
        let (mass, rest) = (base.mass, base.barycentric.each_ref().map(open));
        let parameters = std::array::from_fn(|k| if k == 0 { mass } else { rest[k] });
        let (com, inertia) = (base.com.each_ref(), base.inertia.each_ref());
        let name = base.name.clone();
        *base =
            BodyEstimate::from_numbers(name, mass, com.map(open), inertia.map(open), parameters);
    }
    let of_mass = |name: &String| name.ends_with(".mass");
    let kept: Vec<usize> = (0..estimate.covariance_names.len())
        .filter(|k| of_mass(&estimate.covariance_names[*k]))
        .collect();
    let row = |i: &usize| kept.iter().map(|j| estimate.covariance[*i][*j]).collect();
    estimate.covariance = kept.iter().map(row).collect();
    estimate.covariance_units = kept.iter().map(|k| estimate.covariance_units[*k]).collect();
    estimate.covariance_names.retain(of_mass);
    estimate.system = None;
    let found = &mut estimate.identifiability;
    found.determined.clear();
    found.rank = found.rank.min(kept.len());
    if estimate.status == Status::Converged {
        estimate.status = Status::Partial;
    }
}

/// Sizes of the error matrices under the declared noise of the velocities.
fn limits(
    problem: &Problem,
    segments: &[Vec<Reading>],
    given: Given,
    solved: &TwoStep,
    step: Option<Matrix3>,
) -> Limits {
    let root = |covariance: &Matrix3| {
        let e = SymmetricEigen::new(*covariance);
        e.eigenvectors * Matrix3::from_diagonal(&e.eigenvalues.map(|x| x.max(0.0).sqrt()))
    };
    let velocity = root(&step.unwrap_or(problem.noise.velocity));
    let rate = root(&problem.noise.gyro);
    // The errors of increments add up.
    let grown = |k: usize| step.map_or(1.0, |_| (k as f64).sqrt());
    let errors = |s: &Reading, k: usize| [s.R_NB.transpose() * velocity * grown(k), rate];
    Limits::of(segments, given, solved, errors)
}

/// Condition numbers and bounds of both steps.
fn report(bounds: Vec<Bound>) -> MethodReport {
    let units = [
        ["mixed", "m/s", "mixed (1, m)"],
        ["rad/s", "N m s", "kg m2"],
    ];
    let number = |(n, (bound, [matrix, right, error])): (usize, (_, [&'static str; 3]))| {
        let bound: Bound = bound;
        [
            ("condition number of the matrix", "1", bound.condition),
            ("size of the matrix error, limit", matrix, bound.epsilon_A),
            (
                "size of the right-hand side error, limit",
                right,
                bound.epsilon_b,
            ),
            (
                "first-order bound of the error, eq. (35)",
                error,
                bound.absolute,
            ),
            ("relative bound, eq. (36)", "1", bound.relative),
        ]
        .map(|(what, unit, x)| printed(format!("step {n}: {what}"), unit, x, 0.0))
    };
    let steps = (1..).zip(bounds.into_iter().zip(units));
    let numbers: Vec<ReportedNumber> = steps.flat_map(number).collect();
    MethodReport {
        note: "Ma, Dang and Pham 2008, Sec. IV: first-order bounds of the errors and condition numbers of both steps. The sizes of the error matrices are limits that the declared noise of the velocities exceeds with a probability below 0.1 %. Sigma above is that of the linear method, widened by the difference to it".to_owned(),
        numbers,
    }
}
