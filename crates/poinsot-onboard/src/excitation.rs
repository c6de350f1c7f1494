//! What of the motion the record has shown.

use crate::configuration::{Configuration, INPUTS, ITERATIONS, JOINTS, of_joint, of_rate};
use crate::numbers::{AXES, WHEELS};
use crate::placed::Placed;
use crate::sample::Sample;
use nalgebra::{ArrayStorage, SymmetricEigen};
use poinsot_spatial::{Matrix3, TENSOR, angular};

/// Samples that an excitation is remembered for.
const MEMORY: f64 = 1000.0;
/// Squares of a velocity that may be an error of the estimate, in its variance: the mean of many samples, and the sum of the few that begin
/// a motion.
const JITTER: f64 = 4.0;
const STARTING: f64 = 40.0;
/// Most attitudes in a row that tell a velocity: beyond, errors of the numbers move it more.
const HORIZON: f64 = 100.0;
/// Factor on the noise of an encoder beyond which a joint moves, and samples for which it then counts as moving.
const SEEN: f64 = 6.0;
const MOVES: u32 = 32;
/// Factor on the noise that a direction must exceed to be added: then it is accurate.
const ADDED: f64 = 25.0;
/// Directions of the angular velocity that the record has shown: the regressor of the inertia takes the velocity along them alone. A
/// velocity that is noise of the estimate would find information about inertia that does not show. The directions come from the
/// first window; from then on some are added, but none changes, for a change would be such a velocity. What the rest of the velocity
/// does to a common factor of the inertia is kept: without wheels and torque momentum and inertia have a common factor that does not
/// show either.
#[derive(Debug, Clone, Copy)]
pub struct Excitation {
    /// Sum of `w w^T` in the variance of the estimate of `w`, with a memory of [`MEMORY`] samples.
    scatter: Matrix3,
    samples: f64,
    /// On the directions.
    pub projector: Matrix3,
    /// Whether directions may be added.
    pub grows: bool,
    /// Where each joint stands while it does not move, and for how many samples it still counts as moving.
    anchors: [f64; JOINTS],
    moving: [u32; JOINTS],
    watched: bool,
    /// Attitudes since the motion began: time of the first one, how many, and for how long, s.
    first_s: f64,
    attitudes: f64,
    elapsed_s: f64,
}

impl Excitation {
    /// No direction.
    pub const NONE: Self = Self {
        scatter: Matrix3::from_array_storage(ArrayStorage([[0.0; AXES]; AXES])),
        samples: 0.0,
        projector: Matrix3::from_array_storage(ArrayStorage([[0.0; AXES]; AXES])),
        grows: false,
        anchors: [0.0; JOINTS],
        moving: [0; JOINTS],
        watched: false,
        first_s: 0.0,
        attitudes: 0.0,
        elapsed_s: 0.0,
    };

    /// All directions, until [`Self::settle`].
    pub fn new() -> Self {
        Self {
            projector: Matrix3::identity(),
            ..Self::NONE
        }
    }

    /// Begins to collect anew; the directions stay.
    pub fn begin(&mut self) {
        (self.scatter, self.samples) = (Matrix3::zeros(), 0.0);
    }

    /// A motion begins, of which nothing is known.
    pub fn start(&mut self) {
        self.attitudes = 0.0;
    }

    /// Sees which joints move in a sample, and counts its attitude.
    pub fn watch(&mut self, configuration: &Configuration, sample: &Sample) {
        if sample.attitude.is_some() {
            if self.attitudes == 0.0 {
                self.first_s = sample.time_s;
            }
            self.attitudes += 1.0;
            self.elapsed_s = sample.time_s - self.first_s;
        }
        let inputs = sample.inputs();
        for (j, joint) in configuration.joints().iter().enumerate() {
            let (position, rate) = (inputs[of_joint(j)], inputs[of_rate(j)]);
            if !self.watched {
                self.anchors[j] = position;
            }
            let off = (position - self.anchors[j]).abs() > SEEN * joint.position_noise;
            if off {
                self.anchors[j] = position;
            }
            self.moving[j] = match off || rate.abs() > SEEN * joint.rate_noise {
                true => MOVES,
                false => self.moving[j].saturating_sub(1),
            };
        }
        self.watched = true;
    }

