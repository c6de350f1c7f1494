//! From model and telemetry to the answer: both steps, identifiability, sigmas and notes.

use super::arm::{Raw, Vehicle};
use super::both::{NoisySolution, solve_both};
use super::bounds::Bound;
use super::data::{Variant, check, raws};
use super::equations::Given;
use super::sources::sources;
use super::ten::{MISFIT, Ten, properties, unit};
use super::words::{identifiability, warnings};
use crate::answered::as_one;
use crate::method::Named;
use nalgebra::DMatrix;
use poinsot_dynamics::Kinematics;
use poinsot_files::Faults;
use poinsot_identify::{
    BodyEstimate, Effect, Estimate, MethodReport, MomentumEstimate, NamedNumber, Number, Problem,
    Remark, Segment, SegmentFit, Source as From, Status, axis_name, tensor_name,
};
use poinsot_spatial::{InertialParameters, MassProperties};

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
    let mut estimate = write(problem, variant, given, &solved, contradicted);
    if step.is_some() {
        estimate.add(Remark::assumption("velocity: summed from the first sample over velocity increments or specific force; its unknown constant is eliminated"));
    }
    Ok(estimate)
}

fn write(
    problem: &Problem,
    variant: Variant,
    given: Given,
    solved: &NoisySolution,
    contradicted: Option<f64>,
) -> Estimate {
    let model = problem.model;
    let rejected = contradicted.is_some() || (solved.chi2 > REJECT && solved.explained < 0.5);
    let ten = Ten::new(solved, solved.chi2.sqrt().max(1.0), rejected);
    let first = model.bodies.first();
    let nominal = first.map_or(MassProperties::ZERO, |b| b.nominal);
    let name = first.map_or(String::new(), |b| b.name.clone());
    let base = body(&ten, name.clone(), &nominal, properties);
    let numbers = || {
        std::iter::once(&base.mass)
            .chain(&base.com)
            .chain(&base.inertia)
    };
    let open = numbers().filter(|n| n.source == From::Open).count();
    let status = match open {
        0 => Status::Converged,
        10 => Status::NotIdentifiable,
        _ => Status::Partial,
    };
    let (covariance_names, covariance_units, covariance) = covariance(&ten, &name);
    let system = (open == 0)
        .then(|| system(problem, &ten, &nominal))
        .flatten();
    let mut bodies = vec![base];
    bodies.extend(
        model
            .bodies
            .iter()
            .skip(1)
            .map(|b| BodyEstimate::known(b.name.clone(), &b.nominal)),
    );
    let warnings = warnings(problem, solved, &ten, contradicted, rejected, &bodies[0]);
    let warnings = warnings.into_iter().map(Remark::warning);
    let mut estimate = Estimate {
        method: "ma2008".to_owned(),
        variant: Some(variant.name().to_owned()),
        status,
        system,
        momentum: momentum(given, solved, &ten),
        nuisance: Vec::new(),
        covariance_names,
        covariance_units,
        covariance,
        identifiability: identifiability(&name, solved, &ten, rejected),
        fit: fit(problem, solved),
        states_covariance: true,
        remarks: Vec::new(),
        diagnostics: None,
        known_numbers: Default::default(),
        method_report: Some(report(solved)),
        iterations: 1,
        bodies,
    };
    estimate.add_all(tests(solved.chi2, rejected));
    estimate.add_all(warnings);
    estimate
}

fn tests(chi2: f64, rejected: bool) -> [Remark; 2] {
    let words = match rejected {
        true => "the data contradict the rigid model",
        false => "the data do not contradict the rigid model",
    };
    let model = Remark::test(
        "rigid model",
        Effect::RejectsModel.if_failed(rejected),
        words,
    );
    let effect = Effect::AgainstAnswer.if_failed(!rejected && chi2 > MISFIT);
    let words = format!("residuals are {:.1} times the declared noise", chi2.sqrt());
    let residuals = Remark::test("all residuals", effect, words)
        .statistic("chi-square per degree of freedom", chi2)
        .widening(chi2.sqrt());
    [model, residuals]
}

fn body(
    ten: &Ten,
    name: String,
    nominal: &MassProperties,
    of: impl Fn(&[f64; 10]) -> MassProperties,
) -> BodyEstimate {
    let pi = nominal.parameters().to_array();
    let mass = ten.number(nominal.mass, |u| of(u).mass);
    let com = [0, 1, 2].map(|k| ten.number(nominal.p_BoBcm_B[k], |u| of(u).p_BoBcm_B[k]));
    let inertia =
        poinsot_identify::TENSOR.map(|e| ten.number(nominal.I_BBcm_B[e], |u| of(u).I_BBcm_B[e]));
    let barycentric =
        std::array::from_fn(|k| ten.number(pi[k], |u| of(u).parameters().to_array()[k]));
    BodyEstimate::from_numbers(name, mass, com, inertia, barycentric)
}

