//! Runs a campaign: missing shards are run, all shards are added, and the result is written.

use super::engine::{locked, missing_shards, run_each, run_shards};
use super::plan::Plan;
use super::result::{Folded, fold_shards, fold_sums, widest_coverage};
use super::shard::{MissingShard, ShardSums, find, rows_path, sums_path};
use super::until::looks;
use crate::error::Error;
use crate::trials::OUTSIDE;
use crate::written::{result_json, write_files};
use poinsot_files::{Place, Stage, check_memory, folder_of, open};
use poinsot_formats::CampaignFile;
use poinsot_report::{campaign_page, no_page};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Memory of a listed shard, bytes: its number in three lists.
const OF_SHARD: f64 = 48.0;
/// Interval of `--follow`: at least this, and ten times its computing time.
const FOLLOWED: Duration = Duration::from_secs(5);

/// Runs shards into the folder of a campaign and returns when they are there.
pub type Engine<'a> = dyn Fn(&[u64]) -> Result<(), Error> + Sync + 'a;

/// Request of a campaign.
#[derive(Default)]
pub struct CampaignRequest<'a> {
    /// Folder of the campaign.
    pub out: PathBuf,
    /// Share i of n, from one: every n-th shard, without merging.
    pub share: Option<(u64, u64)>,
    /// Run only missing shards.
    pub resume: bool,
    /// Stop when the half-width of every coverage interval is below this.
    pub until: Option<f64>,
    /// Receives intermediate statistics.
    pub follow: Option<&'a (dyn Fn(&CampaignFile) + Sync)>,
    /// What runs the shards; without one, all cores of this machine.
    pub engine: Option<&'a Engine<'a>>,
}

/// A finished campaign.
#[derive(Default)]
pub struct CampaignRun {
    /// Statistics with intervals; `None` for one share of the shards.
    pub result: Option<CampaignFile>,
    /// Number of shards run now.
    pub shards: u64,
    /// Damaged shards that were run again, and missing ones.
    pub damaged: Vec<MissingShard>,
    /// Whether `until` was reached; `None` if not requested.
    pub reached: Option<bool>,
    /// Files of the result.
    pub written: Vec<PathBuf>,
}

impl CampaignRun {
    /// Whether no trial crashed, no shard is missing, and `until` was reached.
    pub fn passes(&self) -> bool {
        let Some(result) = &self.result else {
            return true;
        };
        let methods = result.cells.iter().flat_map(|c| &c.methods);
        let mut failures = methods.flat_map(|m| &m.failures);
        let crashed = failures.any(|(_, why)| why.starts_with("crashed"));
        !crashed && result.missing.is_empty() && self.reached != Some(false)
    }
}

/// Runs a plan in memory, without files.
///
/// # Errors
/// An experiment cannot be simulated.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// let run = campaign_in_memory(&plan)?;
/// let found = &run.result.unwrap().cells[0].methods[0].numbers["bus.inertia_kg_m2.zz"];
/// // Stated sigma and Cramer-Rao bound agree: the estimator is efficient.
/// assert!((found.stated.unwrap() / found.bound.unwrap() - 1.0).abs() < 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn campaign_in_memory(plan: &Plan) -> Result<CampaignRun, Error> {
    let all: Mutex<Vec<ShardSums>> = Mutex::default();
    let shards = listed(plan.shards(), 0..plan.shards())?;
    run_each(plan, &shards, &|result| {
        // Written as text and parsed, so that the result is identical to that of a campaign with files.
        let text = result.sums.text();
        let what = format!("the sums of {} shards", plan.shards());
        check_memory(&what, text.len() as f64 * plan.shards() as f64)?;
        let sums = ShardSums::parse(&text).map_err(Error::internal)?;
        locked(&all).push(sums);
        Ok(())
    })?;
    let all = all.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(CampaignRun {
        result: Some(fold_sums(plan, all)?.result(plan, plan.trials, OUTSIDE)),
        shards: plan.shards(),
        ..CampaignRun::default()
    })
}

