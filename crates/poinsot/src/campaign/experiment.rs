//! An experiment of a plan: its files as tables, and the study at one point.

use super::address::{Document, Documents, Refusal};
use super::faults::PlanText;
use crate::case::{Case, parse_case, read_case};
use crate::error::Error;
use crate::identify::read_options;
use crate::mass_numbers::names as mass_names;
use crate::trials::Study;
use poinsot_files::Place;
use poinsot_formats::{ExperimentFile, PlanFile, sha256};
use poinsot_model::{Model, Sensor, parse_model, read_model, read_model_text};
use poinsot_telemetry::{Channel, Table, read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(crate) struct Experiment {
    pub name: String,
    pub documents: Documents,
    /// SHA-256 of every file.
    pub hashes: Vec<String>,
    /// Paths of the files.
    pub paths: Vec<PathBuf>,
    record: Option<Arc<[Table]>>,
    /// Requested mass properties of all bodies.
    pub asked: Vec<String>,
    file: ExperimentFile,
    seed: Option<u64>,
}

/// The files of an experiment at one point, parsed.
pub(crate) struct FilesAt {
    pub case: Option<Case>,
    pub truth: Model,
    pub nominal: Model,
}

impl Experiment {
    /// Reads the files of an experiment; `None` if a fault was recorded.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn read(
        file: &ExperimentFile,
        folder: &Path,
        plan: &PlanFile,
        k: usize,
        text: &mut PlanText,
    ) -> Result<Option<Self>, Error> {
        let mut refuse = |key, what: &str, remedy: &str| {
            text.refuse(&format!("experiment[{k}].{key}"), what, remedy);
        };
        check(file, &mut refuse);
        let case = match (&file.case, &file.record) {
            (Some(case), None) => Some(read_case(&folder.join(case))?),
            (None, Some(_)) if file.truth.is_some() && file.model.is_some() => None,
            (None, Some(_)) => {
                let what = "a record needs a model and a truth file";
                refuse("record", what, "give model and truth");
                return Ok(None);
            }
            _ => {
                let what = "exactly one of case and record is needed";
                refuse("case", what, "give one of them");
                return Ok(None);
            }
        };
        let path = |name: &Option<PathBuf>| name.as_ref().map(|n| folder.join(n));
        let of_case = case.as_ref().map(|c| c.model.clone());
        let truth = path(&file.truth).or(of_case).unwrap_or_default();
        let nominal = path(&file.model).unwrap_or_else(|| truth.clone());
        let [truth, nominal] = [model_file(truth)?, model_file(nominal)?];
        let model = read_document(&nominal, false)?;
        let mut hashes = [&truth, &nominal]
            .map(|s| sha256(s.text.as_bytes()))
            .to_vec();
        let mut paths = vec![truth.path.clone(), nominal.path.clone()];
        let mut record = None;
        if let Some(path) = path(&file.record) {
            let tables = read_record(&path, &model, file.every)?;
            let sources = tables.iter().flat_map(|t| &t.sources);
            hashes.extend(sources.map(|s| s.sha256.clone()));
            paths.push(path);
            check_biases(file, &model, &mut refuse);
            record = Some(tables.into());
        }
        if let Some(case) = &case {
            hashes.push(sha256(case.text().as_bytes()));
            hashes.extend(case.inputs_sha256()?);
            paths.push(case.path().to_owned());
            paths.extend(case.inputs());
        }
        let case = case.map(|c| Document::new(c.path().to_owned(), c.text().to_owned()));
        let named = file.case.as_ref().or(file.record.as_ref());
        let asked = model.bodies.iter().filter(|b| b.estimate.any());
        Ok(Some(Self {
            name: name_or_stem(&file.name, named.map_or(Path::new(""), PathBuf::as_path)),
            documents: Documents {
                case,
                truth,
                nominal,
                changed: false,
            },
            hashes,
            paths,
            record,
            asked: asked.flat_map(|b| mass_names(&b.name)).collect(),
            file: file.clone(),
            seed: plan.seed,
        }))
    }

    /// Applies changes to the files, then parses and checks them.
    ///
    /// # Errors
    /// A changed file is invalid.
    pub fn files(
        &self,
        change: impl FnOnce(&mut Documents) -> Result<(), Refusal>,
    ) -> Result<FilesAt, Error> {
        let mut documents = self.documents.clone();
        change(&mut documents).map_err(|(what, remedy)| {
            Error::one("E0542", Place::file(&self.name), what, &remedy)
        })?;
        let changed = documents.changed;
        let case = documents.case.as_ref();
        let case = case.map(|c| parse_case(&c.path, text(c, changed)));
        Ok(FilesAt {
            case: case.transpose()?,
            truth: read_document(&documents.truth, changed)?,
            nominal: read_document(&documents.nominal, changed)?,
        })
    }

    /// The repeatable experiment.
    ///
    /// # Errors
    /// The case does not fit the model, or cannot be simulated.
    pub fn study(&self, files: FilesAt) -> Result<Study, Error> {
        let (truth, nominal) = (files.truth, files.nominal);
        let mut study = match (files.case, &self.record) {
            (Some(mut case), _) => {
                case.rate_hz /= self.file.every.unwrap_or(1) as f64;
                Study::of_case(&case, &truth, nominal)?
            }
            (None, record) => {
                let tables = record.as_deref().unwrap_or_default().to_vec();
                let bias = |s: &Sensor| self.file.bias.get(&s.name).cloned();
                let biases = nominal.sensors.iter().map(bias).collect();
                Study {
                    biases,
                    ..Study::of_tables(tables, &truth, nominal)
                }
            }
        };
        // Noise and rounding are the true ones; other declared errors are those of the nominal model.
        for sensor in &mut study.sensors {
            let same = |t: &&Sensor| t.name == sensor.name && t.kind == sensor.kind;
            if let Some(t) = truth.sensors.iter().find(same) {
                sensor.noise_covariance = t.noise_covariance;
                sensor.quantisation = t.quantisation;
                sensor.slow.clone_from(&t.slow);
            }
        }
        study.draw_phase = self.file.draw_phase.unwrap_or(true);
        study.step_spread = self.file.step_spread.unwrap_or(0.0);
        study.seed = self.seed.unwrap_or(study.seed);
        Ok(study)
    }
}

