//! Held-back telemetry: how well given mass properties predict a record that was not used.
//!
//! No vehicle parameter is fitted, only those of the record: pose and momentum at the start of each segment, and biases
//! and other nuisances that the model declares unknown.

use crate::diagnosis::diagnose;
use crate::diagnosis::octaves::consistent;
use crate::fit::alternatives::{AlternativeFit, random_torque};
use crate::fit::experiment::Experiment;
use crate::fit::{Fitted, fit};
use crate::methods::maximum_likelihood::segment_fits;
use crate::prediction::completion::CompletedVehicle;
use crate::prediction::curves::{Prediction, predict};
use crate::problem::alternative::BetweenSamples;
use crate::problem::loss::Loss;
use crate::problem::parameters::Parameters;
use crate::problem::{Problem, ProblemError};
use crate::solution::estimate::SegmentFit;

/// How a record agrees with given mass properties.
#[derive(Debug, Clone)]
pub struct HeldBack {
    /// Per segment, residuals in the declared noise.
    pub fit: Vec<SegmentFit>,
    /// Per segment and kind of sensor, the largest whitened component of a residual, sigmas.
    pub worst: Vec<Vec<f64>>,
    /// Measured and predicted.
    pub predictions: Vec<Prediction>,
    /// Diagnosis of the residuals: outliers, causes, spectral lines.
    pub findings: Vec<String>,
    /// Whether the fit of pose, momentum and nuisances settled.
    pub converged: bool,
}

/// Compares the segments of a problem with the motion that a vehicle predicts; the model of the problem gives
/// sensors, wheels and thrusters, its own mass properties are not used. At most `points` points a curve;
/// `None` leaves out curves and findings, which take longer than the comparison.
///
/// # Errors
/// The segments hold too little, or the vehicle cannot move.
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// let vehicle = CompletedVehicle {
///     bodies: vec![model.bodies[0].nominal.parameters()],
///     spin_inertia: vec![],
///     thrust_factor: vec![],
/// };
/// let found = held_back(&problem, &vehicle, None)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn held_back(
    problem: &Problem,
    vehicle: &CompletedVehicle,
    points: Option<usize>,
) -> Result<HeldBack, ProblemError> {
    problem.check_observations()?;
    let (model, segments) = prepared(problem, vehicle);
    let problem = problem.with_model(&model).with_segments(&segments);
    let parameters = Parameters::without_mass(&model, problem.tree, &vehicle.bodies);
    let mut experiment = Experiment::new(&problem, &parameters);
    experiment.settings.loss = Loss::Gaussian;
    let settings = experiment.settings;
    let explains = |f: &Fitted| consistent(&f.evaluated, &settings);
    let fitted = fit(&experiment, None)?;
    let mut best = AlternativeFit::new(experiment, fitted);
    let mut process = None;
    if problem.assumes_wheel_motion() {
        // As in an identification: the data decide the wheel interpolation.
        let smooth = best.experiment.under(BetweenSamples::Smooth);
        let fitted = fit(&smooth, None)?;
        if smooth.cost_of(&fitted) < best.experiment.cost_of(&best.fitted) {
            best = AlternativeFit::new(smooth, fitted);
        }
        process = random_torque(&best.experiment, &best.fitted, explains(&best.fitted));
    }
    let driven = process.as_ref().map(|p| problem.with_segments(&p.segments));
    let AlternativeFit {
        experiment, fitted, ..
    } = best.or_random_torque(driven.as_ref(), explains);
    let (mut findings, mut predictions) = (Vec::new(), Vec::new());
    if let Some(points) = points {
        let found = diagnose(&experiment, &fitted);
        findings.extend(found.findings.into_iter().map(|f| f.text));
        predictions = predict(&experiment, &fitted.at, points);
    }
    let worst = fitted.evaluated.iter().map(|one| {
        let largest =
            |white: &[poinsot_spatial::Vector3]| white.iter().map(|w| w.amax()).fold(0.0, f64::max);
        one.channels.iter().map(|c| largest(&c.white)).collect()
    });
    Ok(HeldBack {
        fit: segment_fits(&experiment, &fitted),
        worst: worst.collect(),
        predictions,
        findings,
        converged: fitted.converged,
    })
}

/// Wheels and thrusters as found, none of them unknown any more.
fn prepared(
    problem: &Problem,
    vehicle: &CompletedVehicle,
) -> (poinsot_model::Model, Vec<crate::problem::segment::Segment>) {
    let mut model = problem.model.clone();
    for body in &mut model.bodies {
        body.estimate = poinsot_model::EstimateSet::default();
        body.prior = None;
    }
    for wheel in &mut model.wheels {
        wheel.estimate = false;
    }
    for thruster in &mut model.thrusters {
        thruster.scale = poinsot_model::Nuisance::Known;
    }
    for (k, spin) in &vehicle.spin_inertia {
        if let Some(wheel) = model.wheels.get_mut(*k) {
            wheel.spin_inertia = *spin;
        }
    }
    let mut segments = problem.segments.to_vec();
    for firing in segments.iter_mut().flat_map(|s| &mut s.firings) {
        let factor = vehicle
            .thrust_factor
            .iter()
            .find(|(k, _)| *k == firing.thruster);
        firing.force *= factor.map_or(1.0, |(_, factor)| *factor);
    }
    (model, segments)
}
