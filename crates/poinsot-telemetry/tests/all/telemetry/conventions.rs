//! A tumbling body under every wrong convention: each must be detected and named.

use crate::telemetry::Folder;
use poinsot_telemetry::{
    Change, Channel, ConventionTest, Mounting, ReadOptions, Repair, Table, TelemetryMap, Verdict,
    check_conventions, convention_tests, mount, read, write,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// Torque-free tumbling of a body with moments 1, 2, 3 kg m2, integrated by small Runge-Kutta steps: (q xyzw, omega).
fn tumble(n: usize, dt: f64, rate: f64) -> Vec<([f64; 4], [f64; 3])> {
    let derivative = |s: [f64; 7]| {
        let [x, y, z, w, a, b, c] = s;
        [
            0.5 * (w * a + y * c - z * b),
            0.5 * (w * b + z * a - x * c),
            0.5 * (w * c + x * b - y * a),
            0.5 * (-x * a - y * b - z * c),
            (2.0 - 3.0) * b * c / 1.0,
            (3.0 - 1.0) * c * a / 2.0,
            (1.0 - 2.0) * a * b / 3.0,
        ]
    };
    let plus = |s: [f64; 7], k: [f64; 7], h: f64| std::array::from_fn(|i| s[i] + h * k[i]);
    let mut s = [0.3, -0.5, 0.1, 0.65_f64.sqrt(), 0.4, 0.9, 0.3].map(|x: f64| x);
    for x in &mut s[4..] {
        *x *= rate;
    }
    let fine = 10;
    let h = dt / f64::from(fine);
    let mut rows = Vec::new();
    for _ in 0..n {
        let norm = s[..4].iter().map(|x| x * x).sum::<f64>().sqrt();
        rows.push(([0, 1, 2, 3].map(|k| s[k] / norm), [s[4], s[5], s[6]]));
        for _ in 0..fine {
            let k1 = derivative(s);
            let k2 = derivative(plus(s, k1, h / 2.0));
            let k3 = derivative(plus(s, k2, h / 2.0));
            let k4 = derivative(plus(s, k3, h));
            s = std::array::from_fn(|i| {
                s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
            });
        }
    }
    rows
}

fn table(rows: &[([f64; 4], [f64; 3])], dt: f64) -> Table {
    let time_s: std::sync::Arc<[f64]> = (0..rows.len()).map(|k| k as f64 * dt).collect();
    let channel = |name: &str, unit: &str, values: Vec<f64>| Channel {
        name: name.into(),
        unit: unit.into(),
        time_s: time_s.clone(),
        values,
        ..Channel::default()
    };
    let q = ["q_x", "q_y", "q_z", "q_w"].into_iter().enumerate();
    let w = ["omega_x", "omega_y", "omega_z"].into_iter().enumerate();
    let q = q.map(|(k, name)| channel(name, "1", rows.iter().map(|r| r.0[k]).collect()));
    let w = w.map(|(k, name)| channel(name, "rad/s", rows.iter().map(|r| r.1[k]).collect()));
    Table {
        channels: q.chain(w).collect(),
        ..Table::default()
    }
}

fn noisy(rows: &mut [([f64; 4], [f64; 3])], attitude: f64, gyro: f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let normal = Normal::new(0.0, 1.0).unwrap();
    for (q, w) in rows {
        for x in q.iter_mut() {
            *x += 0.5 * attitude * normal.sample(&mut rng);
        }
        let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        q.iter_mut().for_each(|x| *x /= norm);
        w.iter_mut()
            .for_each(|x| *x += gyro * normal.sample(&mut rng));
    }
}

fn told(change: impl Fn([f64; 4], [f64; 3]) -> ([f64; 4], [f64; 3])) -> ConventionTest {
    let mut rows = tumble(1200, 0.05, 0.2);
    noisy(&mut rows, 1e-4, 1e-4);
    for (q, w) in &mut rows {
        (*q, *w) = change(*q, *w);
    }
    convention_tests(&table(&rows, 0.05)).remove(0)
}

fn conjugate([x, y, z, w]: [f64; 4]) -> [f64; 4] {
    [-x, -y, -z, w]
}

#[test]
fn exact_the_declared_convention_fits_and_only_it() {
    let test = told(|q, w| (q, w));
    assert_eq!(test.verdict, Verdict::DeclaredFits);
    // Scalar first and inverse gives equal rates in axes rotated by 180 deg about (1, 0, 1): data cannot distinguish
    // them, and the simpler one is kept.
    assert_eq!(test.good.len(), 1, "{test}");
    assert!(test.good[0].is_declared(), "{test}");
    assert!((test.scale.unwrap() - 1.0).abs() < 1e-3);
    assert_eq!(
        test.readings.len(),
        4 + 8,
        "eight conventions are four readings, and the gyro has eight other units"
    );
    assert!(test.readings[0].residual < 1e-3, "{test}");
}

/// At slow spin a bias of the gyro can look like exchanged axes; a motion that changes tells them apart.
#[test]
fn exact_a_gyro_bias_is_no_convention() {
    let mut rows = tumble(1200, 0.1, 2e-4);
    noisy(&mut rows, 1e-6, 1e-6);
    for (_, [x, y, _]) in &mut rows {
        (*x, *y) = (*x + 1e-4, *y - 1e-4);
    }
    let test = convention_tests(&table(&rows, 0.1)).remove(0);
    let of_bias =
        matches!(&test.verdict, Verdict::Undecided { reason } if reason.contains("gyro bias"));
    assert!(of_bias, "{test}");
    assert!(check_conventions(&table(&rows, 0.1)).is_ok());
    assert!(told(|q, [x, y, z]| (q, [y, x, z])).is_contradicted());
}

/// A body that makes up to three turns between two attitudes, and a sixth of one between two samples of the gyro.
#[test]
fn prop_attitudes_a_turn_apart_are_compared_by_the_rotation_of_the_gyro() {
    for rate in 1..=20 {
        for every in [1, 4, 10, 17] {
            let mut rows = tumble(1200, 0.05, f64::from(rate));
            noisy(&mut rows, 1e-3, 1e-3);
            let said = |read: fn([f64; 3]) -> [f64; 3]| {
                let rows: Vec<_> = rows.iter().map(|(q, w)| (*q, read(*w))).collect();
                let slow: Vec<_> = rows.iter().step_by(every).copied().collect();
                let mut both = table(&slow, 0.05 * every as f64);
                both.channels.truncate(4);
                both.channels
                    .extend(table(&rows, 0.05).channels.into_iter().skip(4));
                convention_tests(&both).remove(0)
            };
            let right = said(|w| w);
            let case = format!("{rate} rad/s, every {every}");
            assert_eq!(right.verdict, Verdict::DeclaredFits, "{case}: {right}");
            // Faster, the gyro is too coarse to tell which axes: 0.6 rad between two samples.
            if rate > 12 {
                continue;
            }
            let wrong = [
                (said(|[x, y, z]| [z, x, y]), "(y, z, x)"),
                (said(|[x, y, z]| [x, -y, z]), "(x, -y, z)"),
                (said(|[x, y, z]| [y, x, z]), "(y, x, z)"),
            ];
            for (wrong, words) in wrong {
                assert!(wrong.is_contradicted(), "{case}: {wrong}");
                assert!(wrong.good[0].words.contains(words), "{case}: {wrong}");
            }
        }
    }
}

#[test]
fn exact_every_wrong_convention_is_named() {
    let deg = 180.0 / std::f64::consts::PI;
    type Change = fn([f64; 4], [f64; 3]) -> ([f64; 4], [f64; 3]);
    let scalar_first: Change = |[x, y, z, w], rate| ([w, x, y, z], rate);
    let cases: [(Change, &str); 11] = [
        (scalar_first, "quaternion scalar first (wxyz)"),
        (
            |q, w| (conjugate(q), w),
            "quaternion inertial to body (or body to inertial in JPL algebra)",
        ),
        (
            |q, rate| {
                let [x, y, z, w] = conjugate(q);
                ([w, x, y, z], rate)
            },
            "quaternion scalar first (wxyz), quaternion inertial to body (or body to inertial in JPL algebra)",
        ),
        (|q, w| (q, w.map(f64::to_degrees)), "gyro in deg/s"),
        (
            |q, w| (q, w.map(|x| x * 30.0 / std::f64::consts::PI)),
            "gyro in rpm",
        ),
        (
            |q, w| (q, w.map(f64::to_radians)),
            "gyro in rad/s (it is mapped as deg/s)",
        ),
        (
            |q, [x, y, z]| (q, [x, -y, z]),
            "body rates = gyro (x, -y, z)",
        ),
        (
            |q, [x, y, z]| (q, [y, x, -z]),
            "body rates = gyro (y, x, -z)",
        ),
        (
            |[x, y, z, w], rate| ([w, x, y, z], rate.map(f64::to_degrees)),
            "quaternion scalar first (wxyz), gyro in deg/s",
        ),
        (
            |q, rate| (q, rate.map(|w| 0.05 * w)),
            "angles since the sample before in the columns of the gyro (increments = true)",
        ),
        (
            |[x, y, z, w], rate| {
                let attitude =
                    nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z));
                (
                    [x, y, z, w],
                    (attitude * nalgebra::Vector3::from(rate)).into(),
                )
            },
            "gyro in inertial axes, not in body axes",
        ),
    ];
    for (change, name) in cases {
        let test = told(change);
        assert_eq!(
            test.verdict,
            Verdict::DeclaredContradicted,
            "{name}: {test}"
        );
        assert_eq!(test.good[0].words, name);
        assert!(test.good[0].residual < 1e-3);
    }
    let test = told(|q, w| (q, w.map(f64::to_degrees)));
    assert!((test.scale.unwrap() * deg - 1.0).abs() < 1e-3);
}

