//! One size of the filter, for the ground.

use crate::filter::Filter;

/// A [`Filter`] with room for any configuration (eight wheels, seven joints, ten unknown numbers, a position and a bias that walks), and for
/// 300 samples in its first window.
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
pub type GroundFilter = Filter<87, 300>;
