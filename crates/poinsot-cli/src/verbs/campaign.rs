//! `poinsot campaign`

use super::{Outcome, exit_of, note, noted, print, print_document, print_json, print_result};
use crate::arguments::Campaign;
use poinsot::campaign::{
    CampaignRequest, CampaignRun, Plan, campaign, campaign_cost, merge_campaign, read_plan,
    slurm_scripts,
};
use poinsot::{Error, ErrorKind, check_outputs, thread_count, write_files};
use poinsot_files::{Fault, Place, counted, memory_limit, time_limit};
use poinsot_formats::{CampaignFile, WrittenFile};
use poinsot_report::{campaign_document, cost_document};
use std::path::Path;
use std::process::Command;

/// Number of restarts for the shards of a crashed process.
const TRIES: usize = 3;

pub fn run(arguments: &Campaign) -> Outcome {
    poinsot::start_threads()?;
    let mut plan = read_plan(&arguments.plan)?;
    if let Some(trials) = arguments.trials {
        plan.set_trials(trials);
    }
    if arguments.estimate {
        let document = cost_document(&campaign_cost(&plan)?);
        if !arguments.print.quiet {
            print_document(&document);
        }
        return Ok(0);
    }
    let out = arguments.out.as_deref().ok_or_else(|| {
        let problem = "a campaign needs a folder for its shards";
        Error::usage("--out", "", problem, "name one")
    })?;
    let results = ["campaign.json", "campaign.html"].map(|n| out.join(n));
    check_outputs("--out", &results, &[&arguments.plan])?;
    if arguments.emit.is_some() {
        return emit(arguments, &plan, out);
    }
    let ran = match &arguments.merge {
        Some(from) => merge_campaign(&plan, out, from, arguments.partial)?,
        None => {
            if let Some(processes) = arguments.processes {
                supervised(arguments, &plan, out, processes)?;
            }
            let follow = |so_far: &CampaignFile| print_far(so_far);
            let request = CampaignRequest {
                out: out.to_owned(),
                share: arguments.shard,
                resume: arguments.resume || arguments.processes.is_some(),
                until: arguments.until,
                follow: arguments.follow.then_some(&follow),
                ..CampaignRequest::default()
            };
            campaign(&plan, &request)?
        }
    };
    shown(arguments.print.json, arguments.print.quiet, &ran)
}

/// Prints the result of a campaign or sweep and returns the exit code.
pub fn shown(json: bool, quiet: bool, ran: &CampaignRun) -> Outcome {
    if !quiet {
        for shard in ran.damaged.iter().take(10) {
            note(&format!("shard {}: {}", shard.number, shard.why()));
        }
    }
    let Some(result) = &ran.result else {
        if json {
            print_json(&WrittenFile {
                shards: Some(ran.shards),
                ..WrittenFile::of(&ran.written)
            });
        } else if !quiet {
            note(&format!("{} run", counted(ran.shards, "shard")));
        }
        return Ok(0);
    };
    if json {
        print_result(result);
    } else if !quiet {
        for document in campaign_document(result) {
            print_document(&document);
            print("\n");
        }
    }
    noted(&ran.written, quiet);
    Ok(exit_of(ran.passes()))
}

/// Prints intermediate statistics on standard error.
fn print_far(so_far: &CampaignFile) {
    for cell in &so_far.cells {
        for method in &cell.methods {
            let coverage = method.numbers.iter().map(|(name, n)| {
                let percent = n.coverage_all.value.unwrap_or(f64::NAN) * 100.0;
                format!("{name} {percent:.1}")
            });
            let words: Vec<String> = coverage.take(6).collect();
            let (of, by) = (&cell.experiment, &method.method);
            let n = counted(method.trials, "trial");
            let words = words.join(", ");
            note(&format!("{of} {by}: {n}, coverage % {words}"));
        }
    }
}

fn emit(arguments: &Campaign, plan: &Plan, out: &Path) -> Outcome {
    let here = std::env::current_dir().unwrap_or_default();
    let whole = |path: &Path| here.join(path).display().to_string();
    let files = slurm_scripts(plan, &whole(&arguments.plan), &whole(out));
    let written = write_files(&out.join("slurm"), &files)?;
    super::written(&written, arguments.print.json, arguments.print.quiet);
    Ok(0)
}

/// Runs the shards in separate processes and restarts those that crash.
fn supervised(arguments: &Campaign, plan: &Plan, out: &Path, processes: u64) -> Result<(), Error> {
    let program = std::env::current_exe().map_err(|source| {
        let what = "the program cannot be found again";
        Error::io(Path::new("poinsot"), what, &source)
    })?;
    let threads = (thread_count() as u64 / processes).max(1).to_string();
    let hours = time_limit().to_string();
    let memory = memory_limit() / f64::from(1 << 20) / processes as f64;
    let memory = memory.max(1.0).floor().to_string();
    let start = |share: u64| {
        Command::new(&program)
            .arg("campaign")
            .arg(&arguments.plan)
            .arg("--out")
            .arg(out)
            .args(["--trials", &plan.trials.to_string()])
            .args(["--limit-hours", &hours, "--limit-memory", &memory])
            .args(["--resume", "--quiet", "--shard"])
            .arg(format!("{share}/{processes}"))
            .env("RAYON_NUM_THREADS", &threads)
            .spawn()
            .map_err(|source| Error::io(&program, "cannot be started", &source))
    };
    let mut running = Vec::new();
    for share in 1..=processes {
        running.push((share, 0, start(share)?));
    }
    let mut failed = None;
    while let Some((share, crashes, mut child)) = running.pop() {
        let ended = child
            .wait()
            .map_err(|source| Error::io(&program, "its end cannot be observed", &source))?;
        match ended.code() {
            Some(0) => {}
            // The process has already printed its error (input or disk).
            Some(code @ (2 | 3)) => failed = Some(code),
            _ => {
                let of_share = (0..plan.shards()).filter(|s| s % processes == share - 1);
                let missing = poinsot::campaign::missing_shards(plan, out, of_share)?;
                let at = missing.first();
                let at = at.map_or("none".to_owned(), |m| m.number.to_string());
                let again = match crashes < TRIES {
                    true => "it is restarted",
                    false => "given up",
                };
                note(&format!(
                    "process {share} of {processes} ended by {ended} with {} missing, the first {at}: {again}",
                    counted(missing.len(), "shard")
                ));
                if crashes < TRIES {
                    running.push((share, crashes + 1, start(share)?));
                }
            }
        }
    }
    let Some(code) = failed else { return Ok(()) };
    let problem = "a process of this campaign refused its input or met a full disk";
    let advice = "see its message above, then give --resume";
    let kind = if code == 3 {
        ErrorKind::System
    } else {
        ErrorKind::Input
    };
    let fault = Fault::new("E0603", Place::default(), problem, advice);
    Err(fault.of_kind(kind).into())
}
