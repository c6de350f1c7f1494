//! The studies by name, for the program and for the test that reads the commands of the page.

/// Name, what it prints, whether it ends within seconds.
pub const STUDIES: [(&str, &str, bool); 12] = [
    (
        "exact",
        "both options on exact data, increments as printed beside them",
        true,
    ),
    (
        "histories",
        "Fig. 10 and 12: velocities along both trajectories",
        true,
    ),
    ("mass-ratio", "Fig. 8: errors against mass ratio", true),
    ("noise", "Fig. 13 and 14: errors against noise", true),
    (
        "readings",
        "five readings of 3 % noise, both examples, both options",
        true,
    ),
    ("claims", "the claims of Sec. V, one by one", true),
    (
        "advantages",
        "a constant velocity offset and a gyro bias in both options; accelerometer increments",
        true,
    ),
    (
        "reach",
        "span of the motion, number of joints, path and internal torque, mass ratio: bounds",
        true,
    ),
    (
        "compare",
        "both options, linear method, maximum likelihood and bound at equal noise",
        false,
    ),
    (
        "bounds",
        "how often (35) holds in 10,000 trials, how loose it is",
        false,
    ),
    ("speed", "trials per second", false),
    ("all", "everything but speed", false),
];
