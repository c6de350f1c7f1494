//! The repository: its root, its files, and programs that run in it.

use crate::fault::Fault;
use regex::Regex;
use std::fs;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};
use std::process::{Command, ExitStatus, Output, Stdio};

/// Folder of the repository.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_path_buf()
}

/// Path from the root, with `/` between folders.
pub fn name_of(path: &Path) -> String {
    let root = root();
    let inside = path.strip_prefix(&root).unwrap_or(path);
    let parts: Vec<_> = inside.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

/// Text of a file.
pub fn read(path: &Path) -> Result<String, Fault> {
    fs::read_to_string(path).map_err(|why| Fault::file(path, why))
}

/// Writes a file, and its folder where that is missing.
pub fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), Fault> {
    if let Some(folder) = path.parent() {
        create_folder(folder)?;
    }
    fs::write(path, contents).map_err(|why| Fault::file(path, why))
}

/// Creates a folder and those above it.
pub fn create_folder(path: &Path) -> Result<(), Fault> {
    fs::create_dir_all(path).map_err(|why| Fault::file(path, why))
}

/// A folder that is removed at the end.
pub fn scratch() -> Result<tempfile::TempDir, Fault> {
    tempfile::tempdir().map_err(|why| Fault::Failed(format!("no scratch folder: {why}")))
}

/// Every file below a folder, sorted; links to folders are not followed. No folder, no file.
pub fn files_below(folder: &Path) -> Result<Vec<PathBuf>, Fault> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let entries = match fs::read_dir(&folder) {
            Err(why) if why.kind() == ErrorKind::NotFound => continue,
            other => other.map_err(|why| Fault::file(&folder, why))?,
        };
        for entry in entries {
            let path = entry.map_err(|why| Fault::file(&folder, why))?.path();
            let list = if path.is_dir() && !path.is_symlink() {
                &mut folders
            } else {
                &mut found
            };
            list.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// Files that git knows, and new ones that it does not ignore, by name.
pub fn listed(pattern: &[&str]) -> Result<Vec<String>, Fault> {
    let mut git = Command::new("git");
    git.args([
        "ls-files",
        "-z",
        "--cached",
        "--others",
        "--exclude-standard",
    ]);
    let names = stdout_of(git.args(pattern).current_dir(root()))?;
    Ok(names
        .split('\0')
        .filter(|name| !name.is_empty())
        .map(str::to_owned)
        .collect())
}

/// Whether git ignores a path: the book makes it.
pub fn is_ignored(path: &Path) -> Result<bool, Fault> {
    let mut git = Command::new("git");
    git.args(["check-ignore", "--quiet"]).arg(path);
    Ok(status(git.current_dir(root()))?.success())
}

/// A path without `.` and `..`, from its text alone.
pub fn normal(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => drop(out.pop()),
            _ => out.push(part),
        }
    }
    out
}

/// Cargo, in the repository.
pub fn cargo(arguments: &[&str]) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(arguments).current_dir(root());
    cargo
}

/// A program of target/release, in the repository.
pub fn built(name: &str) -> Command {
    let mut program = Command::new(root().join("target/release").join(name));
    program.current_dir(root());
    program
}

/// Builds all programs with the features of the tests.
pub fn build_programs() -> Result<(), Fault> {
    // With -p the features differ, and half of the dependencies are compiled again.
    let arguments = [
        "build",
        "--quiet",
        "--locked",
        "--release",
        "--workspace",
        "--bins",
        "--tests",
    ];
    succeed(&mut cargo(&arguments))
}

/// Exit code of a program; 1 for one that a signal ended.
pub fn code(status: ExitStatus) -> u8 {
    status
        .code()
        .and_then(|code| u8::try_from(code).ok())
        .unwrap_or(1)
}

/// Runs a program to its end, with the output of this one.
pub fn status(command: &mut Command) -> Result<ExitStatus, Fault> {
    command.status().map_err(|why| cannot_start(command, &why))
}

/// Runs a program to its end and keeps what it prints on standard output.
pub fn captured(command: &mut Command) -> Result<Output, Fault> {
    command
        .stderr(Stdio::inherit())
        .output()
        .map_err(|why| cannot_start(command, &why))
}

/// Runs a program that must succeed.
pub fn succeed(command: &mut Command) -> Result<(), Fault> {
    let status = status(command)?;
    status
        .success()
        .then_some(())
        .ok_or_else(|| failed(command, status))
}

/// Standard output of a program that must succeed.
pub fn stdout_of(command: &mut Command) -> Result<String, Fault> {
    let output = captured(command)?;
    if !output.status.success() {
        return Err(failed(command, output.status));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Whether a program is on the path.
pub fn on_path(program: &str) -> bool {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&folders).any(|folder| folder.join(program).is_file())
}

/// A regular expression.
pub fn pattern(text: &str) -> Result<Regex, Fault> {
    Regex::new(text).map_err(|why| Fault::Failed(format!("pattern '{text}': {why}")))
}

/// A program that does not start.
pub fn cannot_start(command: &Command, why: &std::io::Error) -> Fault {
    Fault::Failed(format!(
        "{}: cannot start: {why}",
        command.get_program().to_string_lossy()
    ))
}

/// A program that ended with an error.
pub fn failed(command: &Command, status: ExitStatus) -> Fault {
    let arguments: Vec<_> = command.get_args().map(|a| a.to_string_lossy()).collect();
    let program = command.get_program().to_string_lossy();
    Fault::Failed(format!("{status}: {program} {}", arguments.join(" ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_paths_are_made_normal() {
        let path = normal(Path::new("/a/docs/../examples/./b.md"));
        assert_eq!(path, Path::new("/a/examples/b.md"));
    }

    #[test]
    fn unit_names_start_at_the_root() {
        assert_eq!(name_of(&root().join("docs/words.txt")), "docs/words.txt");
    }
}
