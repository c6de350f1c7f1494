//! One body from its throws, by maximum likelihood: raw gyro, raw wheel speed, random aerodynamic torque.

use super::chain::{Bodies, Body, Covariance, Found, identify, symmetric};
use super::device::{Device, Lever, NUMBERS, Numbers};
use super::recording::Recording;
use super::{Fault, Throws};
use nalgebra::{Matrix3, SVector, Vector3};
use poinsot::bind::bind;
use poinsot_dynamics::Tree;
use poinsot_identify::{Estimate, Loss, TENSOR, maximum_likelihood_predicted};
use poinsot_model::{Model, Nuisance, RandomTorque, Sensor, SensorKind, SlowError};
use std::path::Path;

/// Prior sigma of the box's angles, rad: ten times the result, so it only helps the start of the fit.
const BUILT: Nuisance = Nuisance::Prior(0.03);

/// Objects from the throws in a folder, with a box that is calibrated or ideal.
pub fn evaluate(folder: &Path, ideal: bool) -> Result<Found, Fault> {
    let mut throws = Throws::read(folder, false);
    let device = match ideal {
        true => Device::ideal(),
        false => calibrate(&mut throws)?,
    };
    device.print();
    identify(&throws, |group, own| {
        bodies(&throws.model, &device, group, own)
    })
}

/// Declared disturbances and box parameters.
#[derive(Clone, Copy)]
struct Declared {
    /// Nonorthogonality of the gyro axes, rad.
    gyro_axes: Nuisance,
    /// Tilt of the wheel's axis, rad.
    wheel_axis: Nuisance,
    /// Lag of the tachometer, s.
    wheel_lag: Nuisance,
    /// White noise of the gyro, sigma per axis, rad/s.
    gyro: Vector3<f64>,
    /// Random aerodynamic torque, N m (J = 1e-6).
    torque_N_m: f64,
}

impl Declared {
    /// The most likely disturbances of a group, with its residual as sigma of the gyro.
    fn of(group: &str, device: &Device) -> Self {
        let known = |sigma: f64| match sigma > 0.0 {
            true => Nuisance::Prior(sigma),
            false => Nuisance::Known,
        };
        let s = &device.numbers_sigma;
        let (gyro, torque_N_m) = match group {
            "device_only" => ([0.0324, 0.0840, 0.1167], 3.0e-5),
            "proof_body" => ([0.0213, 0.0138, 0.0300], 3.0e-5),
            "config_empty" => ([0.0132, 0.0080, 0.0166], 3.0e-4),
            _ => ([0.0112, 0.0079, 0.0127], 1.0e-4),
        };
        Self {
            gyro_axes: known((s.fixed_rows::<3>(0).norm_squared() / 3.0).sqrt()),
            wheel_axis: known((s.fixed_rows::<2>(3).norm_squared() / 2.0).sqrt()),
            wheel_lag: known(s[5]),
            gyro: gyro.into(),
            torque_N_m,
        }
    }

    fn apply(&self, model: &mut Model) {
        model.environment.random_torque = Some(RandomTorque {
            sigma_N_m: self.torque_N_m,
            correlation_s: 0.1,
        });
        for sensor in &mut model.sensors {
            if sensor.kind == SensorKind::Gyro {
                let squares = self.gyro.component_mul(&self.gyro);
                sensor.noise_covariance = None;
                sensor.slow = vec![SlowError {
                    covariance: Matrix3::from_diagonal(&squares),
                    correlation_s: 0.003,
                }];
                sensor.nonorthogonality = self.gyro_axes;
            }
        }
        model.wheels[0].misalignment = self.wheel_axis;
        let gyro = model.sensors_of(SensorKind::Gyro).next().cloned();
        model.sensors.push(Sensor {
            name: "tachometer".to_owned(),
            kind: SensorKind::WheelSpeed,
            noise_covariance: None,
            slow: Vec::new(),
            nonorthogonality: Nuisance::Known,
            lag: self.wheel_lag,
            of: vec![0],
            ..gyro.unwrap()
        });
    }
}

