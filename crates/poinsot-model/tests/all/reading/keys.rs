//! Every key of the format, read and written.

use super::{HEAD, accepted, body, joint, shipped};
use poinsot_model::{
    ErrorKey, EstimateSet, JointKind, Model, MomentumKnowledge, Nuisance, RandomTorque, SlowError,
    SpringDamper, parse_model, read_model, write_model,
};
use poinsot_spatial::Matrix3;

pub fn full() -> String {
    let mut text = format!("{HEAD}name = \"everything \\\"quoted\\\"\"\n");
    text += &body("bus", 100.0);
    text += "estimate = [\"mass\", \"inertia\"]\nprior = { mass_kg = 5.0, inertia_kg_m2 = 0.25 }\n";
    text += &body("frame", 0.0);
    text += &body("arm", 10.0);
    text += "estimate = true\n";
    text += &body("slider", 2.0);
    text += &joint("hold", "fixed", "bus", "frame");
    text += &joint("turn", "revolute", "frame", "arm");
    text += "rotation_xyzw = [0.1, 0.2, 0.3, 0.9]\nlocked_at_rad = 0.25\n";
    text += "spring_damper = { stiffness_N_m_per_rad = 2.5, damping_N_m_s_per_rad = 0.0625, rest_rad = -0.5 }\n";
    text += &joint("slide", "prismatic", "arm", "slider");
    text += "locked_at_m = -0.125\nrotation_matrix = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]\n";
    text += "spring_damper = { stiffness_N_per_m = 0.0 }\n";
    text += r#"
[[wheel]]
name = "w1"
body = "bus"
axis = [1.0, 1.0, 1.0]
spin_inertia_kg_m2 = 1e-3
estimate = true
[[thruster]]
name = "t1"
body = "arm"
position_m = [0.1, 0.2, 0.3]
force_direction = [0.0, 0.0, 1.0]
scale = { sigma = 0.05 }
[[mode]]
name = "panel"
body = "arm"
frequency_Hz = 0.31
damping_ratio = 0.005
translation_kg05 = [0.5, 0.0, -0.25]
rotation_kg05_m = [0.1, 0.2, 0.3]
inertia_slope_kg05_m = { xx = 0.01, yz = -0.02 }
estimate = ["frequency", "inertia_slope"]
[[sensor]]
name = "imu"
type = "gyro"
noise_rad_s = [1e-4, 2e-4, 3e-4]
bias = { sigma_rad_s = 1e-3 }
scale = "estimate"
misalignment = { sigma_rad = 0.01 }
lag = { sigma_s = 0.1 }
rotation_xyzw = [0.0, 0.0, 0.6, 0.8]
[[sensor]]
name = "accelerometer"
type = "accelerometer"
body = "arm"
noise_m_s2 = [[2e-3, 1e-3, 0.0], [1e-3, 2e-3, 0.0], [0.0, 0.0, 1e-3]]
position_m = [0.1, 0.0, 0.0]
[[sensor]]
name = "angles"
type = "joint_position"
noise_rad = 1e-5
quantisation_rad = 2e-5
[[sensor]]
name = "lengths"
type = "joint_position"
noise_m = 1e-5
[[sensor]]
name = "tachometer"
type = "wheel_speed"
of = "w1"
[[sensor]]
name = "thrust"
type = "thrust"
noise_N = 0.01
[momentum]
linear_N_s = "zero"
angular_N_m_s = [0.1, 0.2, 0.3]
[environment]
gravity = "point_mass"
gm_m3_s2 = 3.986004418e14
gravity_gradient = true
orbit = { semi_major_axis_m = 7e6, eccentricity = 0.01, inclination_rad = 1.7, raan_rad = 0.3, epoch_s = 12.5 }
disturbance_torque = { sigma_N_m = 1e-5 }
disturbance_torque_inertial = "estimate"
[telemetry]
where = { log = "LOG00119" }
[telemetry.columns]
omega_x = { column = "gyro1_wx", unit = "deg/s" }
"accelerometer.acc_x" = { column = "a \"x\"", unit = "m/s2" }
turn_rad = { column = "turn", counts_per_revolution = 4096.0, sign = -1.0 }
[[telemetry.file]]
name = "tracker*.csv"
delimiter = "tab"
comment = "%"
header_row = 3
units_row = true
time = { column = "TOW", format = "gps_week", week = "WEEK", unit = "ms" }
attitude = [{ euler = ["y", "p", "r"], sequence = "ZYX", unit = "deg", sense = "inertial_to_body" }]
orbit = { position = ["rx", "ry", "rz"], unit = "km", frame = "earth_fixed" }
columns.omega_y = { column = "wy", scale = 2.0, offset = 0.5 }
"#;
    text
}

