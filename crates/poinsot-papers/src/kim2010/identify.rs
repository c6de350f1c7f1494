//! The paper's estimators as answers to a [`Problem`]. The linear method certifies (see [`crate::certified`]); numbers
//! that it does not certify are only in the report of the method.

use super::sums::{Manoeuvre, NAMES, StartRate, Sums, wheel_momentum};
use super::suspicions::suspicions;
use super::variant::Variant;
use crate::certified::put;
use crate::kim2010::error;
use crate::method::Named;
use poinsot_files::Faults;
use poinsot_identify::{
    Effect, Estimate, MethodReport, NamedNumber, Number, Problem, Remark, Segment, Source, Status,
    TENSOR, linear, tensor_index, tensor_name,
};
use poinsot_model::Model;
use poinsot_spatial::{MassProperties, Matrix3, Vector3};

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
    let (sums, at_rest) = sums(problem)?;
    let mut found = run(&sums, variant)?;
    let nominal = problem.model.bodies[0].nominal;
    let mut notes = vec![format!(
        "Kim, Choi and Oh 2010, {}: the numbers as the paper's equations give them. They are no answer where the linear method finds them not identifiable ({} of {} combinations are determined). Sigma above is that of the linear method, widened by the difference to it.",
        variant.name(),
        estimate.identifiability.rank,
        estimate.identifiability.parameters,
    )];
    notes.push(match at_rest {
        true => {
            "Rates at the first sample are zero within the noise and taken so, as in the paper."
                .into()
        }
        false => "Rates at the first sample are not zero: I w(0) is kept in (7), beyond the paper."
            .into(),
    });
    notes.append(&mut found.notes);
    let moments = sums.conventional()?.elements;
    let suspected = suspicions(problem, &moments, &estimate);
    estimate.add_all(suspected.into_iter().map(Remark::warning));
    // Withhold all numbers if the certificate has a negative moment of inertia.
    let impossible = (0..3).any(|k| moments[(k, k)] <= 0.0)
        || estimate.bodies[0].physically_consistent == Some(false);
    let numbers = |names: &[&str], values: &[f64], prefix: &str| -> Vec<NamedNumber> {
        let named = names.iter().zip(values);
        named
            .map(|(name, value)| NamedNumber {
                name: format!("{prefix}_{name}"),
                unit: "kg m2",
                number: plain(*value, nominal.I_BBcm_B[TENSOR[tensor_index(name)]]),
            })
            .collect()
    };
    let six = NAMES.map(|name| tensor_name(tensor_index(name)));
    let mut list = numbers(&six, &found.printed, "inertia");
    if variant == Variant::Batch {
        let nine = ["xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"];
        let values: Vec<f64> = (0..9).map(|k| found.tensor[(k / 3, k % 3)]).collect();
        list.extend(numbers(&nine, &values, "element"));
    }
    list.append(&mut found.numbers);
    estimate.method = "kim2010".to_owned();
    estimate.variant = Some(variant.name().to_owned());
    if !found.settled && estimate.status == Status::Converged {
        let words = "the iteration of the method did not settle";
        estimate.add(Remark::test("convergence", Effect::WithholdsNumbers, words));
    }
    let body = MassProperties {
        I_BBcm_B: (found.tensor + found.tensor.transpose()) * 0.5,
        ..nominal
    };
    put(problem, &mut estimate, &[body.parameters()], impossible);
    if impossible {
        let words = "a moment of inertia is not positive";
        estimate.add(Remark::test(
            "physical inertia",
            Effect::RejectsModel,
            words,
        ));
    }
    estimate.method_report = Some(MethodReport {
        note: notes.join(" "),
        numbers: list,
    });
    Ok(estimate)
}

