//! The verbs that fly a case many times: `design`, `campaign`, `sweep`; and the studies of the papers.

use crate::fault::Fault;
use crate::run::run;
use crate::verbs::{Printed, json, text};
use poinsot::campaign::{
    CampaignRequest, CampaignRun, Plan, campaign as run_campaign, campaign_document,
    campaign_in_memory, made_plan, read_plan,
};
use poinsot::case::read_case;
use poinsot::check_outputs;
use poinsot::simulate::SimulateError;
use poinsot::study::{document, find, findings_file, run as run_study};
use poinsot::sweep::{SweepRequest, sweep_plan};
use poinsot_design::{DesignRequest, design_document, design_file, write_design};
use poinsot_formats::{FINDINGS, FindingsFile};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};

/// `poinsot design`.
#[pyfunction]
#[pyo3(signature = (case, out=None, minutes=None, verify=0, progress=None))]
pub fn design(
    py: Python<'_>,
    case: PathBuf,
    out: Option<PathBuf>,
    minutes: Option<f64>,
    verify: u64,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Printed> {
    run(py, progress.as_ref(), move || {
        let designed = poinsot_design::design(&DesignRequest {
            case: case.clone(),
            minutes,
            verify,
            front: None,
        })?;
        if let Some(folder) = &out {
            let model = read_case(&case).map_err(SimulateError::from)?.model;
            write_design(folder, &designed, &model)?;
        }
        Ok((
            json(&design_file(&designed))?,
            text(&design_document(&designed)),
            poinsot_cli::exit_of(designed.passes()),
        ))
    })
}

/// `poinsot campaign`.
#[pyfunction]
#[pyo3(signature = (plan, out=None, trials=None, resume=false, until=None, progress=None))]
pub fn campaign(
    py: Python<'_>,
    plan: PathBuf,
    out: Option<PathBuf>,
    trials: Option<u64>,
    resume: bool,
    until: Option<f64>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Printed> {
    run(py, progress.as_ref(), move || {
        let mut read = read_plan(&plan)?;
        if let Some(trials) = trials {
            read.set_trials(trials)?;
        }
        flown(&read, &plan, out, (resume, until))
    })
}

/// `poinsot sweep`.
#[pyfunction]
#[pyo3(signature = (case, vary, methods, settings, trials, model=None, seed=None, out=None, resume=false, progress=None))]
#[allow(clippy::too_many_arguments)]
pub fn sweep(
    py: Python<'_>,
    case: PathBuf,
    vary: Vec<String>,
    methods: Vec<String>,
    settings: Vec<String>,
    trials: u64,
    model: Option<PathBuf>,
    seed: Option<u64>,
    out: Option<PathBuf>,
    resume: bool,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Printed> {
    let words = |path: &Path| path.to_string_lossy().into_owned();
    let request = SweepRequest {
        case: words(&case),
        model: model.as_deref().map(words),
        vary,
        methods,
        settings,
        trials,
        seed,
    };
    run(py, progress.as_ref(), move || {
        let plan = made_plan(sweep_plan(&request)?, Path::new(""))?;
        flown(&plan, &case, out, (resume, None))
    })
}

/// `poinsot study` of one study of a paper, or of all.
#[pyfunction]
#[pyo3(signature = (paper, name, examples, progress=None))]
pub fn study(
    py: Python<'_>,
    paper: String,
    name: String,
    examples: PathBuf,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Printed> {
    run(py, progress.as_ref(), move || {
        let (mut findings, mut words) = (Vec::new(), Vec::new());
        for (paper, study) in find(Some(&paper), Some(&name))? {
            let found = run_study(study, &examples)?;
            words.push(text(&document(paper, study, &found)));
            findings.push(findings_file(paper, study, &found));
        }
        let file = FindingsFile {
            schema: FINDINGS.to_owned(),
            findings,
        };
        let values = json(&file)?;
        Ok((values, words.join("\n"), 0))
    })
}

fn flown(
    plan: &Plan,
    input: &Path,
    out: Option<PathBuf>,
    (resume, until): (bool, Option<f64>),
) -> Result<Printed, Fault> {
    let ran = match out {
        None => campaign_in_memory(plan)?,
        Some(out) => {
            let results = ["campaign.json", "campaign.html"].map(|n| out.join(n));
            check_outputs("out", &results, &[input])?;
            let request = CampaignRequest {
                out,
                share: None,
                resume,
                until,
                follow: None,
            };
            run_campaign(plan, &request)?
        }
    };
    let code = poinsot_cli::exit_of(ran.passes());
    let CampaignRun {
        result: Some(result),
        folded: Some(folded),
        ..
    } = ran
    else {
        let what = "a campaign of all shards gave no result".to_owned();
        return Err(poinsot::Error::Internal { what }.into());
    };
    let documents = campaign_document(plan, &folded, &result);
    let all: Vec<String> = documents.iter().map(text).collect();
    let values = json(&result)?;
    Ok((values, all.join("\n"), code))
}
