//! The table of evidence: every test of an answer, from which its reliability follows.

use crate::shared::sigma_factor;
use crate::trust::{Record, STSAT3, example, run, with_prior};
use poinsot::case::read_case;
use poinsot::simulate::simulate_case;
use poinsot::{
    Identified, IdentifyRequest, Modes, Question, estimate_file, identify, identify_tables,
};
use poinsot_formats::{EstimateFile, contradictions};
use poinsot_identify::{Effect, Remark};
use poinsot_model::read_model;
use poinsot_report::Standing;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Words of the rows against the answer, taken from the file by the definition of `doubts`.
fn against(file: &EstimateFile) -> Vec<String> {
    let effects = ["against_answer", "withholds_numbers", "rejects_model"];
    let mut words: Vec<String> = Vec::new();
    for row in &file.evidence {
        if effects.contains(&row.effect.as_str()) && !words.contains(&row.words) {
            words.push(row.words.clone());
        }
    }
    words
}

/// Keys that contradict the rest of the file.
fn differing(file: &EstimateFile) -> Vec<String> {
    contradictions(file)
        .into_iter()
        .map(|c| c.place.key)
        .collect()
}

/// Everything that says whether an answer is reliable is what its rows say.
#[track_caller]
fn assert_rows_decide(answer: &Identified, expected: &[&str]) {
    let (e, file) = (&answer.estimate, estimate_file(answer));
    let words = against(&file);
    assert_eq!(words.len(), expected.len(), "{words:?}");
    for (word, expected) in words.iter().zip(expected) {
        assert!(word.contains(expected), "{words:?}");
    }
    assert_eq!((&e.doubts(), &file.doubts), (&words, &words));
    assert_eq!(differing(&file), Vec::<String>::new());
    assert_eq!(e.covariance_trustworthy(), words.is_empty());
    assert_eq!(Standing::of(&file).doubted, !words.is_empty());
    let rejects = |effect: &str| file.evidence.iter().any(|row| row.effect == effect);
    assert_eq!(file.status == "rejected", rejects("rejects_model"));
    assert_eq!(
        answer.passes(),
        file.status == "converged" && words.is_empty()
    );
    let factors = file.evidence.iter().filter_map(|row| row.sigma_factor);
    let largest = factors.fold(1.0, f64::max);
    assert_eq!(sigma_factor(e), largest);
    if !words.is_empty() && !file.is_withheld() {
        let widened = format!("sigmas are widened {largest:.1} times");
        assert!(
            e.warnings().iter().any(|w| w.ends_with(&widened)),
            "{:?}",
            e.warnings()
        );
    }
}

fn rows<'a>(answer: &'a Identified, test: &str) -> Vec<&'a Remark> {
    let all = answer.estimate.tests();
    all.filter(|row| row.test == test).collect()
}

#[test]
fn stat_a_clean_record_passes_every_test() {
    let answer = run(&example("stsat3/model.toml"), &example(STSAT3));
    assert_rows_decide(&answer, &[]);
    for row in answer.estimate.tests() {
        assert!(row.effect <= Effect::WidensSigmas, "{row:?}");
        assert!(row.sigma_factor < 1.02, "{row:?}");
    }
    for sensor in &answer.estimate.fit[0].channels {
        let found = rows(&answer, &format!("residual of the {}", sensor.name));
        assert_eq!(found.len(), 1);
        assert_eq!(
            (found[0].effect, found[0].sigma_factor),
            (Effect::None, 1.0)
        );
    }
    for test in [
        "rigid model",
        "convergence",
        "all residuals",
        "momentum drift",
    ] {
        assert_eq!(rows(&answer, test).len(), 1, "{test}");
    }
}

/// Chi-square and p of every sensor and of all together are those of the definition.
#[test]
fn exact_p_values_are_tails_of_chi_square() {
    let answer = run(&example("stsat3/model.toml"), &example(STSAT3));
    let found = answer.estimate.diagnostics.as_ref().unwrap();
    let pooled = rows(&answer, "all residuals")[0];
    assert_eq!(pooled.degrees_of_freedom, Some(found.dof));
    assert!((pooled.statistic.unwrap().1 / found.chi2 - 1.0).abs() < 1.0e-9);
    let mut compared = 0;
    for row in answer.estimate.tests() {
        let of_noise = row.test.starts_with("residual of the") || row.test == "all residuals";
        if let (true, Some((_, square)), Some(dof)) =
            (of_noise, row.statistic, row.degrees_of_freedom)
        {
            let tail = ChiSquared::new(dof as f64).unwrap().sf(square);
            assert!((row.p.unwrap() - tail).abs() < 1.0e-3, "{row:?}: {tail}");
            compared += 1;
        }
    }
    assert!(compared >= 5, "{compared}");
}

