//! The unknowns of the linear problem: which numbers are asked for and how they make up the ten
//! parameters of every body.

use crate::point_sensor::Fault;
use crate::segment::Segment;
use poinsot_dynamics::{Kinematics, Tree, composite};
use poinsot_model::{EstimateSet, JointKind, Model, Nuisance, SensorKind};
use poinsot_spatial::{
    InertialParameters, MassProperties, PARAMETER_NAMES, Vector3, parallel_axis,
};

/// One unknown number.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    /// What it is.
    pub kind: UnknownKind,
    /// Name as it appears in the result, for example `bus.I_BBo_xx`.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Value in the model.
    pub nominal: f64,
    /// Natural unit in which identifiability is judged: m, m L or m L^2 of its body.
    pub natural: f64,
}

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
    /// Factor of a thruster, less one.
    ThrusterScale(usize),
    /// Component of the gyro bias, rad/s.
    GyroBias(usize),
    /// Relative scale error of a gyro axis.
    GyroScale(usize),
    /// Component of the small rotation between true and assumed gyro axes, rad.
    GyroMisalignment(usize),
    /// Turn of two gyro axes towards each other, rad: of the pair that leaves out this axis.
    GyroShear(usize),
    /// How late the gyro reads, s.
    GyroLag,
    /// How late the attitude reads, s.
    AttitudeLag,
    /// What may be wrong with another sensor of three axes: its index in the model, and the fault.
    Instrument {
        /// Index in the model's sensors.
        sensor: usize,
        /// Fault.
        fault: Fault,
    },
    /// Component of a constant torque in body axes, N m.
    DisturbanceTorque(usize),
    /// Component of a constant torque in inertial axes, N m.
    InertialTorque(usize),
    /// Coefficient of the drag torque `-c |w| w` about a body axis, kg m2.
    DragTorque(usize),
    /// How late the velocity reads, s.
    VelocityLag,
    /// How late the position reads, s.
    PositionLag,
    /// Constant error of the reading of a joint coordinate, rad or m.
    JointOffset(usize),
    /// How late the readings of these joint coordinates are, s.
    JointLag(Vec<usize>),
    /// How late the readings of these wheels are, s.
    WheelLag(Vec<usize>),
    /// How late these thrusters act, s.
    ThrusterLag(Vec<usize>),
    /// Small tilt of a wheel's axis, rad, about the first or second of its tilt axes.
    WheelTilt(usize, usize),
    /// Component in N of a constant force, N. Only tested for.
    InertialForce(usize),
    /// Component in N of a random torque about the mass centre during a stretch of time, N m.
    RandomTorque(Gust),
}

/// A stretch of time in which the random torque is one number an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gust {
    /// Index of the segment.
    pub segment: usize,
    /// First and last interval between grid times.
    pub span: (usize, usize),
    /// Axis of N.
    pub axis: usize,
}

impl UnknownKind {
    /// Whether it belongs to a sensor or the surroundings: projected out before anything is judged.
    pub fn is_nuisance(&self) -> bool {
        matches!(
            self,
            Self::GyroBias(_)
                | Self::GyroScale(_)
                | Self::GyroMisalignment(_)
                | Self::GyroShear(_)
                | Self::GyroLag
                | Self::AttitudeLag
                | Self::Instrument { .. }
                | Self::DisturbanceTorque(_)
                | Self::InertialTorque(_)
                | Self::DragTorque(_)
                | Self::VelocityLag
                | Self::PositionLag
                | Self::JointOffset(_)
                | Self::JointLag(_)
                | Self::WheelLag(_)
                | Self::ThrusterLag(_)
                | Self::WheelTilt(..)
                | Self::InertialForce(_)
                | Self::RandomTorque(_)
        )
    }

    /// Whether it is a force or torque from outside.
    pub(crate) fn pushes(&self) -> bool {
        matches!(
            self,
            Self::DisturbanceTorque(_)
                | Self::InertialTorque(_)
                | Self::DragTorque(_)
                | Self::RandomTorque(_)
                | Self::InertialForce(_)
        )
    }