/// Runs a plan into a folder.
///
/// # Errors
/// The folder holds shards of another plan, or of this plan without `resume`; writing fails; an experiment cannot be
/// simulated.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-campaign-{}", std::process::id()));
/// let request = CampaignRequest { out: out.clone(), ..CampaignRequest::default() };
/// let run = campaign(&plan, &request)?;
/// assert_eq!(run.shards, 1);
/// assert!(out.join("campaign.json").exists());
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn campaign(plan: &Plan, request: &CampaignRequest<'_>) -> Result<CampaignRun, Error> {
    refuse_other_plans(plan, &request.out)?;
    let mut ran = CampaignRun::default();
    if let Some((i, n)) = request.share {
        let own = (0..plan.shards()).filter(|s| s % n == i - 1);
        run_missing(plan, request, own, plan.trials, &mut ran)?;
        return Ok(ran);
    }
    let all = match request.until {
        Some(_) => looks(plan),
        None => vec![plan.trials],
    };
    // For all tests together (Bonferroni).
    let outside = OUTSIDE / all.len() as f64;
    for trials in all {
        let shards = 0..plan.shards_up_to(trials);
        run_missing(plan, request, shards, trials, &mut ran)?;
        let folded = fold_shards(plan, &request.out, trials)?;
        let widest = || widest_coverage(&folded.result(plan, trials, outside));
        ran.reached = request.until.map(|until| widest() <= until);
        if ran.reached == Some(true) || trials == plan.trials {
            finish(plan, &request.out, folded, trials, &mut ran)?;
            break;
        }
    }
    Ok(ran)
}

/// Merges the shards of this folder and of others into a result in this folder.
///
/// # Errors
/// A shard is missing (unless `partial`), damaged, or present twice with different sums; or writing fails.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-merge-{}", std::process::id()));
/// let (here, there) = (out.join("here"), out.join("there"));
/// run_shards(&plan, &there, &[0], &|_| {})?;
/// let merged = merge_campaign(&plan, &here, &[there], false)?;
/// assert_eq!(merged.result.unwrap().trials, 4);
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn merge_campaign(
    plan: &Plan,
    out: &Path,
    from: &[PathBuf],
    partial: bool,
) -> Result<CampaignRun, Error> {
    for folder in std::iter::once(out).chain(from.iter().map(PathBuf::as_path)) {
        refuse_other_plans(plan, folder)?;
    }
    if let Some(folder) = from.iter().find(|folder| !folder.is_dir()) {
        let what = "there is no such folder of shards".to_owned();
        let place = Place::file(folder);
        return Err(Error::one("E0603", place, what, "check the path"));
    }
    gather(plan, out, from)?;
    let folded = fold_shards(plan, out, plan.trials)?;
    if let Some(missing) = folded.missing.first().filter(|_| !partial) {
        let (many, all) = (folded.missing.len(), plan.shards());
        let (number, why) = (missing.number, missing.why());
        return Err(Error::one(
            "E0603",
            Place::file(sums_path(out, &plan.digest, number)),
            format!("shard {number} cannot be merged: {why} ({many} of {all} shards are missing)"),
            "run the campaign with --resume, or merge with --partial",
        ));
    }
    let mut ran = CampaignRun::default();
    finish(plan, out, folded, plan.trials, &mut ran)?;
    Ok(ran)
}

fn run_missing(
    plan: &Plan,
    request: &CampaignRequest<'_>,
    shards: impl Iterator<Item = u64>,
    trials: u64,
    ran: &mut CampaignRun,
) -> Result<(), Error> {
    let wanted = listed(plan.shards_up_to(trials), shards)?;
    let found = missing_shards(plan, &request.out, wanted.iter().copied())?;
    let missing: Vec<u64> = found.iter().map(|m| m.number).collect();
    let (all, there) = (wanted.len(), wanted.len() - missing.len());
    // On later passes, existing shards belong to this run.
    if there > 0 && !request.resume && ran.shards == 0 {
        let place = Place::file(&request.out);
        let problem = format!("{there} of {all} shards of this plan exist already");
        let advice = "use --resume to run the missing ones, or another --out";
        return Err(Error::one("E0602", place, problem, advice));
    }
    let damaged = found.into_iter().filter(|m| m.damage.is_some());
    ran.damaged.extend(damaged);
    ran.shards += missing.len() as u64;
    let last = Mutex::new((Instant::now(), FOLLOWED));
    let watch = |_: u64| {
        let Some(follow) = request.follow else { return };
        // If it is locked, another thread updates it.
        let Ok(mut last) = last.try_lock() else {
            return;
        };
        let now = Instant::now();
        if now.duration_since(last.0) < last.1 {
            return;
        }
        if let Ok(folded) = fold_shards(plan, &request.out, trials) {
            follow(&folded.result(plan, trials, OUTSIDE));
        }
        *last = (Instant::now(), FOLLOWED.max(10 * now.elapsed()));
    };
    match request.engine {
        Some(engine) => {
            engine(&missing)?;
            arrived(plan, &request.out, &missing)
        }
        None => run_shards(plan, &request.out, &missing, &watch),
    }
}

