//! Cost of a campaign, from measured trials.

use super::engine::one_thread;
use super::plan::{Plan, Shard};
use super::shard::ShardResult;
use super::trial::{Prepared, at_once};
use crate::error::Error;
use poinsot_figures::{Document, Section, Table};
use poinsot_files::significant;
use poinsot_telemetry::RowCells;

/// Least number of trials measured per cell. The first is a warm-up and not counted; kernels measure a block of trials.
const MEASURED: u64 = 4;
/// Number of cells measured: the first, the last, and one in between.
const CELLS: u64 = 3;
/// Numbers of trials with a reported cost, in addition to the plan's.
const PRICED: [u64; 2] = [1_000_000, 1_000_000_000];
/// Target duration of a shard, s: long enough for a scheduler, short enough to lose little.
const SHARD_S: [f64; 2] = [10.0, 120.0];

/// Cost of the trials of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignCost {
    /// CPU time of one trial by all methods, s, averaged over the measured cells.
    pub seconds: f64,
    /// Uncompressed bytes of the rows of one trial.
    pub bytes: f64,
    /// Peak memory of the process, bytes, if the system reports it.
    pub memory: Option<u64>,
    /// Trials of all cells.
    pub trials: u64,
    /// Trials per shard for 10 to 120 s.
    pub block: (u64, u64),
    /// Trials per shard in the plan.
    pub planned_block: u64,
}

/// Runs a few trials on one thread and measures them.
///
/// # Errors
/// An experiment cannot be simulated.
pub fn campaign_cost(plan: &Plan) -> Result<CampaignCost, Error> {
    // A trial of a campaign has one thread; the time of others would not be counted.
    one_thread()?.install(|| measured_cost(plan))
}

fn measured_cost(plan: &Plan) -> Result<CampaignCost, Error> {
    let cells = plan.cells();
    let mut chosen: Vec<u64> = (0..CELLS).map(|k| k * (cells - 1) / (CELLS - 1)).collect();
    chosen.dedup();
    let (mut seconds, mut count, mut bytes) = (0.0, 0.0, 0.0_f64);
    for cell in chosen {
        let whole = plan.shard(cell);
        let measured = MEASURED.max(at_once(plan));
        let past = whole.trials.end.min(whole.trials.start + measured);
        let shard = Shard {
            trials: whole.trials.start..past,
            ..whole
        };
        let prepared = Prepared::new(plan, &shard)?;
        let done = prepared.run(plan, &shard, shard.trials.clone());
        let warm = if done.len() > 1 { 1 } else { 0 };
        for trial in &done[warm..] {
            seconds += trial.seconds.iter().sum::<f64>();
            count += 1.0;
        }
        let result = ShardResult::new(plan, &shard, &prepared.bound(), &done);
        bytes = bytes.max(bytes_of(&result) / done.len() as f64);
    }
    let seconds = seconds / count;
    let in_time = |s: f64| (s / seconds.max(1.0e-9)).ceil() as u64;
    Ok(CampaignCost {
        seconds,
        bytes,
        memory: memory(),
        trials: plan.trials.saturating_mul(cells),
        block: (in_time(SHARD_S[0]), in_time(SHARD_S[1])),
        planned_block: plan.block,
    })
}

/// Bytes of the rows: eight per number. Repeated words are stored once, and the file header is not counted.
fn bytes_of(result: &ShardResult) -> f64 {
    let cells = |c: &poinsot_telemetry::RowColumn| match &c.cells {
        RowCells::Number(x) => x.iter().flatten().count(),
        RowCells::Count(x) => x.len(),
        RowCells::Text(_) => 0,
    };
    8.0 * result.rows.iter().map(cells).sum::<usize>() as f64
}

/// Peak resident memory of this process, bytes.
fn memory() -> Option<u64> {
    let status = poinsot_files::read_text("/proc/self/status".as_ref(), 1 << 20).ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib << 10)
}

/// The cost as a document.
pub fn cost_document(plan: &Plan, cost: &CampaignCost) -> Document {
    let mut document = Document::new(format!(
        "{}: {} s of processor time a trial",
        plan.name,
        significant(cost.seconds, 3)
    ));
    let mut table = Table::new(&["trials", "core-hours", "disk"]);
    let mut rows = vec![(cost.trials, "this plan")];
    rows.extend(PRICED.map(|n| (n, "")));
    for (trials, word) in rows {
        table.push(vec![
            format!("{trials} {word}").trim_end().to_owned(),
            significant(cost.seconds * trials as f64 / 3600.0, 3),
            size(cost.bytes * trials as f64),
        ]);
    }
    document.push(Section::table("cost", table));
    let mut lines = Vec::new();
    if let Some(memory) = cost.memory {
        lines.push(format!(
            "memory: {} with one thread; each further thread adds one trial",
            size(memory as f64)
        ));
    }
    let (least, most) = cost.block;
    lines.push(format!(
        "a shard of 10 to 120 s has {least} to {most} trials; trials_per_shard is {}",
        cost.planned_block
    ));
    lines.push(
        "measured on this machine without other load; times differ on other machines".to_owned(),
    );
    document.push(Section::list("and", lines));
    document
}

fn size(bytes: f64) -> String {
    const UNITS: [&str; 6] = ["B", "kB", "MB", "GB", "TB", "PB"];
    let (mut x, mut unit) = (bytes, 0);
    while x >= 1000.0 && unit + 1 < UNITS.len() {
        x /= 1000.0;
        unit += 1;
    }
    format!("{} {}", significant(x, 3), UNITS[unit])
}