#[test]
fn unit_the_error_names_both_residuals() {
    let mut rows = tumble(400, 0.05, 0.2);
    rows.iter_mut().for_each(|(q, _)| *q = conjugate(*q));
    let message = check_conventions(&table(&rows, 0.05))
        .unwrap_err()
        .to_string();
    assert!(
        message.starts_with(
            "E0215 attitude 'q_x..q_w' and gyro 'omega_x..z' are inconsistent with the declared xyzw, Hamilton, body to inertial, gyro in rad/s and body axes: residual "
        ) && message.ends_with(
            " rad/s with quaternion inertial to body (or body to inertial in JPL algebra); correct the map or the file"
        ),
        "{message}"
    );
    let folder = Folder::new();
    let path = folder.path("a.parquet");
    write(&path, &table(&rows, 0.05).channels).unwrap();
    let options = ReadOptions {
        check_conventions: true,
        ..ReadOptions::default()
    };
    assert_eq!(read(&[&path], &options).unwrap_err().code(), "E0215");
}

#[test]
fn stat_motion_below_the_noise_decides_nothing() {
    let mut rows = tumble(1200, 0.05, 1e-6);
    noisy(&mut rows, 1e-4, 1e-4);
    rows.iter_mut().for_each(|(q, _)| *q = conjugate(*q));
    let test = convention_tests(&table(&rows, 0.05)).remove(0);
    assert!(
        matches!(&test.verdict, Verdict::Undecided { reason } if reason.contains("too small")),
        "{test}"
    );
    let still = vec![([0.0, 0.0, 0.0, 1.0], [0.0; 3]); 100];
    let test = convention_tests(&table(&still, 0.05)).remove(0);
    assert!(matches!(test.verdict, Verdict::Undecided { .. }));
    assert!(check_conventions(&table(&still, 0.05)).is_ok());
}

