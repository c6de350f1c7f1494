//! Tables 4 and 6 to 13, Fig. 9 to 13, the five uses of the Conclusion, and the sensitivities of Sec. 5.6. One joint
//! is compared with all joints.

mod cost;
pub mod robot;
mod sensitivity;
mod tables;
pub mod together;
pub mod uses;
mod validation;

pub use sensitivity::{RATE, largest_coefficients};

use crate::study::Study;

/// The studies.
pub const STUDIES: &[Study] = &[
    Study::slow(
        "tables",
        "Tables 4 and 6 to 12: paper, swarm of 20 seeds, linear, what is identifiable; masses against range",
        tables::run,
    ),
    Study::slow(
        "cost",
        "Fig. 9 and 10: best cost against iterations",
        cost::run,
    ),
    Study::slow("uses", "the five uses of the Conclusion", uses::run),
    Study::quick(
        "target",
        "a grasped target with all joints in motion",
        together::target,
    ),
    Study::slow(
        "together",
        "one joint at a time and all joints at once, noise-free and noisy",
        together::run,
    ),
    Study::quick(
        "sensitivity",
        "Sec. 5.6: weakest direction of candidate paths of each joint",
        sensitivity::paths,
    ),
    Study::quick(
        "coefficients",
        "(63) to (75): the coefficients along the runs, and how tight (75) is",
        sensitivity::coefficients,
    ),
    Study::slow(
        "validation",
        "Sec. 5.5: Table 13 into true and identified robots, Fig. 12 and 13",
        validation::run,
    ),
];
