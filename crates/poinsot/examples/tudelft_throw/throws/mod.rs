//! From the recordings to the inertia of the objects: calibrate on two groups, then identify two more.
//!
//! Symbols: `b` the measuring box, `o` an object, `c` both bolted together; `J` the wheel's spin inertia.

pub mod inertia;
mod low_pass;
pub mod mass_centre;
pub mod recording;
pub mod truth;

use inertia::inertia_over_J;
use mass_centre::p_SBcm_B;
use nalgebra::{Matrix3, Vector3};
use poinsot_model::{Model, parse_model};
use poinsot_spatial::parallel_axis;
use recording::{Recording, read_logs, read_recording};
use std::path::Path;
use truth::{Known, read_truth};

/// Any fault ends the example.
pub type Fault = Box<dyn std::error::Error>;

/// The model file of the box.
pub const MODEL: &str = include_str!("../../../../../data/tudelft_throw/model.toml");

/// Settings of the evaluation; the example's README.md gives the reasons.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Cut-off of the low-pass filter, Hz; infinite for none.
    pub cut_off_hz: f64,
    /// Length of the windows within which momentum is constant, s.
    pub window_s: f64,
    /// Samples up to this time after the start of the wheel are dropped, s.
    pub start_s: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            cut_off_hz: 40.0,
            window_s: 0.05,
            start_s: 0.074,
        }
    }
}

/// Calibration of box and wheel.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// Names and principal moments over J of the box, throw by throw.
    pub box_throws: Vec<(String, [f64; 3])>,
    /// Central inertia of the box over J, all throws, body axes.
    pub I_b_over_J: Matrix3<f64>,
    /// Mass centre of the box from the accelerometer, body axes, m.
    pub p_Sb_B: Vector3<f64>,
    /// Names and J of the throws of the proof body, kg m2.
    pub proof_throws: Vec<(String, f64)>,
    /// J from all throws of the proof body, kg m2.
    pub J: f64,
    /// Principal moments of the proof body with that J, minus the known ones, %: a check of shape.
    pub proof_error: [f64; 3],
}

/// One answer for an object.
#[derive(Debug, Clone)]
pub struct Answer {
    /// Log, or `all`.
    pub name: String,
    /// Principal moments about its mass centre, ascending, kg m2.
    pub moments: [f64; 3],
    /// Their difference from the known ones, %.
    pub error: [f64; 3],
    /// Mass centre of box and object from the accelerometer, body axes, m.
    pub p_Sc_B: Vector3<f64>,
}

/// All answers for one object.
#[derive(Debug, Clone)]
pub struct Object {
    pub name: String,
    /// Known principal moments, ascending, kg m2.
    pub known: [f64; 3],
    pub throws: Vec<Answer>,
    /// Throws that do not determine it, with reasons.
    pub undetermined: Vec<(String, String)>,
    /// All other throws as segments of one problem.
    pub together: Answer,
}

impl Object {
    /// Mean of |error| over throws and moments, %.
    pub fn mean_error(&self) -> f64 {
        let sum: f64 = self.errors().sum();
        sum / self.errors().count().max(1) as f64
    }

    /// Largest |error| over throws and moments, %.
    pub fn worst_error(&self) -> f64 {
        self.errors().fold(0.0, f64::max)
    }

    fn errors(&self) -> impl Iterator<Item = f64> {
        self.throws.iter().flat_map(|t| t.error).map(f64::abs)
    }
}

/// All results.
#[derive(Debug, Clone)]
pub struct Findings {
    pub calibration: Calibration,
    pub objects: Vec<Object>,
}

/// Calibrates on `device_only` and `proof_body`, identifies `config_empty` and `config_a`.
///
/// The known inertia of the objects is used only for the errors.
pub fn evaluate(folder: &Path, settings: &Settings) -> Result<Findings, Fault> {
    let model = parse_model(MODEL, "model.toml")?;
    let truth = read_truth(folder)?;
    let logs = read_logs(folder)?;
    let group = |name: &str| -> Result<Vec<Recording>, Fault> {
        logs.iter()
            .filter(|l| l.group == name)
            .map(|l| read_recording(folder, &model, l, settings))
            .collect()
    };
    let bench = Bench {
        model: &model,
        settings,
        box_mass: truth.box_mass,
    };
    let calibration = bench.calibrate(
        &group("device_only")?,
        &group("proof_body")?,
        &truth.proof_body,
    )?;
    let mut objects = Vec::new();
    for known in &truth.objects {
        objects.push(bench.object(&calibration, &group(&known.name)?, known)?);
    }
    Ok(Findings {
        calibration,
        objects,
    })
}

