//! The advantages of option 2 stated in Sec. II.B: less bias, and relative velocities from accelerometers.

use super::experiment::{Experiment, readings, unsymmetric};
use super::noise::OPTIONS;
use crate::ma2008::{Raw, two_step};
use crate::study::statistics::rms;
use crate::study::{Context, Findings, StudyError, Table, decimals, percent, word};
use poinsot_model::Model;
use poinsot_spatial::Vector3;

/// Ten samples at stops of trajectory 1 at 5 deg/s, base origin at rest.
pub fn offset_experiment(table1: &Model, full_tensor: bool) -> Experiment {
    let e = Experiment::new(table1, 1, [0.0, 0.0, 5.0]);
    if full_tensor {
        e.with_base(unsymmetric())
    } else {
        e
    }
}

/// Mass (kg) and relative error of the tensor for both options, for exact data with an error added to each sample.
///
/// # Errors
/// The motion cannot be computed.
pub fn both(e: &Experiment, error: impl Fn(&mut Raw)) -> Result<[[f64; 2]; 2], StudyError> {
    let run = e.run()?;
    let mut raws = run.raws;
    raws.iter_mut().for_each(error);
    let samples = [readings(&e.model, &raws)];
    let truth = e.truth().I_BBcm_B;
    Ok(OPTIONS.map(|known| {
        let found = two_step(&samples, known.then_some(run.known));
        let off = found.I_S().map(|I| (I - truth).norm() / truth.norm());
        [found.mass(), off.unwrap_or(f64::NAN)]
    }))
}

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let table1 = context.model("cases/ma2008_truth.toml")?;
    let head = "constant error | option 1 | option 2";
    let mut offsets = Table::new(
        "offset",
        "Mass of the base, kg (true 1000 kg), with a constant offset of the velocity in N",
        head,
    );
    let mut biases = Table::new(
        "bias",
        "Error of the tensor, %, with a constant bias of the gyro",
        head,
    );
    let mut drifting = Table::new(
        "drifting",
        "Table 1 base, drifting (0.02, -0.01, 0.005) m/s, 2 Hz over 135 s while the joints move",
        "constant error | number | option 1 | option 2",
    );
    let axes = [
        ("x", Vector3::x()),
        ("y", Vector3::y()),
        ("z", Vector3::z()),
    ];
    let mut of_bias = Vec::new();
    for (base, full) in [("Table 1 base", false), ("unsymmetric base", true)] {
        let e = offset_experiment(&table1, full);
        for offset in [1.0, 0.1, 0.01, 0.001] {
            for (name, axis) in [axes[0], axes[2]] {
                let found = both(&e, |raw| raw.v_NBo_N += axis * offset)?;
                let title = format!("{base}, {offset} m/s along {name}");
                offsets.row(title, found.map(|f| decimals(f[0], 3)));
            }
        }
        for (name, axis) in axes {
            let found = both(&e, |raw| raw.w_NB_B += axis * 1.0e-4)?;
            biases.row(
                format!("{base}, 1e-4 rad/s about {name}"),
                found.map(|f| percent(f[1], 2)),
            );
            if !full {
                of_bias.push(found.map(|f| f[1]));
            }
        }
    }
    let mut e = offset_experiment(&table1, false)
        .sampled(2, false)
        .drifting(0.02);
    e.times = (0..=270).map(|k| 0.5 * f64::from(k)).collect();
    for (unit, size) in [("m/s", 1.0), ("mm/s", 1.0e-3)] {
        let offset = Vector3::new(1.0, -0.5, 0.25) * size;
        let found = both(&e, |raw| raw.v_NBo_N += offset)?;
        let cells = found.map(|f| decimals(f[0], 1));
        let title = format!("velocity (1, -0.5, 0.25) {unit}");
        drifting.row(title, std::iter::once(word("mass, kg")).chain(cells));
    }
    let bias = Vector3::new(1.0, -1.0, 0.5) * 1.0e-4;
    let found = both(&e, |raw| raw.w_NB_B += bias)?;
    let cells = found.map(|f| percent(f[1], 2));
    let title = "gyro (1, -1, 0.5) 1e-4 rad/s";
    drifting.row(title, std::iter::once(word("tensor, %")).chain(cells));
    let mut findings = Findings::of(offsets);
    findings.tables.extend([biases, drifting]);
    let [one, two] = [0, 1].map(|k| percent(rms(of_bias.iter().map(|b| b[k])), 2).text());
    findings.state(
        "increments have less bias",
        format!("{one} and {two} %, rms of three axes"),
    );
    Ok(findings)
}
