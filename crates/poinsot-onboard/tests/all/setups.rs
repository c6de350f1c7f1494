//! Set-ups of the trials.

use crate::arm::{Arm, Link, points};
use crate::sprung::Sprung;
use crate::truth::{Motion, Noise, Truth};
use nalgebra::{DMatrix, Matrix3, UnitQuaternion, Vector3};
use poinsot_onboard::{
    CURVE, Configuration, Filter, JOINTS, Joint, MOUNTING, WHEELS, Wheel, of_wheel,
};
use std::f64::consts::TAU;

/// The filter of the trials: 30 s are replayed.
pub type OnBoard = Filter<72, 150>;

/// Prior sigma relative to the parameter's natural unit.
pub const PRIOR: f64 = 0.2;

/// Tilt of a drawn axis, rad, and correlation of drawn spin inertias.
const TILT: f64 = 3.0e-3;
const LIKE: f64 = 0.7;

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
        q: [0.0; JOINTS],
        rate: [0.0; JOINTS],
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
    configuration.nominal[..10].copy_from_slice(&truth.parameters());
    configuration.longest_gap_s = 1.0;
    for (uncertain, sigma) in configuration.uncertain.iter_mut().zip(sigma) {
        *uncertain = sigma > 0.0;
    }
    for (at, sigma) in sigma.iter().skip(unknown).enumerate() {
        configuration.prior[(at, at)] = 1.0 / sigma;
    }
    Setup {
        name,
        truth,
        configuration,
        sigma,
    }
}

fn four_wheels(k: usize) -> [f64; WHEELS] {
    let mut out = [0.0; WHEELS];
    for (j, torque) in out.iter_mut().enumerate().take(4) {
        *torque = 0.02 * switching(k, 20 + 7 * j, j);
    }
    out
}

fn thrusters(k: usize) -> (Vector3<f64>, Vector3<f64>) {
    let sign = |every, salt| switching(k, every, salt);
    let force = Vector3::new(sign(15, 1), sign(23, 2), sign(31, 3));
    let torque = Vector3::new(sign(11, 4), sign(17, 5), sign(13, 6)) * 0.15;
    (force, torque)
}

/// A bus with a pyramid of four wheels, its six inertia elements unknown.
pub fn bus_with_wheels() -> Setup {
    let truth = Truth {
        mass: 100.0,
        c: Vector3::new(0.02, -0.01, 0.05),
        I: Matrix3::new(10.0, 0.4, -0.3, 0.4, 12.0, 0.2, -0.3, 0.2, 8.0),
        start: at_rest(Vector3::new(0.002, -0.001, 0.003)),
        hold: 1,
        smooth: false,
        motors: four_wheels,
        wrench: |_| (Vector3::zeros(), Vector3::zeros()),
        dt: 0.2,
        samples: 600,
        arm: None,
        sprung: Vec::new(),
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
        smooth: false,
        motors: |_| [0.0; WHEELS],
        wrench: thrusters,
        dt: 0.2,
        samples: 600,
        arm: None,
        sprung: Vec::new(),
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
        smooth: false,
        motors: |k| {
            let mut out = [0.0; WHEELS];
            out[0] = 0.02 * switching(k, 40, 9);
            out
        },
        wrench: |_| (Vector3::zeros(), Vector3::zeros()),
        dt: 0.2,
        samples: 600,
        arm: None,
        sprung: Vec::new(),
    };
    let configuration = Configuration::new(truth.parameters(), noise()).with_wheel(Wheel {
        axis_B: [0.0, 0.6, 0.8],
        spin_inertia: 5.0e-3,
        noise: 0.05,
    });
    setup("tumbling body", truth, configuration, 4)
}

/// The ten parameters about the origin of a frame.
fn ten(mass: f64, c: Vector3<f64>, I: Matrix3<f64>) -> [f64; 10] {
    let truth = Truth {
        mass,
        c,
        I,
        ..bus_with_wheels().truth
    };
    truth.parameters()
}

