//! What a filter is told before it starts.

use crate::numbers::{AXES, CURVE, NUMBERS, Numbers, PARAMETERS, WHEELS};
use crate::triangle::Triangle;
use nalgebra::ArrayStorage;
use poinsot_dynamics::propagation::{MOST_MODES, Mode};
use poinsot_spatial::{Matrix3, Vector3};

/// Most joints.
pub const JOINTS: usize = 7;
/// Inputs that are measured: speeds of the wheels, positions of the joints, their rates.
pub(crate) const INPUTS: usize = WHEELS + 2 * JOINTS;
/// Most samples that are held back to be put in order.
pub(crate) const HELD_BACK: usize = 4;
/// Most iterations for the eigenvalues of a symmetric matrix; three of them take about ten.
pub(crate) const ITERATIONS: usize = 100;
/// Most passes over the first window.
pub(crate) const PASSES: usize = 24;

/// Place of the position of a joint among the inputs.
pub(crate) const fn of_joint(j: usize) -> usize {
    WHEELS + j
}

/// Place of the rate of a joint among the inputs.
pub(crate) const fn of_rate(j: usize) -> usize {
    WHEELS + JOINTS + j
}

/// A reaction wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheel {
    /// Unit spin axis in B.
    pub axis_B: [f64; 3],
    /// Spin inertia, kg m2.
    pub spin_inertia: f64,
    /// Noise of its measured speed, rad/s, one sigma; zero: exact.
    pub noise: f64,
}

impl Wheel {
    fn numbers(&mut self) -> impl Iterator<Item = &mut f64> {
        let last = [&mut self.spin_inertia, &mut self.noise];
        self.axis_B.iter_mut().chain(last)
    }

    /// Unit directions across the axis, about which it tilts.
    ///
    /// ```
    /// let wheel = poinsot_onboard::Wheel { axis_B: [0.0, 0.0, 1.0], spin_inertia: 1e-3, noise: 0.0 };
    /// let [first, second] = wheel.across();
    /// assert_eq!((first.x, second.y), (1.0, 1.0));
    /// ```
    pub fn across(&self) -> [Vector3; 2] {
        let axis = Vector3::from(self.axis_B);
        let mut least = Vector3::zeros();
        least[axis.iamin()] = 1.0;
        let first = (least - axis * axis.dot(&least)).normalize();
        [first, axis.cross(&first)]
    }

    /// What of its momentum per unit of `spin_inertia` times speed each of its three numbers gives, in B.
    fn directions(&self) -> [Vector3; AXES] {
        let [first, second] = self.across();
        [Vector3::from(self.axis_B), -second, first]
    }
}

/// A joint, and what is known of the link that it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// The link that carries it: 0 is the base, k that of the k-th joint, which stands before it.
    pub parent: usize,
    /// Whether it slides along its axis; otherwise it turns about it.
    pub slides: bool,
    /// Rotation from the link to its parent at position zero, as a quaternion x, y, z, w.
    pub rotation: [f64; 4],
    /// Origin of the link at position zero, in the parent, m. A joint that turns leaves it where it is.
    pub position: [f64; AXES],
    /// Unit axis in the link.
    pub axis: [f64; AXES],
    /// The ten parameters of all known bodies that the link consists of, about its origin, in its axes.
    pub known: [f64; PARAMETERS],
    /// Noise of its measured position, rad or m, one sigma; zero: exact.
    pub position_noise: f64,
    /// Noise of its measured rate, rad/s or m/s, one sigma; zero: exact.
    pub rate_noise: f64,
}

impl Joint {
    fn numbers(&mut self) -> impl Iterator<Item = &mut f64> {
        let place = self.rotation.iter_mut().chain(&mut self.position);
        let last = [&mut self.position_noise, &mut self.rate_noise];
        place
            .chain(&mut self.axis)
            .chain(&mut self.known)
            .chain(last)
    }
}

impl Noise {
    /// In the order of its fields.
    pub(crate) fn numbers(&mut self) -> [&mut f64; 6] {
        let Self {
            gyro,
            attitude,
            position,
            bias,
            bias_walk,
            torque_walk,
        } = self;
        [gyro, attitude, position, bias, bias_walk, torque_walk]
    }
}

/// A vehicle without modes has these.
const NO_MODE: Mode = Mode {
    body: 0,
    frequency_Hz: 0.0,
    damping_ratio: 0.0,
    translation: Vector3::new(0.0, 0.0, 0.0),
    rotation: Vector3::new(0.0, 0.0, 0.0),
    inertia_slope: Matrix3::from_array_storage(ArrayStorage([[0.0; AXES]; AXES])),
};

fn numbers_of(mode: &mut Mode) -> impl Iterator<Item = &mut f64> {
    let first = [&mut mode.frequency_Hz, &mut mode.damping_ratio].into_iter();
    let participation = mode.translation.iter_mut().chain(&mut mode.rotation);
    first.chain(participation).chain(&mut mode.inertia_slope)
}

