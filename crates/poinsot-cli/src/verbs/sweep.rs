//! `poinsot sweep`

use super::Outcome;
use super::campaign::shown;
use crate::arguments::Sweep;
use poinsot::campaign::{CampaignRequest, campaign, campaign_in_memory, made_plan};
use poinsot::check_outputs;
use poinsot::sweep::{SweepRequest, sweep_plan};
use std::path::Path;

pub fn run(arguments: &Sweep) -> Outcome {
    poinsot::start_threads()?;
    let file = sweep_plan(&SweepRequest {
        case: arguments.case.clone(),
        model: arguments.model.clone(),
        vary: arguments.vary.clone(),
        methods: arguments.method.clone(),
        settings: arguments.set.clone(),
        trials: arguments.trials,
        seed: arguments.seed,
    })?;
    let plan = made_plan(file, Path::new(""))?;
    let ran = match &arguments.out {
        Some(out) => {
            let results = ["campaign.json", "campaign.html"].map(|n| out.join(n));
            check_outputs("--out", &results, &[&arguments.case])?;
            let request = CampaignRequest {
                out: out.clone(),
                resume: arguments.resume,
                ..CampaignRequest::default()
            };
            campaign(&plan, &request)?
        }
        None => campaign_in_memory(&plan)?,
    };
    shown(arguments.print.json, arguments.print.quiet, &ran)
}
