//! Columns of known numbers by the variational equation against differences of whole evaluations.

use super::{MODEL, noise, segment};
use crate::fit::experiment::as_predicted::take_predictions;
use crate::fit::experiment::known_columns::{MovedVehicle, Shift};
use crate::fit::experiment::{Experiment, Iterate};
use crate::likelihood::{ChannelResidual, Evaluated, PredictionSlopes};
use crate::problem::Problem;
use crate::problem::parameters::{Equations, Parameters, Unknown, UnknownKind};
use crate::problem::segment::Segment;
use crate::problem::shifted_vehicle::ShiftedVehicle;
use nalgebra::{Matrix3, Vector3};
use poinsot_dynamics::Tree;
use poinsot_model::{
    EstimateSet, KnownNumber, Model, Nuisance, Origin, Propellant, SensorKind, parse_model,
};

/// Step of a difference, in the uncertainty of a drawing.
const STEP: f64 = 1.0e-3;

/// Slope of every whitened prediction between two evaluations of the same samples.
fn slope(here: &[Evaluated], there: &[Evaluated], step: f64) -> PredictionSlopes {
    let slope = |(a, b): (&Vector3<f64>, &Vector3<f64>)| (a - b) / step;
    let sensor = |(a, b): (&ChannelResidual, &ChannelResidual)| {
        a.white.iter().zip(&b.white).map(slope).collect()
    };
    let segment =
        |(a, b): (&Evaluated, &Evaluated)| a.channels.iter().zip(&b.channels).map(sensor).collect();
    here.iter().zip(there).map(segment).collect()
}

/// Samples that equal the predictions: with noisy inputs the whitening depends on the vehicle, and its change times a residual
/// is no derivative.
fn predicted(experiment: &Experiment, at: &Iterate) -> Vec<Segment> {
    let mut segments = experiment.problem.segments.to_vec();
    take_predictions(experiment, at, &mut segments).unwrap();
    segments
}

/// Slopes over known numbers by differences of whole evaluations.
fn by_difference(
    experiment: &Experiment,
    at: &Iterate,
    numbers: &[Shift],
) -> Vec<PredictionSlopes> {
    let segments = predicted(experiment, at);
    let there = Problem {
        segments: &segments,
        ..*experiment.problem
    };
    let own = experiment.of_vehicle(&there, experiment.parameters);
    let here = own.evaluate(at, false).unwrap();
    let beside = |shift: &Shift| {
        let model = experiment.problem.model;
        let vehicle = ShiftedVehicle::from(&there, model, experiment.parameters, &[*shift]);
        let vehicle = vehicle.unwrap();
        let beside = vehicle.problem(&there);
        let other = experiment.of_vehicle(&beside, &vehicle.parameters);
        slope(&here, &other.evaluate(at, false).unwrap(), shift.2)
    };
    numbers.iter().map(beside).collect()
}

fn flat(all: &[Vec<Vec<Vector3<f64>>>]) -> Vec<f64> {
    let numbers = all.iter().flatten().flatten();
    numbers.flat_map(|v| v.iter().copied()).collect()
}

/// Largest difference of two columns, and the size of the second.
fn gap(own: &[f64], other: &[f64]) -> (f64, f64) {
    assert_eq!(own.len(), other.len());
    let size = other.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    let pairs = own.iter().zip(other);
    (pairs.fold(0.0, |a: f64, (x, y)| a.max((x - y).abs())), size)
}

#[test]
fn exact_columns_of_known_numbers_are_differences_of_predictions() {
    let mut model = parse_model(MODEL, "test").unwrap();
    // The arm and the hand's mass centre are known, and so are the wheel and the thruster.
    model.bodies[1].estimate = EstimateSet::default();
    model.bodies[2].estimate.com = false;
    (model.wheels[0].estimate, model.wheels[0].misalignment) = (false, Nuisance::Known);
    model.thrusters[0].scale = Nuisance::Known;
    let tree = Tree::new(&model);
    for translation in [true, false] {
        let mut segments = [segment(&model, &tree, translation)];
        // A sensor that is taken as exact has no rows, and keeps its place before the others.
        segments[0].observations.sensors[0].covariance = Matrix3::zeros();
        let noise = noise(&tree);
        let problem = Problem {
            model: &model,
            tree: &tree,
            segments: &segments,
            noise: &noise,
            relative_accuracy: 1.0,
            pace: None,
        };
        let parameters = Parameters::new(&model, &tree, Equations::Momentum, true).unwrap();
        let experiment = Experiment::new(&problem, &parameters);
        let at = experiment.nominal_point();
        let moved = MovedVehicle::new(&experiment, &at).unwrap();
        let known = model.known_numbers().into_iter();
        let numbers: Vec<Shift> = known
            .filter(|n| n.is_known(&model))
            .flat_map(|n| (0..n.components()).map(move |c| (n, c)))
            .map(|(n, c)| {
                let sigma = n.absolute(&model, c, n.usual_sigma(Origin::Cad));
                (n, c, STEP * sigma)
            })
            .collect();
        let columns = moved.slopes(&experiment, &numbers).unwrap();
        let differences = by_difference(&experiment, &at, &numbers);
        let mut compared = 0;
        for ((shift, own), other) in numbers.iter().zip(&columns).zip(&differences) {
            assert_eq!(own[0].len(), segments[0].observations.sensors.len());
            assert!(own[0][0].is_empty() && !own[0][1].is_empty());
            let (gap, size) = gap(&flat(own), &flat(other));
            let name = shift.0.name(&model, shift.1);
            // The bend over a step and its round-off.
            let floor = 1.0e-9 / shift.2;
            assert!(
                gap < 1.0e-4 * size + floor,
                "{name} (translation {translation}): {gap:.3e} of {size:.3e}"
            );
            compared += usize::from(size > 1.0e3 * floor);
        }
        // A mass, mass centre and inertia at the least, a rotor and a thrust move the predictions.
        assert!(compared > numbers.len() / 2, "{compared}");
    }
}

