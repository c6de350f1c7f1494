//! The registry of unknowns: one entry for each kind, with name, unit, natural scale, what the model declares and the fault that it
//! stands for. Estimation, priors and diagnosis loop over it.
//!
//! A new kind is a variant of [`UnknownKind`], a line in `traits`, its entry, and its place in [`Registry::groups`]; its slope is
//! where the vehicle or its inputs use it (docs/howto/adding_an_unknown.md).

use super::sensor_errors::ErrorGroup;
use super::{AXES, Unknown};
use crate::problem::fault::FaultKind;
use crate::problem::segment::Segment;
use poinsot_dynamics::propagation::{ModeNumber, SpringNumber};
use poinsot_dynamics::{SensorError, Tree};
use poinsot_model::{
    ErrorKey, Joint, JointKind, KnownNumber, Model, Nuisance, Sensor, SensorKind, printed_unit,
};
use poinsot_spatial::Vector3;
use std::f64::consts::TAU;

/// Components of a symmetric tensor without a trace.
pub(crate) const GRADIENT: usize = 5;
const MINUTE: f64 = 60.0;
/// Duration, s, of a tenth of a radian in low orbit: a gravity gradient changes in a longer record.
const ORBITING: f64 = 100.0;

/// What an unknown is.
#[derive(Debug, Clone, PartialEq)]
pub enum UnknownKind {
    /// A combination of barycentric parameters: the index `10 body + k` and its coefficient.
    Barycentric(Vec<(usize, f64)>),
    /// Element k (order xx, xy, yy, xz, yz, zz) of the base's central inertia, where only rotation is seen.
    CentralInertia(usize),
    /// Component of the base's mass centre, where only rotation is seen (thrusters turn about it).
    MassCentre(usize),
    /// Spin inertia of a wheel.
    SpinInertia(usize),
    /// A number of a flexible mode.
    Mode(usize, ModeNumber),
    /// A number of the spring of a passive joint, by its index among these.
    Spring(usize, SpringNumber),
    /// Factor of a thruster, less one.
    ThrusterScale(usize),
    /// Direction and position of a thruster, with their slopes in the axes of its body. Tested only.
    ThrusterPlace {
        /// Index in the model's thrusters.
        thruster: usize,
        /// Slope of the unit direction.
        direction_B: Vector3,
        /// Slope of the position, m.
        p_BoT_B: Vector3,
    },
    /// Share of the force of one firing. Tested only.
    Firing {
        /// Index of the segment.
        segment: usize,
        /// Index of the firing in it.
        firing: usize,
        /// Index in the model's thrusters.
        thruster: usize,
    },
    /// Mass that a body loses per impulse of one or all of its thrusters, kg/(N s): from a place of it, or per m of another place
    /// along an axis. Tested only.
    PropellantUse {
        /// Index of the body.
        body: usize,
        /// Index of the thruster; `None`: all of the body.
        thruster: Option<usize>,
        /// The place, m.
        p_BoF_B: Vector3,
        /// The axis along which the place moves.
        axis: Option<usize>,
    },
    /// Play of a joint coordinate, rad or m: its link is half of it behind its drive. Tested only.
    JointPlay(usize),
    /// Origin and axis of a joint, with their slopes. Tested only.
    JointPlace {
        /// The body that the joint carries.
        link: usize,
        /// Slope of the origin in the parent, m.
        p_PoCo_P: Vector3,
        /// Slope of the unit axis in the body.
        axis_C: Vector3,
    },
    /// An error of a sensor with three axes.
    Sensor {
        /// Index in the model's sensors.
        sensor: usize,
        /// Which error.
        error: SensorError,
    },
    /// Component of a constant torque in body axes, N m.
    DisturbanceTorque(usize),
    /// Component of a constant torque in inertial axes, N m.
    InertialTorque(usize),
    /// Coefficient of the drag torque `-c |w| w` about a body axis, kg m2.
    DragTorque(usize),
    /// Constant error of the reading of a joint coordinate, rad or m.
    JointOffset(usize),
    /// Relative error of the position of a joint coordinate, and of its rate where that has no samples of its own.
    JointScale(usize),
    /// Relative error of the measured rate of a joint coordinate.
    JointRateScale(usize),
    /// Constant error of the measured rate of a joint coordinate, rad/s or m/s.
    JointRateBias(usize),
    /// Delay of the samples of these joint coordinates, s.
    JointLag(Vec<usize>),
    /// Delay of the samples of these wheels, s.
    WheelLag(Vec<usize>),
    /// Constant error of the measured speed of a wheel, rad/s.
    WheelSpeedBias(usize),
    /// Delay of these thrusters, s.
    ThrusterLag(Vec<usize>),
    /// Small tilt of a wheel's axis, rad, about the first or second of its tilt axes.
    WheelTilt(usize, usize),
    /// Component in N of a constant force, N. Tested only.
    InertialForce(usize),
    /// Component of the tensor of a gravity gradient in N, 1/s2: five of it, then five of how it grows with time, 1/s3.
    /// Tested only.
    GravityGradient(usize),
    /// Component in N of the gradient of a tide, 1/s2, then of a constant acceleration, m/s2. Tested only.
    Tide(usize),
    /// A number whose column is made of others. Tested only.
    Changed,
    /// A known number of the model within its uncertainty.
    Known(KnownUnknown),
}

