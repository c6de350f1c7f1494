//! T12 to T15: failing sensors and actuators.

use super::{QUATERNION, noise};
use crate::bad_input::row::{Row, row};

pub fn rows() -> Vec<Row> {
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
                "the sensor is stuck",
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
            &["saturation: ", "the sensor is saturated"],
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
            &["held: 400 of 501 samples of q_x..w left out: each value is repeated 5 times"],
        ),
        row(
            "T12",
            "the gyro is quantised at 1e-4 rad/s",
            |b| b.spoil(|s| s.map("omega", |_, w| (w / 1e-4).round() * 1e-4)),
            0,
            &[": Determined. "],
        ),
        row(
            "T13",
            "one spike",
            |b| b.spoil(|s| s.set(77, "omega_x", 0.5)),
            0,
            &[
                "outlier (exclude): omega_x: 1 samples differ from their neighbours by up to",
                "outlier: 1 of 501 samples of omega_x left out",
            ],
        ),
        row(
            "T13",
            "one spike, kept",
            |b| b.spoil(|s| s.set(77, "omega_x", 0.5)),
            1,
            &[
                "outlier (report): omega_x: 1 samples differ from their neighbours by up to",
                ": Contradicted. ",
            ],
        )
        .more(&["--policy", "outlier=report"]),
        row(
            "T13",
            "one spike, strict",
            |b| b.spoil(|s| s.set(77, "omega_x", 0.5)),
            2,
            &[
                "E0220 t.csv: channel 'omega_x': outlier: 1 samples differ from their neighbours by up to",
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
            "a burst of 20 spikes",
            |b| {
                b.spoil(|s| {
                    s.map("omega_x", |n, w| {
                        if (100..120).contains(&n) {
                            w + noise(n)
                        } else {
                            w
                        }
                    })
                })
            },
            1,
            &[": Contradicted. ", "samples of the gyro (3.6 %)"],
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
        .never(&[": Determined. "]),
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
            1,
            &["a bias of the gyro would explain", "rigid model rejected"],
        ),
        row(
            "T14",
            "a thruster reads 1 N for 10 s and gives no force",
            |b| {
                let sensor = "\n[[sensor]]\nname = \"v\"\ntype = \"velocity\"\nnoise_m_s = 1e-5\n";
                b.write(
                    "m.toml",
                    crate::bad_input::bench::MODEL.to_owned()
                        + sensor
                        + crate::bad_input::codes::THRUSTER,
                );
                b.spoil(|s| {
                    s.header
                        .extend(["v_x", "v_y", "v_z", "thr_N"].map(str::to_owned));
                    for (n, row) in s.rows.iter_mut().enumerate() {
                        let velocity =
                            (0..3).map(|k| format!("{:?}", 0.01 + 1e-5 * noise(3 * n + k)));
                        row.extend(velocity);
                        row.push(
                            if (100..150).contains(&n) {
                                "1.0"
                            } else {
                                "0.0"
                            }
                            .to_owned(),
                        );
                    }
                });
            },
            1,
            &[
                "no force of thr would explain 100 % of the misfit: thr.factor = 0",
                ": Contradicted. ",
                "rigid model rejected",
            ],
        ),
        row(
            "T15",
            "noise that hangs together over 5 s",
            |b| {
                b.spoil(|s| {
                    // Correlated noise: weights decay by exp(-0.2 s / 5 s) per sample.
                    for (k, axis) in ["omega_x", "omega_y", "omega_z"].into_iter().enumerate() {
                        let mut drift = 0.0;
                        for n in 0..s.rows.len() {
                            drift = 0.96 * drift + noise(1000 * k + n);
                            let rate = s.get(n, axis) + 1e-4 * drift;
                            s.set(n, axis, format!("{rate:?}"));
                        }
                    }
                })
            },
            1,
            &["residual of the gyro is", "correlated in time"],
        ),
        row(
            "T15",
            "noise ten times as declared",
            |b| b.spoil(|s| s.map("omega", |n, w| w + 1e-3 * noise(n))),
            1,
            &["the covariance is not trustworthy"],
        ),
    ]
}
