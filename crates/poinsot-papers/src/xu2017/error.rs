//! Errors of this method, each one line with its remedy.

use poinsot_files::rounded;
use poinsot_identify::ProblemError;

/// Why the method cannot be applied.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Xu2017Error {
    /// Error of any method.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The model has wheels.
    #[error(
        "E0531 wheel '{wheel}': xu2017 knows no momentum wheels; take it out of the model if it stands still, or use --method auto"
    )]
    Wheel {
        /// Wheel.
        wheel: String,
    },
    /// A body partly known, other than mass and mass centre together.
    #[error(
        "E0532 body '{body}': estimate: xu2017 takes a body as known, as unknown (estimate = true), or with known mass and mass centre (estimate = [\"inertia\"]); change it, or use --method auto"
    )]
    PartlyKnown {
        /// Body.
        body: String,
    },
    /// Neither thrust nor a known body sets the scale.
    #[error(
        "E0533 no thruster fires with the joints locked, and no body fixes the scale of the momentum equations (35); add a segment with thrust, take estimate out of the base or the arm, or use --method auto"
    )]
    NoScale,
    /// No velocity.
    #[error(
        "E0534 segment '{label}': no velocity channel (v_x v_y v_z): xu2017 needs it for {what}; add it, or use --method auto"
    )]
    NoVelocity {
        /// Segment.
        label: String,
        /// Purpose of the velocity.
        what: &'static str,
    },
    /// Several joints move and several bodies are unknown.
    #[error(
        "E0535 segment '{label}': joints {joints} move together: xu2017 unlocks one joint at a time unless a single body is unknown; split the motion, or use --method auto"
    )]
    JointsTogether {
        /// Segment.
        label: String,
        /// Joints.
        joints: String,
    },
    /// Thrust while a joint moves.
    #[error(
        "E0536 segment '{label}': a thruster fires while joint '{joint}' moves: xu2017 takes momentum as conserved then; cut the firing out, or use --method auto"
    )]
    ThrustInMotion {
        /// Segment.
        label: String,
        /// Joint.
        joint: String,
    },
    /// A joint is locked in another configuration.
    #[error(
        "E0537 segment '{label}': joint '{joint}' is locked at {}, elsewhere at {} (rad or m): (43)-(46) need one normal configuration in all segments; bring the joint back, or use --method auto",
        rounded(*found, 6),
        rounded(*expected, 6)
    )]
    OtherConfiguration {
        /// Segment.
        label: String,
        /// Joint.
        joint: String,
        /// Position here.
        found: f64,
        /// Position elsewhere.
        expected: f64,
    },
    /// The swarm's objective assumes zero momentum.
    #[error(
        "E0538 segment '{label}': the vehicle moves at {} rad/s and {} m/s at the first sample: the objective (52) assumes zero momentum, so variant {variant} must start at rest; use --variant linear, which takes the momentum as unknown",
        rounded(*rate, 2),
        rounded(*speed, 2)
    )]
    NotAtRest {
        /// Segment.
        label: String,
        /// Angular rate.
        rate: f64,
        /// Speed.
        speed: f64,
        /// Variant.
        variant: &'static str,
    },
    /// No usable segment.
    #[error(
        "E0539 no segment has thrust with the joints locked, and in none does a joint move: xu2017 has nothing to work on; fire thrusters or drive a joint, or use --method auto"
    )]
    NothingMoves,
    /// Numbers overflow.
    #[error(
        "E0540 the equations hold a number that is not finite; check units and magnitudes of the telemetry"
    )]
    NotFinite,
}