/// A component of a known number with its uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownUnknown {
    /// Which number.
    pub number: KnownNumber,
    /// Which component of it.
    pub component: usize,
    /// One sigma, in the unit of the component.
    pub sigma: f64,
    /// Correlation of its error with that of another number of its kind with the same value.
    pub correlation: f64,
    /// Its place among the known numbers of an earlier answer, and its covariances with these.
    pub told: Option<(usize, Vec<f64>)>,
    /// Slope of the barycentric parameters: index `10 body + k` and slope.
    pub slopes: Vec<(usize, f64)>,
}

/// On what an unknown acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Acts {
    /// Mass properties.
    Bodies,
    /// Flexible modes and springs.
    Modes,
    /// Wheels and thrusters.
    Actuators,
    /// Times of thrust.
    ThrustTimes,
    /// Motion of joints and wheels.
    Inputs,
    /// The same, as a delay of its samples.
    InputTimes,
    /// Measurements of a sensor with three axes.
    Sensor,
    /// The same, as a delay.
    SensorTimes,
    /// Force or torque from outside.
    Outside,
    /// Known numbers, or columns made of others.
    Others,
}

/// How a fit takes an unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Taken {
    /// Solved for with the mass properties.
    Main,
    /// Projected out.
    Nuisance,
    /// It has slopes but no value: tested, never fitted.
    Tested,
}

impl UnknownKind {
    /// On what it acts, and how a fit takes it.
    pub(super) const fn traits(&self) -> (Acts, Taken) {
        use Taken::{Main, Nuisance, Tested};
        match self {
            Self::Barycentric(_) | Self::CentralInertia(_) | Self::MassCentre(_) => {
                (Acts::Bodies, Main)
            }
            Self::SpinInertia(_) | Self::ThrusterScale(_) => (Acts::Actuators, Main),
            Self::Mode(..) | Self::Spring(..) => (Acts::Modes, Nuisance),
            Self::WheelTilt(..) => (Acts::Actuators, Nuisance),
            Self::ThrusterPlace { .. } | Self::Firing { .. } | Self::PropellantUse { .. } => {
                (Acts::Actuators, Tested)
            }
            Self::ThrusterLag(_) => (Acts::ThrustTimes, Nuisance),
            Self::JointOffset(_)
            | Self::JointScale(_)
            | Self::JointRateScale(_)
            | Self::JointRateBias(_)
            | Self::WheelSpeedBias(_) => (Acts::Inputs, Nuisance),
            Self::JointPlay(_) | Self::JointPlace { .. } => (Acts::Inputs, Tested),
            Self::JointLag(_) | Self::WheelLag(_) => (Acts::InputTimes, Nuisance),
            Self::Sensor { error, .. } => match error {
                SensorError::Lag => (Acts::SensorTimes, Nuisance),
                _ => (Acts::Sensor, Nuisance),
            },
            Self::DisturbanceTorque(_) | Self::InertialTorque(_) | Self::DragTorque(_) => {
                (Acts::Outside, Nuisance)
            }
            Self::InertialForce(_) | Self::GravityGradient(_) | Self::Tide(_) => {
                (Acts::Outside, Tested)
            }
            Self::Changed => (Acts::Others, Tested),
            Self::Known(_) => (Acts::Others, Nuisance),
        }
    }

