//! Numbers printed in the paper: Tables 4 and 6 to 12. Mass, inertia xx, yy, zz, xy, xz, yz, mass centre x, y, z.

use crate::xu2017::properties;
use poinsot_spatial::InertialParameters;

/// The ten numbers in this order.
pub const NAMES: [&str; 10] = [
    "mass, kg",
    "I_xx, kg m2",
    "I_yy, kg m2",
    "I_zz, kg m2",
    "I_xy, kg m2",
    "I_xz, kg m2",
    "I_yz, kg m2",
    "com_x, m",
    "com_y, m",
    "com_z, m",
];

/// Table 4, printed relative errors in percent; the mass row is missing in our copy of the paper.
pub const TABLE4_ERRORS: [f64; 10] = [
    f64::NAN,
    6.57e-14,
    3.29e-15,
    1.49e-14,
    1.33e-12,
    1.39e-13,
    7.11e-11,
    8.73e-12,
    2.43e-10,
    5.38e-11,
];

/// Tables 6 to 12, "identification value".
#[rustfmt::skip]
pub const IDENTIFIED: [[f64; 10]; 7] = [
    [399.9415, 30.117, 28.109, 31.993, 0.259, 0.335, -0.289, -5.22e-5, 1.39e-6, 2.0e-4],
    [12.010, 0.523, 0.519, 0.196, 9.1e-11, 6.0e-4, -6.36e-9, 3.0e-4, -1.8e-14, 0.140],
    [9.966, 0.285, 1.817, 1.689, 9.41e-9, 0.257, 5.1e-11, 0.272, -1.30e-13, -0.252],
    [10.007, 0.414, 0.404, 0.141, 8.8e-13, 8.0e-4, -6.5e-13, -5.0e-4, 3.0e-15, 0.149],
    [7.908, 0.509, 0.501, 0.218, 6.5e-13, -4.7e-13, 1.4e-10, 1.0e-15, 1.4e-8, -0.346],
    [6.069, 0.323, 0.164, 0.261, -1.8e-13, -4.6e-14, 3.7e-9, -4.0e-15, -0.033, -1.9e-8],
    [30.009, 2.395, 2.676, 1.405, -0.068, 0.014, 0.051, -0.270, -2.2e-8, 0.429],
];

/// Sec. 5.5: largest differences of base position, m, base attitude and joint angles, rad.
pub const VALIDATION: [f64; 3] = [3.3e-5, 5.6e-4, 8.0e-4];

/// The bodies of Tables 6 to 12.
pub fn printed_bodies() -> Vec<InertialParameters> {
    let body = |x: &[f64; 10]| properties(x).parameters();
    IDENTIFIED.iter().map(body).collect()
}