/// Common data of all identifications.
struct Bench<'a> {
    model: &'a Model,
    settings: &'a Settings,
    box_mass: f64,
}

/// Result of one body's throws, without scale.
struct Unscaled {
    I_over_J: Matrix3<f64>,
    p_S_B: Vector3<f64>,
}

impl Bench<'_> {
    fn unscaled(&self, throws: &[&Recording]) -> Result<Unscaled, Fault> {
        Ok(Unscaled {
            I_over_J: inertia_over_J(self.model, throws, self.settings)?,
            p_S_B: p_SBcm_B(throws).ok_or("the accelerometer does not show the mass centre")?,
        })
    }

    fn calibrate(
        &self,
        boxes: &[Recording],
        proofs: &[Recording],
        block: &Known,
    ) -> Result<Calibration, Fault> {
        let the_box = self.unscaled(&boxes.iter().collect::<Vec<_>>())?;
        let mut box_throws = Vec::new();
        for throw in boxes {
            let one = inertia_over_J(self.model, &[throw], self.settings)?;
            box_throws.push((throw.name.clone(), principal(&one)));
        }
        let mut proof_throws = Vec::new();
        for throw in proofs {
            let both = self.unscaled(&[throw])?;
            proof_throws.push((
                throw.name.clone(),
                self.spin_inertia(&the_box, &both, block),
            ));
        }
        let both = self.unscaled(&proofs.iter().collect::<Vec<_>>())?;
        let J = self.spin_inertia(&the_box, &both, block);
        let found = principal(&self.remainder(&the_box, &both, block.mass, J));
        Ok(Calibration {
            box_throws,
            I_b_over_J: the_box.I_over_J,
            p_Sb_B: the_box.p_S_B,
            proof_throws,
            J,
            proof_error: percent(&found, &principal(&block.I_cm)),
        })
    }

    fn object(
        &self,
        calibration: &Calibration,
        throws: &[Recording],
        known: &Known,
    ) -> Result<Object, Fault> {
        let answer = |name: &str, throws: &[&Recording]| -> Result<Answer, Fault> {
            let the_box = Unscaled {
                I_over_J: calibration.I_b_over_J,
                p_S_B: calibration.p_Sb_B,
            };
            let both = self.unscaled(throws)?;
            let moments = principal(&self.remainder(&the_box, &both, known.mass, calibration.J));
            Ok(Answer {
                name: name.to_owned(),
                moments,
                error: percent(&moments, &principal(&known.I_cm)),
                p_Sc_B: both.p_S_B,
            })
        };
        let (mut found, mut undetermined, mut used) = (Vec::new(), Vec::new(), Vec::new());
        for throw in throws {
            match answer(&throw.name, &[throw]) {
                Ok(one) => {
                    found.push(one);
                    used.push(throw);
                }
                Err(why) => undetermined.push((throw.name.clone(), why.to_string())),
            }
        }
        Ok(Object {
            name: known.name.clone(),
            known: principal(&known.I_cm),
            throws: found,
            undetermined,
            together: answer("all", &used)?,
        })
    }

    /// J from box and known block by the traces, which do not depend on the orientation of the box:
    /// `J tr(I_c/J - I_b/J) = tr I_o + tr I_parallel`.
    fn spin_inertia(&self, the_box: &Unscaled, both: &Unscaled, block: &Known) -> f64 {
        let apart = self.apart(the_box, both, block.mass);
        (block.I_cm + apart).trace() / (both.I_over_J - the_box.I_over_J).trace()
    }

    /// Object = both minus box: `I_o = J (I_c/J - I_b/J) - I_parallel`, about its mass centre.
    fn remainder(&self, the_box: &Unscaled, both: &Unscaled, mass: f64, J: f64) -> Matrix3<f64> {
        (both.I_over_J - the_box.I_over_J) * J - self.apart(the_box, both, mass)
    }

    /// Inertia of the two mass centres about the common one: the reduced mass at the distance
    /// `p_bo = p_bc (m_b + m_o) / m_o`.
    fn apart(&self, the_box: &Unscaled, both: &Unscaled, mass: f64) -> Matrix3<f64> {
        let whole = self.box_mass + mass;
        let p_bo_B = (both.p_S_B - the_box.p_S_B) * (whole / mass);
        parallel_axis(self.box_mass * mass / whole, &p_bo_B)
    }
}

/// Principal moments, ascending.
fn principal(tensor: &Matrix3<f64>) -> [f64; 3] {
    let mut moments: [f64; 3] = tensor.symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    moments
}

fn percent(found: &[f64; 3], known: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| 100.0 * (found[k] / known[k] - 1.0))
}
