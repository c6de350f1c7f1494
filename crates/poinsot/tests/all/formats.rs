//! Formats of results: each has one type that writes, reads and describes it, and no other code knows its structure.

use poinsot::predict::{predict, prediction_file};
use poinsot::{IdentifyRequest, estimate_file, identify};
use poinsot_formats::{PredictionFile, parse_estimate, parse_result, result_text};
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn exact_results_read_back_as_they_were() {
    let shipped = root().join("data");
    for (model, telemetry) in [
        ("stsat3/model.toml", "stsat3/multiaxis/telemetry_noisy.csv"),
        (
            "ma2008/model_noisy.toml",
            "ma2008/traj1/telemetry_noisy.csv",
        ),
    ] {
        let request = IdentifyRequest::new(shipped.join(model), [shipped.join(telemetry)]);
        let file = estimate_file(&identify(&request).unwrap());
        let text = result_text(&file, true).unwrap();
        let read = parse_estimate(Path::new("estimate.json"), text.as_bytes()).unwrap();
        assert_eq!(read, file, "{model}");
        assert_eq!(file.model_file.unwrap().sha256.len(), 64);
    }
    let found = predict(&shipped.join("cases/tug_thrusters.toml"), 1.0).unwrap();
    let file = prediction_file(&found);
    let text = result_text(&file, false).unwrap();
    let read: PredictionFile = parse_result(Path::new(""), text.as_bytes()).unwrap();
    assert_eq!(read, file);
}

/// Every number of a prediction has the name that it has in an estimate.
#[test]
fn exact_predict_and_identify_use_the_same_names() {
    let shipped = root().join("data");
    let found = predict(&shipped.join("cases/ma2008_traj1.toml"), 1.0).unwrap();
    let predicted = prediction_file(&found);
    let request = IdentifyRequest::new(
        shipped.join("ma2008/model_noisy.toml"),
        [shipped.join("ma2008/traj1/telemetry_noisy.csv")],
    );
    let identified = estimate_file(&identify(&request).unwrap());
    let value = serde_json::to_value(&predicted).unwrap();
    for (name, body) in &predicted.bodies {
        let own = &identified.bodies[name];
        assert!(own.com_m.named().map(|n| n.0) == body.com_m.named().map(|n| n.0));
        assert!(value["bodies"][name]["inertia_kg_m2"]["xy"]["sigma"].is_number());
    }
    for row in &predicted.covariance.names {
        assert!(identified.covariance.names.contains(row), "{row}");
    }
}

/// Cases and plans are types with one reader and one writer: written files read back equal, and `check` gives the same
/// description.
#[test]
fn exact_cases_and_plans_read_back_as_they_were() {
    use poinsot_formats::{PlanFile, case::CaseFile};
    let texts = |folder: &str| {
        let files = std::fs::read_dir(root().join("data").join(folder)).unwrap();
        let paths = files.map(|f| f.unwrap().path());
        let toml = paths.filter(|p| p.extension().is_some_and(|e| e == "toml"));
        let read = toml.map(|p| std::fs::read_to_string(p).unwrap());
        read.collect::<Vec<_>>()
    };
    let mut cases = 0;
    for text in texts("cases") {
        let Ok(file) = toml::from_str::<CaseFile>(&text) else {
            assert!(!text.contains("poinsot.case/"), "{text}");
            continue;
        };
        let written = toml::to_string(&file).unwrap();
        assert_eq!(
            toml::from_str::<CaseFile>(&written).unwrap(),
            file,
            "{written}"
        );
        cases += 1;
    }
    assert!(cases > 10, "{cases}");
    for text in texts("campaigns") {
        let file = toml::from_str::<PlanFile>(&text).unwrap();
        let written = toml::to_string(&file).unwrap();
        assert_eq!(
            toml::from_str::<PlanFile>(&written).unwrap(),
            file,
            "{written}"
        );
    }
}

