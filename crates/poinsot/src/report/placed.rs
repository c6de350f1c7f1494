//! The vehicle of a model as it is drawn, with the joints where the kinematics place them.

use poinsot_dynamics::Kinematics;
use poinsot_formats::{DrawnBody, DrawnJoint, DrawnSensor, Pointer, Vehicle};
use poinsot_model::Model;
use poinsot_spatial::{MassProperties, TENSOR, Vector3};

/// With the nominal numbers of every body.
pub(super) fn nominal(model: &Model, kinematics: &Kinematics) -> Vehicle {
    let bodies = model.bodies.iter();
    let bodies = bodies.map(|body| (body.nominal, body.estimate.any()));
    placed(model, kinematics, bodies)
}

/// With these mass properties of its bodies, estimated or not.
pub(super) fn placed(
    model: &Model,
    kinematics: &Kinematics,
    bodies: impl Iterator<Item = (MassProperties, bool)>,
) -> Vehicle {
    let drawn = |(at, (own, estimated)): (usize, (MassProperties, bool))| DrawnBody {
        name: model.bodies[at].name.clone(),
        origin_m: kinematics.p[at].into(),
        rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|j| kinematics.R[at][(i, j)])),
        mass_kg: own.mass,
        com_m: own.p_BoBcm_B.into(),
        inertia_kg_m2: TENSOR.map(|at| own.I_BBcm_B[at]),
        estimated,
    };
    let name = |body: usize| {
        let found = model.bodies.get(body).map(|b| b.name.clone());
        found.unwrap_or_default()
    };
    let at = |body: usize, p: &Vector3| (kinematics.p[body] + kinematics.R[body] * p).into();
    let turned = |body: usize, a: &Vector3| (kinematics.R[body] * a).into();
    let pointer = |name_of: &str, body: usize, p: &Vector3, along: &Vector3| Pointer {
        name: name_of.to_owned(),
        body: name(body),
        at_m: at(body, p),
        direction: turned(body, along),
    };
    let joints = model.joints.iter().map(|j| DrawnJoint {
        name: j.name.clone(),
        kind: j.kind.word().to_owned(),
        parent: name(j.parent),
        child: name(j.child),
        origin_m: kinematics.p[j.child].into(),
        axis: turned(j.child, &j.axis_C),
    });
    let wheels = model.wheels.iter();
    let wheels = wheels.map(|w| pointer(&w.name, w.body, &Vector3::zeros(), &w.axis_B));
    let thrusters = model.thrusters.iter();
    let thrusters = thrusters.map(|t| pointer(&t.name, t.body, &t.p_BoT_B, &t.direction_B));
    let sensors = model.sensors.iter().map(|s| DrawnSensor {
        name: s.name.clone(),
        kind: s.kind.word().to_owned(),
        body: name(s.body),
        at_m: (!s.kind.is_scalar()).then(|| at(s.body, &s.p_BoS_B)),
        sigma: s.covariance().map(|c| c[(0, 0)].sqrt()),
        quantisation: s.quantisation,
    });
    Vehicle {
        bodies: bodies.enumerate().map(drawn).collect(),
        joints: joints.collect(),
        wheels: wheels.collect(),
        thrusters: thrusters.collect(),
        sensors: sensors.collect(),
    }
}
