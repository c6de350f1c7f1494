//! Which candidates explain what is left over, and what their numbers mean.

use super::candidates::Candidate;
use super::projected::Projected;
use super::types::{FaultKind, Suspect};
use crate::fit::{Fitted, fit_from};
use crate::information::{Experiment, Point};
use crate::parameters::UnknownKind;

/// Decrease of chi-square, over its mean per number, from which a candidate is named: one in 10^8 by chance.
const SIGNIFICANT: f64 = 40.0;
/// Candidates that are fitted in earnest before one is named.
const FITTED: usize = 3;
/// Sigmas by which a number must lie beyond what nature allows to be impossible.
const IMPOSSIBLE: f64 = 3.0;
/// Share of a decrease of chi-square that counts as much as all of it.
const AS_MUCH: f64 = 0.95;
/// Name of the candidate that thrusters act at other times than their columns say.
const LATE_THRUST: &str = "a lag of the thrust";
/// Iterations of such a fit.
const ITERATIONS: usize = 12;

/// Significant candidates, the best first. Scores are of first order; where the misfit is large the best few
/// are fitted, because a fault like a wrong sign is far away.
pub(super) fn suspects(
    experiment: &Experiment,
    fitted: &Fitted,
    candidates: &[Candidate],
    projected: &Projected,
    (excess, per_number, misfit): (f64, f64, bool),
    affordable: bool,
) -> Vec<Suspect> {
    let mut from = 0;
    let mut list: Vec<Scored> = Vec::new();
    let mut in_full: Vec<usize> = Vec::new();
    for (at, candidate) in candidates.iter().enumerate() {
        let group: Vec<usize> = (from..from + candidate.unknowns.len()).collect();
        from += group.len();
        let score = projected.score(&group, None);
        if score.decrease > SIGNIFICANT * per_number {
            let values = candidate.unknowns.iter().zip(&score.values);
            let values: Vec<f64> = values.map(|(u, v)| u.nominal + v).collect();
            let sigma = |k: usize| (score.covariance[k][k] * per_number).sqrt();
            let sigmas = (0..values.len()).map(sigma).collect();
            list.push(Scored {
                at,
                suspect: suspect(candidate, score.decrease, &values),
                sigmas,
                nominal: candidate.unknowns.iter().map(|u| u.nominal).collect(),
            });
        }
    }
    list.retain(Scored::is_possible);
    let falling = |a: &Scored, b: &Scored| b.suspect.decrease.total_cmp(&a.suspect.decrease);
    list.sort_by(falling);
    if misfit && affordable {
        for (rank, one) in list.iter_mut().enumerate() {
            let candidate = &candidates[one.at];
            // What reads early may stand for what drives the vehicle late, so that is always tried.
            if rank >= FITTED && !candidate.delays_inputs() {
                continue;
            }
            if let Some((decrease, values)) = in_earnest(experiment, fitted, candidate) {
                one.suspect = suspect(candidate, decrease, &values);
            }
            in_full.push(one.at);
        }
        list = significant(list, SIGNIFICANT * per_number);
        list.retain(Scored::is_possible);
        let is_fitted = |one: &Scored| in_full.contains(&one.at);
        // Those fitted first: what is of first order only says little where the misfit is large.
        list.sort_by(|a, b| is_fitted(b).cmp(&is_fitted(a)).then_with(|| falling(a, b)));
    }
    late_before_early(&mut list, SIGNIFICANT * per_number);
    list.into_iter()
        .map(|one| {
            let mut s = one.suspect;
            s.explains = if misfit {
                (s.decrease / excess).clamp(0.0, 1.0)
            } else {
                0.0
            };
            name(experiment, &mut s);
            s
        })
        .collect()
}

/// A suspect with the place of its candidate, and how well its numbers are known.
struct Scored {
    at: usize,
    suspect: Suspect,
    /// From the score, the size of the residual taken as seen.
    sigmas: Vec<f64>,
    nominal: Vec<f64>,
}