/// All faults of a case are reported together: of its structure, of its numbers, and of names unknown in the model.
#[test]
fn cli_check_tells_every_fault_of_a_case() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    let model = root().join("data/cases/tug_truth.toml");
    let told = |keys: &str| {
        let text = format!(
            "schema = \"poinsot.case/2\"\nmodel = {:?}\n{keys}",
            model.display().to_string()
        );
        std::fs::write(&path, text).unwrap();
        poinsot::check::check(&path).unwrap_err().to_string()
    };
    let said = told("duration_s = 10.0\ntypo = 1\n[output]\nrate_hz = \"fast\"\n");
    assert_eq!(said.lines().count(), 2, "{said}");
    let said = told(
        "duration_s = -1.0\n[output]\nrate_hz = 10.0\n[[firing]]\nthruster = \"none\"\non_s = 1.0\noff_s = 2.0\nforce_N = 1.0\n\
         [[want]]\nnumber = \"bus.mas_kg\"\nsigma = 1.0\n",
    );
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines.len(), 3, "{said}");
    for (line, part) in lines
        .iter()
        .zip(["duration_s", "firing[0].thruster", "want[0]"])
    {
        assert!(line.contains(part), "{said}");
    }
}

/// Every shipped case and plan matches the schema of `poinsot schema`: no unknown keys, no null.
#[test]
fn unit_schemas_of_cases_and_plans_know_every_key() {
    for (name, folder) in [("case", "cases"), ("plan", "campaigns")] {
        let schema = poinsot::schema(name).unwrap();
        assert!(!schema.to_string().contains("\"null\""), "{name}");
        for entry in std::fs::read_dir(root().join("data").join(folder)).unwrap() {
            let text = std::fs::read_to_string(entry.unwrap().path()).unwrap_or_default();
            let table: toml::Table = text.parse().unwrap_or_default();
            let of = table.get("schema").and_then(toml::Value::as_str);
            if of.is_some_and(|s| s.starts_with(&format!("poinsot.{name}/"))) {
                let known = schema["properties"].as_object().unwrap();
                assert!(table.keys().all(|key| known.contains_key(key)), "{text}");
            }
        }
    }
    let limits = poinsot::schema("case").unwrap();
    let limits = &limits["$defs"]["LimitsFile"]["properties"];
    assert_eq!(limits["clearance_m"]["type"], "number");
    assert!(poinsot::schema("map").unwrap()["properties"]["telemetry"].is_object());
}