/// A satellite of 300 kg whose arm of three joints holds a payload, all ten numbers of which are unknown; the encoders have noise.
pub fn arm_with_payload() -> Setup {
    let diagonal = |x, y, z| Matrix3::from_diagonal(&Vector3::new(x, y, z));
    let base = (
        300.0,
        Vector3::new(0.05, 0.0, -0.1),
        diagonal(60.0, 70.0, 50.0),
    );
    let known = (12.0, Vector3::new(0.4, 0.0, 0.0), diagonal(0.05, 0.7, 0.7));
    let payload = (
        40.0,
        Vector3::new(0.9, 0.1, -0.05),
        Matrix3::new(4.0, 0.2, -0.1, 0.2, 3.0, 0.15, -0.1, 0.15, 2.5),
    );
    let turn = UnitQuaternion::from_scaled_axis;
    let link = |parent, p, R: Vector3<f64>, axis, curve| Link {
        parent,
        slides: false,
        R: turn(R),
        p,
        axis,
        curve,
        points: points(known.0, known.1, known.2),
    };
    let mut links = vec![
        link(
            0,
            Vector3::new(0.6, 0.2, 0.5),
            Vector3::new(0.0, 0.0, 0.4),
            Vector3::z(),
            [0.2, 0.6, 0.21, 0.0, 0.3, 0.13, 1.0],
        ),
        link(
            1,
            Vector3::new(0.1, 0.0, 0.1),
            Vector3::new(0.3, 0.1, 0.0),
            Vector3::y(),
            [0.4, 0.5, 0.17, 0.7, 0.3, 0.29, 2.0],
        ),
        link(
            2,
            Vector3::new(0.9, 0.0, 0.0),
            Vector3::new(-0.5, 0.0, 0.2),
            Vector3::new(0.6, 0.0, 0.8),
            [-0.5, 0.7, 0.25, 1.9, 0.2, 0.11, 0.4],
        ),
    ];
    links[2]
        .points
        .extend(points(payload.0, payload.1, payload.2));
    let truth = Truth {
        mass: payload.0,
        c: payload.1,
        I: payload.2,
        start: at_rest(Vector3::new(0.01, -0.02, 0.015)),
        hold: 1,
        smooth: false,
        motors: |_| [0.0; WHEELS],
        wrench: |_| (Vector3::zeros(), Vector3::zeros()),
        dt: 0.2,
        samples: 600,
        arm: Some(Arm {
            base: points(base.0, base.1, base.2),
            links: links.clone(),
        }),
        sprung: Vec::new(),
    };
    let mut configuration = Configuration::new(truth.parameters(), noise());
    configuration.known = ten(base.0, base.1, base.2);
    configuration.unknown_link = links.len();
    for link in &links {
        configuration = configuration.with_joint(Joint {
            parent: link.parent,
            slides: link.slides,
            rotation: link.R.coords.into(),
            position: link.p.into(),
            axis: link.axis.into(),
            known: ten(known.0, known.1, known.2),
            position_noise: 1.0e-4,
            rate_noise: 1.0e-4,
        });
    }
    setup("arm with payload", truth, configuration, 0)
}

pub fn all() -> [Setup; 4] {
    [
        bus_with_wheels(),
        bus_with_thrusters(),
        tumbling(),
        arm_with_payload(),
    ]
}

/// The two buses with two masses on springs, a twelfth of the vehicle's mass, which move at the start. They turn more slowly: a mode is
/// no softer where the vehicle turns.
pub fn with_modes() -> [Setup; 2] {
    let sprung = |mass, r, u: Vector3<f64>, frequency_Hz, start| Sprung {
        mass,
        r,
        u: u.normalize(),
        frequency_Hz,
        damping_ratio: 0.01,
        start,
    };
    let masses = vec![
        sprung(
            5.0,
            Vector3::new(0.6, 0.4, -0.2),
            Vector3::new(0.1, -0.3, 1.0),
            0.43,
            [5.0e-4, 0.0],
        ),
        sprung(
            3.0,
            Vector3::new(-0.3, 0.7, 0.5),
            Vector3::new(1.0, 0.2, -0.4),
            0.94,
            [-2.0e-4, 5.0e-4],
        ),
    ];
    [
        ("bus with wheels and modes", bus_with_wheels()),
        ("bus with thrusters and modes", bus_with_thrusters()),
    ]
    .map(|(name, mut setup)| {
        setup.name = name;
        for mass in &masses {
            let mode = mass.mode(&setup.truth.c);
            setup.configuration = setup.configuration.with_mode(mode);
        }
        setup.truth.sprung.clone_from(&masses);
        setup.truth.motors = match setup.configuration.wheel_count {
            0 => |_| [0.0; WHEELS],
            _ => |k| four_wheels(k).map(|torque| 0.3 * torque),
        };
        if setup.configuration.noise.position > 0.0 {
            setup.truth.wrench = |k| {
                let (force, torque) = thrusters(k);
                (force * 0.2, torque * 0.1)
            };
        }
        setup
    })
}

