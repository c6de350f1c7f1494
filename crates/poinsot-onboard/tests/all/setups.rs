//! Set-ups of the trials.

use crate::truth::{Motion, Noise, Truth};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use poinsot_onboard::{Configuration, Filter, WHEELS, Wheel};

/// The filter of the trials: 30 s are replayed.
pub type OnBoard = Filter<48, 150>;

/// Prior sigma relative to the parameter's natural unit.
pub const PRIOR: f64 = 0.2;

/// A truth with what a filter is told of it.
pub struct Setup {
    pub name: &'static str,
    pub truth: Truth,
    /// Nominal numbers are those of the truth.
    pub configuration: Configuration,
    pub sigma: [f64; 10],
}

fn noise() -> poinsot_onboard::Noise {
    poinsot_onboard::Noise {
        gyro: 1.0e-4,
        attitude: 1.0e-4,
        position: 0.0,
        bias: 1.0e-4,
        bias_walk: 0.0,
        torque_walk: 0.0,
    }
}

/// Signs that change in an order without a period of its own.
fn switching(k: usize, every: usize, salt: usize) -> f64 {
    let block = k / every + 1;
    let hash = (block * 2_654_435_761 + salt * 40_503).wrapping_mul(2_246_822_519) >> 13;
    if hash.is_multiple_of(2) { 1.0 } else { -1.0 }
}

fn at_rest(w: Vector3<f64>) -> Motion {
    Motion {
        R: UnitQuaternion::from_scaled_axis(Vector3::new(0.3, -0.5, 0.2)),
        w,
        speeds: [0.0; WHEELS],
        p: Vector3::new(1.0, 2.0, -0.5),
        v: Vector3::new(0.02, -0.01, 0.03),
    }
}

/// Natural units of the ten parameters: `m`, `m L`, and moments; products have the mean moment.
fn natural(truth: &Truth) -> [f64; 10] {
    let p = truth.parameters();
    let arm = (truth.mass * truth.I.trace() / 2.0).sqrt();
    let mean = truth.I.trace() / 3.0;
    [
        truth.mass, arm, arm, arm, p[4], mean, p[6], mean, mean, p[9],
    ]
}

fn setup(
    name: &'static str,
    truth: Truth,
    mut configuration: Configuration,
    unknown: usize,
) -> Setup {
    let natural = natural(&truth);
    let sigma: [f64; 10] = std::array::from_fn(|k| {
        if k >= unknown {
            PRIOR * natural[k]
        } else {
            0.0
        }
    });
    configuration.nominal = truth.parameters();
    configuration.longest_gap_s = 1.0;
    configuration.unknown = sigma.map(|sigma| sigma > 0.0);
    for (at, sigma) in sigma.iter().skip(unknown).enumerate() {
        configuration.prior[at][at] = 1.0 / sigma;
    }
    Setup {
        name,
        truth,
        configuration,
        sigma,
    }
}

/// A bus with a pyramid of four wheels, its six inertia elements unknown.
pub fn bus_with_wheels() -> Setup {
    let truth = Truth {
        mass: 100.0,
        c: Vector3::new(0.02, -0.01, 0.05),
        I: Matrix3::new(10.0, 0.4, -0.3, 0.4, 12.0, 0.2, -0.3, 0.2, 8.0),
        start: at_rest(Vector3::new(0.002, -0.001, 0.003)),
        hold: 1,
        motors: |k| {
            let mut out = [0.0; WHEELS];
            for (j, torque) in out.iter_mut().enumerate().take(4) {
                *torque = 0.02 * switching(k, 20 + 7 * j, j);
            }
            out
        },
        wrench: |_| (Vector3::zeros(), Vector3::zeros()),
        dt: 0.2,
        samples: 600,
    };
    let mut configuration = Configuration::new(truth.parameters(), noise());
    for (x, y) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
        configuration = configuration.with_wheel(Wheel {
            axis_B: Vector3::new(x, y, 0.7).normalize().into(),
            spin_inertia: 2.0e-3,
            noise: 0.05,
        });
    }
    setup("bus with wheels", truth, configuration, 4)
}

/// A bus with thrusters whose position is measured, all ten parameters unknown.
pub fn bus_with_thrusters() -> Setup {
    let truth = Truth {
        mass: 100.0,
        c: Vector3::new(0.02, -0.01, 0.05),
        I: Matrix3::new(10.0, 0.4, -0.3, 0.4, 12.0, 0.2, -0.3, 0.2, 8.0),
        start: at_rest(Vector3::new(0.01, -0.02, 0.015)),
        hold: 1,
        motors: |_| [0.0; WHEELS],
        wrench: |k| {
            let sign = |every, salt| switching(k, every, salt);
            let force = Vector3::new(sign(15, 1), sign(23, 2), sign(31, 3));
            let torque = Vector3::new(sign(11, 4), sign(17, 5), sign(13, 6)) * 0.15;
            (force, torque)
        },
        dt: 0.2,
        samples: 600,
    };
    let mut noise = noise();
    noise.position = 2.0e-3;
    let configuration = Configuration::new(truth.parameters(), noise);
    setup("bus with thrusters", truth, configuration, 0)
}

/// A tumbling body with one wheel, its six inertia elements unknown.
pub fn tumbling() -> Setup {
    let mut start = at_rest(Vector3::new(0.2, 0.25, -0.15));
    start.speeds[0] = 150.0;
    let truth = Truth {
        mass: 60.0,
        c: Vector3::new(0.02, -0.01, 0.05),
        I: Matrix3::new(5.0, 0.2, -0.1, 0.2, 7.0, 0.3, -0.1, 0.3, 8.5),
        start,
        hold: 1,
        motors: |k| {
            let mut out = [0.0; WHEELS];
            out[0] = 0.02 * switching(k, 40, 9);
            out
        },
        wrench: |_| (Vector3::zeros(), Vector3::zeros()),
        dt: 0.2,
        samples: 600,
    };
    let configuration = Configuration::new(truth.parameters(), noise()).with_wheel(Wheel {
        axis_B: [0.0, 0.6, 0.8],
        spin_inertia: 5.0e-3,
        noise: 0.05,
    });
    setup("tumbling body", truth, configuration, 4)
}

pub fn all() -> [Setup; 3] {
    [bus_with_wheels(), bus_with_thrusters(), tumbling()]
}

impl Setup {
    /// The same flight, sampled so many times as often.
    pub fn faster(mut self, by: usize) -> Self {
        self.truth.dt /= by as f64;
        (self.truth.samples, self.truth.hold) = (self.truth.samples * by, by);
        self
    }

    /// A filter whose nominal numbers are drawn from the prior around the truth; impossible vehicles are drawn anew.
    pub fn filter(&self, noise: &mut Noise) -> Box<OnBoard> {
        loop {
            let mut configuration = self.configuration;
            for (nominal, sigma) in configuration.nominal.iter_mut().zip(&self.sigma) {
                *nominal += sigma * noise.one();
            }
            if let Ok(filter) = OnBoard::new(configuration) {
                return Box::new(filter);
            }
        }
    }
}
