//! `[[design.thruster]]` and `[[limits.thruster]]`: firings with free times, and their limits.

use super::fault::did_you_mean;
use super::planner::Planner;
use poinsot_formats::case::{DesignThrusterFile, Placed, ThrusterLimitFile};
use poinsot_telemetry::STANDARD_GRAVITY;
use std::f64::consts::FRAC_PI_2;

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
    pub(super) fn thrusters_of(
        &mut self,
        names: Option<&[Placed<String>]>,
        key: &str,
    ) -> Vec<usize> {
        let Some(names) = names else {
            return (0..self.model.thrusters.len()).collect();
        };
        let mut found = Vec::new();
        for name in names {
            match self.model.thruster(name.get_ref()) {
                Some(k) => found.push(k),
                None => {
                    let known = self.model.thrusters.iter().map(|t| t.name.as_str());
                    let remedy = did_you_mean(name.get_ref(), known);
                    self.unknown("thruster", &format!("{key}.thrusters"), name, remedy);
                }
            }
        }
        found
    }

    pub(super) fn fired(&mut self, tables: &[Placed<DesignThrusterFile>]) -> Vec<Fired> {
        let mut list: Vec<Fired> = Vec::new();
        for (i, table) in tables.iter().enumerate() {
            let (key, file) = (format!("design.thruster[{i}]"), table.get_ref());
            let of = self.thrusters_of(file.thrusters.as_deref(), &key);
            let span = file.firings.span();
            let Some(firings) = self.needed(Some(&file.firings), "firings", 1, span, &key) else {
                continue;
            };
            let force = self.limit(&format!("{key}.force_N"), Some(&file.force_N));
            for index in of {
                if list.iter().any(|f| f.index == index) {
                    let problem = "the same thruster is designed twice";
                    self.refuse("E0504", &key, table.span(), problem, "name it in one table");
                    continue;
                }
                list.push(Fired {
                    index,
                    firings,
                    force,
                    last_off: f64::NEG_INFINITY,
                    next_on: f64::INFINITY,
                });
            }
        }
        list
    }

    pub(super) fn thruster_limits(
        &mut self,
        tables: &[Placed<ThrusterLimitFile>],
    ) -> (Vec<ThrusterLimit>, Vec<ImpulseLimit>) {
        let mut each = vec![ThrusterLimit::default(); self.model.thrusters.len()];
        let mut together = Vec::new();
        for (i, table) in tables.iter().enumerate() {
            let (key, file) = (format!("limits.thruster[{i}]"), table.get_ref());
            let of = self.thrusters_of(file.thrusters.as_deref(), &key);
            let mut shortest = |name: &str, given: Option<&Placed<f64>>| match given {
                None => 0.0,
                given => self.limit(&format!("{key}.{name}"), given),
            };
            let on = shortest("minimum_on_s", file.minimum_on_s.as_ref());
            let off = shortest("minimum_off_s", file.minimum_off_s.as_ref());
            let plume = file.plume_rad.as_ref().map(|x| (*x.get_ref(), x.span()));
            if let Some((half, span)) = plume.clone()
                && !(half > 0.0 && half < FRAC_PI_2)
            {
                let problem = "the half angle of a plume lies between 0 and pi/2";
                let key = format!("{key}.plume_rad");
                self.refuse("E0505", &key, span, problem, "give it in rad");
            }
            for &k in &of {
                let limit = &mut each[k];
                limit.minimum_on = limit.minimum_on.max(on);
                limit.minimum_off = limit.minimum_off.max(off);
                let wider = plume.iter().map(|p| p.0).chain(limit.plume);
                limit.plume = wider.reduce(f64::max);
            }
            together.extend(self.impulse_limit(file, of, table.span(), &key));
        }
        (each, together)
    }

    fn impulse_limit(
        &mut self,
        file: &ThrusterLimitFile,
        thrusters: Vec<usize>,
        span: std::ops::Range<usize>,
        key: &str,
    ) -> Option<ImpulseLimit> {
        let (impulse, exhaust) = match (
            &file.impulse_N_s,
            &file.propellant_kg,
            &file.specific_impulse_s,
        ) {
            (None, None, None) => return None,
            (Some(_), None, None) => {
                let impulse = file.impulse_N_s.as_ref();
                (self.limit(&format!("{key}.impulse_N_s"), impulse), None)
            }
            (None, Some(_), Some(_)) => {
                let (mass, specific) = (
                    file.propellant_kg.as_ref(),
                    file.specific_impulse_s.as_ref(),
                );
                let mass = self.limit(&format!("{key}.propellant_kg"), mass);
                let specific = self.limit(&format!("{key}.specific_impulse_s"), specific);
                let exhaust = STANDARD_GRAVITY * specific;
                (mass * exhaust, Some(exhaust))
            }
            _ => {
                let problem =
                    "a budget is impulse_N_s, or propellant_kg together with specific_impulse_s";
                self.refuse("E0507", key, span, problem, "give one of the two");
                return None;
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
