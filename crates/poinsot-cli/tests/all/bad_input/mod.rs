//! Every fault of `validation/bad_input/`: printed message, exit code, files left.
//!
//! `POINSOT_CASE=T1_nan` runs the cases whose file names begin so. `POINSOT_BLESS=1` writes what the program prints into
//! the case files. The book makes a page of them.

mod bench;
mod bless;
mod case;
mod cells;
mod changes;
mod check;
mod code;
mod faults;
mod sheet;
mod sources;

use case::{File, file, of_section};
use faults::{SECTIONS, names};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// One test for each section.
macro_rules! sections {
    ($($test:ident: $section:literal,)*) => {
        $(
            #[test]
            fn $test() {
                run($section);
            }
        )*

        #[test]
        fn exact_every_section_has_a_test() {
            assert_eq!(SECTIONS, [$($section),*]);
        }
    };
}

sections! {
    cli_faults_of_telemetry: "telemetry",
    cli_faults_of_results: "results",
    cli_faults_of_files: "files",
    cli_faults_of_models: "models",
    cli_faults_of_security: "security",
    cli_faults_of_other_codes: "codes",
}

/// Runs the cases of a section.
fn run(section: &str) {
    let files = chosen(section);
    let wrong = on_threads(&files, bless::check);
    assert!(wrong.is_empty(), "{wrong}");
}

/// The cases of a section that `POINSOT_CASE` names, or all.
fn chosen(section: &str) -> Vec<File> {
    let Ok(wanted) = std::env::var("POINSOT_CASE") else {
        return of_section(section);
    };
    let is = |stem: &str| stem.starts_with(&wanted);
    let mut all = SECTIONS.iter().flat_map(|s| names(s).unwrap());
    let anywhere = all.any(|(stem, _)| is(&stem));
    assert!(anywhere, "no case file begins with {wanted:?}");
    let here = names(section)
        .unwrap()
        .into_iter()
        .filter(|(stem, _)| is(stem));
    here.map(|(stem, path)| file(stem, path)).collect()
}

/// Checks the cases on two threads; returns the faults in order.
fn on_threads(files: &[File], check: fn(&File) -> Vec<String>) -> String {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some((k, file)) = {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    files.get(k).map(|f| (k, f))
                } {
                    let wrong = check(file);
                    done.lock().unwrap().push((k, file.stem.clone(), wrong));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap();
    done.sort();
    done.retain(|(_, _, wrong)| !wrong.is_empty());
    let faults = done
        .iter()
        .map(|(_, stem, wrong)| format!("\n{stem}: {}\n", wrong.join("; ")));
    faults.collect()
}
