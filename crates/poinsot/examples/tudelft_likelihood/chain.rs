//! From throws to objects, with the uncertainty of every step: box, block, object.
//!
//! Symbols: `b` the measuring box, `o` an object, `c` both bolted together; `J` the wheel's spin inertia.

use super::device::Device;
use super::likelihood::{Covariance, Declared, Fitted, fit};
use super::throws::recording::{Recording, read_logs, read_recording};
use super::throws::truth::{Known, Truth, read_truth};
use super::throws::{Fault, MODEL, Settings};
use nalgebra::{Matrix3, SVector, Vector3};
use poinsot_identify::TENSOR;
use poinsot_model::{Model, Nuisance, RandomTorque, parse_model};
use poinsot_spatial::parallel_axis;
use std::path::Path;

/// Averaged samples: 4 kHz becomes 1 kHz.
const TOGETHER: usize = 4;

/// Prior sigma of the box's angles, rad: ten times the result, so it only helps the start of the fit.
const BUILT: Nuisance = Nuisance::Prior(0.03);

/// Declared disturbances of a group: the most likely of those printed by `--choose`, with its residual as sigma of the
/// gyro.
pub fn declared(group: &str, device: &Device) -> Declared {
    let known = |sigma: f64| match sigma > 0.0 {
        true => Nuisance::Prior(sigma),
        false => Nuisance::Known,
    };
    let s = &device.numbers_sigma;
    let (gyro, steady_N_m, sigma_N_m, drag_kg_m2) = match group {
        "device_only" => (Vector3::new(0.0324, 0.0840, 0.1167), 0.0, 3.0e-5, 0.0),
        "proof_body" => (Vector3::new(0.0213, 0.0138, 0.0300), 0.0, 3.0e-5, 0.0),
        "config_empty" => (Vector3::new(0.0132, 0.0080, 0.0166), 0.0, 3.0e-4, 0.0),
        _ => (Vector3::new(0.0112, 0.0079, 0.0127), 0.0, 1.0e-4, 0.0),
    };
    Declared {
        gyro_axes: known((s.fixed_rows::<3>(0).norm_squared() / 3.0).sqrt()),
        wheel_axis: known((s.fixed_rows::<2>(3).norm_squared() / 2.0).sqrt()),
        wheel_lag: known(s[5]),
        steady: known(steady_N_m),
        drag: known(drag_kg_m2),
        gyro,
        gyro_correlation_s: 0.003,
        torque: RandomTorque {
            sigma_N_m,
            correlation_s: 0.1,
        },
    }
}

/// All throws, read and averaged.
pub struct Throws {
    /// Whether the throws of one body are also fitted as segments of one problem.
    pub as_segments: bool,
    /// Calibration common to all throws.
    pub device: Device,
    pub model: Model,
    truth: Truth,
    alone: Vec<Recording>,
    proof: Vec<Recording>,
    objects: Vec<(Known, Vec<Recording>)>,
}

impl Throws {
    pub fn groups(&self) -> Vec<(&str, &[Recording])> {
        let mut list: Vec<(&str, &[Recording])> =
            vec![("device_only", &self.alone), ("proof_body", &self.proof)];
        list.extend(
            self.objects
                .iter()
                .map(|(k, t)| (k.name.as_str(), t.as_slice())),
        );
        list
    }
}

/// Reads the folder.
pub fn prepare(folder: &Path, as_segments: bool) -> Result<Throws, Fault> {
    let model = parse_model(MODEL, "model.toml")?;
    let settings = Settings {
        cut_off_hz: f64::INFINITY,
        ..Settings::default()
    };
    let logs = read_logs(folder)?;
    let group = |name: &str| -> Result<Vec<Recording>, Fault> {
        logs.iter()
            .filter(|l| l.group == name)
            .map(|l| Ok(averaged(&read_recording(folder, &model, l, &settings)?)))
            .collect()
    };
    let truth = read_truth(folder)?;
    let mut objects = Vec::new();
    for known in &truth.objects {
        objects.push((known.clone(), group(&known.name)?));
    }
    let (alone, proof) = (group("device_only")?, group("proof_body")?);
    Ok(Throws {
        as_segments,
        device: Device::ideal(),
        model,
        truth,
        alone,
        proof,
        objects,
    })
}

