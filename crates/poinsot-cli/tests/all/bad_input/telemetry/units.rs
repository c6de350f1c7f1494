//! T7 to T11: units, quaternions, signs and axes.

use super::{angle, noise, rpm, swap};
use crate::bad_input::bench::Bench;
use crate::bad_input::row::{Row, row};

/// The gyro in another unit, without attitude to compare with.
fn gyro_alone(b: &Bench, unit: fn(f64) -> f64) {
    b.spoil(|s| {
        s.without("q_");
        s.map("omega", |_, w| unit(w));
    });
}

/// An accelerometer half a metre from the mass centre, in units of 9.80665 m/s2.
fn accelerometer_in_g(b: &Bench) {
    let sensor = "\n[[sensor]]\nname = \"acc\"\ntype = \"accelerometer\"\nposition_m = [0.5, 0.3, 0.2]\nnoise_m_s2 = 1e-6\n";
    b.write("m.toml", crate::bad_input::bench::MODEL.to_owned() + sensor);
    b.write("truth.toml", crate::bad_input::bench::truth() + sensor);
    b.write("case.toml", crate::bad_input::bench::CASE);
    let done = b.run(&["simulate", "case.toml", "--out", "sim"]);
    assert_eq!(done.exit, 0, "{}", done.stderr);
    let text = std::fs::read_to_string(b.path("sim/telemetry.csv")).unwrap();
    let columns: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let lines: Vec<String> = text
        .lines()
        .map(|line| {
            let cells = line.split(',').zip(&columns).map(|(cell, name)| {
                let number = cell
                    .parse::<f64>()
                    .ok()
                    .filter(|_| name.starts_with("acc_"));
                number.map_or(cell.to_owned(), |a| format!("{:?}", a / 9.80665))
            });
            cells.collect::<Vec<_>>().join(",")
        })
        .collect();
    b.write("t.csv", lines.join("\n") + "\n");
}

