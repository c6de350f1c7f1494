//! Campaigns: sums independent of the way of running, error texts of plans, the engine against plain trials.

use crate::shared::{rows, statistics};
use poinsot::campaign::{
    CampaignRequest, Plan, ShardSums, campaign, campaign_in_memory, fold_shards, fold_sums, looks,
    made_plan, merge_campaign, parse_plan, run_shard,
};
use poinsot::explain::explain;
use poinsot::trials::OUTSIDE;
use poinsot_formats::{CampaignFile, PlanFile};
use std::path::{Path, PathBuf};

fn cases() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases")
}

/// A rigid satellite with thrusters at a low rate: a trial takes a few milliseconds.
const PLAN: &str = r#"
schema = "poinsot.plan/1"
name = "small"
trials = 12
trials_per_shard = 4

[[experiment]]
case = "tug_thrusters.toml"
every = 20

[[method]]
name = "auto"

[[method]]
name = "linear"

[[vary]]
number = "noise"
values = [1.0, 3.0]
"#;

fn plan(text: &str) -> Plan {
    parse_plan(&cases().join("plan.toml"), text.to_owned()).unwrap()
}

fn request(out: &Path, resume: bool) -> CampaignRequest<'static> {
    CampaignRequest {
        out: out.to_owned(),
        resume,
        ..CampaignRequest::default()
    }
}

/// The result without times, which differ between runs.
fn timeless(mut result: CampaignFile) -> CampaignFile {
    for method in result.cells.iter_mut().flat_map(|c| &mut c.methods) {
        method.seconds_per_trial = None;
    }
    result
}

fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}

#[test]
fn exact_sums_are_the_same_however_a_campaign_is_run() {
    let plan = plan(PLAN);
    assert_eq!((plan.cells(), plan.shards()), (2, 6));
    let whole = tempfile::tempdir().unwrap();
    let ran = on(1, || campaign(&plan, &request(whole.path(), false))).unwrap();
    let whole = timeless(ran.result.unwrap());
    assert_eq!(whole.cells[1].at["noise"], 3.0);
    assert_eq!(whole.cells[0].methods[0].trials, 12);

    // Three threads, and two shares in separate folders, the second first.
    let threads = tempfile::tempdir().unwrap();
    let three = on(3, || campaign(&plan, &request(threads.path(), false))).unwrap();
    assert_eq!(timeless(three.result.unwrap()), whole);
    let shares = [(2, 2), (1, 2)].map(|share| {
        let folder = tempfile::tempdir().unwrap();
        let request = CampaignRequest {
            share: Some(share),
            ..request(folder.path(), false)
        };
        let ran = on(2, || campaign(&plan, &request)).unwrap();
        assert_eq!(ran.shards, 3);
        folder
    });
    let from = vec![shares[1].path().to_owned()];
    let merged = merge_campaign(&plan, shares[0].path(), &from, false).unwrap();
    assert_eq!(timeless(merged.result.unwrap()), whole);

    let memory = campaign_in_memory(&plan).unwrap().result.unwrap();
    assert_eq!(timeless(memory), whole);

    // Separately, in any order, through the text of their sums.
    let mut sums: Vec<ShardSums> = (0..plan.shards())
        .map(|s| ShardSums::parse(&run_shard(&plan, s).unwrap().sums.text()).unwrap())
        .collect();
    sums.reverse();
    let folded = fold_sums(&plan, sums.clone()).unwrap();
    assert_eq!(timeless(folded.result(&plan, plan.trials, OUTSIDE)), whole);
    sums.push(sums[2].clone());
    let Err(why) = fold_sums(&plan, sums) else {
        panic!("a shard twice")
    };
    assert!(why.to_string().contains("twice"), "{why}");
}

#[test]
fn exact_a_campaign_gives_the_numbers_of_plain_trials() {
    let plan = plan(&PLAN.replace("values = [1.0, 3.0]", "values = [1.0]"));
    let study = plan.study(0).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let ran = campaign(&plan, &request(folder.path(), false)).unwrap();
    let mut diagnosed = study.clone();
    diagnosed.diagnose = false;
    let plain = statistics(&rows(&diagnosed, 0..12));
    let engine = &ran.result.unwrap().cells[0].methods[0];
    assert_eq!(engine.numbers.len(), plain.numbers.len());
    for (name, a) in &engine.numbers {
        let b = &plain.numbers[name];
        assert_eq!((a.trials, a.coverage_all), (b.trials, b.coverage_all));
        for (a, b) in [(a.rmse.value, b.rmse.value), (a.bound, b.bound)] {
            assert!((a.unwrap() / b.unwrap() - 1.0).abs() < 1.0e-12, "{name}");
        }
    }
}