/// Calibrates the box from each calibration throw separately: gyro axes and wheel axis, then the accelerometer's bias
/// along the fitted motions. Samples and model are corrected.
pub fn calibrate(throws: &mut Throws) -> Result<(), Fault> {
    let fits = |throws: &Throws, unknown: bool| -> Result<Vec<Fitted>, Fault> {
        let mut list = Vec::new();
        for (group, own) in [
            ("device_only", &throws.alone),
            ("proof_body", &throws.proof),
        ] {
            let mut asked = declared(group, &throws.device);
            if unknown {
                (asked.gyro_axes, asked.wheel_axis) = (BUILT, BUILT);
                asked.wheel_lag = Nuisance::Prior(2.0e-3);
            }
            for throw in own {
                list.push(fit(&throws.model, &[throw], &asked)?);
            }
        }
        Ok(list)
    };
    let found: Vec<_> = fits(throws, true)?
        .iter()
        .filter_map(|f| f.device)
        .collect();
    let (numbers, numbers_sigma) = Device::of_numbers(&found);
    throws.device.numbers = numbers;
    throws.device.numbers_sigma = numbers_sigma;
    let device = throws.device.clone();
    throws.model = device.tilted(&throws.model);
    let objects = throws.objects.iter_mut().map(|(_, own)| own);
    for own in objects.chain([&mut throws.alone, &mut throws.proof]) {
        for throw in own {
            *throw = device.corrected(throw)?;
        }
    }
    let again = fits(throws, false)?;
    let (bias, covariance) = Device::of_bias(&again.iter().collect::<Vec<_>>())
        .ok_or("the accelerometer is not seen")?;
    throws.device.bias = bias;
    throws.device.bias_covariance = covariance;
    Ok(())
}

fn averaged(raw: &Recording) -> Recording {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let means = |x: &[Vector3<f64>]| x.iter().sum::<Vector3<f64>>() / x.len() as f64;
    Recording {
        name: raw.name.clone(),
        time_s: raw.time_s.chunks_exact(TOGETHER).map(mean).collect(),
        rate_hz: raw.rate_hz / TOGETHER as f64,
        w_NB_B: raw.w_NB_B.chunks_exact(TOGETHER).map(means).collect(),
        f_S_B: raw.f_S_B.chunks_exact(TOGETHER).map(means).collect(),
        wheel_rad_s: raw.wheel_rad_s.chunks_exact(TOGETHER).map(mean).collect(),
    }
}

/// One answer for an object.
pub struct Answer {
    pub name: String,
    /// Principal moments minus the known ones, %.
    pub error: [f64; 3],
    /// Their sigma, %.
    pub sigma: [f64; 3],
    /// The paper's measure: norm of the error of the three moments over their norm, %.
    pub published: f64,
}

impl Answer {
    /// Whether the 95 % interval of each moment holds the known one.
    pub fn held(&self) -> [bool; 3] {
        std::array::from_fn(|k| self.error[k].abs() <= 1.959_964 * self.sigma[k])
    }
}

/// All answers for one object.
pub struct Object {
    pub name: String,
    pub throws: Vec<Answer>,
    pub together: Answer,
    /// Factor on every sigma of a fit: ratio of the observed scatter of throws to the stated one.
    pub scatter: f64,
}

impl Object {
    fn errors(&self) -> impl Iterator<Item = f64> {
        self.throws.iter().flat_map(|t| t.error).map(f64::abs)
    }

    pub fn mean_error(&self) -> f64 {
        self.errors().sum::<f64>() / self.errors().count().max(1) as f64
    }

    /// Mean and worst of the paper's measure, %.
    pub fn published(&self) -> (f64, f64) {
        let each = || self.throws.iter().map(|t| t.published);
        let mean = each().sum::<f64>() / self.throws.len().max(1) as f64;
        (mean, each().fold(0.0, f64::max))
    }

    pub fn worst_error(&self) -> f64 {
        self.errors().fold(0.0, f64::max)
    }

    /// Fraction of intervals that hold the truth.
    pub fn held(&self) -> f64 {
        let all: Vec<bool> = self.throws.iter().flat_map(Answer::held).collect();
        all.iter().filter(|h| **h).count() as f64 / all.len().max(1) as f64
    }
}

/// All results.
pub struct Found {
    pub J: f64,
    pub J_sigma: f64,
    pub proof_error: [f64; 3],
    pub objects: Vec<Object>,
}

