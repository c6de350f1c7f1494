//! The paper's estimators as answers to a [`Problem`]: certificate first, then their own numbers.
//!
//! None of them says how good its numbers are, so the linear method answers that: what it certifies may
//! stand in the answer, the rest only in the report of the method.

use super::suspicions::suspicions;
use super::{Kim2010Error, Manoeuvre, NAMES, StartRate, Sums, Variant, wheel_momentum};
use crate::method::{About, Method, MethodError, Named};
use crate::setting::Settings;
use crate::study::Study;
use poinsot_identify::{
    BodyEstimate, Estimate, MethodReport, NamedNumber, Number, Problem, ProblemError, Segment,
    Source, Status, TENSOR, linear,
};
use poinsot_model::Model;
use poinsot_spatial::{Matrix3, Vector3};

/// A direction counts as seen where its one sigma is below this share of the nominal value, or below what
/// was asked for. Stricter than elsewhere: the estimators state no sigma of their own.
const CERTIFIED: f64 = 0.1;
/// An element that differs from the certificate's by more than this share of the largest moment, and by more than
/// [`APART_SIGMAS`], is not to be relied on: the paper's approximations do not hold for the manoeuvre.
const APART: f64 = 0.01;
/// Sigmas of the certificate.
const APART_SIGMAS: f64 = 5.0;
/// Rates at the first sample below this many sigma of the gyro are rest.
const REST: f64 = 5.0;

/// Why a problem cannot be put to the paper's estimators.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Kim2010ProblemError {
    /// No problem for any method.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The estimators cannot divide.
    #[error(transparent)]
    Method(#[from] Kim2010Error),
    /// Another kind of vehicle or experiment.
    #[error("E0425 kim2010 is for one rigid body with wheels and no external torque: {what}")]
    Unsuited {
        /// What does not fit, and what to do.
        what: String,
    },
}

/// This method in the list of methods.
pub struct Kim2010;

impl Method for Kim2010 {
    fn about(&self) -> About {
        About {
            name: "kim2010",
            summary: "inertia of one body from the momentum of its wheels, attitude and rates",
            citation: "Kim, Choi, Oh, J. Astron. Space Sci. 27(4), 2010, doi 10.5140/JASS.2010.27.4.353",
            variants: Variant::texts(),
            settings: &[],
            reads_accelerations: false,
            codes: super::codes::CODES,
        }
    }

    fn identify(
        &self,
        problem: &Problem,
        variant: Option<&str>,
        _: &Settings,
    ) -> Result<Estimate, MethodError> {
        let variant = Variant::named(self.about().name, variant)?;
        Ok(identify(problem, variant)?)
    }

    fn studies(&self) -> &'static [Study] {
        super::studies::STUDIES
    }
}

impl Named for Variant {
    const ALL: &'static [(Self, &'static str)] = &[
        (
            Self::Suggested,
            "products of inertia from the moments alone, (14)-(16)",
        ),
        (Self::Batch, "nine elements at once, (2)-(4)"),
        (Self::Conventional, "every element alone, (8)-(10), (14)"),
        (
            Self::PreEstimate,
            "each product with the other one of its row as (15) gives it",
        ),
        (
            Self::Iterated,
            "(14)-(16) repeated, the paper's future work",
        ),
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Suggested => "suggested",
            Self::Batch => "batch",
            Self::Conventional => "conventional",
            Self::PreEstimate => "pre-estimate",
            Self::Iterated => "iterated",
        }
    }
}