#[test]
fn exact_shards_that_are_there_are_not_run_again_and_damaged_ones_are() {
    let plan = plan(PLAN);
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    let first = campaign(&plan, &request(out, false)).unwrap();
    let whole = timeless(first.result.unwrap());
    let Err(error) = campaign(&plan, &request(out, false)) else {
        panic!("run twice")
    };
    assert!(error.to_string().starts_with("E0602"), "{error}");
    let again = campaign(&plan, &request(out, true)).unwrap();
    assert_eq!(
        (again.shards, timeless(again.result.unwrap())),
        (0, whole.clone())
    );

    let file = |shard: u64, extension: &str| {
        let name = format!("{}_{shard:09}.{extension}", &plan.digest[..12]);
        out.join("shards/000000").join(name)
    };
    let text = std::fs::read_to_string(file(1, "json")).unwrap();
    std::fs::write(file(1, "json"), &text[..text.len() / 2]).unwrap();
    std::fs::write(file(2, "json"), text.replace("\"cell\":1", "\"cell\":0")).unwrap();
    std::fs::remove_file(file(3, "json")).unwrap();
    let rows = std::fs::read(file(4, "parquet")).unwrap();
    std::fs::write(file(4, "parquet"), &rows[..rows.len() - 9]).unwrap();
    std::fs::copy(file(0, "json"), file(5, "json")).unwrap();
    let Err(error) = merge_campaign(&plan, out, &[], false) else {
        panic!("gaps merged")
    };
    assert!(
        error.to_string().contains("5 of 6 shards are missing"),
        "{error}"
    );
    let partial = merge_campaign(&plan, out, &[], true).unwrap();
    assert_eq!(partial.result.unwrap().missing, [1, 2, 3, 4, 5]);
    let mended = campaign(&plan, &request(out, true)).unwrap();
    assert_eq!(mended.shards, 5);
    let named: Vec<u64> = mended.damaged.iter().map(|d| d.number).collect();
    assert_eq!(named, [1, 2, 4, 5]);
    assert_eq!(timeless(mended.result.unwrap()), whole);
}

#[test]
fn exact_a_changed_plan_is_refused_and_more_trials_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    campaign(&plan(PLAN), &request(out, false)).unwrap();
    for change in [
        ("every = 20", "every = 10"),
        ("3.0", "4.0"),
        ("\"linear\"", "\"ma2008\""),
    ] {
        let other = plan(&PLAN.replace(change.0, change.1));
        for error in [
            campaign(&other, &request(out, true)).err(),
            merge_campaign(&other, out, &[], true).err(),
        ] {
            let text = error.unwrap().to_string();
            assert!(
                text.starts_with("E0602") && text.contains("a shard of plan"),
                "{text}"
            );
        }
    }
    // Sixteen trials: the three blocks of each cell remain, a fourth is run.
    let more = plan(&PLAN.replace("trials = 12", "trials = 16"));
    let ran = campaign(&more, &request(out, true)).unwrap();
    assert_eq!(ran.shards, 2);
    assert_eq!(ran.result.unwrap().cells[0].methods[0].trials, 16);
}

#[test]
fn exact_a_shard_twice_with_other_sums_is_refused() {
    let plan = plan(PLAN);
    let [a, b] = [1, 2].map(|_| {
        let folder = tempfile::tempdir().unwrap();
        campaign(&plan, &request(folder.path(), false)).unwrap();
        folder
    });
    let from = vec![b.path().to_owned()];
    merge_campaign(&plan, a.path(), &from, false).unwrap();
    // Of other noise, which the digest does not tell.
    let noise = self::plan(&PLAN.replace("trials = 12", "seed = 2\ntrials = 12"));
    let mut other = run_shard(&noise, 3).unwrap();
    other.sums.digest.clone_from(&plan.digest);
    std::fs::remove_dir_all(b.path().join("shards")).unwrap();
    other.write(b.path()).unwrap();
    let Err(error) = merge_campaign(&plan, a.path(), &from, false) else {
        panic!("merged")
    };
    assert!(
        error.to_string().contains("twice with different sums"),
        "{error}"
    );
}

