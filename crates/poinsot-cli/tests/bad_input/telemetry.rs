//! 2a: what can be wrong inside of telemetry.

use crate::bench::{Bench, Sheet};
use crate::row::{Row, row};

const QUATERNION: [&str; 4] = ["q_x", "q_y", "q_z", "q_w"];

fn noise(k: usize) -> f64 {
    // A fixed sequence without pattern, between -1 and 1.
    let x = (k as f64 * 12.9898 + 4.1).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

fn angle(w: f64) -> f64 {
    w * 180.0 / std::f64::consts::PI
}

fn rpm(w: f64) -> f64 {
    w * 30.0 / std::f64::consts::PI
}

fn swap(sheet: &mut Sheet, a: &str, b: &str) {
    let (a, b) = (sheet.column(a), sheet.column(b));
    sheet.header.swap(a, b);
}

fn drop_rows(sheet: &mut Sheet, keep: impl Fn(usize) -> bool) {
    let mut k = 0;
    sheet.rows.retain(|_| {
        k += 1;
        keep(k - 1)
    });
}

pub fn rows() -> Vec<Row> {
    let mut all = cells();
    all.extend(times());
    all.extend(units());
    all.extend(sensors());
    all.extend(motions());
    all
}

fn cells() -> Vec<Row> {
    vec![
        row("T0", "nothing: the good telemetry", |_| {}, 0, &["every number asked for is determined"]),
        row("T1", "empty cells", |b| b.spoil(|s| (10..20).for_each(|k| s.set(k, "omega_y", ""))), 0,
            &["every number asked for is determined"]),
        row("T1", "NaN in 3 cells", |b| b.spoil(|s| (10..13).for_each(|k| s.set(k, "omega_y", "NaN"))), 0,
            &["3 NaN cells taken as no sample (this is the first)"]),
        row("T1", "the same, strict", |b| b.spoil(|s| (10..13).for_each(|k| s.set(k, "omega_y", "NaN"))), 2,
            &["E0218 t.csv:12 column 'omega_y': 3 NaN cells taken as no sample; --strict allows no repair: correct the file or leave out --strict"])
            .more(&["--strict"]),
        row("T1", "NaN everywhere in the gyro", |b| b.spoil(|s| s.map("omega", |_, _| f64::NAN)), 2,
            &["E0301 t.csv: no channel 'omega_x omega_y omega_z'"]),
        row("T1", "NaN in every cell", |b| b.spoil(|s| s.map("", |_, _| f64::NAN)), 2,
            &["E0208 t.csv:2 column 'time_s': the row has no time"]),
        row("T1", "Inf", |b| b.spoil(|s| s.set(7, "omega_x", "inf")), 2,
            &["E0203 t.csv:9 column 'omega_x': 'inf' is infinite; leave the cell empty where there is no sample"]),
        row("T1", "'null'", |b| b.spoil(|s| s.set(7, "omega_x", "null")), 2,
            &["E0203 t.csv:9 column 'omega_x': 'null' is not a number; leave the cell empty where there is no sample"]),
        row("T1", "'-'", |b| b.spoil(|s| s.set(7, "omega_x", "-")), 2, &["'-' is not a number; leave the cell empty"]),
        row("T1", "'#N/A'", |b| b.spoil(|s| s.set(7, "omega_x", "#N/A")), 2, &["'#N/A' is not a number; leave the cell empty"]),
        row("T1", "sentinel -9999 in the gyro", |b| b.spoil(|s| (0..500).step_by(50).for_each(|k| s.set(k, "omega_x", -9999.0))), 2,
            &["E0306 t.csv: channel 'omega_x': -9999.0 at t = 0 s", "correct the unit, or leave the cell empty where there is no sample"]),
        row("T1", "sentinel 0.5 in 2 % of the gyro", |b| b.spoil(|s| (0..500).step_by(50).for_each(|k| s.set(k, "omega_x", 0.5))), 1,
            &["placeholder (report): omega_x: 0.5 stands in 10 samples"]),
        row("T1", "the same, left out by policy", |b| b.spoil(|s| (0..500).step_by(50).for_each(|k| s.set(k, "omega_x", 0.5))), 0,
            &["placeholder: 10 of 501 samples of omega_x left out", "every number asked for is determined"])
            .more(&["--policy", "placeholder=exclude"]),
        row("T1", "1e30 in a wheel speed", |b| b.spoil(|s| s.set(3, "wheel1_rad_s", "1e30")), 2,
            &["E0306 t.csv: channel 'wheel1_rad_s': 1e30 at t = 0.6", "beyond 1e5 rad/s"]),
        row("T1", "1e300 in the gyro", |b| b.spoil(|s| s.map("omega", |_, x| x * 1e300)), 2, &["E0306 t.csv: channel 'omega_x'"]),
        row("T1", "denormal numbers in the gyro", |b| b.spoil(|s| s.map("omega", |_, x| x * 1e-310)), 1,
            &["residual of the gyro"]).never(&["every number asked for is determined"]),
    ]
}

fn times() -> Vec<Row> {
    vec![
        row(
            "T2",
            "a gap of 20 s in the gyro",
            |b| {
                b.spoil(|s| {
                    (100..200).for_each(|k| {
                        ["omega_x", "omega_y", "omega_z"]
                            .iter()
                            .for_each(|c| s.set(k, c, ""))
                    })
                })
            },
            0,
            &["gap (report): omega_x: 1 gaps, the longest 20.2"],
        ),
        row(
            "T2",
            "a third of the packets lost at random",
            |b| b.spoil(|s| drop_rows(s, |k| noise(k) > -0.33)),
            0,
            &["every number asked for is determined"],
        ),
        row(
            "T2",
            "half of the record lost",
            |b| b.spoil(|s| (100..400).for_each(|k| s.set(k, "wheel2_rad_s", ""))),
            1,
            &["samples of a segment were left out (see repairs)"],
        ),
        row(
            "T3",
            "rows that stand twice",
            |b| {
                b.spoil(|s| {
                    let r = s.rows[5].clone();
                    s.rows.insert(6, r.clone());
                    s.rows.insert(6, r);
                })
            },
            0,
            &["2 rows that repeat the row before them dropped (this is the first)"],
        ),
        row(
            "T3",
            "one time with two values",
            |b| {
                b.spoil(|s| {
                    let mut r = s.rows[5].clone();
                    r[1] = "0.1".into();
                    s.rows.insert(6, r);
                })
            },
            2,
            &[
                "E0208 t.csv:8 column 'time_s': time 1 s stands already in row 7 with another value of 'omega_x'; keep one of the rows",
            ],
        ),
        row(
            "T4",
            "time goes back",
            |b| b.spoil(|s| s.rows.swap(20, 40)),
            2,
            &[
                "E0208 t.csv:23 column 'time_s': time goes back from 8",
                "choose one run by [telemetry] where, or cut the file into segments",
            ],
        ),
        row(
            "T4",
            "a counter in ms wraps at 2^32",
            |b| {
                b.spoil(|s| s.map("time_s", |_, t| (t * 1000.0 + 4294937296.0) % 4294967296.0));
                b.write("m.toml", crate::bench::MODEL.to_owned() + "\n[telemetry.columns]\ntime_s = { column = \"time_s\", unit = \"ms\" }\n");
            },
            2,
            &["E0208", "time goes back from"],
        ),
        row(
            "T4",
            "times start anew after a restart",
            |b| b.spoil(|s| s.map("time_s", |n, t| if n >= 250 { t - 50.0 } else { t })),
            2,
            &["E0208 t.csv:252 column 'time_s': time goes back from"],
        ),
        row(
            "T5",
            "ms read as s",
            |b| b.spoil(|s| s.map("time_s", |_, t| t * 1e9)),
            2,
            &[
                "E0209 t.csv column 'time_s': the median step is 2e8 s",
                "the unit is likely ns",
            ],
        ),
        row(
            "T5",
            "days",
            |b| b.spoil(|s| s.map("time_s", |_, t| t / 86400.0)),
            2,
            &["E0209", "the unit is likely d"],
        ),
        row(
            "T6",
            "the gyro is 0.6 s late",
            |b| {
                b.spoil(|s| {
                    let old = s.clone();
                    for k in 3..s.rows.len() {
                        for c in ["omega_x", "omega_y", "omega_z"] {
                            s.set(k, c, old.get(k - 3, c));
                        }
                    }
                })
            },
            0,
            &["a lag of the gyro"],
        ),
    ]
}

fn units() -> Vec<Row> {
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
            |b| {
                b.spoil(|s| {
                    s.without("q_");
                    s.map("omega", |_, w| angle(w));
                })
            },
            2,
            &[
                "E0220 t.csv: channel 'omega': units: the data contradict the model, and fit it as body rates in deg/s that are read as rad/s; correct it, or accept it by --policy units=report (without --strict)",
            ],
        ),
        row(
            "T7",
            "the same, accepted",
            |b| {
                b.spoil(|s| {
                    s.without("q_");
                    s.map("omega", |_, w| angle(w));
                })
            },
            1,
            &["units: the data contradict the model, and fit it as body rates in deg/s that are read as rad/s"],
        )
        .more(&["--policy", "units=report"])
        .never(&["every number asked for is determined"]),
        row(
            "T7",
            "gyro in rpm, no attitude",
            |b| {
                b.spoil(|s| {
                    s.without("q_");
                    s.map("omega", |_, w| rpm(w));
                })
            },
            2,
            &["E0220", "fit it as body rates in rpm that are read as rad/s"],
        ),
        row(
            "T7",
            "gyro mapped as deg/s that is rad/s, no attitude",
            |b| {
                b.spoil(|s| {
                    s.without("q_");
                    s.map("omega", |_, w| w.to_radians());
                })
            },
            2,
            &[
                "E0220",
                "fit it as body rates in rad/s that are mapped as deg/s",
            ],
        ),
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
                "E0220 t.csv: channel 'bus': units: the data ask for",
                "as wheel speeds in rpm that are read as rad/s would; correct it, or accept it by --policy units=report (without --strict)",
            ],
        ),
        row(
            "T7",
            "the same, accepted",
            |b| b.spoil(|s| s.map("wheel", |_, w| rpm(w))),
            0,
            &["units: the data ask for"],
        )
        .more(&["--policy", "units=report"]),
        row(
            "T7",
            "wheels mapped as rpm that are rad/s",
            |b| {
                b.write("m.toml", crate::bench::MODEL.to_owned() + "\n[telemetry.columns]\nwheel1_rad_s = { column = \"wheel1_rad_s\", unit = \"rpm\" }\nwheel2_rad_s = { column = \"wheel2_rad_s\", unit = \"rpm\" }\nwheel3_rad_s = { column = \"wheel3_rad_s\", unit = \"rpm\" }\n")
            },
            2,
            &[
                "E0220",
                "as wheel speeds in rad/s that are mapped as rpm would",
            ],
        ),
        row(
            "T7",
            "wheels in turns per second",
            |b| b.spoil(|s| s.map("wheel", |_, w| w / (2.0 * std::f64::consts::PI))),
            2,
            &[
                "E0220",
                "as wheel speeds in turns per second that are read as rad/s would",
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
                b.write("m.toml", crate::bench::MODEL.to_owned() + "\n[telemetry.columns]\nomega_x = { column = \"omega_x\", unit = \"m\" }\n")
            },
            2,
            &["E0212 map of channel 'omega_x': unit 'm' does not measure it"],
        ),
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
            &["1 zero quaternions taken as no sample"],
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
        .never(&["every number asked for is determined"]),
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

