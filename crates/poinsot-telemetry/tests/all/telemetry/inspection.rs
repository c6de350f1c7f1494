//! Inspection of a table.

use crate::telemetry::{Folder, read_text};
use poinsot_files::Fault;
use poinsot_telemetry::{Channel, ReadOptions, Table, inspect, inspect_files, read, write};
use std::sync::Arc;

#[test]
fn unit_an_inspection_lists_rates_gaps_and_proposals() {
    let mut text = String::from("time_s,omega_x,wheel1_rad_s,wy [deg/s],Mode\n");
    for k in (0..200).filter(|k| !(100..110).contains(k)) {
        let sentinel = if k % 50 == 7 {
            -9999.0
        } else {
            f64::from(k % 17) * 0.25
        };
        text.push_str(&format!(
            "{},{sentinel},6000,1,nominal\n",
            f64::from(k) * 0.1
        ));
    }
    let table = read_text(text, &ReadOptions::default()).unwrap();
    let seen = inspect(&table);
    let x = &seen.channels[0];
    assert_eq!((x.samples, x.gaps, x.quantum), (190, 1, Some(0.25)));
    assert!((x.longest_gap_s - 1.1).abs() < 1e-12 && (x.rate_hz.unwrap() - 10.0).abs() < 1e-9);
    assert!(seen.channels[1].constant);
    assert_eq!(seen.ignored, ["wy [deg/s]", "Mode"]);
    assert_eq!(
        seen.suggestions[0],
        "omega_y = { column = \"wy [deg/s]\", unit = \"deg/s\" }"
    );
    assert_eq!(
        seen.notes,
        [
            "wheel1_rad_s reaches 6000 rad/s (57296 rpm): check its unit, which attitude and gyro do not determine",
        ]
    );
    let found: Vec<&str> = seen.findings.iter().map(|f| f.text.as_str()).collect();
    assert_eq!(
        found.last(),
        Some(
            &"-9999 occurs in 3 samples, far from all others: probably a placeholder; write it as invalid in its column of the map, or use --policy placeholder=exclude"
        )
    );
    let shown = seen.text(|_, rows| rows.concat().join(" "));
    assert!(shown.contains("omega_x") && shown.contains("Unused columns:\n  wy [deg/s], Mode"));
    let json = serde_json::to_value(&seen).unwrap();
    assert_eq!(json["channels"][0]["name"], "omega_x");
}

/// A long record: noise on a slow oscillation, gaps of two lengths, one of them between two parts of 1 MiB.
fn long() -> Table {
    let (mut t, mut state) = (0.0, 1_u64);
    let mut times = Vec::new();
    for k in 0..60_000 {
        t += match k {
            21_846 => 3.0,
            40_000 => 2.0,
            _ => 0.01,
        };
        times.push(t);
    }
    let time_s: Arc<[f64]> = times.into();
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let names = ["omega_x", "omega_y", "omega_z", "wheel_rad_s"];
    let channels = names.map(|name| Channel {
        name: name.to_owned(),
        unit: "rad/s".to_owned(),
        time_s: time_s.clone(),
        values: time_s
            .iter()
            .map(|t| (0.01 * t).sin() + 1.0e-3 * noise())
            .collect(),
        ..Channel::default()
    });
    Table {
        channels: channels.to_vec(),
        ..Table::default()
    }
}

#[test]
fn exact_a_file_looked_at_in_parts_is_the_file_looked_at_whole() {
    let folder = Folder::new();
    let small = ReadOptions {
        memory_mib: 1,
        ..ReadOptions::default()
    };
    for name in ["run.csv", "run.parquet"] {
        let path = folder.path(name);
        write(&path, &long().channels).unwrap();
        let refused = folder.message(&read(&[&path], &small).unwrap_err());
        assert!(refused.starts_with("E0221"), "{refused}");
        let whole = inspect_files(&[&path], &ReadOptions::default()).unwrap();
        let parts = inspect_files(&[&path], &small).unwrap();
        assert_eq!(parts.sources, whole.sources);
        assert_eq!(parts.time_s, whole.time_s);
        assert!(parts.notes[0].contains("read in parts"));
        assert_eq!(parts.channels.len(), 4);
        for (a, b) in parts.channels.iter().zip(&whole.channels) {
            assert_eq!((a.samples, a.gaps), (60_000, 2));
            let exact = |c: &poinsot_telemetry::ChannelSummary| {
                (c.time_s, c.longest_gap_s, c.min, c.max, c.constant)
            };
            assert_eq!(exact(a), exact(b));
            let noise = a.noise.unwrap() / b.noise.unwrap();
            assert!((noise - 1.0).abs() < 0.02, "{noise}");
            assert!((a.rate_hz.unwrap() / b.rate_hz.unwrap() - 1.0).abs() < 1.0e-9);
        }
    }
}