/// Random true values: the estimate follows them, and the bound is that of each trial.
#[test]
fn stat_trials_that_draw_their_truth_are_calibrated() {
    let text = PLAN
        .replace("trials = 12", "trials = 60")
        .replace("[1.0, 3.0]", "[1.0]")
        + "[[draw]]\nnumber = \"bus.mass_kg\"\nrelative_sigma = 0.1\n\n[[draw]]\nnumber = \"bus.com_m\"\nfrom = -0.05\nto = 0.05\n";
    let plan = plan(&text.replace("[[method]]\nname = \"linear\"\n", ""));
    let folder = tempfile::tempdir().unwrap();
    let ran = campaign(&plan, &request(folder.path(), false)).unwrap();
    let result = ran.result.unwrap();
    let mass = &result.cells[0].methods[0].numbers["bus.mass_kg"];
    assert_eq!(mass.trials, 60);
    // The masses differ by 50 kg, the errors only by the bound.
    assert!(mass.rmse.value.unwrap() < 1.5 * mass.bound.unwrap());
    assert!(mass.coverage_all.low.unwrap() < 0.95 && 0.95 < mass.coverage_all.high.unwrap());
    assert!(
        result.cells[0].methods[0].misses.is_empty(),
        "{:?}",
        result.cells[0].methods[0].misses
    );
}

#[test]
fn exact_looks_double_from_a_thousand_to_the_whole() {
    let text = PLAN
        .replace("trials = 12", "trials = 9000")
        .replace("trials_per_shard = 4", "trials_per_shard = 300");
    assert_eq!(looks(&plan(&text)), [1200, 2100, 4200, 8100, 9000]);
}

/// All faults are reported together, each with its line, and every code is explained.
#[test]
fn unit_a_plan_that_cannot_be_run_says_why() {
    let refused = |from: &str, to: &str| -> String {
        let text = PLAN.replace(from, to);
        assert_ne!(text, PLAN, "{from}");
        match parse_plan(&cases().join("plan.toml"), text) {
            Err(error) => {
                let said = error.to_string();
                assert!(explain(&said[..5]).is_some(), "{said}");
                assert_eq!(error.kind(), poinsot::ErrorKind::Input, "{said}");
                said
            }
            Ok(_) => panic!("{to} was accepted"),
        }
    };
    for (from, to, says) in [
        (
            "plan/1",
            "plan/2",
            "plan.toml:2: schema = \"poinsot.plan/2\": this is not the format of a plan",
        ),
        (
            "trials = 12",
            "trails = 12",
            "plan.toml:4: trails = 12: unknown key; did you mean trials?",
        ),
        (
            "trials = 12",
            "trials = 0",
            "plan.toml:4: trials = 0: the trials must be at least 1",
        ),
        ("\"noise\"", "\"noisy\"", "E0542"),
        ("\"noise\"", "\"bus.mas_kg\"", "did you mean \"mass_kg\"?"),
        ("[1.0, 3.0]", "[]", "vary[0].values"),
        (
            "values = [1.0, 3.0]",
            "from = 1.0\nto = 2.0",
            "a range needs a count",
        ),
        (
            "name = \"linear\"",
            "name = \"linera\"",
            "there is no such method",
        ),
        ("name = \"linear\"", "name = \"auto\"", "given twice"),
        (
            "name = \"linear\"",
            "name = \"linear\"\nset = { particles = 3 }",
            "has no settings",
        ),
        (
            "case = ",
            "record = ",
            "a record needs a model and a truth file; give model and truth",
        ),
        ("every = 20", "every = 0", "1 takes all samples"),
        (
            "number = \"noise\"\nvalues = [1.0, 3.0]",
            "number = \"bus.mass_kg\"\nvalues = [-3.0]",
            "the mass is negative",
        ),
        ("tug_thrusters.toml", "nowhere.toml", "E0501"),
    ] {
        let said = refused(from, to);
        assert!(said.contains(says), "{to}: {said}");
    }
}

#[test]
fn exact_a_plan_of_a_program_is_that_of_a_file() {
    let file: PlanFile = toml::from_str(PLAN).unwrap();
    let made = made_plan(file, &cases()).unwrap();
    assert_eq!(made.digest, plan(PLAN).digest);
}

/// Writing fails in the middle: finished shards remain, and the rest is run later.
#[cfg(unix)]
#[test]
fn exact_a_folder_that_cannot_be_written_loses_nothing() {
    let plan = plan(PLAN);
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    let whole = timeless(
        campaign(&plan, &request(out, false))
            .unwrap()
            .result
            .unwrap(),
    );
    // A file in place of the folder of shards.
    std::fs::rename(out.join("shards"), out.join("kept")).unwrap();
    std::fs::write(out.join("shards"), "").unwrap();
    let Err(error) = campaign(&plan, &request(out, true)) else {
        panic!("written")
    };
    assert_eq!(error.code(), "E0002", "{error}");
    assert_eq!(error.kind(), poinsot::ErrorKind::System);
    std::fs::remove_file(out.join("shards")).unwrap();
    std::fs::rename(out.join("kept"), out.join("shards")).unwrap();
    let folded = fold_shards(&plan, out, plan.trials).unwrap();
    assert_eq!(timeless(folded.result(&plan, plan.trials, OUTSIDE)), whole);
}
