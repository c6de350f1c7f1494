//! Sensitivities of the predictions to known numbers.
//!
//! One evaluation with sensitivities gives the columns of all of them.

use super::{Experiment, Iterate};
use crate::likelihood::{Evaluated, InitialStateColumns, KeptRow, KnownColumns, PredictionSlopes};
use crate::problem::Problem;
use crate::problem::loss::Loss;
use crate::problem::parameters::{Parameters, Unknown, UnknownKind};
use crate::problem::segment::Segment;
use crate::problem::shifted_vehicle::{ShiftedVehicle, shifts};
use poinsot_dynamics::SensorError;
use poinsot_model::{KnownNumber, Model};
use poinsot_spatial::{InertialParameters, Vector3};

/// Step of the difference of what a number moves in the vehicle, sigmas of the number: what it moves is nearly linear in it.
pub(crate) const DIFFERENCE: f64 = 1.0e-5;
/// Sigmas by which a known number may move from where its columns were made to where a fit ends. Columns 10^4 times the noise may
/// cancel in a combination that the data do not show; what their age leaves of it must be small beside a prior.
const FRESH: f64 = 1.0e-4;

/// Whether columns of the known numbers at one point are those at another one.
pub(crate) fn known_columns_last(experiment: &Experiment, from: &Iterate, to: &Iterate) -> bool {
    let unknowns = &experiment.parameters.unknowns;
    let stays = |p: &usize| (to.x[*p] - from.x[*p]).abs() < FRESH * unknowns[*p].natural;
    experiment.parameters.known_places().iter().all(stays)
}

/// Slopes of all whitened predictions over the known numbers among the unknowns, at a value of all of them: those of an
/// unknown that moves the predictions alike.
pub(crate) fn slopes(experiment: &Experiment, at: &Iterate) -> Option<KnownColumns> {
    let moved = MovedVehicle::new(experiment, at)?;
    let unknowns = &experiment.parameters.unknowns;
    let known = unknowns.iter().filter_map(|u| u.kind.known());
    let numbers: Vec<Shift> = known
        .map(|k| (k.number, k.component, DIFFERENCE * k.sigma))
        .collect();
    let names = |segment: &Segment| {
        let sensors = segment.observations.sensors.iter();
        sensors.map(|r| r.name.clone()).collect()
    };
    Some(KnownColumns {
        sensors: experiment.problem.segments.iter().map(names).collect(),
        slopes: moved.slopes(experiment, &numbers)?,
    })
}

/// A component of a known number with a step for the difference of what it moves in the vehicle.
pub(crate) type Shift = (KnownNumber, usize, f64);

/// The vehicle where a value of all unknowns has its known numbers, with the other unknowns.
pub(crate) struct MovedVehicle {
    /// Its problem, and its unknowns: those of the fit without the known numbers.
    pub vehicle: ShiftedVehicle,
    /// The other unknowns.
    pub base: Iterate,
}

impl MovedVehicle {
    pub fn new(experiment: &Experiment, at: &Iterate) -> Option<Self> {
        let (own, kept) = experiment.parameters.without_known();
        let (problem, moved) = (experiment.problem, shifts(experiment.parameters, &at.x));
        Some(Self {
            vehicle: ShiftedVehicle::from(problem, problem.model, &own, &moved)?,
            base: Iterate {
                x: kept.iter().map(|k| at.x[*k]).collect(),
                initial_states: at.initial_states.clone(),
            },
        })
    }

    /// Slopes over components of known numbers: one evaluation with its sensitivities.
    pub fn slopes(
        &self,
        experiment: &Experiment,
        numbers: &[Shift],
    ) -> Option<Vec<PredictionSlopes>> {
        let there = self.vehicle.problem(experiment.problem);
        let nominal = experiment.problem.model;
        let own = &self.vehicle.parameters;
        let twin = |shift: &Shift| twin((&there, nominal), own, &self.base.x, *shift);
        let twins: Vec<Option<(Unknown, f64)>> = numbers.iter().map(twin).collect();
        let mut parameters = own.clone();
        let mut column = parameters.len();
        let mut at = self.base.clone();
        for (unknown, _) in twins.iter().flatten() {
            at.x.push(unknown.nominal);
            parameters.unknowns.push(unknown.clone());
        }
        let mut wide = experiment.of_vehicle(&there, &parameters);
        (wide.keep_rows, wide.settings.loss) = (true, Loss::Gaussian);
        let evaluated = wide.evaluate(&at, true)?;
        let slopes = |twin: &Option<(Unknown, f64)>| {
            let Some((_, factor)) = twin else {
                return Vec::new();
            };
            // By record, also of a sensor that is taken as exact and has no rows.
            let of = |((one, start), segment): ((&Evaluated, &InitialStateColumns), &Segment)| {
                let place = start.count() + column;
                let slope =
                    |row: &KeptRow| Vector3::from_fn(|axis, _| row.rows[axis][place] * factor);
                (0..segment.observations.sensors.len())
                    .map(|sensor| one.kept.of(Some(sensor)).map(slope).collect())
                    .collect()
            };
            let segments = evaluated.iter().zip(&wide.unknown).zip(there.segments);
            let segments = segments.map(of).collect();
            column += 1;
            segments
        };
        Some(twins.iter().map(slopes).collect())
    }
}

