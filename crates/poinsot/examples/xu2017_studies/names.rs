//! The studies by name, for the program and for the test that reads the commands of the page.

/// Name, what it prints, whether it ends within seconds.
pub const STUDIES: [(&str, &str, bool); 9] = [
    (
        "tables",
        "Tables 4 and 6 to 12: paper, swarm of 20 seeds, linear, what is identifiable",
        false,
    ),
    (
        "figures",
        "Fig. 9 and 10: best cost against iterations",
        false,
    ),
    ("uses", "the five uses of the Conclusion", false),
    ("target", "a grasped target with all joints in motion", true),
    (
        "together",
        "one joint at a time and all joints at once, noise-free and noisy",
        false,
    ),
    (
        "sensitivity",
        "Sec. 5.6: coefficients of candidate paths of each joint, weakest direction",
        true,
    ),
    (
        "coefficients",
        "(63) to (75): the coefficients along the runs, and how tight (75) is",
        true,
    ),
    (
        "validation",
        "Sec. 5.5: Table 13 into true and identified robots; Fig. 12 and 13",
        false,
    ),
    ("all", "everything above", false),
];
