//! The result file, `poinsot.estimate/1`.

use crate::diagnostics_file::DiagnosticsFile;
use crate::identify::Identified;
use poinsot_identify::{
    BodyEstimate, Estimate, Identifiability, MomentumEstimate, Number, axis_name, tensor_name,
};
use serde_json::{Map, Value, json};

/// Order of the inertia entries in the file.
const INERTIA_ORDER: [usize; 6] = [0, 2, 5, 1, 3, 4];

/// The answer as the machine-readable result.
pub fn estimate_json(identified: &Identified) -> Value {
    let e = &identified.estimate;
    let inputs: Vec<Value> = identified
        .inputs
        .iter()
        .enumerate()
        .flat_map(|(segment, files)| files.iter().map(move |f| (segment, f)))
        .map(|(segment, f)| {
            json!({ "path": f.path, "sha256": f.sha256, "segment": segment, "time_s": f.time_s, "rows": f.rows })
        })
        .collect();
    let bodies: Map<String, Value> = e.bodies.iter().map(|b| (b.name.clone(), body(b))).collect();
    let mut file = json!({
        "schema": "poinsot.estimate/1",
        "poinsot": env!("CARGO_PKG_VERSION"),
        "method": e.method,
        "variant": e.variant,
        "status": e.status.name(),
        "iterations": e.iterations,
        "model": identified.model.name,
        "inputs": inputs,
        "bodies": bodies,
        "covariance": { "names": e.covariance_names, "units": e.covariance_units, "matrix": e.covariance },
        "system": system(identified),
        "momentum": e.momentum.iter().map(momentum).collect::<Vec<_>>(),
        "nuisance": nuisance(e),
        "identifiability": identifiability(&e.identifiability),
        "fit": e.fit.iter().map(|f| json!({
            "segment": f.label,
            "samples": f.samples,
            "chi2_per_dof": f.chi2_per_dof,
            "channels": f.channels.iter().map(|c| (c.name.to_owned(), json!({
                "rms": c.rms,
                "unit": c.unit,
                "chi2_per_number": c.chi2_per_number,
                "whiteness_p": c.whiteness_p,
            }))).collect::<Map<String, Value>>(),
        })).collect::<Vec<_>>(),
        "diagnostics": e.diagnostics.as_ref().map(DiagnosticsFile::new),
        "covariance_trustworthy": e.covariance_trustworthy,
        "doubts": e.doubts,
        "method_report": e.method_report.as_ref().map(|r| json!({
            "note": r.note,
            "numbers": r.numbers.iter().map(|n| json!({
                "name": n.name,
                "unit": n.unit,
                "value": n.number.value,
                "sigma": n.number.sigma,
                "nominal": n.number.nominal,
            })).collect::<Vec<_>>(),
        })),
        "telemetry_checks": identified.findings,
        "repairs": identified.repairs,
        "ignored_columns": identified.ignored,
        "warnings": e.warnings,
    });
    if let (Some(epoch), Some(map)) = (epoch(identified), file.as_object_mut()) {
        map.insert("epoch".to_owned(), epoch);
    }
    file
}

/// What all times count from: a date, or a number of the files' own count; `None` where that is zero.
fn epoch(identified: &Identified) -> Option<Value> {
    let origin = identified.origin?;
    match origin.date() {
        Some(date) => {
            let (at, scale) = date.split_once(' ')?;
            Some(json!({ "at": at, "scale": scale }))
        }
        None if origin.own_zero_s() == 0.0 => None,
        None => Some(json!({ "own_count_s": origin.own_zero_s() })),
    }
}

fn body(b: &BodyEstimate) -> Value {
    json!({
        "mass_kg": number(&b.mass),
        "com_m": vector(&b.com),
        "inertia_kg_m2": tensor(&b.inertia),
        "principal": b.principal.as_ref().map(|p| json!({
            "moments_kg_m2": p.moments,
            "axes_xyzw": p.axes_xyzw,
        })),
        "barycentric": {
            "m_kg": number(&b.barycentric[0]),
            "mc_kg_m": vector(&[b.barycentric[1], b.barycentric[2], b.barycentric[3]]),
            "I_BBo_kg_m2": tensor(&std::array::from_fn(|k| b.barycentric[4 + k])),
        },
        "physically_consistent": b.physically_consistent,
    })
}

