//! Refusals of sensors.

use crate::refusals::Case;

pub const CASES: &[Case] = &[
    (
        r#"type = "gyro""#,
        r#"type = "gyroscope""#,
        r#"E0107 m.toml:34:8: sensor[0].type (sensor "gyro") = "gyroscope": the word is not one of those allowed here; write "gyro", "attitude", "velocity", "position", "accelerometer", "velocity_increment", "direction", "joint_position", "joint_rate", "wheel_speed", "thrust"; did you mean "gyro"?"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 1.0e-4
bias = 1.0e-5"#,
        r#"E0107 m.toml:36:8: sensor[0].bias (sensor "gyro") = 1.0e-5: a number is here, but another type is needed; write "none", "estimate" or a table { sigma_<unit> = x }"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 1.0e-4
bias = "estimated""#,
        r#"E0107 m.toml:36:8: sensor[0].bias (sensor "gyro") = "estimated": the word is not one of those allowed here; write "none", "estimate" or a table { sigma_<unit> = x }; did you mean "estimate"?"#,
    ),
    (
        r#"[[wheel]]
name = "wheel1""#,
        r#"[[sensor]]
name = "gyro"
type = "gyro"
[[wheel]]
name = "wheel1""#,
        r#"E0110 m.toml:36:8: sensor[1].name = "gyro": sensor[0] has the same type and name; rename one of them"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 1.0e-4
bias = "estimate"
scale = "estimate"
[[sensor]]
name = "gyro"
type = "accelerometer"
noise_m_s2 = 1.0e-4
bias = "estimate"
scale = "estimate""#,
        r#"E0110 m.toml:39:8: sensor[1].name = "gyro": sensor[0] has the same name, and the unknown scale of both would be gyro.scale; rename one of them"#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"quantisation_rad = 2.4e-5
of = ["joint1", "joint2"]"#,
        r#"E0111 m.toml:40:17: sensor[1].of[1] (sensor "encoders") = "joint2": there is no joint of this name; did you mean "joint1"?"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad = 1.0e-4"#,
        r#"E0105 m.toml:35:13: sensor[0].noise_rad (sensor "gyro") = 1.0e-4: the key does not fit type = "gyro"; write noise_rad_s"#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"quantisation_m = 2.4e-5"#,
        r#"accepted, notes ["line 38: sensor[1].type (sensor \"encoders\"): the sensor has no effect: the model has nothing that it could measure; remove it, or add what it measures"]"#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"quantisation_rad = -1.0"#,
        r#"E0118 m.toml:39:20: sensor[1].quantisation_rad (sensor "encoders") = -1.0: the quantisation must be greater than zero; give a positive number"#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"quantisation_rad_s = 2.4e-5"#,
        r#"E0105 m.toml:39:22: sensor[1].quantisation_rad_s (sensor "encoders") = 2.4e-5: the key does not fit type = "joint_position"; write quantisation_rad or quantisation_m"#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"quantisation_rad = 2.4e-5
position_m = [0.0, 0.0, 0.0]"#,
        r#"E0118 m.toml:40:14: sensor[1].position_m (sensor "encoders") = [0.0, 0.0, 0.0]: the key does not fit type = "joint_position"; remove it, or write type = "gyro" or "attitude" or "velocity" or "position" or "accelerometer" or "velocity_increment" or "direction""#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"quantisation_rad = 2.4e-5
misalignment = "estimate""#,
        r#"E0118 m.toml:40:16: sensor[1].misalignment (sensor "encoders") = "estimate": the misalignment of a sensor of type "joint_position" cannot be estimated; remove it; bias, scale, lag can be estimated"#,
    ),
    (
        r#"type = "joint_position"
quantisation_rad = 2.4e-5"#,
        r#"type = "joint_rate"
quantisation_rad_s = 2.4e-5
lag = { sigma_s = 1.0e-3 }"#,
        r#"E0118 m.toml:40:7: sensor[1].lag (sensor "encoders") = { sigma_s = 1.0e-3 }: the lag of a sensor of type "joint_rate" cannot be estimated; declare it on the joint_position sensor"#,
    ),
    (
        r#"type = "joint_position"
quantisation_rad = 2.4e-5"#,
        r#"type = "wheel_speed"
quantisation_rad_s = 2.4e-5
scale = "estimate""#,
        r#"E0118 m.toml:40:9: sensor[1].scale (sensor "encoders") = "estimate": the scale of a sensor of type "wheel_speed" cannot be estimated; write estimate = true on the [[wheel]]: its spin inertia stands for both"#,
    ),
    (
        r#"type = "joint_position"
quantisation_rad = 2.4e-5"#,
        r#"type = "attitude"
quantisation_rad = 2.4e-5
scale = { sigma = 0.01 }"#,
        r#"E0118 m.toml:40:9: sensor[1].scale (sensor "encoders") = { sigma = 0.01 }: the scale of a sensor of type "attitude" cannot be estimated; remove it; bias, lag can be estimated"#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"noise_rad = [1.0, 1.0, 1.0]"#,
        r#"E0118 m.toml:39:13: sensor[1].noise_rad (sensor "encoders") = [1.0, 1.0, 1.0]: a sensor of type "joint_position" has no axes; write one number"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 0.0"#,
        r#"E0118 m.toml:35:15: sensor[0].noise_rad_s (sensor "gyro") = 0.0: the noise must be greater than zero; give a positive number"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = [1.0e-4, -1.0e-4, 1.0e-4]"#,
        r#"E0118 m.toml:35:24: sensor[0].noise_rad_s[1] (sensor "gyro") = -1.0e-4: the noise must be greater than zero; give a positive number"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]]"#,
        r#"E0118 m.toml:35:15: sensor[0].noise_rad_s (sensor "gyro") = [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]]: the matrix is not symmetric and positive definite: eigenvalues -1, 1, 3; write the symmetric square root S of the covariance S S"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = [[1.0, 0.5, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 1.0]]"#,
        r#"E0118 m.toml:35:15: sensor[0].noise_rad_s (sensor "gyro") = [[1.0, 0.5, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 1.0]]: the matrix is not symmetric and positive definite: eigenvalues 0.65, 1, 1.35; write the symmetric square root S of the covariance S S"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_deg_s = 1.0e-4"#,
        r#"E0105 m.toml:35:1: sensor[0].noise_deg_s (sensor "gyro") = 1.0e-4: wrong unit; write noise_rad_s and convert the number"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise = 1.0e-4"#,
        r#"E0105 m.toml:35:1: sensor[0].noise (sensor "gyro") = 1.0e-4: missing unit; write noise_rad_s"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 1.0e-4
of = "joint1""#,
        r#"E0118 m.toml:36:6: sensor[0].of (sensor "gyro") = "joint1": the key does not fit type = "gyro"; remove it, or write type = "joint_position" or "joint_rate" or "wheel_speed" or "thrust""#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 1.0e-4
bias = { sigma_rad = 1.0e-5 }"#,
        r#"E0105 m.toml:36:22: sensor[0].bias.sigma_rad (sensor "gyro") = 1.0e-5: wrong unit; write sigma_rad_s here"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 1.0e-4
lag = { sigma_s = -0.1 }"#,
        r#"E0118 m.toml:36:19: sensor[0].lag.sigma_s (sensor "gyro") = -0.1: the sigma must be greater than zero; give a positive number"#,
    ),
];
