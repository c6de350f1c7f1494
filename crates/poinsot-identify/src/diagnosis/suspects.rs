//! Candidates that explain the residual, with the meaning of their numbers.

use super::candidates::Candidate;
use super::naming::{name, near};
use super::projected::Projected;
use super::shared_noise::SharedNoise;
use super::table::Table;
use super::types::{FaultKind, Suspect, SuspectValue};
use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::{Fitted, fit_from};
use crate::problem::parameters::{GRADIENT, Unknown, UnknownKind};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use statrs::function::gamma::ln_gamma;

/// Number of candidates that are fitted fully.
const FITTED: usize = 2;
/// Sigmas beyond a physical bound from which a number is impossible.
const IMPOSSIBLE: f64 = 3.0;
/// Share of a decrease of chi-square that counts as equal.
const AS_MUCH: f64 = 0.95;
/// Largest eigenvalue of the tensor of a gravity gradient, 1/s2: `3 gm / r^3` of the Earth at its surface.
const STEEPEST: f64 = 4.6e-6;
/// How many times that a tide may be: a position that drifts otherwise is like one.
const TIDE: f64 = 20.0;
/// Probability above which it is a number with all its digits.
const REPRESENTED: f64 = 1.0e-280;
/// Terms of the tail of a probability below that.
const TERMS: i32 = 6;
/// Iterations of such a fit.
const SUSPECT_ITERATIONS: usize = 12;

/// The misfit, and whether causes may be fitted.
#[derive(Clone, Copy)]
pub(super) struct Misfit {
    /// Chi-square beyond the degrees of freedom, and these.
    pub excess: f64,
    pub dof: f64,
    pub misfit: bool,
    pub affordable: bool,
}

impl Misfit {
    /// Mean square of the residual, at least one.
    pub fn mean_square(&self) -> f64 {
        (1.0 + self.excess / self.dof.max(1.0)).max(1.0)
    }

    /// The same with what explains a part of it taken off.
    fn left(&self, decrease: f64) -> f64 {
        (1.0 + (self.excess - decrease) / self.dof.max(1.0)).max(1.0)
    }
}

/// Significant candidates, the best first. Scores are of first order; where the misfit is large the best few
/// are fitted, because a fault like a wrong sign is far away. The others were scored elsewhere.
pub(super) fn suspects(
    table: &Table,
    projected: &Projected,
    others: Vec<Scored>,
    of: Misfit,
) -> Vec<Suspect> {
    let (experiment, candidates) = (table.experiment, table.candidates);
    let mean_square = of.mean_square();
    let limits = experiment.settings.diagnosis;
    let mut list = scores(candidates, projected, None, mean_square);
    list.extend(others);
    let hypotheses = list.len();
    let significant = |list: &mut Vec<Scored>| {
        let chance = limits.false_alarm / hypotheses.max(1) as f64;
        list.retain(|one| one.is_significant(mean_square, chance) && one.is_possible());
    };
    significant(&mut list);
    // One more evaluation, only where it decides something.
    if list.iter().any(|one| one.at.is_some())
        && let Some(noise) = SharedNoise::new(table)
    {
        list.retain(|one| one.at.is_none());
        list.extend(scores(candidates, projected, Some(&noise), mean_square));
        significant(&mut list);
    }
    rank(&mut list, of);
    if of.misfit && of.affordable {
        let fit = |one: &mut Scored, candidate: &Candidate| {
            if let Some((decrease, values)) = in_earnest(experiment, table.fitted, candidate) {
                one.suspect = suspect(candidate, decrease, &values);
            }
        };
        let candidate = |one: &Scored| one.at.map(|at| &candidates[at]);
        let mut of_columns = list
            .iter_mut()
            .filter_map(|one| Some((candidate(one)?, one)));
        let mut early = false;
        for (candidate, one) in of_columns.by_ref().take(FITTED) {
            fit(one, candidate);
            early |= one.early_s() > 0.0;
        }
        // An early sensor may mean a late input.
        for (candidate, one) in of_columns.filter(|(c, _)| early && c.delays_inputs()) {
            fit(one, candidate);
        }
        significant(&mut list);
        rank(&mut list, of);
        fitted_before_scored(&mut list);
    }
    late_before_early(&mut list, limits.tied_evidence * mean_square);
    let best = list.first().map(|one| one.suspect.decrease);
    let left = of.left(best.unwrap_or(0.0));
    let evidence: Vec<f64> = list.iter().map(|one| one.evidence(left)).collect();
    let all = list.into_iter().zip(&evidence);
    all.map(|(one, own)| {
        let mut s = one.suspect;
        let share = (s.decrease / of.excess).clamp(0.0, 1.0);
        s.explains = if of.misfit { share } else { 0.0 };
        s.tied = evidence[0] - own < limits.tied_evidence;
        name(experiment, &mut s);
        s
    })
    .collect()
}

