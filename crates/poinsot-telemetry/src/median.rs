//! Medians.

/// Median of the steps between increasing times, s; `None` for fewer than two times.
///
/// ```
/// use poinsot_telemetry::median_step;
///
/// assert_eq!(median_step(&[0.0, 1.0, 2.0, 10.0]), Some(1.0));
/// assert_eq!(median_step(&[0.0]), None);
/// ```
pub fn median_step(time_s: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = time_s.windows(2).map(|t| t[1] - t[0]).collect();
    median(&mut steps)
}

/// Least and largest value.
pub(crate) fn ends(values: &[f64]) -> [f64; 2] {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [least, largest]
}

/// Median (upper of the two middle values); reorders the slice. `None` if empty.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    let (_, value, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*value)
}

/// Median of a normal magnitude over its sigma.
const MEDIAN_OF_NORMAL: f64 = 0.6745;

/// Robust sigma from the median of magnitudes.
pub(crate) fn sigma_of(median_magnitude: f64) -> f64 {
    median_magnitude / MEDIAN_OF_NORMAL
}

/// Median, and robust sigma: median of the distances from it over 0.6745.
pub(crate) fn spread(values: &[f64]) -> Option<(f64, f64)> {
    let centre = median(&mut values.to_vec())?;
    let mut distances: Vec<f64> = values.iter().map(|x| (x - centre).abs()).collect();
    Some((centre, sigma_of(median(&mut distances)?)))
}