/// White noise three times as large as declared: the sensor speaks, in its whole residual.
#[test]
fn stat_underestimated_noise_is_a_row_of_its_sensor() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(example("stsat3/model.toml")).unwrap();
    let declared = "noise_rad_s = 0.0001";
    assert!(text.contains(declared));
    let model = folder.path().join("model.toml");
    std::fs::write(&model, text.replace(declared, "noise_rad_s = 0.00003333")).unwrap();
    let answer = run(&model, &example(STSAT3));
    assert_rows_decide(&answer, &["the residual of the gyro is 3.0"]);
    let gyro = rows(&answer, "residual of the gyro")[0];
    assert_eq!(gyro.effect, Effect::AgainstAnswer);
    assert!((gyro.sigma_factor / 3.0 - 1.0).abs() < 0.02, "{gyro:?}");
    assert!(gyro.p.unwrap() < 1.0e-100);
    let attitude = rows(&answer, "residual of the attitude")[0];
    assert_eq!(attitude.effect, Effect::None);
}

#[test]
fn stat_a_prior_is_a_row_whether_it_agrees_or_not() {
    for (sigma, agrees) in [(0.5, true), (0.005, false)] {
        let folder = tempfile::tempdir().unwrap();
        let answer = run(&with_prior(folder.path(), sigma), &example(STSAT3));
        let row = rows(&answer, "priors of mass properties against the data")[0];
        let (_, square) = row.statistic.unwrap();
        let tail = ChiSquared::new(row.degrees_of_freedom.unwrap() as f64)
            .unwrap()
            .sf(square);
        assert_eq!(row.p, Some(tail));
        if agrees {
            assert_rows_decide(&answer, &[]);
            assert_eq!((row.effect, row.sigma_factor), (Effect::None, 1.0));
        } else {
            assert_rows_decide(&answer, &["a prior is inconsistent with the data"]);
            assert_eq!(row.effect, Effect::AgainstAnswer);
            assert_eq!(row.sigma_factor, sigma_factor(&answer.estimate));
        }
    }
}

/// A hidden pendulum: the spectral line is a row, and the rejection is the first.
#[test]
fn stat_a_vehicle_that_is_not_rigid_is_rejected_by_its_rows() {
    let case = read_case(&example("cases/slosh.toml")).unwrap();
    let table = simulate_case(&case, &read_model(&case.model).unwrap())
        .unwrap()
        .table;
    let model = read_model(example("cases/rigid_bus.toml")).unwrap();
    let rigid = Question {
        modes: Modes::None,
        ..Question::default()
    };
    let answer = identify_tables(model, vec![table], &rigid).unwrap();
    let words = answer.estimate.doubts();
    let line = "a spectral line in the residual: the vehicle is not rigid";
    assert_eq!(words[0], "the data are inconsistent with the rigid model");
    assert!(words.iter().any(|w| w == line), "{words:?}");
    let expected: Vec<&str> = words.iter().map(String::as_str).collect();
    assert_rows_decide(&answer, &expected);
    assert_eq!(answer.estimate.remarks[0].effect, Effect::RejectsModel);
    let (_, share) = rows(&answer, "spectral line")[0].statistic.unwrap();
    let found = answer.estimate.diagnostics.as_ref().unwrap();
    assert!(found.lines.iter().any(|line| line.share == share));
}

/// Joints 100 ms late: rejected, and numbers withheld.
#[test]
fn stat_withheld_numbers_have_a_row_that_rejects() {
    let mut record = Record::of("ma2008/traj1/telemetry_noisy.csv");
    let joints = record.columns("joint");
    let early = record.rows.clone();
    for (row, before) in record.rows.iter_mut().skip(2).zip(&early) {
        joints.iter().for_each(|k| row[*k].clone_from(&before[*k]));
    }
    record.rows.drain(..2);
    let answer = run(&example("ma2008/model_noisy.toml"), &record.write());
    let words = answer.estimate.doubts();
    let expected: Vec<&str> = words.iter().map(String::as_str).collect();
    assert_eq!(words[0], "the data are inconsistent with the rigid model");
    assert_rows_decide(&answer, &expected);
}

