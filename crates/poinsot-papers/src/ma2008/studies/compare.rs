//! Both options, the linear method and the Cramer-Rao bound for the same draws. Noise is 1 % of the largest velocity
//! components of trajectory 1 at 5 deg/s, ten samples at stops.

use super::cramer_rao::cramer_rao;
use super::experiment::{Experiment, Run, unsymmetric};
use super::noise::{OPTIONS, SEEDS, Sigma, draw, errors, trials};
use crate::ma2008::Raw;
use crate::study::statistics::rms;
use crate::study::{Context, Findings, StudyError, Table, figures};
use poinsot_dynamics::Tree;
use poinsot_identify::{
    Estimate, Noise, Observations, Problem, Samples, Segment, SensorRecord, SensorValue, TENSOR,
    Translation, linear,
};
use poinsot_model::{MomentumKnowledge, SensorKind};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};

/// Trials of the linear method for runs with 200 samples.
const FEW: u64 = 30;
/// Accuracy limit at which everything counts as identified, because only errors are compared.
const ANY_ACCURACY: f64 = 1.0e6;
/// Sigma of the attitude, rad; practically exact.
const EXACT: f64 = 1.0e-7;

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let sigma = Sigma::fixed(context)?;
    let head = "motion, samples, spin | option 1 | option 2 | linear, known | linear, unknown | bound, known | bound, unknown";
    let title =
        |what: &str| format!("Rms error of {SEEDS} trials (linear at 200 samples {FEW}), {what}");
    let mut tables = [
        Table::new("mass", &title("mass, %"), head),
        Table::new("mass_centre", &title("mass centre, mm"), head),
        Table::new("tensor", &title("tensor, % of its norm"), head),
    ];
    for (motion, samples, spin) in [
        ("stopped", 10, 5.0),
        ("stopped", 200, 5.0),
        ("moving", 10, 5.0),
        ("moving", 200, 5.0),
        ("stopped", 10, 0.0),
        ("moving", 10, 0.0),
        ("moving", 200, 0.0),
    ] {
        let mut e = Experiment::of(context, 1, [0.0, 0.0, spin])?
            .with_base(unsymmetric())
            .sampled(samples, motion == "stopped");
        e.velocity = [0.02, -0.01, 0.005];
        let run = e.run()?;
        let of = |found: Vec<[f64; 3]>| -> [f64; 3] {
            std::array::from_fn(|k| rms(found.iter().map(|x| x[k])))
        };
        let mut columns = Vec::new();
        for known in OPTIONS {
            columns.push(of(trials(&e, &run, sigma, known, SEEDS)));
        }
        for known in OPTIONS {
            let seeds = 0..if samples == 10 { SEEDS } else { FEW };
            let found = seeds.filter_map(|seed| {
                let moved = draw(&run.raws, sigma, seed);
                properties(&answer(&e, &run, &moved, sigma, known)?)
            });
            columns.push(of(found.map(|p| errors(Some(p), &e.truth())).collect()));
        }
        for known in OPTIONS {
            columns.push(cramer_rao(&e, &run, sigma, known));
        }
        let spin = if spin > 0.0 {
            format!("{spin} deg/s")
        } else {
            "no spin".to_owned()
        };
        for (k, table) in tables.iter_mut().enumerate() {
            let scale = if k == 1 { 1000.0 } else { 100.0 };
            // An undetermined number is not compared: its bound is infinite.
            let bounded = |(column, c): (usize, &[f64; 3])| match columns[4 + column % 2][k] {
                bound if bound.is_finite() => figures(scale * c[k], 2),
                _ => figures(f64::NAN, 2),
            };
            let cells = columns.iter().enumerate().map(bounded);
            table.row(format!("{motion}, {samples}, {spin}"), cells);
        }
    }
    let mut findings = Findings::default();
    // Ten samples at 5 deg/s, bound with known momentum.
    let [stopped, moving] = [0, 2].map(|row| tables[2].rows[row][5].text());
    findings.state(
        "measurements once the arm has settled",
        format!("bound of the tensor {stopped} % stopped, {moving} % moving"),
    );
    findings.tables.extend(tables);
    Ok(findings)
}