/// The name that is given, or that of the file.
pub(super) fn name_or_stem(name: &str, path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    match name {
        "" => stem.to_string_lossy().into_owned(),
        name => name.to_owned(),
    }
}

fn model_file(path: PathBuf) -> Result<Document, Error> {
    let text = read_model_text(&path)?;
    Ok(Document::new(path, text))
}

/// The text of a changed table, or the text as read.
fn text(of: &Document, changed: bool) -> String {
    match of.table.as_ref().filter(|_| changed) {
        Some(table) => toml::to_string(table).unwrap_or_default(),
        None => of.text.clone(),
    }
}

fn read_document(of: &Document, changed: bool) -> Result<Model, Error> {
    match of.path.extension() {
        Some(urdf) if urdf.eq_ignore_ascii_case("urdf") => read_model(&of.path),
        _ => parse_model(&text(of, changed), &of.path.display().to_string()),
    }
}

fn check(file: &ExperimentFile, refuse: &mut impl FnMut(&'static str, &str, &str)) {
    if file.every == Some(0) {
        let what = "a whole number from 1 is needed";
        refuse("every", what, "1 takes all samples");
    }
    if file.step_spread.is_some_and(|s| !(0.0..1.0).contains(&s)) {
        let what = "must be from 0 to below 1";
        refuse("step_spread", what, "give a share of the step");
    }
    if file.case.is_some() && !file.bias.is_empty() {
        let what = "the case already declares the biases of its sensors";
        let remedy = "give [[output.sensor]] bias_... in the case";
        refuse("bias", what, remedy);
    }
}

fn check_biases(
    file: &ExperimentFile,
    model: &Model,
    refuse: &mut impl FnMut(&'static str, &str, &str),
) {
    for (name, bias) in &file.bias {
        let Some(sensor) = model.sensors.iter().find(|s| s.name == *name) else {
            let what = format!("the model has no sensor \"{name}\"");
            refuse("bias", &what, "use the name of a sensor");
            continue;
        };
        let scalar = sensor.kind.is_scalar();
        let wanted = if scalar { sensor.of.len() } else { 3 };
        if bias.len() != wanted || !bias.iter().all(|b| b.is_finite()) {
            let what = format!("{name} needs {wanted} finite numbers");
            let remedy = "give one for each axis, joint, wheel or thruster";
            refuse("bias", &what, remedy);
        }
    }
}

/// Noise-free telemetry at every n-th sample of each channel.
fn read_record(path: &Path, model: &Model, every: Option<u64>) -> Result<Vec<Table>, Error> {
    let options = read_options(model, &model.telemetry, false, false);
    let mut table = read(&[path.to_owned()], &options)?;
    let every = usize::try_from(every.unwrap_or(1).max(1)).unwrap_or(usize::MAX);
    let thin = |c: &Channel| Channel {
        time_s: Arc::from_iter(c.time_s.iter().copied().step_by(every)),
        values: c.values.iter().copied().step_by(every).collect(),
        ..c.clone()
    };
    table.channels = table.channels.iter().map(thin).collect();
    Ok(vec![table])
}
