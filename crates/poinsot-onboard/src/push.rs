//! A sample on its way into the filter.

use crate::configuration::Configuration;
use crate::filter::Filter;
use crate::sample::Sample;
use crate::stream::Refusal;

/// Largest deviation of a quaternion's length from one.
const LENGTH: f64 = 1.0e-3;

/// The sample with a quaternion of length one.
fn checked(sample: &Sample, configuration: &Configuration) -> Result<Sample, Refusal> {
    let mut sample = *sample;
    let (wheels, joints) = (configuration.wheel_count, configuration.joint_count);
    sample
        .wheel_speed
        .iter_mut()
        .skip(wheels)
        .for_each(|x| *x = 0.0);
    for list in [&mut sample.joint_position, &mut sample.joint_rate] {
        list.iter_mut().skip(joints).for_each(|x| *x = 0.0);
    }
    let vectors = [sample.gyro, sample.position]
        .into_iter()
        .flatten()
        .flatten();
    let acting = sample.force_B.into_iter().chain(sample.torque_B);
    let attitude = sample.attitude.into_iter().flatten();
    let mut all = vectors
        .chain(acting)
        .chain(sample.inputs())
        .chain(attitude)
        .chain([sample.time_s]);
    if !all.all(f64::is_finite) {
        return Err(Refusal::NotFinite);
    }
    if let Some(q) = &mut sample.attitude {
        let length = nalgebra::Vector4::from(*q).norm();
        if (length - 1.0).abs() > LENGTH {
            return Err(Refusal::Quaternion);
        }
        *q = q.map(|x| x / length);
    }
    Ok(sample)
}

impl<const N: usize, const WINDOW: usize> Filter<N, WINDOW> {
    /// Takes a sample. The first samples, at most `WINDOW`, are kept. From a tenth of the window on (with modes when it is full), and
    /// each time that it has grown by a third, they are replayed, linearised at the parameters of the pass before, until no
    /// parameter moves by more than a tenth of its sigma (at most 24 passes). Where the parameters are known well enough the window
    /// ends, and each sample is one step.
    ///
    /// # Errors
    /// The sample is not used, and the filter is as before.
    pub fn push(&mut self, sample: &Sample) -> Result<(), Refusal> {
        let sample = checked(sample, &self.configuration)?;
        self.stream
            .insert(sample, self.configuration.longest_gap_s)?;
        while let Some(next) = self.stream.next(self.configuration.reorder) {
            self.process(&next);
        }
        Ok(())
    }

    /// Takes the samples that are held back, at the end of a stream.
    pub fn flush(&mut self) {
        while let Some(next) = self.stream.next(0) {
            self.process(&next);
        }
    }
}