    /// Whether it is the same number as another, at whatever values of the unknowns and in whatever vehicle.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Barycentric(a), Self::Barycentric(b)) => {
                a.first().map(|part| part.0) == b.first().map(|part| part.0)
            }
            (Self::Known(a), Self::Known(b)) => (a.number, a.component) == (b.number, b.component),
            (a, b) => a == b,
        }
    }
}

/// What the registry holds of one number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    /// Name, unit, value in the model and natural scale.
    pub unknown: Unknown,
    /// How the model declares it: its prior.
    pub declared: Nuisance,
    /// The fault that it stands for.
    pub fault: FaultKind,
    /// The fault of its group in words. That of a sensor goes on with the name of its record.
    pub hypothesis: String,
    /// The known number of the model that it changes.
    pub number: Option<KnownNumber>,
}

impl Entry {
    fn declare(self, declared: Nuisance) -> Self {
        Self { declared, ..self }
    }

    /// Unknown where the model says so.
    fn asked(self, estimate: bool) -> Self {
        let declared = [self.declared, Nuisance::Estimate][usize::from(estimate)];
        self.declare(declared)
    }

    fn changes(self, number: KnownNumber) -> Self {
        let number = Some(number);
        Self { number, ..self }
    }
}

/// The entries of a vehicle and, where they are at hand, of its segments.
#[derive(Clone, Copy)]
pub(crate) struct Registry<'a> {
    pub model: &'a Model,
    pub tree: &'a Tree,
    /// Empty: nothing that follows from telemetry.
    pub segments: &'a [Segment],
}

impl<'a> Registry<'a> {
    /// Entry of a number. `None` of mass properties, and of numbers that others make: known ones, and columns of others.
    pub fn entry(&self, kind: &UnknownKind) -> Option<Entry> {
        match *kind {
            UnknownKind::SpinInertia(k) | UnknownKind::WheelTilt(k, _) => self.of_wheel(kind, k),
            UnknownKind::Mode(k, number) => self.of_mode(kind, (k, number)),
            UnknownKind::Spring(k, number) => self.of_spring(kind, (k, number)),
            UnknownKind::ThrusterScale(k) | UnknownKind::Firing { thruster: k, .. } => {
                self.of_thruster(kind, k)
            }
            UnknownKind::PropellantUse { body, axis, .. } => self.of_propellant(kind, body, axis),
            UnknownKind::JointOffset(k)
            | UnknownKind::JointScale(k)
            | UnknownKind::JointRateScale(k)
            | UnknownKind::JointRateBias(k)
            | UnknownKind::JointPlay(k) => self.of_joint(kind, k),
            UnknownKind::WheelSpeedBias(k) => self.wheel_speed_bias(kind, k),
            UnknownKind::JointLag(ref list) => {
                let joint = self.tree.coordinates.get(*list.first()?)?;
                Some(self.lag(kind, "joints", SensorKind::JointPosition, *joint))
            }
            UnknownKind::WheelLag(ref list) => {
                Some(self.lag(kind, "wheels", SensorKind::WheelSpeed, *list.first()?))
            }
            UnknownKind::ThrusterLag(ref list) => {
                Some(self.lag(kind, "thrust", SensorKind::Thrust, *list.first()?))
            }
            UnknownKind::Sensor { sensor, error } => self.of_sensor(kind, sensor, error),
            UnknownKind::DisturbanceTorque(k)
            | UnknownKind::InertialTorque(k)
            | UnknownKind::DragTorque(k)
            | UnknownKind::InertialForce(k)
            | UnknownKind::GravityGradient(k)
            | UnknownKind::Tide(k) => self.of_environment(kind, k),
            UnknownKind::Barycentric(_)
            | UnknownKind::CentralInertia(_)
            | UnknownKind::MassCentre(_)
            | UnknownKind::ThrusterPlace { .. }
            | UnknownKind::JointPlace { .. }
            | UnknownKind::Changed
            | UnknownKind::Known(_) => None,
        }
    }

