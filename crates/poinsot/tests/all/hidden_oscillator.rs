//! Whether unmodelled slosh or flexibility is detected: the table of `docs/validation/hidden_oscillator.md`.
//!
//! The true vehicle has a pendulum, or a panel on a hinge, with spring and damper; the model does not. Each trial
//! draws new sensor noise. A trial counts as detected if the answer is rejected, its covariance is marked unreliable,
//! and the reported line is within 5 % of the hidden joint's frequency in the exact motion. In the last row of each
//! vehicle the hinge is locked, and nothing may be reported.

use crate::tables;
use poinsot::case::{Case, parse_case, read_case};
use poinsot::simulate::simulate_case;
use poinsot::trials::Study;
use poinsot::{Modes, Question, identify_tables};
use poinsot_identify::{Estimate, Status};
use poinsot_model::{Model, read_model};
use rayon::prelude::*;
use std::path::Path;

/// Case, hidden joint, and masses of the moving body, kg.
const HIDDEN: [(&str, &str, &[f64]); 2] = [
    ("slosh.toml", "slosh", &[0.75, 1.5, 3.0, 6.0]),
    ("hinged_panel.toml", "hinge", &[1.0, 2.0, 4.0]),
];

#[test]
#[ignore = "takes minutes"]
fn stat_table_of_hidden_oscillators() {
    tables::heading(&[
        "hidden",
        "share of the mass",
        "frequency",
        "trials",
        "chi-square per dof",
        "rejected",
        "not trustworthy",
        "line",
        "detected",
        "silent",
    ]);
    for (name, joint, masses) in HIDDEN {
        let masses = masses.iter().copied().map(Some);
        masses.chain([None]).for_each(|mass| row(name, joint, mass));
    }
}

/// The model stays rigid.
fn rigid() -> Question {
    Question {
        modes: Modes::None,
        ..Question::default()
    }
}

/// One set-up; without a mass the hinge is locked.
fn row(name: &str, joint: &str, mass: Option<f64>) {
    let what = mass.map_or(format!("{joint} locked"), |kg| format!("{joint} {kg} kg"));
    if !tables::wanted(&what) {
        return;
    }
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    let case = read_case(&cases.join(name)).unwrap();
    let mut truth = read_model(&case.model).unwrap();
    let at = truth.joint(joint).unwrap();
    let child = truth.joints[at].child;
    let spring = &mut truth.joints[at].spring_damper;
    match mass {
        Some(mass) => {
            let body = &mut truth.bodies[child].nominal;
            // Equal shape and stiffness per mass: equal frequency, smaller effect.
            let factor = mass / body.mass;
            body.mass = mass;
            body.I_BBcm_B *= factor;
            let spring = spring.as_mut().unwrap();
            spring.stiffness *= factor;
            spring.damping *= factor;
        }
        None => *spring = None,
    }
    let whole: f64 = truth.bodies.iter().map(|b| b.nominal.mass).sum();
    let share = truth.bodies[child].nominal.mass / whole;
    let frequency = mass.map(|_| swing(&case, &truth, joint));
    let model = read_model(cases.join("rigid_bus.toml")).unwrap();
    let study = Study::of_case(&case, &truth, model.clone()).unwrap();
    let all: Vec<Estimate> = (0..tables::trials(100))
        .into_par_iter()
        .map(|trial| identify_tables(model.clone(), study.draw(trial).0, &rigid()))
        .map(|answer| answer.unwrap().estimate)
        .collect();
    let count = |of: &dyn Fn(&Estimate) -> bool| all.iter().filter(|e| of(e)).count();
    let near = |hz: f64| frequency.is_none_or(|f| (hz / f - 1.0).abs() < 0.05);
    let named = |e: &Estimate| e.warnings().iter().filter_map(|w| line(w)).any(near);
    let rejected = |e: &Estimate| e.status == Status::Rejected;
    let doubted = |e: &Estimate| !e.covariance_trustworthy();
    let detected = count(&|e| rejected(e) && doubted(e) && named(e));
    let silent = count(&|e| e.status == Status::Converged && !doubted(e));
    let chi2 = all
        .iter()
        .filter_map(|e| e.fit.first())
        .map(|f| f.chi2_per_dof);
    tables::row(&[
        what,
        format!("{:.2} %", 100.0 * share),
        frequency.map_or("-".to_owned(), |hz| format!("{hz:.3} Hz")),
        all.len().to_string(),
        format!("{:.2}", chi2.sum::<f64>() / all.len() as f64),
        count(&rejected).to_string(),
        count(&doubted).to_string(),
        count(&named).to_string(),
        detected.to_string(),
        silent.to_string(),
    ]);
    match mass {
        None => assert_eq!(silent, all.len(), "nothing is hidden"),
        Some(kg) if kg == 3.0 => assert_eq!(detected, all.len(), "{joint} {kg} kg"),
        Some(_) => {}
    }
}

/// Frequency of the joint in the exact motion after the last torque, from its crossings of the mean, Hz.
fn swing(case: &Case, truth: &Model, joint: &str) -> f64 {
    let mut exact = truth.clone();
    exact.sensors.clear();
    let text = std::fs::read_to_string(case.path()).unwrap();
    let case = parse_case(case.path(), text.replace("sensors_only = true", "")).unwrap();
    let table = simulate_case(&case, &exact).unwrap().table;
    let angle = table.channel(&format!("{joint}_rad")).unwrap();
    let samples = angle
        .time_s
        .iter()
        .copied()
        .zip(angle.values.iter().copied());
    let free: Vec<(f64, f64)> = samples.filter(|(t, _)| *t > 176.0).collect();
    let mean = free.iter().map(|(_, q)| q).sum::<f64>() / free.len() as f64;
    let crossings: Vec<f64> = free
        .windows(2)
        .filter(|w| w[0].1 < mean && w[1].1 >= mean)
        .map(|w| w[0].0 + (w[1].0 - w[0].0) * (mean - w[0].1) / (w[1].1 - w[0].1))
        .collect();
    (crossings.len() - 1) as f64 / (crossings[crossings.len() - 1] - crossings[0])
}

/// The frequency named in a warning, Hz.
fn line(warning: &str) -> Option<f64> {
    let rest = warning.split("a line at ").nth(1)?;
    rest.split(' ').next()?.parse().ok()
}
