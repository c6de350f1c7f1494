//! What single change would close an open direction: tried, not guessed.
//!
//! To what the experiment tells already comes one record more, with a sensor, a thrust, a momentum or a motion that
//! it does not have, or one number that is given. The information of both together is decomposed again, and a
//! direction counts as closed where it lies in what is then identified. Nothing is simulated: information needs
//! the predicted motion and the noise, and no readings.

use crate::estimate::OpenCombination;
use crate::information::Experiment;
use crate::input_curves::InputCurves;
use crate::likelihood::{Head, HeadColumns, Setting, Sight, evaluate};
use crate::loss::Loss;
use crate::parameters::{Equations, Parameters, UnknownKind, axis_name};
use crate::problem::Problem;
use crate::quantity::TenParameters;
use crate::segment::{Firing, Noise, Observations, Segment, SensorRecord, SensorValue};
use crate::solved::{Shared, Solved};
use poinsot_dynamics::{Kinematics, composite};
use poinsot_model::{EstimateSet, SensorKind, Thruster};
use poinsot_solve::{BlockQr, Spectrum};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};

/// Samples of a record that is tried, and its longest duration, s; their noise is scaled to that of the record at
/// hand over the same time.
const SAMPLES: usize = 40;
const SPAN: f64 = 120.0;
/// Share of a direction's square that must be identified for it to count as closed.
const CLOSED: f64 = 0.99;
/// Noise of the velocity sensor tried, m/s.
const VELOCITY: f64 = 1.0e-3;
/// Noise of the accelerometer tried, m/s2.
const ACCELERATION: f64 = 1.0e-4;
/// Least rate that is tried about an axis, rad/s.
const RATE: f64 = 0.05;
/// Size of a joint's motion that is tried, rad or m, and its turns in the record.
const SWING: (f64, f64) = (0.3, 3.0);
/// Most joints that are swung, those next to the base first: the time of all grows with the square of a chain.
const JOINTS: usize = 32;
/// Largest force that is tried, N, its arm, m, and the share of the record that it lasts.
const PUSH: (f64, f64, f64) = (1.0, 0.5, 0.1);
/// Accuracy of a number that is given, natural units.
const GIVEN: f64 = 1.0e-3;
/// Most changes named for one direction.
const NAMED: usize = 2;

/// A row of information: over all unknowns in the order of the parameters.
type Row = Vec<f64>;

/// One change.
struct Change {
    text: String,
    /// Whether a number is given, rather than something measured or moved.
    given: bool,
    rows: Vec<Row>,
}

/// What one change does.
struct Effect {
    text: String,
    given: bool,
    /// Per open direction: the share identified, and the one sigma of what is, natural units.
    seen: Vec<(f64, f64)>,
}

impl Effect {
    fn closed(&self) -> usize {
        self.seen
            .iter()
            .filter(|(share, _)| *share > CLOSED)
            .count()
    }
}

/// Puts what was tried in the place of each remedy. Open directions keep theirs where nothing can be tried: the
/// answer was withheld, or priors hold what the data leave open.
pub(crate) fn try_changes(problem: &Problem, solved: &Solved, open: &mut [OpenCombination]) {
    let tried = matches!(solved.method, "maximum_likelihood" | "cramer_rao")
        && solved.data_alone.is_none()
        && solved.settled
        && !open.is_empty();
    let Some(effects) = tried.then(|| effects(problem, solved, open)).flatten() else {
        return;
    };
    for (k, direction) in open.iter_mut().enumerate() {
        if let Some(text) = sentence(&effects, k, open_count(&effects)) {
            direction.remedy = text;
        }
    }
}

fn open_count(effects: &[Effect]) -> usize {
    effects.first().map_or(0, |e| e.seen.len())
}

