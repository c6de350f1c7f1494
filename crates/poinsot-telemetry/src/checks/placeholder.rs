//! Values that mean "no sample".

use crate::Channel;
use crate::median::{ends, spread};
use poinsot_files::{as_read, counted};

/// Finds a value that repeats in at least 1 % of the samples, more than 20 robust sigmas from every other value: the limit that a wheel
/// reaches and stays at is a value.
pub(super) fn find(channel: &Channel) -> Option<(Vec<usize>, String)> {
    let values = &channel.values;
    let (_, sigma) = spread(values).filter(|(_, sigma)| *sigma > 0.0)?;
    let near = |a: f64, b: f64| a != b && (a - b).abs() <= 20.0 * sigma;
    let (value, count) = ends(values)
        .into_iter()
        .map(|x| (x, values.iter().filter(|v| **v == x).count()))
        .find(|(x, count)| {
            *count >= 2 && count * 100 >= values.len() && !values.iter().any(|v| near(*v, *x))
        })?;
    let samples = (values.iter().enumerate())
        .filter(|(_, x)| **x == value)
        .map(|(k, _)| k)
        .collect();
    let (value, count) = (as_read(value), counted(count, "sample"));
    let text = format!(
        "{value} occurs in {count}, far from all others: probably a placeholder; write it as invalid in its column of the map, or use --policy placeholder=exclude"
    );
    Some((samples, text))
}
