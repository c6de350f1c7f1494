//! Python that sets the hub of a Basilisk spacecraft.

use super::{Exported, Source};
use crate::error::Error;
use poinsot_spatial::MassProperties;
use std::fmt::Write as _;

/// A module with the numbers of every determined body, and a function that copies one body into a hub.
pub(super) fn text(source: &Source) -> Result<Exported, Error> {
    let (bodies, left_out) = source.bodies();
    let Some(first) = bodies.first() else {
        return Err(source.nothing(&left_out, ""));
    };
    let mut out =
        String::from("\"\"\"Mass properties for Basilisk, identified from telemetry.\n\n");
    for line in source.origin().iter().chain(&left_out) {
        let _ = writeln!(out, "{}", line.replace('\\', "/").replace('"', "'"));
    }
    out.push_str("\"\"\"\n\n# Mass centre from the origin of the body frame, inertia about the mass centre, both in body axes.\n# Wheels are inside of the body's numbers as if they were locked, as for Basilisk's balanced wheels.\nBODIES = {\n");
    for body in &bodies {
        let _ = writeln!(
            out,
            "    {:?}: {{\n{}    }},",
            body.body,
            numbers(&body.properties)
        );
    }
    let _ = write!(
        out,
        "}}\n\n\ndef set_hub(spacecraft, body={:?}):\n    \"\"\"Set the hub of a Basilisk spacecraft; the body frame is Basilisk's B.\"\"\"\n    numbers = BODIES[body]\n    spacecraft.hub.mHub = numbers[\"mass_kg\"]\n    spacecraft.hub.r_BcB_B = [[x] for x in numbers[\"com_m\"]]\n    spacecraft.hub.IHubPntBc_B = numbers[\"inertia_kg_m2\"]\n",
        first.body
    );
    Ok(Exported {
        text: out,
        left_out,
        no_field: Vec::new(),
    })
}

fn numbers(p: &MassProperties) -> String {
    let c = &p.p_BoBcm_B;
    let rows: Vec<String> = p
        .I_BBcm_B
        .row_iter()
        .map(|r| format!("            [{:?}, {:?}, {:?}],\n", r[0], r[1], r[2]))
        .collect();
    format!(
        "        \"mass_kg\": {:?},\n        \"com_m\": [{:?}, {:?}, {:?}],\n        \"inertia_kg_m2\": [\n{}        ],\n",
        p.mass,
        c.x,
        c.y,
        c.z,
        rows.concat()
    )
}
