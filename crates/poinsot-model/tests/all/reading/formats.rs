//! Every form of a column that a map describes: the example of its row in docs/reference/telemetry.md, and what it means.

use poinsot_model::{describe_map, parse_telemetry_map};
use poinsot_telemetry::{Part, ReadOptions, Table, read_parts};
use std::f64::consts::{PI, TAU};

fn table(map: &str, text: &str) -> Result<Table, String> {
    let map = parse_telemetry_map(map, "map.toml").map_err(|e| e.to_string())?;
    assert!(!describe_map(&map).is_empty());
    let options = ReadOptions {
        map,
        ..ReadOptions::default()
    };
    let part = Part::bytes("run.csv", text.into());
    read_parts(&[part], &options).map_err(|e| e.to_string())
}

#[track_caller]
fn is(map: &str, text: &str, channel: &str, times: &[f64], values: &[f64]) {
    let table = table(map, text).unwrap_or_else(|e| panic!("{e}"));
    let found = table
        .channel(channel)
        .unwrap_or_else(|| panic!("no {channel}: {:?}", table.channels));
    assert_eq!(found.values.len(), values.len(), "{found:?}");
    let all = found
        .values
        .iter()
        .zip(values)
        .chain(found.time_s.iter().zip(times));
    for (a, b) in all {
        assert!((a - b).abs() < 1.0e-12, "{found:?}");
    }
}

/// Attitude of the last row.
fn attitude(map: &str, text: &str) -> [f64; 4] {
    let table = table(map, text).unwrap_or_else(|e| panic!("{e}"));
    ["x", "y", "z", "w"].map(|k| {
        *table
            .channel(&format!("q_{k}"))
            .unwrap()
            .values
            .last()
            .unwrap()
    })
}

#[track_caller]
fn near(found: [f64; 4], expected: [f64; 4]) {
    let along: f64 = found.iter().zip(expected).map(|(a, b)| a * b).sum();
    assert!(
        (along.abs() - 1.0).abs() < 1.0e-12,
        "{found:?} {expected:?}"
    );
}

#[test]
fn exact_files_without_a_header_and_with_one_behind_a_sign() {
    let map = "[telemetry]\nheader_row = 0\ntime = { column = \"1\" }\n[telemetry.columns]\nomega_x = { column = \"3\", unit = \"rad/s\" }\n";
    is(map, "0,7,1\n0.1,7,2\n", "omega_x", &[0.0, 0.1], &[1.0, 2.0]);
    let map = "[telemetry]\nheader_row = 2\ndelimiter = \"space\"\ncomment = \"#\"\n";
    is(
        map,
        "# a log\n# time_s omega_x\n0 1\n# cut\n0.1 2\n",
        "omega_x",
        &[0.0, 0.1],
        &[1.0, 2.0],
    );
    let said = table(
        "[telemetry]\ndelimiter = \",\"\n",
        "# time_s,omega_x\n0,1\n",
    )
    .unwrap_err();
    assert!(said.contains("header_row = 1"), "{said}");
    let said = table("[telemetry]\ndelimiter = \",\"\n", "0,1\n0.1,2\n").unwrap_err();
    assert!(said.contains("header_row = 0"), "{said}");
}

#[test]
fn exact_decimal_commas() {
    let map = "[telemetry]\ndelimiter = \";\"\ndecimal = \",\"\n";
    is(
        map,
        "time_s;omega_x\n0,0;1,5\n0,1;-2,5e-1\n",
        "omega_x",
        &[0.0, 0.1],
        &[1.5, -0.25],
    );
    let said = table(
        "[telemetry]\ndelimiter = \";\"\n",
        "time_s;omega_x\n0;1,5\n",
    )
    .unwrap_err();
    assert!(said.contains("decimal = \",\""), "{said}");
}

