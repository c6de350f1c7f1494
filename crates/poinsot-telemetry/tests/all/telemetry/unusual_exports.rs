//! Exports whose layout, order or clock is not the usual one.

use crate::telemetry::exports::{iso, named, of};
use crate::telemetry::{assert_told, read_text};
use poinsot_telemetry::{
    AttitudeMap, ColumnMap, FileMap, Layout, ReadOptions, TimeMap, map_faults,
};

fn spaced(header_row: Option<u64>) -> Layout {
    Layout {
        delimiter: Some("space".to_owned()),
        header_row,
        ..Layout::default()
    }
}

fn rows_of(channel: &str, name: &str) -> ColumnMap {
    ColumnMap {
        rows: vec![("NAME".to_owned(), name.to_owned())],
        ..ColumnMap::new(channel, "VALUE", "rad/s")
    }
}

#[test]
fn regress_a_byte_order_mark_before_a_number_is_no_part_of_it() {
    let time = TimeMap {
        column: "1".to_owned(),
        ..TimeMap::default()
    };
    let options = of(FileMap {
        layout: Layout {
            header_row: Some(0),
            ..Layout::default()
        },
        time: Some(time),
        columns: vec![ColumnMap::new("omega_x", "2", "rad/s")],
        ..FileMap::default()
    });
    let table = read_text("\u{feff}0,3\n0.1,4\n", &options).unwrap();
    let rate = table.channel("omega_x").unwrap();
    assert_eq!(
        (&rate.time_s[..], &rate.values[..]),
        (&[0.0, 0.1][..], &[3.0, 4.0][..])
    );
}

#[test]
fn regress_a_file_without_names_is_told_what_to_write() {
    let told = |text: &str, header_row| {
        let layout = Layout {
            header_row,
            ..Layout::default()
        };
        let all = FileMap {
            layout,
            ..FileMap::default()
        };
        read_text(text, &of(all)).unwrap_err()
    };
    for (text, header_row, code, advice) in [
        (
            "0,0.1\n1,0.2\n",
            None,
            "E0207",
            "header_row = 0 and time = { column = \"1\" }",
        ),
        (
            "0,0.1\n1,0.2\n",
            Some(0),
            "E0207",
            "by its number: [telemetry] time = { column = \"1\" }",
        ),
        (
            "0;0,1;2\n0,1;0,2;3\n",
            None,
            "E0205",
            "header_row = 0, as the file has no header",
        ),
        (
            "time_s omega_x\n0 1\n",
            None,
            "E0205",
            "delimiter = \"space\"",
        ),
        (
            "Zeit,omega_x\n0,1\n",
            None,
            "E0207",
            "time = { column = \"...\", unit = \"s\" }",
        ),
    ] {
        let error = told(text, header_row);
        assert_told(&error, &format!("{code} run.csv"), advice);
        assert!(!error.contains("poinsot inspect"), "{error}");
    }
}

#[test]
fn regress_an_attitude_without_rows_is_named_once() {
    let options = of(FileMap {
        attitude: vec![AttitudeMap {
            quaternion: named(&["q_x", "q_y", "q_z", "q_w"]),
            rows: vec![("OK".to_owned(), "1".to_owned())],
            ..AttitudeMap::default()
        }],
        ..FileMap::default()
    });
    let text = "time_s,q_x,q_y,q_z,q_w,OK,omega_x\n0,0,0,0,1,VALID,1\n1,0,0,0,1,VALID,2\n";
    let told = read_text(text, &options).unwrap().repairs.join("\n");
    assert!(
        told.contains("so there is no attitude; the first"),
        "{told}"
    );
}

/// Two sensors of 8 samples in one column, by a permutation of the rows; two runs in one file are refused.
#[test]
fn regress_shuffled_rows_of_channels_are_sorted() {
    let options = of(FileMap {
        columns: vec![rows_of("omega_x", "X"), rows_of("omega_y", "Y")],
        ..FileMap::default()
    });
    let row = |k: usize| format!("{},{},{k}\n", k / 2, ["X", "Y"][k % 2]);
    let text = |order: &[usize]| {
        let rows: Vec<String> = order.iter().map(|k| row(*k)).collect();
        format!("time_s,NAME,VALUE\n{}", rows.concat())
    };
    let shuffled: Vec<usize> = (0..16).map(|k| 7 * k % 16).collect();
    let table = read_text(text(&shuffled), &options).unwrap();
    for (name, odd) in [("omega_x", 0.0), ("omega_y", 1.0)] {
        let rate = table.channel(name).unwrap();
        let values: Vec<f64> = rate.time_s.iter().map(|t| 2.0 * t + odd).collect();
        assert_eq!((rate.values.len(), &rate.values), (8, &values));
    }
    let told = table.repairs.join("\n");
    assert!(
        told.contains("column 'time_s': rows in no order of time sorted"),
        "{told}"
    );
    let strict = ReadOptions {
        strict: true,
        ..options.clone()
    };
    assert_told(
        &read_text(text(&shuffled), &strict).unwrap_err(),
        "E0218 run.csv column 'time_s'",
        "order",
    );
    let runs: Vec<usize> = (0..16).chain(0..16).collect();
    let error = read_text(text(&runs), &options).unwrap_err();
    assert_told(&error, "E0208 run.csv:18 column 'time_s'", "choose one run");
}

