//! A checked case, plan or result in statements, one a line.

use crate::templates::TEMPLATES;
use minijinja::context;
use poinsot_formats::case::CaseFile;
use poinsot_formats::{EstimateFile, PlanFile};
use serde::Serialize;

/// What the check of a case with its model found beside its file.
#[derive(Serialize)]
pub struct CheckedCase<'a> {
    /// The case as read.
    pub file: &'a CaseFile,
    /// Name and file of the model.
    pub model: String,
    /// Duration, s.
    pub duration_s: f64,
    /// Rate of the samples, Hz.
    pub rate_hz: f64,
    /// Number of samples.
    pub rows: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Wanted numbers: name, sigma and unit.
    pub wants: Vec<(String, f64, &'static str)>,
    /// Numbers of joints and wheels that a design prescribes; `None` without a design.
    pub design: Option<[usize; 2]>,
}

/// A case.
///
/// ```
/// use poinsot_formats::case::CaseFile;
/// use poinsot_report::{CheckedCase, case_lines};
///
/// let text = "schema = 'poinsot.case/2'\nmodel = 'box.toml'\nduration_s = 10.0\n[output]\nrate_hz = 5\n";
/// let file: CaseFile = toml::from_str(text).unwrap();
/// let model = "box (box.toml)".to_owned();
/// let (rows, seed, wants, design) = (51, 1, Vec::new(), None);
/// let lines = case_lines(&CheckedCase { file: &file, model, duration_s: 10.0, rate_hz: 5.0, rows, seed, wants, design });
/// assert_eq!(lines[1], "10 s at 5 Hz: 51 rows, seed 1");
/// assert_eq!(lines[2], "start: at rest");
/// ```
pub fn case_lines(case: &CheckedCase<'_>) -> Vec<String> {
    TEMPLATES.lines("case.txt", case)
}

/// A plan of this name with its numbers of trials, cells and shards, and its methods.
///
/// ```
/// use poinsot_formats::PlanFile;
/// use poinsot_report::plan_lines;
///
/// let text = "schema = 'poinsot.plan/1'\n[[experiment]]\nname = 'box'\ncase = 'case.toml'\n";
/// let file: PlanFile = toml::from_str(text).unwrap();
/// let lines = plan_lines(&file, "box", [4, 1, 1], &["linear"]);
/// assert_eq!(lines, ["box: 4 trials of 1 cell, in 1 shard", "experiment: case.toml", "methods: linear"]);
/// ```
pub fn plan_lines(
    file: &PlanFile,
    name: &str,
    [trials, cells, shards]: [u64; 3],
    methods: &[&str],
) -> Vec<String> {
    let context = context! { file, name, trials, cells, shards, methods };
    TEMPLATES.lines("plan.txt", context)
}

/// A result of `identify`.
///
/// ```
#[doc = include_str!("../doc/estimate.txt")]
/// let lines = poinsot_report::estimate_lines(&estimate);
/// assert!(lines[0].contains("combinations identifiable"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn estimate_lines(file: &EstimateFile) -> Vec<String> {
    let asked = file.bodies.iter().filter(|(_, b)| b.is_asked());
    let bodies = asked.map(|(name, b)| {
        let asked = b.numbers().into_iter().filter(|(_, _, n)| !n.is_known());
        let open = asked.clone().filter(|(_, _, n)| n.value.is_none());
        (name, asked.count(), open.count())
    });
    let context = context! {
        file,
        method => file.method_in_words(),
        bodies => bodies.collect::<Vec<_>>(),
        doubts => file.evidence_against(),
    };
    TEMPLATES.lines("answer.txt", context)
}
