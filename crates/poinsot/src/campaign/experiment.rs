//! An experiment of a plan: its files as tables, and the study at one point.

use super::address::{Documents, Edit, FileSelector, edit};
use super::faults::PlanText;
use crate::case::{Case, parse_case, read_case};
use crate::digest::sha256;
use crate::error::Error;
use crate::identify::{Question, read_options};
use crate::simulate::SimulateError;
use crate::trials::{Study, mass_names};
use poinsot_formats::{ExperimentFile, PlanFile};
use poinsot_model::{Body, Model, Sensor, parse_model, read_model, read_model_text};
use poinsot_telemetry::{Channel, Table, read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// All changes of a cell or trial, applied by [`Apply`].
pub(crate) type Changes<'a> = dyn Fn(&mut Apply<'_>) -> Result<(), (String, String)> + 'a;

/// Applies one change to the files.
pub(crate) type Apply<'a> =
    dyn FnMut(&str, FileSelector, Edit<'_>) -> Result<(), (String, String)> + 'a;

/// Default seed of a record.
const SEED: u64 = 1;

/// A file as read, and as a table if it is TOML.
#[derive(Debug, Clone)]
struct Source {
    path: PathBuf,
    text: String,
}

pub(crate) struct Experiment {
    pub name: String,
    pub documents: Documents,
    /// SHA-256 of every file.
    pub hashes: Vec<String>,
    /// Paths of the files.
    pub paths: Vec<PathBuf>,
    case: Option<Source>,
    record: Option<Arc<[Table]>>,
    truth: Source,
    nominal: Source,
    bodies: Vec<Body>,
    file: ExperimentFile,
    seed: Option<u64>,
}

/// The files of an experiment at one point, parsed.
pub(crate) struct FilesAt {
    pub case: Option<Case>,
    pub truth: Model,
    pub nominal: Model,
}

/// The case of an experiment, or none for a record; no answer if a fault was recorded.
fn case_of(
    file: &ExperimentFile,
    folder: &Path,
    refuse: &mut impl FnMut(&'static str, &str, &str),
) -> Result<Option<Option<Case>>, Error> {
    match (&file.case, &file.record) {
        (Some(case), None) => {
            let case = read_case(&folder.join(case)).map_err(SimulateError::from)?;
            return Ok(Some(Some(case)));
        }
        (None, Some(_)) if file.truth.is_some() && file.model.is_some() => return Ok(Some(None)),
        (None, Some(_)) => refuse(
            "record",
            "a record needs a model and a truth file",
            "give model and truth",
        ),
        _ => refuse(
            "case",
            "exactly one of case and record is needed",
            "give one of them",
        ),
    }
    Ok(None)
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
        let index = k.to_string();
        let at = |key| ["experiment", &index, key].map(str::to_owned);
        let mut refuse = |key, what: &str, remedy: &str| {
            let at = at(key);
            let at: Vec<&str> = at.iter().map(String::as_str).collect();
            text.refuse("E0541", &at, what, remedy);
        };
        check(file, &mut refuse);
        let Some(case) = case_of(file, folder, &mut refuse)? else {
            return Ok(None);
        };
        let path = |name: &Option<String>| name.as_ref().map(|n| folder.join(n));
        let of_case = case.as_ref().map(|c| c.model.clone());
        let truth = path(&file.truth).or(of_case).unwrap_or_default();
        let nominal = path(&file.model).unwrap_or_else(|| truth.clone());
        let (truth, nominal) = (Source::model(truth)?, Source::model(nominal)?);
        let mut hashes = vec![
            sha256(truth.text.as_bytes()),
            sha256(nominal.text.as_bytes()),
        ];
        let mut paths = vec![truth.path.clone(), nominal.path.clone()];
        let record = match &file.record {
            Some(record) => {
                let record = folder.join(record);
                let tables = read_record(&record, &nominal.read()?, file.every)?;
                paths.push(record);
                let sources = tables.iter().flat_map(|t| &t.sources);
                hashes.extend(sources.map(|s| s.sha256.clone()));
                check_biases(file, &nominal.read()?, &mut refuse);
                Some(tables.into())
            }
            None => None,
        };
        let case = match case {
            Some(case) => {
                hashes.push(sha256(case.text().as_bytes()));
                hashes.extend(case.inputs_sha256()?);
                paths.push(case.path().to_owned());
                paths.extend(case.inputs());
                Some(Source {
                    path: case.path().to_owned(),
                    text: case.text().to_owned(),
                })
            }
            None => None,
        };
        let named = file.case.as_ref().or(file.record.as_ref());
        let stem = named
            .map(Path::new)
            .and_then(Path::file_stem)
            .unwrap_or_default();
        Ok(Some(Self {
            name: match file.name.as_str() {
                "" => stem.to_string_lossy().into_owned(),
                name => name.to_owned(),
            },
            documents: Documents {
                case: case.as_ref().and_then(Source::table),
                truth: truth.table(),
                nominal: nominal.table(),
            },
            hashes,
            paths,
            case,
            record,
            bodies: nominal.read()?.bodies,
            truth,
            nominal,
            file: file.clone(),
            seed: plan.seed,
        }))
    }

    /// Applies changes to the files, then parses and checks them.
    ///
    /// # Errors
    /// A changed file is invalid.
    pub fn files(&self, changes: &Changes<'_>) -> Result<FilesAt, Error> {
        let mut documents = self.documents.clone();
        let mut changed = false;
        changes(&mut |address, of, change| {
            changed = true;
            edit(&mut documents, address, of, change)
        })
        .map_err(|(what, remedy)| {
            let text = PlanText::new(Path::new(&self.name), String::new());
            let fault = text.fault("E0542", &[], what, &remedy);
            Error::File(crate::case::CaseError {
                faults: vec![fault],
                environment: false,
            })
        })?;
        if !changed {
            return Ok(FilesAt {
                case: self.case.as_ref().map(Source::case).transpose()?,
                truth: self.truth.read()?,
                nominal: self.nominal.read()?,
            });
        }
        let case = match (&self.case, &documents.case) {
            (Some(source), Some(table)) => Some(source.with(table).case()?),
            _ => None,
        };
        let model = |source: &Source, table: &Option<toml::Table>| match table {
            Some(table) => source.with(table).read(),
            None => source.read(),
        };
        Ok(FilesAt {
            case,
            truth: model(&self.truth, &documents.truth)?,
            nominal: model(&self.nominal, &documents.nominal)?,
        })
    }

    /// Requested mass properties of all bodies.
    pub fn asked(&self) -> Vec<String> {
        let of = |b: &Body| mass_names(&b.name);
        let asked = self.bodies.iter().filter(|b| b.estimate.any());
        asked.flat_map(of).collect()
    }

    /// Mass properties of the first body.
    pub fn first(&self) -> Vec<String> {
        let first = self.bodies.first();
        first.map_or_else(Vec::new, |b| mass_names(&b.name))
    }

    /// The repeatable experiment.
    ///
    /// # Errors
    /// The case does not fit the model, or cannot be simulated.
    pub fn study(&self, files: FilesAt) -> Result<Study, Error> {
        let FilesAt {
            case,
            truth,
            nominal,
        } = files;
        let mut study = match case {
            Some(mut case) => {
                case.rate_hz /= self.file.every.unwrap_or(1) as f64;
                Study::of_case(&case, &truth, nominal)?
            }
            None => {
                let tables = self.record.as_deref().unwrap_or(&[]).to_vec();
                let biases = biases(&self.file, &nominal);
                let mut study = Study::of_tables(tables, &truth, nominal);
                study.biases = biases;
                study.seed = SEED;
                study
            }
        };
        // Noise and rounding are the true ones; other declared errors are those of the nominal model.
        for sensor in &mut study.sensors {
            let same = |t: &&Sensor| t.name == sensor.name && t.kind == sensor.kind;
            if let Some(t) = truth.sensors.iter().find(same) {
                sensor.noise_covariance = t.noise_covariance;
                sensor.quantisation = t.quantisation;
                sensor.correlation_s = t.correlation_s;
            }
        }
        study.question = Question::default();
        study.draw_phase = self.file.draw_phase.unwrap_or(true);
        study.step_spread = self.file.step_spread.unwrap_or(0.0);
        study.seed = self.seed.unwrap_or(study.seed);
        Ok(study)
    }
}

impl Source {
    fn model(path: PathBuf) -> Result<Self, Error> {
        let text = read_model_text(&path)?;
        Ok(Self { path, text })
    }

    fn is_urdf(&self) -> bool {
        let extension = self.path.extension();
        extension.is_some_and(|e| e.eq_ignore_ascii_case("urdf"))
    }

    fn table(&self) -> Option<toml::Table> {
        match self.is_urdf() {
            true => None,
            false => self.text.parse().ok(),
        }
    }

    fn with(&self, table: &toml::Table) -> Self {
        Self {
            path: self.path.clone(),
            // A changed table is written as text again.
            text: toml::to_string(table).unwrap_or_default(),
        }
    }

    fn read(&self) -> Result<Model, Error> {
        Ok(match self.is_urdf() {
            true => read_model(&self.path)?,
            false => parse_model(&self.text, &self.path.display().to_string())?,
        })
    }

    fn case(&self) -> Result<Case, Error> {
        Ok(parse_case(&self.path, self.text.clone()).map_err(SimulateError::from)?)
    }
}

fn check(file: &ExperimentFile, refuse: &mut impl FnMut(&'static str, &str, &str)) {
    if file.every == Some(0) {
        refuse(
            "every",
            "a whole number from 1 is needed",
            "1 takes all samples",
        );
    }
    if file.step_spread.is_some_and(|s| !(0.0..1.0).contains(&s)) {
        refuse(
            "step_spread",
            "must be from 0 to below 1",
            "give a share of the step",
        );
    }
    if file.case.is_some() && !file.bias.is_empty() {
        let remedy = "give [[output.sensor]] bias_... in the case";
        refuse(
            "bias",
            "the case already declares the biases of its sensors",
            remedy,
        );
    }
}

fn check_biases(
    file: &ExperimentFile,
    model: &Model,
    refuse: &mut impl FnMut(&'static str, &str, &str),
) {
    for (name, bias) in &file.bias {
        let Some(sensor) = model.sensors.iter().find(|s| s.name == *name) else {
            refuse(
                "bias",
                &format!("the model has no sensor \"{name}\""),
                "use the name of a sensor",
            );
            continue;
        };
        let wanted = if sensor.kind.is_scalar() {
            sensor.of.len()
        } else {
            3
        };
        if bias.len() != wanted || !bias.iter().all(|b| b.is_finite()) {
            let what = format!("{name} needs {wanted} finite numbers");
            refuse(
                "bias",
                &what,
                "give one for each axis, joint, wheel or thruster",
            );
        }
    }
}

fn biases(file: &ExperimentFile, model: &Model) -> Vec<Option<Vec<f64>>> {
    let of = |s: &Sensor| file.bias.get(&s.name).cloned();
    model.sensors.iter().map(of).collect()
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
