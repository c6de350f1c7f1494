//! The Table 1 system with both trajectories, and draws of noise.

use crate::ma2008::{Known, Raw, Reading, TwoStep, Vehicle, two_step};
use crate::study::statistics::Normals;
use crate::study::{Context, StudyError};
use poinsot_dynamics::{
    Flight, JointDrive, JointMotion, Plan, Start, StartVelocity, Tolerance, Tree,
};
use poinsot_model::Model;
use poinsot_spatial::{MassProperties, Matrix3, Vector3};

/// Mass of the arm of Table 1 relative to the base.
const ARM: f64 = 93.184 / 1000.0;

/// Seed of all trials; each uses its own stream.
const SEED: u64 = 2008;

/// A base with offset mass centre and full tensor.
pub fn unsymmetric() -> MassProperties {
    MassProperties {
        mass: 1000.0,
        p_BoBcm_B: Vector3::new(0.05, -0.08, 0.1),
        I_BBcm_B: Matrix3::new(150.0, 12.0, -8.0, 12.0, 180.0, 15.0, -8.0, 15.0, 210.0),
    }
}

/// One experiment: vehicle, motion, samples.
#[derive(Clone)]
pub struct Experiment {
    /// Vehicle with its true numbers.
    pub model: Model,
    /// Knots: time s, joints deg.
    pub knots: Vec<(f64, [f64; 6])>,
    /// Initial angular velocity, deg/s.
    pub spin_deg_s: [f64; 3],
    /// Initial velocity of the base origin, m/s.
    pub velocity: [f64; 3],
    /// Times of the samples, s.
    pub times: Vec<f64>,
    /// Whether the arm stops at every sample.
    pub stops: bool,
    /// Amplitude of joint 2 between stops, deg.
    pub detour_deg: f64,
}

const HOME: [f64; 6] = [0.0; 6];
const UP: [f64; 6] = [0.0, -90.0, 180.0, 0.0, 0.0, 0.0];
const DOWN: [f64; 6] = [0.0, -180.0, 180.0, 0.0, 0.0, 0.0];
const TURNED: [f64; 6] = [150.0, -180.0, 180.0, 0.0, 0.0, 0.0];

/// Trajectory 1: stretch up, swing down to the top plane, rotate joint 1. Trajectory 2: stretch up and fold back.
/// Times, s, and joints, deg.
const TRAJECTORIES: [(&[f64], &[[f64; 6]]); 2] = [
    (
        &[0.0, 5.0, 45.0, 75.0, 125.0, 135.0],
        &[HOME, HOME, UP, DOWN, TURNED, TURNED],
    ),
    (&[0.0, 5.0, 45.0, 85.0, 90.0], &[HOME, HOME, UP, HOME, HOME]),
];

/// The same stops with a swing by `angle` half-way between them.
fn detour(stops: &[f64], place: &[f64], angle: f64) -> (Vec<f64>, Vec<f64>) {
    let middle = |list: &[f64], by: f64| -> Vec<f64> {
        let pairs = list.windows(2);
        let swung = pairs.flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1]) + by]);
        swung.chain(list.last().copied()).collect()
    };
    (middle(stops, 0.0), middle(place, angle))
}

/// Result of a run: vehicle, samples and the true momentum.
#[derive(Clone)]
pub struct Run {
    /// The vehicle.
    pub model: Model,
    /// Times, s.
    pub times: Vec<f64>,
    /// Samples.
    pub raws: Vec<Raw>,
    /// Positions of the base origin, in N, m.
    pub positions: Vec<Vector3>,
    /// Momentum at the start.
    pub known: Known,
}

impl Experiment {
    /// The base at rest on trajectory 1 or 2, ten samples at stops.
    pub fn new(table1: &Model, trajectory: usize, spin_deg_s: [f64; 3]) -> Self {
        let (times, joints) = TRAJECTORIES[usize::from(trajectory != 1)];
        let knots = times.iter().copied().zip(joints.iter().copied());
        let own = Self {
            model: table1.clone(),
            times: Vec::new(),
            knots: knots.collect(),
            spin_deg_s,
            velocity: [0.0; 3],
            stops: true,
            detour_deg: 0.0,
        };
        own.sampled(10, true)
    }

