//! Published methods: one paper, one file. Baselines beside the ladder, run by the same command.

pub mod kim2010;