/// The best changes for one direction in words.
fn sentence(effects: &[Effect], k: usize, all: usize) -> Option<String> {
    let mut closing: Vec<&Effect> = effects.iter().filter(|e| e.seen[k].0 > CLOSED).collect();
    // What is measured or moved before what is given; then what closes most; then the better.
    closing.sort_by(|a, b| {
        (a.given, b.closed())
            .cmp(&(b.given, a.closed()))
            .then(a.seen[k].1.total_cmp(&b.seen[k].1))
    });
    let named: Vec<String> = closing
        .iter()
        .take(NAMED)
        .map(|e| {
            format!(
                "{} (tried: then known to {} of nominal, one sigma; closes {} of {all})",
                e.text,
                percent(e.seen[k].1),
                e.closed()
            )
        })
        .collect();
    if !named.is_empty() {
        return Some(named.join("; or "));
    }
    let best = effects
        .iter()
        .max_by(|a, b| a.seen[k].0.total_cmp(&b.seen[k].0))?;
    let others = effects.iter().filter(|e| !e.given).count();
    Some(if best.seen[k].0 > 0.05 {
        format!(
            "no single change of the {} tried closes it; most shows: {} ({:.0} % of it)",
            effects.len(),
            best.text,
            100.0 * best.seen[k].0
        )
    } else {
        format!(
            "no single change of the {} tried closes it: {others} sensors, thrusts and motions, and numbers given",
            effects.len()
        )
    })
}

