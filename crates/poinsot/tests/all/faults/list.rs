//! The faults: fifteen of a known size on one satellite, and those of drawn size on three vehicles.

use super::plants::*;
use super::trials::{Craft, Fault, Way};
use poinsot_identify::FaultKind;
use poinsot_model::SensorKind;
use poinsot_spatial::Vector3;

/// Description, names, required text, size, way.
type Row = (
    &'static str,
    &'static [FaultKind],
    &'static str,
    (f64, &'static str),
    Way,
);

fn fault((words, names, culprit, size, way): Row, craft: Craft) -> Fault {
    Fault {
        words,
        craft,
        names,
        culprit,
        size,
        fixed: true,
        way,
        least: 200,
    }
}

/// Faults of a known size; the first row has none.
#[rustfmt::skip]
pub fn planted() -> Vec<Fault> {
    use Craft::{Fine, Panel, Pendulum};
    use FaultKind as F;
    use Way::{Exact, Nothing, Read, Study};
    let rows: [(Row, Craft); 16] = [
        (("none", &[], "", (0.0, ""), Nothing), Fine),
        (("gyro scale 1 %", &[F::GyroScale], "gyro", (0.01, ""), Exact(|t, e| scale(t, "omega_", 1.0 + e))), Fine),
        (("sign of one wheel flipped", &[F::WheelSign], "wheel2", (1.0, "sign"), Exact(|t, _| scale(t, "wheel2_rad_s", -1.0))), Fine),
        (("speeds of two wheels exchanged", &[F::WheelExchange], "wheel1 and wheel2", (1.0, "exchange"), Exact(|t, _| exchange(t, ["wheel1_rad_s", "wheel2_rad_s"]))), Fine),
        (("gyro 20 ms late", &[F::Lag], "gyro", (0.02, "s"), Exact(|t, _| delay(t, "omega_"))), Fine),
        (("star tracker 20 ms late", &[F::Lag], "tracker", (0.02, "s"), Exact(|t, e| late(t, "q_", e))), Fine),
        (("wheel speeds 20 ms late", &[F::Lag], "a lag of the wheels", (0.02, "s"), Exact(|t, _| delay(t, "wheel"))), Fine),
        // 20 ms of this motion are below the original noise of these two sensors and could not be detected.
        (("velocity 20 ms late, its noise a tenth", &[F::Lag], "a lag of the velocity", (0.02, "s"), Study(|s, e| sharp_and_late(s, SensorKind::Velocity, "v_", e))), Fine),
        (("position 20 ms late, its noise a tenth", &[F::Lag], "a lag of the position", (0.02, "s"), Study(|s, e| sharp_and_late(s, SensorKind::Position, "r_", e))), Fine),
        (("gyro in deg/s, declared rad/s", &[F::Units], "gyro", (1.0, "unit"), Exact(|t, _| scale(t, "omega_", 1.0_f64.to_degrees()))), Fine),
        (("one wheel in deg/s, declared rad/s", &[F::Units], "wheel2", (1.0, "unit"), Exact(|t, _| scale(t, "wheel2_rad_s", 1.0_f64.to_degrees()))), Fine),
        (("gyro noise understated by 3", &[F::NoiseUnderstated], "gyro", (3.0, ""), Study(|s, e| noise(&mut s.sensors, SensorKind::Gyro, e))), Fine),
        // Telemetry shows less than the actual thrust.
        (("one thruster 10 % stronger", &[F::Thrust], "thr2", (0.1, ""), Exact(|t, e| scale(t, "thr2_N", 1.0 / (1.0 + e)))), Fine),
        (("3 % of the gyro samples off by 20 sigma", &[F::Outliers], "gyro", (20.0 * GYRO_RAD_S, "rad/s"), Read(outliers)), Fine),
        (("pendulum of 2 % of the mass", &[F::NotRigid], "line at", (0.02, ""), Nothing), Pendulum),
        (("panel on a soft hinge", &[F::NotRigid], "line at", (1.0, "panel"), Nothing), Panel),
    ];
    rows.into_iter().map(|(row, craft)| fault(row, craft)).collect()
}

/// Every fault on every applicable vehicle: those of drawn size, then those of a fixed one.
#[rustfmt::skip]
pub fn drawn() -> Vec<Fault> {
    use Craft::{Arm, LowOrbit, Satellite};
    use FaultKind as F;
    use Way::{Exact, Joined, Read, Vehicle};
    const ALL: [Craft; 3] = [Satellite, Arm, LowOrbit];
    // Size drawn or fixed, how many of 200 must be named correctly, vehicles.
    let rows: [(bool, u64, &[Craft], Row); 19] = [
        (false, 193, &ALL, ("wheel tilt", &[F::WheelTilt], "wheel2", (1.0e-4, "rad"), Vehicle(tilt))),
        (false, 193, &ALL, ("spin inertia", &[F::WheelScale, F::KnownNumber], "wheel2", (1.0e-4, "1"), Vehicle(|m, e| m.wheels[1].spin_inertia *= 1.0 + e))),
        (false, 193, &ALL, ("tracker misalignment", &[F::TrackerMisalignment], "attitude", (1.0e-4, "rad"), Exact(|t, e| turn(t, f64::NEG_INFINITY, e)))),
        (false, 193, &ALL, ("gyro bias drift", &[F::BiasDrift], "gyro", (1.0e-7, "rad/s2"), Exact(|t, e| each(t, "omega_y", |s, x| *x += e * s)))),
        (false, 193, &ALL, ("gyro scale", &[F::GyroScale], "gyro", (1.0e-4, "1"), Exact(|t, e| scale(t, "omega_", 1.0 + e)))),
        (false, 193, &ALL, ("attitude jump", &[F::AttitudeJump], "attitude", (1.0e-5, "rad"), Exact(|t, e| turn(t, 0.46 * duration_s(t), e)))),
        (true, 193, &ALL, ("time jitter 20 %", &[F::TimeJitter], "gyro", (0.2, "of an interval"), Read(jitter))),
        (true, 193, &ALL, ("rounded gyro", &[F::Quantisation], "gyro", (3.0e-4, "rad/s"), Read(|t, e, _| each(t, "omega_", |_, x| *x = (*x / e).round() * e)))),
        (false, 187, &[LowOrbit], ("early attitude jump", &[F::AttitudeJump], "attitude", (1.0e-5, "rad"), Exact(|t, e| turn(t, 37.0, e)))),
        (false, 189, &[Satellite], ("propellant use", &[F::PropellantUse], "bus", (1.0e-4, "kg/(N s)"), Vehicle(propellant))),
        (false, 193, &[Satellite, Arm], ("joined record", &[F::JoinedRecord], "", (1.0e-5, "rad/s"), Joined)),
        (false, 190, &[Satellite], ("tide", &[F::Tide], "", (1.0e-6, "1/s2"), Exact(tide))),
        (true, 193, &[Satellite], ("firing missing from telemetry", &[F::Firing], "", (1.0, "firing"), Exact(|t, _| thrust(t, 0.0..20.0, 0.0)))),
        (true, 193, &[Satellite], ("firing that did not happen", &[F::Firing], "thr2 at", (1.0, "firing"), Exact(|t, _| thrust(t, 40.0..41.0, 5.0)))),
        (false, 193, &[Arm], ("backlash", &[F::Backlash], "elbow", (1.0e-4, "rad"), Exact(backlash))),
        (false, 193, &[Arm], ("link mass", &[F::KnownNumber], "upper.mass", (1.0e-3, "1"), Vehicle(|m, e| m.bodies[1].nominal.mass *= 1.0 + e))),
        (false, 193, &[Arm], ("joint origin", &[F::KnownNumber], "shoulder.origin", (1.0e-4, "m"), Vehicle(|m, e| m.joints[0].p_PoCo_P += Vector3::new(0.3, 0.8, -0.5) * e))),
        (true, 193, &[LowOrbit], ("gravity gradient", &[F::GravityGradient], "", (1.0, "of 600 km"), Vehicle(gravity_gradient))),
        (true, 193, &[LowOrbit], ("reversed wheel", &[F::WheelSign], "wheel2", (1.0, "sign"), Exact(|t, _| scale(t, "wheel2_rad_s", -1.0)))),
    ];
    rows.into_iter()
        .flat_map(|(fixed, least, crafts, row)| {
            crafts.iter().map(move |craft| Fault { fixed, least, ..fault(row, *craft) })
        })
        .collect()
}

/// Vehicles without a fault; the last satellite has stored momentum.
pub fn clean() -> Vec<Fault> {
    use Craft::{Arm, LowOrbit, Satellite};
    let none = |craft| fault(("none", &[], "", (0.0, ""), Way::Nothing), craft);
    let mut list: Vec<Fault> = [Satellite, Arm, LowOrbit].map(none).into();
    let stored = ("stored momentum", &[] as &[_], "", (0.0, ""), Way::Stored);
    list.push(fault(stored, Satellite));
    list
}