/// Another force of one firing, play of a joint, and another use of propellant.
#[test]
fn exact_columns_of_firings_play_and_propellant_are_differences_of_predictions() {
    let mut model = parse_model(MODEL, "test").unwrap();
    // Where the link changes sides its acceleration is that of the curve of the samples.
    let point = [SensorKind::Accelerometer, SensorKind::VelocityIncrement];
    model.sensors.retain(|s| !point.contains(&s.kind));
    let tree = Tree::new(&model);
    let mut segment = segment(&model, &tree, true);
    let kinds = |kind: &SensorKind| !point.contains(kind);
    segment.observations.sensors.retain(|s| kinds(&s.kind));
    let (segments, noise) = ([segment.clone(), segment], noise(&tree));
    let problem = Problem {
        model: &model,
        tree: &tree,
        segments: &segments,
        noise: &noise,
        relative_accuracy: 1.0,
        pace: None,
    };
    let parameters = Parameters::new(&model, &tree, Equations::Momentum, true).unwrap();
    let experiment = Experiment::new(&problem, &parameters);
    let at = experiment.nominal_point();
    let firing = |k: usize| UnknownKind::Firing {
        segment: 1,
        firing: k,
        thruster: segments[1].firings[k].thruster,
    };
    let firings = (0..segments[1].firings.len()).map(firing);
    let play = (0..tree.dof()).map(UnknownKind::JointPlay);
    let propellant = model.thrusters[0].propellant.unwrap();
    let used = [None, Some(0), Some(1), Some(2)].map(|axis| UnknownKind::PropellantUse {
        body: model.thrusters[0].body,
        thruster: None,
        p_BoF_B: propellant.p_BoF_B,
        axis,
    });
    let kinds: Vec<UnknownKind> = firings.chain(play).chain(used).collect();
    let mut wide = parameters.clone();
    let mut there = at.clone();
    for kind in &kinds {
        there.x.push(0.0);
        wide.unknowns.push(Unknown {
            kind: kind.clone(),
            name: String::new(),
            unit: "",
            nominal: 0.0,
            natural: 1.0,
        });
    }
    let mut extended = experiment.with_parameters(&wide);
    extended.keep_rows = true;
    let evaluated = extended.evaluate(&there, true).unwrap();
    let samples = predicted(&experiment, &at);
    let step = 1.0e-6;
    let residuals = |model: &Model, segments: &[Segment]| {
        let problem = Problem {
            model,
            segments,
            ..problem
        };
        experiment
            .of_vehicle(&problem, &parameters)
            .evaluate(&at, false)
            .unwrap()
    };
    let here = residuals(&model, &samples);
    for (k, kind) in kinds.iter().enumerate() {
        let (mut changed, mut other_model) = (samples.clone(), model.clone());
        match kind {
            UnknownKind::PropellantUse { axis, .. } => {
                let of_jet = other_model.thrusters[0].propellant.as_mut().unwrap();
                let use_of = |p: &Propellant| p.flow().used;
                let used = use_of(of_jet);
                match axis {
                    None => of_jet.specific_impulse *= used / (used + step),
                    Some(k) => of_jet.p_BoF_B[*k] += step / used,
                }
            }
            UnknownKind::Firing { firing, .. } => changed[1].firings[*firing].force *= 1.0 + step,
            UnknownKind::JointPlay(joint) => {
                for o in changed.iter_mut().map(|s| &mut s.observations) {
                    let mut side = 0.0;
                    let rates = o.joint_rate.chunks_exact(tree.dof());
                    for (rates, q) in rates.zip(o.joint_position.chunks_exact_mut(tree.dof())) {
                        if rates[*joint] != 0.0 {
                            side = rates[*joint].signum();
                        }
                        q[*joint] -= 0.5 * step * side;
                    }
                }
            }
            _ => unreachable!(),
        }
        let other = flat(&slope(&here, &residuals(&other_model, &changed), step));
        let mut own = Vec::new();
        for (one, start) in evaluated.iter().zip(&extended.unknown) {
            let place = start.count() + parameters.len() + k;
            for channel in &one.channels {
                let rows = one.kept.of(Some(channel.sensor));
                own.extend(
                    rows.flat_map(|row| row.rows.iter().map(|r| r[place]).collect::<Vec<_>>()),
                );
            }
        }
        let (gap, size) = gap(&own, &other);
        assert!(
            size > 1.0e-3 && gap < 1.0e-4 * size,
            "{kind:?}: {gap:.3e} of {size:.3e}"
        );
    }
}