/// Estimate of one problem, in units of the wheel's spin inertia J.
struct Fitted {
    I_over_J: Matrix3<f64>,
    covariance: Covariance,
    /// Accelerometer data on the mass centre along the fitted motion.
    lever: Lever,
    /// Estimated box parameters with sigmas, if they are unknown.
    device: Option<(Numbers, Numbers)>,
}

/// Fits one throw. Unknown box parameters are fitted from the solution with nominal ones, because the linear start cannot
/// determine them.
fn fit(model: &Model, throw: &Recording, declared: &Declared) -> Result<Fitted, Fault> {
    let sure = Declared {
        gyro_axes: Nuisance::Known,
        wheel_axis: Nuisance::Known,
        wheel_lag: Nuisance::Known,
        ..*declared
    };
    let first = fit_from(model, throw, &sure)?;
    let asked = [declared.gyro_axes, declared.wheel_axis, declared.wheel_lag];
    if asked == [Nuisance::Known; 3] {
        return Ok(first);
    }
    let mut near = model.clone();
    near.bodies[0].nominal.I_BBcm_B = first.I_over_J * model.wheels[0].spin_inertia;
    fit_from(&near, throw, declared)
}

fn fit_from(model: &Model, throw: &Recording, declared: &Declared) -> Result<Fitted, Fault> {
    let mut model = model.clone();
    declared.apply(&mut model);
    let tables = [throw.table(0, throw.time_s.len())];
    let tree = Tree::new(&model);
    let bound = bind(&model, &tree, &tables)?;
    let problem = bound.problem(&model, &tree);
    let (estimate, predictions) =
        maximum_likelihood_predicted(&problem, Loss::Gaussian, usize::MAX)?;
    let J = model.wheels[0].spin_inertia;
    let numbers = &estimate.bodies[0].inertia;
    if numbers.iter().any(|n| n.value.is_none()) {
        let why = estimate.warnings().join("; ");
        return Err(format!("{}: {}: {why}", throw.name, estimate.status.name()).into());
    }
    let place = |name: &str| estimate.covariance_names.iter().position(|n| n == name);
    let at = ["xx", "xy", "yy", "xz", "yz", "zz"]
        .map(|element| place(&format!("thrown.inertia_{element}")).unwrap());
    let w: Vec<Vector3<f64>> = predictions[0]
        .omega_rad_s
        .iter()
        .map(|w| (*w).into())
        .collect();
    assert_eq!(w.len(), throw.f_S_B.len());
    let mut lever = Lever::default();
    lever.follow(throw, &w);
    Ok(Fitted {
        I_over_J: symmetric(std::array::from_fn(|k| numbers[k].value.unwrap() / J)),
        covariance: Covariance::from_fn(|i, j| estimate.covariance[at[i]][at[j]] / (J * J)),
        lever,
        device: device(&estimate),
    })
}

fn device(estimate: &Estimate) -> Option<(Numbers, Numbers)> {
    let found = NUMBERS.map(|name| {
        let number = estimate.nuisance.iter().find(|n| n.name == name)?;
        number.number.value.zip(number.number.sigma)
    });
    let found: Vec<(f64, f64)> = found.into_iter().collect::<Option<_>>()?;
    Some((
        Numbers::from_fn(|k, _| found[k].0),
        Numbers::from_fn(|k, _| found[k].1),
    ))
}

