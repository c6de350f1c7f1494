//! Reduces curves to the size limit of a page: from every stretch the samples with least and greatest residual are
//! kept.

use minijinja::{Value, context};
use poinsot_formats::{Channel, Segment};

/// Largest number of values of all curves of a page: about half a megabyte.
const NUMBERS: usize = 180_000;
/// Fewest points kept of a curve.
const FEWEST: usize = 60;

/// Fraction of every curve that is kept.
pub(super) struct Envelope {
    share: f64,
    /// Number of samples in the files per sample of `report_data.json`.
    thinned: usize,
}

impl Envelope {
    pub fn of(segments: &[Segment]) -> Self {
        let channel = |c: &Channel| c.time_s.len() * (2 + 3 * c.residual.len());
        let numbers = |s: &Segment| -> usize {
            let motion = s.time_s.len() * (5 + s.joints.len() + s.wheels.len());
            motion + channel(&s.momentum) + s.channels.iter().map(channel).sum::<usize>()
        };
        let all: usize = segments.iter().map(numbers).sum();
        let channels = segments.iter().flat_map(|s| &s.channels);
        Self {
            share: (NUMBERS as f64 / all.max(1) as f64).min(1.0),
            thinned: channels
                .map(|c| c.samples.div_ceil(c.time_s.len().max(1)))
                .max()
                .unwrap_or(1),
        }
    }

    /// Numbers for the note of the page.
    pub fn note(&self) -> Value {
        context! { share => self.share, thinned => self.thinned }
    }

    fn most(&self, samples: usize) -> usize {
        ((self.share * samples as f64) as usize).max(FEWEST)
    }

    /// Indices of the kept samples of rows over time, in order.
    pub fn keep(&self, time_s: &[f64], rows: &[Vec<f64>]) -> Vec<usize> {
        let (n, most) = (time_s.len(), self.most(time_s.len()));
        if n <= most {
            return (0..n).collect();
        }
        let stretch = n.div_ceil((most / (2 * rows.len().max(1))).max(1));
        let mut kept = Vec::new();
        for from in (0..n).step_by(stretch) {
            let places = from..(from + stretch).min(n);
            for row in rows {
                let order = |a: &usize, b: &usize| row[*a].total_cmp(&row[*b]);
                kept.extend(places.clone().min_by(order));
                kept.extend(places.clone().max_by(order));
            }
        }
        kept.sort_unstable();
        kept.dedup();
        kept
    }

    /// Step between the kept samples of a smooth curve.
    pub fn stride(&self, samples: usize) -> usize {
        samples.div_ceil(self.most(samples)).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_the_envelope_keeps_what_stands_out() {
        let n = 10_000;
        let mut c = Channel {
            time_s: (0..n).map(f64::from).collect(),
            residual: vec![(0..n).map(|k| (0.1 * f64::from(k)).sin()).collect()],
            ..Channel::default()
        };
        c.residual[0][4321] = 7.0;
        let half = Envelope {
            share: 0.02,
            thinned: 1,
        };
        let kept = half.keep(&c.time_s, &c.residual);
        assert!(kept.contains(&4321));
        assert!(kept.len() <= 202, "{}", kept.len());
        assert!(kept.is_sorted());
    }
}