/// A list of shards, of at most so many.
fn listed(most: u64, shards: impl Iterator<Item = u64>) -> Result<Vec<u64>, Error> {
    let most = most as f64;
    check_memory(&format!("the {most:.3e} shards"), most * OF_SHARD)?;
    Ok(shards.collect())
}

/// Checks that the shards of an engine are in the folder.
fn arrived(plan: &Plan, out: &Path, shards: &[u64]) -> Result<(), Error> {
    let missing = missing_shards(plan, out, shards.iter().copied())?;
    let Some(first) = missing.first() else {
        return Ok(());
    };
    let (many, all) = (missing.len(), shards.len());
    let place = Place::file(sums_path(out, &plan.digest, first.number));
    let problem = format!("{many} of {all} shards that workers have run are not readable here");
    let advice = "run the campaign again with resume";
    Err(Error::one("E0603", place, problem, advice))
}

fn finish(
    plan: &Plan,
    out: &Path,
    folded: Folded,
    counted: u64,
    ran: &mut CampaignRun,
) -> Result<(), Error> {
    let result = folded.result(plan, counted, OUTSIDE);
    let report = |why: String| Error::report(out, why, "");
    let page = campaign_page(&result).map_err(|e| report(no_page(&e)))?;
    let html = page.html().map_err(|e| report(no_page(&e)))?;
    let text = result_json(out, &result, true)?;
    let files = [
        ("campaign.html".into(), html.into_bytes()),
        ("campaign.json".into(), text.into_bytes()),
    ];
    ran.written = write_files(out, &files)?;
    ran.damaged.extend(folded.missing);
    ran.result = Some(result);
    Ok(())
}

/// Checks that the folder has no shards of another plan.
fn refuse_other_plans(plan: &Plan, out: &Path) -> Result<(), Error> {
    let short = |path: &Path| {
        let name = path.file_name()?.to_str()?;
        let (digest, number) = name.strip_suffix(".json")?.split_once('_')?;
        number.parse::<u64>().ok()?;
        Some(digest.to_owned())
    };
    let entries = |folder: PathBuf| {
        let read = std::fs::read_dir(folder).into_iter().flatten();
        read.flatten().map(|entry| entry.path())
    };
    let other = entries(out.join("shards"))
        .flat_map(entries)
        .filter_map(|f| Some((short(&f)?, f)))
        .find(|(digest, _)| !plan.digest.starts_with(digest.as_str()));
    let Some((digest, path)) = other else {
        return Ok(());
    };
    let own = plan.digest.get(..digest.len()).unwrap_or(&plan.digest);
    let what =
        format!("this is a shard of plan {digest}, but the plan or one of its files is {own} now");
    let advice = "use another --out, or restore the plan";
    Err(Error::one("E0602", Place::file(path), what, advice))
}

/// Copies shards from other folders; duplicates must have the same sums.
fn gather(plan: &Plan, out: &Path, from: &[PathBuf]) -> Result<(), Error> {
    let pairs = from
        .iter()
        .flat_map(|f| (0..plan.shards()).map(move |n| (f, n)));
    for (folder, number) in pairs {
        let Ok(theirs) = find(plan, folder, number)? else {
            continue;
        };
        let source = sums_path(folder, &plan.digest, number);
        if let Ok(ours) = find(plan, out, number)? {
            if ours.sums.methods != theirs.sums.methods {
                let what = format!("shard {number} is there twice with different sums");
                let place = Place::file(source);
                return Err(Error::one("E0603", place, what, "remove one of them"));
            }
            continue;
        }
        let target = sums_path(out, &plan.digest, number);
        let mut stage = Stage::new(folder_of(&target))?;
        for (from, to) in [(rows_path(&source), rows_path(&target)), (source, target)] {
            let (mut file, _) = open(&from).map_err(|e| e.of_result(&from))?;
            stage.fill(Path::new(to.file_name().unwrap_or_default()), |draft| {
                let copied = std::io::copy(&mut file, draft);
                copied.map_err(|e| Error::io(&from, "cannot be copied", &e))
            })?;
        }
        stage.commit()?;
    }
    Ok(())
}
