//! The vehicle with its known numbers at other values.

use crate::problem::Problem;
use crate::problem::parameters::Parameters;
use crate::problem::segment::{Segment, SensorValue};
use poinsot_dynamics::Tree;
use poinsot_model::{KnownNumber, Model};
use poinsot_spatial::{UnitQuaternion, Vector3};

/// The vehicle with its known numbers at other values than those of the model.
pub(crate) struct ShiftedVehicle {
    model: Model,
    tree: Tree,
    segments: Option<Vec<Segment>>,
    /// The same unknowns, of that vehicle.
    pub parameters: Parameters,
}

impl ShiftedVehicle {
    /// `changes` are added to the numbers of the problem; `None` without a valid vehicle. Its numbers may have moved already: turns are
    /// about directions of the `nominal` one.
    pub fn from(
        problem: &Problem,
        nominal: &Model,
        parameters: &Parameters,
        changes: &[(KnownNumber, usize, f64)],
    ) -> Option<Self> {
        let mut model = problem.model.clone();
        let mut segments = None;
        for (number, component, change) in changes.iter().filter(|c| c.2 != 0.0) {
            number.shift(nominal, &mut model, *component, *change);
            let acts_on_readings =
                matches!(number, KnownNumber::Force(_) | KnownNumber::Mounting(_));
            if acts_on_readings {
                let segments = segments.get_or_insert_with(|| problem.segments.to_vec());
                reread(segments, *number, *component, *change);
            }
        }
        let tree = Tree::new(&model);
        let parameters = parameters.of_vehicle(&model, &tree)?;
        Some(Self {
            model,
            tree,
            segments,
            parameters,
        })
    }

    /// The known numbers where a value of all unknowns has them.
    pub fn at(problem: &Problem, parameters: &Parameters, x: &[f64]) -> Option<Self> {
        Self::from(problem, problem.model, parameters, &shifts(parameters, x))
    }

    /// The problem of that vehicle.
    pub fn problem<'a>(&'a self, problem: &Problem<'a>) -> Problem<'a> {
        Problem {
            model: &self.model,
            tree: &self.tree,
            segments: self.segments.as_deref().unwrap_or(problem.segments),
            ..*problem
        }
    }
}

/// How far a value of all unknowns moves each component of a known number.
pub(crate) fn shifts(parameters: &Parameters, x: &[f64]) -> Vec<(KnownNumber, usize, f64)> {
    let unknowns = parameters.unknowns.iter().zip(x);
    let moved = unknowns.filter_map(|(u, x)| {
        let known = u.kind.known()?;
        Some((known.number, known.component, x - u.nominal))
    });
    moved.collect()
}

/// Samples with another thrust factor or sensor mounting.
fn reread(segments: &mut [Segment], number: KnownNumber, component: usize, change: f64) {
    for segment in segments {
        match number {
            KnownNumber::Force(thruster) => {
                let firings = segment.firings.iter_mut();
                for f in firings.filter(|f| f.thruster == thruster) {
                    f.force *= 1.0 + change;
                }
            }
            KnownNumber::Mounting(sensor) => {
                let turn = UnitQuaternion::from_scaled_axis(Vector3::ith(component % 3, change));
                let records = segment.observations.sensors.iter_mut();
                for record in records.filter(|r| r.sensor == Some(sensor)) {
                    let attitude = record.kind.is_rotation();
                    for sample in &mut record.samples {
                        sample.value = match sample.value {
                            SensorValue::Attitude(R) if attitude => {
                                SensorValue::Attitude(R * turn.inverse())
                            }
                            SensorValue::Vector(v) if !attitude => SensorValue::Vector(turn * v),
                            SensorValue::Direction {
                                seen_B,
                                reference_N,
                                normal_B,
                            } => SensorValue::Direction {
                                seen_B: turn * seen_B,
                                reference_N,
                                normal_B,
                            },
                            other => other,
                        };
                    }
                }
            }
            _ => {}
        }
    }
}
