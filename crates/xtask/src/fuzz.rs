//! Fuzzes every reader and `identify` with libFuzzer.

use crate::fault::Fault;
use crate::repository::{
    cannot_start, cargo, create_folder, failed, files_below, root, status, succeed,
};
use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Seconds for each target: what a change is given before it goes in.
pub const SECONDS: u64 = 60;
/// All targets of fuzz/.
const TARGETS: [&str; 5] = ["csv", "parquet", "model", "urdf", "identify"];
/// Largest input that the archives keep, so that the repository stays small.
const LARGEST_KEPT_BYTES: u32 = 2048;
/// 64 KiB for an input and 10 s for it, 4 GiB for a process that may not need them.
const LIMITS: [&str; 4] = [
    "-max_len=65536",
    "-timeout=10",
    "-rss_limit_mb=4096",
    "-print_final_stats=1",
];
/// Each input is written to a file: in memory that is ten times as fast.
const MEMORY: &str = "/dev/shm";

/// Folders of one target.
struct Target<'a> {
    name: &'a str,
    found: PathBuf,
    written: PathBuf,
    archive: PathBuf,
    kept: PathBuf,
    artifacts: PathBuf,
}

impl<'a> Target<'a> {
    fn new(name: &'a str) -> Self {
        let folder = |path: &str| PathBuf::from(path).join(name);
        Self {
            name,
            found: folder("target/fuzz/corpus"),
            written: folder("fuzz/corpus"),
            archive: folder("fuzz/found").with_extension("tar"),
            kept: folder("target/fuzz/kept"),
            artifacts: folder("target/fuzz/artifacts"),
        }
    }

    fn program(&self) -> Command {
        let mut program = Command::new(root().join("target/fuzz/release").join(self.name));
        program.current_dir(root());
        if std::env::var_os("TMPDIR").is_none() && is_writable(MEMORY) {
            program.env("TMPDIR", MEMORY);
        }
        program
    }

    fn log(&self) -> PathBuf {
        Path::new("target/fuzz")
            .join(self.name)
            .with_extension("log")
    }

    /// Empty folders, and what earlier runs have kept.
    fn prepare(&self) -> Result<(), Fault> {
        // It may not be there.
        let _ = fs::remove_dir_all(root().join(&self.kept));
        for folder in [&self.found, &self.kept, &self.artifacts] {
            create_folder(&root().join(folder))?;
        }
        if !root().join(&self.archive).is_file() {
            return Ok(());
        }
        let mut tar = Command::new("tar");
        succeed(
            tar.arg("-xf")
                .arg(&self.archive)
                .arg("-C")
                .arg(&self.kept)
                .current_dir(root()),
        )
    }

    fn minimise(&self) -> Result<(), Fault> {
        let mut merge = self.program();
        merge.args([
            "-set_cover_merge=1",
            "-use_counters=0",
            &format!("-max_len={LARGEST_KEPT_BYTES}"),
        ]);
        succeed(merge.args([&self.kept, &self.written, &self.found]))?;
        self.pack()
    }

    /// Writes the archive: equal bytes for equal inputs.
    fn pack(&self) -> Result<(), Fault> {
        let folder = root().join(&self.kept);
        let mut names: Vec<_> = files_below(&folder)?
            .iter()
            .filter_map(|path| {
                Some(
                    path.strip_prefix(&folder)
                        .ok()?
                        .to_string_lossy()
                        .into_owned(),
                )
            })
            .collect();
        names.sort();
        let mut tar = Command::new("tar");
        tar.args([
            "--format=ustar",
            "--mtime=@0",
            "--owner=0",
            "--group=0",
            "--numeric-owner",
            "--mode=644",
        ]);
        tar.arg("-C")
            .arg(&folder)
            .args(["--null", "-T", "-", "-cf"])
            .arg(root().join(&self.archive));
        let mut running = tar
            .stdin(Stdio::piped())
            .spawn()
            .map_err(|why| cannot_start(&tar, &why))?;
        if let Some(mut input) = running.stdin.take() {
            for name in names {
                input
                    .write_all(format!("{name}\0").as_bytes())
                    .map_err(|why| Fault::file(&self.archive, why))?;
            }
        }
        let ended = running
            .wait()
            .map_err(|why| Fault::file(&self.archive, why))?;
        ended
            .success()
            .then_some(())
            .ok_or_else(|| failed(&tar, ended))
    }

    /// Fuzzes for some seconds; false where something was found.
    fn fuzz(&self, seconds: u64) -> Result<bool, Fault> {
        let log = root().join(self.log());
        let file = File::create(&log).map_err(|why| Fault::file(&log, why))?;
        let mut program = self.program();
        program
            .arg(format!("-max_total_time={seconds}"))
            .args(LIMITS);
        program.arg(format!("-artifact_prefix={}/", self.artifacts.display()));
        let ended = status(
            program
                .args([&self.found, &self.kept, &self.written])
                .stderr(file),
        )?;
        if !ended.success() {
            println!(
                "{}: FAILED; see {} and {}",
                self.name,
                self.log().display(),
                self.artifacts.display()
            );
        }
        let said = fs::read(&log).map_err(|why| Fault::file(&log, why))?;
        let said = String::from_utf8_lossy(&said);
        let (executions, places) = counts(&said);
        println!(
            "{}: {executions} executions in {seconds} s, {places} places of the code reached",
            self.name
        );
        Ok(ended.success())
    }
}

/// Fuzzes the targets, or makes their archives small.
pub fn run(minimise: bool, seconds: u64, targets: &[String]) -> Result<(), Fault> {
    let names: Vec<&str> = match targets {
        [] => TARGETS.to_vec(),
        some => some.iter().map(String::as_str).collect(),
    };
    if let Some(name) = names.iter().find(|name| !TARGETS.contains(name)) {
        return Err(Fault::Use(format!(
            "fuzz: no target '{name}'; use one of: {}",
            TARGETS.join(", ")
        )));
    }
    let build = [
        "build",
        "--release",
        "--manifest-path",
        "fuzz/Cargo.toml",
        "--target-dir",
        "target/fuzz",
    ];
    succeed(cargo(&build).env("RUSTC_WRAPPER", root().join("fuzz/rustc-with-coverage")))?;
    let mut all_passed = true;
    for name in names {
        let target = Target::new(name);
        target.prepare()?;
        if minimise {
            target.minimise()?;
        } else {
            all_passed &= target.fuzz(seconds)?;
        }
    }
    // The lines above say which target failed.
    all_passed.then_some(()).ok_or(Fault::Ended(1))
}

fn is_writable(folder: &str) -> bool {
    tempfile::tempfile_in(folder).is_ok()
}

/// Executions and places reached, as libFuzzer's log has them.
fn counts(log: &str) -> (&str, &str) {
    let executed = log
        .lines()
        .find_map(|line| line.strip_prefix("stat::number_of_executed_units:"));
    let covered = log.rmatch_indices("cov: ").find_map(|(at, sign)| {
        let rest = &log[at + sign.len()..];
        let end = rest
            .find(|letter: char| !letter.is_ascii_digit())
            .unwrap_or(rest.len());
        (end > 0).then(|| &rest[..end])
    });
    (
        executed.unwrap_or_default().trim(),
        covered.unwrap_or_default(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_the_log_is_counted() {
        let log = "#2 INITED cov: 17 ft: 3\n#9 NEW cov: 214 ft: 9\nstat::number_of_executed_units: 1234\ncov: x";
        assert_eq!(counts(log), ("1234", "214"));
        assert_eq!(counts(""), ("", ""));
    }
}
