//! The document `truth.json`: what an identification of the telemetry should find.

use super::record::Recorder;
use super::{every, stream};
use crate::case::{Case, Scenario, unit_suffix};
use poinsot_dynamics::{MotionSample, composite};
use poinsot_identify::ErrorGroup;
use poinsot_model::{JointKind, Model};
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, UnitQuaternion, Vector3};
use serde_json::{Map, Value, json};

/// The name of the format.
const TRUTH_SCHEMA: &str = "poinsot.truth/1";

pub(super) fn document(
    case: &Case,
    model: &Model,
    scenario: &Scenario,
    first: Option<&MotionSample>,
    recorder: &Recorder,
    trial: u64,
) -> Value {
    let bodies: Map<String, Value> = model
        .bodies
        .iter()
        .map(|b| (b.name.clone(), body(&b.nominal)))
        .collect();
    let wheels: Map<String, Value> = model
        .wheels
        .iter()
        .map(|w| {
            (
                w.name.clone(),
                json!({ "spin_inertia_kg_m2": { "value": w.spin_inertia } }),
            )
        })
        .collect();
    let noise: Map<String, Value> = (0..model.sensors.len())
        .map(|i| {
            let key = format!("{}.{}", model.sensors[i].kind.word(), model.sensors[i].name);
            (key, noise(case, model, scenario, recorder, trial, i))
        })
        .collect();
    json!({
        "schema": TRUTH_SCHEMA,
        "poinsot": env!("CARGO_PKG_VERSION"),
        "model": model.name,
        "duration_s": case.duration_s,
        "rate_hz": case.rate_hz,
        "seed": case.seed,
        "trial": trial,
        "initial": first.map(|s| initial(model, s)),
        "bodies": bodies,
        "wheels": wheels,
        "system": first.map(|s| vec![system(model, s)]),
        "momentum": first.map(|s| vec![json!({
            "linear_N_s": { "value": array(&s.l_S_N) },
            "angular_N_m_s": { "value": array(&s.h_SScm_N) },
        })]),
        "noise": noise,
    })
}

fn array(v: &Vector3) -> [f64; 3] {
    [v.x, v.y, v.z]
}

fn tensor(i: &Matrix3) -> Value {
    json!({
        "xx": i[(0, 0)], "yy": i[(1, 1)], "zz": i[(2, 2)],
        "xy": i[(0, 1)], "xz": i[(0, 2)], "yz": i[(1, 2)],
    })
}

/// One body in the layout of `bodies` of an estimate, values only.
fn body(properties: &MassProperties) -> Value {
    let (moments, axes) = properties.principal();
    let axes = nalgebra::Rotation3::from_matrix_unchecked(axes);
    let q = UnitQuaternion::from_rotation_matrix(&axes).coords;
    let InertialParameters {
        mass,
        mc_B,
        I_BBo_B,
    } = properties.parameters();
    json!({
        "mass_kg": { "value": properties.mass },
        "com_m": { "value": array(&properties.p_BoBcm_B) },
        "inertia_kg_m2": { "value": tensor(&properties.I_BBcm_B) },
        "principal": { "moments_kg_m2": moments, "axes_xyzw": [q.x, q.y, q.z, q.w] },
        "barycentric": {
            "m_kg": { "value": mass },
            "mc_kg_m": { "value": array(&mc_B) },
            "I_BBo_kg_m2": { "value": tensor(&I_BBo_B) },
        },
        "physically_consistent": properties.check_physical(1e-9).is_ok(),
    })
}

/// Pose and motion of the base and the joints at time zero.
fn initial(model: &Model, s: &MotionSample) -> Value {
    let q = s.R_NB.coords;
    let moving = model.joints.iter().filter(|j| j.kind != JointKind::Fixed);
    let joints: Map<String, Value> = moving
        .zip(s.q.iter().zip(&s.rates))
        .map(|(joint, (q, rate))| {
            let numbers = match joint.kind {
                JointKind::Prismatic => json!({ "position_m": q, "rate_m_s": rate }),
                _ => json!({ "position_rad": q, "rate_rad_s": rate }),
            };
            (joint.name.clone(), numbers)
        })
        .collect();
    json!({
        "q_xyzw": [q.x, q.y, q.z, q.w],
        "omega_rad_s": array(&s.w_NB_B),
        "r_m": array(&s.p_NoBo_N),
        "v_m_s": array(&s.v_NBo_N),
        "joints": joints,
    })
}

/// The whole as one body at the first sample, about the base's origin and in its axes.
fn system(model: &Model, s: &MotionSample) -> Value {
    let parameters: Vec<_> = model
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();
    let whole = composite(&parameters, &s.kinematics);
    let moving = model.joints.iter().filter(|j| j.kind != JointKind::Fixed);
    let joints: Map<String, Value> = moving
        .zip(&s.q)
        .map(|(joint, q)| {
            let unit = match joint.kind {
                JointKind::Prismatic => "m",
                _ => "rad",
            };
            (format!("{}_{unit}", joint.name), json!(q))
        })
        .collect();
    json!({
        "mass_kg": { "value": whole.mass },
        "com_m": { "value": array(&whole.p_BoScm_B()) },
        "inertia_kg_m2": { "value": tensor(&whole.I_SScm_B()) },
        "joints": joints,
    })
}

/// The errors that one sensor had.
fn noise(
    case: &Case,
    model: &Model,
    scenario: &Scenario,
    recorder: &Recorder,
    trial: u64,
    i: usize,
) -> Value {
    let sensor = &model.sensors[i];
    let unit = unit_suffix(model, sensor);
    let mut out = Map::new();
    let bias = recorder.bias(i);
    out.insert("name".into(), json!(sensor.name));
    out.insert("type".into(), json!(sensor.kind.word()));
    out.insert("stream".into(), json!(stream(trial, i)));
    out.insert(
        "rate_hz".into(),
        json!(case.rate_hz / every(scenario, i) as f64),
    );
    out.insert(format!("bias_{unit}"), json!(bias));
    for group in ErrorGroup::of(sensor.kind)
        .iter()
        .filter(|g| g.key != "bias")
    {
        let errors = group.errors.iter();
        let values: Vec<f64> = errors.map(|e| recorder.error(i, e.0)).collect();
        // As in the case that gave it.
        let key = match group.unit(sensor.kind) {
            "1" => group.key.to_owned(),
            unit => format!("{}_{unit}", group.key),
        };
        match values.as_slice() {
            values if values.iter().all(|x| *x == 0.0) => {}
            [one] => drop(out.insert(key, json!(one))),
            all => drop(out.insert(key, json!(all))),
        }
    }
    let covariance = sensor.noise_covariance.map(|c| {
        if sensor.kind.is_scalar() {
            return json!(c[(0, 0)]);
        }
        json!([0, 1, 2].map(|r| [0, 1, 2].map(|k| c[(r, k)])))
    });
    out.insert(format!("covariance_{unit}_squared"), json!(covariance));
    out.insert(format!("quantisation_{unit}"), json!(sensor.quantisation));
    Value::Object(out)
}
