//! Motion of the vehicle under joint torques, wheels and thrust.
//!
//! The equations are in `driven_stage.rs`.

use crate::dop853::DormandPrince8;
use crate::driven_stage::{Driven, DrivenPlan, DrivenSample, DrivenStage};
use crate::integrate::{DormandPrince, Halt, Tolerance};
use crate::joint_drive::JointDrive;
use crate::plan::{SmoothIntervals, Start};
use crate::prescribed::{MotionError, gravity_gradient};
use crate::runge_kutta::RungeKutta4;
use crate::thrust::Nozzle;
use crate::tree::{Motion, Tree};
use crate::vehicle::Vehicle;
use crate::wheel_motion::WheelMotion;
use poinsot_spatial::InertialParameters;

/// How the motion is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// Runge-Kutta of fourth order in equal steps of at most this length, s.
    RungeKutta4(f64),
    /// Dormand and Prince's pair of fifth order with step control; steps end at every output.
    DormandPrince5(Tolerance),
    /// Dormand and Prince's eighth order with step control; outputs come from dense output.
    DormandPrince8(Tolerance),
    /// The same in equal steps of at most this length, s.
    DormandPrince8Fixed(f64),
}

impl<'p> Driven<'p> {
    /// Combines a vehicle with a plan.
    ///
    /// # Errors
    /// The plan does not fit the vehicle, or this form of gravity is not simulated.
    pub fn new(vehicle: impl Into<Vehicle>, plan: &'p DrivenPlan) -> Result<Self, MotionError> {
        let vehicle: Vehicle = vehicle.into();
        let parameters = vehicle.bodies.clone();
        Self::with_parameters(vehicle, parameters, plan)
    }

    /// The same with other inertial parameters (one set per body), about the bodies' origins. They need not be
    /// physical: base parameters have the same motion as the vehicle they were derived from.
    ///
    /// # Errors
    /// The plan or the parameters do not fit the vehicle, or this form of gravity is not simulated.
    pub fn with_parameters(
        vehicle: impl Into<Vehicle>,
        parameters: Vec<InertialParameters>,
        plan: &'p DrivenPlan,
    ) -> Result<Self, MotionError> {
        let vehicle: Vehicle = vehicle.into();
        let orbit = gravity_gradient(&vehicle.gravity)?;
        let (spin_inertia, nozzles) = (vehicle.spin_inertia, vehicle.nozzles);
        let driven = Self::from_parts(vehicle.tree, parameters, spin_inertia, nozzles, plan)?;
        Ok(Self { orbit, ..driven })
    }

    /// From the tree, ten parameters per body, spin inertia per wheel (kg m2) and the thrusters, in free fall.
    ///
    /// # Errors
    /// The plan or the parameters do not fit the tree.
    pub fn from_parts(
        tree: Tree,
        parameters: Vec<InertialParameters>,
        spin_inertia: Vec<f64>,
        nozzles: Vec<Nozzle>,
        plan: &'p DrivenPlan,
    ) -> Result<Self, MotionError> {
        MotionError::count("sets of parameters", parameters.len(), tree.bodies())?;
        MotionError::count("joint drives", plan.joints.len(), tree.dof())?;
        MotionError::count("wheel motions", plan.wheels.len(), tree.rotors.len())?;
        MotionError::count("spin inertias", spin_inertia.len(), tree.rotors.len())?;
        let mass: f64 = parameters.iter().map(|p| p.mass).sum();
        if mass.is_nan() || mass <= 0.0 {
            return Err(MotionError::NoMass);
        }
        let mut reduced = parameters.clone();
        for (i, (wheel, js)) in plan.wheels.iter().zip(&spin_inertia).enumerate() {
            if matches!(wheel, WheelMotion::Torque { .. }) {
                if js.is_nan() || *js <= 0.0 {
                    return Err(MotionError::InertialessWheel(i));
                }
                let rotor = &tree.rotors[i];
                let a = rotor.axis_B;
                reduced[rotor.body].I_BBo_B -= a * a.transpose() * *js;
            }
        }
        let free = tree
            .links
            .iter()
            .filter_map(|link| match link.motion {
                Motion::Revolute(k) | Motion::Prismatic(k) => Some(k),
                Motion::Fixed | Motion::Free => None,
            })
            .filter(|k| matches!(plan.joints.get(*k), Some(JointDrive::Force { .. })))
            .collect();
        Ok(Self {
            tree,
            reduced,
            parameters,
            spin_inertia,
            nozzles,
            plan,
            free,
            mass,
            orbit: None,
        })
    }

    /// The kinematic constants.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The state at time `t`, s: `q_NB` (scalar last), `p_NoScm`, `l_S`, `h_SScm` in N, momenta of torque-driven wheels,
    /// positions and then rates of the driven joints.
    ///
    /// # Errors
    /// The vehicle has no inertia.
    pub fn state(&self, start: &Start, t: f64) -> Result<Vec<f64>, MotionError> {
        let stretches = SmoothIntervals::new(self.plan.breaks());
        Ok(DrivenStage::new(self, stretches.of(t).0).start(start, t)?)
    }

