//! The filter compiled in this crate, which is optimised: generic code is compiled where it is used.

use crate::answer::Answer;
use crate::check::Invalid;
use crate::configuration::Configuration;
use crate::filter::Filter;
use crate::health::{SENSORS, SensorCounts};
use crate::layout::COLUMNS;
use crate::sample::Sample;
use crate::stream::Refusal;

/// Samples of the first window.
const WINDOW: usize = 300;

/// A [`Filter`] with room for any configuration, and for 300 samples in its first window.
///
/// ```
/// use poinsot_onboard::{Configuration, GroundFilter, Health, Invalid, Noise, Sample};
///
/// let noise = Noise { gyro: 1e-4, attitude: 1e-4, position: 0.0, bias: 1e-4, bias_walk: 0.0, torque_walk: 0.0 };
/// let cube = [6.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0];
/// let mut filter = GroundFilter::new(Configuration::new(cube, noise))?;
/// let mut sample = Sample::at(0.0);
/// sample.gyro = Some([0.1, 0.0, 0.0]);
/// assert!(filter.push(&sample).is_ok());
/// filter.flush();
/// assert_eq!((filter.answer(0.1).health, filter.counts()[0].gated), (Health::Converging, 0));
/// # Ok::<(), Invalid>(())
/// ```
#[derive(Debug, Clone)]
pub struct GroundFilter(Filter<COLUMNS, WINDOW>);

impl GroundFilter {
    /// As [`Filter::new`].
    ///
    /// # Errors
    /// As there.
    #[inline(never)]
    pub fn new(configuration: Configuration) -> Result<Self, Invalid> {
        Filter::new(configuration).map(Self)
    }

    /// As [`Filter::push`].
    ///
    /// # Errors
    /// As there.
    #[inline(never)]
    pub fn push(&mut self, sample: &Sample) -> Result<(), Refusal> {
        self.0.push(sample)
    }

    /// As [`Filter::flush`].
    #[inline(never)]
    pub fn flush(&mut self) {
        self.0.flush();
    }

    /// As [`Filter::answer`].
    #[inline(never)]
    pub fn answer(&self, time_s: f64) -> Answer {
        self.0.answer(time_s)
    }

    /// As [`Filter::counts`].
    pub fn counts(&self) -> [SensorCounts; SENSORS] {
        self.0.counts()
    }
}