fn number(n: &Number) -> Value {
    json!({ "value": n.value, "sigma": n.sigma, "nominal": n.nominal, "source": n.source.name() })
}

fn vector(v: &[Number; 3]) -> Value {
    json!({
        "value": v.map(|n| n.value),
        "sigma": v.map(|n| n.sigma),
        "nominal": v.map(|n| n.nominal),
        "source": v.map(|n| n.source.name()),
    })
}

fn tensor(t: &[Number; 6]) -> Value {
    let entries = |pick: &dyn Fn(&Number) -> Value| -> Value {
        INERTIA_ORDER
            .iter()
            .map(|&k| (tensor_name(k).to_owned(), pick(&t[k])))
            .collect::<Map<String, Value>>()
            .into()
    };
    json!({
        "value": entries(&|n| json!(n.value)),
        "sigma": entries(&|n| json!(n.sigma)),
        "nominal": entries(&|n| json!(n.nominal)),
        "source": entries(&|n| json!(n.source.name())),
    })
}

fn system(identified: &Identified) -> Vec<Value> {
    let Some((whole, position)) = &identified.estimate.system else {
        return Vec::new();
    };
    let joints: Map<String, Value> = identified
        .model
        .joints
        .iter()
        .filter(|j| j.kind != poinsot_model::JointKind::Fixed)
        .zip(position)
        .map(|(j, q)| {
            let unit = match j.kind {
                poinsot_model::JointKind::Prismatic => "m",
                _ => "rad",
            };
            (format!("{}_{unit}", j.name), json!(q))
        })
        .collect();
    let mut value = body(whole);
    if let Value::Object(map) = &mut value {
        map.insert("joint_positions".to_owned(), joints.into());
    }
    vec![value]
}

fn momentum(m: &MomentumEstimate) -> Value {
    json!({ "linear_N_s": vector(&m.linear), "angular_N_m_s": vector(&m.angular) })
}

fn nuisance(e: &Estimate) -> Map<String, Value> {
    e.nuisance
        .iter()
        .map(|n| {
            let unit = match n.unit {
                "1" => String::new(),
                unit => format!("_{}", unit.replace(['/', ' '], "_")),
            };
            (format!("{}{unit}", n.name), number(&n.number))
        })
        .collect()
}

/// What the data determine and leave open, as in the result file.
pub(crate) fn identifiability(i: &Identifiability) -> Value {
    let coefficients = |list: &[(String, f64)]| -> Map<String, Value> {
        list.iter()
            .map(|(name, c)| (name.clone(), json!(c)))
            .collect()
    };
    json!({
        "parameters": i.parameters,
        "rank": i.rank,
        "structural_rank": i.structural_rank,
        "sigmas_natural": i.sigmas_natural,
        "identifiable": i.determined.iter().map(|c| json!({
            "combination": c.text,
            "coefficients": coefficients(&c.coefficients),
            "unit": c.unit,
            "value": c.value,
            "sigma": c.sigma,
        })).collect::<Vec<_>>(),
        "not_identifiable": i.open.iter().map(|c| json!({
            "combination": c.text,
            "coefficients": coefficients(&c.coefficients),
            "reason": c.reason,
            "remedy": c.remedy,
        })).collect::<Vec<_>>(),
    })
}

/// Names of the axes, for tables.
pub(crate) fn component(prefix: &str, k: usize) -> String {
    format!("{prefix}_{}", axis_name(k))
}

/// Tensor entries in the order of the file: index and name.
pub(crate) fn inertia_entries() -> impl Iterator<Item = (usize, &'static str)> {
    INERTIA_ORDER.iter().map(|&k| (k, tensor_name(k)))
}
