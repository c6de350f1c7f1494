//! Reads channels in parallel along the union of their times.

use crate::Channel;

/// One channel, read along the union of times.
pub(crate) struct Cursor<'a> {
    channel: &'a Channel,
    /// Samples read.
    pub(crate) next: usize,
}

impl Cursor<'_> {
    pub(crate) fn at(&mut self, time: f64) -> Option<f64> {
        if *self.channel.time_s.get(self.next)? != time {
            return None;
        }
        let value = self.channel.values.get(self.next).copied();
        self.next += 1;
        value
    }
}

pub(crate) fn cursors(channels: &[Channel]) -> Vec<Cursor<'_>> {
    channels
        .iter()
        .map(|channel| Cursor { channel, next: 0 })
        .collect()
}
