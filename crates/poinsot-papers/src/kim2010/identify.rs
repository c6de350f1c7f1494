//! The paper's estimators as answers to a [`Problem`]. The linear method certifies (see [`crate::certified`]); numbers
//! that it does not certify are only in the report of the method.

use super::Variant;
use super::sums::{Answer, Manoeuvre, NAMES, StartRate, Sums, wheel_momentum};
use crate::certified::put;
use crate::method::Named;
use crate::numbers::printed;
use poinsot_files::{Faults, Place};
use poinsot_identify::{
    Effect, Estimate, MethodReport, Problem, Remark, ReportedNumber, Segment, Status, linear,
};
use poinsot_spatial::{MassProperties, TENSOR, Vector3, tensor_index, tensor_name};

/// A direction is identifiable if its sigma is below this fraction of nominal or below the requested accuracy.
/// Stricter than elsewhere, because the estimators have no sigma of their own.
const CERTIFIED: f64 = 0.1;
/// Rates at the first sample below this many gyro sigmas count as zero.
const REST: f64 = 5.0;

/// Identifies the inertia of one body with wheels by one of the paper's estimators.
///
/// # Errors
/// Invalid model or telemetry. Undetermined numbers are part of the answer, not an error.
///
/// ```
#[doc = include_str!("../../doc/record.txt")]
/// use poinsot_papers::kim2010::{Variant, identify};
///
/// let input = record("kim2010", "stsat3/model.toml", "stsat3/multiaxis/telemetry.parquet")?;
/// let estimate = identify(&problem(&input), Variant::Batch)?;
/// assert_eq!(estimate.identifiability.rank, 6);
/// assert!(estimate.method_report.is_some_and(|report| !report.numbers.is_empty()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify(problem: &Problem, variant: Variant) -> Result<Estimate, Faults> {
    check(problem)?;
    let mut estimate = linear(&Problem {
        relative_accuracy: problem.relative_accuracy.min(CERTIFIED),
        ..*problem
    })?;
    let sums = sums(problem)?;
    let mut found = run(&sums, variant)?;
    let nominal = problem.model.bodies[0].nominal;
    let at_rest = match problem.segments.iter().all(|s| starts_at_rest(problem, s)) {
        true => {
            "Rates at the first sample are zero within the noise and taken so, as in the paper."
        }
        false => "Rates at the first sample are not zero: I w(0) is kept in (7), beyond the paper.",
    };
    let note = format!(
        "Kim, Choi and Oh 2010, {}: the numbers as the paper's equations give them. They are no answer where the linear method finds them not identifiable ({} of {} combinations are determined). Sigma above is that of the linear method, widened by the difference to it. {at_rest}{}",
        variant.name(),
        estimate.identifiability.rank,
        estimate.identifiability.parameters,
        found.note,
    );
    let moments = sums.conventional()?.elements;
    // Withhold all numbers if the certificate has a negative moment of inertia.
    let impossible = (0..3).any(|k| moments[(k, k)] <= 0.0)
        || estimate.bodies[0].physically_consistent == Some(false);
    let number = |prefix: &str, name: &str, value: f64| {
        let nominal = nominal.I_BBcm_B[TENSOR[tensor_index(name)]];
        printed(format!("{prefix}_{name}"), "kg m2", value, nominal)
    };
    let six = NAMES.map(|name| tensor_name(tensor_index(name)));
    let six = six.into_iter().zip(found.answer.printed);
    let mut numbers: Vec<ReportedNumber> =
        six.map(|(name, x)| number("inertia", name, x)).collect();
    if variant == Variant::Batch {
        let nine = ["xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"];
        let rows = found.answer.elements.transpose();
        let nine = nine.into_iter().zip(rows.iter());
        numbers.extend(nine.map(|(name, x)| number("element", name, *x)));
    }
    numbers.append(&mut found.numbers);
    estimate.method = "kim2010".to_owned();
    estimate.variant = Some(variant.name().to_owned());
    if !found.settled && estimate.status == Status::Converged {
        let words = "the iteration of the method did not settle";
        estimate.add(Remark::test("convergence", Effect::WithholdsNumbers, words));
    }
    let body = MassProperties {
        I_BBcm_B: (found.answer.elements + found.answer.elements.transpose()) * 0.5,
        ..nominal
    };
    put(problem, &mut estimate, &[body.parameters()], impossible);
    if impossible {
        let test = "physical inertia";
        let words =
            "a moment of inertia is not positive; --method auto names a wheel with the wrong sign";
        estimate.add(Remark::test(test, Effect::RejectsModel, words));
    }
    estimate.method_report = Some(MethodReport { note, numbers });
    Ok(estimate)
}

