//! The parallel-axis theorem of the linked library: within the crate the compiler may generate other instructions.
#![allow(clippy::unwrap_used, non_snake_case)]

use poinsot_spatial::{MassProperties, Matrix3, Vector3};

/// The bodies of the arm of Xu 2017, with the sums of the parallel-axis theorem element by element.
#[test]
fn exact_parallel_axis_is_the_sum_over_the_elements() {
    // Mass, mass centre, and xx, yy, zz, xy, xz, yz about it.
    let arm = [
        (
            388.0,
            [0.004, -0.003, 0.005],
            [31.2, 29.12, 33.28, 0.2704, 0.3848, -0.3016],
        ),
        (
            12.6,
            [0.004, -0.003, 0.155],
            [0.4845, 0.4845, 0.19, 0.0, 0.0, 0.0],
        ),
        (
            9.6,
            [0.274, -0.003, -0.246],
            [0.28634, 1.86533, 1.7407, 0.0, 0.27089, 0.0],
        ),
        (
            10.4,
            [0.004, -0.003, 0.155],
            [0.4074, 0.4074, 0.1455, 0.0, 0.0, 0.0],
        ),
        (
            7.6,
            [0.004, -0.003, -0.345],
            [0.525, 0.525, 0.2205, 0.0, 0.0, 0.0],
        ),
        (
            6.36,
            [0.004, -0.037, 0.005],
            [0.3168, 0.16512, 0.2496, 0.0, 0.0, 0.0],
        ),
        (
            30.9,
            [-0.266, -0.003, 0.435],
            [2.35004, 2.62444, 1.3769, -0.06762, 0.01274, 0.04998],
        ),
    ];
    // Prevents evaluation at compile time.
    for (mass, c, [xx, yy, zz, xy, xz, yz]) in std::hint::black_box(arm) {
        let central = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        let body = MassProperties {
            mass,
            p_BoBcm_B: Vector3::from(c),
            I_BBcm_B: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        };
        let about_origin = body.parameters();
        let back = about_origin.mass_properties().unwrap();
        for i in 0..3 {
            assert!((about_origin.mc_B[i] - mass * c[i]).abs() < 1.0e-14);
            for j in 0..3 {
                let (p, q) = ((i + 1) % 3, (i + 2) % 3);
                let shift = match i == j {
                    true => c[p] * c[p] + c[q] * c[q],
                    false => -c[i] * c[j],
                };
                let gap = about_origin.I_BBo_B[(i, j)] - (central[i][j] + mass * shift);
                assert!(gap.abs() < 1.0e-14, "{mass} kg, {i} {j}: {gap:e}");
                let gap = back.I_BBcm_B[(i, j)] - central[i][j];
                assert!(gap.abs() < 1.0e-14, "{mass} kg, {i} {j}, central: {gap:e}");
            }
        }
    }
}