#[test]
fn cli_every_kind_of_file_is_checked_and_said_in_words() {
    use poinsot::check::check;
    let shipped = root().join("data");
    let say = |path: &Path| check(path).map(|c| c.content.to_string());
    let case = say(&shipped.join("cases/tug_thrusters.toml")).unwrap();
    assert!(case.contains("120 s at 10 Hz: 1201 rows"), "{case}");
    assert!(case.contains("thruster thr1: 10 N from 2 to 8 s"), "{case}");
    let plan = say(&shipped.join("campaigns/tug_thrusters.toml")).unwrap();
    assert!(plan.contains("trials of"), "{plan}");
    for entry in std::fs::read_dir(shipped.join("cases")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            say(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let map = "[telemetry.columns]\nthr1_N = { column = \"ON\", unit = \"ms\", nominal_N = 0.9 }\n";
    let said = say(&write("map.toml", map)).unwrap();
    assert_eq!(said, "thr1_N: column ON, unit ms, nominal 0.9 N");
    let request = IdentifyRequest::new(
        shipped.join("stsat3/model.toml"),
        [shipped.join("stsat3/multiaxis/telemetry_noisy.csv")],
    );
    let mut file = estimate_file(&identify(&request).unwrap());
    let answer = |file: &poinsot::EstimateFile| {
        write("estimate.json", &result_text(file, true).unwrap());
        say(folder.path())
    };
    let said = answer(&file).unwrap();
    assert!(
        said.contains("6 of 6 requested numbers determined"),
        "{said}"
    );
    // A number changed by hand is inconsistent with the covariance and the principal moments.
    let xx = &mut file.bodies["spacecraft"].inertia_kg_m2.xx;
    xx.sigma = xx.sigma.map(|s| -2.0 * s);
    xx.value = xx.value.map(|v| v + 1.0);
    let refused = answer(&file).unwrap_err();
    let said = refused.to_string();
    for part in [
        "E0604",
        "bodies.spacecraft.inertia_kg_m2.xx.sigma",
        "a sigma is not negative",
        "their sum is not the trace",
        "it is not the square of the sigma of spacecraft.inertia_kg_m2.xx",
    ] {
        assert!(said.contains(part), "{said}\nlacks {part}");
    }
    assert_eq!(refused.kind(), poinsot::ErrorKind::Input);
}

/// Null means not determined. Example: only rotation is measured, the mass is known, and thrust determines the mass
/// centre. Then the ten parameters and the vehicle as one body are determined too.
#[test]
fn regress_what_follows_from_known_and_determined_numbers_is_not_null() {
    let shipped = root().join("data/cases");
    let case = poinsot::case::read_case(&shipped.join("tug_thrusters.toml")).unwrap();
    let mut model = poinsot_model::read_model(&case.model).unwrap();
    model.sensors.truncate(2);
    model.bodies[0].estimate.mass = false;
    let mut table = poinsot::simulate::simulate_case(&case, &model)
        .unwrap()
        .table;
    let moves = |name: &str| ["r_", "v_", "acc_"].iter().any(|p| name.starts_with(p));
    table.channels.retain(|c| !moves(&c.name));
    let question = poinsot::Question::default();
    let identified =
        poinsot::identify_tables(model.clone(), vec![table.clone()], &question).unwrap();
    let file = estimate_file(&identified);
    let bus = &file.bodies["bus"];
    let whole = &file.system[0].body;
    let ten = |b: &poinsot_formats::BodyFile| {
        let b = &b.barycentric;
        let (mc, tensor) = (
            b.mc_kg_m.named().map(|n| n.1.clone()),
            b.I_BBo_kg_m2.named(),
        );
        let tensor = tensor.map(|n| n.1.clone());
        mc.into_iter().chain(tensor).collect::<Vec<_>>()
    };
    for (k, number) in ten(bus).into_iter().enumerate() {
        let (value, sigma) = (number.value.unwrap(), number.sigma.unwrap());
        assert!(
            sigma > 0.0 && (value - number.nominal).abs() < 4.0 * sigma,
            "{k}: {number:?}"
        );
    }
    let (mc, com) = (&bus.barycentric.mc_kg_m.x, &bus.com_m.x);
    assert!((mc.value.unwrap() - 500.0 * com.value.unwrap()).abs() < 1e-9);
    assert!((mc.sigma.unwrap() / com.sigma.unwrap() - 500.0).abs() < 1e-6);
    assert_eq!(ten(whole), ten(bus));
    // With the mass requested but not determined, ten numbers are requested and nine determined; those that depend on
    // the mass are null.
    model.bodies[0].estimate.mass = true;
    let file = estimate_file(&poinsot::identify_tables(model, vec![table], &question).unwrap());
    assert_eq!(
        (file.identifiability.rank, file.identifiability.parameters),
        (9, 10)
    );
    assert!(ten(&file.bodies["bus"]).iter().all(|n| n.value.is_none()));
}

/// One grammar of addresses: names in a covariance are valid for `--vary` and `[[want]]`.
#[test]
fn exact_names_of_results_are_addresses_of_plans() {
    use poinsot_formats::Address;
    let shipped = root().join("data/cases");
    let found = predict(&shipped.join("tug_thrusters.toml"), 1.0).unwrap();
    let names = prediction_file(&found).covariance.names;
    assert!(names.contains(&"gyro.bias_rad_s.x".to_owned()), "{names:?}");
    for name in &names {
        let parts = Address::parse(name);
        assert!(["bus", "gyro"].contains(&parts.owner()), "{name}");
        let request = poinsot::sweep::SweepRequest {
            case: shipped.join("tug_thrusters.toml"),
            vary: vec![format!("{name}=1e-5,2e-5")],
            methods: vec!["linear".to_owned()],
            trials: 1,
            ..Default::default()
        };
        let plan = poinsot::sweep::sweep_plan(&request).unwrap();
        // An unphysical body is rejected later: the address itself is valid.
        let error = poinsot::campaign::made_plan(plan, Path::new("")).err();
        let said = error.map_or(String::new(), |e| e.to_string());
        assert!(!said.contains("E0542"), "{name}: {said}");
    }
}
