//! Parts of the tree that are compared over time, and the files of each that hold what is new.

/// A part: its name, what the paths of its files contain, and of these the files with new capability.
pub struct Part {
    /// As printed.
    pub name: &'static str,
    /// Folders and names; a file belongs to the first part that names it.
    files: &'static [&'static str],
    /// What version 0.1.0 could not do, as whole files.
    new: &'static [&'static str],
}

/// Parts of the product. What is not named here tests, shows or maintains it.
pub const PARTS: [Part; 7] = [
    Part {
        name: "papers and examples",
        files: &[
            "/kim2010",
            "/ma2008",
            "/xu2017",
            "poinsot-papers/",
            "/examples/",
        ],
        new: &[],
    },
    Part {
        name: "identify and solve",
        files: &["poinsot-identify/", "poinsot-solve/"],
        new: &[
            "/certify/barycentre",
            "/certify/continuation",
            "/certify/naming",
            "/diagnosis/noise_models",
            "/diagnosis/onset",
            "/diagnosis/pulse",
            "/evaluation/",
            "/experiment/known_columns",
            "/fit/known_numbers",
            "/motion/chord",
            "/motion/mass_loss",
            "/motion/virtual_joints",
            "/parameters/known_numbers",
            "/parameters/sensor_errors",
            "/sensors/relative",
            "/shifted_vehicle",
            "/minimax",
            "/polytope",
        ],
    },
    Part {
        name: "poinsot, report, figures, formats, files, design",
        files: &[
            "/poinsot/",
            "poinsot-report/",
            "poinsot-figures/",
            "poinsot-formats/",
            "poinsot-files/",
            "poinsot-design/",
        ],
        new: &[
            "poinsot-design/",
            "/campaign",
            "/plan.rs",
            "/sweep.rs",
            "/compare.",
            "/compare/",
            "/comparison",
            "/export/",
            "/onboard",
            "/propose",
            "/mounting",
            "/design",
            "/case/limits",
            "/case/wanted",
            "/predict/wanted",
            "/several.rs",
            "/page/results/",
            "/page/flown",
            "/page/morph",
            "/page/export",
            "/packed.rs",
            "/pixels.rs",
            "/input.rs",
            "/stage.rs",
        ],
    },
    Part {
        name: "telemetry",
        files: &["poinsot-telemetry/"],
        new: &[
            "/clock",
            "/conversion",
            "/csv_rows",
            "/derive",
            "/instant",
            "/map",
            "/memory",
            "/mounting",
            "/parquet_pages",
            "/parquet_writer",
            "/selection",
        ],
    },
    Part {
        name: "model",
        files: &["poinsot-model/"],
        new: &[
            "/patch/",
            "/known",
            "/knowledge",
            "/check_known",
            "/limits",
            "/describe_telemetry",
            "/write_telemetry",
        ],
    },
    Part {
        name: "dynamics and spatial",
        files: &["poinsot-dynamics/", "poinsot-spatial/"],
        new: &[
            "/batch/",
            "/lanes",
            "/free_motion",
            "/rates_momentum",
            "/propellant",
            "/propagation/vehicle",
            "/relative_",
        ],
    },
    Part {
        name: "cli",
        files: &["poinsot-cli/"],
        new: &[
            "/campaign",
            "/compare",
            "/design",
            "/export",
            "/methods",
            "/signals",
            "/study",
            "/sweep",
            "/units",
        ],
    },
];

impl Part {
    /// The part of a file, by its path from the root.
    pub fn of(path: &str) -> Option<&'static Self> {
        PARTS
            .iter()
            .find(|part| part.files.iter().any(|name| path.contains(name)))
    }

    /// Whether a file of this part holds new capability.
    pub fn is_new(&self, path: &str) -> bool {
        self.new.iter().any(|name| path.contains(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_a_file_has_one_part() {
        let name = |path| Part::of(path).map(|part| part.name);
        assert_eq!(
            name("crates/poinsot-identify/src/methods/kim2010/mod.rs"),
            Some("papers and examples")
        );
        assert_eq!(
            name("crates/poinsot-identify/src/fit/mod.rs"),
            Some("identify and solve")
        );
        assert_eq!(name("crates/xtask/src/main.rs"), None);
    }
}