fn check(problem: &Problem) -> Result<(), Faults> {
    let model: &Model = problem.model;
    let unsuited = |what: &str, advice| Err(error::unsuited(what, advice));
    if model.bodies.len() != 1 {
        return unsuited(
            &format!("the model has {} bodies", model.bodies.len()),
            "use --method maximum_likelihood",
        );
    }
    if model.wheels.is_empty() {
        return unsuited(
            "the model has no wheel, so the scale of the inertia is undetermined",
            "use --method maximum_likelihood",
        );
    }
    if let Some(segment) = problem.segments.iter().find(|s| !s.firings.is_empty()) {
        return unsuited(
            &format!("thrusters fire in '{}'", segment.label),
            "use --method maximum_likelihood",
        );
    }
    if !model.bodies[0].estimate.inertia {
        return unsuited(
            "the inertia is given as known",
            "set estimate = [\"inertia\"]",
        );
    }
    Ok(())
}

/// The sums of all segments, and whether every segment starts at rest.
fn sums(problem: &Problem) -> Result<(Sums, bool), Faults> {
    let sigma = problem.noise.gyro.trace().sqrt();
    let rest = |s: &Segment| {
        let first = s.samples.w_NB_B.first();
        first.is_none_or(|w| w.norm() <= REST * sigma)
    };
    let momenta: Vec<Vec<Vector3>> = problem
        .segments
        .iter()
        .map(|s| momenta(problem, s))
        .collect();
    let manoeuvres: Vec<Manoeuvre> = problem
        .segments
        .iter()
        .zip(&momenta)
        .map(|(segment, h)| Manoeuvre {
            R_NB: &segment.samples.R_NB,
            w_NB_B: &segment.samples.w_NB_B,
            h_W_B: h,
            start: if rest(segment) {
                StartRate::Rest
            } else {
                StartRate::Measured
            },
        })
        .collect();
    Ok((Sums::of(&manoeuvres)?, problem.segments.iter().all(rest)))
}

fn momenta(problem: &Problem, segment: &Segment) -> Vec<Vector3> {
    let wheels = &problem.model.wheels;
    let axes: Vec<Vector3> = wheels.iter().map(|w| w.axis_B).collect();
    let spin: Vec<f64> = wheels.iter().map(|w| w.spin_inertia).collect();
    let speeds = segment.samples.wheel_speed.chunks_exact(wheels.len());
    speeds
        .map(|speed| wheel_momentum(&axes, &spin, speed))
        .collect()
}

/// Result of one estimator.
struct Found {
    tensor: Matrix3,
    printed: [f64; 6],
    notes: Vec<String>,
    numbers: Vec<NamedNumber>,
    settled: bool,
}

fn run(sums: &Sums, variant: Variant) -> Result<Found, Faults> {
    let mut notes = Vec::new();
    let mut numbers = Vec::new();
    let mut settled = true;
    let answer = match variant {
        Variant::Conventional => sums.conventional()?,
        Variant::Suggested => sums.suggested()?,
        Variant::PreEstimate => sums.pre_estimate()?,
        Variant::Batch => {
            let (answer, rank) = sums.batch()?;
            if rank < 9 {
                notes.push(format!(
                    "H^T H in (3) has rank {rank} of 9: the solution of smallest norm is printed."
                ));
            }
            answer
        }
        Variant::Iterated => {
            let it = sums.iterated()?;
            settled = it.converged;
            let settled = if it.converged {
                "settled"
            } else {
                "did not converge"
            };
            let end = match (it.free_directions, it.fixed_point) {
                (0, _) => "its fixed point is unique".to_owned(),
                (n, _) => format!("{n} directions are free: any value along them is a fixed point"),
            };
            notes.push(format!(
                "The iteration {settled} in {} sweeps (spectral radius {:.9}); {end}.",
                it.sweeps, it.spectral_radius
            ));
            for (name, value) in [
                ("sweeps", it.sweeps as f64),
                ("spectral_radius", it.spectral_radius),
                ("free_directions", it.free_directions as f64),
            ] {
                numbers.push(NamedNumber {
                    name: name.to_owned(),
                    unit: "1",
                    number: plain(value, value),
                });
            }
            it.answer
        }
    };
    Ok(Found {
        tensor: answer.elements,
        printed: answer.printed,
        notes,
        numbers,
        settled,
    })
}

/// A number without a sigma.
fn plain(value: f64, nominal: f64) -> Number {
    Number {
        value: Some(value),
        sigma: None,
        nominal,
        source: Source::Data,
    }
}
