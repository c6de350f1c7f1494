//! Files of two runs are not mixed, and every reader refuses what contradicts itself. Changes of single bytes:
//! `crates/poinsot-formats/tests/integrity.rs`.

use poinsot::campaign::{Plan, missing_shards, read_plan, run_shards};
use poinsot::compare::compare;
use poinsot::export::{Target, export};
use poinsot::validate::{ValidateRequest, validate};
use poinsot::*;
use poinsot_formats::result_text;
use poinsot_model::read_model;
use poinsot_telemetry::{Channel, ReadOptions, read, write};
use std::fs;
use std::path::{Path, PathBuf};

fn crates(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

fn answer(trial: u64) -> Identified {
    let case = case::read_case(&crates("poinsot/doc/case.toml")).unwrap();
    let model = read_model(&case.model).unwrap();
    let table = simulate::simulate_trial(&case, &model, trial)
        .unwrap()
        .table;
    identify_tables(model, vec![table], &Question::default()).unwrap()
}

/// Every byte changed in one bit, and every length: refused, or read as before. Returns how many of both.
fn survives(bytes: &[u8], same: impl Fn(&[u8]) -> Option<bool>) -> (usize, usize) {
    let (mut refused, mut equal) = (0, 0);
    let mut count = |changed: &[u8], what: &str| match same(changed) {
        None => refused += 1,
        Some(true) => equal += 1,
        Some(false) => panic!("{what}: another answer"),
    };
    let mut changed = bytes.to_vec();
    for k in 0..bytes.len() {
        changed[k] ^= 1 << (k % 8);
        count(&changed, &format!("byte {k} changed"));
        changed[k] = bytes[k];
        count(&bytes[..k], &format!("cut at {k}"));
    }
    (refused, equal)
}

/// Files of two runs, swapped one by one.
#[test]
fn exact_files_of_two_answers_are_not_mixed() {
    let folder = tempfile::tempdir().unwrap();
    let runs = [0, 1].map(|trial| {
        let out = folder.path().join(trial.to_string());
        write_result(&out, &answer(trial), &[], false, &[]).unwrap();
        out
    });
    for name in ["estimate.json", "report_data.json"] {
        let [a, b] = [&runs[0], &runs[1]].map(|run| run.join(name));
        let kept = fs::read(&a).unwrap();
        fs::copy(&b, &a).unwrap();
        let error = write_report(&runs[0], &[], &[]).unwrap_err().to_string();
        assert!(error.contains("different runs"), "{name}: {error}");
        fs::write(&a, kept).unwrap();
        write_report(&runs[0], &[], &[]).unwrap();
    }
}

/// An answer of the previous version has no checksum: whatever is made of it says so.
#[test]
fn exact_what_is_made_of_an_unchecked_answer_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    let now = write_estimate(out, &answer(0)).unwrap();
    let text = fs::read_to_string(&now).unwrap();
    let end = text.rfind(",\n  \"sha256\"").unwrap();
    let old = text[..end].replacen("estimate/3", "estimate/2", 1) + "\n}\n";
    fs::write(&now, old).unwrap();
    let why = "unchecked: poinsot.estimate/2 has no checksum";
    let refused = export(out, Target::Csv, None, false).unwrap_err();
    assert!(refused.to_string().contains(why), "{refused}");
    let model = crates("poinsot/doc/model.toml");
    let onto = export(out, Target::Model, Some(&model), true).unwrap();
    assert!(onto.text.contains(why), "{}", onto.text);
    let after = posterior::after_answer(&read_model(&model).unwrap(), out, false);
    assert!(after.unwrap_err().to_string().contains(why));
    let checked = check::check(&now).unwrap().content.to_string();
    assert!(checked.contains(why), "{checked}");
    let compared = compare(&[now.clone(), now.clone()]).unwrap();
    assert!(compared.doubts[0].contains(why), "{:?}", compared.doubts);
    let request = ValidateRequest {
        estimate: Some(now),
        case: Some(crates("poinsot/doc/case.toml")),
        against: model.into(),
        ..ValidateRequest::default()
    };
    let validated = validate(&request).unwrap().file;
    assert_eq!(validated.warnings, [why]);
}

/// Two writers of one folder: one answer or the other, never a mixture.
#[test]
fn exact_two_writers_of_one_folder_leave_one_answer() {
    let folder = tempfile::tempdir().unwrap();
    let answers = [0, 1].map(answer);
    std::thread::scope(|scope| {
        for answer in &answers {
            scope.spawn(|| {
                for _ in 0..20 {
                    write_result(folder.path(), answer, &[], false, &[]).unwrap();
                }
            });
        }
    });
    write_report(folder.path(), &[], &[]).unwrap();
}