    /// Whether it changes what joints and wheels do.
    pub(crate) fn shifts_inputs(&self) -> bool {
        matches!(
            self,
            Self::JointOffset(_) | Self::JointLag(_) | Self::WheelLag(_)
        )
    }
}

/// Which equations of motion can be written for the data at hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Equations {
    /// Linear and angular momentum about the inertial origin: six rows a sample. Unknowns are barycentric.
    Momentum,
    /// Angular momentum about the mass centre of one rigid body: three rows a sample.
    Rotation,
}

/// The unknowns, the known remainder and the maps between them and the bodies.
#[derive(Debug, Clone)]
pub struct Parameters {
    /// Which equations they belong to.
    pub equations: Equations,
    /// Unknowns: mass properties first, then nuisances.
    pub unknowns: Vec<Unknown>,
    /// How many of them are mass properties.
    pub mass_unknowns: usize,
    /// Barycentric parameters of every body with the unknowns set to zero.
    pub known: Vec<InertialParameters>,
    /// Nominal parameters of every body.
    pub nominal: Vec<InertialParameters>,
    /// Names of the bodies.
    pub body_names: Vec<String>,
    /// What is asked for, per body.
    pub estimate: Vec<EstimateSet>,
    /// Nominal mass properties of every body.
    pub nominal_properties: Vec<MassProperties>,
    /// Natural unit of mass and length per body, kg and m.
    pub natural: Vec<(f64, f64)>,
    /// Spin axis and tilt axes of every wheel, in its host.
    pub wheel_axes: Vec<(Vector3, [Vector3; 2])>,
    /// Gravitational parameter of the gravity gradient, where one acts, m3/s2.
    pub gm: Option<f64>,
}

/// Elements of a tensor in the order of the parameters.
pub const TENSOR: [(usize, usize); 6] = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
const TENSOR_NAMES: [&str; 6] = ["xx", "xy", "yy", "xz", "yz", "zz"];
const AXES: [&str; 3] = ["x", "y", "z"];
/// Stretch of time in which a random torque is one number, over its correlation time. Half of it was too coarse: where
/// the stretches began moved the inertia of a thrown body by 2 %.
const STRETCH: f64 = 0.2;
/// Pairs of axes by the one that is left out.
const PAIRS: [&str; 3] = ["yz", "xz", "xy"];

/// Why the question cannot be asked of the linear method.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParametersError {
    /// The nominal numbers make a product of unknowns.
    #[error(
        "E0401 body '{body}': estimate asks for the mass centre while the inertia about it is held; that is a product of unknowns, which the linear method cannot solve; add \"inertia\" to estimate or use --method maximum_likelihood"
    )]
    Nonlinear {
        /// Body.
        body: String,
    },
    /// Nothing is unknown.
    #[error(
        "E0402 the model has nothing to estimate: every body is given as known; set estimate = true on at least one body"
    )]
    NothingUnknown,
    /// A tree without a translation sensor.
    #[error(
        "E0403 no velocity: no channels v_x v_y v_z, or no [[sensor]] of type \"velocity\" in the model: the linear method can use rotation alone only for one rigid body whose mass properties are all asked of it; this model has {bodies} bodies; add velocity or use --method maximum_likelihood"
    )]
    RotationOfTree {
        /// Number of bodies.
        bodies: usize,
    },
    /// The matrices would not fit into memory, nor the time into a day.
    #[error(
        "E0406 the model asks for {numbers} mass properties at once; at most {MOST_NUMBERS} are solved for: take estimate out of bodies that are known well enough"
    )]
    TooMany {
        /// Numbers asked for.
        numbers: usize,
    },
}

/// Most mass properties that are solved for together: their spectrum costs the cube of it.
const MOST_NUMBERS: usize = 1000;