/// Noise of sensors and motion, one sigma.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Of the gyro, rad/s, per axis and sample.
    pub gyro: f64,
    /// Of the measured attitude, rad, per axis.
    pub attitude: f64,
    /// Of the measured position of `Bo`, m, per axis; zero: not measured, and the filter leaves out translation.
    pub position: f64,
    /// Prior of the gyro bias, rad/s.
    pub bias: f64,
    /// Random walk of the gyro bias, rad/s per square root of a second.
    pub bias_walk: f64,
    /// Random walk of the angular momentum by torques without a model, N m s per square root of a second.
    pub torque_walk: f64,
}

/// Vehicle, priors, noise and limits.
///
/// Bodies are fixed to B or to a link of a joint. The unknown body has its frame at the origin and in the axes of B, unless
/// `unknown_link` and the two numbers after it say otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Configuration {
    /// The ten parameters of all known bodies that are fixed to B, about `Bo`, in the order of `poinsot_spatial::PARAMETER_NAMES`.
    pub known: [f64; PARAMETERS],
    /// Nominal numbers: parameters of the unknown body, then errors of what is known, at [`crate::of_wheel`] and [`crate::MOUNTING`], and
    /// [`CURVE`].
    pub nominal: [f64; NUMBERS],
    /// Which numbers are not exact, at their places: of the parameters the unknown ones, of what is known that with a sigma.
    pub uncertain: [bool; NUMBERS],
    /// Square root of the prior information over these: the upper triangle of its first rows and columns. The prior is
    /// `R (x - nominal) = white noise`.
    pub prior: Triangle,
    /// Wheels; the first `wheel_count` count.
    pub wheels: [Wheel; WHEELS],
    /// Number of wheels.
    pub wheel_count: usize,
    /// Joints, each after the one that carries it; the first `joint_count` count.
    pub joints: [Joint; JOINTS],
    /// Number of joints.
    pub joint_count: usize,
    /// The link that the unknown body is fixed to: 0 is the base, k that of the k-th joint.
    pub unknown_link: usize,
    /// Rotation from its frame to the link, as a quaternion x, y, z, w.
    pub unknown_rotation: [f64; 4],
    /// Its origin in the link, m.
    pub unknown_position: [f64; AXES],
    /// Flexible modes of the base, in its axes and about `Bo`; the first `mode_count` count. Their bodies are not read.
    pub modes: [Mode; MOST_MODES],
    /// Number of modes.
    pub mode_count: usize,
    /// Noise.
    pub noise: Noise,
    /// Time after which the parameters may have changed by as much as the prior, s: they are a random walk whose covariance is that of
    /// the prior then. Zero where they stay.
    pub forget_s: f64,
    /// Longest time between two samples that the motion is followed over, s. After a longer one the motion starts anew.
    pub longest_gap_s: f64,
    /// Time after which an answer without a new sample is stale, s.
    pub stale_s: f64,
    /// Samples that are held back to be put in order; at most 4.
    pub reorder: usize,
}

impl Configuration {
    /// No vehicle.
    pub(crate) const NONE: Self = Self {
        known: [0.0; PARAMETERS],
        nominal: [0.0; NUMBERS],
        uncertain: [false; NUMBERS],
        prior: Triangle::ZERO,
        wheels: [Wheel {
            axis_B: [0.0; AXES],
            spin_inertia: 0.0,
            noise: 0.0,
        }; WHEELS],
        wheel_count: 0,
        joints: [Joint {
            parent: 0,
            slides: false,
            rotation: [0.0; 4],
            position: [0.0; AXES],
            axis: [0.0; AXES],
            known: [0.0; PARAMETERS],
            position_noise: 0.0,
            rate_noise: 0.0,
        }; JOINTS],
        joint_count: 0,
        unknown_link: 0,
        unknown_rotation: [0.0; 4],
        unknown_position: [0.0; AXES],
        modes: [NO_MODE; MOST_MODES],
        mode_count: 0,
        forget_s: 0.0,
        noise: Noise {
            gyro: 0.0,
            attitude: 0.0,
            position: 0.0,
            bias: 0.0,
            bias_walk: 0.0,
            torque_walk: 0.0,
        },
        longest_gap_s: 0.0,
        stale_s: 0.0,
        reorder: 0,
    };

    /// A vehicle of one body without wheels, nothing of it unknown. Gaps of 10 s; stale after 10 s; nothing is held back.
    pub fn new(nominal: [f64; PARAMETERS], noise: Noise) -> Self {
        Self {
            nominal: core::array::from_fn(|k| nominal.get(k).copied().unwrap_or_default()),
            noise,
            unknown_rotation: [0.0, 0.0, 0.0, 1.0],
            longest_gap_s: 10.0,
            stale_s: 10.0,
            ..Self::NONE
        }
    }

    /// Adds a wheel; beyond [`WHEELS`] it is counted, and the configuration is refused.
    #[must_use]
    pub fn with_wheel(mut self, wheel: Wheel) -> Self {
        if let Some(place) = self.wheels.get_mut(self.wheel_count) {
            *place = wheel;
        }
        self.wheel_count += 1;
        self
    }

