//! The command `study`: reproduces the results of papers.
//!
//! The studies are defined in [`poinsot_papers::study`]. They simulate and identify through [`Tools`], implemented
//! here by the commands of this crate.

use crate::Error;
use crate::bind::{RELATIVE_ACCURACY, acceleration_channels, bind};
use crate::case::{Case, parse_case};
use crate::error::unknown;
use crate::identify::{Question, identify_tables, read_options};
use crate::predict::predict_case;
use crate::report::drawn;
use crate::simulate::simulate_trial;
use crate::validate::{Mover, compare_motion};
use crate::written::csv_text;
use indexmap::IndexSet;
use poinsot_dynamics::Tree;
use poinsot_figures::FigureFormat;
use poinsot_formats::{
    FoundCellFile, FoundTableFile, PaperFile, STUDIES, StatementFile, StudiesFile, StudyFile,
    StudyFindingsFile, finite,
};
use poinsot_identify::{Estimate, Noise, Segment};
use poinsot_model::{Model, read_model};
use poinsot_papers::Method;
pub use poinsot_papers::studies;
use poinsot_papers::study::{CaseText, Difference, Tools};
pub use poinsot_papers::study::{Cell, Context, Findings, Study, StudyError, Table as FoundTable};
use poinsot_spatial::InertialParameters;
use poinsot_telemetry::{Table, read};
use std::path::{Path, PathBuf};

/// Implementation of the tools.
pub struct Verbs;

fn parsed(case: &CaseText) -> Result<Case, Error> {
    parse_case(&case.path, case.text.clone())
}

impl Tools for Verbs {
    fn vehicle(&self, case: &CaseText) -> Result<Model, StudyError> {
        Ok(read_model(parsed(case)?.model)?)
    }

    fn simulate(&self, case: &CaseText, vehicle: &Model, trial: u64) -> Result<Table, StudyError> {
        let simulated = simulate_trial(&parsed(case)?, vehicle, trial);
        Ok(simulated?.table)
    }

    fn read(&self, model: &Model, file: &Path) -> Result<Table, StudyError> {
        let mut options = read_options(model, &model.telemetry, false, false);
        if let Some(wanted) = &mut options.wanted {
            wanted.extend(acceleration_channels());
        }
        Ok(read(&[file], &options)?)
    }

    fn bind(
        &self,
        model: &Model,
        tree: &Tree,
        tables: &[Table],
    ) -> Result<(Vec<Segment>, Noise), StudyError> {
        let bound = bind(model, tree, tables)?;
        Ok((bound.segments, bound.noise))
    }

    fn identify(
        &self,
        model: &Model,
        tables: Vec<Table>,
        method: &str,
        variant: Option<&str>,
    ) -> Result<Estimate, StudyError> {
        let question = Question {
            variant: variant.map(str::to_owned),
            ..Question::by(method)
        };
        Ok(identify_tables(model.clone(), tables, &question)?.estimate)
    }

    fn bound(&self, case: &CaseText, vehicle: &Model) -> Result<Estimate, StudyError> {
        Ok(predict_case(&parsed(case)?, vehicle.clone(), RELATIVE_ACCURACY)?.bound)
    }

    fn differences(
        &self,
        case: &CaseText,
        of: &[InertialParameters],
        against: &[InertialParameters],
    ) -> Result<Vec<Difference>, StudyError> {
        let own = Mover::of_model(self.vehicle(case)?);
        let [of, against] = [of, against].map(|bodies| Mover {
            bodies: bodies.to_vec(),
            ..own.clone()
        });
        let compared = compare_motion(&parsed(case)?, &of, &against)?;
        let compared = compared.into_iter().map(|c| Difference {
            name: c.file.quantity,
            time_s: c.time_s,
            rows: c.difference,
            largest: c.file.largest,
        });
        Ok(compared.collect())
    }
}