/// Calibrates the box from each calibration throw separately: gyro axes and wheel axis, then the accelerometer's bias
/// along the fitted motions. Samples and model are corrected.
fn calibrate(throws: &mut Throws) -> Result<Device, Fault> {
    let fits = |throws: &Throws, device: &Device, unknown: bool| -> Result<Vec<Fitted>, Fault> {
        let mut list = Vec::new();
        for group in ["device_only", "proof_body"] {
            let mut asked = Declared::of(group, device);
            if unknown {
                (asked.gyro_axes, asked.wheel_axis) = (BUILT, BUILT);
                asked.wheel_lag = Nuisance::Prior(2.0e-3);
            }
            for throw in throws.group(group) {
                list.push(fit(&throws.model, throw, &asked)?);
            }
        }
        Ok(list)
    };
    let mut device = Device::ideal();
    let found = fits(throws, &device, true)?;
    let found: Vec<_> = found.iter().filter_map(|f| f.device).collect();
    (device.numbers, device.numbers_sigma) = Device::of_numbers(&found);
    throws.model = device.tilted(&throws.model);
    for throw in throws.groups.iter_mut().flat_map(|(_, own)| own) {
        *throw = device.corrected(throw)?;
    }
    let again = fits(throws, &device, false)?;
    let levers: Vec<_> = again.iter().map(|f| &f.lever).collect();
    let found = Device::of_bias(&levers).ok_or("the accelerometer is not seen")?;
    (device.bias, device.bias_covariance) = found;
    Ok(device)
}

/// Each throw separately, and all together: the covariance-weighted mean.
fn bodies(model: &Model, device: &Device, group: &str, own: &[Recording]) -> Result<Bodies, Fault> {
    const UNSEEN: &str = "the mass centre is not seen";
    let declared = Declared::of(group, device);
    let fits = own.iter().map(|t| fit(model, t, &declared));
    let fits: Vec<Fitted> = fits.collect::<Result<_, _>>()?;
    let n = fits.len() as f64;
    let centres = fits.iter().map(|f| f.lever.p_Sc_B(&device.bias));
    let centres: Vec<Vector3<f64>> = centres.collect::<Option<_>>().ok_or(UNSEEN)?;
    let centre = centres.iter().sum::<Vector3<f64>>() / n;
    let slopes = fits.iter().map(|f| f.lever.slope());
    let by_bias = slopes.sum::<Option<Matrix3<f64>>>().ok_or(UNSEEN)? / n;
    let biased = by_bias * device.bias_covariance * by_bias.transpose();
    // The accelerometer's errors are vibration, so the uncertainty of the mass centre is its observed scatter.
    let off = centres
        .iter()
        .map(|p| (p - centre) * (p - centre).transpose());
    let spread = off.sum::<Matrix3<f64>>() / (n - 1.0);
    let (I, covariance, birge) = weighted_mean(&fits).ok_or("a covariance is singular")?;
    // If the throws scatter more than stated, each sigma is increased.
    let body = |(f, p): (&Fitted, &Vector3<f64>)| Body {
        I: f.I_over_J,
        p: *p,
        I_cov: f.covariance * birge,
        p_cov: spread + biased,
    };
    Ok(Bodies {
        each: fits.iter().zip(&centres).map(body).collect(),
        together: Body {
            I,
            p: centre,
            I_cov: covariance,
            p_cov: spread / n + biased,
        },
        scatter: birge.sqrt(),
    })
}

/// Covariance-weighted mean of the tensors, its covariance widened by the ratio of observed to stated scatter of the throws
/// (Birge 1932), and that ratio, at least one.
fn weighted_mean(fits: &[Fitted]) -> Option<(Matrix3<f64>, Covariance, f64)> {
    let six = |I: &Matrix3<f64>| SVector::<f64, 6>::from_fn(|k, _| I[TENSOR[k]]);
    let (mut information, mut sum) = (Covariance::zeros(), SVector::<f64, 6>::zeros());
    for f in fits {
        let own = f.covariance.cholesky()?.inverse();
        information += own;
        sum += own * six(&f.I_over_J);
    }
    let covariance = information.cholesky()?.inverse();
    let mean = covariance * sum;
    let mut square = 0.0;
    for f in fits {
        let d = six(&f.I_over_J) - mean;
        square += d.dot(&f.covariance.cholesky()?.solve(&d));
    }
    let birge = (square / (6.0 * (fits.len() as f64 - 1.0))).max(1.0);
    Some((symmetric(mean.into()), covariance * birge, birge))
}
