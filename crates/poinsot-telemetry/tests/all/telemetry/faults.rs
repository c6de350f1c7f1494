//! Every fault of a CSV file: code, place and value of its error.

use crate::telemetry::{Folder, assert_told, map_of, read_text};
use poinsot_telemetry::{ColumnMap, ReadOptions, read};

fn fault(text: impl AsRef<[u8]>) -> String {
    read_text(text, &ReadOptions::default()).expect_err("must be refused")
}

fn strict(text: &str) -> String {
    let options = ReadOptions {
        strict: true,
        ..ReadOptions::default()
    };
    read_text(text, &options).expect_err("must be refused")
}

fn map(channel: &str, column: &str, unit: &str) -> ReadOptions {
    ReadOptions {
        map: map_of(vec![ColumnMap::new(channel, column, unit)], Vec::new()),
        ..ReadOptions::default()
    }
}

#[test]
fn unit_cells_that_are_no_numbers() {
    for (cell, place, value) in [
        (
            "\"1,5\"",
            "E0203 run.csv:3 column 'omega_x'",
            "'1,5' has a decimal comma",
        ),
        (
            "\u{2212}1.5",
            "E0203 run.csv:3 column 'omega_x'",
            "typographic minus",
        ),
        (
            "1e400",
            "E0203 run.csv:3 column 'omega_x'",
            "'1e400' is too large",
        ),
        (
            "inf",
            "E0203 run.csv:3 column 'omega_x'",
            "'inf' is infinite",
        ),
        ("#N/A", "E0203 run.csv:3 column 'omega_x'", "'#N/A'"),
        ("off", "E0203 run.csv:3 column 'omega_x'", "'off'"),
        ("1d-3", "E0203 run.csv:3 column 'omega_x'", "Fortran"),
    ] {
        let text = format!("time_s,omega_x\n0,0.5\n0.1,{cell}\n0.2,0.5\n");
        assert_told(&fault(text), place, value);
    }
    assert_told(
        &fault(b"time_s,omega_x\n0,1\n1,2\xb0\n2,3\n"),
        "E0203 run.csv:3 column 'omega_x'",
        "is not UTF-8",
    );
}

#[test]
fn unit_line_numbers_count_blank_lines_and_line_ends_of_any_kind() {
    for text in [
        "time_s,omega_x\n\n0,1\n1,x\n",
        "time_s,omega_x\r\n\r\n0,1\r\n1,x\r\n",
        "time_s,omega_x\r\r0,1\r1,x\r",
        "time_s,omega_x\n\n0,1\n1,x\n2,2",
        "\u{feff}time_s,omega_x,\n\n0,1,\n1,x,\n",
    ] {
        assert_told(&fault(text), "E0203 run.csv:4 column 'omega_x'", "'x'");
    }
}

#[test]
fn unit_rows_and_headers() {
    for (text, place, value) in [
        (
            "time_s,omega_x\n0,1\n1\n2,3\n",
            "E0204 run.csv:3",
            "1 field where the header has 2",
        ),
        (
            "time_s,omega_x\n0,1,5\n1,1,5\n",
            "E0204 run.csv:2",
            "3 fields where the header has 2",
        ),
        (
            "time_s,omega_x\n# made by hand\n0,1\n",
            "E0204 run.csv:2",
            "comment = \"#\"",
        ),
        (
            "time_s,omega_x,omega_x\n0,1,2\n",
            "E0205 run.csv",
            "'omega_x'",
        ),
        (
            "time_s;omega_x\n0;1,5\n",
            "E0205 run.csv",
            "delimiter = \";\"",
        ),
        (
            "time_s\tomega_x\n0\t1\n",
            "E0205 run.csv",
            "delimiter = \"tab\"",
        ),
        ("", "E0205 run.csv", "empty"),
        ("time_s,omega_x\n", "E0217 run.csv", "no data rows"),
        (
            "t_s,omega_x\n0,1\n",
            "E0207 run.csv",
            "{ column = \"t_s\", unit = \"s\" }",
        ),
        ("omega_x,n\n0,1\n", "E0207 run.csv", "[omega_x, n]"),
        (
            "time_s,omega_x\n0,1\nnone,2\n",
            "E0203 run.csv:3 column 'time_s'",
            "'none'",
        ),
    ] {
        assert_told(&fault(text), place, value);
    }
}