/// The bus with wheels, each with a torque that goes up and down over 10 to 25 s.
pub fn bus_with_smooth_wheels() -> Setup {
    let mut setup = bus_with_wheels();
    setup.name = "bus with wheels of smooth torque";
    setup.truth.smooth = true;
    setup.truth.motors = |k| {
        let wave = |j: usize| (TAU * k as f64 / (50.0 + 23.0 * j as f64) + j as f64).sin();
        std::array::from_fn(|j| if j < 4 { 0.06 * wave(j) } else { 0.0 })
    };
    setup
}

impl Setup {
    /// Lets the filter find what the wheels do between samples.
    pub fn with_curve(mut self) -> Self {
        self.configuration = self.configuration.with_curve();
        self
    }

    /// The same flight, sampled so many times as often.
    pub fn faster(mut self, by: usize) -> Self {
        self.truth.dt /= by as f64;
        (self.truth.samples, self.truth.hold) = (self.truth.samples * by, by);
        self
    }

    /// Hardly known: nominal numbers within 35 %, the bias of the gyro within a degree per second.
    pub fn hardly_known(mut self) -> Self {
        let wider = 0.35 / PRIOR;
        self.sigma = self.sigma.map(|sigma| wider * sigma);
        for x in &mut self.configuration.prior.0 {
            *x /= wider;
        }
        self.configuration.noise.bias = 0.017;
        self
    }

    /// Wheels and mounting as drawings tell them: spin inertias within 2 %, with a correlation of 0.7; axes and mounting within 3 mrad.
    pub fn drawn(mut self) -> Self {
        let wheels = self.configuration.wheel_count;
        let n = 3 * wheels + 3;
        let covariance = DMatrix::from_fn(n, n, |i, j| {
            let is_spin = |k: usize| k < 3 * wheels && k.is_multiple_of(3);
            match (is_spin(i), is_spin(j)) {
                (true, true) => 0.02 * 0.02 * if i == j { 1.0 } else { LIKE },
                _ if i == j => TILT * TILT,
                _ => 0.0,
            }
        });
        let information = covariance.try_inverse().unwrap().cholesky().unwrap();
        let R = information.l().transpose();
        let unknown = self.sigma.iter().filter(|s| **s > 0.0).count();
        for i in 0..n {
            for j in i..n {
                self.configuration.prior[(unknown + i, unknown + j)] = R[(i, j)];
            }
        }
        self.configuration.uncertain[of_wheel(0)..of_wheel(wheels)].fill(true);
        self.configuration.uncertain[MOUNTING..CURVE].fill(true);
        self
    }

    /// The wheels that fly, and the turn of the attitude sensor, drawn around the numbers that are known.
    pub fn flown(&self, noise: &mut Noise) -> (Configuration, UnitQuaternion<f64>) {
        let mut flown = self.configuration;
        if !flown.uncertain[MOUNTING] {
            return (flown, UnitQuaternion::identity());
        }
        let shared = LIKE.sqrt() * noise.one();
        for wheel in &mut flown.wheels[..flown.wheel_count] {
            let error = shared + (1.0 - LIKE).sqrt() * noise.one();
            wheel.spin_inertia *= 1.0 + 0.02 * error;
            let tilt = UnitQuaternion::from_scaled_axis(noise.vector(TILT));
            wheel.axis_B = (tilt * Vector3::from(wheel.axis_B)).into();
        }
        let turn = noise.vector(TILT);
        (flown, UnitQuaternion::from_scaled_axis(turn))
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
