//! Kinds of faults: one table of names, meanings and advice.

/// Kinds of faults that the diagnosis can name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaultKind {
    /// Bias of the gyro.
    GyroBias,
    /// Scale error of the gyro.
    GyroScale,
    /// Misalignment of the gyro.
    GyroMisalignment,
    /// Bias of another sensor.
    SensorBias,
    /// Scale error of another sensor.
    SensorScale,
    /// Misalignment of another sensor.
    SensorMisalignment,
    /// Axes of a sensor that are not square to each other.
    Nonorthogonality,
    /// A star tracker stands in the body otherwise than declared.
    TrackerMisalignment,
    /// The bias of a sensor grows with time.
    BiasDrift,
    /// One sensor reads later than the others.
    Lag,
    /// The clock of the sensors jumps against that of the inputs.
    ClockJump,
    /// The attitude as read jumps.
    AttitudeJump,
    /// The motion starts anew within a record.
    JoinedRecord,
    /// The times of a sensor's samples scatter.
    TimeJitter,
    /// A sensor's samples are rounded.
    Quantisation,
    /// A joint stands elsewhere than it reads.
    JointOffset,
    /// A joint has play between its drive and its link.
    Backlash,
    /// The sign of a wheel's speed or axis.
    WheelSign,
    /// The speeds of two wheels stand in each other's column.
    WheelExchange,
    /// Spin inertia, or scale of the speed, of a wheel.
    WheelScale,
    /// The axis of a wheel is tilted.
    WheelTilt,
    /// Degrees for radians, revolutions for radians.
    Units,
    /// Thrust of one thruster.
    Thrust,
    /// A firing that is missing from the telemetry, or that did not happen.
    Firing,
    /// A number that the model takes as known exactly.
    KnownNumber,
    /// Constant torque in body axes.
    Torque,
    /// Torque of the gravity gradient.
    GravityGradient,
    /// Difference of gravity between the vehicle and the origin of N.
    Tide,
    /// Drag.
    Drag,
    /// Angular momentum drifts in inertial axes.
    MomentumDrift,
    /// Linear momentum drifts in inertial axes.
    ForceDrift,
    /// A declared prior that the data contradict.
    Prior,
    /// Single bad readings.
    Outliers,
    /// Noise larger than declared, and white.
    NoiseUnderstated,
    /// Noise far smaller than declared.
    NoiseOverstated,
    /// A line in the residual: flexing, slosh.
    NotRigid,
    /// Larger than declared, and nothing known explains it.
    Unexplained,
}

impl FaultKind {
    /// Every kind.
    pub const ALL: [Self; 37] = [
        Self::GyroBias,
        Self::GyroScale,
        Self::GyroMisalignment,
        Self::SensorBias,
        Self::SensorScale,
        Self::SensorMisalignment,
        Self::Nonorthogonality,
        Self::TrackerMisalignment,
        Self::BiasDrift,
        Self::Lag,
        Self::ClockJump,
        Self::AttitudeJump,
        Self::JoinedRecord,
        Self::TimeJitter,
        Self::Quantisation,
        Self::JointOffset,
        Self::Backlash,
        Self::WheelSign,
        Self::WheelExchange,
        Self::WheelScale,
        Self::WheelTilt,
        Self::Units,
        Self::Thrust,
        Self::Firing,
        Self::KnownNumber,
        Self::Torque,
        Self::GravityGradient,
        Self::Tide,
        Self::Drag,
        Self::MomentumDrift,
        Self::ForceDrift,
        Self::Prior,
        Self::Outliers,
        Self::NoiseUnderstated,
        Self::NoiseOverstated,
        Self::NotRigid,
        Self::Unexplained,
    ];