    /// Adds a joint with its link; beyond [`JOINTS`] it is counted, and the configuration is refused.
    #[must_use]
    pub fn with_joint(mut self, joint: Joint) -> Self {
        if let Some(place) = self.joints.get_mut(self.joint_count) {
            *place = joint;
        }
        self.joint_count += 1;
        self
    }

    /// Adds a mode of the base; beyond [`MOST_MODES`] it is counted, and the configuration is refused.
    #[must_use]
    pub fn with_mode(mut self, mode: Mode) -> Self {
        if let Some(place) = self.modes.get_mut(self.mode_count) {
            *place = mode;
        }
        self.mode_count += 1;
        self
    }

    /// Lets the data tell what the speeds of the wheels do between samples, see [`CURVE`]. Comes after all other uncertain numbers.
    ///
    /// ```
    /// use poinsot_onboard::{CURVE, Configuration, Noise};
    ///
    /// let noise = Noise { gyro: 1e-4, attitude: 1e-4, position: 0.0, bias: 1e-4, bias_walk: 0.0, torque_walk: 0.0 };
    /// let cube = [6.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    /// let configuration = Configuration::new(cube, noise).with_curve();
    /// assert_eq!((configuration.nominal[CURVE], configuration.prior[(0, 0)]), (0.5, 2.0));
    /// ```
    #[must_use]
    pub fn with_curve(mut self) -> Self {
        let last = self.uncertain().filter(|k| *k != CURVE).count();
        self.uncertain[CURVE] = true;
        self.nominal[CURVE] = 0.5;
        self.prior[(last, last)] = 2.0;
        self
    }

    /// Every number, in the order of the table.
    pub(crate) fn numbers(&mut self) -> impl Iterator<Item = &mut f64> {
        let body = self.known.iter_mut().chain(&mut self.nominal);
        let body = body.chain(&mut self.prior.0);
        body.chain(self.wheels.iter_mut().flat_map(Wheel::numbers))
            .chain(self.noise.numbers())
            .chain([&mut self.longest_gap_s, &mut self.stale_s])
            .chain(&mut self.unknown_rotation)
            .chain(&mut self.unknown_position)
            .chain(self.joints.iter_mut().flat_map(Joint::numbers))
            .chain(self.modes.iter_mut().flat_map(numbers_of))
            .chain([&mut self.forget_s])
    }

    /// Whether the position is measured.
    pub(crate) fn translates(&self) -> bool {
        self.noise.position > 0.0
    }

    pub(crate) fn wheels(&self) -> &[Wheel] {
        self.wheels.get(..self.wheel_count).unwrap_or_default()
    }

    /// Angular momentum of each wheel relative to the base per unit of its speed, in B, N m s2.
    pub(crate) fn wheel_momenta(&self, numbers: &Numbers) -> [Vector3; WHEELS] {
        let mut out = [Vector3::zeros(); WHEELS];
        let errors = numbers[PARAMETERS..].chunks_exact(AXES);
        for ((out, wheel), errors) in out.iter_mut().zip(self.wheels()).zip(errors) {
            let [axis, first, second] = wheel.directions();
            let turned = axis * (1.0 + errors[0]) + first * errors[1] + second * errors[2];
            *out = turned * wheel.spin_inertia;
        }
        out
    }

    /// What a number of a wheel changes of it, by its place after the parameters.
    pub(crate) fn wheel_slope(&self, place: usize, speeds: &[f64; WHEELS]) -> Vector3 {
        let at = place / AXES;
        let slope =
            |wheel: &Wheel| wheel.directions()[place % AXES] * (wheel.spin_inertia * speeds[at]);
        self.wheels().get(at).map_or_else(Vector3::zeros, slope)
    }

    pub(crate) fn modes(&self) -> &[Mode] {
        self.modes.get(..self.mode_count).unwrap_or_default()
    }

    pub(crate) fn joints(&self) -> &[Joint] {
        self.joints.get(..self.joint_count).unwrap_or_default()
    }

    /// Places of the numbers that are not exact.
    pub(crate) fn uncertain(&self) -> impl Iterator<Item = usize> + Clone {
        (0..NUMBERS).filter(|k| self.uncertain[*k])
    }

    /// Places of the inputs that the vehicle has.
    pub(crate) fn driven(&self) -> impl Iterator<Item = usize> {
        let joints = self.joint_count.min(JOINTS);
        let positions = of_joint(0)..of_joint(joints);
        let rates = of_rate(0)..of_rate(joints);
        (0..self.wheel_count.min(WHEELS))
            .chain(positions)
            .chain(rates)
    }

    /// Noise of an input, one sigma; zero where the vehicle does not have it.
    pub(crate) fn input_noise(&self, k: usize) -> f64 {
        let joint = |j: usize| self.joints().get(j);
        match k.checked_sub(WHEELS) {
            None => self.wheels().get(k).map_or(0.0, |w| w.noise),
            Some(j) if j < JOINTS => joint(j).map_or(0.0, |j| j.position_noise),
            Some(j) => joint(j - JOINTS).map_or(0.0, |j| j.rate_noise),
        }
    }
}
