//! What a lag needs: the motion before and after.

use crate::motion::{Motion, State};
use crate::parameters::{Parameters, UnknownKind};
use crate::segment::Segment;
use crate::vehicle::{Vehicle, parabola_slope};
use poinsot_spatial::Vector3;

/// Motion that a perfect sensor would read at all grid times: a lag needs what comes before and after.
#[derive(Default)]
pub(super) struct Ideal {
    pub rate: Vec<Vector3>,
    /// Velocity of the velocity sensor, in N.
    pub velocity: Vec<Vector3>,
    /// Position of the position sensor, in N.
    pub position: Vec<Vector3>,
}

impl Ideal {
    /// Empty where no lag is unknown; `None` where the vehicle cannot move.
    pub fn new(vehicle: &Vehicle, segment: &Segment, start: &State) -> Option<Self> {
        let late = |k: &UnknownKind| {
            matches!(
                k,
                UnknownKind::GyroLag
                    | UnknownKind::AttitudeLag
                    | UnknownKind::VelocityLag
                    | UnknownKind::PositionLag
            )
        };
        let mut ideal = Self::default();
        if !vehicle.kinds.iter().any(late) {
            return Some(ideal);
        }
        let o = &segment.observations;
        let mut motion = Motion::new(vehicle, segment, Vec::new(), 0);
        let samples = o.time_s.len();
        let mut state = *start;
        for k in 0..samples {
            let twist = motion.velocity(&state, k)?.0.twist;
            ideal.rate.push(twist.w);
            let moving = twist.v + twist.w.cross(&o.velocity_arm_B);
            ideal.velocity.push(state.R_NB * moving);
            let place = state.p_NoBo_N + state.R_NB * o.position_arm_B;
            ideal.position.push(place);
            if k + 1 < samples {
                state = motion.advance(&state, k)?;
            }
        }
        Some(ideal)
    }
}

/// How late velocity and position read, s.
pub(crate) fn translation_lag(parameters: &Parameters, x: &[f64]) -> [f64; 2] {
    let of = |kind: UnknownKind| {
        let mut pairs = parameters.unknowns.iter().zip(x);
        pairs.find(|(u, _)| u.kind == kind).map_or(0.0, |(_, x)| *x)
    };
    [of(UnknownKind::VelocityLag), of(UnknownKind::PositionLag)]
}

/// Slope over time of a series at grid time k; zero where there is none.
pub(super) fn slope(t: &[f64], series: &[Vector3], k: usize) -> Vector3 {
    if series.len() < 2 || series.len() != t.len() {
        return Vector3::zeros();
    }
    Vector3::from_fn(|axis, _| parabola_slope(t, |i| series[i][axis], k))
}
