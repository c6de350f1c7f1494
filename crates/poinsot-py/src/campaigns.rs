//! `campaign` and `sweep`: plans, their shards, and the campaign around an engine of Python.

use crate::fault::Fault;
use crate::printed::{Printed, json};
use crate::run::run;
use poinsot::campaign::{
    CampaignRequest, CampaignRun, Plan, campaign, campaign_in_memory, made_plan, read_plan,
    run_shards,
};
use poinsot::sweep::{SweepRequest, sweep_plan};
use poinsot::{Error, check_outputs};
use poinsot_figures::Document;
use poinsot_report::campaign_document;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A checked plan.
#[pyclass(name = "Plan", frozen, module = "poinsot._core")]
pub struct CorePlan {
    plan: Arc<Plan>,
    /// What the result must not overwrite.
    input: PathBuf,
}

#[pymethods]
impl CorePlan {
    #[staticmethod]
    #[pyo3(signature = (path, trials=None))]
    fn read(py: Python<'_>, path: PathBuf, trials: Option<u64>) -> PyResult<Self> {
        run(py, None, move || {
            let mut plan = read_plan(&path)?;
            if let Some(trials) = trials {
                plan.set_trials(trials);
            }
            Ok(Self {
                plan: Arc::new(plan),
                input: path,
            })
        })
    }

    #[staticmethod]
    #[pyo3(signature = (case, vary, methods, settings, trials, model=None, seed=None))]
    #[allow(clippy::too_many_arguments)]
    fn of_sweep(
        py: Python<'_>,
        case: PathBuf,
        vary: Vec<String>,
        methods: Vec<String>,
        settings: Vec<String>,
        trials: u64,
        model: Option<PathBuf>,
        seed: Option<u64>,
    ) -> PyResult<Self> {
        let request = SweepRequest {
            case: case.clone(),
            model,
            vary,
            methods,
            settings,
            trials,
            seed,
        };
        run(py, None, move || {
            let plan = made_plan(sweep_plan(&request)?, Path::new(""))?;
            Ok(Self {
                plan: Arc::new(plan),
                input: case,
            })
        })
    }

    /// SHA-256 of everything that a trial depends on.
    #[getter]
    fn digest(&self) -> &str {
        &self.plan.digest
    }

    /// Trials of every cell.
    #[getter]
    fn trials(&self) -> u64 {
        self.plan.trials
    }

    /// The plan as TOML.
    fn text(&self) -> PyResult<String> {
        let text = toml::to_string(&self.plan.file);
        let what = |e: toml::ser::Error| Error::internal(e.to_string());
        Ok(text.map_err(|e| Fault::from(what(e)))?)
    }

    /// Folder from which the plan names its files, and these files.
    fn files(&self) -> (PathBuf, Vec<PathBuf>) {
        let files = self.plan.files().map(Path::to_owned).collect();
        (self.plan.folder.clone(), files)
    }

    /// Runs shards into a folder, on all cores or on this many threads.
    #[pyo3(signature = (out, shards, threads=None, progress=None))]
    fn run(
        &self,
        py: Python<'_>,
        out: PathBuf,
        shards: Vec<u64>,
        threads: Option<usize>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let plan = Arc::clone(&self.plan);
        run(py, progress.as_ref(), move || {
            let work = || run_shards(&plan, &out, &shards, &|_| {});
            let Some(threads) = threads else {
                return Ok(work()?);
            };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.map_err(Error::threads)?;
            Ok(pool.install(work)?)
        })
    }

    /// The campaign into a folder, or in memory; `engine(shards)` runs shards into the folder.
    #[pyo3(signature = (out=None, resume=false, until=None, engine=None, progress=None))]
    fn campaign(
        &self,
        py: Python<'_>,
        out: Option<PathBuf>,
        resume: bool,
        until: Option<f64>,
        engine: Option<Py<PyAny>>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Printed> {
        let (plan, input) = (Arc::clone(&self.plan), self.input.clone());
        run(py, progress.as_ref(), move || {
            let Some(out) = out else {
                return printed(campaign_in_memory(&plan)?);
            };
            let results = ["campaign.json", "campaign.html"].map(|n| out.join(n));
            check_outputs("out", &results, &[&input])?;
            let called = |engine: &Py<PyAny>, shards: &[u64]| {
                let done = Python::attach(|py| engine.call1(py, (shards.to_vec(),)).map(|_| ()));
                done.map_err(|e| Error::internal(e.to_string()))
            };
            let engine = engine.as_ref();
            let engine = engine.map(|e| move |shards: &[u64]| called(e, shards));
            let request = CampaignRequest {
                out,
                resume,
                until,
                engine: engine.as_ref().map(|e| e as _),
                ..CampaignRequest::default()
            };
            printed(campaign(&plan, &request)?)
        })
    }
}

fn printed(ran: CampaignRun) -> Result<Printed, Fault> {
    let code = poinsot_cli::exit_of(ran.passes());
    let Some(result) = ran.result else {
        return Err(Error::internal("a campaign of all shards gave no result").into());
    };
    let documents = campaign_document(&result);
    let all: Vec<String> = documents.iter().map(Document::to_string).collect();
    Ok((json(&result)?, all.join("\n"), code))
}