/// Score of every candidate.
fn scores(
    candidates: &[Candidate],
    projected: &Projected,
    noise: Option<&SharedNoise>,
    mean_square: f64,
) -> Vec<Scored> {
    let mut from = 0;
    let mut list = Vec::new();
    for (at, candidate) in candidates.iter().enumerate() {
        let group: Vec<usize> = (from..from + candidate.unknowns.len()).collect();
        from += group.len();
        let score = match noise {
            Some(noise) => noise.score(projected, &group),
            None => projected.score(&group, None),
        };
        let values = candidate.unknowns.iter().zip(&score.values);
        let values: Vec<f64> = values.map(|(u, v)| u.nominal + v).collect();
        let sigma = |k: usize| (score.covariance[(k, k)] * mean_square).sqrt();
        list.push(Scored {
            at: Some(at),
            suspect: suspect(candidate, score.decrease, &values),
            sigmas: (0..values.len()).map(sigma).collect(),
            nominal: candidate.unknowns.iter().map(|u| u.nominal).collect(),
        });
    }
    list
}

/// The best evidence first, on the scale of the residual that the best leaves.
fn rank(list: &mut [Scored], of: Misfit) {
    let most = list.iter().map(|one| one.suspect.decrease);
    let left = of.left(most.fold(0.0, f64::max));
    list.sort_by(|a, b| b.evidence(left).total_cmp(&a.evidence(left)));
}

/// Where a cause that was fitted explains hardly less than one that was only scored, it comes first: a score is of first
/// order, and of a large misfit too high.
fn fitted_before_scored(list: &mut [Scored]) {
    let Some(first) = list.first().filter(|one| one.at.is_none()) else {
        return;
    };
    let enough = AS_MUCH * first.suspect.decrease;
    let fitted = |one: &Scored| one.at.is_some() && one.suspect.decrease >= enough;
    if let Some(at) = list.iter().position(fitted) {
        list[..=at].rotate_right(1);
    }
}

/// A suspect with the place of its candidate, and how well its numbers are known.
pub(super) struct Scored {
    /// Among the candidates that can be fitted.
    pub at: Option<usize>,
    pub suspect: Suspect,
    /// From the score, with the observed size of the residual.
    pub sigmas: Vec<f64>,
    pub nominal: Vec<f64>,
}

impl Scored {
    /// One that was scored by itself, without a candidate.
    pub fn alone(suspect: Suspect) -> Self {
        Self {
            at: None,
            suspect,
            sigmas: Vec::new(),
            nominal: Vec::new(),
        }
    }

    /// Evidence for the fault, in units of -2 ln L: how rarely chance lowers a residual of this scale as much with as many
    /// numbers, tried as often.
    fn evidence(&self, scale: f64) -> f64 {
        let numbers = self.suspect.numbers.max(1) as f64;
        let tried = self.suspect.times.max(1) as f64;
        -2.0 * (ln_chance(self.suspect.decrease / scale, numbers) + tried.ln())
    }

    /// Whether chance explains it more rarely than allowed.
    pub fn is_significant(&self, mean_square: f64, chance: f64) -> bool {
        self.evidence(mean_square) > -2.0 * chance.ln()
    }

    /// Whether the numbers are physical: drag does not accelerate, and a rotor's inertia is positive unless its sign is
    /// wrong.
    fn is_possible(&self) -> bool {
        let values = self.suspect.values.iter().map(|v| v.value);
        let value = |k: usize| self.suspect.values.get(k).map_or(0.0, |v| v.value);
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
            // A tensor without a trace whose eigenvalues are below that bound has elements below it. Where they are known far
            // worse than it, none below it explains what these do.
            fault @ (FaultKind::GravityGradient | FaultKind::Tide) => {
                let most = match fault {
                    FaultKind::Tide => TIDE * STEEPEST,
                    _ => STEEPEST,
                };
                let mut each = values.zip(&self.sigmas).take(GRADIENT);
                each.all(|(x, sigma)| x.abs() < most + IMPOSSIBLE * sigma.min(most))
            }
            FaultKind::KnownNumber => {
                let mut each = self.suspect.values.iter();
                each.all(|v| v.unit != "kg" || v.value > 0.0)
            }
            // Mass is lost, not gained.
            FaultKind::PropellantUse => value(0) > -IMPOSSIBLE * sigma(0),
            FaultKind::Thrust => near(value(0), -2.0) || value(0) > -1.0 - IMPOSSIBLE * sigma(0),
            _ => true,
        }
    }

    /// How early a sensor would have to read, s: a sensor cannot measure the future. Thrust samples may be late, so
    /// that the thrust acts before its column.
    fn early_s(&self) -> f64 {
        match (self.suspect.fault, self.suspect.first()) {
            (FaultKind::Lag, Some((UnknownKind::ThrusterLag(_), _))) => 0.0,
            (FaultKind::Lag, Some((_, lag))) => (-lag).max(0.0),
            _ => 0.0,
        }
    }
}

/// Where one sensor reading early explains hardly more than something that is possible, that one is named first.
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
    let pairs = candidate.unknowns.iter().zip(values);
    let value = |(u, v): (&Unknown, &f64)| SuspectValue {
        name: u.name.clone(),
        value: *v,
        unit: u.unit,
        kind: Some(u.kind.clone()),
    };
    let values = pairs.map(value).collect();
    Suspect::new(candidate.name.clone(), candidate.fault, decrease, values)
}

