//! The command `report`: the page next to a result. `report_data.json` keeps what a page draws.

mod data;
mod placed;

pub use data::report_data;

use crate::case::read_case;
use crate::compare::compare;
use crate::error::Error;
use crate::simulate::simulate_exact_watched;
use crate::written::{OutputFile, write_files};
use placed::nominal;
use poinsot_figures::{Figure, FigureFormat, Page, PageError};
use poinsot_files::read;
use poinsot_formats::{LARGEST_RESULT, Vehicle, parse_estimate, sha256};
use poinsot_model::read_model;
use poinsot_report::{
    Flown, Motion, RESULTS, comparison_part, no_page, parse_report_data, report_page, result_page,
};
use poinsot_spatial::UnitQuaternion;
use std::path::{Path, PathBuf};

/// Writes `report.html` next to a result: a folder of `identify`, compared with `earlier` results, or a file or folder
/// of another command. Also writes every figure into the folder `figures` in each given format. Writes all files or
/// none. Returns their paths.
///
/// # Errors
/// A file is missing, has another format, or belongs to another run.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-report-{}", std::process::id()));
/// write_result(&out, &identified, &["poinsot".to_owned()], false, &[])?;
/// let written = write_report(&out, &[], &[])?;
/// assert_eq!(written, [out.join("report.html")]);
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_report(
    result: &Path,
    earlier: &[PathBuf],
    figures: &[FigureFormat],
) -> Result<Vec<PathBuf>, Error> {
    let bytes = |path: &Path| read(path, LARGEST_RESULT).map_err(|e| e.of_result(path));
    let inside = |name: &str| result.join(name);
    let of_other = || RESULTS.into_iter().map(inside).find(|path| path.is_file());
    let file = match (result.is_dir(), inside("estimate.json").is_file()) {
        (true, true) => None,
        (true, false) => of_other(),
        (false, _) if result.file_name().is_some_and(|n| n == "estimate.json") => None,
        (false, _) => result.is_file().then(|| result.to_owned()),
    };
    let folder = match result.is_dir() || !result.is_file() {
        true => result,
        false => result.parent().unwrap_or(Path::new("")),
    };
    let mut page = match &file {
        Some(path) => result_page(path, &bytes(path)?, flown).map_err(fault(path))?,
        None => page_of(
            folder,
            &bytes(&folder.join("estimate.json"))?,
            &bytes(&folder.join("report_data.json"))?,
        )?,
    };
    if !earlier.is_empty() {
        let found = compare(&[earlier, &[folder.to_owned()]].concat())?;
        page.parts
            .push(comparison_part(&found).map_err(fault(folder))?);
    }
    let mut files = vec![html_file(folder, &page)?];
    files.extend(figure_files(folder, &page, figures)?);
    write_files(folder, &files)
}

/// The page as the file `report.html`.
pub(crate) fn html_file(folder: &Path, page: &Page) -> Result<OutputFile, Error> {
    let html = page.html().map_err(|e| fault(folder)(no_page(&e)))?;
    Ok(("report.html".into(), html.into_bytes()))
}

fn fault(path: &Path) -> impl Fn(String) -> Error {
    move |why| Error::report(path, why, "")
}

/// The page for the two files of `identify`, as bytes.
pub(crate) fn page_of(folder: &Path, estimate: &[u8], data: &[u8]) -> Result<Page, Error> {
    let path = folder.join("report_data.json");
    let data = parse_report_data(data).map_err(fault(&path))?;
    let sum = sha256(estimate);
    let estimate = parse_estimate(&folder.join("estimate.json"), estimate)?;
    // Files of earlier versions list no others.
    let own = match data.files.get("estimate.json") {
        Some(listed) => *listed == sum,
        None => estimate.unchecked().is_some(),
    };
    if !own {
        let why = "estimate.json and report_data.json come from different runs; run identify again";
        return Err(fault(&path)(why.to_owned()));
    }
    report_page(estimate, data).map_err(fault(folder))
}

/// The figures of a page as separate files: SVG, PNG or both.
pub(crate) fn figure_files(
    folder: &Path,
    page: &Page,
    formats: &[FigureFormat],
) -> Result<Vec<OutputFile>, Error> {
    let figures = page.parts.iter().flat_map(|p| &p.figures);
    let files = drawn(figures, formats).map_err(|(_, why)| fault(folder)(why))?;
    let below = |(name, bytes): OutputFile| (Path::new("figures").join(name), bytes);
    Ok(files.into_iter().map(below).collect())
}

/// Figures in some formats; the name of one that cannot be drawn, and why.
pub(crate) fn drawn<'a>(
    figures: impl Iterator<Item = &'a Figure>,
    formats: &[FigureFormat],
) -> Result<Vec<OutputFile>, (String, String)> {
    let mut files = Vec::new();
    for figure in figures {
        for format in formats {
            let why = |e: PageError| (figure.name.to_string(), no_page(&e));
            let name = format!("{}.{}", figure.name, format.extension());
            let bytes = figure.file(*format).map_err(why)?;
            files.extend(bytes.map(|b| (PathBuf::from(name), b)));
        }
    }
    Ok(files)
}

/// The vehicle as it flies the case next to a design; `None` if the case or its model cannot be read any more.
fn flown(folder: &Path) -> Option<Flown> {
    let case = read_case(&folder.join("case.toml")).ok()?;
    let model = read_model(&case.model).ok()?;
    let scenario = case.bind(&model).ok()?;
    let joints = model.moving_joints();
    let mut motion = Motion {
        joints: joints.map(|j| (j.name.clone(), Vec::new())).collect(),
        ..Motion::default()
    };
    let mut first: Option<(UnitQuaternion, Vehicle)> = None;
    simulate_exact_watched(&case, &model, scenario, |sample| {
        let start = || (sample.R_NB, nominal(&model, &sample.kinematics));
        let R_BN = first.get_or_insert_with(start).0.inverse();
        let turn = (R_BN * sample.R_NB).coords;
        let place = R_BN * (sample.p_NoBo_N - sample.p_NoScm_N);
        motion.time_s.push(sample.time);
        motion.base.push((turn.into(), place.into()));
        for ((_, values), q) in motion.joints.iter_mut().zip(&sample.q) {
            values.push(*q);
        }
    })
    .ok()?;
    let vehicle = first?.1;
    Some(Flown { vehicle, motion })
}
