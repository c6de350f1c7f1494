//! Findings of the checks, absence of false findings, and effects of policies.

use crate::telemetry::read_text;
use poinsot_telemetry::checks::{Check, Policies, Policy, apply, findings, refused};
use poinsot_telemetry::{ReadOptions, Table};

/// Pseudo-random noise between -1 and 1.
fn noise(k: usize) -> f64 {
    let x = (k as f64 * 12.9898 + 4.1).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

/// A gyro with an oscillation about x and noise about all axes.
fn gyro(change: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Table {
    let mut text = String::from("time_s,omega_x,omega_y,omega_z\n");
    for k in 0..400 {
        let t = k as f64 * 0.1;
        let clean = [
            (0.3 * t).sin() + 1e-3 * noise(k),
            1e-3 * noise(k + 1000),
            0.2 * (0.2 * t).cos() + 1e-3 * noise(k + 2000),
        ];
        let [x, y, z] = change(k, clean);
        text.push_str(&format!("{t},{x},{y},{z}\n"));
    }
    read_text(text, &ReadOptions::default()).unwrap()
}

fn names(table: &Table) -> Vec<(Check, usize)> {
    findings(table)
        .into_iter()
        .map(|f| (f.check, f.count))
        .collect()
}

#[test]
fn exact_a_good_gyro_has_no_finding() {
    assert_eq!(names(&gyro(|_, w| w)), []);
}

#[test]
fn exact_smooth_motion_without_noise_has_no_finding() {
    // Coarse: twenty samples per oscillation.
    let table = gyro(|k, _| {
        let t = k as f64;
        [
            (0.314 * t).sin(),
            0.0,
            (0.2 * t).cos() + 0.3 * (0.31 * t).sin(),
        ]
    });
    assert_eq!(names(&table), []);
    // At rest, then a lasting step: neither outlier nor stuck.
    let table = gyro(|k, _| {
        if k < 200 {
            [0.0, 0.0, 0.1]
        } else {
            [0.5, 0.0, 0.1]
        }
    });
    assert_eq!(names(&table), []);
}

#[test]
fn exact_each_fault_is_found_with_its_count() {
    let spikes = gyro(|k, [x, y, z]| [if k % 50 == 7 { x + 0.5 } else { x }, y, z]);
    assert_eq!(names(&spikes), [(Check::Outlier, 8)]);
    let cut = gyro(|_, [x, y, z]| [x.clamp(-0.8, 0.8), y, z]);
    assert!(matches!(names(&cut)[..], [(Check::Saturation, n), ..] if n > 100));
    let hangs = gyro(|k, [x, y, z]| [x, if (100..150).contains(&k) { 0.5e-3 } else { y }, z]);
    assert_eq!(names(&hangs), [(Check::Stuck, 49)]);
    let held = gyro(|k, _| {
        let k = k - k % 4;
        [noise(k), noise(k + 1000), noise(k + 2000)]
    });
    assert_eq!(names(&held), [(Check::Held, 300)]);
}

/// An angle within one turn, and 16 bits of a two's complement read as unsigned; a joint that oscillates, and one that jumps, do neither.
#[test]
fn exact_a_channel_that_begins_anew_is_found() {
    let of = |name: &str, value: &dyn Fn(f64) -> f64| {
        let mut text = format!("time_s,{name}\n");
        for k in 0..400 {
            let t = 0.1 * f64::from(k);
            text.push_str(&format!("{t},{}\n", value(t)));
        }
        let table = read_text(text, &ReadOptions::default()).unwrap();
        names(&table).iter().filter(|n| n.0 == Check::Wrap).count()
    };
    let (turn, pi) = (std::f64::consts::TAU, std::f64::consts::PI);
    let angle = |t: f64| 2.0 + 0.3 * t + 0.5 * (0.4 * t).sin();
    assert_eq!(of("J1_rad", &|t| (angle(t) + pi).rem_euclid(turn) - pi), 1);
    assert_eq!(of("J1_rad", &|t| angle(t).rem_euclid(turn)), 1);
    assert_eq!(of("J1_rad", &angle), 0);
    assert_eq!(of("J1_rad", &|t| 3.1 * (0.3 * t).sin()), 0);
    let counts = |t: f64| (800.0 * (0.4 * t).sin()).round();
    assert_eq!(
        of("w1_rad_s", &|t| 1.0e-4 * counts(t).rem_euclid(65536.0)),
        1
    );
    assert_eq!(of("w1_rad_s", &|t| 1.0e-4 * counts(t)), 0);
    let step = |t: f64| {
        if t < 20.0 {
            counts(t)
        } else {
            counts(t) + 9000.0
        }
    };
    assert_eq!(of("w1_rad_s", &|t| 1.0e-4 * step(t)), 0);
}

/// A tracker that holds its last value while the vehicle turns.
#[test]
fn exact_an_attitude_that_holds_while_the_gyro_turns_is_found() {
    let record = |turns: bool| {
        let mut text = String::from("time_s,q_x,q_y,q_z,q_w,omega_x,omega_y,omega_z\n");
        for k in 0..400_i32 {
            let at = if (100..150).contains(&k) { 100 } else { k };
            let half = 0.005 * f64::from(at);
            let rate = if turns || !(100..150).contains(&k) {
                0.1
            } else {
                0.0
            };
            let t = 0.1 * f64::from(k);
            text.push_str(&format!(
                "{t},{},0,0,{},{rate},0,0\n",
                half.sin(),
                half.cos()
            ));
        }
        let table = read_text(text, &ReadOptions::default()).unwrap();
        let held = names(&table).into_iter().find(|n| n.0 == Check::Held);
        held.map(|n| n.1)
    };
    assert_eq!(record(true), Some(49));
    assert_eq!(record(false), None);
}

/// A tracker that shows one attitude all along: the vehicle rests where the gyro reads no more than a bias.
#[test]
fn exact_an_attitude_that_never_changes_may_be_at_rest() {
    let held = |rate: f64| {
        let mut text = String::from("time_s,q_x,q_y,q_z,q_w,omega_x,omega_y,omega_z\n");
        for k in 0..400 {
            text.push_str(&format!(
                "{},0.6,0,0,0.8,{},0,0\n",
                0.1 * f64::from(k),
                rate + 1.0e-4 * noise(k as usize)
            ));
        }
        let table = read_text(text, &ReadOptions::default()).unwrap();
        names(&table).into_iter().any(|n| n.0 == Check::Held)
    };
    assert!(!held(2.0e-4));
    assert!(held(0.1));
}

#[test]
fn exact_policies_do_what_they_say() {
    let faulty = || gyro(|k, [x, y, z]| [if k % 50 == 7 { x + 0.5 } else { x }, y, z]);
    let policies = |changes: &[&str], strict| Policies::new(changes, strict).unwrap();
    let mut table = faulty();
    let found = apply(&mut table, "t.csv", &policies(&[], false));
    assert_eq!(found.len(), 1);
    // All axes of the sensor lose the sample, and the repairs list it.
    assert!(table.channels.iter().all(|c| c.values.len() == 392));
    assert!(
        table
            .repairs
            .iter()
            .any(|r| r.starts_with("t.csv: outlier: 8 of 400 samples of omega_x left out"))
    );
    let mut table = faulty();
    apply(&mut table, "t.csv", &policies(&["outlier=report"], false));
    assert!(table.channels.iter().all(|c| c.values.len() == 400));
    for policies in [
        policies(&["outlier=refuse"], false),
        policies(&["outlier=report"], true),
    ] {
        let found = apply(&mut faulty(), "t.csv", &policies);
        assert_eq!(found[0].policy, Policy::Refuse);
        let error = refused("t.csv", &found[0]);
        assert!(
            error
                .to_string()
                .starts_with("E0220 t.csv: channel 'omega_x': outlier: 8 samples differ from their neighbours by up to"),
            "{error}"
        );
    }
    for (change, words) in [
        (
            "outlier=repair",
            "outlier has no such policy; use one of exclude, report, refuse",
        ),
        (
            "spikes=report",
            "there is no check 'spikes'; use one of gap, placeholder, wrap, held",
        ),
    ] {
        let error = Policies::new(&[change], false).unwrap_err();
        let fault = &error.list[0];
        assert_eq!((fault.code, fault.value.as_str()), ("E0001", change));
        assert!(error.to_string().contains(words), "{error}");
    }
}

/// A wheel that ran up to its limit and stayed there had a placeholder, which a policy would exclude. A value that is reached in one
/// step is one.
#[test]
fn prop_a_limit_that_is_reached_is_no_placeholder() {
    for sign in [-1.0, 1.0] {
        for (slope, expected) in [(2.0, 0), (5.0, 0), (12.0, 0), (200.0, 1)] {
            for stay in [8, 40] {
                let ran = |k: usize| slope * (k as f64 - 200.0);
                let end = 200 + (100.0 / slope) as usize + stay;
                let table = gyro(|k, [_, y, z]| match k {
                    k if k <= 200 || k > end => [noise(k), y, z],
                    k => [sign * ran(k).min(100.0), y, z],
                });
                let found = names(&table);
                let count = found.iter().filter(|f| f.0 == Check::Placeholder).count();
                assert_eq!(count, expected, "{sign} {slope} {stay}: {found:?}");
            }
        }
    }
}

#[test]
fn exact_a_wheel_read_more_often_than_it_tells_keeps_each_of_its_values() {
    let rows = |value: &dyn Fn(usize) -> f64| {
        let row = |k: usize| format!("{},{}\n", k as f64 * 0.1, value(k));
        let rows: String = (0..400).map(row).collect();
        read_text(
            format!("time_s,wheel1_rad_s\n{rows}"),
            &ReadOptions::default(),
        )
        .unwrap()
    };
    // At rest for 80 samples in between.
    let speed = |k: usize| (0.02 * k.clamp(160, 240).abs_diff(160) as f64 + 0.01 * k as f64).sin();
    let still = |k: usize| if (160..240).contains(&k) { 160 } else { k };
    let mut table = rows(&|k| speed(still(k - k % 4)));
    assert_eq!(names(&table), [(Check::Held, 300)]);
    apply(&mut table, "run.csv", &Policies::default());
    let kept = &table.channels[0];
    assert_eq!(kept.values.len(), 100);
    for (t, x) in kept.time_s.iter().zip(&kept.values) {
        assert_eq!(*x, speed(still((10.0 * t).round() as usize)));
    }
    // A coarse encoder of a joint that moves at one rate, and a wheel that only rests.
    assert_eq!(names(&rows(&|k| 0.1 * (k / 4) as f64)), []);
    assert_eq!(names(&rows(&|k| speed(still(k)))), []);
}