/// A body in units of J, with its covariance: six tensor elements, three of the mass centre.
#[derive(Clone)]
struct Body {
    I: Matrix3<f64>,
    p: Vector3<f64>,
    I_cov: Covariance,
    p_cov: Matrix3<f64>,
}

/// Calibrates with box and block, identifies the objects. The known inertia of the objects is used only for the
/// errors.
pub fn identify(throws: &Throws) -> Result<Found, Fault> {
    let boxes = bodies(throws, "device_only", &throws.alone)?;
    let (box_fits, the_box) = (boxes.each, boxes.together);
    let proofs = bodies(throws, "proof_body", &throws.proof)?;
    let (proof_fits, block) = (proofs.each, proofs.together);
    let chain = Chain {
        box_mass: throws.truth.box_mass,
        the_box: &the_box,
    };
    let known = &throws.truth.proof_body;
    let J = chain.spin(&block, known);
    // The observed scatter of the throws gives the uncertainty of their mean, for any declared noise.
    let each: Vec<f64> = proof_fits.iter().map(|b| chain.spin(b, known)).collect();
    let boxes: Vec<f64> = box_fits
        .iter()
        .map(|b| {
            Chain {
                box_mass: chain.box_mass,
                the_box: b,
            }
            .spin(&block, known)
        })
        .collect();
    let J_sigma = (variance_of_mean(&each) + variance_of_mean(&boxes)).sqrt();
    let found = chain.object(&block, known.mass, J);
    let mut objects = Vec::new();
    for (known, own) in &throws.objects {
        let found = bodies(throws, &known.name, own)?;
        let answer = |name: &str, body: &Body| {
            let moments = principal(&chain.object(body, known.mass, J));
            Answer {
                name: name.to_owned(),
                error: percent(&moments, known),
                sigma: chain.sigma(body, known, (J, J_sigma)),
                published: length_of_error(&moments, known),
            }
        };
        objects.push(Object {
            name: known.name.clone(),
            throws: own
                .iter()
                .zip(&found.each)
                .map(|(t, b)| answer(&t.name, b))
                .collect(),
            together: answer("all", &found.together),
            scatter: found.scatter,
        });
    }
    Ok(Found {
        J,
        J_sigma,
        proof_error: percent(&principal(&found), known),
        objects,
    })
}

/// Result of the throws of one body.
struct Bodies {
    each: Vec<Body>,
    together: Body,
    /// Ratio of observed to stated scatter of the throws, at least one.
    scatter: f64,
}

/// Each throw separately, and all together: as segments of one problem if requested, otherwise the covariance-weighted
/// mean.
fn bodies(throws: &Throws, group: &str, own: &[Recording]) -> Result<Bodies, Fault> {
    let declared = declared(group, &throws.device);
    let one = |t: &Recording| fit(&throws.model, &[t], &declared);
    let fits: Vec<Fitted> = own.iter().map(one).collect::<Result<_, _>>()?;
    let n = fits.len() as f64;
    let device = &throws.device;
    let centres: Vec<Vector3<f64>> = fits
        .iter()
        .map(|f| f.lever.p_Sc_B(&device.bias))
        .collect::<Option<_>>()
        .ok_or("the mass centre is not seen")?;
    let centre = centres.iter().sum::<Vector3<f64>>() / n;
    let by_bias = fits
        .iter()
        .map(|f| f.lever.slope())
        .sum::<Option<Matrix3<f64>>>()
        .ok_or("the mass centre is not seen")?
        / n;
    let biased = by_bias * device.bias_covariance * by_bias.transpose();
    // The accelerometer's errors are vibration, so the uncertainty of the mass centre is its observed scatter.
    let spread = centres
        .iter()
        .map(|p| (p - centre) * (p - centre).transpose())
        .sum::<Matrix3<f64>>()
        / (n - 1.0);
    let mean = weighted_mean(&fits).ok_or("a covariance is singular")?;
    let all = match throws.as_segments {
        true => {
            let one = fit(&throws.model, &own.iter().collect::<Vec<_>>(), &declared)?;
            (one.I_over_J, one.covariance)
        }
        false => (mean.I, mean.covariance),
    };
    // If the throws scatter more than stated, each sigma is increased.
    let body = |(f, p): (&Fitted, &Vector3<f64>)| Body {
        I: f.I_over_J,
        p: *p,
        I_cov: f.covariance * mean.birge,
        p_cov: spread + biased,
    };
    let together = Body {
        I: all.0,
        p: centre,
        I_cov: all.1,
        p_cov: spread / n + biased,
    };
    Ok(Bodies {
        each: fits.iter().zip(&centres).map(body).collect(),
        together,
        scatter: mean.birge.sqrt(),
    })
}

