//! Repairs of the map that checks and diagnosis propose: each is tried before it is advised, and applied where that is asked for.

use super::Identified;
use crate::channel_names::{names, of_all};
use crate::error::Error;
use poinsot_identify::refusal::NO_MOTION;
use poinsot_identify::{BodyEstimate, Effect, Estimate, Remark, RemarkKind, Settings};
use poinsot_model::{Model, SensorKind, TelemetryMap};
use poinsot_telemetry::checks::{self, Finding, Policy};
use poinsot_telemetry::{Change, ConventionTest, Line, Repair, UNIT_FACTORS};
use statrs::function::erf::erfc;

/// Most repairs of a record, each of which is read again.
const ROUNDS: usize = 8;
/// Most ways that are tried of one refusal.
const WAYS: usize = 3;
/// Rate of a low orbit, rad/s.
const ORBIT_RAD_S: f64 = 1.1e-3;
/// Chance that a record in inertial axes drifts as much, and that another frame lowers its `-2 ln L` by as much. Both frames together:
/// the difference of `-2 ln L` of two declarations is normal, its mean `-d` and variance `4 d`, so that it exceeds `b` at most as
/// often as a normal number does `sqrt(b)`, whatever `d`.
const CHANCE: f64 = 0.01;

/// Why records are refused, and what would put them right.
pub(crate) struct Refusal {
    pub error: Error,
    /// The channels; empty where only a fit tells whether a line of a map helps.
    of: String,
    /// Repairs, the likeliest first.
    ways: Vec<Vec<Repair>>,
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self {
            error,
            of: String::new(),
            ways: Vec::new(),
        }
    }
}

impl From<ConventionTest> for Refusal {
    fn from(found: ConventionTest) -> Self {
        Self {
            error: found.fault(),
            of: found.between.join(" "),
            ways: found.ways().into_iter().take(WAYS).collect(),
        }
    }
}

impl Refusal {
    /// That of the first finding whose policy is to refuse; all findings of its check are put right together.
    pub fn of_findings(label: &str, all: &[Finding]) -> Result<(), Self> {
        let Some(finding) = all.iter().find(|f| f.policy == Policy::Refuse) else {
            return Ok(());
        };
        let own = all.iter().filter(|f| f.check == finding.check);
        let repairs: Vec<Repair> = own.filter_map(|f| f.repair.clone()).collect();
        Err(Self {
            error: checks::refused(label, finding),
            of: finding.check.name().to_owned(),
            ways: finding.repair.iter().map(|_| repairs.clone()).collect(),
        })
    }

    /// That of a fit; where no motion is predicted, a wheel, a joint or all thrusters may be in another unit.
    pub fn of_fit(error: Error, model: &Model) -> Self {
        if error.code() != NO_MOTION {
            return Self::from(error);
        }
        let of = |kind, k| names(model, kind, &[k]);
        let has_rates = model.sensors_of(SensorKind::JointRate).next().is_some();
        let kinds = [SensorKind::JointPosition, SensorKind::JointRate];
        let kinds = &kinds[..1 + usize::from(has_rates)];
        let wheels = (0..model.wheels.len()).map(|k| of(SensorKind::WheelSpeed, k));
        let joints = 0..model.joints.len();
        let joints = joints.map(|k| kinds.iter().flat_map(|kind| of(*kind, k)).collect());
        let turns = wheels.chain(joints).flat_map(|own: Vec<String>| {
            let factors = UNIT_FACTORS[..2].iter();
            factors.map(move |x| (own.clone(), *x))
        });
        let forces = of_all(model, SensorKind::Thrust);
        let forces = (!forces.is_empty()).then_some((forces, 1.0e-3));
        let ways = turns.chain(forces).map(|(channels, x)| {
            let change = Change::Factor(x);
            vec![Repair { channels, change }]
        });
        Self {
            ways: ways.collect(),
            ..Self::from(error)
        }
    }

    /// The ways after which the gate has nothing against these channels.
    pub fn passing(
        &self,
        map: &TelemetryMap,
        gate: impl Fn(&TelemetryMap) -> Result<(), Self>,
    ) -> impl Iterator<Item = Declared> {
        let declared = self.ways.iter().filter_map(|way| Declared::of(map, way));
        let other = |other: Self| !other.of.is_empty() && other.of != self.of;
        declared.filter(move |declared| gate(&declared.map).map_or_else(other, |()| true))
    }

    /// Advises lines that were tried.
    fn advise(&mut self, lines: &[Line]) {
        let mut changed: Vec<&str> = lines.iter().map(|line| line.changed.as_str()).collect();
        changed.dedup();
        let write = match changed[..] {
            [all] if !self.of.is_empty() => all.to_owned(),
            _ => {
                let each = lines
                    .iter()
                    .map(|line| format!("{}: {}", line.key, line.changed));
                each.collect::<Vec<_>>().join("; ")
            }
        };
        for fault in &mut self.error.list {
            let others = fault.advice.strip_prefix("correct it, or ");
            let others = others.map_or(String::new(), |others| format!(", or {others}"));
            fault.advice = format!("write {write}, or --repair{others}");
        }
    }
}

/// A map with a repair in it.
pub(crate) struct Declared {
    pub map: TelemetryMap,
    pub lines: Vec<Line>,
}

impl Declared {
    /// `None` where a change has no line.
    fn of(map: &TelemetryMap, way: &[Repair]) -> Option<Self> {
        let mut map = map.clone();
        let lines = way.iter().map(|repair| repair.declare(&mut map));
        let lines = lines.collect::<Option<Vec<_>>>()?.concat();
        Some(Self { map, lines })
    }
}