/// Equal except for notes and noise matrices, which are written as a square root.
pub fn assert_reads_back(model: &Model) {
    let written = write_model(model);
    let mut back = parse_model(&written, "back.toml").unwrap_or_else(|e| panic!("{e}\n{written}"));
    let mut model = model.clone();
    for (a, b) in model.sensors.iter_mut().zip(&mut back.sensors) {
        if let (Some(x), Some(y)) = (a.noise_covariance, b.noise_covariance) {
            assert!((x - y).amax() <= 1e-14 * x.amax(), "{x} {y}");
            b.noise_covariance = a.noise_covariance;
        }
    }
    model.notes.clear();
    back.notes.clear();
    assert_eq!(back, model);
}

#[test]
fn exact_every_key_is_read() {
    let model = accepted(&full());
    assert_eq!(model.name, "everything \"quoted\"");
    assert_eq!(
        model.bodies[0].estimate,
        EstimateSet {
            mass: true,
            com: false,
            inertia: true
        }
    );
    let prior = model.bodies[0].prior.unwrap();
    assert_eq!(
        (prior.mass, prior.com, prior.inertia),
        (Some(5.0), None, Some(0.25))
    );
    assert_eq!(model.joints[1].locked_at, Some(0.25));
    assert_eq!(model.joints[2].locked_at, Some(-0.125));
    let spring = model.joints[1].spring_damper.unwrap();
    let numbers = (spring.stiffness, spring.damping, spring.rest);
    assert_eq!(numbers, (2.5, 0.0625, -0.5));
    assert_eq!(spring.force(0.5, 2.0), -2.625);
    assert_eq!(model.joints[0].spring_damper, None);
    assert_eq!(model.joints[2].spring_damper, Some(SpringDamper::default()));
    assert_eq!(model.joints[2].kind, JointKind::Prismatic);
    // A rotation by 90 deg about z: the child's x is the parent's y.
    assert_eq!(model.joints[2].R_PC_zero.column(0).y, 1.0);
    assert!((model.wheels[0].axis_B.norm() - 1.0).abs() < 1e-15);
    assert_eq!(model.thrusters[0].scale, Nuisance::Prior(0.05));
    assert_eq!(model.thrusters[0].body, 2);
    let panel = &model.modes[0];
    let numbers = (
        panel.mode.body,
        panel.mode.frequency_Hz,
        panel.mode.damping_ratio,
    );
    assert_eq!(numbers, (2, 0.31, 0.005));
    assert_eq!(panel.mode.translation.as_slice(), [0.5, 0.0, -0.25]);
    assert_eq!(panel.mode.rotation.as_slice(), [0.1, 0.2, 0.3]);
    let slope = &panel.mode.inertia_slope;
    assert_eq!(
        (slope[(0, 0)], slope[(2, 1)], slope[(1, 2)]),
        (0.01, -0.02, -0.02)
    );
    assert_eq!(panel.estimate.words(), ["frequency", "inertia slope"]);
    let gyro = &model.sensors[0];
    assert_eq!(gyro.noise_covariance.unwrap()[(2, 2)], 3e-4 * 3e-4);
    assert_eq!(gyro.bias, Nuisance::Prior(1e-3));
    assert_eq!(gyro.scale, Nuisance::Estimate);
    assert_eq!(gyro.lag, Nuisance::Prior(0.1));
    // Rotation by 2 atan(0.6 / 0.8) about z.
    assert!((gyro.R_BS[(1, 0)] - 0.96).abs() < 1e-15);
    let covariance = model.sensors[1].noise_covariance.unwrap();
    assert!((covariance[(0, 1)] - 4e-6).abs() < 1e-20, "S S, not S");
    assert_eq!(model.sensors[1].body, 2);
    assert_eq!(model.sensors[2].of, [1]);
    assert_eq!(model.sensors[3].of, [2]);
    assert_eq!(model.sensors[4].of, [0]);
    assert_eq!(
        model.momentum.linear,
        MomentumKnowledge::Known([0.0; 3].into())
    );
    assert_eq!(
        model.momentum.angular,
        MomentumKnowledge::Known([0.1, 0.2, 0.3].into())
    );
    assert_eq!(model.environment.point_mass_gm, Some(3.986004418e14));
    assert_eq!(
        model.telemetry.all.row_filter,
        [("log".to_owned(), "LOG00119".to_owned())]
    );
    assert_eq!(model.telemetry.all.columns.len(), 3);
    assert_eq!(
        model.notes,
        [
            "line 37: joint[1].rotation_xyzw (joint \"turn\"): the quaternion has length 0.974679; normalised",
            "line 54: wheel[0].axis (wheel \"w1\"): the axis has length 1.73205; normalised",
        ]
    );
}

