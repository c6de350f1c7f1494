//! Information of an experiment: sensitivities of every sample, reduced to a triangle per segment.
//!
//! The triangle of the shared unknowns is the square root of the Fisher information with pose, momentum
//! and biases projected out; its inverse is the Cramer-Rao bound. It belongs to the experiment, not to an
//! estimator: this module knows none.

pub(crate) mod as_predicted;
pub(crate) mod known_columns;

pub(crate) use known_columns::{
    DIFFERENCE, MovedVehicle, body_slopes, known_columns_last, slopes, twin,
};

use crate::fit::triangle::{SharedTriangle, longest_column};
use crate::likelihood::{
    Evaluated, InitialState, InitialStateColumns, KnownColumns, Setting, evaluate,
};
use crate::motion::input_curves::InputCurves;
use crate::motion::{Fineness, Grid, Vehicle};
use crate::problem::Problem;
use crate::problem::alternative::BetweenSamples;
use crate::problem::parameters::Parameters;
use crate::problem::prior;
use crate::problem::refusal::not_finite;
use crate::problem::segment::{Samples, Segment};
use crate::problem::settings::Settings;
use crate::problem::shifted_vehicle::ShiftedVehicle;
use poinsot_dynamics::propagation::{Flexibility, Internal, LockedVehicle, PoseMomentum};
use poinsot_dynamics::{JointSlopes, composite, composite_and_momentum, momentum, wheel_momentum};
use poinsot_files::Faults;
use poinsot_model::{MomentumKnowledge, Thruster};
use poinsot_solve::{BlockQr, Spectrum, Triangle};
use poinsot_spatial::Vector3;
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// Sigma in natural units below which a fit moves a direction.
const MOVED: f64 = 1.0;

/// A problem with its unknowns, ready to be evaluated at any value of them.
#[derive(Clone)]
pub(crate) struct Experiment<'a> {
    pub problem: &'a Problem<'a>,
    pub parameters: &'a Parameters,
    pub nominal_spin: Vec<f64>,
    pub thrusters: Vec<Thruster>,
    pub unknown: Vec<InitialStateColumns>,
    /// Whether position or velocity is measured, not attitude and rates alone.
    pub sees_translation: bool,
    pub settings: Settings,
    /// What is assumed of the inputs between their samples.
    pub wheels: BetweenSamples,
    /// How finely the motion is propagated.
    pub fineness: Fineness,
    /// Columns of the known numbers, where they are unknowns.
    pub known: Option<Arc<KnownColumns>>,
    /// Whether a fit only leads near an answer.
    pub only_near: bool,
    /// Whether the readings of a beginning count little at first, and its unknowns are held about their nominal values.
    pub tempers: bool,
    /// Whether fits that are far from an answer take full steps only.
    pub full_steps: bool,
    /// How many times as large as declared a mean square of white noise in the readings is taken to be where a search judges
    /// whether a start is far; 1 as declared.
    pub scatter: f64,
    /// Whether evaluations keep every whitened row instead of a triangle.
    pub keep_rows: bool,
    /// Whether evaluations smooth the inputs.
    pub smooth_inputs: bool,
    /// How many samples each sample stands for.
    pub weight: f64,
    /// How many of the unknowns were fitted, where those behind them are only candidates.
    pub fitted: Option<usize>,
    /// Integration steps, one grid per segment, chosen once for the nominal vehicle.
    grids: Arc<OnceLock<Vec<Grid>>>,
    /// Smooth curves through the samples of joints and wheels, one per segment; made when a lag first asks for them.
    curves: Arc<OnceLock<Vec<InputCurves>>>,
}

/// A value of all unknowns: the shared ones and the start of every segment.
#[derive(Clone)]
pub(crate) struct Iterate {
    pub x: Vec<f64>,
    pub initial_states: Vec<InitialState>,
}

impl<'a> Experiment<'a> {
    pub fn new(problem: &'a Problem<'a>, parameters: &'a Parameters) -> Self {
        let sees_translation = problem.sees_translation();
        Self {
            problem,
            parameters,
            nominal_spin: problem.model.spin_inertias(),
            thrusters: problem.model.thrusters.clone(),
            unknown: problem
                .segments
                .iter()
                .map(|s| InitialStateColumns::of(s, problem, sees_translation))
                .collect(),
            sees_translation,
            settings: Settings::default(),
            wheels: BetweenSamples::default(),
            fineness: Fineness::default(),
            known: None,
            only_near: false,
            tempers: false,
            full_steps: false,
            scatter: 1.0,
            keep_rows: false,
            smooth_inputs: false,
            weight: 1.0,
            fitted: None,
            grids: Arc::default(),
            curves: Arc::default(),
        }
    }

