//! Tables 2 and 3, figures 1 to 4, the record inferred from the printed numbers, and the four columns for slews about
//! several axes.

mod bands;
pub mod inversion;
mod manoeuvres;
mod one_axis;
pub mod records;

use crate::study::Study;

/// The studies.
pub const STUDIES: &[Study] = &[
    Study::quick(
        "axis",
        "the slew keeps one axis, so products follow from moments",
        one_axis::axis,
    ),
    Study::quick(
        "table2",
        "Table 2 without noise, column by column",
        one_axis::table2,
    ),
    Study::quick(
        "pre-estimate",
        "the sums that Table 2 fixes, and the column considering pre-estimate",
        one_axis::pre_estimate,
    ),
    Study::quick(
        "bands",
        "Tables 2 and 3 and Fig. 1 to 4 among 200 noisy records",
        bands::run,
    ),
    Study::slow(
        "manoeuvres",
        "one slew and three slews of 17 and 90 deg: every column, linear and maximum likelihood",
        manoeuvres::run,
    ),
];