impl Parameters {
    /// The unknowns of a model under the equations that the data allow.
    ///
    /// # Errors
    /// The question cannot be put as a linear problem.
    pub fn new(
        model: &Model,
        tree: &Tree,
        equations: Equations,
        thrusters_fire: bool,
    ) -> Result<Self, ParametersError> {
        let properties: Vec<MassProperties> = model.bodies.iter().map(|b| b.nominal).collect();
        let nominal: Vec<InertialParameters> = properties.iter().map(|b| b.parameters()).collect();
        let mut parameters = Self {
            equations,
            unknowns: Vec::new(),
            mass_unknowns: 0,
            known: nominal.clone(),
            natural: natural_units(tree, &properties, &nominal),
            nominal,
            body_names: model.bodies.iter().map(|b| b.name.clone()).collect(),
            estimate: model.bodies.iter().map(|b| b.estimate).collect(),
            nominal_properties: properties,
            wheel_axes: wheel_axes(model),
            gm: gradient_gm(model),
        };
        match equations {
            Equations::Momentum => {
                for body in 0..model.bodies.len() {
                    parameters.add_body(body)?;
                }
            }
            Equations::Rotation => parameters.add_rotation(model, thrusters_fire)?,
        }
        parameters.mass_unknowns = parameters.unknowns.len();
        if parameters.mass_unknowns > MOST_NUMBERS {
            let numbers = parameters.mass_unknowns;
            return Err(ParametersError::TooMany { numbers });
        }
        parameters.add_nuisances(model, tree);
        if parameters.unknowns.is_empty() {
            return Err(ParametersError::NothingUnknown);
        }
        Ok(parameters)
    }

    /// No mass property unknown: the bodies are as given, what remains are the nuisances that the model declares.
    pub fn without_mass(model: &Model, tree: &Tree, bodies: &[InertialParameters]) -> Self {
        let properties: Vec<MassProperties> = model.bodies.iter().map(|b| b.nominal).collect();
        let mut parameters = Self {
            equations: Equations::Momentum,
            unknowns: Vec::new(),
            mass_unknowns: 0,
            known: bodies.to_vec(),
            natural: natural_units(tree, &properties, bodies),
            nominal: bodies.to_vec(),
            body_names: model.bodies.iter().map(|b| b.name.clone()).collect(),
            estimate: vec![EstimateSet::default(); model.bodies.len()],
            nominal_properties: properties,
            wheel_axes: wheel_axes(model),
            gm: gradient_gm(model),
        };
        parameters.add_nuisances(model, tree);
        parameters
    }

    fn push(
        &mut self,
        kind: UnknownKind,
        name: String,
        unit: &'static str,
        nominal: f64,
        natural: f64,
    ) {
        self.unknowns.push(Unknown {
            kind,
            name,
            unit,
            nominal,
            natural,
        });
    }

