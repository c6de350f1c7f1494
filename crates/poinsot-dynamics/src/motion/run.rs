//! Motion through the requested times. Steps end where a derivative is discontinuous.

use crate::motion::dop853::DormandPrince8;
use crate::motion::integrate::{Flow, Halt, Tolerance};
use crate::motion::runge_kutta::RungeKutta4;
use crate::motion::times::Times;

/// Steps after which the number to the next output is estimated.
const TRIED: usize = 1000;
/// How many times the allowed number the estimate must be to end the motion: later steps may be longer.
const HOPELESS: f64 = 1000.0;

/// How the motion is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// Runge-Kutta of fourth order in equal steps of at most this length, s.
    RungeKutta4(f64),
    /// Dormand and Prince's eighth order with step control; outputs come from dense output.
    DormandPrince8(Tolerance),
}

impl From<Tolerance> for Integrator {
    fn from(tolerance: Tolerance) -> Self {
        Self::DormandPrince8(tolerance)
    }
}

/// An equation that is smooth between discontinuities, with its measurements.
pub(crate) trait SmoothByParts: Flow {
    type Sample;

    /// Begins the smooth part at `t`, the limit from the right at a discontinuity; returns where it ends, s.
    fn enter(&mut self, t: f64, y: &[f64]) -> Result<f64, Halt>;

    /// All ideal measurements.
    fn sample(&mut self, t: f64, y: &[f64]) -> Result<&Self::Sample, Halt>;
}

/// Moves from `y` at the first of the ascending `times` through every time; `sink` takes the samples, until one
/// for which it is false. `scale` is the natural magnitude of each component.
pub(crate) fn run<S: SmoothByParts>(
    stage: &mut S,
    (y, scale): (Vec<f64>, Vec<f64>),
    times: &Times,
    integrator: Integrator,
    mut sink: impl FnMut(&S::Sample) -> bool,
) -> Result<(), Halt> {
    let (Some(first), Some(last)) = (times.get(0), times.last()) else {
        return Ok(());
    };
    let mut moving = Moving {
        stepper: Stepper::new(integrator, scale),
        last,
        t: first,
        end: stage.enter(first, &y)?,
        inside: y.clone(),
        stage,
        y,
    };
    for time in times.iter() {
        moving.reach(time)?;
        if !sink(moving.sample(time)?) {
            break;
        }
    }
    Ok(())
}

/// Workspace of the selected method.
enum Stepper {
    Fourth(RungeKutta4, f64),
    Eighth(Box<DormandPrince8>),
}

impl Stepper {
    fn new(integrator: Integrator, scale: Vec<f64>) -> Self {
        match integrator {
            Integrator::RungeKutta4(step) => Self::Fourth(RungeKutta4::new(scale.len()), step),
            Integrator::DormandPrince8(tolerance) => {
                Self::Eighth(Box::new(DormandPrince8::new(scale, tolerance)))
            }
        }
    }

    /// Largest number of steps between two outputs where the step is chosen.
    fn most_steps(&self) -> usize {
        match self {
            Self::Eighth(method) => method.tolerance().max_steps,
            Self::Fourth(..) => usize::MAX,
        }
    }

    /// From `t` to `next`, or with dense output by one step towards `far`; returns the time reached.
    fn go(
        &mut self,
        flow: &mut impl Flow,
        t: f64,
        (next, far): (f64, f64),
        y: &mut [f64],
    ) -> Result<f64, Halt> {
        match self {
            Self::Fourth(method, step) => {
                method.advance(flow, t, next, *step, y)?;
                Ok(next)
            }
            Self::Eighth(method) => method.step(flow, t, far, y),
        }
    }

    /// The derivative is discontinuous here.
    fn restart(&mut self) {
        if let Self::Eighth(method) = self {
            method.restart();
        }
    }
}

/// State of a running integration.
struct Moving<'s, S> {
    stage: &'s mut S,
    stepper: Stepper,
    /// The last output time, s.
    last: f64,
    /// Time reached, end of the smooth part entered, s, and the state.
    t: f64,
    end: f64,
    y: Vec<f64>,
    /// The state between two steps.
    inside: Vec<f64>,
}

impl<S: SmoothByParts> Moving<'_, S> {
    /// Steps until `time` is reached, or passed where there is dense output.
    fn reach(&mut self, time: f64) -> Result<(), Halt> {
        let (mut steps, from, most) = (0, self.t, self.stepper.most_steps());
        while self.t < time {
            let expected = steps as f64 * (time - from) / (self.t - from);
            if steps == most || (steps == TRIED && expected > HOPELESS * most as f64) {
                return Err(Halt::TooManySteps { time });
            }
            steps += 1;
            self.enter()?;
            let ends = (self.end.min(time), self.end.min(self.last));
            self.t = self.stepper.go(self.stage, self.t, ends, &mut self.y)?;
        }
        Ok(())
    }

    /// Begins the next smooth part where this one is at its end.
    fn enter(&mut self) -> Result<(), Halt> {
        if self.t >= self.end {
            self.end = self.stage.enter(self.t, &self.y)?;
            self.stepper.restart();
        }
        Ok(())
    }

    /// The sample at `time`, at a switch just after it.
    fn sample(&mut self, time: f64) -> Result<&S::Sample, Halt> {
        if let Stepper::Eighth(method) = &mut self.stepper
            && time < self.t
        {
            method.dense(self.stage, time, &mut self.inside)?;
            return self.stage.sample(time, &self.inside);
        }
        self.enter()?;
        self.stage.sample(self.t, &self.y)
    }
}