    /// The Table 1 system of the shipped examples.
    ///
    /// # Errors
    /// The model cannot be read.
    pub fn of(context: &Context, trajectory: usize, spin: [f64; 3]) -> Result<Self, StudyError> {
        let table1 = context.model("cases/ma2008_truth.toml")?;
        Ok(Self::new(&table1, trajectory, spin))
    }

    /// Replaces the base.
    #[must_use]
    pub fn with_base(mut self, base: MassProperties) -> Self {
        self.model.bodies[0].nominal = base;
        self
    }

    /// Samples equally spaced over the moving part of the trajectory, with or without stops.
    #[must_use]
    pub fn sampled(mut self, samples: usize, stops: bool) -> Self {
        let (a, b) = (self.knots[1].0, self.knots[self.knots.len() - 2].0);
        let time = |k: usize| a + (b - a) * k as f64 / (samples - 1) as f64;
        self.times = (0..samples).map(time).collect();
        self.stops = stops;
        self
    }

    /// Times at 2 Hz over the whole trajectory, s.
    pub fn whole(&self) -> Vec<f64> {
        let end = self.knots[self.knots.len() - 1].0;
        (0..=2 * end as usize).map(|k| 0.5 * k as f64).collect()
    }

    fn joint(&self, j: usize) -> Result<JointMotion, StudyError> {
        let time: Vec<f64> = self.knots.iter().map(|k| k.0).collect();
        let position: Vec<f64> = self.knots.iter().map(|k| k.1[j].to_radians()).collect();
        let smooth = JointMotion::quintic_rest(&time, &position)?;
        if !self.stops {
            return Ok(smooth);
        }
        // The same configurations, but at rest at every sample.
        let mut stops = time;
        stops.extend(&self.times);
        stops.sort_by(f64::total_cmp);
        stops.dedup_by(|a, b| (*a - *b).abs() < 1.0e-9);
        let mut place: Vec<f64> = stops.iter().map(|t| smooth.at(*t, *t).value).collect();
        if j == 1 && self.detour_deg != 0.0 {
            (stops, place) = detour(&stops, &place, self.detour_deg.to_radians());
        }
        Ok(JointMotion::quintic_rest(&stops, &place)?)
    }

    /// Simulates the experiment from time zero.
    ///
    /// # Errors
    /// The motion cannot be computed.
    pub fn run(&self) -> Result<Run, StudyError> {
        let joints = (0..6).map(|j| self.joint(j).map(JointDrive::Motion));
        let plan = Plan {
            joints: joints.collect::<Result<_, _>>()?,
            ..Plan::default()
        };
        let tolerance = Tolerance {
            relative: 1.0e-13,
            ..Tolerance::default()
        };
        let vehicle = Flight::new(&self.model, &plan, tolerance)?;
        let start = Start {
            velocity: StartVelocity::Twist {
                v_NBo_N: Vector3::from(self.velocity),
                w_NB_B: Vector3::from(self.spin_deg_s).map(f64::to_radians),
            },
            ..Start::at_rest()
        };
        let mut times = vec![0.0];
        times.extend(&self.times);
        let (mut raws, mut positions, mut known) = (Vec::new(), Vec::new(), None);
        vehicle.run(&start, &times, |s| {
            known.get_or_insert(Known {
                p_C_N: s.l_S_N,
                h_C_N: s.h_SScm_N,
            });
            positions.push(s.p_NoBo_N);
            let still = if self.stops { 0.0 } else { 1.0 };
            raws.push(Raw {
                R_NB: s.R_NB,
                v_NBo_N: s.v_NBo_N,
                w_NB_B: s.w_NB_B,
                q: s.q.clone(),
                rates: s.rates.iter().map(|r| still * r).collect(),
                wheel_speed: Vec::new(),
            });
        })?;
        raws.remove(0);
        positions.remove(0);
        Ok(Run {
            model: self.model.clone(),
            times: self.times.clone(),
            raws,
            positions,
            known: known.ok_or("the motion has no first sample")?,
        })
    }

