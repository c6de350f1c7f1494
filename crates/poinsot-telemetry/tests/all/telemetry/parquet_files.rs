//! Parquet files of other programs, and damaged ones.

use crate::telemetry::{Folder, map_of};
use poinsot_telemetry::{ColumnMap, ReadOptions, read};
use std::path::{Path, PathBuf};

/// A file of pyarrow: tests/data/columns.py.
fn made(name: &str) -> PathBuf {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    data.join(name)
}

fn options() -> ReadOptions {
    let columns = vec![
        ColumnMap::new("time_s", "t_ns", "ns"),
        ColumnMap::new("omega_x", "wx", "rad/s"),
    ];
    let rows = vec![("log".into(), "b".into()), ("group".into(), "g".into())];
    ReadOptions {
        map: map_of(columns, rows),
        ..ReadOptions::default()
    }
}

#[test]
fn xval_runs_of_another_writer_with_empty_cells_and_dictionaries() {
    let table = read(&[made("runs.parquet")], &options()).unwrap();
    let x = table.channel("omega_x").unwrap();
    assert_eq!(x.values, [f64::from(0.1_f32), 5.0]);
    assert_eq!(x.time_s.as_ref(), [0.0, 0.2]);
    assert_eq!(table.channel("wheel1_rad_s").unwrap().values, [2.0, 3.0]);
    assert_eq!(table.channel("thr1_N").unwrap().values, [1.0, 0.0, 1.0]);
    assert_eq!(table.repairs.len(), 1);
    assert!(table.repairs[0].ends_with(
        "runs.parquet row 4 column 'wx': 1 NaN cells treated as missing samples (this is the first)"
    ));
    assert!(table.ignored.is_empty());
}

/// The time and one column as rate of the gyro.
fn rate(file: &str, time: &str, column: &str) -> Result<poinsot_telemetry::Table, String> {
    let columns = vec![
        ColumnMap::new("time_s", time, "s"),
        ColumnMap::new("omega_x", column, "rad/s"),
    ];
    let options = ReadOptions {
        map: map_of(columns, Vec::new()),
        ..ReadOptions::default()
    };
    read(&[made(file)], &options).map_err(|e| e.to_string())
}

#[test]
fn xval_every_type_of_number_of_another_writer_is_read() {
    let wanted: [(&str, [f64; 2]); 8] = [
        ("int8", [-128.0, 127.0]),
        ("int16", [-32_768.0, 32_767.0]),
        ("int32", [-2_147_483_648.0, 2_147_483_647.0]),
        ("int64", [-4_503_599_627_370_496.0, 4_503_599_627_370_496.0]),
        ("uint8", [0.0, 255.0]),
        ("uint16", [0.0, 65_535.0]),
        ("uint32", [0.0, 4_294_967_295.0]),
        ("uint64", [0.0, 9_223_372_036_854_775_808.0]),
    ];
    for (column, values) in wanted {
        let table = rate("types.parquet", "ns", column).unwrap();
        assert_eq!(table.channel("omega_x").unwrap().values, values, "{column}");
    }
    let table = rate("types.parquet", "ns", "nothing").unwrap();
    assert!(table.channel("omega_x").is_none_or(|c| c.values.is_empty()));
}

#[test]
fn unit_types_that_are_not_read_are_named() {
    for (column, kind) in [
        ("text", "text"),
        ("us", "timestamp"),
        ("bytes", "BYTE_ARRAY"),
        ("date", "Date"),
        ("time", "Time"),
        ("decimal", "Decimal"),
        ("half", "Float16"),
        ("list", "list or structure"),
        ("structure", "list or structure"),
    ] {
        let error = rate("types.parquet", "ns", column).unwrap_err();
        let says = format!("types.parquet column '{column}': type {kind}");
        assert!(error.contains(&says), "{error}");
        assert!(error.ends_with(
            " is not supported; store numbers as float64, times as seconds or timestamps; write the file again, or convert it to CSV"
        ), "{error}");
    }
}

#[test]
fn unit_an_infinite_number_names_file_row_and_column() {
    let error = rate("types.parquet", "ns", "infinite").unwrap_err();
    assert!(error.contains(
        "types.parquet row 2 column 'infinite': '-inf' is infinite; correct it, or leave the cell empty where there is no sample"
    ), "{error}");
}

#[test]
fn unit_a_time_that_goes_back_names_file_row_and_column() {
    let unfiltered = ReadOptions {
        map: map_of(options().map.all.columns, Vec::new()),
        ..options()
    };
    let error = read(&[made("runs.parquet")], &unfiltered).unwrap_err();
    let error = error.to_string();
    assert!(error.contains(
        "runs.parquet row 3 column 't_ns': time goes back from 0.1 s (row 2) to 0 s; choose one run by [telemetry] where, or cut the file into segments"
    ), "{error}");
}

