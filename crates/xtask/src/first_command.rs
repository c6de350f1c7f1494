//! Runs the first command of README.md.

use crate::fault::Fault;
use crate::repository::{code, read, root, status};
use std::process::Command;

/// Runs the command as it is there, or by the program that the tests have built.
pub fn run(built: bool) -> Result<(), Fault> {
    let readme = read(&root().join("README.md"))?;
    let line = first(&readme).ok_or_else(|| {
        Fault::Failed(
            "README.md: no line begins with 'cargo run' and holds ' identify '; add one".to_owned(),
        )
    })?;
    let command = if built {
        by_built_program(line)
    } else {
        line.to_owned()
    };
    println!("{command}\n");
    let status = status(
        Command::new("bash")
            .args(["-c", &command])
            .current_dir(root()),
    )?;
    status
        .success()
        .then_some(())
        .ok_or(Fault::Ended(code(status)))
}

fn first(readme: &str) -> Option<&str> {
    readme.lines().find(|line| {
        line.strip_prefix("cargo run ")
            .is_some_and(|rest| rest.contains(" identify "))
    })
}

fn by_built_program(line: &str) -> String {
    let arguments = line.split_once(" -- ").map_or(line, |(_, after)| after);
    format!("target/release/poinsot {arguments}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_the_first_command_is_found_and_shortened() {
        let readme = "text\n```sh\ncargo run --release -- simulate x\ncargo run --release -- identify --model m -- x\n```\n";
        let line = first(readme).unwrap();
        assert_eq!(line, "cargo run --release -- identify --model m -- x");
        assert_eq!(
            by_built_program(line),
            "target/release/poinsot identify --model m -- x"
        );
    }
}
