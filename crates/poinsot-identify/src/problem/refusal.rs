//! Faults of a problem; their codes are stable.

use poinsot_files::{Fault, Faults, Place, counted};
use poinsot_solve::NotFinite;

/// Most mass properties, or uncertain known numbers, that are solved for together: their spectrum costs the cube of it.
pub(crate) const MOST_NUMBERS: usize = 1000;
/// Code of a tree without a translation sensor.
pub const NO_VELOCITY: &str = "E0403";
/// Code of a nominal vehicle that has no motion.
pub const NO_MOTION: &str = "E0405";

/// E0401: the nominal numbers make a product of unknowns.
pub(crate) fn nonlinear(body: &str) -> Faults {
    let place = Place::item("body", body);
    let problem = "estimate has the mass centre but not the inertia; about the origin of the body the inertia then holds a product of unknowns";
    Faults::one("E0401", place, problem, "add \"inertia\" to estimate")
}

/// E0402: nothing is unknown.
pub(crate) fn nothing_unknown() -> Faults {
    let problem = "the model has nothing to estimate: every body is known";
    let advice = "set estimate = true on at least one body";
    Faults::one("E0402", Place::default(), problem, advice)
}

/// E0403: a tree without a translation sensor.
pub(crate) fn rotation_of_tree(bodies: usize) -> Faults {
    let problem = format!(
        "no velocity (channels v_x v_y v_z with a [[sensor]] of type \"velocity\"): without it the linear method identifies one fully unknown rigid body only, and this model has {bodies} bodies"
    );
    let advice = "add velocity or use --method maximum_likelihood";
    Faults::one(NO_VELOCITY, Place::default(), problem, advice)
}

/// E0404: too few samples.
pub fn too_few_samples(segment: &str, samples: usize) -> Faults {
    let place = Place::item("segment", segment);
    let problem = format!("{}, at least 2 are needed", counted(samples, "sample"));
    Faults::one("E0404", place, problem, "give a longer record")
}

/// E0405: the nominal vehicle has no motion.
pub fn no_motion() -> Faults {
    let problem = "the motion cannot be predicted from the nominal mass properties (no positive mass or inertia, or a rotation five times faster than measured)";
    let advice = "check mass_kg and inertia_kg_m2 in the model and the units of wheel, joint and thrust columns";
    Faults::one(NO_MOTION, Place::default(), problem, advice)
}

/// E0406: the matrices would exceed memory and computing time.
pub(crate) fn too_many(numbers: usize, what: &str, advice: &str) -> Faults {
    let problem = format!("the model has {numbers} {what}, more than the limit of {MOST_NUMBERS}");
    Faults::one("E0406", Place::default(), problem, advice)
}

/// E0407: a setting out of its range.
pub(crate) fn setting(name: &str, value: f64, range: &str) -> Faults {
    let place = Place::item("setting", name);
    let fault = Fault::new("E0407", place, "out of its range", format!("give {range}"));
    fault.with_value(value.to_string()).into()
}

/// E0408: a mode with what its equations do not hold yet.
pub(crate) fn mode(name: &str, with: &str, advice: &str) -> Faults {
    let problem = format!("a flexible mode is not identified together with {with}");
    Faults::one("E0408", Place::item("mode", name), problem, advice)
}

/// The same of a joint that a spring moves.
pub(crate) fn passive_joint(name: &str, with: &str, advice: &str) -> Faults {
    let problem = format!("a joint that its spring moves is not identified together with {with}");
    let advice = format!("{advice}; or lock the joint by locked_at_rad or locked_at_m");
    Faults::one("E0408", Place::item("joint", name), problem, advice)
}

/// E0410: the numbers overflow.
pub fn not_finite(_: NotFinite) -> Faults {
    let problem = "the equations hold a number that is not finite";
    let advice = "check units and magnitudes of the telemetry";
    Faults::one("E0410", Place::default(), problem, advice)
}

/// E0411: an array is too short, too long or points beyond the grid.
pub fn wrong_length(what: &str, found: usize, expected: usize) -> Faults {
    let problem = format!("{found} entries, expected {expected}");
    let place = Place::default().key(what);
    Faults::one("E0411", place, problem, "give one for each")
}
