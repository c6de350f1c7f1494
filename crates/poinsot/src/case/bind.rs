//! Binds a case to a model: names become indices, and the first instant an initial state.

use super::Case;
use super::planner::Planner;
use super::sensor_output::{SensorOutput, sensor_outputs};
use super::window::Open;
use crate::error::Error;
use poinsot_dynamics::{Plan, Start, StartVelocity, Times};
use poinsot_files::{check_memory, check_time, rounded};
use poinsot_formats::case::InitialFile;
use poinsot_model::Model;
use poinsot_spatial::Vector3;

/// Numbers of a row: time and motion of the base, of a joint or wheel, of a sensor.
const MOTION: usize = 16;
const OF_JOINT: usize = 2;
const OF_SENSOR: usize = 4;
/// Copies of a row in memory where a record is simulated and written, where two are compared, and for each fit that
/// is running; measured on the shipped cases with 24,000 and 27,000 rows, and rounded up.
pub(crate) const SIMULATED: usize = 2;
pub(crate) const COMPARED: usize = 4;
pub(crate) const FITTED: usize = 5;
/// Least time of a number of a row, s, where a record is simulated and where it is fitted.
const SIMULATED_S: f64 = 1e-8;
pub(crate) const FITTED_S: f64 = 1e-7;

/// A case bound to a model: all inputs of a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// What drives joints, wheels and thrusters.
    pub plan: Plan,
    /// Pose and motion at time zero.
    pub start: Start,
    /// Times of the rows, s.
    pub times: Times<'static>,
    /// Whether channels without a sensor are omitted.
    pub sensors_only: bool,
    /// One entry per sensor of the model.
    pub sensors: Vec<SensorOutput>,
}

impl Case {
    /// Resolves the names of the case in a model.
    ///
    /// # Errors
    /// All faults with this model.
    pub fn bind(&self, model: &Model) -> Result<Scenario, Error> {
        self.bind_around(model, Open::default())
    }

    /// Binds a case of which a design fills a part: its wheels are at rest unless the case moves them.
    ///
    /// # Errors
    /// As [`Self::bind`].
    pub fn bind_around(&self, model: &Model, open: Open) -> Result<Scenario, Error> {
        let file = &self.file;
        self.planned(model, |planner| {
            planner.open = open;
            let plan = planner.control(file).unwrap_or_else(|| {
                let (wheels, firings) = (&file.wheel_motion, &file.firing);
                let (mut plan, led) = planner.plan(&file.joint_motion, wheels, firings);
                planner.drives(&file.joint_torque, &file.initial.joint, &mut plan, &led);
                plan
            });
            let start = start(planner, &file.initial);
            let sensors = sensor_outputs(planner, &file.output);
            if planner.faults.is_empty() {
                self.check_time(model, SIMULATED_S)?;
            }
            Ok(Scenario {
                plan,
                start,
                times: self.times(),
                sensors_only: file.output.sensors_only,
                sensors,
            })
        })?
    }

    /// Checks that the memory is there for some copies of so many rows.
    pub(crate) fn check_memory(
        &self,
        model: &Model,
        rows: usize,
        copies: usize,
    ) -> Result<(), Error> {
        let bytes = 8.0 * copies as f64 * numbers(model, rows);
        check_memory(&self.words(rows), bytes)
    }

    /// Checks that the time is there for every row; returns it, s.
    pub(crate) fn check_time(&self, model: &Model, of_number: f64) -> Result<f64, Error> {
        let rows = self.times().count();
        let seconds = of_number * numbers(model, rows);
        check_time(&self.words(rows), seconds)?;
        Ok(seconds)
    }

    /// Checks that memory and time are there to fit every row once; returns the least time, s.
    ///
    /// # Errors
    /// E0006 with both figures.
    ///
    /// ```
    #[doc = include_str!("../../doc/case.txt")]
    /// // 51 rows.
    /// assert!(case.check_fit(&model)? < 0.01);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn check_fit(&self, model: &Model) -> Result<f64, Error> {
        self.check_memory(model, self.times().count(), FITTED)?;
        self.check_time(model, FITTED_S)
    }

    /// Its rows in words.
    pub(crate) fn words(&self, rows: usize) -> String {
        let path = self.path().display();
        format!("the {} rows of {path}", rounded(rows as f64, 4))
    }
}

/// How many numbers so many rows are.
fn numbers(model: &Model, rows: usize) -> f64 {
    let of_row = MOTION + model.joints.len() * OF_JOINT + model.sensors.len() * OF_SENSOR;
    rows as f64 * of_row as f64
}

fn start(planner: &mut Planner, initial: &InitialFile) -> Start {
    let vector = |x: Option<[f64; 3]>| x.map_or_else(Vector3::zeros, Vector3::from);
    let p_NoBo_N = vector(initial.r_m);
    let v_NBo_N = vector(initial.v_m_s);
    let w_NB_B = vector(initial.omega_rad_s);
    let l_S_N = vector(initial.linear_N_s);
    let h_SScm_N = vector(initial.angular_N_m_s);

    let twist = initial.v_m_s.map(|_| "v_m_s");
    let twist = twist.or(initial.omega_rad_s.map(|_| "omega_rad_s"));
    let momentum = initial.linear_N_s.map(|_| "linear_N_s");
    let momentum = momentum.or(initial.angular_N_m_s.map(|_| "angular_N_m_s"));
    let zero = (initial.momentum_zero == Some(true)).then_some("momentum_zero");
    if let Some(second) = [twist, momentum, zero].into_iter().flatten().nth(1) {
        let problem = "the initial motion is given twice";
        let remedy =
            "give either omega_rad_s and v_m_s, or linear_N_s and angular_N_m_s, or momentum_zero";
        planner.refuse("E0507", &format!("initial.{second}"), problem, remedy);
    }
    let velocity = if momentum.is_some() || zero.is_some() {
        StartVelocity::Momentum { l_S_N, h_SScm_N }
    } else {
        StartVelocity::Twist { v_NBo_N, w_NB_B }
    };
    let q_xyzw = initial.q_xyzw;
    let R_NB = q_xyzw.and_then(|q| planner.attitude(q, "initial.q_xyzw"));
    Start {
        R_NB: R_NB.unwrap_or_default(),
        p_NoBo_N,
        velocity,
    }
}