    /// The true base.
    pub fn truth(&self) -> MassProperties {
        self.model.bodies[0].nominal
    }
}

/// Converts samples to the form used by both steps.
pub fn readings(model: &Model, raws: &[Raw]) -> Vec<Reading> {
    let tree = Tree::new(model);
    let mut vehicle = Vehicle::new(model, &tree);
    raws.iter().map(|r| vehicle.reading(r)).collect()
}

/// Scales masses and inertias of the arm to this fraction of the base's mass.
pub fn scale_arm(model: &mut Model, ratio: f64) {
    for body in &mut model.bodies[1..] {
        body.nominal.mass *= ratio / ARM;
        body.nominal.I_BBcm_B *= ratio / ARM;
    }
}

/// One sigma of each velocity component: linear in N, m/s; angular in B, rad/s.
#[derive(Debug, Clone, Copy)]
pub struct Sigma {
    /// Linear.
    pub v: Vector3,
    /// Angular.
    pub w: Vector3,
}

/// Errors of one answer: mass (relative), mass centre (m), tensor (relative to its norm). Infinite without an answer.
pub type Errors = [f64; 3];

impl Run {
    /// The true base.
    pub fn truth(&self) -> MassProperties {
        self.model.bodies[0].nominal
    }

    /// A fraction of the maximum of each velocity component.
    pub fn sigma(&self, share: f64) -> Sigma {
        let most = |of: fn(&Raw) -> Vector3| {
            let larger = |m: Vector3, r: &Raw| m.zip_map(&of(r), |a, b| a.max(b.abs()));
            self.raws.iter().fold(Vector3::zeros(), larger) * share
        };
        Sigma {
            v: most(|r| r.v_NBo_N),
            w: most(|r| r.w_NB_B),
        }
    }

    /// A fraction of the largest linear and of the largest angular component.
    pub fn equal_sigma(&self, share: f64) -> Sigma {
        let most = self.sigma(1.0);
        Sigma {
            v: Vector3::repeat(most.v.amax()) * share,
            w: Vector3::repeat(most.w.amax()) * share,
        }
    }

    /// The samples in the form used by both steps.
    pub fn readings(&self) -> Vec<Reading> {
        readings(&self.model, &self.raws)
    }

    /// The samples with one draw of noise.
    pub fn noisy(&self, sigma: Sigma, seed: u64) -> Vec<Raw> {
        let mut normals = Normals::new(SEED, seed);
        let moved = |r: &Raw| {
            let mut r = r.clone();
            r.v_NBo_N += sigma.v.component_mul(&normals.vector());
            r.w_NB_B += sigma.w.component_mul(&normals.vector());
            r
        };
        self.raws.iter().map(moved).collect()
    }

    /// Both steps for samples of this run.
    pub fn solved(&self, raws: &[Raw], known: bool) -> TwoStep {
        let samples = readings(&self.model, raws);
        two_step(&[samples], known.then_some(self.known))
    }

    /// Errors of an answer.
    pub fn errors(&self, found: Option<MassProperties>) -> Errors {
        let Some(found) = found else {
            return [f64::INFINITY; 3];
        };
        let truth = self.truth();
        let I = &truth.I_BBcm_B;
        let errors = [
            (found.mass / truth.mass - 1.0).abs(),
            (found.p_BoBcm_B - truth.p_BoBcm_B).norm(),
            (found.I_BBcm_B - I).norm() / I.norm(),
        ];
        errors.map(|e| if e.is_nan() { f64::INFINITY } else { e })
    }
}