#[test]
fn exact_sentinels_integers_and_wraps() {
    let map = "[telemetry.columns]\nomega_x = { column = \"w\", unit = \"rad/s\", invalid = [-999, \"N/A\"] }\n";
    is(
        map,
        "time_s,w\n0,1\n1,-999.0\n2,N/A\n3,2\n",
        "omega_x",
        &[0.0, 3.0],
        &[1.0, 2.0],
    );
    let map = "[telemetry.columns]\nomega_x = { column = \"w\", unit = \"rad/s\", scale = 0.5, signed_range = 65536 }\n";
    is(
        map,
        "time_s,w\n0,3\n1,65535\n2,32768\n",
        "omega_x",
        &[0.0, 1.0, 2.0],
        &[1.5, -0.5, -16384.0],
    );
    let map = "[telemetry.columns]\nj_rad = { column = \"a\", unit = \"deg\", wraps_at = 360 }\n";
    let turns = [350.0, 370.0, 350.0, -10.0].map(f64::to_radians);
    is(
        map,
        "time_s,a\n0,350\n1,10\n2,350\n3,350\n",
        "j_rad",
        &[0.0, 1.0, 2.0, 3.0],
        &[turns[0], turns[1], turns[0], turns[0]],
    );
    let map = "[telemetry.columns]\nj_rad = { column = \"n\", counts_per_revolution = 100, wraps_at = 256 }\n";
    let count = TAU / 100.0;
    is(
        map,
        "time_s,n\n0,250\n1,4\n2,250\n",
        "j_rad",
        &[0.0, 1.0, 2.0],
        &[250.0 * count, 260.0 * count, 250.0 * count],
    );
}

#[test]
fn exact_increments_are_mean_rates_at_the_middle_of_their_intervals() {
    let map =
        "[telemetry.columns]\nomega_x = { column = \"da\", unit = \"rad\", increments = true }\n";
    // The increment of 0.5 s lost those before it.
    let text = "time_s,da\n0,9\n0.1,0.2\n0.2,0.3\n0.5,0.9\n0.6,0.1\n";
    is(map, text, "omega_x", &[0.05, 0.15, 0.55], &[2.0, 3.0, 1.0]);
    let said = table(
        "[telemetry.columns]\nq_x = { column = \"da\", unit = \"1\", increments = true }\n",
        text,
    )
    .unwrap_err();
    assert!(said.contains("only a rate has increments"), "{said}");
}

#[test]
fn exact_one_column_for_two_channels() {
    let map = "[telemetry.columns]\nf2_m = { column = \"f1_m\", unit = \"m\", scale = -2.0, offset = 0.5 }\n";
    let text = "time_s,f1_m\n0,1\n1,2\n";
    is(map, text, "f2_m", &[0.0, 1.0], &[-1.5, -3.5]);
    is(map, text, "f1_m", &[0.0, 1.0], &[1.0, 2.0]);
    let map = "[telemetry.columns]\nf1_m = { column = \"a\", unit = \"m\" }\nf2_m = { column = \"a\", unit = \"m\" }\n";
    let said = table(map, text).unwrap_err();
    assert!(
        said.starts_with("E0210 ") && said.contains("scale"),
        "{said}"
    );
}

#[test]
fn exact_one_row_per_value_in_any_order() {
    let map = "[telemetry]\ntime = { column = \"t\" }\nattitude = [{ quaternion = [{ column = \"v\", where = { k = \"a\" } }, { column = \"v\", where = { k = \"b\" } }, { column = \"v\", where = { k = \"c\" } }, { column = \"v\", where = { k = \"d\" } }] }]\n[telemetry.columns]\nomega_x = { column = \"v\", unit = \"rad/s\", where = { k = \"w\" } }\n";
    let row = |t: u8, k: &str, v: f64| format!("{t},{k},{v}\n");
    // By name, then by time; the rate has samples that the attitude lacks, and a text stands between.
    let mut text = "t,k,v\n0,mode,SAFE\n".to_owned();
    for (k, v) in [("w", 3.0), ("a", 0.0), ("b", 0.0), ("c", 0.6), ("d", 0.8)] {
        text += &row(0, k, v);
        text += &if k == "w" {
            row(1, k, 4.0)
        } else {
            String::new()
        };
        text += &row(2, k, if k == "c" { -v } else { v });
    }
    is(map, &text, "omega_x", &[0.0, 1.0, 2.0], &[3.0, 4.0, 3.0]);
    is(map, &text, "q_z", &[0.0, 2.0], &[0.6, -0.6]);
    is(map, &text, "q_w", &[0.0, 2.0], &[0.8, 0.8]);
    let said = table(map, &(text + &row(2, "w", 5.0))).unwrap_err();
    assert!(
        said.starts_with("E0208 ") && said.contains("another value of 'v'"),
        "{said}"
    );
}