/// The requested studies: of one or all papers, one or all studies.
///
/// # Errors
/// The paper or study is unknown; the message lists the known ones.
///
/// ```
/// use poinsot::study::find;
///
/// let found = find(Some("kim2010"), Some("table2"))?;
/// assert_eq!((found.len(), found[0].1.name), (1, "table2"));
/// assert!(find(Some("newton1687"), None).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn find(
    paper: Option<&str>,
    name: Option<&str>,
) -> Result<Vec<(&'static str, &'static Study)>, Error> {
    let refuse = |value: Option<&str>, what: &str, known: Vec<&'static str>| {
        unknown(
            "study",
            value.unwrap_or_default(),
            what,
            IndexSet::<&str>::from_iter(known),
        )
    };
    let own: Vec<_> = studies()
        .filter(|s| paper.is_none_or(|p| p == s.0))
        .collect();
    if own.is_empty() {
        return Err(refuse(paper, "paper", studies().map(|s| s.0).collect()));
    }
    let named = |s: &&(_, &Study)| name.is_none_or(|n| [s.1.name, ALL].contains(&n));
    let found: Vec<_> = own.iter().filter(named).copied().collect();
    if found.is_empty() {
        let known = own.iter().map(|s| s.1.name).chain([ALL]);
        return Err(refuse(name, "study", known.collect()));
    }
    Ok(found)
}

/// Name of all studies of a paper.
pub const ALL: &str = "all";

/// Runs a study with the folder of shipped data.
///
/// # Errors
/// The data are missing, or a tool fails.
///
/// ```
/// use poinsot::study::{find, run};
///
/// let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
/// let (_, study) = find(Some("kim2010"), Some("table2"))?[0];
/// let findings = run(study, &data)?;
/// assert!(!findings.tables.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run(study: &Study, data: &Path) -> Result<Findings, Error> {
    if !data.join("cases").is_dir() {
        let problem = "this folder does not have the project's data (no folder 'cases')";
        let advice = "run in the project's folder, or give the path of its folder 'data'";
        return Err(Error::usage("--data", data.display(), problem, advice));
    }
    let context = Context {
        data,
        tools: &Verbs,
    };
    (study.run)(&context).map_err(told)
}

/// An error of a tool is returned unchanged; any other is a bug of the study.
fn told(error: StudyError) -> Error {
    error
        .downcast::<Error>()
        .map(|error| *error)
        .unwrap_or_else(|other| Error::internal(format!("a study: {other}")))
}

/// The findings as a file: numbers with all digits, null if missing.
///
/// ```
/// use poinsot::study::{find, findings_file};
/// use poinsot_papers::study::Findings;
///
/// let (paper, study) = find(Some("kim2010"), Some("table2"))?[0];
/// assert_eq!(findings_file(paper, study, &Findings::default()).study, "table2");
/// # Ok::<(), poinsot::Error>(())
/// ```
pub fn findings_file(paper: &str, study: &Study, findings: &Findings) -> StudyFindingsFile {
    filed(paper, study, findings, |cell| match cell {
        Cell::Word(text) => FoundCellFile::Word(text.clone()),
        Cell::Number(x, _) => FoundCellFile::Number(finite(*x)),
        Cell::Pair(a, _, b, _) => FoundCellFile::Pair(finite(*a), finite(*b)),
    })
}

/// The findings as the paper's page prints them: every cell as text.
///
/// ```
/// use poinsot::study::{find, printed_findings};
/// use poinsot_papers::study::Findings;
///
/// let (paper, study) = find(Some("kim2010"), Some("table2"))?[0];
/// assert_eq!(printed_findings(paper, study, &Findings::default()).paper, "kim2010");
/// # Ok::<(), poinsot::Error>(())
/// ```
pub fn printed_findings(paper: &str, study: &Study, findings: &Findings) -> StudyFindingsFile {
    filed(paper, study, findings, |cell| {
        FoundCellFile::Word(cell.text())
    })
}

