//! The kernels give the same numbers with `std` and with `libm`: run by `scripts/test policy` for the second.

use poinsot_without_std::values;
use std::path::Path;

const STATES: u32 = 8;

/// Equal to 1e-12 of the largest number of a state, with the numbers that the standard library's functions gave.
/// `POINSOT_BLESS=1` writes them.
#[test]
fn xval_kernels_without_the_standard_library_give_the_same_numbers() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/digits_with_std.txt");
    let found = values(STATES);
    if cfg!(feature = "std") && std::env::var_os("POINSOT_BLESS").is_some() {
        let lines: Vec<String> = found.iter().map(|x| format!("{x:e}\n")).collect();
        std::fs::write(&file, lines.concat()).unwrap();
    }
    let text = std::fs::read_to_string(&file).unwrap();
    let recorded: Vec<f64> = text.lines().map(|line| line.parse().unwrap()).collect();
    assert_eq!(found.len(), recorded.len());
    let off = found
        .iter()
        .zip(&recorded)
        .map(|(a, b)| (a - b).abs() / b.abs().max(1.0));
    let worst = off.fold(0.0, f64::max);
    println!(
        "{} numbers, largest relative difference {worst:.1e}",
        found.len()
    );
    assert!(worst < 1.0e-12, "{worst:e}");
}
