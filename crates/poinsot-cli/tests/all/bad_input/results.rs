//! 2b: faults of a result file.

use crate::bad_input::row::{Row, row};

pub fn rows() -> Vec<Row> {
    vec![
        row(
            "R1",
            "nominal inertia indefinite",
            |b| b.model("xx = 15.0", "xx = -15.0"),
            2,
            &[
                "E0115 m.toml:8:17: body[0].inertia_kg_m2 (body \"bus\")",
                "the smallest principal moment is negative: -15, 16, 21 kg m2",
            ],
        ),
        row(
            "R1",
            "nominal triangle inequality broken",
            |b| b.model("zz = 21.0", "zz = 40.0"),
            2,
            &[
                "E0115",
                "these principal moments are not physical: 15, 16, 40 kg m2, the largest exceeds the sum of the other two",
            ],
        ),
        row(
            "R1",
            "negative mass",
            |b| b.model("mass_kg = 150.0", "mass_kg = -150.0"),
            2,
            &[
                "E0115 m.toml:6:11: body[0].mass_kg (body \"bus\") = -150.0: the mass is negative; give a positive mass",
            ],
        ),
        row(
            "R1",
            "telemetry that asks for an impossible body",
            |b| b.spoil(|s| s.map("wheel", |_, w| -w)),
            1,
            &["a wrong sign of all wheels would explain"],
        ),
        row(
            "R3",
            "wheels that have no momentum to speak of",
            |b| {
                for k in 1..=3 {
                    b.model(
                        &format!("name = \"wheel{k}\""),
                        &format!("name = \"wheel{k}\" # tiny"),
                    );
                }
                let m = std::fs::read_to_string(b.path("m.toml"))
                    .unwrap()
                    .replace("0.0004113", "4.113e-20");
                b.write("m.toml", m);
            },
            1,
            &[": Contradicted. "],
        )
        .never(&["every number"]),
        row(
            "R5",
            "a mass of 1e31 kg",
            |b| b.model("mass_kg = 150.0", "mass_kg = 1e31"),
            2,
            &[
                "E0108 m.toml:6:11: body[0].mass_kg (body \"bus\") = 1e31: the number is larger than 1e30",
            ],
        ),
        row(
            "R5",
            "a quantisation of 1e-310",
            |b| {
                b.model(
                    "noise_rad_s = 0.0001",
                    "noise_rad_s = 0.0001\nquantisation_rad_s = 1e-310",
                )
            },
            2,
            &[
                "E0118 m.toml:33:22: sensor[0].quantisation_rad_s (sensor \"gyro\") = 1e-310: the quantisation is below 1e-100; give that of a real instrument",
            ],
        ),
        row(
            "R5",
            "noise of 1e-300",
            |b| b.model("noise_rad_s = 0.0001", "noise_rad_s = 1e-300"),
            2,
            &[
                "E0118 m.toml:32:15: sensor[0].noise_rad_s (sensor \"gyro\") = 1e-300: the noise is below 1e-100; give the noise of a real instrument",
            ],
        ),
    ]
}
