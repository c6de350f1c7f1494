//! T1: content of the cells.

use crate::bad_input::row::{Row, row};

pub fn rows() -> Vec<Row> {
    vec![
        row("T0", "nothing: the good telemetry", |_| {}, 0, &[": Determined. "]),
        row("T1", "empty cells", |b| b.spoil(|s| (10..20).for_each(|k| s.set(k, "omega_y", ""))), 0,
            &[": Determined. "]),
        row("T1", "NaN in 3 cells", |b| b.spoil(|s| (10..13).for_each(|k| s.set(k, "omega_y", "NaN"))), 0,
            &["3 NaN cells treated as missing samples (this is the first)"]),
        row("T1", "the same, strict", |b| b.spoil(|s| (10..13).for_each(|k| s.set(k, "omega_y", "NaN"))), 2,
            &["E0218 t.csv:12 column 'omega_y': 3 NaN cells treated as missing samples: --strict allows no repair; correct the file or leave out --strict"])
            .more(&["--strict"]),
        row("T1", "NaN everywhere in the gyro", |b| b.spoil(|s| s.map("omega", |_, _| f64::NAN)), 2,
            &["E0301 t.csv: no channel 'omega_x omega_y omega_z'"]),
        row("T1", "NaN in every cell", |b| b.spoil(|s| s.map("", |_, _| f64::NAN)), 2,
            &["E0208 t.csv:2 column 'time_s': the row has no time"]),
        row("T1", "Inf", |b| b.spoil(|s| s.set(7, "omega_x", "inf")), 2,
            &["E0203 t.csv:9 column 'omega_x': 'inf' is infinite; write a number, or leave the cell empty where there is no sample"]),
        row("T1", "'null'", |b| b.spoil(|s| s.set(7, "omega_x", "null")), 2,
            &["E0203 t.csv:9 column 'omega_x': 'null' is not a number; write a number, or leave the cell empty where there is no sample"]),
        row("T1", "'-'", |b| b.spoil(|s| s.set(7, "omega_x", "-")), 2, &["'-' is not a number; write a number, or leave the cell empty"]),
        row("T1", "'#N/A'", |b| b.spoil(|s| s.set(7, "omega_x", "#N/A")), 2, &["'#N/A' is not a number; write a number, or leave the cell empty"]),
        row("T1", "sentinel -9999 in the gyro", |b| b.spoil(|s| (0..500).step_by(50).for_each(|k| s.set(k, "omega_x", -9999.0))), 2,
            &["E0306 t.csv: channel 'omega_x': -9999 at t = 0 s", "correct the unit, or leave the cell empty where there is no sample"]),
        row("T1", "sentinel 0.5 in 2 % of the gyro", |b| b.spoil(|s| (0..500).step_by(50).for_each(|k| s.set(k, "omega_x", 0.5))), 1,
            &["placeholder (report): omega_x: 0.5 occurs in 10 samples"]),
        row("T1", "the same, left out by policy", |b| b.spoil(|s| (0..500).step_by(50).for_each(|k| s.set(k, "omega_x", 0.5))), 0,
            &["placeholder: 10 of 501 samples of omega_x left out", ": Determined. "])
            .more(&["--policy", "placeholder=exclude"]),
        row("T1", "1e30 in a wheel speed", |b| b.spoil(|s| s.set(3, "wheel1_rad_s", "1e30")), 2,
            &["E0306 t.csv: channel 'wheel1_rad_s': 1e30 at t = 0.6", "beyond 1e5 rad/s"]),
        row("T1", "1e300 in the gyro", |b| b.spoil(|s| s.map("omega", |_, x| x * 1e300)), 2, &["E0306 t.csv: channel 'omega_x'"]),
        row("T1", "denormal numbers in the gyro", |b| b.spoil(|s| s.map("omega", |_, x| x * 1e-310)), 1,
            &["residual of the gyro"]).never(&[": Determined. "]),
        row("T1", "denormal numbers in gyro and wheels, the attitude at rest", |b| b.spoil(|s| { s.map("omega", |_, _| 5e-324); s.map("wheel", |_, _| 5e-324); s.map("q_", |_, _| 0.5); }), 1,
            &[": Not determined. "]),
        row("T1", "1e300 in every cell but the time", |b| b.spoil(|s| { s.map("omega", |_, _| 1e300); s.map("wheel", |_, _| 1e300); s.map("q_", |_, _| 1e300); }), 2, &["E0"]),
    ]
}