/// A record replaced by its predictions has the columns of the measured one: known numbers are compared with the other unknowns.
#[test]
fn exact_predicted_samples_have_the_columns_of_measured_ones() {
    let model = parse_model(MODEL, "test").unwrap();
    let tree = Tree::new(&model);
    let segments = [segment(&model, &tree, true)];
    let noise = noise(&tree);
    let problem = Problem {
        model: &model,
        tree: &tree,
        segments: &segments,
        noise: &noise,
        relative_accuracy: 1.0,
        pace: None,
    };
    let parameters = Parameters::new(&model, &tree, Equations::Momentum, true).unwrap();
    let mut experiment = Experiment::new(&problem, &parameters);
    experiment.keep_rows = true;
    let at = experiment.nominal_point();
    let segments = predicted(&experiment, &at);
    let there = Problem {
        segments: &segments,
        ..problem
    };
    let other = experiment.of_vehicle(&there, &parameters);
    let [own, other] = [&experiment, &other].map(|e| e.evaluate(&at, true).unwrap());
    let rows = own[0].kept.rows.iter().zip(&other[0].kept.rows);
    let mut compared = 0;
    for (a, b) in rows.filter(|(a, _)| a.sensor.is_some()) {
        for (a, b) in a.rows.iter().zip(&b.rows) {
            // The last one is the residual.
            for (x, y) in a.iter().zip(b).take(a.len() - 1) {
                assert!((x - y).abs() < 1.0e-9 * (1.0 + x.abs()), "{x} {y}");
                compared += usize::from(*x != 0.0);
            }
        }
    }
    assert!(compared > 100);
}

/// Where nothing is known of translation, no column of a mass or a mass centre is left: the slope of a parallel-axis part is
/// exact, not one of a step.
#[test]
fn regress_a_mass_centre_that_no_sample_shows_has_no_column() {
    let mut model = parse_model(MODEL, "test").unwrap();
    model.bodies.truncate(1);
    (model.joints, model.thrusters, model.sensors) = (Vec::new(), Vec::new(), Vec::new());
    (model.wheels[0].body, model.environment) = (0, Default::default());
    (model.wheels[0].estimate, model.wheels[0].misalignment) = (false, Nuisance::Known);
    model.bodies[0].estimate = EstimateSet {
        inertia: true,
        ..EstimateSet::default()
    };
    let tree = Tree::new(&model);
    let mut segment = segment(&model, &tree, false);
    segment.firings.clear();
    segment.observations.orbit.clear();
    let kinds = [SensorKind::Gyro, SensorKind::Attitude];
    segment
        .observations
        .sensors
        .retain(|s| kinds.contains(&s.kind));
    let (segments, noise) = ([segment], noise(&tree));
    let problem = Problem {
        model: &model,
        tree: &tree,
        segments: &segments,
        noise: &noise,
        relative_accuracy: 1.0,
        pace: None,
    };
    let parameters = Parameters::new(&model, &tree, Equations::Momentum, false).unwrap();
    let experiment = Experiment::new(&problem, &parameters);
    let moved = MovedVehicle::new(&experiment, &experiment.nominal_point()).unwrap();
    for number in [
        KnownNumber::Mass(0),
        KnownNumber::MassCentre(0),
        KnownNumber::SpinInertia(0),
    ] {
        let sigma = number.absolute(&model, 0, number.usual_sigma(Origin::Cad));
        let columns = moved
            .slopes(&experiment, &[(number, 0, STEP * sigma)])
            .unwrap();
        let all = columns.iter().flatten().flatten().flatten();
        let length = all.map(|v| v.norm_squared()).sum::<f64>().sqrt() * sigma;
        let moves = number == KnownNumber::SpinInertia(0);
        assert!((length > 1.0e-6) == moves, "{number:?}: {length:.1e}");
    }
}

/// Across an axis of the vehicle two directions are as good as each other: a small turn must not exchange them.
#[test]
fn regress_tilts_of_a_turned_wheel_stay_about_the_nominal_directions() {
    let mut model = parse_model(MODEL, "test").unwrap();
    model.wheels[0].axis_B = Vector3::x();
    let tree = Tree::new(&model);
    let parameters = Parameters::new(&model, &tree, Equations::Momentum, true).unwrap();
    let mut turned = model.clone();
    turned.wheels[0].axis_B = Vector3::new(1.0, 3.0e-4, 1.0e-4).normalize();
    let there = parameters.of_vehicle(&turned, &tree).unwrap();
    assert_eq!(there.wheel_axes[0].0, turned.wheels[0].axis_B);
    assert_eq!(there.wheel_axes[0].1, parameters.wheel_axes[0].1);
}