    /// Unknowns of one body under the momentum equations: linear wherever the mass centre is not asked
    /// for on its own.
    fn add_body(&mut self, body: usize) -> Result<(), ParametersError> {
        let asked = self.estimate[body];
        if !asked.any() {
            return Ok(());
        }
        let name = self.body_names[body].clone();
        if asked.com && !asked.inertia {
            return Err(ParametersError::Nonlinear { body: name });
        }
        let (m, l) = self.natural[body];
        let pi = self.nominal[body].to_array();
        let given = self.nominal_properties[body];
        let at = 10 * body;
        let mut known = InertialParameters::ZERO;
        if asked.mass {
            let mut column = vec![(at, 1.0)];
            if !asked.com {
                // A known mass centre ties first moment and parallel-axis part to the mass.
                let c = given.p_BoBcm_B;
                column.extend((0..3).map(|k| (at + 1 + k, c[k])));
                let shift = parallel_axis(1.0, &c);
                column.extend(
                    TENSOR
                        .iter()
                        .enumerate()
                        .map(|(k, &e)| (at + 4 + k, shift[e])),
                );
            }
            self.push(
                UnknownKind::Barycentric(column),
                format!("{name}.m"),
                "kg",
                pi[0],
                m,
            );
        } else {
            known.mass = given.mass;
            if !asked.com {
                known = MassProperties {
                    I_BBcm_B: Default::default(),
                    ..given
                }
                .parameters();
            }
        }
        if asked.com {
            for k in 0..3 {
                self.push(
                    UnknownKind::Barycentric(vec![(at + 1 + k, 1.0)]),
                    format!("{name}.{}", PARAMETER_NAMES[1 + k]),
                    "kg m",
                    pi[1 + k],
                    m * l,
                );
            }
        }
        if asked.inertia {
            // With the mass centre unknown the tensor about Bo is the linear one; else the central one.
            let (point, value) = if asked.com {
                ("BBo", self.nominal[body].I_BBo_B)
            } else {
                ("BBcm", given.I_BBcm_B)
            };
            for (k, &e) in TENSOR.iter().enumerate() {
                self.push(
                    UnknownKind::Barycentric(vec![(at + 4 + k, 1.0)]),
                    format!("{name}.I_{point}_{}", TENSOR_NAMES[k]),
                    "kg m2",
                    value[e],
                    m * l * l,
                );
            }
        } else {
            known.I_BBo_B += given.I_BBcm_B;
        }
        self.known[body] = known;
        Ok(())
    }

    /// Unknowns of one rigid body of which only the rotation is seen.
    fn add_rotation(&mut self, model: &Model, thrusters_fire: bool) -> Result<(), ParametersError> {
        let asked = self.estimate[0];
        if model.bodies.len() != 1 {
            return Err(ParametersError::RotationOfTree {
                bodies: model.bodies.len(),
            });
        }
        let (m, l) = self.natural[0];
        let given = self.nominal_properties[0];
        let name = self.body_names[0].clone();
        // Without thrusters the mass centre never enters: it is left out, and reported as unseen.
        if asked.com && thrusters_fire {
            for (k, axis) in AXES.iter().enumerate() {
                self.push(
                    UnknownKind::MassCentre(k),
                    format!("{name}.com_{axis}"),
                    "m",
                    given.p_BoBcm_B[k],
                    l,
                );
            }
        }
        if asked.inertia {
            for (k, &e) in TENSOR.iter().enumerate() {
                self.push(
                    UnknownKind::CentralInertia(k),
                    format!("{name}.I_BBcm_{}", TENSOR_NAMES[k]),
                    "kg m2",
                    given.I_BBcm_B[e],
                    m * l * l,
                );
            }
        }
        Ok(())
    }

    fn add_nuisances(&mut self, model: &Model, tree: &Tree) {
        for (k, wheel) in model.wheels.iter().enumerate() {
            if wheel.estimate {
                let js = wheel.spin_inertia;
                let name = format!("{}.spin_inertia", wheel.name);
                self.push(UnknownKind::SpinInertia(k), name, "kg m2", js, js);
            }
        }
        for (k, thruster) in model.thrusters.iter().enumerate() {
            if thruster.scale != Nuisance::Known {
                let name = format!("{}.scale", thruster.name);
                self.push(UnknownKind::ThrusterScale(k), name, "1", 0.0, 1.0);
            }
        }
        if let Some(gyro) = model.sensors_of(SensorKind::Gyro).next() {
            let name = gyro.name.as_str();
            self.add_axes(gyro.bias, UnknownKind::GyroBias, name, "bias", "rad/s");
            self.add_axes(gyro.scale, UnknownKind::GyroScale, name, "scale", "1");
            let turned = UnknownKind::GyroMisalignment;
            self.add_axes(gyro.misalignment, turned, name, "misalignment", "rad");
            if gyro.nonorthogonality != Nuisance::Known {
                for (k, pair) in PAIRS.iter().enumerate() {
                    let name = format!("{name}.nonorthogonality_{pair}");
                    self.push(UnknownKind::GyroShear(k), name, "rad", 0.0, 1.0);
                }
            }
            self.add_lag(gyro.lag, UnknownKind::GyroLag, name);
        }
        if let Some(tracker) = model.sensors_of(SensorKind::Attitude).next() {
            self.add_lag(tracker.lag, UnknownKind::AttitudeLag, &tracker.name);
        }
        self.add_instruments(model);
        self.add_input_faults(model, tree);
        let around = &model.environment;
        let torque = UnknownKind::DisturbanceTorque;
        self.add_axes(
            around.disturbance_torque,
            torque,
            "environment",
            "torque",
            "N m",
        );
        self.add_axes(
            around.disturbance_torque_inertial,
            UnknownKind::InertialTorque,
            "environment",
            "torque_inertial",
            "N m",
        );
        self.add_axes(
            around.drag_torque,
            UnknownKind::DragTorque,
            "environment",
            "drag",
            "kg m2",
        );
    }