/// The unknown that moves the predictions of a vehicle as a known number does, and by how much more. Turns are about
/// directions of the `nominal` vehicle. `None` for a number that cannot be moved.
pub(crate) fn twin(
    (problem, nominal): (&Problem, &Model),
    parameters: &Parameters,
    x: &[f64],
    shift: Shift,
) -> Option<(Unknown, f64)> {
    let (number, component, step) = shift;
    if step == 0.0 {
        return None;
    }
    let (mut at, mut factor) = (0.0, 1.0);
    let kind = match number {
        KnownNumber::Mass(_) | KnownNumber::MassCentre(_) | KnownNumber::Inertia(_) => {
            UnknownKind::Barycentric(body_slopes((problem, nominal), parameters, x, shift)?)
        }
        KnownNumber::SpinInertia(k) => {
            at = problem.model.wheels.get(k)?.spin_inertia;
            UnknownKind::SpinInertia(k)
        }
        KnownNumber::WheelAxis(k) => UnknownKind::WheelTilt(k, component),
        KnownNumber::Force(k) => UnknownKind::ThrusterScale(k),
        KnownNumber::ForceDirection(k) | KnownNumber::ForcePosition(k) => {
            let [direction_B, p_BoT_B] = place_slopes((problem.model, nominal), shift, |model| {
                let t = model.thrusters.get(k)?;
                Some([t.direction_B, t.p_BoT_B])
            })?;
            UnknownKind::ThrusterPlace {
                thruster: k,
                direction_B,
                p_BoT_B,
            }
        }
        KnownNumber::JointOrigin(k) | KnownNumber::JointAxis(k) => {
            let [p_PoCo_P, axis_C] = place_slopes((problem.model, nominal), shift, |model| {
                let j = model.joints.get(k)?;
                Some([j.p_PoCo_P, j.axis_C])
            })?;
            UnknownKind::JointPlace {
                link: problem.model.joints.get(k)?.child,
                p_PoCo_P,
                axis_C,
            }
        }
        KnownNumber::SpecificImpulse(k) | KnownNumber::PropellantPlace(k) => {
            let thruster = problem.model.thrusters.get(k)?;
            let propellant = thruster.propellant?;
            let used = propellant.flow().used;
            let place = matches!(number, KnownNumber::PropellantPlace(_));
            // What is used is the inverse of the specific impulse.
            factor = match place {
                true => used,
                false => -used / propellant.specific_impulse,
            };
            UnknownKind::PropellantUse {
                body: thruster.body,
                thruster: Some(k),
                p_BoF_B: propellant.p_BoF_B,
                axis: place.then_some(component),
            }
        }
        KnownNumber::Mounting(sensor) => {
            let attitude = problem.model.sensors.get(sensor)?.kind.is_rotation();
            let error = match attitude {
                true => SensorError::Bias(component),
                false => SensorError::Misalignment(component),
            };
            // A sensor whose axes are turned measures a vector turned back.
            factor = if attitude { 1.0 } else { -1.0 };
            UnknownKind::Sensor { sensor, error }
        }
    };
    let name = number.name(nominal, component);
    let unknown = Unknown::new(kind, (name, number.unit()), (at, 1.0));
    Some((unknown, factor))
}

/// How a known number moves a position and a direction of a part. Turns are about directions of the `nominal` vehicle.
fn place_slopes(
    (model, nominal): (&Model, &Model),
    (number, component, step): Shift,
    place: impl Fn(&Model) -> Option<[Vector3; 2]>,
) -> Option<[Vector3; 2]> {
    let moved = |change: f64| {
        let mut there = model.clone();
        number.shift(nominal, &mut there, component, change);
        place(&there)
    };
    let (behind, ahead) = (moved(-step)?, moved(step)?);
    Some([0, 1].map(|k| (ahead[k] - behind[k]) / (2.0 * step)))
}

/// Slopes of the barycentric parameters over a known number, at a value of the unknowns: index `10 body + k` and slope. Turns
/// are about directions of the `nominal` vehicle. `None` where the number cannot be moved.
pub(crate) fn body_slopes(
    (problem, nominal): (&Problem, &Model),
    parameters: &Parameters,
    x: &[f64],
    shift: Shift,
) -> Option<Vec<(usize, f64)>> {
    // Both ways: the parallel-axis part is quadratic in the mass centre.
    if let Some((body, [here, there])) = of_known_body(problem.model, shift) {
        return Some(difference(body, &here, &there, shift.2));
    }
    let bodies = |step: f64| {
        let shift = (shift.0, shift.1, step);
        let end = ShiftedVehicle::from(problem, nominal, parameters, &[shift])?;
        Some(end.parameters.bodies(x))
    };
    let (there, here) = (bodies(shift.2)?, bodies(-shift.2)?);
    let pairs = here.iter().zip(&there).enumerate();
    let of = |(body, (a, b))| difference(body, a, b, shift.2);
    Some(pairs.flat_map(of).collect())
}

/// A body of which nothing is unknown, with its parameters before and behind a change of one of its numbers: no other body changes
/// with it, so that the vehicle need not be made anew.
fn of_known_body(
    model: &Model,
    (number, component, step): Shift,
) -> Option<(usize, [InertialParameters; 2])> {
    let (KnownNumber::Mass(k) | KnownNumber::MassCentre(k) | KnownNumber::Inertia(k)) = number
    else {
        return None;
    };
    let body = model.bodies.get(k).filter(|b| !b.estimate.any())?;
    let moved = |change: f64| {
        let mut there = body.nominal;
        number.shift_body(&mut there, component, change);
        there.parameters()
    };
    Some((k, [moved(-step), moved(step)]))
}

/// Slopes of the ten parameters of a body between two that are twice a step apart; those that do not change are left out.
fn difference(
    body: usize,
    here: &InertialParameters,
    there: &InertialParameters,
    step: f64,
) -> Vec<(usize, f64)> {
    let pairs = here.to_array().into_iter().zip(there.to_array());
    let moved = pairs.enumerate().filter(|(_, (a, b))| a != b);
    moved
        .map(|(k, (a, b))| (10 * body + k, (b - a) / (2.0 * step)))
        .collect()
}
