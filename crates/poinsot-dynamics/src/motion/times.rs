//! The times at which a motion is sampled.

use std::borrow::Cow;

/// Output times of a motion, s, which must not decrease.
///
/// ```
/// use poinsot_dynamics::Times;
///
/// let times = Times::Even { rows: 3, rate_hz: 2.0 };
/// assert!(times.iter().eq([0.0, 0.5, 1.0]));
/// assert_eq!(Times::from(&[0.0, 4.0]).get(1), Some(4.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Times<'t> {
    /// `k / rate_hz` from `k = 0`; takes no memory.
    Even {
        /// How many.
        rows: usize,
        /// Rate, Hz.
        rate_hz: f64,
    },
    /// A list.
    Listed(Cow<'t, [f64]>),
}

impl<'t, L: Into<Cow<'t, [f64]>>> From<L> for Times<'t> {
    fn from(list: L) -> Self {
        Self::Listed(list.into())
    }
}

impl Times<'_> {
    /// How many.
    pub fn count(&self) -> usize {
        match self {
            Self::Even { rows, .. } => *rows,
            Self::Listed(list) => list.len(),
        }
    }

    /// One of them, counted from 0.
    pub fn get(&self, k: usize) -> Option<f64> {
        match self {
            Self::Even { rows, rate_hz } => (k < *rows).then(|| k as f64 / rate_hz),
            Self::Listed(list) => list.get(k).copied(),
        }
    }

    /// The last; `None` without any.
    pub fn last(&self) -> Option<f64> {
        self.get(self.count().checked_sub(1)?)
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = f64> {
        (0..self.count()).filter_map(|k| self.get(k))
    }

    /// The first that is not before `t`.
    pub(crate) fn not_before(&self, t: f64) -> Option<f64> {
        let near = match self {
            // To round-off.
            Self::Even { rate_hz, .. } => ((t * rate_hz) as usize).saturating_sub(1),
            Self::Listed(list) => list.partition_point(|x| *x < t),
        };
        (near..).map_while(|k| self.get(k)).find(|x| *x >= t)
    }
}