/// A run for the linear method, with the exact position of the base, which the two steps do not use.
fn segment(run: &Run, raws: &[Raw], noise: &Noise) -> Segment {
    let of = |kind, covariance, value: fn(&Raw) -> SensorValue| {
        SensorRecord::of_base(kind, covariance).at_every_time(raws.iter().map(value))
    };
    let joint_position: Vec<f64> = raws.iter().flat_map(|r| r.q.clone()).collect();
    let joint_rate: Vec<f64> = raws.iter().flat_map(|r| r.rates.clone()).collect();
    Segment {
        label: "study".to_owned(),
        samples: Samples {
            time_s: run.times.clone(),
            R_NB: raws.iter().map(|r| r.R_NB).collect(),
            w_NB_B: raws.iter().map(|r| r.w_NB_B).collect(),
            translation: Some(Translation {
                v_NBo_N: raws.iter().map(|r| r.v_NBo_N).collect(),
                p_NoBo_N: run.positions.iter().map(|p| p - run.positions[0]).collect(),
            }),
            joint_position: joint_position.clone(),
            joint_rate: joint_rate.clone(),
            wheel_speed: Vec::new(),
        },
        firings: Vec::new(),
        accelerations: None,
        observations: Observations {
            time_s: run.times.clone(),
            sensors: vec![
                of(SensorKind::Gyro, noise.gyro, |r| {
                    SensorValue::Vector(r.w_NB_B)
                }),
                of(SensorKind::Attitude, noise.attitude, |r| {
                    SensorValue::Attitude(r.R_NB)
                }),
                of(SensorKind::Velocity, noise.velocity, |r| {
                    SensorValue::Vector(r.v_NBo_N)
                }),
            ],
            joint_position,
            joint_rate,
            ..Observations::default()
        },
    }
}

/// Noise of the two velocities; all else is exact.
fn noise(sigma: Sigma) -> Noise {
    let square = |s: Vector3| Matrix3::from_diagonal(&s.component_mul(&s));
    Noise {
        gyro_sensor: None,
        gyro: square(sigma.w),
        attitude: Matrix3::identity() * EXACT * EXACT,
        velocity: square(sigma.v),
        position: Matrix3::zeros(),
        joint_position: vec![0.0; 6],
        joint_rate: vec![0.0; 6],
        wheel_speed: Vec::new(),
        seen_gyro: 1.0,
        seen_velocity: 1.0,
        seen_joint_rate: 0.0,
    }
}

/// The linear method for one draw.
fn answer(e: &Experiment, run: &Run, raws: &[Raw], sigma: Sigma, known: bool) -> Option<Estimate> {
    let mut model = e.model.clone();
    if known {
        model.momentum.linear = MomentumKnowledge::Known(run.known.p_C_N);
        model.momentum.angular = MomentumKnowledge::Known(run.known.h_C_N);
    }
    let tree = Tree::new(&model);
    let noise = noise(sigma);
    linear(&Problem {
        model: &model,
        tree: &tree,
        segments: &[segment(run, raws, &noise)],
        noise: &noise,
        relative_accuracy: ANY_ACCURACY,
    })
    .ok()
}

/// Mass properties of an answer, if complete.
fn properties(e: &Estimate) -> Option<MassProperties> {
    let b = e.bodies.first()?;
    let mut I = Matrix3::zeros();
    for (n, (i, j)) in b.inertia.iter().zip(TENSOR) {
        I[(i, j)] = n.value?;
        I[(j, i)] = n.value?;
    }
    Some(MassProperties {
        mass: b.mass.value?,
        p_BoBcm_B: Vector3::new(b.com[0].value?, b.com[1].value?, b.com[2].value?),
        I_BBcm_B: I,
    })
}
