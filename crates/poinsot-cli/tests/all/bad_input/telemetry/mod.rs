//! 2a: faults within telemetry.

mod cells;
mod exports;
mod motions;
mod sensors;
mod times;
mod units;

use crate::bad_input::bench::Sheet;
use crate::bad_input::row::Row;

const QUATERNION: [&str; 4] = ["q_x", "q_y", "q_z", "q_w"];

fn noise(k: usize) -> f64 {
    // A fixed pseudo-random sequence between -1 and 1.
    let x = (k as f64 * 12.9898 + 4.1).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

fn angle(w: f64) -> f64 {
    w * 180.0 / std::f64::consts::PI
}

fn rpm(w: f64) -> f64 {
    w * 30.0 / std::f64::consts::PI
}

fn swap(sheet: &mut Sheet, a: &str, b: &str) {
    let (a, b) = (sheet.column(a), sheet.column(b));
    sheet.header.swap(a, b);
}

fn drop_rows(sheet: &mut Sheet, keep: impl Fn(usize) -> bool) {
    let mut k = 0;
    sheet.rows.retain(|_| {
        k += 1;
        keep(k - 1)
    });
}

pub fn rows() -> Vec<Row> {
    let mut all = cells::rows();
    all.extend(times::rows());
    all.extend(units::rows());
    all.extend(sensors::rows());
    all.extend(motions::rows());
    all.extend(exports::rows());
    all
}
