//! Cost of a campaign, from measured trials.

use super::engine::one_thread;
use super::plan::{Plan, Shard};
use super::shard::ShardResult;
use super::trial::Prepared;
use crate::error::Error;
use crate::trials::Row;
use poinsot_files::stated;
use poinsot_formats::CampaignCost;
use poinsot_telemetry::RowCells;

/// Number of trials measured per cell. The first is a warm-up and not counted.
const MEASURED: u64 = 4;
/// Number of cells measured: the first, the last, and one in between.
const CELLS: u64 = 3;
/// Target duration of a shard, s: long enough for a scheduler, short enough to lose little.
const SHARD_S: [f64; 2] = [10.0, 120.0];

/// Runs a few trials on one thread and measures them.
///
/// # Errors
/// An experiment cannot be simulated.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// // Processor time of a trial, s.
/// assert!(campaign_cost(&plan)?.seconds > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
        let past = whole.trials.end.min(whole.trials.start + MEASURED);
        let shard = Shard {
            trials: whole.trials.start..past,
            ..whole
        };
        let rows = Prepared::new(plan, &shard)?.run_all(plan, &shard);
        let trials: Vec<&[Row]> = rows.chunks(plan.methods.len()).collect();
        let warm = usize::from(trials.len() > 1);
        for trial in &trials[warm..] {
            seconds += trial.iter().map(|row| row.seconds).sum::<f64>();
            count += 1.0;
        }
        let result = ShardResult::new(plan, &shard, &rows);
        bytes = bytes.max(bytes_of(&result) / trials.len() as f64);
    }
    let seconds = seconds / count;
    let in_time = |s: f64| (s / seconds.max(1.0e-9)).ceil() as u64;
    Ok(CampaignCost {
        name: plan.name.clone(),
        seconds,
        bytes,
        memory: stated("/proc/self/status", "VmHWM:", 1024.0).map(|bytes| bytes as u64),
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