fn sensors() -> Vec<Row> {
    vec![
        row(
            "T12",
            "one gyro axis hangs for 20 s",
            |b| {
                b.spoil(|s| {
                    let x = s.get(100, "omega_y");
                    (100..200).for_each(|k| s.set(k, "omega_y", x));
                })
            },
            0,
            &[
                "stuck: 99 of 501 samples of omega_x..z left out",
                "a sensor that hangs",
            ],
        ),
        row(
            "T12",
            "the same, strict",
            |b| {
                b.spoil(|s| {
                    let x = s.get(100, "omega_y");
                    (100..200).for_each(|k| s.set(k, "omega_y", x));
                })
            },
            2,
            &[
                "E0220 t.csv: channel 'omega_x..z': stuck:",
                "accept it by --policy stuck=exclude (without --strict)",
            ],
        )
        .more(&["--strict"]),
        row(
            "T12",
            "the gyro is cut at 0.02 rad/s",
            |b| b.spoil(|s| s.map("omega", |_, w| w.clamp(-0.02, 0.02))),
            1,
            &["saturation: ", "the sensor is saturated there"],
        ),
        row(
            "T12",
            "the tracker's column repeats each reading 5 times",
            |b| {
                b.spoil(|s| {
                    let old = s.clone();
                    for k in 0..s.rows.len() {
                        for c in QUATERNION {
                            s.set(k, c, old.get(k - k % 5, c));
                        }
                    }
                })
            },
            0,
            &["held: 400 of 501 samples of q_x..w left out: each reading stands 5 times in a row"],
        ),
        row(
            "T12",
            "the gyro is quantised at 1e-4 rad/s",
            |b| b.spoil(|s| s.map("omega", |_, w| (w / 1e-4).round() * 1e-4)),
            0,
            &["every number asked for is determined"],
        ),
        row(
            "T13",
            "one spike",
            |b| b.spoil(|s| s.set(77, "omega_x", 0.5)),
            0,
            &[
                "outlier (exclude): omega_x: 1 readings lie up to",
                "outlier: 1 of 501 samples of omega_x left out",
            ],
        ),
        row(
            "T13",
            "one spike, kept",
            |b| b.spoil(|s| s.set(77, "omega_x", 0.5)),
            1,
            &[
                "outlier (report): omega_x: 1 readings lie up to",
                "contradicts the data; no number is given",
            ],
        )
        .more(&["--policy", "outlier=report"]),
        row(
            "T13",
            "one spike, strict",
            |b| b.spoil(|s| s.set(77, "omega_x", 0.5)),
            2,
            &[
                "E0220 t.csv: channel 'omega_x': outlier: 1 readings lie up to",
                "accept it by --policy outlier=exclude (without --strict)",
            ],
        )
        .more(&["--strict"]),
        row(
            "T13",
            "5 % spikes",
            |b| b.spoil(|s| s.map("omega_x", |n, w| if n % 20 == 3 { w + 0.1 } else { w })),
            0,
            &["outlier: 25 of 501 samples of omega_x left out"],
        ),
        row(
            "T13",
            "40 % spikes",
            |b| {
                b.spoil(|s| {
                    s.map(
                        "omega",
                        |n, w| if noise(n) > 0.2 { w + noise(n + 7) } else { w },
                    )
                })
            },
            1,
            &["samples"],
        )
        .never(&["every number asked for is determined"]),
        row(
            "T14",
            "wheel 2 hangs at a speed",
            |b| {
                b.spoil(|s| {
                    let x = s.get(200, "wheel2_rad_s");
                    (200..400).for_each(|k| s.set(k, "wheel2_rad_s", x));
                })
            },
            1,
            &["rejected"],
        ),
        row(
            "T14",
            "wheel 1 reads zero",
            |b| b.spoil(|s| s.map("wheel1", |_, _| 0.0)),
            1,
            &["times the declared noise"],
        ),
        row(
            "T15",
            "a gyro bias that the model does not have",
            |b| b.spoil(|s| s.map("omega_x", |_, w| w + 1e-3)),
            0,
            &[
                "a bias of the gyro would explain",
                "the covariance is not trustworthy",
            ],
        ),
        row(
            "T15",
            "noise ten times as declared",
            |b| b.spoil(|s| s.map("omega", |n, w| w + 1e-3 * noise(n))),
            0,
            &["the covariance is not trustworthy"],
        ),
    ]
}