#[test]
fn unit_bytes_that_are_not_utf8_text() {
    assert_told(&fault(b"\xff\xfet\0i\0m\0e\0"), "E0202 run.csv", "UTF-16");
    assert_told(
        &fault(b"time_s,omega_x\n0,1\n1,\0\n"),
        "E0202 run.csv",
        "byte 21",
    );
    assert_told(
        &fault(b"time_s,w [\xb0/s]\n0,1\n"),
        "E0202 run.csv:1",
        "byte 3",
    );
    let mut long = b"time_s,omega_x\n0,1\n".to_vec();
    long.resize(long.len() + (17 << 20), b'7');
    assert!(fault(long).contains("a line is longer than 16 MiB"));
}

#[test]
fn unit_times_that_cannot_be() {
    for (text, place, value) in [
        (
            "time_s,omega_x\n0,1\n2,2\n1,3\n",
            "E0208 run.csv:4 column 'time_s'",
            "2 s (row 3) to 1 s",
        ),
        (
            "time_s,omega_x\n0,1\n1,2\n1,3\n2,1\n",
            "E0208 run.csv:4 column 'time_s'",
            "'omega_x'",
        ),
        (
            "time_s,omega_x\n0,1\n,2\n2,3\n",
            "E0208 run.csv:3 column 'time_s'",
            "no time",
        ),
        (
            "time_s,omega_x\n0,1\n1e8,2\n2e8,3\n",
            "E0209 run.csv column 'time_s'",
            "unit = \"ns\"",
        ),
        (
            "time_s,omega_x\n0,1\n1e-6,2\n2e-6,3\n",
            "E0209 run.csv column 'time_s'",
            "unit = \"d\"",
        ),
    ] {
        assert_told(&fault(text), place, value);
    }
}

#[test]
fn unit_a_repeated_row_is_dropped_and_listed() {
    let text = "time_s,omega_x,omega_y\n0,1,\n1,2,\n1,2,\n2,3,4\n";
    let table = read_text(text, &ReadOptions::default()).unwrap();
    assert_eq!(table.channel("omega_x").unwrap().values, [1.0, 2.0, 3.0]);
    assert_eq!(
        table.repairs,
        ["run.csv:4: 1 row dropped: the same as the row before (this is the first)"]
    );
    assert_told(&strict(text), "E0218 run.csv:4", "1 row dropped");
}

#[test]
fn unit_nan_is_no_sample_and_listed_but_an_empty_cell_is_just_no_sample() {
    let text = "time_s,omega_x,omega_y\n0,1,\n1,NaN,2\n2,3,4\n";
    let table = read_text(text, &ReadOptions::default()).unwrap();
    let x = table.channel("omega_x").unwrap();
    assert_eq!(
        (x.time_s.as_ref(), x.values.as_slice()),
        ([0.0, 2.0].as_slice(), [1.0, 3.0].as_slice())
    );
    assert_eq!(table.channel("omega_y").unwrap().values, [2.0, 4.0]);
    assert_eq!(
        table.repairs,
        ["run.csv:3 column 'omega_x': 1 NaN cells treated as missing samples (this is the first)"]
    );
    assert!(strict(text).starts_with("E0218 run.csv:3 column 'omega_x': 1 NaN"));
}

#[test]
fn unit_a_cut_file_is_refused_or_recovered() {
    let recover = ReadOptions {
        recover: true,
        ..ReadOptions::default()
    };
    for (text, place, value) in [
        (
            "time_s,omega_x\n0,1\n1,2\n2",
            "E0206 run.csv:4",
            "1 of 2 fields",
        ),
        (
            "time_s,omega_x\n0,1\n1,2\n2,3.1e-",
            "E0206 run.csv:4",
            "'3.1e-'",
        ),
        (
            "time_s,omega_x\n0,1\n1,2\n\"2,3",
            "E0206 run.csv:4",
            "1 of 2 fields",
        ),
    ] {
        assert_told(&fault(text), place, value);
        let table = read_text(text, &recover).unwrap();
        assert_eq!(table.channel("omega_x").unwrap().values, [1.0, 2.0]);
        assert_eq!(table.sources[0].rows, 2);
        assert_eq!(table.repairs, ["run.csv:4: cut last row dropped"]);
    }
    let whole = "time_s,omega_x\n0,1\n1,2";
    let table = read_text(whole, &ReadOptions::default()).unwrap();
    assert_eq!(table.channel("omega_x").unwrap().values, [1.0, 2.0]);
    assert_eq!(
        table.repairs,
        ["run.csv:3: the last row has no line end; assumed complete"]
    );
    let table = read_text(whole, &recover).unwrap();
    assert_eq!(table.channel("omega_x").unwrap().values, [1.0]);
}