#[test]
fn unit_a_spin_about_one_axis_says_what_it_cannot_tell() {
    let spin = |sign: f64| -> Vec<_> {
        (0..600)
            .map(|k| {
                let half = 0.5 * 0.3 * f64::from(k) * 0.05;
                ([0.0, 0.0, sign * half.sin(), half.cos()], [0.0, 0.0, 0.3])
            })
            .collect()
    };
    let test = convention_tests(&table(&spin(1.0), 0.05)).remove(0);
    assert_eq!(test.verdict, Verdict::DeclaredFits);
    assert!(test.good.len() > 1);
    let test = convention_tests(&table(&spin(-1.0), 0.05)).remove(0);
    assert_eq!(test.verdict, Verdict::DeclaredContradicted);
    assert!(
        test.good[0]
            .words
            .starts_with("quaternion inertial to body"),
        "{test}"
    );
    let others: Vec<&str> = test.good[1..].iter().map(|h| h.words.as_str()).collect();
    assert!(
        others.contains(&"body rates = gyro (x, y, -z)"),
        "{others:?}"
    );
}

#[test]
fn unit_a_turned_gyro_fits_with_its_mounting() {
    let mut rows = tumble(400, 0.05, 0.2);
    // The gyro is rotated by 90 deg about z: its x axis is along body y.
    rows.iter_mut().for_each(|(_, w)| *w = [w[1], -w[0], w[2]]);
    let mut table = table(&rows, 0.05);
    assert!(check_conventions(&table).is_err());
    let mounting = Mounting {
        sensor: "gyro".into(),
        unnamed: true,
        prefix: "omega",
        R_BS: [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    };
    mount(&mut table, &[mounting]);
    let test = convention_tests(&table).remove(0);
    assert!(!test.is_contradicted());
    assert_eq!(test.verdict, Verdict::DeclaredFits);
}

#[test]
fn unit_the_gyro_is_not_averaged_across_its_gaps() {
    let whole = table(&tumble(1200, 0.05, 0.2), 0.05);
    let mut gapped = whole.clone();
    for c in gapped
        .channels
        .iter_mut()
        .filter(|c| c.name.starts_with("omega"))
    {
        let there = |k: &usize| !(*k > 300 && k % 100 < 5);
        let kept: Vec<usize> = (0..c.values.len()).filter(there).collect();
        c.time_s = kept.iter().map(|k| c.time_s[*k]).collect();
        c.values = kept.iter().map(|k| c.values[*k]).collect();
    }
    let [whole, gapped] = [whole, gapped].map(|t| convention_tests(&t).remove(0));
    assert!(
        gapped.intervals + 9 <= whole.intervals,
        "{} {}",
        gapped.intervals,
        whole.intervals
    );
    assert_eq!(gapped.verdict, Verdict::DeclaredFits);
}

/// Times too large by a factor of 1000 reduce the attitude rates to 1/1000 of the gyro's.
#[test]
fn exact_times_in_another_unit_are_told_by_their_factor() {
    let rows = tumble(400, 0.05, 0.2);
    for (step, says) in [
        (50.0, "times in ms used as s"),
        (5.0e-5, "times in s used as ms"),
    ] {
        let message = check_conventions(&table(&rows, step))
            .unwrap_err()
            .to_string();
        assert!(message.starts_with("E0215"), "{message}");
        assert!(message.contains(says), "{message}");
    }
}

/// A sun at rest in inertial axes, seen with two axes exchanged.
#[test]
fn exact_exchanged_axes_of_a_direction_are_named() {
    let rows = tumble(400, 0.05, 0.2);
    let seen = |order: [usize; 3]| {
        let mut table = table(&rows, 0.05);
        let time_s = table.channels[0].time_s.clone();
        let sun = |([x, y, z, w], _): &([f64; 4], [f64; 3])| {
            let attitude =
                nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(*w, *x, *y, *z));
            let s: [f64; 3] =
                (attitude.inverse() * nalgebra::Vector3::new(0.6, 0.64, -0.48)).into();
            order.map(|k| s[k])
        };
        let all: Vec<[f64; 3]> = rows.iter().map(sun).collect();
        for (k, name) in ["direction_x", "direction_y", "direction_z"]
            .into_iter()
            .enumerate()
        {
            table.channels.push(Channel {
                name: name.to_owned(),
                sensor: "sun".to_owned(),
                unit: "1".to_owned(),
                time_s: time_s.clone(),
                values: all.iter().map(|s| s[k]).collect(),
                ..Channel::default()
            });
        }
        check_conventions(&table)
    };
    assert!(seen([0, 1, 2]).is_ok());
    let message = seen([0, 2, 1]).unwrap_err().to_string();
    assert!(
        message.ends_with("body axes = sensor (x, z, y); correct the map or the file"),
        "{message}"
    );
}

