//! The Table 1 system of Ma, Dang and Pham 2008 with both trajectories, shared by studies and tests.
#![allow(clippy::expect_used)]

use poinsot_dynamics::{JointMotion, Plan, Prescribed, Start, StartVelocity, Tolerance, Tree};
use poinsot_model::{Model, read_model};
use poinsot_papers::ma2008::{Known, Raw, Reading, Vehicle};
use poinsot_spatial::{MassProperties, Matrix3, UnitQuaternion, Vector3};
use std::path::{Path, PathBuf};

/// The folder of shipped examples.
pub fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

/// The Table 1 system with its true numbers.
pub fn table1() -> Model {
    read_model(examples().join("cases/ma2008_truth.toml")).expect("the shipped model is readable")
}

/// A base that hides nothing: offset mass centre, full tensor.
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
    /// How far joint 2 swings out and back between stops, deg.
    pub detour_deg: f64,
}

/// Trajectory 1: stretch up, swing down to the top plane, turn about joint 1.
pub fn trajectory1() -> Vec<(f64, [f64; 6])> {
    let (up, down) = (
        [0.0, -90.0, 180.0, 0.0, 0.0, 0.0],
        [0.0, -180.0, 180.0, 0.0, 0.0, 0.0],
    );
    let turned = [150.0, -180.0, 180.0, 0.0, 0.0, 0.0];
    vec![
        (0.0, [0.0; 6]),
        (5.0, [0.0; 6]),
        (45.0, up),
        (75.0, down),
        (125.0, turned),
        (135.0, turned),
    ]
}

/// Trajectory 2: stretch up and fold back.
pub fn trajectory2() -> Vec<(f64, [f64; 6])> {
    let up = [0.0, -90.0, 180.0, 0.0, 0.0, 0.0];
    vec![
        (0.0, [0.0; 6]),
        (5.0, [0.0; 6]),
        (45.0, up),
        (85.0, [0.0; 6]),
        (90.0, [0.0; 6]),
    ]
}

/// The same stops with a swing out by `angle` half-way between each two.
fn detour(stops: &[f64], place: &[f64], angle: f64) -> (Vec<f64>, Vec<f64>) {
    let mut out = (Vec::new(), Vec::new());
    for k in 0..stops.len() {
        out.0.push(stops[k]);
        out.1.push(place[k]);
        if let (Some(t), Some(q)) = (stops.get(k + 1), place.get(k + 1)) {
            out.0.push(0.5 * (stops[k] + t));
            out.1.push(0.5 * (place[k] + q) + angle);
        }
    }
    out
}

/// `n` times equally spaced over the moving part of a trajectory.
pub fn equally_spaced(knots: &[(f64, [f64; 6])], n: usize) -> Vec<f64> {
    let (a, b) = (knots[1].0, knots[knots.len() - 2].0);
    (0..n)
        .map(|k| a + (b - a) * k as f64 / (n - 1) as f64)
        .collect()
}

/// What the run gives: samples and the true momentum.
pub struct Run {
    /// Times, s.
    pub times: Vec<f64>,
    /// Samples.
    pub raws: Vec<Raw>,
    /// Positions of the base origin, in N, m.
    pub positions: Vec<Vector3>,
    /// Momentum at the first sample.
    pub known: Known,
}

impl Experiment {
    /// The base at rest on trajectory 1 or 2, ten stopped samples.
    pub fn new(trajectory: usize, spin_deg_s: [f64; 3]) -> Self {
        let knots = if trajectory == 1 {
            trajectory1()
        } else {
            trajectory2()
        };
        Self {
            model: table1(),
            times: equally_spaced(&knots, 10),
            knots,
            spin_deg_s,
            velocity: [0.0; 3],
            stops: true,
            detour_deg: 0.0,
        }
    }

    /// With another base.
    pub fn with_base(mut self, base: MassProperties) -> Self {
        self.model.bodies[0].nominal = base;
        self
    }

    /// The arm's masses and inertias times a factor.
    pub fn with_arm_factor(mut self, factor: f64) -> Self {
        for body in &mut self.model.bodies[1..] {
            body.nominal.mass *= factor;
            body.nominal.I_BBcm_B *= factor;
        }
        self
    }

    /// With samples of the moving arm.
    pub fn moving(mut self, samples: usize) -> Self {
        self.times = equally_spaced(&self.knots, samples);
        self.stops = false;
        self
    }

    /// With this many stopped samples.
    pub fn stopped(mut self, samples: usize) -> Self {
        self.times = equally_spaced(&self.knots, samples);
        self.stops = true;
        self
    }

    fn plan(&self) -> Plan {
        let time: Vec<f64> = self.knots.iter().map(|k| k.0).collect();
        let joint = |j: usize| -> JointMotion {
            let position: Vec<f64> = self.knots.iter().map(|k| k.1[j].to_radians()).collect();
            let smooth = JointMotion::quintic_rest(&time, &position).expect("ascending knots");
            if !self.stops {
                return smooth;
            }
            // Through the same configurations, but at rest at every sample.
            let mut stops = time.clone();
            stops.extend(&self.times);
            stops.sort_by(f64::total_cmp);
            stops.dedup_by(|a, b| (*a - *b).abs() < 1.0e-9);
            let place: Vec<f64> = stops.iter().map(|t| smooth.at(*t, *t).value).collect();
            if j == 1 && self.detour_deg != 0.0 {
                let (stops, place) = detour(&stops, &place, self.detour_deg.to_radians());
                return JointMotion::quintic_rest(&stops, &place).expect("ascending stops");
            }
            JointMotion::quintic_rest(&stops, &place).expect("ascending stops")
        };
        Plan {
            joints: (0..6).map(joint).collect(),
            wheels: Vec::new(),
            firings: Vec::new(),
        }
    }

    /// Runs it; the start is at time zero, the samples where asked.
    pub fn run(&self) -> Run {
        let plan = self.plan();
        let tolerance = Tolerance {
            relative: 1.0e-13,
            ..Tolerance::default()
        };
        let vehicle = Prescribed::new(&self.model, &plan, tolerance).expect("the plan fits");
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
        let mut raws = Vec::new();
        let mut positions = Vec::new();
        let mut known = None;
        vehicle
            .run(&start, &times, |s| {
                known.get_or_insert(Known {
                    p_C_N: s.l_S_N,
                    h_C_N: s.h_SScm_N,
                });
                positions.push(s.p_NoBo_N);
                raws.push(Raw {
                    R_NB: s.R_NB,
                    v_NBo_N: s.v_NBo_N,
                    w_NB_B: s.w_NB_B,
                    q: s.q.clone(),
                    rates: if self.stops {
                        vec![0.0; s.rates.len()]
                    } else {
                        s.rates.clone()
                    },
                    wheel_speed: Vec::new(),
                });
            })
            .expect("the motion can be computed");
        raws.remove(0);
        positions.remove(0);
        Run {
            times: self.times.clone(),
            raws,
            positions,
            known: known.expect("a first sample"),
        }
    }

    /// The true base.
    pub fn truth(&self) -> MassProperties {
        self.model.bodies[0].nominal
    }
}

/// Samples in the form the two steps take.
pub fn readings(model: &Model, raws: &[Raw]) -> Vec<Reading> {
    let tree = Tree::new(model);
    let mut vehicle = Vehicle::new(model, &tree);
    raws.iter().map(|r| vehicle.reading(r)).collect()
}