/// Identifies the inertia of one body with wheels by one of the paper's estimators.
///
/// # Errors
/// The question cannot be asked. What the data leave open is an answer, not an error.
pub fn identify(problem: &Problem, variant: Variant) -> Result<Estimate, Kim2010ProblemError> {
    check(problem)?;
    let mut estimate = linear(&Problem {
        relative_accuracy: problem.relative_accuracy.min(CERTIFIED),
        ..*problem
    })?;
    let (sums, at_rest) = sums(problem)?;
    let mut found = run(&sums, variant)?;
    let nominal = problem.model.bodies[0].nominal.I_BBcm_B;
    let mut notes = vec![format!(
        "Kim, Choi and Oh 2010, {}: the numbers of the published method as they come, without uncertainty. They are no answer where the certificate says not identifiable ({} of {} combinations are seen).",
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
    estimate.warnings.extend(suspected);
    // No tensor has a negative moment, and none the certificate may stand on one.
    let impossible = (0..3).any(|k| moments[(k, k)] <= 0.0)
        || estimate.bodies[0].physically_consistent == Some(false);
    let numbers = |names: &[&str], values: &[f64], prefix: &str| -> Vec<NamedNumber> {
        let named = names.iter().zip(values);
        named
            .map(|(name, value)| NamedNumber {
                name: format!("{prefix}_{name}"),
                unit: "kg m2",
                number: plain(*value, nominal_of(&nominal, name)),
            })
            .collect()
    };
    let mut list = numbers(&NAMES, &found.printed, "inertia");
    if variant == Variant::Batch {
        let nine = ["xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"];
        let values: Vec<f64> = (0..9).map(|k| found.tensor[(k / 3, k % 3)]).collect();
        list.extend(numbers(&nine, &values, "element"));
    }
    list.append(&mut found.numbers);
    estimate.method = "kim2010".to_owned();
    estimate.variant = Some(variant.name().to_owned());
    if !found.settled && estimate.status == Status::Converged {
        estimate.status = Status::IterationLimit;
    }
    let symmetric = (found.tensor + found.tensor.transpose()) * 0.5;
    let certified = estimate.bodies[0].clone();
    if let Some(doubt) = apart(&certified, &symmetric).filter(|_| !impossible) {
        estimate.doubt(doubt);
    }
    estimate.bodies[0] = replaced(certified, &symmetric, impossible);
    if impossible {
        estimate.status = Status::Rejected;
    }
    estimate.system = None;
    estimate.nuisance.clear();
    estimate.covariance_names.clear();
    estimate.covariance_units.clear();
    estimate.covariance.clear();
    estimate.covariance_trustworthy = false;
    estimate.method_report = Some(MethodReport {
        note: notes.join(" "),
        numbers: list,
    });
    Ok(estimate)
}

/// The element that is furthest from the certificate's, where that is too far.
fn apart(certified: &BodyEstimate, found: &Matrix3) -> Option<String> {
    let largest = found.symmetric_eigenvalues().amax();
    let gaps = certified.inertia.iter().zip(TENSOR).filter_map(|(n, e)| {
        let (value, sigma) = (n.value?, n.sigma?);
        let gap = (found[e] - value).abs();
        (gap > APART * largest && gap > APART_SIGMAS * sigma).then_some((gap, e))
    });
    let (gap, (i, j)) = gaps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let axis = ["x", "y", "z"];
    Some(format!(
        "I_{}{} is {:.1} % of the largest moment away from linear least squares of the same data: the estimator neglects products of inertia that this manoeuvre shows; use --variant batch or --method maximum_likelihood",
        axis[i.min(j)],
        axis[i.max(j)],
        100.0 * gap / largest
    ))
}

fn check(problem: &Problem) -> Result<(), Kim2010ProblemError> {
    let model: &Model = problem.model;
    let unsuited = |what: String| Err(Kim2010ProblemError::Unsuited { what });
    if model.bodies.len() != 1 {
        return unsuited(format!(
            "the model has {} bodies; use --method maximum_likelihood",
            model.bodies.len()
        ));
    }
    if model.wheels.is_empty() {
        return unsuited("the model has no wheel, so the scale of the inertia is open; use --method maximum_likelihood".into());
    }
    if let Some(segment) = problem.segments.iter().find(|s| !s.firings.is_empty()) {
        return unsuited(format!(
            "thrusters fire in '{}'; use --method maximum_likelihood",
            segment.label
        ));
    }
    if !model.bodies[0].estimate.inertia {
        return unsuited("the inertia is given as known; set estimate = [\"inertia\"]".into());
    }
    Ok(())
}

/// The sums of all segments, and whether every one starts at rest.
fn sums(problem: &Problem) -> Result<(Sums, bool), Kim2010Error> {
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

/// What one estimator says.
struct Found {
    tensor: Matrix3,
    printed: [f64; 6],
    notes: Vec<String>,
    numbers: Vec<NamedNumber>,
    settled: bool,
}

fn run(sums: &Sums, variant: Variant) -> Result<Found, Kim2010Error> {
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
                "did not settle"
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

fn nominal_of(I: &Matrix3, name: &str) -> f64 {
    let index = |c: Option<char>| c.and_then(|c| "xyz".find(c)).unwrap_or(0);
    let mut letters = name.chars();
    I[(index(letters.next()), index(letters.next()))]
}

/// The certified body with the method's numbers where the certificate stands, and no sigma; all open where
/// the data contradict any rigid body.
fn replaced(mut body: BodyEstimate, I: &Matrix3, impossible: bool) -> BodyEstimate {
    let seen = |n: &Number| n.source == Source::Data;
    let shift: [Option<f64>; 6] = std::array::from_fn(|k| {
        body.barycentric[4 + k]
            .value
            .zip(body.inertia[k].value)
            .map(|(o, cm)| o - cm)
    });
    for k in 0..6 {
        if !seen(&body.inertia[k]) {
            continue;
        }
        if impossible {
            body.inertia[k] = Number::open(body.inertia[k].nominal);
            continue;
        }
        let value = I[TENSOR[k]];
        body.inertia[k] = plain(value, body.inertia[k].nominal);
        body.barycentric[4 + k] = match shift[k] {
            Some(shift) => plain(value + shift, body.barycentric[4 + k].nominal),
            None => Number::open(body.barycentric[4 + k].nominal),
        };
    }
    for number in body
        .com
        .iter_mut()
        .chain([&mut body.mass])
        .chain(&mut body.barycentric)
    {
        if seen(number) && number.sigma.is_some() {
            *number = Number::open(number.nominal);
        }
    }
    BodyEstimate::from_numbers(
        body.name,
        body.mass,
        body.com,
        body.inertia,
        body.barycentric,
    )
}
