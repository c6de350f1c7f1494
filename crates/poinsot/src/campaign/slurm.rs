//! Slurm scripts: an array of tasks, one share of the shards each, and a merge after all tasks have succeeded.

use super::plan::Plan;
use crate::written::OutputFile;

/// Largest number of tasks in an array; Slurm's default limit is 1001.
const MOST_TASKS: u64 = 1000;

/// `campaign.sbatch`, `merge.sbatch` and `submit.sh` for a plan and its folder, with paths as given on the command
/// line.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// let scripts = slurm_scripts(&plan, "plan.toml", "out");
/// assert!(scripts.iter().any(|(name, _)| name.ends_with("submit.sh")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn slurm_scripts(plan: &Plan, plan_path: &str, out: &str) -> Vec<OutputFile> {
    let tasks = plan.shards().clamp(1, MOST_TASKS);
    let (plan_path, out) = (quoted(plan_path), quoted(out));
    let name = quoted(&format!("poinsot-{}", plan.digest.get(..8).unwrap_or("")));
    let head = format!(
        "#!/bin/sh\n#SBATCH --job-name={name}\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=1\n"
    );
    let array = format!(
        "{head}#SBATCH --array=1-{tasks}\n#SBATCH --requeue\n# Each task runs one part of the {} shards; a repeated task runs the missing ones.\nset -eu\nexport RAYON_NUM_THREADS=\"${{SLURM_CPUS_PER_TASK:-1}}\"\nexec poinsot campaign {plan_path} --out {out} --shard \"${{SLURM_ARRAY_TASK_ID}}/{tasks}\" --resume --quiet\n",
        plan.shards()
    );
    let merge = format!("{head}set -eu\nexec poinsot campaign {plan_path} --out {out} --merge\n");
    let submit = "#!/bin/sh\n\
        # Submits the array, and the merge to follow it. Options, for example --time=1:00:00 --partition=short, go to both.\n\
        set -eu\n\
        here=$(dirname \"$0\")\n\
        array=$(sbatch --parsable \"$@\" \"$here/campaign.sbatch\")\n\
        sbatch \"$@\" --dependency=\"afterok:${array%%;*}\" \"$here/merge.sbatch\"\n";
    [
        ("campaign.sbatch", array),
        ("merge.sbatch", merge),
        ("submit.sh", submit.to_owned()),
    ]
    .into_iter()
    .map(|(name, text)| (name.into(), text.into_bytes()))
    .collect()
}

/// A word quoted for the shell.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', "'\\''"))
}
