//! The studies by name, for the program and for the test that reads the commands of the page.

/// Name, what it prints, whether it ends within seconds.
pub const STUDIES: [(&str, &str, bool); 8] = [
    (
        "axis",
        "the slew keeps one axis; products follow from moments",
        true,
    ),
    (
        "table2",
        "Table 2 without noise, column by column; table2_noise_free.csv",
        true,
    ),
    (
        "pre-estimate",
        "the sums that Table 2 fixes; the column considering pre-estimate; record length and rate",
        true,
    ),
    (
        "orders",
        "the sequential readings of that column, 720 orders",
        true,
    ),
    (
        "iteration",
        "the announced iteration and the symmetric fit",
        true,
    ),
    (
        "bands",
        "Tables 2 and 3 among noisy records; table2_bands.csv, figures 1 to 4",
        true,
    ),
    (
        "manoeuvres",
        "one slew and three slews of 17 and 90 deg, every column and maximum likelihood; second_axis.csv",
        false,
    ),
    ("all", "everything above", false),
];
