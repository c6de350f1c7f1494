//! The paper's figures, the claims of its Sec. II to V, its bounds, and both options compared with the methods of this
//! project.

mod advantages;
mod bounds;
mod claims;
mod compare;
pub mod cramer_rao;
pub mod experiment;
pub mod noise;
mod reach;
mod runs;
mod speed;
mod sweeps;

pub use advantages::{both, offset_experiment};

use crate::study::Study;

/// The studies.
pub const STUDIES: &[Study] = &[
    Study::quick(
        "exact",
        "both options on exact data, the increments as printed beside them",
        runs::exact,
    ),
    Study::quick(
        "histories",
        "Fig. 9 to 12: velocities along both trajectories",
        runs::histories,
    ),
    Study::quick(
        "mass-ratio",
        "Fig. 8: errors against the mass ratio",
        sweeps::mass_ratio,
    ),
    Study::quick(
        "noise",
        "Fig. 13 and 14: errors against noise",
        sweeps::noise,
    ),
    Study::quick(
        "readings",
        "five interpretations of 3 % noise, both examples, both options",
        sweeps::readings,
    ),
    Study::quick(
        "claims",
        "the claims of Sec. V on spin, axes, unknown momentum and noise",
        claims::run,
    ),
    Study::quick(
        "advantages",
        "a constant velocity offset and a gyro bias in both options",
        advantages::run,
    ),
    Study::quick(
        "reach",
        "bounds against span of the motion, number of joints and mass ratio; another path",
        reach::run,
    ),
    Study::slow(
        "compare",
        "both options, the linear method and the bound at equal noise",
        compare::run,
    ),
    Study::slow(
        "bounds",
        "how often (35) holds in 10,000 trials, and how loose it is",
        bounds::run,
    ),
    Study::quick(
        "speed",
        "trials per second of both options on one core",
        speed::run,
    ),
];
