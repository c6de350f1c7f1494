//! From model and telemetry to the answer: both steps, identifiability, sigmas and notes.

use super::Variant;
use super::arm::{Raw, Vehicle};
use super::both::{NoisySolution, solve_both};
use super::data::{check, raws};
use super::equations::Given;
use super::influence::sources;
use super::ten::{MISFIT, Ten};
use super::words::{identifiability, warnings};
use crate::method::Named;
use crate::numbers::printed;
use poinsot_dynamics::{Kinematics, composite};
use poinsot_files::Faults;
use poinsot_identify::{
    BodyEstimate, Effect, Estimate, MethodReport, MomentumEstimate, Number, Problem, Remark,
    SegmentFit, Source, Status,
};
use poinsot_model::Body;
use poinsot_spatial::{
    InertialParameters, MASS_PROPERTY_NAMES, MASS_PROPERTY_UNITS, MassProperties, Vector3,
};

/// Ratio above which the answer is rejected: the model explains little, or the given momentum explains less than none.
const REJECT: f64 = 9.0;

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
    let mut data: Vec<Vec<Raw>> = Vec::new();
    let mut step = None;
    for segment in problem.segments {
        let (raws, summed) = raws(problem, segment, &given)?;
        data.push(raws);
        step = step.or(summed);
    }
    let mut segments = problem.segments.iter();
    let velocity = segments.any(|s| s.samples.translation.is_some());
    let sources = sources(problem.noise, velocity, step);
    let solved = solve_both(problem, &mut vehicle, &data, &sources, given)?;
    let mut contradicted = None;
    if given != Given::default() && solved.chi2 > REJECT {
        let free = solve_both(problem, &mut vehicle, &data, &sources, Given::default())?;
        contradicted = (solved.chi2 > 4.0 * free.chi2).then_some(free.chi2);
    }
    let rejected = contradicted.is_some() || (solved.chi2 > REJECT && solved.explained < 0.5);
    let ten = Ten::new(&solved, rejected);
    let mut estimate = write(problem, given, &solved, &ten);
    estimate.variant = Some(variant.name().to_owned());
    estimate.add_all(tests(solved.chi2, rejected));
    let warnings = warnings(problem, &solved, &ten, contradicted, &estimate.bodies[0]);
    estimate.add_all(warnings.into_iter().map(Remark::warning));
    if step.is_some() {
        estimate.add(Remark::assumption("velocity: summed from the first sample over velocity increments or specific force; its unknown constant is eliminated"));
    }
    Ok(estimate)
}

fn write(problem: &Problem, given: Given, solved: &NoisySolution, ten: &Ten) -> Estimate {
    let bodies = &problem.model.bodies;
    let first = bodies.first();
    let nominal = first.map_or(MassProperties::ZERO, |b| b.nominal);
    let name = first.map_or(String::new(), |b| b.name.clone());
    let base = body(ten, &name, &nominal, |base| base);
    let numbers = base.numbers();
    let open = numbers.iter().filter(|n| n.source == Source::Open).count();
    let system = || system(problem, ten, &nominal);
    let links = bodies.iter().skip(1);
    let links = links.map(|b: &Body| BodyEstimate::known(b.name.clone(), &b.nominal));
    let kept: Vec<usize> = (0..10).filter(|&k| !ten.open[k]).collect();
    let scale = ten.inflation * ten.inflation;
    let element = |i: usize, j: usize| scale * ten.mean_square(i, j);
    let row = |&i: &usize| kept.iter().map(|&j| element(i, j)).collect();
    let segments = problem.segments.iter().zip(&solved.chi2_segment);
    let fit = segments.map(|(s, chi2)| SegmentFit {
        label: s.label.clone(),
        samples: s.samples.time_s.len(),
        chi2_per_dof: *chi2,
        channels: Vec::new(),
    });
    Estimate {
        method: "ma2008".to_owned(),
        variant: None,
        status: match open {
            0 => Status::Converged,
            10 => Status::NotIdentifiable,
            _ => Status::Partial,
        },
        system: (open == 0).then(system).flatten(),
        momentum: momentum(given, solved, ten),
        nuisance: Vec::new(),
        covariance_names: kept
            .iter()
            .map(|&k| format!("{name}.{}", MASS_PROPERTY_NAMES[k]))
            .collect(),
        covariance_units: kept.iter().map(|&k| MASS_PROPERTY_UNITS[k]).collect(),
        covariance: kept.iter().map(row).collect(),
        identifiability: identifiability(&name, solved, ten),
        fit: fit.collect(),
        states_covariance: true,
        remarks: Vec::new(),
        diagnostics: None,
        known_numbers: Default::default(),
        method_report: Some(report(solved)),
        iterations: 1,
        bodies: std::iter::once(base).chain(links).collect(),
    }
}

