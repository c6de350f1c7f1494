//! Kinds of faults: one table of names, meanings and advice.

/// Makes the kinds from their table: name in the result file, meaning, and remedy, which begins with a separator.
macro_rules! faults {
    ($($kind:ident: $name:literal, $what:literal, $advice:literal;)*) => {
        /// Kinds of faults that the diagnosis can name.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum FaultKind {
            $(#[doc = $what] $kind,)*
        }

        impl FaultKind {
            /// Every kind.
            pub const ALL: &'static [Self] = &[$(Self::$kind),*];

            const fn entry(self) -> [&'static str; 3] {
                match self {
                    $(Self::$kind => [$name, $what, $advice],)*
                }
            }
        }
    };
}

faults! {
    GyroBias: "gyro_bias", "bias of the gyro", "; write bias = \"estimate\" for it";
    GyroScale: "gyro_scale", "scale error of the gyro", "; write scale = \"estimate\" for it";
    GyroMisalignment: "gyro_misalignment", "misalignment of the gyro", "; write misalignment = \"estimate\" for it";
    SensorBias: "sensor_bias", "bias of another sensor", "; write bias = \"estimate\" for it";
    SensorScale: "sensor_scale", "scale error of another sensor", "; write scale = \"estimate\" for it";
    SensorMisalignment: "sensor_misalignment", "misalignment of another sensor", "; write misalignment = \"estimate\" for it";
    Nonorthogonality: "nonorthogonality", "axes of a sensor that are not orthogonal",
        "; write nonorthogonality = \"estimate\" for it";
    TrackerMisalignment: "tracker_misalignment", "a star tracker has another orientation than declared",
        "; check its mounting, or write bias = \"estimate\" for it";
    BiasDrift: "bias_drift", "the bias of a sensor grows with time",
        "; declare it as a random walk (walk_<unit>_s05 of the sensor)";
    Lag: "lag", "one sensor is delayed relative to the others", "; write it as late_s in its columns, or lag = \"estimate\" for it";
    ClockJump: "clock_jump", "the sensor clock jumps relative to the input clock",
        "; cut the record there into two segments, or correct its times";
    AttitudeJump: "attitude_jump", "the measured attitude jumps", "; cut the record there into two segments";
    JoinedRecord: "joined_record", "the motion restarts within a record", "; cut the record there into two segments";
    TimeJitter: "time_jitter", "the sample times of a sensor have jitter", "; use the measurement times";
    Quantisation: "quantisation", "a sensor's samples are rounded",
        "; write the step as resolution of the sensor, or add its twelfth part squared to the noise";
    JointOffset: "joint_offset", "the position of a joint has an offset",
        "; write bias = \"estimate\" for the sensor of the joint";
    JointScale: "joint_scale", "scale of the position or the rate of a joint",
        "; write scale = \"estimate\" for the sensor of the joint";
    GearedRotor: "geared_rotor", "rotor of a geared motor that the model does not have",
        "; declare it as [[wheel]] on the body that carries the motor, with its speed";
    Backlash: "backlash", "a joint has play between its drive and its link", "; measure the joint on the link side";
    WheelSign: "wheel_sign", "the sign of a wheel's speed or axis", "; reverse the axis, or the sign of the column";
    WheelExchange: "wheel_exchange", "the speed columns of two wheels are exchanged",
        "; exchange their columns in the map";
    WheelScale: "wheel_scale", "spin inertia, or scale of the speed, of a wheel", "; write estimate = true for it";
    WheelTilt: "wheel_tilt", "the axis of a wheel is tilted", "; write misalignment = \"estimate\" for it";
    Units: "units", "degrees for radians, revolutions for radians", "; correct the unit in [telemetry.columns]";
    Convention: "convention", "a channel that is read by another convention than declared", "; correct it in the map";
    Thrust: "thrust", "thrust of one thruster", "; check its firings, or write scale = \"estimate\" for it";
    Firing: "firing", "a firing that is missing from the telemetry, or that did not happen",
        "; check the commands of all thrusters about that time";
    PropellantUse: "propellant_use", "mass lost with the propellant", "; write specific_impulse_s for the thrusters";
    KnownNumber: "known_number", "a number that the model declares as known exactly", "; correct it, or declare its uncertainty";
    Torque: "torque", "constant torque in body axes", "; write disturbance_torque = \"estimate\" in [environment]";
    GravityGradient: "gravity_gradient", "torque of the gravity gradient",
        "; write gravity_gradient = true in [environment], with the orbit in the telemetry";
    Tide: "tide", "difference of gravity between the vehicle and the origin of N",
        "; give positions from a point that moves with the vehicle";
    Drag: "drag", "drag", "; write drag_torque = \"estimate\" in [environment]";
    MomentumDrift: "momentum_drift", "angular momentum drifts in inertial axes",
        "; write disturbance_torque_inertial = \"estimate\" in [environment]";
    ForceDrift: "force_drift", "linear momentum drifts in inertial axes", "";
    Prior: "prior", "a declared prior that is inconsistent with the data", "";
    Outliers: "outliers", "single outliers", "; a robust loss limits their effect (--variant student_t)";
    NoiseUnderstated: "noise_understated", "noise larger than declared, and white", "";
    NoiseOverstated: "noise_overstated", "noise far smaller than declared", "";
    NotRigid: "not_rigid", "a line in the residual: flexing, slosh", "";
    Unexplained: "unexplained", "larger than declared, and no known cause explains it", "";
}

impl FaultKind {
    /// Name in the result file.
    pub fn name(self) -> &'static str {
        self.entry()[0]
    }

    /// Meaning.
    pub fn what(self) -> &'static str {
        self.entry()[1]
    }

    /// Whether it is a fault of a sensor's noise, which wider sigmas may cover.
    pub(crate) fn is_noise_fault(self) -> bool {
        matches!(
            self,
            Self::Outliers | Self::NoiseUnderstated | Self::TimeJitter | Self::Quantisation
        )
    }

    /// How to include the fault in the model or remove it from the data; begins with a separator.
    pub fn advice(self) -> &'static str {
        self.entry()[2]
    }
}