impl Scored {
    /// Whether nature allows the numbers: no drag pushes, no rotor has less than no inertia unless its sign is wrong.
    fn is_possible(&self) -> bool {
        let values = self.suspect.values.iter().map(|v| v.1);
        let value = |k: usize| self.suspect.values.get(k).map_or(0.0, |v| v.1);
        let sigma = |k: usize| self.sigmas.get(k).copied().unwrap_or(0.0);
        match self.suspect.fault {
            FaultKind::Drag => {
                let largest = values.clone().fold(0.0, f64::max);
                let mut each = values.zip(&self.sigmas);
                each.all(|(c, sigma)| c >= 0.0 || -c < IMPOSSIBLE * sigma && -c < largest)
            }
            // The wrong sign of a speed is a rotor of the same size that is negative.
            FaultKind::WheelScale => {
                let mirrored = self.nominal.iter().any(|n| near(value(0), -n));
                mirrored || value(0) > -IMPOSSIBLE * sigma(0)
            }
            FaultKind::Thrust => near(value(0), -2.0) || value(0) > -1.0 - IMPOSSIBLE * sigma(0),
            _ => true,
        }
    }

    /// How early a sensor would have to read, s: what it reads has not happened yet. Thrust may be read late, so that
    /// it acts before its column.
    fn early_s(&self) -> f64 {
        let thrust = self.suspect.name == LATE_THRUST;
        match (self.suspect.fault, self.suspect.values.first()) {
            (FaultKind::Lag, Some((_, lag, _))) if !thrust => (-lag).max(0.0),
            _ => 0.0,
        }
    }
}

/// Without those that turned out to explain nothing when they were fitted.
fn significant(mut list: Vec<Scored>, least: f64) -> Vec<Scored> {
    list.retain(|one| one.suspect.decrease > least);
    list
}

/// Where one sensor reading early explains hardly more than something that is possible, that is named first: nothing
/// reads what has not happened yet.
fn late_before_early(list: &mut [Scored], margin: f64) {
    let Some(first) = list.first().filter(|one| one.early_s() > 0.0) else {
        return;
    };
    let enough = (first.suspect.decrease - margin).min(AS_MUCH * first.suspect.decrease);
    let possible = |one: &Scored| {
        one.suspect.fault == FaultKind::Lag
            && one.early_s() == 0.0
            && one.suspect.decrease >= enough
    };
    if let Some(at) = list.iter().position(possible) {
        list[..=at].rotate_right(1);
    }
}

fn suspect(candidate: &Candidate, decrease: f64, values: &[f64]) -> Suspect {
    Suspect {
        name: candidate.name.clone(),
        decrease,
        explains: 0.0,
        values: candidate
            .unknowns
            .iter()
            .zip(values)
            .map(|(u, v)| (u.name.clone(), *v, u.unit))
            .collect(),
        fault: candidate.fault,
    }
}

/// The fit with this candidate unknown: decrease of chi-square, and values.
fn in_earnest(
    experiment: &Experiment,
    fitted: &Fitted,
    candidate: &Candidate,
) -> Option<(f64, Vec<f64>)> {
    let known = |u: &crate::parameters::Unknown| {
        matches!(
            u.kind,
            UnknownKind::InertialTorque(_) | UnknownKind::InertialForce(_)
        )
    };
    // A drift has columns only: its score is exact enough.
    if candidate.unknowns.iter().any(known) {
        return None;
    }
    let mut parameters = experiment.parameters.clone();
    let mut x = fitted.at.x.clone();
    let at = match candidate.unknowns.first()?.kind.is_nuisance() {
        true => parameters.len(),
        false => fitted.shared.mass,
    };
    for (k, unknown) in candidate.unknowns.iter().enumerate() {
        parameters.unknowns.insert(at + k, unknown.clone());
        x.insert(at + k, unknown.nominal);
    }
    let wide = experiment.with_parameters(&parameters);
    let start = Point {
        x,
        heads: fitted.at.heads.clone(),
    };
    let before = experiment.chi2(&fitted.at, &fitted.evaluated)?;
    let found = fit_from(&wide, start, ITERATIONS)?;
    let after = wide.chi2(&found.at, &found.evaluated)?;
    let values = found.at.x.get(at..at + candidate.unknowns.len())?.to_vec();
    Some((before - after, values))
}

/// Factors by which a unit is mistaken, and the mistake.
const MISTAKEN: [(f64, &str); 4] = [
    (57.295_779_5, "radians read as degrees"),
    (0.017_453_293, "degrees read as radians"),
    (0.104_719_755, "revolutions a minute read as rad/s"),
    (std::f64::consts::TAU, "revolutions read as radians"),
];

fn near(value: f64, wanted: f64) -> bool {
    (value / wanted - 1.0).abs() < 0.2
}