/// Refuses vehicles and experiments that the paper does not treat.
fn check(problem: &Problem) -> Result<(), Faults> {
    let model = problem.model;
    let firing = problem.segments.iter().find(|s| !s.firings.is_empty());
    let other = "use --method maximum_likelihood";
    let (obstacle, advice) = if model.bodies.len() != 1 {
        let bodies = format!("the model has {} bodies", model.bodies.len());
        (bodies, other)
    } else if model.wheels.is_empty() {
        let scale = "the model has no wheel, so the scale of the inertia is undetermined";
        (scale.to_owned(), other)
    } else if let Some(segment) = firing {
        (format!("thrusters fire in '{}'", segment.label), other)
    } else if !model.bodies[0].estimate.inertia {
        let known = "the inertia is given as known".to_owned();
        (known, "set estimate = [\"inertia\"]")
    } else {
        return Ok(());
    };
    let problem =
        format!("kim2010 is for one rigid body with wheels and no external torque: {obstacle}");
    Err(Faults::one("E0425", Place::default(), problem, advice))
}

fn starts_at_rest(problem: &Problem, segment: &Segment) -> bool {
    let sigma = problem.noise.gyro.trace().sqrt();
    let first = segment.samples.w_NB_B.first();
    first.is_none_or(|w| w.norm() <= REST * sigma)
}

/// The sums of all segments.
fn sums(problem: &Problem) -> Result<Sums, Faults> {
    let wheels = &problem.model.wheels;
    let axes: Vec<Vector3> = wheels.iter().map(|w| w.axis_B).collect();
    let spin: Vec<f64> = wheels.iter().map(|w| w.spin_inertia).collect();
    let momenta = |s: &Segment| -> Vec<Vector3> {
        let speeds = s.samples.wheel_speed.chunks_exact(wheels.len());
        let momentum = |speed| wheel_momentum(&axes, &spin, speed);
        speeds.map(momentum).collect()
    };
    let momenta: Vec<Vec<Vector3>> = problem.segments.iter().map(momenta).collect();
    let segments = problem.segments.iter().zip(&momenta);
    let manoeuvres = segments.map(|(segment, h_W_B)| Manoeuvre {
        R_NB: &segment.samples.R_NB,
        w_NB_B: &segment.samples.w_NB_B,
        h_W_B,
        start: match starts_at_rest(problem, segment) {
            true => StartRate::Rest,
            false => StartRate::Measured,
        },
    });
    Sums::of(&manoeuvres.collect::<Vec<_>>())
}

/// Result of one estimator.
struct Found {
    answer: Answer,
    note: String,
    numbers: Vec<ReportedNumber>,
    settled: bool,
}

fn run(sums: &Sums, variant: Variant) -> Result<Found, Faults> {
    let (mut note, mut numbers, mut settled) = (String::new(), Vec::new(), true);
    let answer = match variant {
        Variant::Conventional => sums.conventional()?,
        Variant::Suggested => sums.suggested()?,
        Variant::PreEstimate => sums.pre_estimate()?,
        Variant::Batch => {
            let (answer, rank) = sums.batch()?;
            if rank < 9 {
                note = format!(
                    " H^T H in (3) has rank {rank} of 9: the solution of smallest norm is printed."
                );
            }
            answer
        }
        Variant::Iterated => {
            let it = sums.iterated()?;
            settled = it.converged;
            let end = match it.free_directions {
                0 => "its fixed point is unique".to_owned(),
                n => format!("{n} directions are free: any value along them is a fixed point"),
            };
            note = format!(
                " The iteration {} in {} sweeps (spectral radius {:.9}); {end}.",
                if settled {
                    "settled"
                } else {
                    "did not converge"
                },
                it.sweeps,
                it.spectral_radius
            );
            let counts = [
                ("sweeps", it.sweeps as f64),
                ("spectral_radius", it.spectral_radius),
                ("free_directions", it.free_directions as f64),
            ];
            numbers.extend(counts.map(|(name, x)| printed(name.to_owned(), "1", x, x)));
            it.answer
        }
    };
    Ok(Found {
        answer,
        note,
        numbers,
        settled,
    })
}
