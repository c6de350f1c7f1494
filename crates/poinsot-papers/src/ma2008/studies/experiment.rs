//! The Table 1 system with both trajectories.

use crate::ma2008::{Known, Raw, Reading, Vehicle};
use crate::study::{Context, StudyError};
use poinsot_dynamics::{
    Flight, JointDrive, JointMotion, Plan, Start, StartVelocity, Tolerance, Tree,
};
use poinsot_model::Model;
use poinsot_spatial::{MassProperties, Matrix3, UnitQuaternion, Vector3};

/// Mass of the arm of Table 1 relative to the base.
const ARM: f64 = 93.184 / 1000.0;

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

/// Trajectory 1: stretch up, swing down to the top plane, rotate joint 1. Trajectory 2: stretch up and fold back.
fn knots(trajectory: usize) -> Vec<(f64, [f64; 6])> {
    let home = [0.0; 6];
    let (up, down) = (
        [0.0, -90.0, 180.0, 0.0, 0.0, 0.0],
        [0.0, -180.0, 180.0, 0.0, 0.0, 0.0],
    );
    let turned = [150.0, -180.0, 180.0, 0.0, 0.0, 0.0];
    match trajectory {
        1 => vec![
            (0.0, home),
            (5.0, home),
            (45.0, up),
            (75.0, down),
            (125.0, turned),
            (135.0, turned),
        ],
        _ => vec![
            (0.0, home),
            (5.0, home),
            (45.0, up),
            (85.0, home),
            (90.0, home),
        ],
    }
}

/// The same stops with a swing by `angle` half-way between them.
fn detour(stops: &[f64], place: &[f64], angle: f64) -> (Vec<f64>, Vec<f64>) {
    let mut out = (Vec::new(), Vec::new());
    for (k, (stop, at)) in stops.iter().zip(place).enumerate() {
        out.0.push(*stop);
        out.1.push(*at);
        if let (Some(t), Some(q)) = (stops.get(k + 1), place.get(k + 1)) {
            out.0.push(0.5 * (stop + t));
            out.1.push(0.5 * (at + q) + angle);
        }
    }
    out
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
        Self {
            model: table1.clone(),
            times: Vec::new(),
            knots: knots(trajectory),
            spin_deg_s,
            velocity: [0.0; 3],
            stops: true,
            detour_deg: 0.0,
        }
        .sampled(10, true)
    }

    /// The Table 1 system of the shipped examples.
    ///
    /// # Errors
    /// The model cannot be read.
    pub fn of(
        context: &Context,
        trajectory: usize,
        spin_deg_s: [f64; 3],
    ) -> Result<Self, StudyError> {
        let table1 = context.model("cases/ma2008_truth.toml")?;
        Ok(Self::new(&table1, trajectory, spin_deg_s))
    }

    /// Example 1 or 2 of Sec. III.D.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn example(context: &Context, n: usize) -> Result<Self, StudyError> {
        match n {
            1 => Self::of(context, 1, [0.0, 0.0, 1.0]),
            _ => Self::of(context, 2, [0.0, 1.0, 5.0]),
        }
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

    /// Changes the positions of the joints at every knot, deg.
    #[must_use]
    pub fn moved(mut self, change: impl Fn(usize, &mut [f64; 6])) -> Self {
        let knots = self.knots.iter_mut().enumerate();
        knots.for_each(|(k, (_, place))| change(k, place));
        self
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
        let plan = Plan {
            joints: (0..6)
                .map(|j| self.joint(j).map(JointDrive::Motion))
                .collect::<Result<_, _>>()?,
            ..Plan::default()
        };
        let tolerance = Tolerance {
            relative: 1.0e-13,
            ..Tolerance::default()
        };
        let vehicle = Flight::new(&self.model, &plan, tolerance)?;
        let start = Start {
            R_NB: UnitQuaternion::identity(),
            p_NoBo_N: Vector3::zeros(),
            velocity: StartVelocity::Twist {
                v_NBo_N: Vector3::from(self.velocity),
                w_NB_B: Vector3::from(self.spin_deg_s).map(f64::to_radians),
            },
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
