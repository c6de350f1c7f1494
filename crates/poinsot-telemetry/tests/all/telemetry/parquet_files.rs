//! Parquet files of other programs, and damaged ones.

use crate::telemetry::Folder;
use arrow_array::types::Int8Type;
use arrow_array::{
    ArrayRef, DictionaryArray, Float32Array, Int64Array, LargeStringArray, RecordBatch,
    TimestampMicrosecondArray, TimestampNanosecondArray,
};
use arrow_array::{BooleanArray, Float64Array, StringArray};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::properties::WriterProperties;
use poinsot_telemetry::{ColumnMap, ReadOptions, TelemetryError, TelemetryMap, read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn store(path: &Path, columns: Vec<(&str, ArrayRef)>, compression: Compression) {
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let properties = WriterProperties::builder()
        .set_compression(compression)
        .build();
    let file = std::fs::File::create(path).unwrap();
    let mut writer = ArrowWriter::try_new(file, batch.schema(), Some(properties)).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
}

fn sample(folder: &Folder) -> PathBuf {
    let path = folder.path("run.parquet");
    let log: DictionaryArray<Int8Type> = ["a", "a", "b", "b", "b"].into_iter().collect();
    store(
        &path,
        vec![
            ("group", Arc::new(LargeStringArray::from(vec!["g"; 5]))),
            ("log", Arc::new(log)),
            (
                "t_ns",
                Arc::new(Int64Array::from(vec![
                    0,
                    100_000_000,
                    0,
                    100_000_000,
                    200_000_000,
                ])),
            ),
            (
                "wx",
                Arc::new(Float32Array::from(vec![1.0, 2.0, 0.1, f32::NAN, 5.0])),
            ),
            (
                "wheel1_rad_s",
                Arc::new(Float64Array::from(vec![
                    None,
                    Some(1.0),
                    None,
                    Some(2.0),
                    Some(3.0),
                ])),
            ),
            (
                "thr1_N",
                Arc::new(BooleanArray::from(vec![true, false, true, false, true])),
            ),
        ],
        Compression::ZSTD(ZstdLevel::default()),
    );
    path
}

fn options() -> ReadOptions {
    let columns = vec![
        ColumnMap::new("time_s", "t_ns", "ns"),
        ColumnMap::new("omega_x", "wx", "rad/s"),
    ];
    let rows = vec![("log".into(), "b".into()), ("group".into(), "g".into())];
    ReadOptions {
        map: TelemetryMap::of(columns, rows),
        ..ReadOptions::default()
    }
}

#[test]
fn exact_types_nulls_and_dictionaries() {
    let folder = Folder::new();
    let path = sample(&folder);
    let table = read(&[&path], &options()).unwrap();
    let x = table.channel("omega_x").unwrap();
    assert_eq!(x.values, [f64::from(0.1_f32), 5.0]);
    assert_eq!(x.time_s.as_ref(), [0.0, 0.2]);
    assert_eq!(table.channel("wheel1_rad_s").unwrap().values, [2.0, 3.0]);
    assert_eq!(table.channel("thr1_N").unwrap().values, [1.0, 0.0, 1.0]);
    assert_eq!(table.repairs.len(), 1);
    assert!(table.repairs[0].ends_with(
        "run.parquet row 4 column 'wx': 1 NaN cells treated as missing samples (this is the first)"
    ));
    assert!(table.ignored.is_empty());
}

#[test]
fn unit_faults_name_file_row_and_column() {
    let folder = Folder::new();
    let path = sample(&folder);
    let unfiltered = ReadOptions {
        map: TelemetryMap::of(options().map.all.columns, Vec::new()),
        ..options()
    };
    let error = read(&[&path], &unfiltered).unwrap_err();
    assert_eq!(
        folder.message(&error),
        "E0208 run.parquet row 3 column 't_ns': time goes back from 0.1 s (row 2) to 0 s; choose one run by [telemetry] where, or cut the file into segments"
    );
    let path = folder.path("text.parquet");
    let text: ArrayRef = Arc::new(StringArray::from(vec!["1", "2"]));
    let time: ArrayRef = Arc::new(Float64Array::from(vec![0.0, 1.0]));
    store(
        &path,
        vec![("time_s", Arc::clone(&time)), ("omega_x", text)],
        Compression::SNAPPY,
    );
    let error = read(&[&path], &ReadOptions::default()).unwrap_err();
    assert_eq!(
        folder.message(&error),
        "E0216 text.parquet column 'omega_x': type Utf8 is not supported; store numbers as float64, times as seconds or timestamps; write the file again, or convert it to CSV"
    );
    let path = folder.path("inf.parquet");
    let inf: ArrayRef = Arc::new(Float64Array::from(vec![0.0, f64::NEG_INFINITY]));
    store(
        &path,
        vec![("time_s", time), ("omega_x", inf)],
        Compression::SNAPPY,
    );
    let error = read(&[&path], &ReadOptions::default()).unwrap_err();
    assert_eq!(
        folder.message(&error),
        "E0203 inf.parquet row 2 column 'omega_x': '-inf' is infinite; correct it, or leave the cell empty where there is no sample"
    );
}

/// Every truncation and many single-byte changes: an error or a table, never a panic.
#[test]
fn prop_damaged_files_are_refused_cleanly() {
    let folder = Folder::new();
    let whole = std::fs::read(sample(&folder)).unwrap();
    let path = folder.path("damaged.parquet");
    for cut in (0..whole.len()).step_by(7) {
        std::fs::write(&path, &whole[..cut]).unwrap();
        let error = read(&[&path], &options()).unwrap_err();
        assert!(matches!(error, TelemetryError::Parquet { .. }), "{error}");
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
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    std::fs::read(data.join(format!("checksums_{version}.parquet"))).unwrap()
}

#[test]
fn xval_checksums_of_another_writer_are_compared_and_reported() {
    let folder = Folder::new();
    for version in ["v1", "v2"] {
        let path = folder.path("sums.parquet");
        std::fs::write(&path, with_checksums(version)).unwrap();
        let table = read(&[&path], &ReadOptions::default()).unwrap();
        assert_eq!(table.sources[0].rows, 400);
        let said = table.repairs.iter().find(|r| r.contains("checksums of"));
        let said = said.unwrap_or_else(|| panic!("{version}: {:?}", table.repairs));
        let words: Vec<&str> = said.split(' ').collect();
        let count = |k: usize| words[k].parse::<usize>().unwrap();
        // At least one page for each of four columns in two groups.
        assert!(count(3) >= 8 && count(3) == count(5), "{said}");
    }
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
fn exact_columns_of_timestamps_are_times_with_a_date() {
    let folder = Folder::new();
    let start = 1_773_512_340_100_000_000_i64;
    let nanoseconds = TimestampNanosecondArray::from(vec![start, start + 200_000_001]);
    let microseconds = [start / 1000, start / 1000 + 200_000];
    let zoned = TimestampMicrosecondArray::from(microseconds.to_vec()).with_timezone("UTC");
    let times: [(&str, ArrayRef, f64); 2] = [
        ("ns.parquet", Arc::new(nanoseconds), 0.200_000_001),
        ("us.parquet", Arc::new(zoned), 0.2),
    ];
    for (name, time, second) in times {
        let path = folder.path(name);
        let rates: ArrayRef = Arc::new(Float64Array::from(vec![0.1, 0.2]));
        store(
            &path,
            vec![("time_s", time), ("omega_x", rates)],
            Compression::UNCOMPRESSED,
        );
        let table = read(&[&path], &ReadOptions::default()).unwrap();
        assert_eq!(table.channels[0].time_s.as_ref(), [0.0, second], "{name}");
        let date = table.origin.and_then(|o| o.date());
        assert_eq!(date.as_deref(), Some("2026-03-14T18:19:00.1 UTC"));
    }
}