/// Every truncation and many single-byte changes: an error or a table, never a panic.
#[test]
fn prop_damaged_files_are_refused_cleanly() {
    let folder = Folder::new();
    let whole = std::fs::read(made("runs.parquet")).unwrap();
    let path = folder.path("damaged.parquet");
    for cut in (0..whole.len()).step_by(7) {
        std::fs::write(&path, &whole[..cut]).unwrap();
        let error = read(&[&path], &options()).unwrap_err();
        assert_eq!(error.code(), "E0216", "{error}");
    }
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 0xff;
        std::fs::write(&path, &bytes).unwrap();
        let _ = read(&[&path], &options());
    }
}

/// Found by libFuzzer: a page header with an endless list was skipped by one empty read at a time.
#[test]
fn regress_a_list_without_end_in_a_page_header_is_refused_at_once() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/parquet");
    let error = read(&[corpus.join("endless.parquet")], &ReadOptions::default()).unwrap_err();
    assert_eq!(error.code(), "E0216", "{error}");
    // Reported by the guard after a few empty reads; without it the decoder ends with another error.
    let error = error.to_string();
    assert!(
        error.contains("the file ends inside a page header"),
        "{error}"
    );
}

/// Found by libFuzzer: the decoder allocated the 15 GB declared in the header of a dictionary.
#[test]
fn regress_a_dictionary_that_declares_more_than_it_holds_is_refused() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/parquet");
    let file = corpus.join("huge_dictionary.parquet");
    let error = read(&[file], &ReadOptions::default()).unwrap_err();
    assert_eq!(error.code(), "E0216", "{error}");
    let error = error.to_string();
    assert!(
        error.contains("a dictionary of column 'omega_x' declares"),
        "{error}"
    );
}

/// 400 rows in two groups, pages of about 64 rows, a dictionary in `omega_y`. Made by pyarrow 26 with
/// `write_page_checksum=True, row_group_size=200, data_page_size=512, write_batch_size=64`; data pages of versions 1
/// and 2.
fn with_checksums(version: &str) -> Vec<u8> {
    std::fs::read(made(&format!("checksums_{version}.parquet"))).unwrap()
}

/// One changed byte anywhere before the footer: if a checksum detects it, the file is refused, and --recover keeps
/// only correct rows.
#[test]
fn regress_a_changed_page_is_refused_and_the_rows_before_it_are_kept() {
    let folder = Folder::new();
    let path = folder.path("sums.parquet");
    for version in ["v1", "v2"] {
        let good = with_checksums(version);
        std::fs::write(&path, &good).unwrap();
        let whole = read(&[&path], &ReadOptions::default()).unwrap();
        assert_eq!(whole.sources[0].rows, 400, "{version}");
        let recover = ReadOptions {
            recover: true,
            ..ReadOptions::default()
        };
        let footer = &good[good.len() - 8..good.len() - 4];
        let footer = u32::from_le_bytes(footer.try_into().unwrap()) as usize;
        let (mut refused, mut recovered) = (0, 0);
        for at in (4..good.len() - 8 - footer).step_by(41) {
            let mut bad = good.clone();
            bad[at] ^= 0x10;
            std::fs::write(&path, &bad).unwrap();
            let Err(error) = read(&[&path], &ReadOptions::default()) else {
                continue;
            };
            if !error.to_string().contains("does not match its checksum") {
                continue;
            }
            refused += 1;
            let Ok(table) = read(&[&path], &recover) else {
                continue;
            };
            recovered += 1;
            let rows = table.sources[0].rows;
            assert!(rows < 400, "{version}, byte {at}");
            for (kept, all) in table.channels.iter().zip(&whole.channels) {
                assert_eq!(kept.values[..], all.values[..rows], "{version}, byte {at}");
            }
        }
        assert!(
            refused > 150 && recovered > 100,
            "{version}: {refused} refused, {recovered} recovered"
        );
    }
}

/// Timestamps of pandas and Spark: instants since 1970, with and without a zone.
#[test]
fn xval_columns_of_timestamps_are_times_with_a_date() {
    for (file, time, second) in [
        ("types.parquet", "ns", 0.200_000_001),
        ("types.parquet", "us", 0.2),
        ("types.parquet", "ms", 0.2),
        ("int96.parquet", "ns", 0.200_000_001),
    ] {
        let table = rate(file, time, "int8").unwrap();
        let times = table.channels[0].time_s.as_ref();
        assert_eq!(times, [0.0, second], "{file} {time}");
        let date = table.origin.and_then(|o| o.date());
        assert_eq!(date.as_deref(), Some("2026-03-14T18:19:00.1 UTC"));
    }
}
