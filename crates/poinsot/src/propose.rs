//! The command `inspect`: what files hold, and a `[telemetry]` table for those without a map.

use crate::bind::{mountings, spin_inertias};
use crate::channel_names;
use crate::error::Error;
use crate::identify::repair::Refusal;
use crate::proposal::Proposal;
use crate::propose_sensors::proposed_sensors;
use crate::survey::{Survey, likely};
use poinsot_figures::{Section, TextStyle};
use poinsot_formats::{INSPECTION, StatedFile};
use poinsot_model::{TelemetryMap, read_model, read_telemetry_map};
use poinsot_telemetry::{Inspection, ReadOptions, inspect_files};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Inspects the files of one segment, with the map of `map` or of `model`. Without a map, a `[telemetry]` table is
/// proposed, and the files are read with it.
///
/// # Errors
/// Model or map are invalid, or the files cannot be read with the proposal either.
///
/// ```
/// use poinsot::inspect;
/// use poinsot_telemetry::ReadOptions;
///
/// # let out = std::env::temp_dir().join(format!("poinsot-propose-{}", std::process::id()));
/// # std::fs::create_dir_all(&out)?;
/// let path = out.join("imu.csv");
/// std::fs::write(&path, "t_s,wx [deg/s],wy [deg/s],wz [deg/s]\n0,1,2,3\n1,1,2,3\n2,1,2,4\n")?;
/// let found = inspect(&[path], &ReadOptions::default(), None, None)?;
/// assert!(found.proposed_map.unwrap().contains(r#"column = "wx [deg/s]""#));
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn inspect(
    files: &[PathBuf],
    options: &ReadOptions,
    model: Option<&Path>,
    map: Option<&Path>,
) -> Result<InspectionAnswer, Error> {
    let mut options = options.clone();
    let mut own = Vec::new();
    if let Some(model) = model.map(read_model).transpose()? {
        options.mountings = mountings(&model);
        options.spin_inertia = Some(spin_inertias(&model));
        own = channel_names::of_parts(&model);
        options.map = model.telemetry;
    }
    if let Some(map) = map {
        options.map = read_telemetry_map(map)?;
    }
    let described = map.is_some() || options.map != TelemetryMap::default();
    let (inspection, proposed_map) = match described {
        true => (inspect_files(files, &options)?, None),
        false => {
            let survey = Survey::of(files, &options, Proposal::of_all(files, &own))?;
            (survey.inspection, likely(&survey.proposals))
        }
    };
    let next = match model {
        Some(_) => contradicted(files, &options, &inspection),
        None => {
            let names: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
            let names = names.join(",");
            format!("Next: `poinsot init {names}` writes a model for these files.")
        }
    };
    Ok(InspectionAnswer {
        proposed_sensors: proposed_sensors(&inspection),
        inspection,
        proposed_map,
        next,
    })
}

/// The lines of a map that put right what contradicts each other, read with them.
fn contradicted(files: &[PathBuf], options: &ReadOptions, inspection: &Inspection) -> String {
    let refusal = |i: &Inspection| {
        let mut tests = i.conventions.iter();
        Some(Refusal::from(tests.find(|t| t.is_contradicted())?.clone()))
    };
    let gate = |map: &TelemetryMap| {
        let options = ReadOptions {
            map: map.clone(),
            ..options.clone()
        };
        refusal(&inspect_files(files, &options)?).map_or(Ok(()), Err)
    };
    let declared = refusal(inspection).and_then(|found| found.passing(&options.map, gate).next());
    let Some(declared) = declared else {
        return String::new();
    };
    let lines = declared.lines.iter().map(|line| line.text.as_str());
    let lines = lines.collect::<Vec<_>>().join("\n");
    format!("With these lines in the map the measurements are consistent:\n{lines}")
}

/// An inspection with what it proposes.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct InspectionAnswer {
    /// What was found.
    #[serde(flatten)]
    pub inspection: Inspection,
    /// The `[telemetry]` table to paste.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proposed_map: Option<String>,
    /// `[[sensor]]` tables with the noise that the data show.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proposed_sensors: Option<String>,
    /// The next command.
    #[serde(skip)]
    pub next: String,
}

