//! One segment on two threads: one propagates the motion, the other computes residuals some grid times later.
//!
//! What each computes, and in what order, does not depend on the other: the result is that of one thread, bit by bit.

use super::SegmentComparison;
use crate::motion::{Column, EvaluatedState, Motion, State};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{Builder, scope};

/// Fewest grid times for which a thread is worth its start.
const LEAST: usize = 256;
/// Grid times handed over at once.
const BATCH: usize = 64;
/// Batches that may wait.
const WAITING: usize = 4;

/// Pose, momentum and their sensitivities at some grid times in a row.
#[derive(Default)]
struct GridBlock {
    known: Vec<EvaluatedState>,
    columns: Vec<Column>,
}

/// Compares every grid time of a segment with what `motion`, a propagation from the first one, gives there; on two
/// threads where `split` and the segment is long. `None` where the vehicle cannot move so, or no reading can be compared.
pub(super) fn compare_all<'m>(
    compare: &mut SegmentComparison,
    motion: impl Fn() -> Motion<'m> + Sync,
    start: &State,
    (samples, split): (usize, bool),
) -> Option<()> {
    if split && samples >= LEAST {
        let done = on_two_threads(compare, &motion, start, samples);
        // No second thread to be had.
        return done.unwrap_or_else(|| in_turn(compare, motion(), start, samples));
    }
    in_turn(compare, motion(), start, samples)
}

fn in_turn(
    compare: &mut SegmentComparison,
    mut motion: Motion,
    start: &State,
    samples: usize,
) -> Option<()> {
    let mut state = *start;
    for k in 0..samples {
        compare.sample(&mut motion, &state, k)?;
        state = motion.advance(&state, k)?;
    }
    Some(())
}

/// `None` where the system starts no thread.
fn on_two_threads<'m>(
    compare: &mut SegmentComparison,
    motion: &(impl Fn() -> Motion<'m> + Sync),
    start: &State,
    samples: usize,
) -> Option<Option<()>> {
    scope(|threads| {
        let (ahead, behind) = sync_channel(WAITING);
        Builder::new()
            .spawn_scoped(threads, move || follow(motion(), start, samples, &ahead))
            .ok()?;
        Some(compare_behind(compare, motion(), &behind, samples))
    })
}

/// Propagates the motion and sends it until the end, an invalid motion, or a closed channel.
fn follow(
    mut motion: Motion,
    start: &State,
    samples: usize,
    ahead: &SyncSender<GridBlock>,
) -> Option<()> {
    let mut state = *start;
    for first in (0..samples).step_by(BATCH) {
        let mut stretch = GridBlock::default();
        for k in first..(first + BATCH).min(samples) {
            stretch.known.push(motion.evaluated_state(&state, k)?);
            stretch.columns.extend_from_slice(&motion.columns);
            state = motion.advance(&state, k)?;
        }
        ahead.send(stretch).ok()?;
    }
    Some(())
}

/// Compares what comes; `None` where it ends too early.
fn compare_behind(
    compare: &mut SegmentComparison,
    mut motion: Motion,
    behind: &Receiver<GridBlock>,
    samples: usize,
) -> Option<()> {
    let width = motion.columns.len();
    let mut k = 0;
    for stretch in behind {
        for (i, known) in stretch.known.iter().enumerate() {
            motion.resume_from(known, &stretch.columns[i * width..(i + 1) * width], k);
            compare.sample(&mut motion, &known.state, k)?;
            k += 1;
        }
    }
    (k == samples).then_some(())
}