    /// Moves the vehicle from `start` (at the first of `times`; joints start as their drives define) through every
    /// time, s, and hands each sample to `sink`.
    ///
    /// # Errors
    /// The motion cannot be computed; samples before that point have been handed over.
    pub fn run(
        &self,
        start: &Start,
        times: &[f64],
        integrator: Integrator,
        mut sink: impl FnMut(&DrivenSample),
    ) -> Result<(), MotionError> {
        let first = MotionError::check_times(times)?;
        let stretches = SmoothIntervals::new(self.plan.breaks());
        let mut stage = DrivenStage::new(self, stretches.of(first).0);
        let y = stage.start(start, first)?;
        let mut moving = Moving {
            stepper: Stepper::new(integrator, stage.scale()),
            most_steps: integrator.most_steps(),
            last: times.last().copied().unwrap_or(first),
            within: stretches.of(first).0,
            inside: y.clone(),
            stage,
            stretches,
            t: first,
            y,
        };
        for &time in times {
            moving.reach(time)?;
            sink(moving.sample(time)?);
        }
        Ok(())
    }
}

impl Integrator {
    /// Largest number of steps between two outputs where the step is chosen.
    fn most_steps(&self) -> usize {
        match self {
            Self::DormandPrince5(tolerance) | Self::DormandPrince8(tolerance) => {
                tolerance.max_steps
            }
            Self::RungeKutta4(_) | Self::DormandPrince8Fixed(_) => usize::MAX,
        }
    }
}

/// Workspace of the selected method.
enum Stepper {
    Fourth(RungeKutta4, f64),
    Fifth(DormandPrince),
    Eighth(Box<DormandPrince8>),
    EighthFixed(Box<DormandPrince8>, f64),
}

impl Stepper {
    fn new(integrator: Integrator, scale: Vec<f64>) -> Self {
        let eighth = |scale, tolerance| Box::new(DormandPrince8::new(scale, tolerance));
        match integrator {
            Integrator::RungeKutta4(step) => Self::Fourth(RungeKutta4::new(scale.len()), step),
            Integrator::DormandPrince5(tolerance) => {
                Self::Fifth(DormandPrince::new(scale, tolerance))
            }
            Integrator::DormandPrince8(tolerance) => Self::Eighth(eighth(scale, tolerance)),
            Integrator::DormandPrince8Fixed(step) => {
                Self::EighthFixed(eighth(scale, Tolerance::default()), step)
            }
        }
    }

    /// From `t` to `next`, or with dense output by one step towards `end`; returns the time reached.
    fn go(
        &mut self,
        stage: &mut DrivenStage,
        t: f64,
        next: f64,
        end: f64,
        y: &mut [f64],
    ) -> Result<f64, Halt> {
        match self {
            Self::Fourth(method, step) => method.advance(stage, t, next, *step, y)?,
            Self::Fifth(method) => method.advance(stage, t, next, y)?,
            Self::EighthFixed(method, step) => method.advance_fixed(stage, t, next, *step, y)?,
            Self::Eighth(method) => return method.step(stage, t, end, y),
        }
        Ok(next)
    }

    /// The derivative is discontinuous here.
    fn restart(&mut self) {
        match self {
            Self::Fourth(..) => {}
            Self::Fifth(method) => method.restart(),
            Self::Eighth(method) | Self::EighthFixed(method, _) => method.restart(),
        }
    }
}

/// State of a running integration.
struct Moving<'s> {
    stage: DrivenStage<'s>,
    stretches: SmoothIntervals,
    stepper: Stepper,
    most_steps: usize,
    /// The last output time, s.
    last: f64,
    /// Time reached, s, a time inside the stretch of the step that led there, and the state.
    t: f64,
    within: f64,
    y: Vec<f64>,
    /// The state between two steps.
    inside: Vec<f64>,
}

impl Moving<'_> {
    /// Steps until `time` is reached, or passed where there is dense output.
    fn reach(&mut self, time: f64) -> Result<(), Halt> {
        let mut steps = 0;
        while self.t < time {
            if steps == self.most_steps {
                return Err(Halt::TooManySteps { time });
            }
            steps += 1;
            // One smooth stretch, or the part of it before the next output.
            let (within, end) = self.stretches.of(self.t);
            self.within = within;
            self.stage.set_stretch(within);
            let next = end.min(time);
            let far = end.min(self.last);
            self.t = self
                .stepper
                .go(&mut self.stage, self.t, next, far, &mut self.y)?;
            if self.t == end {
                self.stepper.restart();
            }
        }
        Ok(())
    }

    /// The sample at `time`, at a switch just after it.
    fn sample(&mut self, time: f64) -> Result<&DrivenSample, Halt> {
        if let Stepper::Eighth(method) = &mut self.stepper
            && time < self.t
        {
            self.stage.set_stretch(self.within);
            method.dense(&mut self.stage, time, &mut self.inside)?;
            return self.stage.sample(time, &self.inside);
        }
        self.stage.set_stretch(self.stretches.of(self.t).0);
        self.stage.sample(self.t, &self.y)
    }
}