    /// Adds the random torque of the surroundings: one number an axis for every stretch of a correlation time.
    pub fn add_random_torque(&mut self, model: &Model, segments: &[Segment]) {
        let Some(random) = model.environment.random_torque else {
            return;
        };
        for (at, segment) in segments.iter().enumerate() {
            for span in stretches(&segment.observations.time_s, random.correlation_s) {
                for axis in 0..3 {
                    let gust = Gust {
                        segment: at,
                        span,
                        axis,
                    };
                    let name = format!("random torque in segment {at} from {}", span.0);
                    self.push(UnknownKind::RandomTorque(gust), name, "N m", 0.0, 1.0);
                }
            }
        }
    }

    fn add_axes(
        &mut self,
        declared: Nuisance,
        kind: fn(usize) -> UnknownKind,
        owner: &str,
        what: &str,
        unit: &'static str,
    ) {
        if declared != Nuisance::Known {
            for (k, axis) in AXES.iter().enumerate() {
                self.push(kind(k), format!("{owner}.{what}_{axis}"), unit, 0.0, 1.0);
            }
        }
    }

    /// Faults of accelerometers and of velocity increments, as declared.
    fn add_instruments(&mut self, model: &Model) {
        for (sensor, of) in model.sensors.iter().enumerate() {
            let unit = match of.kind {
                SensorKind::Accelerometer => "m/s2",
                SensorKind::VelocityIncrement => "m/s",
                _ => continue,
            };
            let triples: [Declared; 3] = [
                (of.bias, Fault::Bias, "bias", unit),
                (of.scale, Fault::Scale, "scale", "1"),
                (of.misalignment, Fault::Misalignment, "misalignment", "rad"),
            ];
            for (declared, fault, what, unit) in triples {
                if declared != Nuisance::Known {
                    for (k, axis) in AXES.iter().enumerate() {
                        let kind = UnknownKind::Instrument {
                            sensor,
                            fault: fault(k),
                        };
                        self.push(kind, format!("{}.{what}_{axis}", of.name), unit, 0.0, 1.0);
                    }
                }
            }
            let fault = Fault::Lag;
            self.add_lag(of.lag, UnknownKind::Instrument { sensor, fault }, &of.name);
        }
    }