fn with_map(model: &Model, map: &TelemetryMap) -> Model {
    Model {
        telemetry: map.clone(),
        ..model.clone()
    }
}

/// Answers a question. Where the records are refused, or what the diagnosis found is a convention of their columns, the map is
/// repaired and the question asked again if `apply` says so; otherwise a repair that passes the gate becomes advice.
pub(crate) fn answered(
    mut model: Model,
    apply: bool,
    ask: impl Fn(&Model) -> Result<Identified, Refusal>,
    gate: impl Fn(&Model) -> Result<(), Refusal>,
) -> Result<Identified, Error> {
    let mut assumed: Vec<String> = Vec::new();
    let mut found = ask(&model);
    for _ in 0..ROUNDS {
        let by_fit = matches!(&found, Err(refusal) if refusal.of.is_empty());
        // Each of many is a fit: only where it is asked for.
        if by_fit && !apply {
            break;
        }
        let mut ways = match &found {
            Err(refusal) => {
                let pass = |map: &TelemetryMap| gate(&with_map(&model, map));
                refusal.passing(&model.telemetry, pass).collect()
            }
            Ok(identified) if apply && !identified.passes() => {
                let found = identified.findings.iter().filter_map(|f| f.repair.as_ref());
                let all = cause(&identified.estimate).into_iter().chain(found);
                let declared = |way| Declared::of(&model.telemetry, std::slice::from_ref(way));
                all.filter_map(declared).collect()
            }
            Ok(_) => Vec::new(),
        };
        // Of two channels that contradict each other, only the motion of the vehicle tells which is wrong.
        if by_fit || apply && ways.len() > 1 {
            let trusted =
                |way: &Declared| ask(&with_map(&model, &way.map)).is_ok_and(|i| i.passes());
            let at = ways.iter().position(trusted);
            if by_fit && at.is_none() {
                break;
            }
            ways.swap(0, at.unwrap_or(0));
        }
        let Some(declared) = ways.into_iter().next() else {
            break;
        };
        if let (false, Err(refusal)) = (apply, &mut found) {
            refusal.advise(&declared.lines);
            break;
        }
        let mut lines = declared.lines.iter();
        if lines.all(|line| assumed.contains(&line.text)) {
            break;
        }
        let repaired = with_map(&model, &declared.map);
        let next = ask(&repaired);
        // What the fit proposed and the records refuse is no repair.
        if next.is_err() && found.is_ok() {
            break;
        }
        (model, found) = (repaired, next);
        assumed.extend(declared.lines.into_iter().map(|line| line.text));
    }
    let lines = || {
        assumed
            .iter()
            .map(|line| format!("assumed by --repair: {line}"))
    };
    let mut identified = found.map_err(|mut refusal| {
        for fault in &mut refusal.error.list {
            fault
                .problem
                .extend(lines().map(|line| format!(" ({line})")));
        }
        refusal.error
    })?;
    let repairs = lines().map(|line| Remark::new(RemarkKind::Repair, line));
    identified.estimate.add_all(repairs);
    doubt_frame(&mut identified, &model, ask);
    Ok(identified)
}

/// The convention that explains a misfit.
fn cause(estimate: &Estimate) -> Option<&Repair> {
    let found = estimate.diagnostics.as_ref()?;
    found.suspects.first()?.repair.as_ref()
}

/// Doubts an answer that is trusted where the momentum drifts as it would in orbital axes, and would be another in them.
fn doubt_frame(
    identified: &mut Identified,
    model: &Model,
    ask: impl Fn(&Model) -> Result<Identified, Refusal>,
) {
    let estimate = &identified.estimate;
    let Some(found) = estimate
        .diagnostics
        .as_ref()
        .filter(|_| identified.passes())
    else {
        return;
    };
    let mut drifts = found.drift.iter().filter(|d| d.segment.is_none());
    if !drifts.any(|d| d.p.is_some_and(|p| p < CHANCE)) {
        return;
    }
    let of = |rate: f64| {
        let frame = Repair::of("", Change::OrbitalAxes(rate, true));
        let declared = Declared::of(&model.telemetry, &[frame])?;
        let other = ask(&with_map(model, &declared.map)).ok()?.estimate;
        let better = found.deviance - other.diagnostics.as_ref()?.deviance;
        let moved = apart(estimate, &other);
        let likelier = erfc((0.5 * better.max(0.0)).sqrt()) < CHANCE;
        let sensitive = moved > Settings::default().sensitivity_sigmas;
        (likelier && sensitive).then(|| (declared.lines[0].text.clone(), better, moved))
    };
    let Some((line, better, moved)) = [ORBIT_RAD_S, -ORBIT_RAD_S].into_iter().find_map(of) else {
        return;
    };
    let words = format!(
        "attitudes and rates may be relative to a frame that turns, as the orbital one does: with {line} the answer moves by {moved:.1} sigma, and -2 ln L falls by {better:.1}; say which axes the attitude refers to"
    );
    let row = Remark::test("axes of the attitude", Effect::AgainstAnswer, words.clone());
    let row = row.statistic("change of the estimate, sigma", moved);
    identified.estimate.add(row);
    identified.estimate.add(Remark::warning(words));
}

/// Largest difference of a mass property of two answers, in sigmas of the first.
fn apart(estimate: &Estimate, other: &Estimate) -> f64 {
    let of_body = |b: &BodyEstimate| [std::slice::from_ref(&b.mass), &b.com, &b.inertia].concat();
    let [own, others] = [estimate, other].map(|e| e.bodies.iter().flat_map(of_body));
    let pairs = own.zip(others);
    let apart = pairs.filter_map(|(a, b)| Some((a.value? - b.value?).abs() / a.sigma?));
    apart.fold(0.0, f64::max)
}