#[test]
fn unit_time_that_goes_back_between_two_parts_is_refused() {
    let folder = Folder::new();
    let path = folder.path("run.csv");
    write(&path, &long().channels).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let (head, rows) = text.split_once('\n').unwrap();
    // The same rows again: some part starts with a much earlier time.
    let path = folder.file("twice.csv", format!("{head}\n{rows}{rows}"));
    let small = ReadOptions {
        memory_mib: 1,
        ..ReadOptions::default()
    };
    let error = folder.message(&inspect_files(&[path], &small).unwrap_err());
    assert!(error.starts_with("E0208 twice.csv:60002"), "{error}");
    assert!(error.contains("time goes back"), "{error}");
}

/// Two parts of 1 MiB are 2 x 21,846 rows of four channels. An incomplete last row is dropped even if it fills a part
/// exactly, and so is one truncated right after it.
#[test]
fn regress_a_last_row_on_the_border_of_a_part_is_taken_back() {
    let folder = Folder::new();
    let path = folder.path("run.csv");
    write(&path, &long().channels).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let recover = ReadOptions {
        memory_mib: 1,
        recover: true,
        ..ReadOptions::default()
    };
    for rows in [43_691, 43_692, 43_693] {
        let whole: Vec<&str> = text.lines().take(rows + 1).collect();
        let (last, before) = whole.split_last().unwrap();
        for cut in [*last, &last[..last.len() / 2]] {
            let path = folder.file("cut.csv", format!("{}\n{cut}", before.join("\n")));
            let seen = inspect_files(&[path], &recover).unwrap();
            assert!(seen.notes[0].contains("read in parts"));
            assert_eq!(seen.sources[0].rows, rows - 1);
            assert!(seen.channels.iter().all(|c| c.samples == rows - 1));
            let t: f64 = before[rows - 1].split(',').next().unwrap().parse().unwrap();
            assert_eq!(seen.time_s.unwrap()[1], t);
        }
    }
}

/// The row step named in a refusal fits; for a file that declares its rows no smaller step does. If all rows are
/// requested, the file is refused by its size alone, even with an invalid last row.
#[test]
fn exact_the_step_that_a_refusal_names_fits() {
    let folder = Folder::new();
    for name in ["run.csv", "run.parquet"] {
        let path = folder.path(name);
        write(&path, &long().channels).unwrap();
        for time_s in [None, Some([100.0, 500.0])] {
            let small = ReadOptions {
                memory_mib: 1,
                time_s,
                ..ReadOptions::default()
            };
            let error = read(&[&path], &small).unwrap_err();
            assert_eq!(error.code(), "E0221");
            let Fault {
                problem, advice, ..
            } = &error.list[0];
            // 6 numbers of 8 bytes: channels plus two.
            let fit = (1 << 20) / 48;
            assert!(problem.contains(&format!("but {fit} fit")), "{problem}");
            let every = advice.split([' ', ',']).nth(2).unwrap().parse().unwrap();
            let thin = |every: u64| {
                let every = usize::try_from(every).unwrap();
                let options = ReadOptions {
                    every,
                    ..small.clone()
                };
                read(&[&path], &options)
            };
            let kept = thin(every).unwrap().channels[0].values.len();
            assert!(kept <= fit && kept > fit / 2, "{kept} of {fit}");
            if name == "run.parquet" && time_s.is_none() {
                assert!(thin(every - 1).is_err());
            }
        }
        let mut broken = std::fs::read(&path).unwrap();
        broken.extend_from_slice(b"not a row");
        if name == "run.csv" {
            let path = folder.file("broken.csv", broken);
            let small = ReadOptions {
                memory_mib: 1,
                ..ReadOptions::default()
            };
            let error = folder.message(&read(&[path], &small).unwrap_err());
            assert!(error.starts_with("E0221 broken.csv: up to 6"), "{error}");
        }
    }
}