/// What the first way of a contradiction declares, and whether the file then reads without one.
fn put_right(table: &Table) -> (Vec<String>, bool) {
    let mut found = convention_tests(table).into_iter();
    let ways = found.find(ConventionTest::is_contradicted).unwrap().ways();
    let mut map = TelemetryMap::default();
    let lines = ways[0].iter().map(|r| r.declare(&mut map).unwrap());
    let lines = lines.collect::<Vec<_>>().concat();
    let lines = lines.into_iter().map(|line| line.text).collect();
    let folder = Folder::new();
    let path = folder.path("a.parquet");
    write(&path, &table.channels).unwrap();
    let options = ReadOptions {
        map,
        check_conventions: true,
        ..ReadOptions::default()
    };
    let reads = read(&[&path], &options);
    (lines, reads.inspect_err(|e| println!("{e}")).is_ok())
}

/// The lines of the first way are those of a map with which the file is right.
#[test]
fn exact_proposed_lines_put_every_convention_right() {
    type Spoil = fn([f64; 4], [f64; 3]) -> ([f64; 4], [f64; 3]);
    let cases: [(Spoil, &[&str]); 7] = [
        (
            |[x, y, z, w], rate| ([w, x, y, z], rate),
            &[r#"attitude = [{ order = "wxyz", quaternion = ["q_x", "q_y", "q_z", "q_w"] }]"#],
        ),
        (
            |q, w| (conjugate(q), w),
            &[
                r#"attitude = [{ quaternion = ["q_x", "q_y", "q_z", "q_w"], sense = "inertial_to_body" }]"#,
            ],
        ),
        (
            |q, w| (q, w.map(f64::to_degrees)),
            &[r#"omega_x = { column = "omega_x", unit = "deg/s" }"#],
        ),
        (
            |q, w| (q, w.map(|x| x * 30.0 / std::f64::consts::PI)),
            &[r#"omega_x = { column = "omega_x", unit = "rpm" }"#],
        ),
        (
            |q, [x, y, z]| (q, [y, x, -z]),
            &[
                r#"omega_x = { column = "omega_y", unit = "rad/s" }"#,
                r#"omega_z = { column = "omega_z", sign = -1.0, unit = "rad/s" }"#,
            ],
        ),
        (
            |[x, y, z, w], rate| ([w, x, y, z], rate.map(f64::to_degrees)),
            &[r#"omega_z = { column = "omega_z", unit = "deg/s" }"#],
        ),
        (
            |q, rate| (q, rate.map(|w| 0.05 * w)),
            &[r#"omega_x = { column = "omega_x", increments = true, unit = "rad" }"#],
        ),
    ];
    for (spoil, wanted) in cases {
        let mut rows = tumble(1200, 0.05, 0.2);
        rows.iter_mut().for_each(|(q, w)| (*q, *w) = spoil(*q, *w));
        let (lines, reads) = put_right(&table(&rows, 0.05));
        assert!(
            wanted.iter().all(|w| lines.iter().any(|l| l == w)),
            "{lines:?}"
        );
        assert!(reads, "{lines:?}");
    }
    let (lines, reads) = put_right(&table(&tumble(400, 0.05, 0.2), 50.0));
    let time = r#"time = { column = "time_s", format = "number", unit = "ms" }"#;
    assert_eq!(lines, [time]);
    assert!(reads);
}

/// Joints and positions against their rates.
#[test]
fn exact_a_rate_of_another_sign_unit_or_axes_is_named() {
    let time_s: std::sync::Arc<[f64]> = (0..400).map(|k| 0.1 * f64::from(k)).collect();
    let channel = |name: &str, unit: &str, of: &dyn Fn(f64) -> f64| Channel {
        name: name.into(),
        unit: unit.into(),
        time_s: time_s.clone(),
        values: time_s.iter().map(|t| of(*t)).collect(),
        ..Channel::default()
    };
    let joint = |factor: f64, rate: f64| Table {
        channels: vec![
            channel("elbow_rad", "rad", &|t| factor * (0.4 * t).sin()),
            channel("elbow_rad_s", "rad/s", &|t| rate * 0.4 * (0.4 * t).cos()),
        ],
        ..Table::default()
    };
    assert!(check_conventions(&joint(1.0, 1.0)).is_ok());
    assert!(check_conventions(&joint(1.0, 1.3)).is_ok());
    let (lines, reads) = put_right(&joint(1.0, -1.0));
    assert_eq!(
        lines,
        [r#"elbow_rad_s = { column = "elbow_rad_s", sign = -1.0, unit = "rad/s" }"#]
    );
    assert!(reads);
    let (lines, reads) = put_right(&joint(1.0, 1.0_f64.to_degrees()));
    assert_eq!(
        lines,
        [r#"elbow_rad_s = { column = "elbow_rad_s", unit = "deg/s" }"#]
    );
    assert!(reads);
    let (lines, reads) = put_right(&joint(1.0_f64.to_degrees(), 1.0));
    assert_eq!(
        lines,
        [r#"elbow_rad = { column = "elbow_rad", unit = "deg" }"#]
    );
    assert!(reads);
    let place = [0.3_f64, 0.5, 0.8];
    let axes = ["x", "y", "z"];
    let mut all: Vec<Channel> = Vec::new();
    for (k, w) in place.into_iter().enumerate() {
        all.push(channel(&format!("r_{}", axes[k]), "m", &|t| {
            9.0 * (w * t).sin()
        }));
        let seen = axes[(k + 1) % 3];
        all.push(channel(&format!("v_{seen}"), "m/s", &|t| {
            9.0 * w * (w * t).cos()
        }));
    }
    let (lines, reads) = put_right(&Table {
        channels: all,
        ..Table::default()
    });
    assert_eq!(lines[0], r#"v_x = { column = "v_y", unit = "m/s" }"#);
    assert!(reads);
}

/// A change joins what the map already says of a column.
#[test]
fn exact_a_change_of_a_mapped_column_keeps_its_keys() {
    let mut map: TelemetryMap = TelemetryMap::default();
    map.all.columns.push(poinsot_telemetry::ColumnMap {
        sign: Some(-1.0),
        scale: Some(2.0),
        offset: Some(30.0),
        ..poinsot_telemetry::ColumnMap::new("elbow_rad", "E", "deg")
    });
    let mut lines = |change| {
        Repair::of("elbow_rad", change)
            .declare(&mut map)
            .unwrap()
            .remove(0)
            .text
    };
    assert_eq!(
        lines(Change::Factor(-1.5)),
        r#"elbow_rad = { column = "E", offset = 45.0, scale = 3.0, sign = 1.0, unit = "deg" }"#
    );
    assert_eq!(
        lines(Change::Offset(std::f64::consts::PI)),
        r#"elbow_rad = { column = "E", offset = 225.0, scale = 3.0, sign = 1.0, unit = "deg" }"#
    );
    assert_eq!(
        lines(Change::WrapsAt(std::f64::consts::TAU)),
        r#"elbow_rad = { column = "E", offset = 225.0, scale = 3.0, sign = 1.0, unit = "deg", wraps_at = 120.0 }"#
    );
}
