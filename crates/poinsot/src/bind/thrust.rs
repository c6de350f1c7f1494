//! Converts thrust columns to firings: a value holds until the next sample.

use super::channels::Channels;
use poinsot_identify::{Firing, Samples};
use poinsot_model::Model;

/// Firings of every thruster with a column; others are off.
pub(super) fn firings(
    model: &Model,
    channels: &Channels,
    samples: &Samples,
    repairs: &mut Vec<String>,
) -> Vec<Firing> {
    let mut list = Vec::new();
    let mut off = Vec::new();
    for (thruster, item) in model.thrusters.iter().enumerate() {
        let Some(channel) = channels.find(None, &format!("{}_N", item.name)) else {
            off.push(item.name.as_str());
            continue;
        };
        let mut pairs = channel.time_s.iter().zip(&channel.values).peekable();
        while let Some((&start_s, &force)) = pairs.next() {
            if force == 0.0 {
                continue;
            }
            let mut end_s = start_s;
            // Consecutive equal values are one firing.
            while let Some(&(&next, &value)) = pairs.peek() {
                end_s = next;
                if value != force {
                    break;
                }
                pairs.next();
            }
            if pairs.peek().is_none() {
                end_s = samples.time_s.last().copied().unwrap_or(end_s).max(end_s);
            }
            list.push(Firing {
                thruster,
                start_s,
                end_s,
                force,
            });
        }
    }
    if !off.is_empty() {
        repairs.push(format!(
            "{}: no column for {}: assumed off",
            channels.label,
            off.join(", ")
        ));
    }
    list.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
    list
}