#[test]
fn regress_columns_aligned_by_blanks_are_read() {
    let all = FileMap {
        layout: spaced(Some(1)),
        ..FileMap::default()
    };
    let text = "#   time_s   omega_x  \n\n   0.0       1.5\n  \n 10.0   \"-2.5\"  \n 20.0 3";
    let table = read_text(text, &of(all.clone())).unwrap();
    let rate = table.channel("omega_x").unwrap();
    assert_eq!(
        (&rate.time_s[..], &rate.values[..]),
        (&[0.0, 10.0, 20.0][..], &[1.5, -2.5, 3.0][..])
    );
    let error = read_text("time_s  omega_x\n0   1   2\n1  2\n", &of(all)).unwrap_err();
    assert_told(&error, "E0204 run.csv:2", "3 fields where the header has 2");
}

#[test]
fn regress_keys_without_a_meaning_for_times_are_refused() {
    let time = || ColumnMap::new("time_s", "t", "s");
    let wraps_at = ColumnMap {
        wraps_at: Some(256.0),
        ..time()
    };
    let late_s = ColumnMap {
        late_s: Some(0.1),
        ..time()
    };
    let invalid = ColumnMap {
        invalid: vec!["0".to_owned()],
        ..time()
    };
    for (key, map) in [
        ("wraps_at", wraps_at),
        ("late_s", late_s),
        ("invalid", invalid),
    ] {
        let all = FileMap {
            columns: vec![map],
            ..FileMap::default()
        };
        let fault = map_faults(&of(all).map).remove(0);
        assert_eq!(
            (fault.refused.code, fault.refused.key, fault.keys),
            (
                "E0212",
                key,
                ["columns", "time_s"].map(str::to_owned).to_vec()
            )
        );
    }
}

/// Of Unix times without an epoch, as the messages name times: since the first sample, or those of the file.
#[test]
fn regress_a_range_of_times_counts_as_the_file_or_since_its_first_sample() {
    let text = "time_s,omega_x\n1773512340,1\n1773512341,2\n1773512342,3\n";
    for range in [[0.0, 1.0], [1_773_512_340.0, 1_773_512_341.5]] {
        let options = ReadOptions {
            time_s: Some(range),
            ..ReadOptions::default()
        };
        let table = read_text(text, &options).unwrap();
        assert_eq!(table.channel("omega_x").unwrap().values, [1.0, 2.0]);
    }
}

#[test]
fn regress_rows_of_a_clock_that_was_not_set_are_counted_and_can_be_left_out() {
    let options = of(FileMap {
        time: iso("UTC"),
        ..FileMap::default()
    });
    let row = |k: usize| match k {
        0 | 1 => format!("1970-01-01T00:00:0{k},{k}\n"),
        _ => format!("2026-03-14T18:19:0{k},{k}\n"),
    };
    let text = |last: usize| format!("UTC,omega_x\n{}", (0..=last).map(row).collect::<String>());
    let error = read_text(text(5), &options).unwrap_err();
    assert_told(
        &error,
        "E0203 run.csv:2 column 'UTC'",
        "as in 2 of 6 rows; correct the unit or the epoch in [telemetry] time, or leave these rows out by --time-s 0,TO",
    );
    let chosen = ReadOptions {
        time_s: Some([0.0, 2.0]),
        ..options.clone()
    };
    let table = read_text(text(5), &chosen).unwrap();
    assert_eq!(table.channel("omega_x").unwrap().values, [2.0, 3.0, 4.0]);
    // Where all rows are such, the unit or the epoch is wrong.
    for options in [&options, &chosen] {
        let error = read_text(text(1), options).unwrap_err();
        assert!(error.ends_with("the epoch in [telemetry] time"), "{error}");
    }
}