    fn of_wheel(&self, kind: &UnknownKind, k: usize) -> Option<Entry> {
        let wheel = self.model.wheels.get(k)?;
        let name = &wheel.name;
        let UnknownKind::WheelTilt(_, i) = *kind else {
            let number = (format!("{name}.spin_inertia"), "kg m2");
            let hypothesis = format!("another spin inertia of {name}");
            let mut spin = entry(kind, number, FaultKind::WheelScale, hypothesis);
            spin.unknown.nominal = wheel.spin_inertia;
            spin.unknown.natural = wheel.spin_inertia;
            let spin = spin.asked(wheel.estimate);
            return Some(spin.changes(KnownNumber::SpinInertia(k)));
        };
        let about = wheel.tilt_axes()[i];
        let axis = (0..3).find(|a| about[*a] == 1.0);
        let what = axis.map_or_else(|| format!("{}", i + 1), |a| AXES[a].to_owned());
        let number = (format!("{name}.misalignment_{what}"), "rad");
        let hypothesis = format!("a tilt of {name}");
        let tilt = entry(kind, number, FaultKind::WheelTilt, hypothesis);
        let declared = tilt.declare(wheel.misalignment);
        Some(declared.changes(KnownNumber::WheelAxis(k)))
    }

    /// The joint of a coordinate.
    pub fn joint(&self, coordinate: usize) -> Option<&'a Joint> {
        let at = self.tree.coordinates.get(coordinate)?;
        self.model.joints.get(*at)
    }

    /// The natural scale of a damping is the critical one of the whole vehicle; a spring without stiffness turns it once in a minute.
    fn of_spring(&self, kind: &UnknownKind, (k, number): (usize, SpringNumber)) -> Option<Entry> {
        let passive = self.model.passive_joints(self.tree);
        let own = passive.joints().get(k)?;
        let joint = self.joint(own.coordinate)?;
        let slides = joint.slides();
        let (mass, inertia) = self.whole();
        let moved = if slides { mass } else { inertia };
        let stiffness = own.spring.stiffness.max(moved * (TAU / MINUTE).powi(2));
        let natural = match number {
            SpringNumber::Stiffness => stiffness,
            SpringNumber::Damping => 2.0 * (stiffness * moved).sqrt(),
            SpringNumber::Rest if slides => (inertia / mass).sqrt(),
            SpringNumber::Rest => 1.0,
        };
        let nominal = *number.of(&mut own.spring.clone());
        let name_and_unit = (number.name(), number.unit(slides));
        let entry = internal(kind, &joint.name, name_and_unit, nominal, natural);
        Some(entry.asked(joint.spring_unknown.contains(&number)))
    }

    /// Nominal mass, and sum of the traces of all inertias.
    fn whole(&self) -> (f64, f64) {
        let bodies = self.model.bodies.iter().map(|b| &b.nominal);
        let mass = bodies.clone().map(|b| b.mass).sum();
        (mass, bodies.map(|b| b.parameters().I_BBo_B.trace()).sum())
    }

    /// Natural scales are the largest plausible sizes: a mode carries no more than its vehicle.
    fn of_mode(&self, kind: &UnknownKind, (k, number): (usize, ModeNumber)) -> Option<Entry> {
        let own = self.model.modes.get(k)?;
        let asked = own.estimate;
        let (mass, inertia) = self.whole();
        let (natural, asked) = match number {
            ModeNumber::Frequency => (own.mode.frequency_Hz, asked.frequency),
            ModeNumber::Damping => (1.0, asked.damping),
            ModeNumber::Translation(_) => (mass.sqrt(), asked.translation),
            ModeNumber::Rotation(_) => (inertia.sqrt(), asked.rotation),
            ModeNumber::InertiaSlope(_) => (inertia.sqrt(), asked.inertia_slope),
        };
        let nominal = own.mode.get(number);
        let name_and_unit = (number.name(), number.unit());
        let entry = internal(kind, &own.name, name_and_unit, nominal, natural);
        Some(entry.asked(asked))
    }

    fn of_thruster(&self, kind: &UnknownKind, k: usize) -> Option<Entry> {
        let thruster = self.model.thrusters.get(k)?;
        let name = &thruster.name;
        let UnknownKind::Firing {
            segment, firing, ..
        } = *kind
        else {
            let number = (format!("{name}.scale"), "1");
            let hypothesis = format!("another thrust of {name}");
            let scale = entry(kind, number, FaultKind::Thrust, hypothesis);
            return Some(scale.declare(thruster.scale).changes(KnownNumber::Force(k)));
        };
        let start_s = self.segments.get(segment)?.firings.get(firing)?.start_s;
        let number = (format!("{name}.firing_at_{start_s:.1}_s"), "1");
        let hypothesis = format!("another force of the firing of {name} at {start_s:.1} s");
        let mut share = entry(kind, number, FaultKind::Firing, hypothesis);
        share.unknown.nominal = 1.0;
        Some(share)
    }

    fn of_propellant(&self, kind: &UnknownKind, body: usize, axis: Option<usize>) -> Option<Entry> {
        let name = &self.model.bodies.get(body)?.name;
        let (what, unit) = match axis {
            None => ("use".to_owned(), "kg/(N s)"),
            Some(k) => (format!("moment_{}", AXES[k]), "kg m/(N s)"),
        };
        let number = (format!("{name}.propellant_{what}"), unit);
        let hypothesis = format!("the propellant that {name} uses");
        Some(entry(kind, number, FaultKind::PropellantUse, hypothesis))
    }

    fn of_joint(&self, kind: &UnknownKind, k: usize) -> Option<Entry> {
        let at = *self.tree.coordinates.get(k)?;
        let joint = self.model.joints.get(at)?;
        let name = &joint.name;
        let slides = joint.kind == JointKind::Prismatic;
        let (position, rate) = (SensorKind::JointPosition, SensorKind::JointRate);
        let unit = |of: SensorKind| printed_unit(of.unit(slides));
        let of = |end: &str, unit, fault, what: &str| {
            let number = (format!("{name}.{end}"), unit);
            entry(kind, number, fault, format!("{what} {name}"))
        };
        let (error, sensor, key) = match kind {
            UnknownKind::JointPlay(_) => {
                let play = of("play", unit(position), FaultKind::Backlash, "backlash of");
                return Some(play);
            }
            UnknownKind::JointScale(_) => {
                let what = "a scale error of the position of";
                let scale = of("position_scale", "1", FaultKind::JointScale, what);
                (scale, position, ErrorKey::Scale)
            }
            UnknownKind::JointRateScale(_) => {
                let what = "a scale error of the rate of";
                let scale = of("rate_scale", "1", FaultKind::JointScale, what);
                (scale, rate, ErrorKey::Scale)
            }
            UnknownKind::JointRateBias(_) => {
                let (fault, what) = (FaultKind::SensorBias, "a bias of the rate of");
                (
                    of("rate_bias", unit(rate), fault, what),
                    rate,
                    ErrorKey::Bias,
                )
            }
            _ => {
                let fault = FaultKind::JointOffset;
                let offset = of("offset", unit(position), fault, "an offset of");
                (offset, position, ErrorKey::Bias)
            }
        };
        Some(error.declare(declared(self.reader(sensor, at), key)))
    }

    fn wheel_speed_bias(&self, kind: &UnknownKind, k: usize) -> Option<Entry> {
        let name = &self.model.wheels.get(k)?.name;
        let number = (format!("{name}.speed_bias"), "rad/s");
        let hypothesis = format!("a bias of the speed of {name}");
        let bias = entry(kind, number, FaultKind::SensorBias, hypothesis);
        let sensor = self.reader(SensorKind::WheelSpeed, k);
        Some(bias.declare(declared(sensor, ErrorKey::Bias)))
    }

    /// Delay of the samples of joints, wheels or thrusters that one sensor reads; `first` is the first of them.
    fn lag(&self, kind: &UnknownKind, what: &str, sensor: SensorKind, first: usize) -> Entry {
        let reader = self.reader(sensor, first);
        let owner = reader.map_or(sensor.word(), |s| s.name.as_str());
        let number = (format!("{owner}.lag"), "s");
        let lag = entry(kind, number, FaultKind::Lag, format!("a lag of the {what}"));
        lag.declare(declared(reader, ErrorKey::Lag))
    }

    fn of_sensor(&self, kind: &UnknownKind, sensor: usize, error: SensorError) -> Option<Entry> {
        let of = self.model.sensors.get(sensor)?;
        let group = ErrorGroup::holding(of.kind, error)?;
        let name = format!("{}.{}", of.name, group.end(error));
        let number = (name, group.unit(of.kind));
        let hypothesis = format!("a {}", group.word(of.kind));
        let own = entry(kind, number, group.fault(of.kind), hypothesis);
        let own = own.declare(group.key.declared(of));
        let turns = match group.key {
            ErrorKey::Misalignment => !of.kind.is_rotation(),
            ErrorKey::Bias => of.kind.is_rotation(),
            _ => false,
        };
        Some(match turns {
            true => own.changes(KnownNumber::Mounting(sensor)),
            false => own,
        })
    }

    fn of_environment(&self, kind: &UnknownKind, k: usize) -> Option<Entry> {
        let around = &self.model.environment;
        let of = |what: &str, unit, fault, hypothesis: &str| {
            let end = match kind {
                UnknownKind::GravityGradient(_) | UnknownKind::Tide(_) => (k + 1).to_string(),
                _ => (*AXES.get(k)?).to_owned(),
            };
            let number = (format!("{what}_{end}"), unit);
            Some(entry(kind, number, fault, hypothesis.to_owned()))
        };
        match kind {
            UnknownKind::DisturbanceTorque(_) => {
                let hypothesis = "a constant external torque";
                let own = of("environment.torque", "N m", FaultKind::Torque, hypothesis)?;
                Some(own.declare(around.disturbance_torque))
            }
            UnknownKind::InertialTorque(_) => {
                let (name, fault) = ("environment.torque_inertial", FaultKind::MomentumDrift);
                let own = of(name, "N m", fault, "a drift of the angular momentum")?;
                Some(own.declare(around.disturbance_torque_inertial))
            }
            UnknownKind::DragTorque(_) => {
                let own = of("environment.drag", "kg m2", FaultKind::Drag, "drag")?;
                Some(own.declare(around.drag_torque))
            }
            UnknownKind::InertialForce(_) => {
                let hypothesis = "a drift of the linear momentum";
                of("drift.force", "N", FaultKind::ForceDrift, hypothesis)
            }
            UnknownKind::GravityGradient(_) => {
                let unit = if k < GRADIENT { "1/s2" } else { "1/s3" };
                let (name, fault) = ("gravity_gradient.tensor", FaultKind::GravityGradient);
                of(name, unit, fault, "the gravity gradient")
            }
            _ if k < GRADIENT => of("tide.gradient", "1/s2", FaultKind::Tide, "a tide"),
            _ => of("tide.acceleration", "m/s2", FaultKind::Tide, "a tide"),
        }
    }

    /// The sensor of a kind that reads a joint, wheel or thruster.
    fn reader(&self, kind: SensorKind, of: usize) -> Option<&Sensor> {
        self.model.sensors_of(kind).find(|s| s.of.contains(&of))
    }

    /// Every number that can be declared unknown or tested, in the order of the answer; those of one group are unknown together.
    pub fn groups(&self) -> Vec<Vec<UnknownKind>> {
        let model = self.model;
        let (wheels, thrusters) = (0..model.wheels.len(), 0..model.thrusters.len());
        let mut all: Vec<Vec<UnknownKind>> = Vec::new();
        all.extend(wheels.clone().map(|k| vec![UnknownKind::SpinInertia(k)]));
        all.extend(thrusters.map(|k| vec![UnknownKind::ThrusterScale(k)]));
        for k in 0..model.modes.len() {
            let groups = ModeNumber::groups();
            all.extend(groups.map(|g| g.iter().map(|n| UnknownKind::Mode(k, *n)).collect()));
        }
        let passive = model.passive_joints(self.tree);
        let springs = 0..passive.joints().len();
        let springs = springs.flat_map(|k| SpringNumber::ALL.map(|n| UnknownKind::Spring(k, n)));
        all.extend(springs.map(|kind| vec![kind]));
        all.extend(self.sensor_groups());
        all.extend(self.input_groups());
        let tilts = |k| [0, 1].map(|i| UnknownKind::WheelTilt(k, i)).to_vec();
        all.extend(wheels.map(tilts));
        let axes: [fn(usize) -> UnknownKind; 4] = [
            UnknownKind::DisturbanceTorque,
            UnknownKind::InertialTorque,
            UnknownKind::DragTorque,
            UnknownKind::InertialForce,
        ];
        all.extend(axes.map(|kind| (0..3).map(kind).collect()));
        all.push((0..GRADIENT + 3).map(UnknownKind::Tide).collect());
        if !(model.environment.gravity_gradient && model.environment.point_mass_gm.is_some()) {
            let numbers = gradient_numbers(self.segments);
            all.push((0..numbers).map(UnknownKind::GravityGradient).collect());
        }
        all.extend(propellant_groups(model, self.segments));
        all.extend(firing_groups(self.segments));
        let read = self.read_joints();
        all.extend(read.map(|k| vec![UnknownKind::JointPlay(k)]));
        all
    }

    /// Joint coordinates whose motion is an input.
    fn read_joints(&self) -> impl Iterator<Item = usize> + Clone {
        let joints = self.tree.coordinates.iter().enumerate();
        let read = |(_, joint): &(usize, &usize)| !self.model.joints[**joint].is_passive();
        joints.filter(read).map(|(k, _)| k)
    }

    fn sensor_groups(&self) -> impl Iterator<Item = Vec<UnknownKind>> {
        let sensors = self.model.sensors.iter().enumerate();
        sensors.flat_map(|(sensor, of)| {
            ErrorGroup::of(of.kind).map(move |group| {
                let errors = group.errors().into_iter();
                errors
                    .map(|error| UnknownKind::Sensor { sensor, error })
                    .collect()
            })
        })
    }

    /// Errors of the samples of joints, wheels and thrusters, sensor by sensor; then of those that no sensor reads.
    fn input_groups(&self) -> Vec<Vec<UnknownKind>> {
        let model = self.model;
        let mut all = Vec::new();
        for sensor in &model.sensors {
            all.extend(self.input_errors(sensor.kind, &sensor.of));
        }
        for (kind, count) in [
            (SensorKind::JointPosition, model.joints.len()),
            (SensorKind::JointRate, model.joints.len()),
            (SensorKind::WheelSpeed, model.wheels.len()),
            (SensorKind::Thrust, model.thrusters.len()),
        ] {
            let rest = (0..count).filter(|k| self.reader(kind, *k).is_none());
            let rest: Vec<usize> = rest.collect();
            all.extend(self.input_errors(kind, &rest));
        }
        all
    }

    fn input_errors(&self, kind: SensorKind, of: &[usize]) -> Vec<Vec<UnknownKind>> {
        let joints = self.read_joints();
        let joints = joints.filter(|k| of.contains(&self.tree.coordinates[*k]));
        let read: Vec<usize> = match kind {
            SensorKind::JointPosition | SensorKind::JointRate => joints.collect(),
            _ => of.to_vec(),
        };
        let each = |error: fn(usize) -> UnknownKind| -> Vec<Vec<UnknownKind>> {
            read.iter().map(|k| vec![error(*k)]).collect()
        };
        let lag = |error: fn(Vec<usize>) -> UnknownKind| vec![vec![error(read.clone())]];
        let of_key = |key: &ErrorKey| match (kind, key) {
            (SensorKind::JointPosition, ErrorKey::Bias) => each(UnknownKind::JointOffset),
            (SensorKind::JointPosition, ErrorKey::Scale) => each(UnknownKind::JointScale),
            (SensorKind::JointPosition, _) => lag(UnknownKind::JointLag),
            (SensorKind::JointRate, ErrorKey::Bias) => each(UnknownKind::JointRateBias),
            (SensorKind::JointRate, _) => each(UnknownKind::JointRateScale),
            (SensorKind::WheelSpeed, ErrorKey::Bias) => each(UnknownKind::WheelSpeedBias),
            (SensorKind::WheelSpeed, _) => lag(UnknownKind::WheelLag),
            _ => lag(UnknownKind::ThrusterLag),
        };
        let keys = kind.unknown_errors().iter().filter(|_| kind.is_scalar());
        keys.flat_map(of_key).collect()
    }
}

