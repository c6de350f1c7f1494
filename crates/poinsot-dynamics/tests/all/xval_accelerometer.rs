//! Accelerometers on driven trees against MuJoCo's sensor (validation/trees/accelerometer.py).

use crate::setup;

use poinsot_dynamics::*;
use poinsot_spatial::{InertialParameters, Vector3, Vector6};
use poinsot_testkit::trees::load_trees;

struct Record {
    tree: usize,
    body: usize,
    place: Vector3,
    qdd: Vec<f64>,
    reading: Vector3,
}

fn records() -> Vec<Record> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../validation/trees/accelerometer.jsonl"
    );
    let text = std::fs::read_to_string(path).unwrap();
    let numbers = |v: &serde_json::Value| -> Vec<f64> {
        let list = v.as_array().unwrap();
        list.iter().map(|x| x.as_f64().unwrap()).collect()
    };
    text.lines()
        .map(|line| {
            let v: serde_json::Value = serde_json::from_str(line).unwrap();
            Record {
                tree: v["tree"].as_u64().unwrap() as usize,
                body: v["body"].as_u64().unwrap() as usize,
                place: Vector3::from_row_slice(&numbers(&v["p_BoS_B"])),
                qdd: numbers(&v["qdd"]),
                reading: Vector3::from_row_slice(&numbers(&v["reading"])),
            }
        })
        .collect()
}

/// The base acceleration from the momentum equation without external force, then the accelerometer's.
#[test]
fn xval_accelerometer_is_that_of_mujoco() {
    let trees = load_trees().unwrap();
    let records = records();
    assert_eq!(records.len(), 200);
    let mut worst: f64 = 0.0;
    for record in &records {
        let case = &trees[record.tree];
        let model = setup::model(&case.bodies, &[]);
        let tree = Tree::new(&model);
        let bodies: Vec<InertialParameters> = model
            .bodies
            .iter()
            .map(|b| b.nominal.parameters())
            .collect();
        let s = &case.state;
        let mut kinematics = Kinematics::at(&tree, &s.q);
        kinematics.set_velocities(&tree, &s.v_NBo_B, &s.w_NB_B, &s.qd);
        let mut body = Accelerations::new(&tree);
        body.set_without_base(&tree, &kinematics, &s.qd, &record.qdd);
        let (force, torque) = body.momentum_rate(&bodies, &kinematics);
        let b = Vector6::from_iterator(force.iter().chain(torque.iter()).copied());
        let H = composite(&bodies, &kinematics).locked_inertia();
        let A = -H.cholesky().unwrap().solve(&b);
        let (a, alpha) = (A.fixed_rows::<3>(0).into(), A.fixed_rows::<3>(3).into());
        body.add_base(&kinematics, &a, &alpha);
        // Without external forces the regressor times the true parameters is zero.
        let mut balance = Vector6::zeros();
        let mut size = 0.0;
        for (i, pi) in bodies.iter().enumerate() {
            for (k, value) in pi.to_array().into_iter().enumerate() {
                let column = momentum_rate_column(&body, &kinematics, i, k) * value;
                balance += column;
                size += column.norm();
            }
        }
        assert!(balance.norm() < 1.0e-11 * size, "tree {}", record.tree);
        let found = body.at_point(&kinematics, record.body, &record.place);
        worst = worst.max((found - record.reading).norm() / (1.0 + record.reading.norm()));
    }
    println!("largest difference {worst:.1e} of 1 m/s2 and the reading");
    assert!(worst < 1.0e-9, "{worst:e}");
}