fn percent(sigma: f64) -> String {
    let p = 100.0 * sigma;
    let decimals = (1.0 - p.abs().max(1.0e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{p:.decimals$} %")
}

fn effects(problem: &Problem, solved: &Solved, open: &[OpenCombination]) -> Option<Vec<Effect>> {
    let ground = Ground::new(problem, solved)?;
    let directions: Vec<Vec<f64>> = open.iter().map(|o| ground.direction(o)).collect();
    let changes = ground.changes();
    let list: Vec<Effect> = changes
        .into_iter()
        .filter_map(|change| {
            let spectrum = ground.spectrum(&change.rows)?;
            Some(Effect {
                seen: directions.iter().map(|z| seen(&spectrum, z)).collect(),
                text: change.text,
                given: change.given,
            })
        })
        .collect();
    (!list.is_empty()).then_some(list)
}

/// Share of a direction, by squares, that a spectrum identifies, and the one sigma of that part.
fn seen(spectrum: &Spectrum, z: &[f64]) -> (f64, f64) {
    let (mut share, mut variance) = (0.0, 0.0);
    for k in 0..spectrum.rank {
        let along: f64 = z
            .iter()
            .enumerate()
            .map(|(i, x)| x * spectrum.directions[(i, k)])
            .sum();
        share += along * along;
        variance += (along / spectrum.singular[k]).powi(2);
    }
    (share, variance.sqrt())
}

/// What the experiment tells already, in barycentric unknowns.
struct Ground<'a> {
    problem: &'a Problem<'a>,
    parameters: Parameters,
    x: Vec<f64>,
    rows: Vec<Row>,
    mass: usize,
    head: Head,
    sight: Sight,
    wheels_smooth: bool,
    spin: Vec<f64>,
}

impl<'a> Ground<'a> {
    fn new(problem: &'a Problem<'a>, solved: &Solved) -> Option<Self> {
        let own = &solved.parameters;
        let rotation = own.equations == Equations::Rotation;
        let parameters = if rotation {
            Parameters::new(problem.model, problem.tree, Equations::Momentum, true).ok()?
        } else {
            own.clone()
        };
        let x = match rotation {
            true => crate::maximum_likelihood::lifted_vector(own, &solved.x, &parameters),
            false => solved.x.clone(),
        };
        let mass = parameters
            .unknowns
            .iter()
            .filter(|u| !u.kind.is_nuisance())
            .count();
        let experiment = Experiment::new(problem, own);
        let head = experiment.point(solved).heads.first().copied()?;
        Some(Self {
            rows: known_rows(solved, &parameters, &x),
            spin: experiment.nominal_spin.clone(),
            sight: experiment.sight,
            wheels_smooth: solved.wheels_smooth,
            problem,
            parameters,
            x,
            mass,
            head,
        })
    }

    /// An open direction as a unit vector in natural units.
    fn direction(&self, open: &OpenCombination) -> Vec<f64> {
        let mut z = vec![0.0; self.mass];
        for (name, coefficient) in &open.coefficients {
            let at = |name: &str| {
                let unknowns = self.parameters.unknowns[..self.mass].iter();
                unknowns.clone().position(|u| u.name == name)
            };
            // About the mass centre and about the origin a tensor changes alike, the mass centre held.
            let found = at(name).or_else(|| at(&name.replace("I_BBcm", "I_BBo")));
            if let Some(u) = found {
                z[u] += coefficient / self.parameters.unknowns[u].natural;
            }
        }
        let length = z.iter().map(|x| x * x).sum::<f64>().sqrt();
        z.iter()
            .map(|x| x / length.max(f64::MIN_POSITIVE))
            .collect()
    }

    fn spectrum(&self, more: &[Row]) -> Option<Spectrum> {
        let n = self.parameters.len();
        let mut stacked = BlockQr::new(n + 1);
        let all: Vec<&Row> = self.rows.iter().chain(more).collect();
        stacked.push(all.len(), |i, j| all[i].get(j).copied().unwrap_or(0.0));
        let triangle = stacked.finish();
        let natural: Vec<f64> = self.parameters.unknowns[..self.mass]
            .iter()
            .map(|u| u.natural)
            .collect();
        let size = (0..self.mass)
            .map(|j| {
                let square: f64 = (0..=j).map(|i| triangle.r[(i, j)].powi(2)).sum();
                square.sqrt() * natural[j]
            })
            .fold(0.0, f64::max);
        let shared = Shared::new(&self.parameters, &triangle);
        Spectrum::new(
            &shared.block(),
            &natural,
            &vec![0.0; self.mass * self.mass],
            size,
            self.problem.relative_accuracy,
        )
        .ok()
    }

    fn changes(&self) -> Vec<Change> {
        let mut list = self.records().unwrap_or_default();
        for (body, set) in self.parameters.estimate.iter().enumerate() {
            list.extend(self.given(body, *set));
        }
        list
    }

    /// Mass, mass centre or inertia of a body, given.
    fn given(&self, body: usize, set: EstimateSet) -> Vec<Change> {
        let ten = TenParameters::of_body(&self.parameters, body, &self.x);
        let (m, l) = self.parameters.natural[body];
        let name = &self.parameters.body_names[body];
        let row = |gradient: Vec<f64>, sigma: f64| -> Row {
            gradient.iter().map(|g| g / sigma).collect()
        };
        let mut list = Vec::new();
        let mut add = |what: &str, rows: Vec<Row>| {
            list.push(Change {
                text: format!("give {what} of {name} as known, to {}", percent(GIVEN)),
                given: true,
                rows,
            });
        };
        if set.mass {
            add("the mass", vec![row(ten.parameter(0).gradient, GIVEN * m)]);
        }
        if set.com {
            let rows = (0..3).map(|k| row(ten.mass_centre(k).gradient, GIVEN * l));
            add("the mass centre", rows.collect());
        }
        if set.inertia {
            let rows = (0..6).map(|k| row(ten.central_inertia(k).gradient, GIVEN * m * l * l));
            add("the inertia", rows.collect());
        }
        list
    }

    /// Records with a sensor, a thrust, a momentum or a motion that is missing; `None` without a record to start
    /// from.
    fn records(&self) -> Option<Vec<Change>> {
        let from = self.problem.segments.first()?;
        let (base, share) = thinned(from, self.sight, self.problem.noise)?;
        let trial = Trial {
            segment: base,
            noise: self.problem.noise.clone(),
            head: self.head,
            sight: self.sight,
            known_momentum: false,
            thrusters: self.problem.model.thrusters.clone(),
        };
        let mut list = Vec::new();
        let mut add = |text: String, trial: &Trial| {
            if let Some(rows) = self.rows_of(trial) {
                list.push(Change {
                    text,
                    given: false,
                    rows,
                });
            }
        };
        self.turns(&trial, &mut add);
        self.joints(&trial, &mut add);
        self.sensors(&trial, share, &mut add);
        self.pushes(&trial, &mut add);
        let mut known = trial;
        known.known_momentum = true;
        add(
            "know the angular momentum at the start of a record".to_owned(),
            &known,
        );
        Some(list)
    }

    /// The base turns about one of its axes besides.
    fn turns(&self, trial: &Trial, add: &mut impl FnMut(String, &Trial)) {
        let tree = self.problem.tree;
        let mut kinematics = Kinematics::new(tree);
        let joints = &trial.segment.observations.joint_position;
        kinematics.place(tree, joints.get(..tree.dof()).unwrap_or(&[]));
        let I = composite(&self.parameters.bodies(&self.x), &kinematics).I_SScm_B();
        let fastest = self.problem.segments[0]
            .samples
            .w_NB_B
            .iter()
            .map(|w| w.norm())
            .fold(RATE, f64::max);
        for axis in 0..3 {
            let mut w = Vector3::zeros();
            w[axis] = fastest;
            let mut turning = trial.clone();
            turning.head.h_SScm_N += trial.head.R_NB * (I * w);
            let text = format!(
                "record {:.0} s more with the base turning about its {} axis too, at {fastest:.2} rad/s",
                trial.span(),
                axis_name(axis)
            );
            add(text, &turning);
        }
    }

    /// A joint that swings.
    fn joints(&self, trial: &Trial, add: &mut impl FnMut(String, &Trial)) {
        let tree = self.problem.tree;
        let dof = tree.dof();
        let (size, turns) = SWING;
        for (joint, at) in tree.coordinates.iter().enumerate().take(JOINTS) {
            let mut moving = trial.clone();
            let o = &mut moving.segment.observations;
            let span = o.time_s.last().copied().unwrap_or(1.0) - o.time_s[0];
            let pace = std::f64::consts::TAU * turns / span;
            for (k, t) in o.time_s.iter().enumerate() {
                let angle = pace * (t - o.time_s[0]);
                o.joint_position[k * dof + joint] += size * angle.sin();
                o.joint_rate[k * dof + joint] += size * pace * angle.cos();
            }
            let joint = &self.problem.model.joints[*at];
            let unit = match joint.kind {
                poinsot_model::JointKind::Prismatic => "m",
                _ => "rad",
            };
            let text = format!(
                "record {:.0} s more with {} swinging by {size} {unit}",
                trial.span(),
                joint.name
            );
            add(text, &moving);
        }
    }

    /// A velocity sensor or an accelerometer on the base.
    fn sensors(&self, trial: &Trial, share: f64, add: &mut impl FnMut(String, &Trial)) {
        let samples = trial.segment.observations.time_s.len();
        if self.sight == Sight::Rotation {
            let mut with = trial.clone();
            with.sight = Sight::Translation;
            let o = &mut with.segment.observations;
            let sigma = VELOCITY * share.sqrt();
            o.sensors.push(tried(SensorKind::Velocity, samples, sigma));
            add(
                format!("add a velocity sensor of {VELOCITY} m/s, as fast as the gyro"),
                &with,
            );
        }
        if !self.problem.sees_points() {
            let mut with = trial.clone();
            let o = &mut with.segment.observations;
            let sigma = ACCELERATION * share.sqrt();
            o.sensors
                .push(tried(SensorKind::Accelerometer, samples, sigma));
            add(
                format!(
                    "add an accelerometer of {ACCELERATION:.0e} m/s2 at the origin of the base, as fast as the gyro"
                ),
                &with,
            );
        }
    }

    /// A known force: of every thruster that does not fire, or of one that the vehicle does not have.
    fn pushes(&self, trial: &Trial, add: &mut impl FnMut(String, &Trial)) {
        let (most, arm, share) = PUSH;
        let o = &trial.segment.observations;
        let start_s = o.time_s[0];
        let lasting = (trial.span() * share).max(f64::MIN_POSITIVE);
        // No more than turns the base at the rate that is tried about its axes.
        let kinematics = Kinematics::new(self.problem.tree);
        let I = composite(&self.parameters.bodies(&self.x), &kinematics).I_SScm_B();
        let force = (RATE * I.trace() / 3.0 / (arm * lasting)).clamp(1.0e-6, most);
        // Edges on the grid.
        let last = ((o.time_s.len() as f64 * share).ceil() as usize).min(o.time_s.len() - 1);
        let mut push = |thruster: usize, trial: &Trial, text: String| {
            let mut with = trial.clone();
            with.segment.firings = vec![Firing {
                thruster,
                start_s,
                end_s: trial.segment.observations.time_s[last],
                force,
            }];
            let lasting = trial.segment.observations.time_s[last] - start_s;
            add(
                format!("{text}, {force:.1e} N for {lasting:.1} s, of known force"),
                &with,
            );
        };
        let fires = |k: usize| {
            let firings = self.problem.segments.iter().flat_map(|s| &s.firings);
            firings.into_iter().any(|f| f.thruster == k)
        };
        for (k, thruster) in trial
            .thrusters
            .iter()
            .enumerate()
            .filter(|(k, _)| !fires(*k))
        {
            push(k, trial, format!("fire {}", thruster.name));
        }
        if trial.thrusters.is_empty() {
            let mut with = trial.clone();
            with.thrusters.push(Thruster {
                name: String::new(),
                body: 0,
                p_BoT_B: Vector3::new(arm, 0.0, 0.0),
                direction_B: Vector3::y(),
                scale: Default::default(),
            });
            push(
                0,
                &with,
                format!("push the base along y, {arm} m from its origin along x"),
            );
        }
    }

    /// Information of a record over the shared unknowns, its own start projected out.
    fn rows_of(&self, trial: &Trial) -> Option<Vec<Row>> {
        let seen = trial.sight == Sight::Translation;
        let o = &trial.segment.observations;
        let unknown = HeadColumns {
            attitude: o.reads(SensorKind::Attitude)
                && !o.of_kind(SensorKind::Attitude).any(SensorRecord::is_exact),
            position: false,
            linear: seen,
            angular: !trial.known_momentum,
        };
        let late = self
            .parameters
            .unknowns
            .iter()
            .any(|u| u.kind.delays_inputs());
        // A record of its own: of the others nothing is asked.
        let index = self.problem.segments.len();
        let mut curves = vec![InputCurves::default(); index];
        if late {
            curves.push(InputCurves::new(o, &trial.noise));
        }
        let setting = Setting {
            tree: self.problem.tree,
            thrusters: &trial.thrusters,
            parameters: &self.parameters,
            nominal_spin: &self.spin,
            noise: &trial.noise,
            loss: Loss::Gaussian,
            wheels_smooth: self.wheels_smooth,
            random_torque: self.problem.model.environment.random_torque,
            curves: &curves,
            grids: &[],
            factor: 1,
            bends: false,
            keep_rows: false,
            split: false,
        };
        let evaluated = evaluate(
            &setting,
            (index, &trial.segment),
            &self.x,
            &trial.head,
            unknown,
            true,
        )?;
        let triangle = evaluated.triangle?;
        let h = unknown.count();
        let n = self.parameters.len();
        let rows = (h..h + n).map(|i| (0..n).map(|j| triangle.r[(i, h + j)]).collect());
        Some(rows.collect())
    }
}

/// A record that is tried.
#[derive(Clone)]
struct Trial {
    segment: Segment,
    noise: Noise,
    head: Head,
    sight: Sight,
    known_momentum: bool,
    thrusters: Vec<Thruster>,
}

impl Trial {
    /// Duration, s.
    fn span(&self) -> f64 {
        let t = &self.segment.observations.time_s;
        t.last().copied().unwrap_or(0.0) - t.first().copied().unwrap_or(0.0)
    }
}

/// The rows of a solved problem over the unknowns given, barycentric for those of a rotation alone.
fn known_rows(solved: &Solved, parameters: &Parameters, x: &[f64]) -> Vec<Row> {
    let own = &solved.parameters;
    let n = own.len();
    let (front, back): (Vec<usize>, Vec<usize>) =
        (0..n).partition(|k| own.unknowns[*k].kind.is_nuisance());
    let order: Vec<usize> = front.into_iter().chain(back).collect();
    // Gradient of each of the own unknowns over those wanted.
    let ten = TenParameters::of_body(parameters, 0, x);
    let width = parameters.len();
    let gradients: Vec<Vec<f64>> = own
        .unknowns
        .iter()
        .map(|u| match u.kind {
            UnknownKind::CentralInertia(k) => ten.central_inertia(k).gradient,
            UnknownKind::MassCentre(k) => ten.mass_centre(k).gradient,
            _ => {
                let at = parameters.unknowns.iter().position(|p| p.name == u.name);
                let mut unit = vec![0.0; width];
                if let Some(at) = at {
                    unit[at] = 1.0;
                }
                unit
            }
        })
        .collect();
    let r = &solved.shared.r;
    (0..n)
        .map(|i| {
            let mut row = vec![0.0; width];
            for (column, unknown) in order.iter().enumerate().skip(i) {
                let value = r[(i, column)];
                for (sum, g) in row.iter_mut().zip(&gradients[*unknown]) {
                    *sum += value * g;
                }
            }
            row
        })
        .collect()
}

/// A sensor at the base's origin with a sample at every grid time; its values are not looked at.
fn tried(kind: SensorKind, samples: usize, sigma: f64) -> SensorRecord {
    let covariance = Matrix3::identity() * (sigma * sigma);
    SensorRecord::of_base(kind, covariance).at_every_time(vec![any_value(kind); samples])
}

fn any_value(kind: SensorKind) -> SensorValue {
    match kind {
        SensorKind::Attitude => SensorValue::Attitude(UnitQuaternion::identity()),
        _ => SensorValue::Vector(Vector3::zeros()),
    }
}

/// A segment at a few times of the gyro, every sensor of rate, attitude and velocity at each, and how many these are of
/// those at hand.
fn thinned(segment: &Segment, sight: Sight, noise: &Noise) -> Option<(Segment, f64)> {
    let o = &segment.observations;
    let first = o.time_s.first()?;
    let times = o.rates().map(|(k, _)| k);
    let all: Vec<usize> = times.filter(|&k| o.time_s[k] - first <= SPAN).collect();
    let stride = all.len().div_ceil(SAMPLES).max(1);
    let picked: Vec<usize> = all.iter().copied().step_by(stride).collect();
    if picked.len() < 4 {
        return None;
    }
    let dof = o.joint_position.len() / o.time_s.len();
    let wheels = o.wheel_speed.len() / o.time_s.len();
    let rows = |values: &[f64], width: usize| -> Vec<f64> {
        picked
            .iter()
            .flat_map(|&k| values[k * width..(k + 1) * width].to_vec())
            .collect()
    };
    let samples = picked.len();
    let share = samples as f64 / all.len() as f64;
    let moving = sight == Sight::Translation;
    let mut sensors: Vec<SensorRecord> = Vec::new();
    for record in o.sensors.iter().filter(|r| !r.samples.is_empty()) {
        let kept = match record.kind {
            SensorKind::Gyro | SensorKind::Attitude => true,
            SensorKind::Velocity => moving,
            _ => false,
        };
        if kept {
            let mut few = SensorRecord {
                samples: Vec::new(),
                ..record.clone()
            };
            // Fewer samples stand for all of them.
            few.covariance *= share;
            sensors.push(few.at_every_time(vec![any_value(record.kind); samples]));
        }
    }
    if moving && sensors.iter().all(|r| r.kind != SensorKind::Velocity) {
        // Made of positions.
        sensors.push(SensorRecord {
            covariance: noise.velocity * share,
            ..tried(SensorKind::Velocity, samples, VELOCITY)
        });
    }
    let observations = Observations {
        time_s: picked.iter().map(|&k| o.time_s[k]).collect(),
        sensors,
        orbit: picked
            .iter()
            .filter_map(|&k| o.orbit.get(k).copied())
            .collect(),
        joint_position: rows(&o.joint_position, dof),
        joint_rate: rows(&o.joint_rate, dof),
        wheel_speed: rows(&o.wheel_speed, wheels),
        ..Observations::default()
    };
    let segment = Segment {
        label: String::new(),
        observations,
        ..Segment::default()
    };
    Some((segment, share))
}
