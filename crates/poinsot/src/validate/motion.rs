//! Motion of two vehicles under the same torques, wheels and thrust (Xu et al. 2017, sec. 5.5).

use super::Mover;
use super::compared::{Compared, Group};
use crate::case::{COMPARED, Case, Scenario};
use crate::channel_names::{joint_unit, names, position};
use crate::error::Error;
use crate::simulate::perfect_table;
use poinsot_files::Place;
use poinsot_model::{Model, SensorKind};
use poinsot_spatial::UnitQuaternion;
use poinsot_telemetry::Table;

/// The exact motion of a vehicle in a case: pose of the base in N, positions of the joints.
///
/// # Errors
/// The case does not fit the vehicle, has a controller, or the motion cannot be computed.
pub(super) fn path(case: &Case, mover: &Mover) -> Result<Table, Error> {
    let mut model = mover.model.clone();
    model.sensors.clear();
    perfect_table(case, &model, &mover.bodies, scenario(case, mover)?)
}

/// The scenario of a vehicle in a case, with its thruster forces.
pub(super) fn scenario(case: &Case, mover: &Mover) -> Result<Scenario, Error> {
    let mut scenario = case.bind(&mover.model)?;
    case.check_memory(&mover.model, case.times().count(), COMPARED)?;
    if scenario.plan.control.is_some() {
        let place = Place::file(case.path());
        let problem = "[control] would command different torques on the two vehicles";
        let advice = "prescribe wheel torques with [[wheel_motion]]";
        return Err(Error::one("E0702", place, problem, advice));
    }
    for firing in &mut scenario.plan.firings {
        let factor = mover.thrust_factor.get(firing.thruster);
        firing.force *= factor.copied().unwrap_or(1.0);
    }
    Ok(scenario)
}

/// Compares two vehicles in a case: base position, base attitude and every common joint over time.
///
/// # Errors
/// The case does not fit the vehicle, has a controller, or the motion cannot be computed.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// use poinsot::validate::{Mover, compare_motion};
///
/// // Twice the inertia turns half as far.
/// let mut heavy = model.clone();
/// heavy.bodies[0].nominal.I_BBcm_B *= 2.0;
/// let compared = compare_motion(&case, &Mover::of_model(model), &Mover::of_model(heavy))?;
/// assert!(compared[0].file.largest < 1.0e-12 && compared[1].file.largest > 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare_motion(case: &Case, model: &Mover, against: &Mover) -> Result<Vec<Compared>, Error> {
    let (own, theirs) = (path(case, model)?, path(case, against)?);
    Ok(compare_paths(&model.model, &own, &theirs))
}

/// Compares two paths at the same times.
pub(super) fn compare_paths(model: &Model, own: &Table, against: &Table) -> Vec<Compared> {
    let group = |name: String, unit, channels| Group {
        name,
        unit,
        channels,
        sensor: None,
        unnamed: true,
        attitude: UnitQuaternion::new_unchecked,
    };
    let mut groups = Vec::new();
    for (name, unit, kind) in [
        ("base position", "m", SensorKind::Position),
        ("base attitude", "rad", SensorKind::Attitude),
    ] {
        groups.push(group(name.to_owned(), unit, names(model, kind, &[])));
    }
    for joint in model.moving_joints() {
        let (name, channels) = (format!("joint {}", joint.name), vec![position(joint)]);
        groups.push(group(name, joint_unit(joint), channels));
    }
    let compared = groups
        .iter()
        .map(|group| group.compare(own, against, f64::INFINITY));
    compared.flatten().collect()
}
