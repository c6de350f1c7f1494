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
    let mut steps: Vec<f64> = time_s
        .iter()
        .zip(time_s.iter().skip(1))
        .map(|(a, b)| b - a)
        .collect();
    median(&mut steps)
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