pub fn rows() -> Vec<Row> {
    vec![
        row(
            "T7",
            "gyro in deg/s",
            |b| b.spoil(|s| s.map("omega", |_, w| angle(w))),
            2,
            &[
                "E0215 attitude 'q_x..q_w' and gyro 'omega_x..z' contradict the declared",
                "gyro in deg/s; correct the map or the file",
            ],
        ),
        row(
            "T7",
            "gyro in deg/s, no attitude",
            |b| gyro_alone(b, angle),
            2,
            &[
                "E0220 t.csv: channel 'omega': units: the data contradict the model; they fit with body rates in deg/s used as rad/s; correct it, or accept it by --policy units=report (without --strict)",
            ],
        ),
        row(
            "T7",
            "the same, accepted",
            |b| gyro_alone(b, angle),
            1,
            &["units: the data contradict the model; they fit with body rates in deg/s used as rad/s"],
        )
        .more(&["--policy", "units=report"])
        .never(&[": Determined. "]),
        row(
            "T7",
            "gyro in rpm, no attitude",
            |b| gyro_alone(b, rpm),
            2,
            &["E0220", "they fit with body rates in rpm used as rad/s"],
        ),
        row(
            "T7",
            "gyro mapped as deg/s that is rad/s, no attitude",
            |b| gyro_alone(b, f64::to_radians),
            1,
            &[": Partly determined, not reliable. "],
        )
        .never(&["every number"]),
        row(
            "T7",
            "gyro in rpm",
            |b| b.spoil(|s| s.map("omega", |_, w| rpm(w))),
            2,
            &["E0215", "gyro in rpm"],
        ),
        row(
            "T7",
            "all wheels in rpm",
            |b| b.spoil(|s| s.map("wheel", |_, w| rpm(w))),
            2,
            &[
                "E0220 t.csv: channel 'bus': units: the data fit",
                "possible cause: wheel speeds in rpm used as rad/s; correct it, or accept it by --policy units=report (without --strict)",
            ],
        ),
        row(
            "T7",
            "the same, accepted",
            |b| b.spoil(|s| s.map("wheel", |_, w| rpm(w))),
            1,
            &["units: the data fit"],
        )
        .more(&["--policy", "units=report"]),
        row(
            "T7",
            "wheels mapped as rpm that are rad/s",
            |b| {
                b.write("m.toml", crate::bad_input::bench::MODEL.to_owned() + "\n[telemetry.columns]\nwheel1_rad_s = { column = \"wheel1_rad_s\", unit = \"rpm\" }\nwheel2_rad_s = { column = \"wheel2_rad_s\", unit = \"rpm\" }\nwheel3_rad_s = { column = \"wheel3_rad_s\", unit = \"rpm\" }\n")
            },
            2,
            &[
                "E0220",
                "possible cause: wheel speeds in rad/s mapped as rpm",
            ],
        ),
        row(
            "T7",
            "wheels in turns per second",
            |b| b.spoil(|s| s.map("wheel", |_, w| w / (2.0 * std::f64::consts::PI))),
            2,
            &[
                "E0220",
                "possible cause: wheel speeds in turns per second used as rad/s",
            ],
        ),
        row(
            "T7",
            "one wheel in rpm",
            |b| b.spoil(|s| s.map("wheel2", |_, w| rpm(w))),
            1,
            &["wheel2"],
        ),
        row(
            "T7",
            "a map with a unit of another kind",
            |b| {
                b.write("m.toml", crate::bad_input::bench::MODEL.to_owned() + "\n[telemetry.columns]\nomega_x = { column = \"omega_x\", unit = \"m\" }\n")
            },
            2,
            &["E0212 m.toml:", "unit 'm' does not measure it"],
        ),
        row(
            "T7",
            "inertia in kg cm2",
            |b| b.model("inertia_kg_m2 = { xx = 15.0", "inertia_kg_cm2 = { xx = 150000.0"),
            2,
            &["E0105 m.toml:8:1: body[0].inertia_kg_cm2", "wrong unit; write inertia_kg_m2 and convert the number"],
        ),
        row(
            "T7",
            "a torque in mN m: nothing that is asked needs it",
            |b| {
                b.spoil(|s| {
                    s.header.push("wheel1_Nm".into());
                    s.rows.iter_mut().for_each(|r| r.push("35.0".into()));
                })
            },
            0,
            &[": Determined. "],
        ),
        row("T7", "an accelerometer in g", accelerometer_in_g, 1, &["the data contradict the known number bus.com_x", "a scale error of the accelerometer"]),
        row(
            "T8",
            "signs of the quaternion flip",
            |b| b.spoil(|s| s.map("q_", |n, q| if (n / 7) % 2 == 0 { q } else { -q })),
            0,
            &["changes of quaternion sign undone (the same attitude)"],
        ),
        row(
            "T9",
            "norm off by 5e-4",
            |b| b.spoil(|s| s.map("q_", |_, q| q * 1.0005)),
            0,
            &["quaternions normalised; the norm is off by up to"],
        ),
        row(
            "T9",
            "norm off by 1e-2",
            |b| b.spoil(|s| s.map("q_", |_, q| q * 1.01)),
            0,
            &["warning: 501 quaternions are off unit norm by more than 1e-3"],
        ),
        row(
            "T9",
            "norm 1.2 in one row",
            |b| b.spoil(|s| s.map("q_", |n, q| if n == 9 { q * 1.2 } else { q })),
            2,
            &[
                "E0214 t.csv:11 column 'q_x': the quaternion (",
                "has norm 1.2",
                "not 1; correct the row or the order of the columns",
            ],
        ),
        row(
            "T9",
            "a zero quaternion",
            |b| b.spoil(|s| s.map("q_", |n, q| if n == 9 { 0.0 } else { q })),
            0,
            &["1 zero quaternions treated as missing samples"],
        ),
        row(
            "T10",
            "scalar first",
            |b| {
                b.spoil(|s| {
                    s.header[4..8].rotate_right(1);
                })
            },
            2,
            &["E0215", "quaternion scalar first (wxyz)"],
        ),
        row(
            "T10",
            "inertial to body",
            |b| {
                b.spoil(|s| {
                    ["q_x", "q_y", "q_z"]
                        .iter()
                        .for_each(|c| s.map(c, |_, q| -q))
                })
            },
            2,
            &[
                "E0215",
                "quaternion inertial to body (or body to inertial in JPL algebra)",
            ],
        ),
        row(
            "T10",
            "too little motion to decide",
            |b| {
                b.spoil(|s| {
                    s.map("omega", |n, _| 1e-4 * noise(n));
                    s.map("q_", |_, _| 0.5);
                    s.map("wheel", |_, _| 0.0);
                })
            },
            1,
            &["not"],
        )
        .never(&[": Determined. "]),
        row(
            "T11",
            "axes of the gyro exchanged",
            |b| b.spoil(|s| swap(s, "omega_x", "omega_y")),
            2,
            &["E0215", "body rates = gyro (y, x, z)"],
        ),
        row(
            "T11",
            "sign of wheel 1",
            |b| b.spoil(|s| s.map("wheel1", |_, w| -w)),
            1,
            &["wheel1"],
        ),
        row(
            "T11",
            "signs of all wheels",
            |b| b.spoil(|s| s.map("wheel", |_, w| -w)),
            1,
            &["wheel"],
        ),
        row(
            "T11",
            "two wheels exchanged",
            |b| b.spoil(|s| swap(s, "wheel1_rad_s", "wheel2_rad_s")),
            1,
            &["wheel"],
        ),
        row(
            "T11",
            "a frame matrix that is left-handed",
            |b| {
                b.model("noise_rad_s = 0.0001", "noise_rad_s = 0.0001\nrotation_matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]")
            },
            2,
            &["E0114 m.toml:"],
        ),
        row(
            "T11",
            "a frame matrix that is not orthonormal",
            |b| {
                b.model("noise_rad_s = 0.0001", "noise_rad_s = 0.0001\nrotation_matrix = [[1.0, 0.01, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]")
            },
            2,
            &["E0114 m.toml:"],
        ),
    ]
}
