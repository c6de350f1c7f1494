//! Models of recorded trees and of the true vehicles of recorded runs; recorded telemetry.
#![allow(dead_code)]

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use poinsot_dynamics::MotionSample;
use poinsot_model::*;
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
use poinsot_testkit::momentum_sum::{KitBody, KitJoint, KitState, KitWheel};
use serde_json::Value;
use std::collections::HashMap;
use std::path::Path;

/// A vehicle without sensors, from test kit bodies.
pub fn model(bodies: &[KitBody], wheels: &[KitWheel]) -> Model {
    let mut model = Model {
        name: "test".into(),
        bodies: Vec::new(),
        joints: Vec::new(),
        wheels: Vec::new(),
        modes: Vec::new(),
        thrusters: Vec::new(),
        sensors: Vec::new(),
        momentum: Momentum::default(),
        environment: Environment::default(),
        telemetry: TelemetryMap::default(),
        knowledge: poinsot_model::Knowledge::default(),
        notes: Vec::new(),
    };
    for (i, body) in bodies.iter().enumerate() {
        let kind = match body.joint {
            KitJoint::Base => None,
            KitJoint::Revolute => Some(JointKind::Revolute),
            KitJoint::Prismatic => Some(JointKind::Prismatic),
            KitJoint::Fixed => Some(JointKind::Fixed),
        };
        model.bodies.push(Body {
            name: format!("body{i}"),
            nominal: MassProperties {
                mass: body.mass,
                p_BoBcm_B: body.p_CoCcm_C,
                I_BBcm_B: body.I_CCcm_C,
            },
            given: None,
            estimate: EstimateSet::default(),
            prior: None,
            joint: kind.map(|_| model.joints.len()),
        });
        if let Some(kind) = kind {
            model.joints.push(Joint {
                name: format!("joint{i}"),
                kind,
                parent: body.parent,
                child: i,
                p_PoCo_P: body.p_PoCo_P,
                R_PC_zero: body.R_PC_zero,
                axis_C: body.axis_C,
                locked_at: None,
                spring_damper: None,
                spring_unknown: Vec::new(),
            });
        }
    }
    for (i, wheel) in wheels.iter().enumerate() {
        model.wheels.push(Wheel {
            name: format!("wheel{i}"),
            body: wheel.host,
            axis_B: wheel.axis_C,
            spin_inertia: wheel.spin_inertia,
            at_rest: false,
            estimate: false,
            misalignment: Nuisance::Known,
        });
    }
    model
}

/// State for the test kit's momentum sums.
pub fn state(sample: &MotionSample) -> KitState {
    let R_NB = sample.R_NB.to_rotation_matrix().into_inner();
    KitState {
        R_NB,
        p_NBo_N: sample.p_NoBo_N,
        v_NBo_B: R_NB.transpose() * sample.v_NBo_N,
        w_NB_B: sample.w_NB_B,
        q: sample.q.clone(),
        qd: sample.rates.clone(),
        wheel_speeds: sample.wheel_speed.clone(),
    }
}

pub fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap()],
    }
}

pub fn vector(value: &Value) -> Vector3 {
    Vector3::from_column_slice(&numbers(value))
}

/// The model of a recorded run with the true numbers of its `truth.json`.
fn true_model(folder: &Path, truth: &Value) -> Model {
    let file = folder.parent().unwrap().join("model.toml");
    let mut model = read_model(file).unwrap();
    let bodies = truth["bodies"].as_object().unwrap();
    assert_eq!(bodies.len(), model.bodies.len());
    for body in &mut model.bodies {
        let given = &bodies[&body.name];
        let i = &given["inertia_kg_m2"]["value"];
        let i = |name: &str| i[name].as_f64().unwrap();
        body.nominal = MassProperties {
            mass: given["mass_kg"]["value"].as_f64().unwrap(),
            p_BoBcm_B: vector(&given["com_m"]["value"]),
            I_BBcm_B: Matrix3::new(
                i("xx"),
                i("xy"),
                i("xz"),
                i("xy"),
                i("yy"),
                i("yz"),
                i("xz"),
                i("yz"),
                i("zz"),
            ),
        };
    }
    model
}

/// A recorded run: vehicle, origin, and noise-free telemetry by column.
pub struct Run {
    pub model: Model,
    pub source: Value,
    pub columns: HashMap<String, Vec<f64>>,
}

impl Run {
    pub fn load(run: &str) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        let folder = root.join(run);
        let truth = std::fs::read_to_string(folder.join("truth.json")).unwrap();
        let truth: Value = serde_json::from_str(&truth).unwrap();
        Self {
            model: true_model(&folder, &truth),
            source: truth["source"].clone(),
            columns: parquet_columns(&folder.join("telemetry.parquet")),
        }
    }

    pub fn column(&self, name: &str) -> &[f64] {
        &self.columns[name]
    }

    pub fn vector(&self, prefix: &str, row: usize) -> Vector3 {
        let get = |axis| self.columns[&format!("{prefix}_{axis}")][row];
        Vector3::new(get("x"), get("y"), get("z"))
    }
}

fn parquet_columns(path: &Path) -> HashMap<String, Vec<f64>> {
    let file = std::fs::File::open(path).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let mut columns: HashMap<String, Vec<f64>> = HashMap::new();
    for row in reader.get_row_iter(None).unwrap() {
        for (name, field) in row.unwrap().get_column_iter() {
            if let Field::Double(value) = field {
                columns.entry(name.clone()).or_default().push(*value);
            }
        }
    }
    columns
}