    /// Inputs at which columns are taken: noise of a joint that stands would turn them from sample to sample, and so find
    /// information that its position does not show.
    pub fn calm(&self, inputs: &[f64; INPUTS]) -> [f64; INPUTS] {
        let mut out = *inputs;
        for j in (0..JOINTS).filter(|j| self.moving[*j] == 0) {
            (out[of_joint(j)], out[of_rate(j)]) = (self.anchors[j], 0.0);
        }
        out
    }

    /// Takes the directions from what was collected.
    pub fn settle(&mut self) {
        let Some(eigen) = SymmetricEigen::try_new(self.scatter, f64::EPSILON, ITERATIONS) else {
            return;
        };
        self.projector = Matrix3::zeros();
        for (k, value) in eigen.eigenvalues.iter().enumerate() {
            if *value > self.errors() {
                let direction = eigen.eigenvectors.column(k);
                self.projector += direction * direction.transpose();
            }
        }
    }

    /// One sample more at this motion.
    pub fn add(&mut self, configuration: &Configuration, placed: &Placed) {
        let w = &placed.motion.twist.w;
        let kept = if self.samples < MEMORY {
            1.0
        } else {
            1.0 - 1.0 / MEMORY
        };
        self.samples = (self.samples + 1.0).min(MEMORY);
        let variance = self.variance(configuration, placed);
        self.scatter = self.scatter * kept + w * w.transpose() / variance;
        if !self.grows {
            return;
        }
        let rest = Matrix3::identity() - self.projector;
        let noise = ADDED * self.errors();
        let across = rest * self.scatter * rest;
        if across.trace() <= noise {
            return;
        }
        let Some(eigen) = SymmetricEigen::try_new(across, f64::EPSILON, ITERATIONS) else {
            return;
        };
        let (largest, value) = eigen.eigenvalues.argmax();
        if value > noise {
            let direction = rest * eigen.eigenvectors.column(largest);
            let direction = direction.normalize();
            self.projector += direction * direction.transpose();
        }
    }

    /// Sum of squares of a velocity that may be an error, in its variance.
    fn errors(&self) -> f64 {
        STARTING + JITTER * self.samples
    }

    /// Variance of the estimated velocity: the gyro's bias counts until attitudes tell the velocity better, and errors of the inputs always.
    fn variance(&self, configuration: &Configuration, placed: &Placed) -> f64 {
        let noise = &configuration.noise;
        let mut of_start = noise.gyro * noise.gyro + noise.bias * noise.bias;
        if self.attitudes > 1.0 {
            // Of the slope through points at even steps, with what torques without a model do over them.
            let step_s = self.elapsed_s / (self.attitudes - 1.0);
            let slope = noise.attitude / step_s;
            let walk = noise.torque_walk / placed.motion.centre.I_SScm_B.diagonal().mean();
            let n = self.attitudes.min(HORIZON);
            let of_slope = 12.0 * slope * slope / (n * (n * n - 1.0));
            of_start = of_start.min(of_slope + walk * walk * step_s * n);
        }
        let inputs = placed.input_twists(configuration).into_iter().enumerate();
        // A joint that stands is taken where it stands.
        let moves = |k: usize| k < WHEELS || self.moving[(k - WHEELS) % JOINTS] > 0;
        let inputs = inputs.filter(|(k, _)| moves(*k));
        let of_inputs: f64 = inputs.map(|(_, t)| angular(&t).norm_squared()).sum();
        // At the most likely inputs, by gyro, tachometers and encoders together.
        let gyro = AXES as f64 * noise.gyro * noise.gyro;
        let jitter = gyro * of_inputs / (gyro + of_inputs).max(f64::MIN_POSITIVE);
        (of_start + jitter).max(f64::MIN_POSITIVE)
    }

    /// Relative change of the inertia along the shown directions, `tr(P dI) / tr(P I)`, per unit of each element of a body at `R`; zero
    /// where nothing is shown.
    pub fn shares(&self, I: &Matrix3, R: &Matrix3) -> [f64; 6] {
        let whole = (self.projector * I).trace();
        let projector = R.transpose() * self.projector * R;
        core::array::from_fn(|k| {
            let (i, j) = TENSOR[k];
            let both = if i == j { 1.0 } else { 2.0 };
            match whole > 0.0 {
                true => both * projector[(i, j)] / whole,
                false => 0.0,
            }
        })
    }
}
