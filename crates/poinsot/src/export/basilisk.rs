//! Python that sets the hub of a Basilisk spacecraft.

use super::{Exported, Source};
use crate::error::Error;
use poinsot_spatial::MassProperties;
use std::collections::BTreeMap;
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
    let springs = springs(source);
    if !springs.is_empty() {
        let _ = write!(
            out,
            "\n\n# Springs of joints, N m/rad and N m s/rad, or N/m and N s/m.\nSPRINGS = {{\n"
        );
        for (joint, [stiffness, damping]) in &springs {
            let _ = writeln!(
                out,
                "    {joint:?}: {{\"k\": {stiffness:?}, \"c\": {damping:?}}},"
            );
        }
        out.push_str("}\n\n\ndef set_spring(effector, joint):\n    \"\"\"Set the spring of a hinged body, or of a particle of slosh.\"\"\"\n    for name, value in SPRINGS[joint].items():\n        setattr(effector, name, value)\n");
    }
    Ok(Exported {
        text: out,
        left_out,
        parts: springs.into_keys().collect(),
        ..Exported::default()
    })
}

/// Stiffness and damping of joints with both.
fn springs(source: &Source) -> BTreeMap<String, [f64; 2]> {
    let numbers = source.numbers();
    let of = |begin: &str| {
        let own = numbers.iter().filter(move |n| n.key.starts_with(begin));
        own.map(|n| (n.part.clone(), n.value))
            .collect::<BTreeMap<_, _>>()
    };
    let damping = of("damping_N");
    let both = of("stiffness_").into_iter();
    let both = both.filter_map(|(part, k)| Some((part.clone(), [k, *damping.get(&part)?])));
    both.collect()
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