#[test]
fn exact_attitudes_with_signs_offsets_flags_and_three_components() {
    let head = "[telemetry]\nattitude = [";
    let text = "time_s,ra,dec,roll,ok\n0,0,0,0,1\n1,90,30,0,1\n2,5,5,5,0\n";
    // The axis x points to right ascension 90 deg and declination 30 deg: (0, cos 30, sin 30).
    let of_x = "{ euler = [\"ra\", { column = \"dec\", sign = -1 }, \"roll\"], sequence = \"ZYX\", unit = \"deg\", where = { ok = \"1\" } }]\n";
    let x = turned(attitude(&format!("{head}{of_x}"), text), [1.0, 0.0, 0.0]);
    let direction = [0.0, (PI / 6.0).cos(), (PI / 6.0).sin()];
    assert!(
        (0..3).all(|k| (x[k] - direction[k]).abs() < 1.0e-12),
        "{x:?}"
    );
    let of_z = "{ euler = [\"ra\", { column = \"dec\", sign = -1, offset = -90 }, \"roll\"], sequence = \"ZYZ\", unit = \"deg\", where = { ok = \"1\" } }]\n";
    let z = turned(attitude(&format!("{head}{of_z}"), text), [0.0, 0.0, 1.0]);
    assert!(
        (0..3).all(|k| (z[k] - direction[k]).abs() < 1.0e-12),
        "{z:?}"
    );
    let vector =
        "{ quaternion = [\"a\", \"b\", \"c\"], sense = \"inertial_to_body\", invalid = [-9] }]\n";
    let found = attitude(
        &format!("{head}{vector}"),
        "time_s,a,b,c\n0,0,0,0\n1,0,0,0.6\n2,-9,-9,-9\n",
    );
    near(found, [0.0, 0.0, -0.6, 0.8]);
    let long = table(
        &format!("{head}{vector}"),
        "time_s,a,b,c\n0,0,0,0\n1,0,1,0.6\n",
    )
    .unwrap_err();
    assert!(
        long.starts_with("E0214 ") && long.contains("longer than 1"),
        "{long}"
    );
}

/// A vector in inertial axes.
fn turned([x, y, z, w]: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let q = [x, y, z];
    let t = cross(q, v).map(|c| 2.0 * c);
    let u = cross(q, t);
    std::array::from_fn(|k| v[k] + w * t[k] + u[k])
}

#[test]
fn exact_pulses_with_dead_times_and_overlaps() {
    let pulse = |more: &str| {
        format!(
            "[telemetry.columns]\nthr_N = {{ column = \"on\", unit = \"ms\", nominal_N = 2.0{more} }}\n"
        )
    };
    let text = "time_s,on\n0,0\n1,100\n2,5\n3,1000\n3.5,200\n";
    let said = table(&pulse(""), text).unwrap_err();
    assert!(
        said.starts_with("E0208 ") && said.contains("overlap = \"merged\""),
        "{said}"
    );
    is(
        &pulse(", overlap = \"merged\""),
        text,
        "thr_N",
        &[1.0, 1.1, 2.0, 2.005, 3.0, 4.0],
        &[2.0, 0.0, 2.0, 0.0, 2.0, 0.0],
    );
    // A pulse of 5 ms does not open a valve that opens 8 ms late and closes 2 ms late.
    let late = ", overlap = \"replaced\", opens_late_s = 0.008, closes_late_s = 0.002";
    is(
        &pulse(late),
        text,
        "thr_N",
        &[1.008, 1.102, 3.008, 3.702],
        &[2.0, 0.0, 2.0, 0.0],
    );
    let flag = "[telemetry.columns]\nthr_N = { column = \"on\", nominal_N = 2.0, opens_late_s = 0.25, closes_late_s = 0.125 }\n";
    let text = "time_s,on\n0,0\n1,1\n2,1\n3,0\n4,0\n";
    is(flag, text, "thr_N", &[0.0, 1.25, 3.125], &[0.0, 2.0, 0.0]);
    let wrong = "[telemetry.columns]\nomega_x = { column = \"on\", unit = \"rad/s\", opens_late_s = 0.25 }\n";
    assert!(
        table(wrong, text)
            .unwrap_err()
            .contains("only a thruster has a valve")
    );
}

/// A momentum wheel whose momentum is measured, in N m s: the speed of a rotor of 1 kg m2.
#[test]
fn exact_momentum_of_a_wheel() {
    let map =
        "[telemetry.columns]\nwheel1_rad_s = { column = \"h\", unit = \"rad/s\", scale = 20.0 }\n";
    is(
        map,
        "time_s,h\n0,0.5\n1,1\n",
        "wheel1_rad_s",
        &[0.0, 1.0],
        &[10.0, 20.0],
    );
}