fn tests(chi2: f64, rejected: bool) -> [Remark; 2] {
    let words = match rejected {
        true => "the data contradict the rigid model",
        false => "the data do not contradict the rigid model",
    };
    let effect = Effect::RejectsModel.if_failed(rejected);
    let model = Remark::test("rigid model", effect, words);
    let effect = Effect::AgainstAnswer.if_failed(!rejected && chi2 > MISFIT);
    let words = format!("residuals are {:.1} times the declared noise", chi2.sqrt());
    let residuals = Remark::test("all residuals", effect, words)
        .statistic("chi-square per degree of freedom", chi2)
        .widening(chi2.sqrt());
    [model, residuals]
}

/// A body that follows from the base.
fn body(
    ten: &Ten,
    name: &str,
    nominal: &MassProperties,
    of: impl Fn(MassProperties) -> MassProperties,
) -> BodyEstimate {
    let at = |u: &[f64; 10]| of(MassProperties::from_array(u));
    let (known, pi) = (nominal.to_array(), nominal.parameters().to_array());
    let number = |k: usize| ten.number(known[k], |u| at(u).to_array()[k]);
    let parameter = |k: usize| ten.number(pi[k], |u| at(u).parameters().to_array()[k]);
    BodyEstimate::from_numbers(
        name.to_owned(),
        number(0),
        [1, 2, 3].map(number),
        [4, 5, 6, 7, 8, 9].map(number),
        std::array::from_fn(parameter),
    )
}

fn system(
    problem: &Problem,
    ten: &Ten,
    nominal: &MassProperties,
) -> Option<(BodyEstimate, Vec<f64>)> {
    let samples = &problem.segments.first()?.samples;
    let q = samples.joint_position.get(..problem.tree.dof())?;
    let mut kinematics = Kinematics::new(problem.tree);
    kinematics.place(problem.tree, q);
    let bodies = problem.model.bodies.iter();
    let bodies: Vec<InertialParameters> = bodies.map(|b| b.nominal.parameters()).collect();
    let whole = |base: MassProperties| {
        let mut all = bodies.clone();
        all[0] = base.parameters();
        let whole = composite(&all, &kinematics).parameters().mass_properties();
        whole.unwrap_or(MassProperties::ZERO)
    };
    Some((body(ten, "system", &whole(*nominal), whole), q.to_vec()))
}

fn momentum(given: Given, solved: &NoisySolution, ten: &Ten) -> Vec<MomentumEstimate> {
    let covariance = &solved.influence.covariance;
    let (open_P, open_H) = (ten.open[..4].contains(&true), ten.open.contains(&true));
    let three = |given: Option<Vector3>, found: &Vector3, at: usize, open: bool| {
        [0, 1, 2].map(|k| match given {
            Some(given) => Number::known(given[k]),
            None if open => Number::undetermined(0.0),
            None => {
                let sigma = ten.inflation * covariance[(at + k, at + k)].sqrt();
                Number::data(found[k], sigma, 0.0)
            }
        })
    };
    let segments = solved.influence.momentum.iter().enumerate();
    let of = |(s, (P, H)): (usize, &(Vector3, Vector3))| MomentumEstimate {
        linear: three(given.p_C_N, P, 10 + 6 * s, open_P),
        angular: three(given.h_C_N, H, 13 + 6 * s, open_H),
    };
    segments.map(of).collect()
}

/// Sec. IV with the declared noise: errors, bounds, condition numbers of both steps.
fn report(solved: &NoisySolution) -> MethodReport {
    let (linear, angular) = (
        ["mixed", "m/s", "mixed (1, m)"],
        ["rad/s", "N m s", "kg m2"],
    );
    let steps = solved.bounds.iter().zip([linear, angular]);
    let mut list = Vec::new();
    for (n, (bound, [matrix, right, error])) in (1..).zip(steps) {
        let mut add = |what: &str, unit, x| {
            let name = format!("step {n}: {what}");
            list.push(printed(name, unit, x, 0.0));
        };
        add("condition number of the matrix", "1", bound.condition);
        add("size of the matrix error, limit", matrix, bound.epsilon_A);
        let size = "size of the right-hand side error, limit";
        add(size, right, bound.epsilon_b);
        let first_order = "first-order bound of the error, eq. (35)";
        add(first_order, error, bound.absolute);
        add("relative bound, eq. (36)", "1", bound.relative);
    }
    MethodReport {
        note: "Ma, Dang and Pham 2008, Sec. IV: first-order bounds of the errors and condition numbers of both steps. The sizes of the error matrices are limits that the declared noise exceeds with a probability below 0.1 %".to_owned(),
        numbers: list,
    }
}
