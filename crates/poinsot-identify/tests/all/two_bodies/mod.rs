//! Two unknown bodies that tumble while the joint between them moves.

use poinsot_dynamics::{
    Flight, Fourier, JointMotion, MotionSample, Plan, Start, StartVelocity, Tolerance,
};
use poinsot_model::Model;
use poinsot_spatial::{UnitQuaternion, Vector3};

pub const VEHICLE: &str = r#"
schema = "poinsot.model/1"
exact = true
name = "two bodies"

[[body]]
name = "bus"
mass_kg = 30.0
com_m = [0.1, -0.2, 0.3]
inertia_kg_m2 = { xx = 9.0, yy = 11.0, zz = 8.0, xy = 0.5, xz = -0.7, yz = 0.4 }
estimate = true

[[body]]
name = "arm"
mass_kg = 14.0
com_m = [0.3, 0.2, -0.1]
inertia_kg_m2 = { xx = 2.0, yy = 3.0, zz = 2.5, xy = 0.2, xz = 0.1, yz = -0.3 }
estimate = true

[[joint]]
name = "shoulder"
type = "revolute"
parent = "bus"
child = "arm"
origin_m = [0.4, 0.3, -0.2]
axis = [0.36, 0.48, 0.8]

[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 1e-5
"#;

/// Motion number `at`, sample by sample.
pub fn tumble(model: &Model, at: usize, times: &[f64], see: impl FnMut(&MotionSample)) {
    let mut plan = Plan::hold(model);
    let swing = JointMotion::Fourier(Fourier {
        offset: 0.2,
        base_frequency_hz: 0.05,
        sine: vec![0.5, -0.3 + 0.1 * at as f64],
        cosine: vec![0.2, 0.4],
    });
    plan.joints[0] = swing.into();
    let start = Start {
        R_NB: UnitQuaternion::from_euler_angles(0.3, -0.5, 0.2 + at as f64),
        p_NoBo_N: Vector3::zeros(),
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::new(0.1, -0.05, 0.2),
            w_NB_B: Vector3::new(0.2, 0.15, -0.1 - 0.1 * at as f64),
        },
    };
    let vehicle = Flight::new(model, &plan, Tolerance::default()).unwrap();
    vehicle.run(&start, times, see).unwrap();
}