/// A number that is zero in the model, of natural scale one, and not declared.
fn entry(
    kind: &UnknownKind,
    number: (String, &'static str),
    fault: FaultKind,
    hypothesis: String,
) -> Entry {
    Entry {
        unknown: Unknown::new(kind.clone(), number, (0.0, 1.0)),
        declared: Nuisance::Known,
        fault,
        hypothesis,
        number: None,
    }
}

/// A number of a mode or a spring.
fn internal(
    kind: &UnknownKind,
    owner: &str,
    (what, unit): (impl std::fmt::Display, &'static str),
    nominal: f64,
    natural: f64,
) -> Entry {
    let number = (format!("{owner}.{what}"), unit);
    let hypothesis = format!("another {what} of {owner}");
    let mut own = entry(kind, number, FaultKind::KnownNumber, hypothesis);
    (own.unknown.nominal, own.unknown.natural) = (nominal, natural);
    own
}

fn declared(sensor: Option<&Sensor>, key: ErrorKey) -> Nuisance {
    sensor.map_or(Nuisance::Known, |s| key.declared(s))
}

/// How many numbers a gravity gradient has: a constant tensor, or one that grows with time along the orbit.
fn gradient_numbers(segments: &[Segment]) -> usize {
    let spans = segments.iter().filter_map(|s| {
        let t = &s.observations.time_s;
        Some(t.last()? - t.first()?)
    });
    match spans.fold(0.0, f64::max) > ORBITING {
        true => 2 * GRADIENT,
        false => GRADIENT,
    }
}

/// Mass that bodies lose as their thrusters fire: how much, and by the place that it comes from.
fn propellant_groups(model: &Model, segments: &[Segment]) -> Vec<Vec<UnknownKind>> {
    let firings = segments.iter().flat_map(|s| &s.firings);
    let mut hosts: Vec<usize> = firings
        .filter(|f| f.force != 0.0)
        .filter_map(|f| Some(model.thrusters.get(f.thruster)?.body))
        .collect();
    hosts.sort_unstable();
    hosts.dedup();
    let of = |body: usize| {
        let number = |axis| UnknownKind::PropellantUse {
            body,
            thruster: None,
            p_BoF_B: model.bodies[body].nominal.p_BoBcm_B,
            axis,
        };
        [None, Some(0), Some(1), Some(2)].map(number).to_vec()
    };
    hosts.into_iter().map(of).collect()
}

fn firing_groups(segments: &[Segment]) -> impl Iterator<Item = Vec<UnknownKind>> {
    segments.iter().enumerate().flat_map(|(segment, own)| {
        own.firings.iter().enumerate().map(move |(firing, of)| {
            vec![UnknownKind::Firing {
                segment,
                firing,
                thruster: of.thruster,
            }]
        })
    })
}