fn plan() -> Plan {
    read_plan(&crates("poinsot/doc/plan.toml")).unwrap()
}

/// Sums and rows of a shard: a change of any byte, and files of another shard, make the shard damaged.
#[test]
fn exact_a_changed_shard_is_run_again() {
    let (plan, folder) = (plan(), tempfile::tempdir().unwrap());
    let out = folder.path();
    run_shards(&plan, out, &[0], &|_| {}).unwrap();
    let damaged = || missing_shards(&plan, out, 0..1).unwrap();
    assert!(damaged().is_empty());
    let mut paths: Vec<PathBuf> = fs::read_dir(out.join("shards/000000"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    paths.sort();
    assert_eq!(paths.len(), 2);
    for path in &paths {
        let bytes = fs::read(path).unwrap();
        let (refused, equal) = survives(&bytes, |changed| {
            fs::write(path, changed).unwrap();
            damaged().is_empty().then_some(true)
        });
        fs::write(path, &bytes).unwrap();
        println!("{}: {refused} refused, {equal} equal", path.display());
        assert!(refused > 2 * bytes.len() - 100);
    }
    assert!(damaged().is_empty());
}

/// Telemetry as Parquet: only what the checksum itself is called may change.
#[test]
fn exact_changed_parquet_telemetry_is_refused_or_equal() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("telemetry.parquet");
    let channel = |name: &str, scale: f64| Channel {
        name: name.to_owned(),
        unit: "rad/s".to_owned(),
        frame: "body".to_owned(),
        time_s: (0..20).map(f64::from).collect(),
        values: (0..20).map(|t| scale * f64::from(t).sin()).collect(),
        ..Channel::default()
    };
    let channels = [channel("omega_x", 0.1), channel("omega_y", -2.0)];
    write(&path, &channels).unwrap();
    let bytes = fs::read(&path).unwrap();
    let options = ReadOptions::default();
    let again = || read(&[&path], &options);
    let whole = again().unwrap().channels;
    let (refused, equal) = survives(&bytes, |changed| {
        fs::write(&path, changed).unwrap();
        Some(again().ok()?.channels == whole)
    });
    println!("{refused} refused, {equal} equal");
    assert!(equal <= "sha256".len() + 8, "{equal}");
}

/// Sums with a forged header and a good checksum.
#[test]
fn exact_forged_sums_are_not_merged() {
    let (plan, folder) = (plan(), tempfile::tempdir().unwrap());
    let whole = poinsot::campaign::run_shard(&plan, 0).unwrap();
    let forge = |change: &dyn Fn(&mut poinsot::campaign::ShardSums)| {
        let mut shard = poinsot::campaign::run_shard(&plan, 0).unwrap();
        change(&mut shard.sums);
        shard.write(folder.path()).unwrap();
        let missing = missing_shards(&plan, folder.path(), 0..1).unwrap();
        assert!(missing[0].damage.is_some(), "{missing:?}");
        let merged = campaign::merge_campaign(&plan, folder.path(), &[], false);
        let error = merged.err().unwrap().to_string();
        assert!(error.starts_with("E0603"), "{error}");
    };
    assert_eq!(whole.sums.sums.methods.len(), 1);
    for trials in [u64::MAX, 1_000_000_000_000_000_000, 0] {
        forge(&|sums| sums.sums.methods[0].trials = trials);
        forge(&|sums| sums.sums.methods[0].numbers[0].trials = trials.max(5));
    }
    // The band of so many squares did not end.
    forge(&|sums| sums.sums.methods[0].nees.dof = u64::MAX);
    forge(&|sums| sums.sums.methods[0].nees.square = -1.0);
    forge(&|sums| sums.sums.methods[0].failures = 1);
    forge(&|sums| sums.sums.methods[0].chi2_per_dof = f64::NEG_INFINITY);
    forge(&|sums| sums.sums.methods[0].numbers[0].bounds.count = u64::MAX);
    forge(&|sums| sums.sums.methods[0].numbers[0].variance = -1.0);
    forge(&|sums| sums.sums.methods[0].numbers[0].error = 1.0e9);
    forge(&|sums| sums.sums.methods.clear());
    forge(&|sums| sums.cell = 1);
    forge(&|sums| sums.sums.methods[0].numbers[0].square = f64::INFINITY);
}

/// Every number and text of the sums of a shard changed alone, with a good checksum. Rows state neither bounds nor sensors.
#[test]
fn exact_edited_sums_are_not_those_of_their_rows() {
    let (plan, folder) = (plan(), tempfile::tempdir().unwrap());
    let mut whole = poinsot::campaign::run_shard(&plan, 0).unwrap();
    whole.write(folder.path()).unwrap();
    let damage = || missing_shards(&plan, folder.path(), 0..1).unwrap();
    assert_eq!(damage(), []);
    let shards = fs::read_dir(folder.path().join("shards/000000")).unwrap();
    let mut files = shards.map(|f| f.unwrap().path());
    let path = files.find(|f| f.extension().unwrap() == "json").unwrap();
    let value = serde_json::to_value(&whole.sums).unwrap();
    let mut leaves = Vec::new();
    leaves_of(&value, String::new(), &mut leaves);
    let (mut refused, mut untold) = (0, 0);
    for at in &leaves {
        let mut edited = value.clone();
        let leaf = edited.pointer_mut(at).unwrap();
        *leaf = match &leaf {
            serde_json::Value::String(text) => format!("{text}x").into(),
            leaf if leaf.is_u64() => (leaf.as_u64().unwrap() + 1).into(),
            leaf => (leaf.as_f64().unwrap() * 1.000_000_1 + 1.0e-300).into(),
        };
        let sums: poinsot::campaign::ShardSums = serde_json::from_value(edited).unwrap();
        fs::write(&path, sums.text()).unwrap();
        match damage().is_empty() {
            true => {
                assert!(at.contains("/bounds/") || at.contains("/channels/"), "{at}");
                untold += 1;
            }
            false => refused += 1,
        }
    }
    println!("{refused} refused, {untold} of bounds and sensors read");
    assert!(refused > 3 * untold);
}

/// Pointers to every number and text.
fn leaves_of(value: &serde_json::Value, at: String, leaves: &mut Vec<String>) {
    match value {
        serde_json::Value::Array(items) => {
            let items = items.iter().enumerate();
            items.for_each(|(k, item)| leaves_of(item, format!("{at}/{k}"), leaves));
        }
        serde_json::Value::Object(items) => {
            let items = items.iter();
            items.for_each(|(key, item)| leaves_of(item, format!("{at}/{key}"), leaves));
        }
        serde_json::Value::Null => {}
        _ => leaves.push(at),
    }
}

/// Edits by hand with a good checksum: every reader refuses them.
#[test]
fn exact_every_reader_refuses_an_estimate_that_contradicts_itself() {
    let folder = tempfile::tempdir().unwrap();
    let identified = answer(0);
    let out = folder.path().join("out");
    write_result(&out, &identified, &[], false, &[]).unwrap();
    let path = out.join("estimate.json");
    let file = estimate_file(&identified);
    let edited = |change: &dyn Fn(&mut EstimateFile)| {
        let mut file = file.clone();
        change(&mut file);
        result_text(&file, true).unwrap()
    };
    let text = result_text(&file, true).unwrap();
    let cut = text.rfind("\"sha256\"").unwrap();
    let body = text[..cut].trim_end().trim_end_matches(',');
    let twice = body.replacen("\"bus\": {", "\"bus\": {\"mass_kg\": null, ", 1);
    let sealed = |body: &str| {
        format!(
            "{body},\n  \"sha256\": \"{}\"\n}}\n",
            poinsot_formats::sha256(body.as_bytes())
        )
    };
    let edits = [
        edited(&|e| e.bodies["bus"].mass_kg.value = Some(-1.0)),
        edited(&|e| e.bodies["bus"].inertia_kg_m2.xx.value = Some(1.0e308)),
        edited(&|e| e.bodies["bus"].inertia_kg_m2.xx.sigma = Some(-1.0)),
        edited(&|e| e.status = "finished".to_owned()),
        sealed(&twice),
        sealed(body).replacen("2.5", "2.6", 1),
        text[..cut].trim_end().trim_end_matches(',').to_owned() + "}",
    ];
    let model = crates("poinsot/doc/model.toml");
    let readers: [(&str, &dyn Fn() -> Option<Error>); 5] = [
        ("report", &|| write_report(&out, &[], &[]).err()),
        ("export", &|| export(&out, Target::Csv, None, true).err()),
        ("check", &|| check::check(&path).err()),
        ("compare", &|| {
            let answers = vec![path.clone(), path.clone()];
            compare(&answers).err()
        }),
        ("validate", &|| {
            let request = ValidateRequest {
                estimate: Some(path.clone()),
                case: Some(crates("poinsot/doc/case.toml")),
                against: model.clone().into(),
                ..ValidateRequest::default()
            };
            validate(&request).err()
        }),
    ];
    for (name, read) in &readers {
        assert!(read().is_none(), "{name}: {:?}", read());
    }
    for (k, edit) in edits.iter().enumerate() {
        fs::write(&path, edit).unwrap();
        for (name, read) in &readers {
            let error = read().unwrap_or_else(|| panic!("{name} reads edit {k}"));
            assert!(
                error.to_string().contains("estimate.json"),
                "{name}: {error}"
            );
        }
    }
}
