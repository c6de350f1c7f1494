//! Stopping rule of a campaign: tests at complete prefixes of the trials, with the error probability split among them.

use super::plan::Plan;

/// Trials at the first test; each further test has twice as many.
const FIRST_LOOK: u64 = 1000;

/// Trial numbers of the tests: 1000, 2000, 4000 and so on, rounded up to whole shards. The last test is at the end.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// // Fewer than 1000 trials: one test, at the end.
/// assert_eq!(looks(&plan), [4]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn looks(plan: &Plan) -> Vec<u64> {
    let mut all = Vec::new();
    let mut next = FIRST_LOOK;
    while next < plan.trials {
        let whole = next.div_ceil(plan.block) * plan.block;
        if whole < plan.trials && all.last() != Some(&whole) {
            all.push(whole);
        }
        next = next.saturating_mul(2);
    }
    all.push(plan.trials);
    all
}