    /// The same experiment with one integration step in place of so many.
    pub fn coarse(mut self, steps: u32) -> Self {
        let mut grids = self.grids().to_vec();
        for step in grids.iter_mut().flat_map(|g| &mut g.steps) {
            *step = step.div_ceil(steps);
        }
        self.grids = Arc::new(OnceLock::from(grids));
        self
    }

    /// The same experiment with another motion of the wheels.
    pub fn under(&self, wheels: BetweenSamples) -> Self {
        Self {
            wheels,
            ..self.clone()
        }
    }

    /// The same experiment, whose fits end where a full step fails far from an answer: the prediction is not linear there.
    pub fn within_linear_range(&self) -> Self {
        Self {
            full_steps: true,
            ..self.clone()
        }
    }

    /// The same experiment with more unknowns.
    pub fn with_parameters(&self, parameters: &'a Parameters) -> Self {
        Self {
            parameters,
            ..self.clone()
        }
    }

    /// The same problem with other samples of the same segments.
    pub fn with_problem(&self, problem: &'a Problem<'a>) -> Self {
        Self {
            problem,
            curves: Arc::default(),
            grids: Arc::default(),
            ..self.clone()
        }
    }

    /// The same readings of a vehicle whose known numbers differ: the steps of the motion stay.
    pub fn of_vehicle(&self, problem: &'a Problem<'a>, parameters: &'a Parameters) -> Self {
        Self {
            problem,
            nominal_spin: problem.model.spin_inertias(),
            thrusters: problem.model.thrusters.clone(),
            ..self.with_parameters(parameters)
        }
    }

