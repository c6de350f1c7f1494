//! One body from its throws, by maximum likelihood: raw gyro, raw wheel speed, random aerodynamic torque.

use super::Fault;
use super::device::{Lever, NUMBERS, Numbers};
use super::throws::inertia::table;
use super::throws::recording::Recording;
use nalgebra::{Matrix3, SMatrix, Vector3};
use poinsot::bind::bind;
use poinsot_dynamics::Tree;
use poinsot_identify::{Loss, Prediction, TENSOR, maximum_likelihood_predicted};
use poinsot_model::{Model, Nuisance, RandomTorque, Sensor, SensorKind};

/// Covariance of the six tensor elements in the order of [`TENSOR`].
pub type Covariance = SMatrix<f64, 6, 6>;

/// Declared disturbances and box parameters.
#[derive(Debug, Clone, Copy)]
pub struct Declared {
    /// Nonorthogonality of the gyro axes, rad.
    pub gyro_axes: Nuisance,
    /// Tilt of the wheel's axis, rad.
    pub wheel_axis: Nuisance,
    /// Lag of the tachometer, s.
    pub wheel_lag: Nuisance,
    /// Constant aerodynamic torque in inertial axes, N m (J = 1e-6); for single throws only.
    pub steady: Nuisance,
    /// Coefficients of the drag torque `-c |w| w`, kg m2 (J = 1e-6).
    pub drag: Nuisance,
    /// White noise of the gyro, sigma per axis, rad/s.
    pub gyro: Vector3<f64>,
    /// Correlation time of that noise, s; zero if white.
    pub gyro_correlation_s: f64,
    pub torque: RandomTorque,
}

/// Estimate of one problem, in units of the wheel's spin inertia J.
#[derive(Debug, Clone)]
pub struct Fitted {
    pub I_over_J: Matrix3<f64>,
    pub covariance: Covariance,
    /// `-2 ln` of the restricted likelihood.
    pub deviance: f64,
    /// RMS of the gyro's residual, rad/s.
    pub residual: Vector3<f64>,
    /// Accelerometer data on the mass centre along the fitted motion.
    pub lever: Lever,
    /// Estimated box parameters with sigmas, if requested.
    pub device: Option<(Numbers, Numbers)>,
}

/// Fits throws of one body as segments: the body is common, each throw has its own momentum and random torque. Unknown
/// box parameters are fitted from the solution with nominal ones, because the linear start cannot determine them.
pub fn fit(model: &Model, throws: &[&Recording], declared: &Declared) -> Result<Fitted, Fault> {
    let sure = Declared {
        gyro_axes: Nuisance::Known,
        wheel_axis: Nuisance::Known,
        wheel_lag: Nuisance::Known,
        steady: Nuisance::Known,
        drag: Nuisance::Known,
        ..*declared
    };
    let first = fit_from(model, throws, &sure)?;
    let asked = [
        declared.gyro_axes,
        declared.wheel_axis,
        declared.wheel_lag,
        declared.steady,
        declared.drag,
    ];
    if asked == [Nuisance::Known; 5] {
        return Ok(first);
    }
    let mut near = model.clone();
    near.bodies[0].nominal.I_BBcm_B = first.I_over_J * model.wheels[0].spin_inertia;
    fit_from(&near, throws, declared)
}

fn fit_from(model: &Model, throws: &[&Recording], declared: &Declared) -> Result<Fitted, Fault> {
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
        sensor.nonorthogonality = declared.gyro_axes;
    }
    for wheel in &mut model.wheels {
        wheel.misalignment = declared.wheel_axis;
    }
    let gyro = model.sensors_of(SensorKind::Gyro).next().cloned();
    if let Some(gyro) = gyro {
        let tachometer = Sensor {
            name: "tachometer".to_owned(),
            kind: SensorKind::WheelSpeed,
            noise_covariance: None,
            correlation_s: 0.0,
            nonorthogonality: Nuisance::Known,
            lag: declared.wheel_lag,
            of: vec![0],
            ..gyro
        };
        model.sensors.push(tachometer);
    }
    model.environment.drag_torque = declared.drag;
    if throws.len() == 1 {
        model.environment.disturbance_torque_inertial = declared.steady;
    }
    let tables: Vec<_> = throws.iter().map(|t| table(t, 0, t.time_s.len())).collect();
    let tree = Tree::new(&model);
    let bound = bind(&model, &tree, &tables)?;
    let problem = bound.problem(&model, &tree);
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
    let place = |name: &str| estimate.covariance_names.iter().position(|n| n == name);
    let wanted = ["xx", "xy", "yy", "xz", "yz", "zz"].map(|k| format!("thrown.inertia_{k}"));
    let at: Vec<usize> = wanted.iter().filter_map(|name| place(name)).collect();
    if at.len() != 6 {
        return Err("the covariance lacks an entry".into());
    }
    let found: Vec<(f64, f64)> = NUMBERS
        .iter()
        .filter_map(|name| estimate.nuisance.iter().find(|n| n.name == *name))
        .filter_map(|n| n.number.value.zip(n.number.sigma))
        .collect();
    let device = (found.len() == NUMBERS.len()).then(|| {
        (
            Numbers::from_fn(|k, _| found[k].0),
            Numbers::from_fn(|k, _| found[k].1),
        )
    });
    let diagnostics = estimate.diagnostics.ok_or("no diagnostics")?;
    Ok(Fitted {
        I_over_J: I / J,
        covariance: Covariance::from_fn(|i, j| estimate.covariance[at[i]][at[j]] / (J * J)),
        deviance: diagnostics.deviance,
        residual: residual(&predictions),
        lever: lever(throws, &predictions).ok_or("the mass centre is not seen")?,
        device,
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

/// Raw samples of the accelerometer along the fitted motion: unfiltered, with noise-free regressors.
fn lever(throws: &[&Recording], predictions: &[Prediction]) -> Option<Lever> {
    let mut lever = Lever::default();
    for (throw, predicted) in throws.iter().zip(predictions) {
        let (t, w) = (&predicted.motion.time_s, &predicted.motion.w_NB_B);
        if w.len() != throw.f_S_B.len() {
            return None;
        }
        for k in 1..w.len().saturating_sub(1) {
            let dw = (Vector3::from(w[k + 1]) - Vector3::from(w[k - 1])) / (t[k + 1] - t[k - 1]);
            let turn = Vector3::from(w[k]).cross_matrix();
            lever.push(&(dw.cross_matrix() + turn * turn), &throw.f_S_B[k]);
        }
    }
    Some(lever)
}