#[test]
fn unit_maps_that_cannot_be_followed() {
    let text = "time_s,gyro_wx\n0,1\n1,2\n";
    for (options, place, value) in [
        (
            map("omega_x", "gyro_w", "deg/s"),
            "E0212 map of channel 'omega_x'",
            "'gyro_wx'",
        ),
        (
            map("omega_x", "gyro_wx", "deg"),
            "E0212 map of channel 'omega_x'",
            "'deg'",
        ),
        (
            map("omega_x", "gyro_wx", "dgs/s"),
            "E0211 map of channel 'omega_x'",
            "'deg/s'",
        ),
        (
            map("omega", "gyro_wx", "deg/s"),
            "E0212 map of channel 'omega'",
            "standard channel",
        ),
    ] {
        assert_told(&read_text(text, &options).unwrap_err(), place, value);
    }
}

#[test]
fn unit_quaternions_that_are_none() {
    assert_told(
        &fault("time_s,q_x,q_y,q_z\n0,0,0,0\n1,0,0,0\n"),
        "E0214 run.csv",
        "'q_w'",
    );
    assert_told(
        &fault("time_s,q_x,q_y,q_z,q_w\n0,0,0,0,1\n1,0,0,1,1\n"),
        "E0214 run.csv:3 column 'q_x'",
        "1.41421",
    );
}

#[test]
fn unit_files_that_are_none() {
    let folder = Folder::new();
    let missing = read(&[folder.path("none.csv")], &ReadOptions::default()).unwrap_err();
    assert_told(
        &folder.message(&missing),
        "E0201 none.csv",
        "check the path",
    );
    assert_eq!(missing.kind(), poinsot_files::FaultKind::Input);
    std::fs::create_dir(folder.path("dir.csv")).unwrap();
    let error = read(&[folder.path("dir.csv")], &ReadOptions::default()).unwrap_err();
    assert_told(&folder.message(&error), "E0202 dir.csv", "regular file");
    let path = folder.file("run.xlsx", "PK");
    let error = read(&[path], &ReadOptions::default()).unwrap_err();
    assert_told(&folder.message(&error), "E0202 run.xlsx", ".parquet");
}

proptest::proptest! {
    /// Arbitrary bytes give a table or one error line, never a panic.
    #[test]
    fn prop_any_bytes_are_answered(
        noise in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..200),
        at in 0_usize..60,
        strict: bool,
        recover: bool,
    ) {
        let options = ReadOptions { strict, recover, check_conventions: true, ..ReadOptions::default() };
        let mut text = b"time_s,q_x,q_y,q_z,q_w,omega_x\n0,0,0,0,1,1\n1,0,0,0,1,\n".to_vec();
        text.truncate(at);
        text.extend(noise);
        let _ = read_text(&text, &options);
    }

    /// Cells drawn from common texts.
    #[test]
    fn prop_any_rows_are_answered(
        cells in proptest::collection::vec(
            proptest::sample::select(vec!["0", "1", "2.5", "-1e9", "1e308", "", "NaN", "nan", "x", "\"", "-0"]),
            0..40,
        ),
        width in 1_usize..7,
    ) {
        let mut text = "time_s,q_x,q_y,q_z,q_w,omega_x\n".to_owned();
        for row in cells.chunks(width) {
            text.push_str(&row.join(","));
            text.push('\n');
        }
        for strict in [false, true] {
            let _ = read_text(&text, &ReadOptions { strict, ..ReadOptions::default() })
                .map(|t| poinsot_telemetry::inspect(&t).text(|_, rows| rows.concat().concat()));
        }
    }
}

/// Found by fuzzing: a line end in a quoted column name split the message.
#[test]
fn regress_a_column_name_with_a_line_end_stays_in_one_line() {
    assert_told(
        &fault("\"tim\ne\",omega_x\n0,1\n"),
        "E0207 run.csv",
        "[tim\\ne, omega_x]",
    );
}

/// Found by libFuzzer: a duplicate column name with a line end.
#[test]
fn regress_a_column_name_with_a_line_end_that_stands_twice_stays_in_one_line() {
    assert_told(
        &fault("time_s,\"a\nb\",\"a\nb\"\n0,1,2\n"),
        "E0205 run.csv",
        "'a\\nb'",
    );
}
