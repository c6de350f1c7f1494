//! Files that crashed other readers: the result is a table or one error line, within a time limit.

use poinsot_telemetry::{ColumnMap, ReadOptions, read};
use poinsot_testkit::outside::outside;
use std::path::{Path, PathBuf};
use std::time::Instant;

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut list: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .flatten()
        .map(|e| e.path())
        .filter(|p| p.is_file() && p.file_name().is_some_and(|n| n != "README.md"))
        .collect();
    list.sort();
    list
}

/// Reads a file under a name with the suffix of its kind, trying every column as time.
fn outcome(path: &Path, kind: &str) -> Result<usize, String> {
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join(format!("x.{kind}"));
    std::fs::copy(path, &copy).unwrap();
    let mut options = ReadOptions::default();
    let start = Instant::now();
    let mut answer = read(&[&copy], &options);
    if let Err(error) = &answer
        && error.code() == "E0207"
    {
        // No column is called time_s: use the first column named in the message.
        let text = error.to_string();
        let name = text
            .split(" among [")
            .nth(1)
            .and_then(|t| t.split([',', ']']).next());
        options.map.all.columns = vec![ColumnMap::new("time_s", name.unwrap_or_default(), "s")];
        answer = read(&[&copy], &options);
    }
    assert!(start.elapsed().as_secs_f64() < 1.0, "{}", path.display());
    answer.map(|t| t.channels.len()).map_err(|e| {
        let text = e.to_string();
        assert!(text.starts_with(e.code()) && !text.contains('\n'), "{text}");
        text
    })
}

fn count(files: &[PathBuf], kind: &str) -> (usize, usize) {
    let (mut good, mut refused) = (0, 0);
    for path in files {
        match outcome(path, kind) {
            Ok(_) => good += 1,
            Err(_) => refused += 1,
        }
    }
    (good, refused)
}

#[test]
#[ignore = "needs POINSOT_DATA"]
fn cli_parquet_files_of_fuzzers_and_of_bad_data() {
    let arrow = outside("corpora/arrow_testing/data/parquet");
    let bad = outside("corpora/parquet_testing/bad_data");
    let mut fuzzed = files(&arrow.join("fuzzing"));
    fuzzed.extend(files(&arrow.join("encoding-fuzzing")));
    let bad = files(&bad);
    assert_eq!((fuzzed.len(), bad.len()), (141, 8));
    println!("fuzzed (read, refused): {:?}", count(&fuzzed, "parquet"));
    println!("bad data (read, refused): {:?}", count(&bad, "parquet"));
}

#[test]
#[ignore = "needs POINSOT_DATA"]
fn cli_csv_files_of_fuzzers() {
    let folder = outside("corpora/arrow_testing/data/csv/fuzzing");
    let all = files(&folder);
    assert!(all.len() >= 7);
    println!("(read, refused): {:?}", count(&all, "csv"));
}

#[test]
#[ignore = "needs POINSOT_DATA"]
fn cli_csv_spectrum() {
    let folder = outside("corpora/csv_spectrum/csvs");
    let all = files(&folder);
    assert_eq!(all.len(), 12);
    println!("(read, refused): {:?}", count(&all, "csv"));
}