/// Covariance-weighted mean of the tensors.
struct Mean {
    I: Matrix3<f64>,
    /// Widened by `birge`.
    covariance: Covariance,
    /// Ratio of observed to stated scatter of the throws (Birge 1932), at least one.
    birge: f64,
}

fn weighted_mean(fits: &[Fitted]) -> Option<Mean> {
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
    let mut I = Matrix3::zeros();
    for (k, (i, j)) in TENSOR.into_iter().enumerate() {
        I[(i, j)] = mean[k];
        I[(j, i)] = mean[k];
    }
    Some(Mean {
        I,
        covariance: covariance * birge,
        birge,
    })
}

fn variance_of_mean(x: &[f64]) -> f64 {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))
}

struct Chain<'a> {
    box_mass: f64,
    the_box: &'a Body,
}

impl Chain<'_> {
    /// J from box and known block by the traces, which do not depend on the orientation of the box:
    /// `J tr(I_c/J - I_b/J) = tr I_o + tr I_parallel`.
    fn spin(&self, both: &Body, block: &Known) -> f64 {
        let apart = self.apart(&self.the_box.p, &both.p, block.mass);
        (block.I_cm + apart).trace() / (both.I - self.the_box.I).trace()
    }

    /// `I_o = J (I_c/J - I_b/J) - I_parallel`, about its mass centre.
    fn object(&self, both: &Body, mass: f64, J: f64) -> Matrix3<f64> {
        (both.I - self.the_box.I) * J - self.apart(&self.the_box.p, &both.p, mass)
    }

    /// Inertia of the two mass centres about the common one: the reduced mass at the distance
    /// `p_bo = p_bc (m_b + m_o) / m_o`.
    fn apart(&self, p_Sb: &Vector3<f64>, p_Sc: &Vector3<f64>, mass: f64) -> Matrix3<f64> {
        let whole = self.box_mass + mass;
        parallel_axis(
            self.box_mass * mass / whole,
            &((p_Sc - p_Sb) * (whole / mass)),
        )
    }

    /// Sigma of the principal moments, %, to first order in all inputs.
    fn sigma(&self, both: &Body, known: &Known, (J, J_sigma): (f64, f64)) -> [f64; 3] {
        let I = self.object(both, known.mass, J);
        let eigen = I.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let moments = principal(&known.I_cm);
        std::array::from_fn(|k| {
            let v: Vector3<f64> = eigen.eigenvectors.column(order[k]).into();
            let along = |M: &Matrix3<f64>| (v.transpose() * M * v)[0];
            let g = SVector::<f64, 6>::from_fn(|e, _| {
                let (i, j) = TENSOR[e];
                J * v[i] * v[j] * if i == j { 1.0 } else { 2.0 }
            });
            let tensors = (g.transpose() * (both.I_cov + self.the_box.I_cov) * g)[0];
            let scale = along(&(both.I - self.the_box.I)) * J_sigma;
            let step = 1.0e-6;
            let slope = Vector3::from_fn(|axis, _| {
                let mut d = Vector3::zeros();
                d[axis] = step;
                let there = self.apart(&self.the_box.p, &(both.p + d), known.mass);
                let back = self.apart(&self.the_box.p, &(both.p - d), known.mass);
                along(&(there - back)) / (2.0 * step)
            });
            let centres = (slope.transpose() * (both.p_cov + self.the_box.p_cov) * slope)[0];
            100.0 * (tensors + scale * scale + centres).sqrt() / moments[k]
        })
    }
}

fn principal(tensor: &Matrix3<f64>) -> [f64; 3] {
    let mut moments: [f64; 3] = tensor.symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    moments
}

/// Blaha et al. 2025: the error of the moments as a vector, relative to the moments as a vector.
fn length_of_error(found: &[f64; 3], known: &Known) -> f64 {
    let known = Vector3::from(principal(&known.I_cm));
    100.0 * (Vector3::from(*found) - known).norm() / known.norm()
}

fn percent(found: &[f64; 3], known: &Known) -> [f64; 3] {
    let known = principal(&known.I_cm);
    std::array::from_fn(|k| 100.0 * (found[k] / known[k] - 1.0))
}