impl InspectionAnswer {
    /// The inspection as text for a terminal of a width; what is proposed is never wrapped, to be pasted.
    ///
    /// ```
    /// use poinsot::inspect;
    /// use poinsot_telemetry::ReadOptions;
    ///
    /// let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/stsat3/paper/telemetry_noisy.csv");
    /// let found = inspect(&[path.into()], &ReadOptions::default(), None, None)?;
    /// let text = found.text(Some(120));
    /// assert!(text.contains("omega_x       rad/s      body"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn text(&self, width: Option<u16>) -> String {
        let style = TextStyle {
            width,
            ..TextStyle::default()
        };
        let mut out = style.wrapped(&self.inspection.text(|head, rows| {
            let table = Section {
                head,
                rows,
                ..Section::default()
            };
            table.text(&style)
        }));
        let map = "Proposed map, for the model file or a file for --map; check the lines marked unsure:\n\n";
        let sensors = "Proposed noise of the sensors:\n\n";
        let next = Some(self.next.clone()).filter(|next| !next.is_empty());
        let (of_map, of_sensors) = (&self.proposed_map, &self.proposed_sensors);
        for (title, text) in [(map, of_map), (sensors, of_sensors), ("", &next)] {
            if let Some(text) = text {
                out += &format!("\n\n{title}{text}");
            }
        }
        out
    }
}

/// The inspection as a file.
///
/// ```
/// use poinsot::{inspect, inspection_file};
/// use poinsot_telemetry::ReadOptions;
///
/// let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/stsat3/paper/telemetry_noisy.csv");
/// let found = inspect(&[path.into()], &ReadOptions::default(), None, None)?;
/// assert!(inspection_file(found).content.inspection.channels.iter().any(|c| c.name == "omega_x"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn inspection_file(content: InspectionAnswer) -> StatedFile<InspectionAnswer> {
    StatedFile {
        schema: INSPECTION,
        content,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn proposed(path: &Path, own: &[String]) -> Option<String> {
        let files = [path.to_owned()];
        let proposals = Proposal::of_all(&files, own);
        let survey = Survey::of(&files, &ReadOptions::default(), proposals);
        likely(&survey.unwrap().proposals)
    }

    #[test]
    fn unit_an_export_is_described_and_what_is_unsure_is_marked() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("aocs.csv");
        let text = "# export\nUTC;wx;wy;wz;RW1;THR1;Q0;Q1;Q2;Q3\n-;deg/s;deg/s;deg/s;rpm;-;-;-;-;-\n\
                    2026-03-14T18:19:00.0;0.1;0.2;0.3;100;0;1;0;0;0\n2026-03-14T18:19:01.0;0.1;0.2;0.3;100;0;1;0;0;0\n\
                    2026-03-14T18:19:02.0;0.1;0.2;0.3;100;0;1;0;0;0\n";
        std::fs::write(&path, text).unwrap();
        let map = proposed(&path, &[]).unwrap();
        let wanted = "[[telemetry.file]]\nname = \"aocs.csv\"\ncomment = \"#\"\ndelimiter = \";\"\nunits_row = true\n\
            time = { column = \"UTC\", format = \"iso8601\" }   # no zone is written, UTC is assumed\n\
            attitude = [{ quaternion = [\"Q0\", \"Q1\", \"Q2\", \"Q3\"], order = \"xyzw\", sense = \"body_to_inertial\" }]   # unsure: order of Q0, Q1, Q2, Q3: \"wxyz\" (scalar first) or \"xyzw\"; sense of Q0, Q1, Q2, Q3: \"body_to_inertial\" or \"inertial_to_body\"\n\n\
            [telemetry.file.columns]\nomega_x = { column = \"wx\" }\nomega_y = { column = \"wy\" }\nomega_z = { column = \"wz\" }\n\
            wheel1_rad_s = { column = \"RW1\" }\n\
            # thr1_N = { column = \"THR1\", nominal_N = ... }   # unsure: force of THR1 while it is on, N\n";
        assert_eq!(map, wanted);
        poinsot_model::parse_telemetry_map(&map, "proposed").unwrap();
        let plain = folder.path().join("plain.csv");
        std::fs::write(&plain, "time_s,omega_x\n0,1\n1,2\n2,3\n").unwrap();
        assert_eq!(proposed(&plain, &[]), None);
        // A wheel of the model bears a name that often means a rate.
        std::fs::write(&plain, "time_s,wx_rad_s\n0,1\n1,2\n2,3\n").unwrap();
        assert!(proposed(&plain, &[]).unwrap().contains("omega_x"));
        assert_eq!(proposed(&plain, &["wx_rad_s".to_owned()]), None);
    }
}
