//! Numbers printed in the paper, elements in the order xx, yy, zz, xy, yz, zx.

/// Columns of Table 2, by variant.
pub const COLUMNS: [&str; 4] = ["batch", "conventional", "pre-estimate", "suggested"];
/// Table 2, kg m2.
pub const PRINTED: [[f64; 6]; 4] = [
    [4.2859, 7.1157, 6.1224, 4.8224, 6.1667, 6.2786],
    [14.1181, 17.5350, 20.6816, 16.3578, 19.1201, 17.4000],
    [14.1181, 17.5350, 20.6816, -0.0019, 0.0062, 0.0589],
    [14.1181, 17.5350, 20.6816, 0.1197, 0.1538, 0.1560],
];
/// Table 1: the tensor, kg m2.
pub const TRUE: [f64; 6] = [13.916, 16.954, 19.894, 0.085, 0.5896, 0.133];
/// Table 1: gyro noise, rad/s.
pub const SIGMA: f64 = 1.0e-4;