/// The fit with this candidate unknown: decrease of chi-square, and values.
fn in_earnest(
    experiment: &Experiment,
    fitted: &Fitted,
    candidate: &Candidate,
) -> Option<(f64, Vec<f64>)> {
    // What has columns only has a score that is exact enough.
    if candidate
        .unknowns
        .iter()
        .any(|u| u.kind.is_only_tested() || matches!(u.kind, UnknownKind::InertialTorque(_)))
    {
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
    let start = Iterate {
        x,
        initial_states: fitted.at.initial_states.clone(),
    };
    let before = experiment.chi2(&fitted.at, &fitted.evaluated)?;
    let found = fit_from(&wide, start, SUSPECT_ITERATIONS)?;
    let after = wide.chi2(&found.at, &found.evaluated)?;
    let values = found.at.x.get(at..at + candidate.unknowns.len())?.to_vec();
    Some((before - after, values))
}

/// Logarithm of the probability that a chi-square with so many degrees of freedom exceeds a value; zero where it is no number.
fn ln_chance(chi2: f64, dof: f64) -> f64 {
    let Ok(distribution) = ChiSquared::new(dof) else {
        return 0.0;
    };
    if chi2.is_nan() || chi2 <= 0.0 {
        return 0.0;
    }
    let chance = distribution.sf(chi2);
    if chance > REPRESENTED {
        return chance.ln();
    }
    // The tail far out (Abramowitz and Stegun 1964, 6.5.32).
    let (a, x) = (0.5 * dof, 0.5 * chi2);
    let terms = (1..TERMS).scan(1.0, |term, k| {
        *term *= (a - f64::from(k)) / x;
        Some(*term)
    });
    (a - 1.0) * x.ln() - x - ln_gamma(a) + (1.0 + terms.sum::<f64>()).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_the_tail_of_chi_square() {
        // Two degrees of freedom: exp(-x / 2). Four: exp(-x / 2) (1 + x / 2).
        for chi2 in [1.0_f64, 30.0, 1.0e3, 1.3e3, 1.4e3, 1.0e6] {
            let half = 0.5 * chi2;
            assert!((ln_chance(chi2, 2.0) + half).abs() < 1.0e-9 * half);
            assert!((ln_chance(chi2, 4.0) + half - half.ln_1p()).abs() < 1.0e-9 * half);
        }
        assert!(ln_chance(f64::NAN, 3.0) == 0.0 && ln_chance(-1.0, 3.0) == 0.0);
    }

    #[test]
    fn regress_a_suspect_whose_fit_lowers_nothing_is_none() {
        let with = |decrease: f64| scored("drag", FaultKind::Drag, decrease, &[1.0]);
        let named = |decrease: f64| with(decrease).is_significant(1.0, 1.0e-4);
        assert!(named(500.0) && !named(-0.3) && !named(f64::NAN));
    }

    fn number(value: f64) -> SuspectValue {
        SuspectValue::other(String::new(), value, "")
    }

    fn scored(name: &str, fault: FaultKind, decrease: f64, values: &[f64]) -> Scored {
        let numbers = values.iter().map(|v| number(*v)).collect();
        Scored {
            at: None,
            suspect: Suspect::new(name.to_owned(), fault, decrease, numbers),
            sigmas: vec![0.1; values.len()],
            nominal: vec![1.0; values.len()],
        }
    }

    #[test]
    fn unit_drag_that_pushes_is_no_suspect() {
        let possible = |c: [f64; 3]| scored("drag", FaultKind::Drag, 1.0e3, &c).is_possible();
        assert!(possible([1.0, 0.0, 2.0]));
        // Zero-mean noise.
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
        let of = |list: &[(&str, UnknownKind, f64, f64)]| {
            let one = |(name, kind, decrease, lag): &(&str, UnknownKind, f64, f64)| {
                let mut one = scored(name, FaultKind::Lag, *decrease, &[*lag]);
                one.suspect.values[0].kind = Some(kind.clone());
                one
            };
            let mut list: Vec<Scored> = list.iter().map(one).collect();
            late_before_early(&mut list, 40.0);
            list[0].suspect.name.clone()
        };
        let sensor = |sensor: usize| UnknownKind::Sensor {
            sensor,
            error: poinsot_dynamics::SensorError::Lag,
        };
        let joints = |decrease: f64| ("joints", UnknownKind::JointLag(vec![0]), decrease, 0.1);
        let early = || ("attitude", sensor(0), 1000.0, -0.09);
        assert_eq!(of(&[early(), joints(970.0)]), "joints");
        let thrust = ("thrust", UnknownKind::ThrusterLag(vec![0]), 970.0, -0.1);
        assert_eq!(of(&[early(), thrust]), "thrust");
        assert_eq!(of(&[early(), joints(500.0)]), "attitude");
        assert_eq!(of(&[early(), ("gyro", sensor(1), 990.0, -0.1)]), "attitude");
    }
}
