//! T2 to T6: gaps, times, lags.

use super::{drop_rows, noise};
use crate::bad_input::row::{Row, row};

pub fn rows() -> Vec<Row> {
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
            &[": Determined. "],
        ),
        row(
            "T2",
            "half of the record lost",
            |b| b.spoil(|s| (100..400).for_each(|k| s.set(k, "wheel2_rad_s", ""))),
            1,
            &["samples of a segment were left out; check the repairs"],
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
                "E0208 t.csv:8 column 'time_s': time 1 s is already in row 7 with another value of 'omega_x'; keep one of the rows",
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
                b.write("m.toml", crate::bad_input::bench::MODEL.to_owned() + "\n[telemetry.columns]\ntime_s = { column = \"time_s\", unit = \"ms\" }\n");
            },
            2,
            &["E0208", "time goes back from"],
        ),
        row(
            "T4",
            "a leap second: the clock counts one second twice",
            |b| b.spoil(|s| s.map("time_s", |n, t| if n >= 250 { t - 1.0 } else { t })),
            2,
            &["E0208 t.csv:252 column 'time_s': time goes back from 49.8 s (row 251) to 49 s"],
        ),
        row(
            "T4",
            "times start anew after a restart",
            |b| b.spoil(|s| s.map("time_s", |n, t| if n >= 250 { t - 50.0 } else { t })),
            2,
            &["E0208 t.csv:252 column 'time_s': time goes back from"],
        ),
        row(
            "T4",
            "two runs in one file, a day apart",
            |b| b.spoil(|s| s.map("time_s", |n, t| if n >= 250 { t + 86400.0 } else { t })),
            2,
            &[
                "E0208 t.csv:252 column 'time_s': time jumps from 49.8 s (row 251) to 86450 s in a record of 99.8",
                "these are several runs; choose one by --time-s or [telemetry] where, or give each as a segment",
            ],
        ),
        row(
            "T4",
            "one of them taken",
            |b| b.spoil(|s| s.map("time_s", |n, t| if n >= 250 { t + 86400.0 } else { t })),
            0,
            &["251 of 501 rows selected by --time-s and --every"],
        )
        .more(&["--time-s", "86000,90000"]),
        row(
            "T4",
            "the last time is 1e308 s",
            |b| b.spoil(|s| s.set(500, "time_s", "1e308")),
            2,
            &["E0208 t.csv:502 column 'time_s': time jumps from 99.8 s (row 501) to 1e308 s"],
        ),
        row(
            "T5",
            "ms read as s",
            |b| b.spoil(|s| s.map("time_s", |_, t| t * 1e3)),
            2,
            &[
                "E0215 attitude 'q_x..q_w' and gyro 'omega_x..z' contradict",
                "times in ms used as s",
            ],
        ),
        row(
            "T5",
            "ns read as s",
            |b| b.spoil(|s| s.map("time_s", |_, t| t * 1e9)),
            2,
            &[
                "E0209 t.csv column 'time_s': the median step is 2e8 s",
                "its unit is likely ns",
            ],
        ),
        row(
            "T5",
            "days",
            |b| b.spoil(|s| s.map("time_s", |_, t| t / 86400.0)),
            2,
            &["E0209", "its unit is likely d"],
        ),
        row(
            "T6",
            "the gyro's clock runs 1 % fast",
            |b| {
                let mut gyro = crate::bad_input::bench::sheet();
                gyro.without("q_");
                gyro.without("wheel");
                gyro.map("time_s", |_, t| 1.01 * t);
                b.write("u.csv", gyro.text());
                b.spoil(|s| s.without("omega"));
            },
            1,
            &[
                "a lag of the gyro would explain",
                "residual of the gyro is",
                "and correlated in time",
            ],
        )
        .run(crate::bad_input::codes::TWO),
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
            1,
            &["a lag of the gyro"],
        ),
    ]
}