    /// Offsets and lags of what drives the vehicle, lags of position and velocity, and tilts of wheels.
    fn add_input_faults(&mut self, model: &Model, tree: &Tree) {
        for sensor in &model.sensors {
            let coordinates: Vec<usize> = (0..tree.dof())
                .filter(|k| sensor.of.contains(&tree.coordinates[*k]))
                .collect();
            let lag = match sensor.kind {
                SensorKind::JointPosition => {
                    if sensor.bias != Nuisance::Known {
                        for &k in &coordinates {
                            let joint = &model.joints[tree.coordinates[k]];
                            let unit = match joint.kind {
                                JointKind::Prismatic => "m",
                                _ => "rad",
                            };
                            let name = format!("{}.offset", joint.name);
                            self.push(UnknownKind::JointOffset(k), name, unit, 0.0, 1.0);
                        }
                    }
                    UnknownKind::JointLag(coordinates)
                }
                SensorKind::WheelSpeed => UnknownKind::WheelLag(sensor.of.clone()),
                SensorKind::Thrust => UnknownKind::ThrusterLag(sensor.of.clone()),
                _ => continue,
            };
            self.add_lag(sensor.lag, lag, &sensor.name);
        }
        for (kind, lag) in [
            (SensorKind::Velocity, UnknownKind::VelocityLag),
            (SensorKind::Position, UnknownKind::PositionLag),
        ] {
            if let Some(sensor) = model.sensors_of(kind).find(|s| s.body == 0) {
                self.add_lag(sensor.lag, lag, &sensor.name);
            }
        }
        for (k, wheel) in model.wheels.iter().enumerate() {
            if wheel.misalignment != Nuisance::Known {
                for (i, about) in wheel.tilt_axes().iter().enumerate() {
                    let axis = (0..3).find(|a| about[*a] == 1.0);
                    let what = axis.map_or_else(|| format!("{}", i + 1), |a| AXES[a].to_owned());
                    let name = format!("{}.misalignment_{what}", wheel.name);
                    self.push(UnknownKind::WheelTilt(k, i), name, "rad", 0.0, 1.0);
                }
            }
        }
    }

    fn add_lag(&mut self, declared: Nuisance, kind: UnknownKind, owner: &str) {
        if declared != Nuisance::Known {
            self.push(kind, format!("{owner}.lag"), "s", 0.0, 1.0);
        }
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.unknowns.len()
    }

    /// Whether there is nothing to find; never true for a constructed problem.
    pub fn is_empty(&self) -> bool {
        self.unknowns.is_empty()
    }

    /// Nominal values of the unknowns.
    pub fn nominal_vector(&self) -> Vec<f64> {
        self.unknowns.iter().map(|u| u.nominal).collect()
    }

    /// Barycentric parameters of every body for values of the unknowns.
    ///
    /// Where only rotation is seen the mass is the nominal one: it does not matter then.
    pub fn bodies(&self, x: &[f64]) -> Vec<InertialParameters> {
        if self.equations == Equations::Rotation {
            return vec![rotation_properties(self, x).parameters()];
        }
        let mut pi: Vec<[f64; 10]> = self.known.iter().map(|b| b.to_array()).collect();
        for (unknown, value) in self.unknowns.iter().zip(x) {
            if let UnknownKind::Barycentric(column) = &unknown.kind {
                for (at, coefficient) in column {
                    pi[at / 10][at % 10] += coefficient * value;
                }
            }
        }
        pi.iter().map(InertialParameters::from_array).collect()
    }

    /// How each unknown moves the barycentric parameters at `x`: pairs of index `10 body + k` and slope.
    /// Empty for unknowns that are not mass properties.
    pub fn slopes(&self, x: &[f64]) -> Vec<Vec<(usize, f64)>> {
        let given = (self.equations == Equations::Rotation).then(|| rotation_properties(self, x));
        self.unknowns
            .iter()
            .map(|unknown| match (&unknown.kind, &given) {
                (UnknownKind::Barycentric(parts), _) => parts.clone(),
                (UnknownKind::CentralInertia(k), _) => vec![(4 + k, 1.0)],
                (UnknownKind::MassCentre(axis), Some(body)) => mass_centre_slope(body, *axis),
                _ => Vec::new(),
            })
            .collect()
    }

    /// Gradient over the unknowns of a function of one body, given its gradient over the body's ten
    /// barycentric parameters.
    pub fn chain(&self, body: usize, over_pi: &[f64; 10]) -> Vec<f64> {
        let slot = |at: &usize| (at / 10 == body).then(|| over_pi[at % 10]);
        self.unknowns
            .iter()
            .map(|unknown| match &unknown.kind {
                UnknownKind::Barycentric(column) => column
                    .iter()
                    .filter_map(|(at, c)| slot(at).map(|g| c * g))
                    .sum(),
                _ => 0.0,
            })
            .collect()
    }
}