fn filed(
    paper: &str,
    study: &Study,
    findings: &Findings,
    cell: impl Fn(&Cell) -> FoundCellFile,
) -> StudyFindingsFile {
    let row = |row: &Vec<Cell>| row.iter().map(&cell).collect();
    let table = |t: &FoundTable| FoundTableFile {
        name: t.name.to_string(),
        title: t.title.to_string(),
        columns: t.head.clone(),
        rows: t.rows.iter().map(row).collect(),
    };
    let statement = |(what, number): &(String, String)| StatementFile {
        in_the_paper: what.clone(),
        number: number.clone(),
    };
    StudyFindingsFile {
        paper: paper.to_owned(),
        study: study.name.to_owned(),
        summary: study.summary.to_owned(),
        tables: findings.tables.iter().map(table).collect(),
        statements: findings.statements.iter().map(statement).collect(),
    }
}

/// A table as CSV: numbers with all digits; two numbers of a cell are joined by their separator.
///
/// ```
/// use poinsot_papers::study::Table;
///
/// let mut table = Table::new("moments", "Moments", " | kg m2");
/// table.row("xx", [13.916]);
/// // All digits, however few are shown.
/// assert_eq!(poinsot::study::csv(&table), ",kg m2\nxx,13.916\n");
/// ```
pub fn csv(table: &FoundTable) -> String {
    let number = |x: f64| finite(x).map_or(String::new(), |x| x.to_string());
    let cell = |cell: &Cell| match cell {
        Cell::Word(text) => text.clone(),
        Cell::Number(x, _) => number(*x),
        Cell::Pair(a, between, b, _) => format!("{} {between} {}", number(*a), number(*b)),
    };
    let rows = table.rows.iter().map(|row| row.iter().map(cell).collect());
    csv_text(std::iter::once(table.head.clone()).chain(rows))
}

/// Files of the findings: tables as CSV, figures in the given formats.
///
/// # Errors
/// A figure cannot be rendered.
///
/// ```
/// use poinsot::study::{files, find};
/// use poinsot_papers::study::Findings;
///
/// let (_, study) = find(Some("kim2010"), Some("table2"))?[0];
/// assert!(files(study, &Findings::default(), &[])?.is_empty());
/// # Ok::<(), poinsot::Error>(())
/// ```
pub fn files(
    study: &Study,
    findings: &Findings,
    formats: &[FigureFormat],
) -> Result<Vec<(PathBuf, Vec<u8>)>, Error> {
    let mut files = Vec::new();
    for table in &findings.tables {
        let name = format!("{}_{}.csv", study.name, table.name);
        files.push((PathBuf::from(name), csv(table).into_bytes()));
    }
    let figures = drawn(findings.figures.iter(), formats);
    let refuse = |(name, why): (String, String)| Error::report(Path::new(&name), why, "");
    files.extend(figures.map_err(refuse)?);
    Ok(files)
}

/// Papers with their studies; one paper if named.
///
/// ```
/// use poinsot::study::studies_file;
///
/// assert_eq!(studies_file(None).papers.len(), poinsot_papers::METHODS.len());
/// assert_eq!(studies_file(Some("kim2010")).papers[0].paper, "kim2010");
/// ```
pub fn studies_file(paper: Option<&str>) -> StudiesFile {
    let study = |s: &Study| StudyFile {
        name: s.name.to_owned(),
        summary: s.summary.to_owned(),
        quick: s.quick,
    };
    let of = |m: &Method| PaperFile {
        paper: m.name.to_owned(),
        citation: m.citation.to_owned(),
        studies: m.studies.iter().map(study).collect(),
    };
    let papers = poinsot_papers::METHODS.into_iter().map(of);
    StudiesFile {
        schema: STUDIES.to_owned(),
        papers: papers
            .filter(|p| paper.is_none_or(|wanted| wanted == p.paper))
            .collect(),
    }
}