fn still(b: &Bench) {
    b.spoil(|s| {
        s.map("omega", |_, _| 0.0);
        s.map("wheel", |_, _| 0.0);
        let first: Vec<f64> = QUATERNION.iter().map(|c| s.get(0, c)).collect();
        for (c, q) in QUATERNION.iter().zip(first) {
            s.map(c, |_, _| q);
        }
    });
}

fn collinear(b: &Bench) {
    b.write(
        "case.toml",
        crate::bench::CASE
            .replace(
                "angular_N_m_s = [0.2, -0.3, 0.25]",
                "angular_N_m_s = [0.0, 0.0, 0.0]",
            )
            .replace("momentum_zero = false", "")
            .replace(
                "q_xyzw = [0.1, -0.2, 0.05, 0.9733961166965892]",
                "q_xyzw = [0.0, 0.0, 0.0, 1.0]",
            )
            .replace(
                "[0.0, 150.0, 60.0, -120.0, 0.0]",
                "[0.0, 0.0, 0.0, 0.0, 0.0]",
            )
            .replace("[20.0, -100.0, 130.0, -50.0]", "[0.0, 0.0, 0.0, 0.0]")
            .replace("[-30.0, 90.0, -110.0, 40.0]", "[0.0, 90.0, -110.0, 40.0]"),
    );
    b.write(
        "truth.toml",
        crate::bench::truth().replace(
            "xy = 0.085, xz = 0.133, yz = 0.5896",
            "xy = 0.0, xz = 0.0, yz = 0.0",
        ),
    );
    let done = b.run(&["simulate", "case.toml", "--out", "sim"]);
    assert_eq!(done.exit, 0, "{}", done.stderr);
}