#[test]
fn exact_a_written_model_reads_back() {
    assert_reads_back(&accepted(&full()));
    for path in shipped() {
        assert_reads_back(&read_model(path).unwrap());
    }
}

fn nuisances(model: &mut Model) -> Vec<&mut Nuisance> {
    let mut all = Vec::new();
    for sensor in &mut model.sensors {
        let of_sensor = [
            (ErrorKey::Bias, &mut sensor.bias),
            (ErrorKey::Scale, &mut sensor.scale),
            (ErrorKey::Misalignment, &mut sensor.misalignment),
            (ErrorKey::Nonorthogonality, &mut sensor.nonorthogonality),
            (ErrorKey::Lag, &mut sensor.lag),
        ];
        let can = sensor.kind.unknown_errors();
        let own = of_sensor.into_iter().filter(|(key, _)| can.contains(key));
        all.extend(own.map(|(_, nuisance)| nuisance));
    }
    all.extend(model.wheels.iter_mut().map(|w| &mut w.misalignment));
    all.extend(model.thrusters.iter_mut().map(|t| &mut t.scale));
    let around = &mut model.environment;
    all.push(&mut around.disturbance_torque);
    all.push(&mut around.disturbance_torque_inertial);
    all.push(&mut around.drag_torque);
    all
}

#[test]
fn exact_every_nuisance_reads_back_from_what_was_written() {
    let model = accepted(&full());
    let places = nuisances(&mut model.clone()).len();
    assert_eq!(places, 2 * 5 + 2 * 3 + 1 + 2 + 1 + 1 + 3);
    for place in 0..places {
        for value in [
            Nuisance::Known,
            Nuisance::Estimate,
            Nuisance::Prior(0.1),
            Nuisance::Prior(3.0e-17),
        ] {
            let mut changed = model.clone();
            if let Some(nuisance) = nuisances(&mut changed).into_iter().nth(place) {
                *nuisance = value;
            }
            assert_reads_back(&changed);
        }
    }
    let mut gusty = model;
    gusty.environment.random_torque = Some(RandomTorque {
        sigma_N_m: 1.0e-5,
        correlation_s: 30.0,
    });
    let slow = |correlation_s| SlowError {
        covariance: Matrix3::identity() * (1.0e-5 * 1.0e-5),
        correlation_s,
    };
    for correlation_s in [f64::INFINITY, 0.3] {
        gusty.sensors[0].slow.insert(0, slow(correlation_s));
        assert_reads_back(&gusty);
    }
    gusty.sensors[0].noise_covariance = None;
    assert_reads_back(&gusty);
}
