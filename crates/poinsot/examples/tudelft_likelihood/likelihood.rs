//! One body from its throws, by maximum likelihood: raw gyro, raw wheel speed, a random torque of the air.

use super::Fault;
use super::throws::inertia::table;
use super::throws::recording::Recording;
use nalgebra::{Matrix3, SMatrix, Vector3};
use poinsot::bind::bind;
use poinsot_dynamics::Tree;
use poinsot_identify::{Loss, Prediction, Problem, TENSOR, maximum_likelihood_predicted};
use poinsot_model::{Model, RandomTorque, SensorKind};

/// Covariance of the six tensor elements in the order of [`TENSOR`].
pub type Covariance = SMatrix<f64, 6, 6>;

/// What is declared of the disturbances.
#[derive(Debug, Clone, Copy)]
pub struct Declared {
    /// White noise of the gyro, one sigma an axis, rad/s.
    pub gyro: Vector3<f64>,
    /// Correlation time of that noise, s; zero where it is white.
    pub gyro_correlation_s: f64,
    /// Random torque of the air.
    pub torque: RandomTorque,
}

/// The answer of one problem, in units of the wheel's spin inertia J.
#[derive(Debug, Clone)]
pub struct Fitted {
    pub I_over_J: Matrix3<f64>,
    pub covariance: Covariance,
    /// `-2 ln` of the restricted likelihood.
    pub deviance: f64,
    /// Root mean square of the gyro's residual, rad/s.
    pub residual: Vector3<f64>,
    /// Mass centre from the accelerometer along the fitted motion, from the sensor, body axes, m.
    pub p_Sc_B: Vector3<f64>,
}

/// Fits throws of one body as segments: the body is shared, each has its own momentum and random torque.
pub fn fit(model: &Model, throws: &[&Recording], declared: &Declared) -> Result<Fitted, Fault> {
    let mut model = model.clone();
    model.environment.random_torque = Some(declared.torque);
    for sensor in model
        .sensors
        .iter_mut()
        .filter(|s| s.kind == SensorKind::Gyro)
    {
        let squares = declared.gyro.component_mul(&declared.gyro);
        sensor.noise_covariance = Some(Matrix3::from_diagonal(&squares));
        sensor.correlation_s = declared.gyro_correlation_s;
    }
    let tables: Vec<_> = throws.iter().map(|t| table(t, 0, t.time_s.len())).collect();
    let tree = Tree::new(&model);
    let bound = bind(&model, &tree, &tables)?;
    let problem = Problem {
        model: &model,
        tree: &tree,
        segments: &bound.segments,
        noise: &bound.noise,
        relative_accuracy: 1.0,
    };
    let (estimate, predictions) =
        maximum_likelihood_predicted(&problem, Loss::Gaussian, usize::MAX)?;
    let J = model.wheels[0].spin_inertia;
    let mut I = Matrix3::zeros();
    for ((i, j), number) in TENSOR.iter().zip(&estimate.bodies[0].inertia) {
        let value = number.value.ok_or_else(|| {
            format!(
                "{}: {}",
                estimate.status.name(),
                estimate.warnings.join("; ")
            )
        })?;
        I[(*i, *j)] = value;
        I[(*j, *i)] = value;
    }
    let wanted = ["xx", "xy", "yy", "xz", "yz", "zz"].map(|k| format!("thrown.inertia_{k}"));
    let at: Vec<usize> = wanted
        .iter()
        .filter_map(|name| estimate.covariance_names.iter().position(|n| n == name))
        .collect();
    if at.len() != 6 {
        return Err("the covariance lacks an entry".into());
    }
    let diagnostics = estimate.diagnostics.ok_or("no diagnostics")?;
    Ok(Fitted {
        I_over_J: I / J,
        covariance: Covariance::from_fn(|i, j| estimate.covariance[at[i]][at[j]] / (J * J)),
        deviance: diagnostics.deviance,
        residual: residual(&predictions),
        p_Sc_B: mass_centre(throws, &predictions).ok_or("the mass centre is not seen")?,
    })
}

fn residual(predictions: &[Prediction]) -> Vector3<f64> {
    let channels = predictions
        .iter()
        .flat_map(|p| p.channels.iter().find(|c| c.name == "gyro"));
    let rows: Vec<&Vec<Vec<f64>>> = channels.map(|c| &c.residual).collect();
    Vector3::from_fn(|k, _| {
        let all = rows.iter().flat_map(|r| &r[k]);
        let count = rows.iter().map(|r| r[k].len()).sum::<usize>().max(1);
        (all.map(|x| x * x).sum::<f64>() / count as f64).sqrt()
    })
}

/// `f_S = w' x r + w x (w x r)` with `r` from the mass centre to the sensor: raw readings of the accelerometer,
/// the fitted motion. Nothing is filtered; the regressors have no noise.
fn mass_centre(throws: &[&Recording], predictions: &[Prediction]) -> Option<Vector3<f64>> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (throw, predicted) in throws.iter().zip(predictions) {
        let (t, w) = (&predicted.motion.time_s, &predicted.motion.w_NB_B);
        if w.len() != throw.f_S_B.len() {
            return None;
        }
        for k in 1..w.len().saturating_sub(1) {
            let dw = (Vector3::from(w[k + 1]) - Vector3::from(w[k - 1])) / (t[k + 1] - t[k - 1]);
            let turn = Vector3::from(w[k]).cross_matrix();
            let A = dw.cross_matrix() + turn * turn;
            normal += A.transpose() * A;
            right += A.transpose() * throw.f_S_B[k];
        }
    }
    normal.cholesky().map(|c| -c.solve(&right))
}