fn system(
    problem: &Problem,
    ten: &Ten,
    nominal: &MassProperties,
) -> Option<(BodyEstimate, Vec<f64>)> {
    let q = problem
        .segments
        .first()?
        .samples
        .joint_position
        .get(..problem.tree.dof())?
        .to_vec();
    let mut kinematics = Kinematics::new(problem.tree);
    kinematics.place(problem.tree, &q);
    let arm: Vec<InertialParameters> = problem
        .model
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();
    let whole = |base: &MassProperties| {
        let mut all = arm.clone();
        if let Some(first) = all.first_mut() {
            *first = base.parameters();
        }
        let whole = as_one(&all, &kinematics).mass_properties();
        whole.unwrap_or(MassProperties::ZERO)
    };
    let of = |u: &[f64; 10]| whole(&properties(u));
    Some((body(ten, "system".to_owned(), &whole(nominal), of), q))
}

type Covariance = (Vec<String>, Vec<&'static str>, Vec<Vec<f64>>);

fn covariance(ten: &Ten, name: &str) -> Covariance {
    let kept: Vec<usize> = (0..10).filter(|&k| !ten.open[k]).collect();
    let label = |k: usize| match k {
        0 => format!("{name}.mass"),
        1..=3 => format!("{name}.com_{}", axis_name(k - 1)),
        _ => format!("{name}.inertia_{}", tensor_name(k - 4)),
    };
    let scale = ten.inflation * ten.inflation;
    (
        kept.iter().map(|&k| label(k)).collect(),
        kept.iter().map(|&k| unit(k)).collect(),
        kept.iter()
            .map(|&i| {
                kept.iter()
                    .map(|&j| scale * ten.mean_square(i, j))
                    .collect()
            })
            .collect(),
    )
}

fn momentum(given: Given, solved: &NoisySolution, ten: &Ten) -> Vec<MomentumEstimate> {
    let cov: &DMatrix<f64> = &solved.influence.covariance;
    let number = |value: f64, at: usize, open: bool| {
        if open {
            Number::undetermined(0.0)
        } else {
            Number::data(value, ten.inflation * cov[(at, at)].sqrt(), 0.0)
        }
    };
    let (open_P, open_H) = (ten.open[..4].contains(&true), ten.open.contains(&true));
    solved
        .influence
        .momentum
        .iter()
        .enumerate()
        .map(|(s, (P, H))| MomentumEstimate {
            linear: [0, 1, 2].map(|k| match given.p_C_N {
                Some(p) => Number::known(p[k]),
                None => number(P[k], 10 + 6 * s + k, open_P),
            }),
            angular: [0, 1, 2].map(|k| match given.h_C_N {
                Some(h) => Number::known(h[k]),
                None => number(H[k], 13 + 6 * s + k, open_H),
            }),
        })
        .collect()
}

fn fit(problem: &Problem, solved: &NoisySolution) -> Vec<SegmentFit> {
    let segments = problem.segments.iter().zip(&solved.chi2_segment);
    let of = |(s, chi2): (&Segment, &f64)| SegmentFit {
        label: s.label.clone(),
        samples: s.samples.time_s.len(),
        chi2_per_dof: *chi2,
        channels: Vec::new(),
    };
    segments.map(of).collect()
}

/// Sec. IV with the declared noise: errors, bounds, condition numbers of both steps.
fn report(solved: &NoisySolution) -> MethodReport {
    let units = [
        ["1", "mixed", "m/s", "mixed (1, m)", "1"],
        ["1", "rad/s", "N m s", "kg m2", "1"],
    ];
    let steps = solved.bounds.iter().zip(units).zip(1..);
    let of = |((bound, units), n): ((&Bound, [&'static str; 5]), i32)| {
        let numbers = [
            ("condition number of the matrix", bound.condition),
            ("size of the matrix error, limit", bound.epsilon_A),
            ("size of the right-hand side error, limit", bound.epsilon_b),
            ("first-order bound of the error, eq. (35)", bound.absolute),
            ("relative bound, eq. (36)", bound.relative),
        ];
        let named = move |((what, value), unit): ((&str, f64), &'static str)| NamedNumber {
            name: format!("step {n}: {what}"),
            unit,
            number: Number {
                value: value.is_finite().then_some(value),
                sigma: None,
                nominal: 0.0,
                source: From::Data,
            },
        };
        numbers.into_iter().zip(units).map(named)
    };
    MethodReport {
        note: "Ma, Dang and Pham 2008, Sec. IV: first-order bounds of the errors and condition numbers of both steps. The sizes of the error matrices are limits that the declared noise exceeds with a probability below 0.1 %".to_owned(),
        numbers: steps.flat_map(of).collect(),
    }
}