fn motions() -> Vec<Row> {
    vec![
        row("T16", "nothing moves", still, 1, &["not"]).never(&["every number"]),
        row(
            "T17",
            "it turns about one axis only",
            collinear,
            1,
            &["not identifiable from these data"],
        )
        .run(&[
            "identify",
            "--model",
            "m.toml",
            "--telemetry",
            "sim/telemetry.csv",
            "--out",
            "out",
        ]),
        row(
            "T18",
            "mass asked for, and no force acts",
            |b| b.model("estimate = [\"inertia\"]", "estimate = true"),
            1,
            &[
                "mass not identifiable",
                "part of what was asked for is determined",
            ],
        ),
        row(
            "T19",
            "one sample",
            |b| b.spoil(|s| s.rows.truncate(1)),
            2,
            &["E0303 t.csv: 1 samples have all needed channels at one time; at least 2 are needed"],
        ),
        row(
            "T19",
            "two samples",
            |b| b.spoil(|s| s.rows.truncate(2)),
            1,
            &["not"],
        )
        .never(&["every number"]),
        row(
            "T19",
            "header only",
            |b| b.spoil(|s| s.rows.clear()),
            2,
            &["E0217 t.csv: no data rows after the header; give a file with samples"],
        ),
        row(
            "T19",
            "empty file",
            |b| b.write("t.csv", ""),
            2,
            &["E0205 t.csv: the file is empty; a header row is needed"],
        ),
        row(
            "T19",
            "comments only",
            |b| b.write("t.csv", "# nothing\n# here\n"),
            2,
            &["E0207 t.csv: no column 'time_s'"],
        ),
        row(
            "T20",
            "a constant torque of the surroundings",
            |b| {
                b.spoil(|s| s.map("wheel3", |n, w| w + 8.0 * n as f64 / 5.0));
            },
            1,
            &["torque"],
        ),
        row(
            "T21",
            "the inertia changes in the run",
            |b| {
                b.spoil(|s| {
                    let old = s.clone();
                    for k in 250..s.rows.len() {
                        for w in ["wheel1_rad_s", "wheel2_rad_s", "wheel3_rad_s"] {
                            let x = old.get(250, w) + 0.7 * (old.get(k, w) - old.get(250, w));
                            s.set(k, w, x);
                        }
                    }
                })
            },
            1,
            &["rejected"],
        ),
    ]
}