    /// Name in the result file, what it is, and what would take it into the model or out of the data.
    fn entry(self) -> [&'static str; 3] {
        match self {
            Self::GyroBias => [
                "gyro_bias",
                "bias of the gyro",
                "; write bias = \"estimate\" for it",
            ],
            Self::GyroScale => [
                "gyro_scale",
                "scale error of the gyro",
                "; write scale = \"estimate\" for it",
            ],
            Self::GyroMisalignment => [
                "gyro_misalignment",
                "misalignment of the gyro",
                "; write misalignment = \"estimate\" for it",
            ],
            Self::SensorBias => [
                "sensor_bias",
                "bias of another sensor",
                "; write bias = \"estimate\" for it",
            ],
            Self::SensorScale => [
                "sensor_scale",
                "scale error of another sensor",
                "; write scale = \"estimate\" for it",
            ],
            Self::SensorMisalignment => [
                "sensor_misalignment",
                "misalignment of another sensor",
                "; write misalignment = \"estimate\" for it",
            ],
            Self::Nonorthogonality => [
                "nonorthogonality",
                "axes of a sensor that are not square to each other",
                "; write nonorthogonality = \"estimate\" for it",
            ],
            Self::TrackerMisalignment => [
                "tracker_misalignment",
                "a star tracker stands in the body otherwise than declared",
                "; check its mounting, or write bias = \"estimate\" for it",
            ],
            Self::BiasDrift => [
                "bias_drift",
                "the bias of a sensor grows with time",
                "; cut the record into shorter segments, or let the sensor warm up",
            ],
            Self::Lag => [
                "lag",
                "one sensor reads later than the others",
                "; correct its times, or write lag = \"estimate\" for it",
            ],
            Self::ClockJump => [
                "clock_jump",
                "the clock of the sensors jumps against that of the inputs",
                "; cut the record there into two segments, or correct its times",
            ],
            Self::AttitudeJump => [
                "attitude_jump",
                "the attitude as read jumps",
                "; cut the record there into two segments",
            ],
            Self::JoinedRecord => [
                "joined_record",
                "the motion starts anew within a record",
                "; cut the record there into two segments",
            ],
            Self::TimeJitter => [
                "time_jitter",
                "the times of a sensor's samples scatter",
                "; use the times at which the samples were taken",
            ],
            Self::Quantisation => [
                "quantisation",
                "a sensor's samples are rounded",
                "; write the step as resolution of the sensor, or add its twelfth part squared to the noise",
            ],
            Self::JointOffset => [
                "joint_offset",
                "a joint stands elsewhere than it reads",
                "; write bias = \"estimate\" for the sensor of the joint",
            ],
            Self::Backlash => [
                "backlash",
                "a joint has play between its drive and its link",
                "; read the joint on the side of the link",
            ],
            Self::WheelSign => [
                "wheel_sign",
                "the sign of a wheel's speed or axis",
                "; turn the axis round, or the sign of the column",
            ],
            Self::WheelExchange => [
                "wheel_exchange",
                "the speeds of two wheels stand in each other's column",
                "; exchange their columns in the map",
            ],
            Self::WheelScale => [
                "wheel_scale",
                "spin inertia, or scale of the speed, of a wheel",
                "; write estimate = true for it",
            ],
            Self::WheelTilt => [
                "wheel_tilt",
                "the axis of a wheel is tilted",
                "; write misalignment = \"estimate\" for it",
            ],
            Self::Units => [
                "units",
                "degrees for radians, revolutions for radians",
                "; correct the unit in [telemetry.columns]",
            ],
            Self::Thrust => [
                "thrust",
                "thrust of one thruster",
                "; check its firings, or write scale = \"estimate\" for it",
            ],
            Self::Firing => [
                "firing",
                "a firing that is missing from the telemetry, or that did not happen",
                "; check the commands of all thrusters about that time",
            ],
            Self::KnownNumber => [
                "known_number",
                "a number that the model takes as known exactly",
                "; correct it, or declare its uncertainty",
            ],
            Self::Torque => [
                "torque",
                "constant torque in body axes",
                "; write disturbance_torque = \"estimate\" in [environment]",
            ],
            Self::GravityGradient => [
                "gravity_gradient",
                "torque of the gravity gradient",
                "; write gravity_gradient = true in [environment], with the orbit in the telemetry",
            ],
            Self::Tide => [
                "tide",
                "difference of gravity between the vehicle and the origin of N",
                "; give positions from a point that moves with the vehicle",
            ],
            Self::Drag => [
                "drag",
                "drag",
                "; write drag_torque = \"estimate\" in [environment]",
            ],
            Self::MomentumDrift => [
                "momentum_drift",
                "angular momentum drifts in inertial axes",
                "; write disturbance_torque_inertial = \"estimate\" in [environment]",
            ],
            Self::ForceDrift => ["force_drift", "linear momentum drifts in inertial axes", ""],
            Self::Prior => ["prior", "a declared prior that the data contradict", ""],
            Self::Outliers => [
                "outliers",
                "single bad readings",
                "; a robust loss bounds what they do (--variant student_t)",
            ],
            Self::NoiseUnderstated => [
                "noise_understated",
                "noise larger than declared, and white",
                "",
            ],
            Self::NoiseOverstated => ["noise_overstated", "noise far smaller than declared", ""],
            Self::NotRigid => ["not_rigid", "a line in the residual: flexing, slosh", ""],
            Self::Unexplained => [
                "unexplained",
                "larger than declared, and nothing known explains it",
                "",
            ],
        }
    }

    /// Name in the result file.
    pub fn name(self) -> &'static str {
        self.entry()[0]
    }

    /// What it is.
    pub fn what(self) -> &'static str {
        self.entry()[1]
    }

    /// Whether it is a fault of the scatter of a sensor: wider sigmas may make up for it.
    pub(crate) fn is_spread(self) -> bool {
        matches!(
            self,
            Self::Outliers | Self::NoiseUnderstated | Self::TimeJitter | Self::Quantisation
        )
    }

    /// What would take the fault into the model, or out of the data; begins with a separator.
    pub fn advice(self) -> &'static str {
        self.entry()[2]
    }
}