/// The methods without a fit of single samples have rows, too.
#[test]
fn prop_rows_decide_for_every_method() {
    for (method, model, telemetry) in [
        ("linear", "stsat3/model.toml", STSAT3),
        ("kim2010", "stsat3/model.toml", STSAT3),
        (
            "ma2008",
            "ma2008/model_noisy.toml",
            "ma2008/traj1/telemetry_noisy.csv",
        ),
    ] {
        let request = IdentifyRequest::new(example(model), [example(telemetry)]);
        let answer = identify(&request.by(method)).unwrap();
        let words = answer.estimate.doubts();
        let file = estimate_file(&answer);
        assert_eq!(
            (&against(&file), &file.doubts),
            (&words, &words),
            "{method}"
        );
        assert_eq!(differing(&file), Vec::<String>::new(), "{method}");
        assert!(!rows(&answer, "rigid model").is_empty(), "{method}");
        assert!(!rows(&answer, "all residuals").is_empty(), "{method}");
    }
}

/// A file whose words, status or reliability differ from its rows is contradictory; one without rows is not.
#[test]
fn unit_a_file_that_differs_from_its_rows_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let answer = run(&with_prior(folder.path(), 0.005), &example(STSAT3));
    let file = estimate_file(&answer);
    let changed = |change: fn(&mut EstimateFile)| {
        let mut file = file.clone();
        change(&mut file);
        differing(&file)
    };
    assert_eq!(changed(|f| f.doubts.clear()), ["doubts"]);
    assert_eq!(changed(|f| f.status = "rejected".to_owned()), ["status"]);
    assert_eq!(
        changed(|f| f.covariance_trustworthy = true),
        ["covariance_trustworthy"]
    );
    assert_eq!(changed(|f| f.evidence[0].p = Some(1.5)), ["evidence[0].p"]);
    assert_eq!(
        changed(|f| f.evidence[0].effect = "good".to_owned()),
        ["evidence[0].effect"]
    );
    // A file of an earlier version.
    assert_eq!(changed(|f| f.evidence.clear()), Vec::<String>::new());
    let mut earlier = file.clone();
    earlier.evidence.clear();
    assert!(Standing::of(&earlier).doubted);
    assert_eq!(
        earlier.evidence_against(),
        ["a prior is inconsistent with the data"]
    );
}

/// Times that are 1 % too long scale all rates alike: 110 sigma, and trusted, before the equal scales were a doubt.
#[test]
fn regress_a_wrong_clock_is_not_three_scales_of_a_gyro() {
    let folder = tempfile::tempdir().unwrap();
    let model = std::fs::read_to_string(crate::shared::stsat3().join("model.toml")).unwrap();
    let gyro = "noise_rad_s = 0.0001\n";
    assert!(model.contains(gyro));
    let model = model.replace(gyro, &format!("{gyro}scale = \"estimate\"\n"));
    let [file, stretched] = ["model.toml", "telemetry.csv"].map(|name| folder.path().join(name));
    std::fs::write(&file, model).unwrap();
    let record = crate::shared::stsat3().join("multiaxis/telemetry_noisy.csv");
    let text = std::fs::read_to_string(&record).unwrap();
    let slow = |line: &str| {
        let (time, rest) = line.split_once(',').unwrap();
        let time = time.parse::<f64>().map(|t| (1.01 * t).to_string());
        format!("{},{rest}\n", time.unwrap_or_else(|_| "time_s".to_owned()))
    };
    std::fs::write(&stretched, text.lines().map(slow).collect::<String>()).unwrap();
    let doubts = |telemetry| {
        let answer = identify(&IdentifyRequest::new(file.clone(), [telemetry])).unwrap();
        answer.estimate.doubts()
    };
    assert_eq!(doubts(record), Vec::<String>::new());
    let of_clock = doubts(stretched);
    println!("{of_clock:?}");
    let equal = |d: &String| d.starts_with("the three scales of gyro are equal, 0.99");
    assert!(of_clock.iter().any(equal), "{of_clock:?}");
}