/// Says what values mean where they speak for themselves: a wrong sign, a wrong unit.
fn name(experiment: &Experiment, suspect: &mut Suspect) {
    let model = experiment.problem.model;
    match suspect.fault {
        FaultKind::WheelScale => {
            let Some((owner, value, _)) = suspect.values.first() else {
                return;
            };
            let wheel = model
                .wheels
                .iter()
                .find(|w| *owner == format!("{}.spin_inertia", w.name));
            let Some(wheel) = wheel else { return };
            let ratio = value / wheel.spin_inertia;
            if near(ratio, -1.0) {
                suspect.fault = FaultKind::WheelSign;
                suspect.name = format!("a wrong sign of {}", wheel.name);
            } else if let Some((_, what)) = MISTAKEN.iter().find(|(f, _)| near(ratio, *f)) {
                suspect.fault = FaultKind::Units;
                suspect.name = format!("a wrong unit of {} ({what})", wheel.name);
            }
        }
        FaultKind::Lag
            if suspect.name == LATE_THRUST && suspect.values.first().is_some_and(|v| v.1 < 0.0) =>
        {
            "thrust that is read late".clone_into(&mut suspect.name);
        }
        FaultKind::GyroScale => {
            for (factor, what) in MISTAKEN {
                // The gyro reads (1 + scale) w: the reading is 1/factor of what it should be.
                if suspect
                    .values
                    .iter()
                    .all(|(_, s, _)| near(1.0 + s, 1.0 / factor))
                {
                    suspect.fault = FaultKind::Units;
                    suspect.name = format!("a wrong unit of the gyro ({what})");
                }
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_a_suspect_whose_fit_lowers_nothing_is_none() {
        let with = |decrease: f64| scored("drag", FaultKind::Drag, decrease, &[]);
        let left = significant(vec![with(-0.3), with(500.0), with(f64::NAN)], 40.0);
        assert_eq!(left.len(), 1);
        assert_eq!(left[0].suspect.decrease, 500.0);
    }

    fn scored(name: &str, fault: FaultKind, decrease: f64, values: &[f64]) -> Scored {
        Scored {
            at: 0,
            suspect: Suspect {
                name: name.to_owned(),
                decrease,
                explains: 0.0,
                values: values.iter().map(|v| (String::new(), *v, "")).collect(),
                fault,
            },
            sigmas: vec![0.1; values.len()],
            nominal: vec![1.0; values.len()],
        }
    }

    #[test]
    fn unit_drag_that_pushes_is_no_suspect() {
        let possible = |c: [f64; 3]| scored("drag", FaultKind::Drag, 1.0e3, &c).is_possible();
        assert!(possible([1.0, 0.0, 2.0]));
        // Noise about zero.
        assert!(possible([1.0, -0.2, 0.0]));
        assert!(!possible([1.0, -0.4, 0.0]));
        assert!(!possible([0.0, -0.2, 0.1]));
        assert!(!possible([10.0, 20.0, -1777.0]));
    }

    #[test]
    fn unit_a_rotor_of_negative_inertia_is_no_suspect_unless_its_sign_is_wrong() {
        let rotor = |s: f64| scored("rotor", FaultKind::WheelScale, 1.0e3, &[s]).is_possible();
        assert!(rotor(0.5) && rotor(-0.2) && rotor(-1.05));
        assert!(!rotor(-0.5) && !rotor(-20.0));
        let thrust = |x: f64| scored("jet", FaultKind::Thrust, 1.0e3, &[x]).is_possible();
        assert!(thrust(0.1) && thrust(-1.1) && thrust(-2.1));
        assert!(!thrust(-1.5) && !thrust(-9.0));
    }

    #[test]
    fn unit_a_late_input_comes_before_a_sensor_that_reads_the_future() {
        let of = |list: &[(&str, f64, f64)]| {
            let one = |(name, decrease, lag): &(&str, f64, f64)| {
                scored(name, FaultKind::Lag, *decrease, &[*lag])
            };
            let mut list: Vec<Scored> = list.iter().map(one).collect();
            late_before_early(&mut list, 40.0);
            list[0].suspect.name.clone()
        };
        let early = ("a lag of the attitude", 1000.0, -0.09);
        assert_eq!(of(&[early, ("joints", 970.0, 0.1)]), "joints");
        assert_eq!(of(&[early, (LATE_THRUST, 970.0, -0.1)]), LATE_THRUST);
        assert_eq!(of(&[early, ("joints", 500.0, 0.1)]), early.0);
        assert_eq!(of(&[early, ("gyro", 990.0, -0.1)]), early.0);
    }
}