    /// What stays the same over all evaluations.
    pub fn setting(&self) -> Setting<'_> {
        Setting {
            problem: *self.problem,
            thrusters: &self.thrusters,
            parameters: self.parameters,
            nominal_spin: &self.nominal_spin,
            loss: self.settings.loss,
            wheels: self.wheels,
            curves: self.curves(),
            grids: self.grids(),
            fineness: Fineness {
                bends: self.bends(),
                ..self.fineness
            },
            known: self.known.as_deref(),
            keep_rows: self.keep_rows,
            smooth_inputs: self.smooth_inputs,
            fitted: self.fitted,
            // More segments keep the cores busy, and so do other problems solved at the same time.
            split: self.problem.segments.len() == 1
                && rayon::current_thread_index().is_none()
                && rayon::current_num_threads() > 1,
        }
    }

    /// The vehicle at a value of the unknowns.
    fn vehicle(&self, x: &[f64]) -> Vehicle<'_> {
        let (tree, spin) = (self.problem.tree, &self.nominal_spin);
        Vehicle::new(tree, &self.thrusters, self.parameters, spin, x)
    }

    /// The grids of all segments.
    fn grids(&self) -> &[Grid] {
        self.grids.get_or_init(|| {
            let vehicle = self.vehicle(&self.parameters.nominal_vector());
            let segments = self.problem.segments.iter();
            segments
                .map(|s| Grid::new(&vehicle, &s.observations))
                .collect()
        })
    }

    /// Whether wheel speeds bend within an interval.
    pub fn bends(&self) -> bool {
        let long = || self.grids().iter().any(|g| g.bends);
        self.may_bend() && (self.fineness.bends || long())
    }

    /// Whether they can: where they run smoothly they are curves already.
    pub fn may_bend(&self) -> bool {
        !self.problem.model.wheels.is_empty() && self.wheels == BetweenSamples::Held
    }

    /// Curves along which lags shift the inputs, one per segment; none where no lag is unknown.
    fn curves(&self) -> &[InputCurves] {
        if !self.parameters.delay_inputs() {
            return &[];
        }
        self.curves.get_or_init(|| {
            let of = |s: &Segment| InputCurves::new(&s.observations, self.problem.noise);
            self.problem.segments.iter().map(of).collect()
        })
    }

    /// All segments at a point; `None` where the vehicle cannot move as predicted, or no time is left.
    pub fn evaluate(&self, at: &Iterate, with_sensitivities: bool) -> Option<Vec<Evaluated>> {
        if !self.problem.has_time() {
            return None;
        }
        if !self.parameters.has_known() {
            return self.evaluate_here(at, with_sensitivities);
        }
        // The vehicle with its known numbers where the point has them.
        let shifted = ShiftedVehicle::at(self.problem, self.parameters, &at.x)?;
        let problem = shifted.problem(self.problem);
        let mut there = self.of_vehicle(&problem, &shifted.parameters);
        if with_sensitivities {
            there.known = Some(Arc::new(slopes(self, at)?));
        }
        there.evaluate_here(at, with_sensitivities)
    }

    fn evaluate_here(&self, at: &Iterate, with_sensitivities: bool) -> Option<Vec<Evaluated>> {
        let setting = self.setting();
        let one =
            |((segment, initial_state), unknown): ((_, &InitialState), &InitialStateColumns)| {
                evaluate(
                    &setting,
                    segment,
                    &at.x,
                    initial_state,
                    *unknown,
                    with_sensitivities,
                )
            };
        let segments = self.problem.segments;
        if setting.split {
            let all = segments.iter().enumerate().zip(&at.initial_states);
            return all.zip(&self.unknown).map(one).collect();
        }
        let all = segments.par_iter().enumerate().zip(&at.initial_states);
        all.zip(&self.unknown).map(one).collect()
    }

    /// Loss of readings and declared priors; `None` where a prior forbids the point.
    pub fn chi2(&self, at: &Iterate, evaluated: &[Evaluated]) -> Option<f64> {
        let readings: f64 = evaluated.iter().map(|e| e.cost).sum();
        let calibration = prior::calibration(self.problem, self.parameters, &at.x).chi2;
        let design = prior::design(self.problem, self.parameters, &at.x)?.chi2;
        let held = self.held(at).map(|row| row.residual * row.residual);
        Some(readings + (calibration + design + held.sum::<f64>()) / self.weight)
    }

    /// Chance that some number is as far from what is declared of it as the farthest one here, at most (Bonferroni).
    pub fn declared_chance(&self, at: &Iterate) -> f64 {
        let rows = self.prior_rows(at, true);
        let farthest = rows.iter().map(|row| row.residual.abs());
        let z = farthest.fold(0.0, f64::max);
        prior::chance_of_largest(z, rows.len())
    }

    /// Whether any mass property has a declared prior.
    pub fn has_design_prior(&self) -> bool {
        let bodies = &self.problem.model.bodies;
        bodies.iter().any(|b| b.estimate.any() && b.prior.is_some())
    }

    /// Rows of the declared calibrations and, if wanted, of the design.
    pub fn prior_rows(&self, at: &Iterate, with_design: bool) -> Vec<prior::PriorRow> {
        let mut rows = prior::calibration(self.problem, self.parameters, &at.x).rows;
        if with_design && let Some(design) = prior::design(self.problem, self.parameters, &at.x) {
            rows.extend(design.rows);
        }
        rows
    }

    /// Rows by which unknowns are loosely held: off their nominal values by their natural scale.
    fn held(&self, at: &Iterate) -> impl Iterator<Item = prior::PriorRow> {
        let n = at.x.len();
        let all = self.parameters.unknowns.iter().zip(&at.x).enumerate();
        let held = all.filter(|(_, (unknown, _))| self.tempers && unknown.natural > 0.0);
        held.map(move |(k, (unknown, x))| prior::PriorRow {
            gradient: (0..n)
                .map(|j| f64::from(u8::from(j == k)) / unknown.natural)
                .collect(),
            residual: (unknown.nominal - x) / unknown.natural,
            about: None,
        })
    }

    /// Triangle of the shared unknowns: the rows of every segment below its own head, those of declared
    /// calibrations, if wanted those of the design, and those that hold unknowns loosely. A row stands for one sample, of the
    /// weight of the experiment.
    pub fn stack(&self, at: &Iterate, evaluated: &[Evaluated], with_design: bool) -> Triangle {
        let mut stacked = BlockQr::new(self.parameters.len() + 1);
        for (triangle, h) in self.triangles(evaluated) {
            let tail = triangle.r.nrows() - h;
            stacked.push(tail, |i, j| triangle.r[(h + i, h + j)]);
        }
        let priors = self.prior_rows(at, with_design);
        let root = self.weight.sqrt();
        for row in priors.into_iter().chain(self.held(at)) {
            stacked.push(1, |_, j| {
                row.gradient.get(j).copied().unwrap_or(row.residual) / root
            });
        }
        stacked.finish()
    }

    /// Spectrum of the shared unknowns within the directions that the data determine where every known number is exact.
    pub fn spectrum_within(
        &self,
        stacked: &Triangle,
        shared: &SharedTriangle,
        evaluated: &[Evaluated],
    ) -> Result<Spectrum, Faults> {
        if !self.parameters.has_known() {
            return self.spectrum(shared, evaluated);
        }
        let (_, kept) = self.parameters.without_known();
        let exact = SharedTriangle::of_columns(self.parameters, stacked, kept, &[]);
        let exact = self.spectrum(&exact, evaluated)?;
        Spectrum::within(&shared.block(), None, &exact).map_err(not_finite)
    }

    /// Spectrum of the shared unknowns: what a fit moves. A stricter accuracy applies to the answer only; in the fit it
    /// would keep nominal values that the data contradict.
    pub fn spectrum(
        &self,
        shared: &SharedTriangle,
        evaluated: &[Evaluated],
    ) -> Result<Spectrum, Faults> {
        let natural = self.parameters.natural_vector(shared.mass);
        Spectrum::new(
            &shared.block(),
            &natural,
            None,
            self.longest_column(evaluated),
            self.problem.relative_accuracy.max(MOVED),
        )
        .map_err(not_finite)
    }

    /// The largest value that each nuisance can have.
    pub fn largest_nuisances(&self) -> Vec<f64> {
        let all = self.parameters.unknowns.iter();
        let nuisances = all.filter(|u| u.kind.is_nuisance());
        nuisances
            .map(|u| u.kind.largest(u.natural, self.problem.segments))
            .collect()
    }

    /// Length of the longest column of a mass property before projection, natural units.
    pub(crate) fn longest_column(&self, evaluated: &[Evaluated]) -> f64 {
        let segments: Vec<_> = self.triangles(evaluated).collect();
        longest_column(self.parameters, &segments)
    }

    /// The triangle of each segment that has one, and how many of its columns are of the start.
    pub fn triangles<'e>(
        &'e self,
        evaluated: &'e [Evaluated],
    ) -> impl Iterator<Item = (&'e Triangle, usize)> {
        let segments = evaluated.iter().zip(&self.unknown);
        segments.filter_map(|(e, own)| Some((e.triangle.as_ref()?, own.count())))
    }

    /// Start of a segment from its first sample and the momentum that the vehicle has at `x` then.
    pub fn measured_initial_state(&self, segment: &Segment, x: &[f64]) -> InitialState {
        let samples = &segment.samples;
        let w = samples.w_NB_B.first().copied().unwrap_or_default();
        self.initial_state_at(samples, w, x)
    }

    /// The same at another rate of the base.
    pub fn initial_state_at(&self, s: &Samples, w: Vector3, x: &[f64]) -> InitialState {
        let (tree, dof) = (self.problem.tree, self.problem.tree.dof());
        let bodies = self.parameters.bodies(x);
        let mut kinematics = s.first_placement(tree);
        let R = s.R_NB.first().copied().unwrap_or_default();
        let v = match (&s.translation, self.sees_translation) {
            (Some(t), true) => R.inverse() * t.v_NBo_N.first().copied().unwrap_or_default(),
            _ => Vector3::zeros(),
        };
        let zeros = vec![0.0; dof];
        let rates = s.joint_rate.get(..dof).unwrap_or(&zeros);
        kinematics.set_velocities(tree, &v, &w, rates);
        let now = momentum(&bodies, &kinematics);
        let speeds = s.wheel_speed.get(..tree.rotors.len()).unwrap_or(&[]);
        let vehicle = self.vehicle(x);
        let l: Vector3 = now.fixed_rows::<3>(0).into();
        let h = now.fixed_rows::<3>(3) + wheel_momentum(tree, &kinematics, &vehicle.spin, speeds);
        let c = composite(&bodies, &kinematics).p_BoScm_B();
        let given = &self.problem.model.momentum;
        let pick = |known: MomentumKnowledge, value: Vector3| match known {
            MomentumKnowledge::Known(k) => k,
            MomentumKnowledge::Estimate => value,
        };
        let linear = match self.sees_translation {
            true => pick(given.linear, R * l),
            // Without a translation sensor N may move with the mass centre.
            false => Vector3::zeros(),
        };
        let rigid = PoseMomentum {
            R_NB: R,
            p_NoBo_N: Vector3::zeros(),
            P: linear,
            h_SScm_N: pick(given.angular, R * (h - c.cross(&l))),
        };
        kinematics.set_velocities(tree, &Vector3::zeros(), &Vector3::zeros(), rates);
        let (whole, still) = composite_and_momentum(&bodies, &kinematics);
        let locked = LockedVehicle::new(&whole, &whole, &still);
        let mut at_rest = JointSlopes::default();
        at_rest.fill(tree, &bodies, &kinematics, &vehicle.spin, speeds);
        let placed = (&vehicle.passive, &at_rest);
        let place = |l| Flexibility::with_joints(&vehicle.modes, placed, &kinematics, &l);
        let flexible = locked.and_then(place);
        InitialState {
            rigid,
            internal: flexible.map_or_else(Internal::zeros, |f| f.at_rest(&w)),
        }
    }

    /// The point of the nominal numbers.
    pub fn nominal_point(&self) -> Iterate {
        let x = self.parameters.nominal_vector();
        let initial_states = self
            .problem
            .segments
            .iter()
            .map(|s| self.measured_initial_state(s, &x))
            .collect();
        Iterate { x, initial_states }
    }
}
