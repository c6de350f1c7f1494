//! Pose and momentum at the start of a segment, and which of them are unknown.

use crate::motion::Column;
/// Pose and momentum at the first grid time; angular momentum about the system's mass centre, all in N.
pub(crate) use crate::motion::State as InitialState;
use crate::problem::Problem;
use crate::problem::segment::{Segment, SensorRecord};
use poinsot_dynamics::propagation::STATE;
use poinsot_model::{MomentumKnowledge, SensorKind};

/// Unknown parts of the initial state: a column for each component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct InitialStateColumns {
    pub attitude: bool,
    pub position: bool,
    pub linear: bool,
    pub angular: bool,
    /// Number of modes and passive joints, whose amplitudes and momenta are unknown.
    pub internal: usize,
}

impl InitialStateColumns {
    /// Unknown initial state of a segment: an unmeasured pose is the choice of the frame.
    ///
    /// One that is taken as exact is known, at its first sample. `seen` is whether translation is measured.
    pub fn of(segment: &Segment, problem: &Problem, seen: bool) -> Self {
        let (o, momentum) = (&segment.observations, &problem.model.momentum);
        let noisy = |kind| !o.of_kind(kind).any(SensorRecord::is_exact);
        Self {
            // Without an attitude sensor, directions or motion in N still determine the attitude in N.
            attitude: match o.reads(SensorKind::Attitude) {
                true => noisy(SensorKind::Attitude),
                false => o.reads(SensorKind::Direction) || seen && o.reads_translation(),
            },
            position: seen && o.reads(SensorKind::Position) && noisy(SensorKind::Position),
            linear: seen && momentum.linear == MomentumKnowledge::Estimate,
            angular: momentum.angular == MomentumKnowledge::Estimate,
            internal: problem.internal_states(),
        }
    }

    /// Change of the state at the first grid time with every unknown, `unknowns` of which are not of the start.
    pub fn columns(&self, unknowns: usize) -> Vec<Column> {
        let parts = self.parts().into_iter().enumerate();
        let wanted = parts.filter(|(_, wanted)| *wanted);
        let vectors = wanted.flat_map(|(part, _)| 3 * part..3 * part + 3);
        let internal = STATE..STATE + 2 * self.internal;
        let own = vectors.chain(internal).map(|k| Column::ith(k, 1.0));
        own.chain((0..unknowns).map(|_| Column::zeros())).collect()
    }

    /// Number of columns.
    pub fn count(&self) -> usize {
        let vectors = self.parts().map(usize::from).iter().sum::<usize>();
        3 * vectors + 2 * self.internal
    }

    /// Whether attitude, position and both momenta are unknown.
    pub fn parts(&self) -> [bool; 4] {
        [self.attitude, self.position, self.linear, self.angular]
    }

    /// First column of the linear and of the angular momentum.
    pub fn momentum_at(&self) -> (Option<usize>, Option<usize>) {
        let before = 3 * (usize::from(self.attitude) + usize::from(self.position));
        let linear = self.linear.then_some(before);
        let angular = self
            .angular
            .then_some(before + 3 * usize::from(self.linear));
        (linear, angular)
    }
}
