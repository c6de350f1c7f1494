//! `[[design.thruster]]` and `[[limits.thruster]]`: firings with free times, and their limits.

use super::planner::{Part, Planner};
use poinsot_formats::case::{DesignThrusterFile, ThrusterLimitFile};
use poinsot_telemetry::STANDARD_GRAVITY;

/// One thruster whose firings a design times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fired {
    /// Index of the thruster.
    pub index: usize,
    /// Number of firings.
    pub firings: usize,
    /// Force of each firing, N.
    pub force: f64,
    /// When its last firing before the designed part ends, s.
    pub last_off: f64,
    /// When its first firing after the designed part begins, s.
    pub next_on: f64,
}

/// Limits of one thruster.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ThrusterLimit {
    /// Shortest firing, s.
    pub minimum_on: f64,
    /// Shortest pause between two firings, s.
    pub minimum_off: f64,
    /// Half angle of the plume, rad; `None`: no plume.
    pub plume: Option<f64>,
}

/// Impulse budget of several thrusters.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpulseLimit {
    /// Indices of the thrusters.
    pub thrusters: Vec<usize>,
    /// Budget, N s.
    pub impulse: f64,
    /// Impulse of firings that are not designed, N s.
    pub spent: f64,
    /// Exhaust velocity, m/s, if the budget is given as propellant.
    pub exhaust: Option<f64>,
}

impl Planner<'_> {
    pub(super) fn fired(&mut self, tables: &[DesignThrusterFile]) -> Vec<Fired> {
        let mut list: Vec<Fired> = Vec::new();
        for (i, table) in tables.iter().enumerate() {
            let key = format!("design.thruster[{i}]");
            let of = self.parts(Part::Thruster, table.thrusters.as_deref(), &key);
            for index in of {
                if list.iter().any(|f| f.index == index) {
                    let problem = "the same thruster is designed twice";
                    self.refuse("E0504", &key, problem, "name it in one table");
                    continue;
                }
                list.push(Fired {
                    index,
                    firings: table.firings,
                    force: table.force_N,
                    last_off: f64::NEG_INFINITY,
                    next_on: f64::INFINITY,
                });
            }
        }
        list
    }

    pub(super) fn thruster_limits(
        &mut self,
        tables: &[ThrusterLimitFile],
    ) -> (Vec<ThrusterLimit>, Vec<ImpulseLimit>) {
        let mut each = vec![ThrusterLimit::default(); self.model.thrusters.len()];
        let mut together = Vec::new();
        for (i, table) in tables.iter().enumerate() {
            let key = format!("limits.thruster[{i}]");
            let of = self.parts(Part::Thruster, table.thrusters.as_deref(), &key);
            for &k in &of {
                let limit = &mut each[k];
                limit.minimum_on = limit.minimum_on.max(table.minimum_on_s.unwrap_or(0.0));
                limit.minimum_off = limit.minimum_off.max(table.minimum_off_s.unwrap_or(0.0));
                let wider = table.plume_rad.into_iter().chain(limit.plume);
                limit.plume = wider.reduce(f64::max);
            }
            together.extend(self.impulse_limit(table, of, &key));
        }
        (each, together)
    }

    fn impulse_limit(
        &mut self,
        file: &ThrusterLimitFile,
        thrusters: Vec<usize>,
        key: &str,
    ) -> Option<ImpulseLimit> {
        let (impulse, exhaust) = match (
            file.impulse_N_s,
            file.propellant_kg,
            file.specific_impulse_s,
        ) {
            (None, None, None) => return None,
            (Some(impulse), None, None) => (impulse, None),
            (None, Some(mass), Some(specific)) => {
                let exhaust = STANDARD_GRAVITY * specific;
                (mass * exhaust, Some(exhaust))
            }
            _ => {
                let problem =
                    "a budget is impulse_N_s, or propellant_kg together with specific_impulse_s";
                return self.refused("E0507", key, problem, "give one of the two");
            }
        };
        Some(ImpulseLimit {
            thrusters,
            impulse,
            spent: 0.0,
            exhaust,
        })
    }
}

impl ImpulseLimit {
    /// Whether a thruster uses this budget.
    pub fn holds(&self, thruster: usize) -> bool {
        self.thrusters.contains(&thruster)
    }
}