/// Slope of the barycentric parameters over a component of the mass centre at fixed mass and central
/// inertia: `d(m c)` and `d(m (c.c 1 - c c^T))`.
fn mass_centre_slope(body: &MassProperties, axis: usize) -> Vec<(usize, f64)> {
    let (m, c) = (body.mass, body.p_BoBcm_B);
    let mut e = Vector3::zeros();
    e[axis] = 1.0;
    let shift =
        (nalgebra::Matrix3::identity() * (2.0 * c[axis]) - e * c.transpose() - c * e.transpose())
            * m;
    let mut slope = vec![(1 + axis, m)];
    slope.extend(
        TENSOR
            .iter()
            .enumerate()
            .map(|(k, &element)| (4 + k, shift[element])),
    );
    slope
}

/// Whether a fault of an instrument is declared, the fault of an axis, its name and unit.
type Declared = (Nuisance, fn(usize) -> Fault, &'static str, &'static str);

/// Per wheel the spin axis and the two axes about which it may be tilted, in the host's axes.
fn wheel_axes(model: &Model) -> Vec<(Vector3, [Vector3; 2])> {
    let wheels = model.wheels.iter();
    wheels.map(|w| (w.axis_B, w.tilt_axes())).collect()
}

/// Gravitational parameter of the centre, m3/s2, where the gravity gradient is asked for.
fn gradient_gm(model: &Model) -> Option<f64> {
    let around = &model.environment;
    around.point_mass_gm.filter(|_| around.gravity_gradient)
}

/// Intervals between grid times in stretches of a share of the correlation time, first and last of each: an even
/// number of stretches in all would do, but a grid with gaps has no even ones.
fn stretches(time_s: &[f64], correlation_s: f64) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut from = 0;
    for k in 0..time_s.len().saturating_sub(1) {
        if time_s[k + 1] - time_s[from] >= STRETCH * correlation_s || k + 2 == time_s.len() {
            found.push((from, k));
            from = k + 1;
        }
    }
    found
}

/// Natural unit of mass and length per body; a massless nominal body borrows those of the vehicle.
fn natural_units(
    tree: &Tree,
    properties: &[MassProperties],
    nominal: &[InertialParameters],
) -> Vec<(f64, f64)> {
    let whole = composite(nominal, &Kinematics::new(tree));
    let (mass, length) = match (InertialParameters {
        mass: whole.mass,
        mc_B: whole.mc,
        I_BBo_B: whole.I_SBo_B,
    })
    .mass_properties()
    {
        Some(p) => (p.mass, p.radius_of_gyration()),
        None => (1.0, 1.0),
    };
    let length = if length > 0.0 { length } else { 1.0 };
    properties
        .iter()
        .map(|b| {
            let m = if b.mass > 0.0 { b.mass } else { mass };
            let l = b.radius_of_gyration();
            (m, if l > 0.0 { l } else { length })
        })
        .collect()
}

/// Component names of a vector.
pub fn axis_name(k: usize) -> &'static str {
    AXES[k % 3]
}

/// Element names of a tensor in the order of [`TENSOR`].
pub fn tensor_name(k: usize) -> &'static str {
    TENSOR_NAMES[k % 6]
}

/// Values of the rotation unknowns: mass centre and central inertia of the base.
pub fn rotation_properties(parameters: &Parameters, x: &[f64]) -> MassProperties {
    let mut p = parameters.nominal_properties[0];
    let mut c: Vector3 = p.p_BoBcm_B;
    for (unknown, value) in parameters.unknowns.iter().zip(x) {
        match unknown.kind {
            UnknownKind::MassCentre(k) => c[k] = *value,
            UnknownKind::CentralInertia(k) => {
                let (i, j) = TENSOR[k];
                p.I_BBcm_B[(i, j)] = *value;
                p.I_BBcm_B[(j, i)] = *value;
            }
            _ => {}
        }
    }
    p.p_BoBcm_B = c;
    p
}
