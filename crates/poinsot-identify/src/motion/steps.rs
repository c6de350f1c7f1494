//! Integration steps of a motion.

/// Integration steps of a segment.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Grid {
    /// In the interval after each grid time.
    pub steps: Vec<u32>,
    /// Whether any interval is long enough for wheel speeds to bend within it.
    pub bends: bool,
}

/// Step refinement of an experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fineness {
    /// Steps for each one of the grid.
    pub factor: u32,
    /// Whether wheel speeds bend within an interval wherever the grid would have them straight; their axial momentum is straight then.
    pub bends: bool,
}

impl Default for Fineness {
    fn default() -> Self {
        Self {
            factor: 1,
            bends: false,
        }
    }
}
