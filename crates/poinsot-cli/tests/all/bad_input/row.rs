//! One row of the table: a fault, a command, and the expected output.

use crate::bad_input::advice::says_what_to_do;
use crate::bad_input::bench::{Bench, Done};
use poinsot_files::{LONGEST_LINE, is_unprintable};

/// The default command.
pub const IDENTIFY: &[&str] = &[
    "identify",
    "--model",
    "m.toml",
    "--telemetry",
    "t.csv",
    "--out",
    "out",
];

/// A fault and the expected reaction.
pub struct Row {
    /// Number in the list of faults, or the code.
    pub id: &'static str,
    pub fault: &'static str,
    /// Introduces the fault.
    pub spoil: fn(&Bench),
    /// The command.
    pub run: &'static [&'static str],
    /// Further arguments.
    pub more: &'static [&'static str],
    pub exit: i32,
    /// Texts that must be in the output.
    pub says: &'static [&'static str],
    /// Texts that must not be in the output.
    pub never: &'static [&'static str],
}

/// The default command with faulty files.
pub const fn row(
    id: &'static str,
    fault: &'static str,
    spoil: fn(&Bench),
    exit: i32,
    says: &'static [&'static str],
) -> Row {
    Row {
        id,
        fault,
        spoil,
        run: IDENTIFY,
        more: &[],
        exit,
        says,
        never: &[],
    }
}

impl Row {
    pub const fn more(mut self, more: &'static [&'static str]) -> Self {
        self.more = more;
        self
    }

    pub const fn run(mut self, run: &'static [&'static str]) -> Self {
        self.run = run;
        self
    }

    pub const fn never(mut self, never: &'static [&'static str]) -> Self {
        self.never = never;
        self
    }

    /// Runs the row; returns the deviations and the output.
    pub fn check(&self) -> (Vec<String>, Printed) {
        let bench = Bench::good();
        (self.spoil)(&bench);
        let before = bench.files();
        let arguments: Vec<&str> = self.run.iter().chain(self.more).copied().collect();
        let done = bench.run(&arguments);
        let new: Vec<String> = bench
            .files()
            .difference(&before)
            .map(|p| p.display().to_string())
            .collect();
        let wrong = self.judge(&done, &new);
        (wrong, Printed::new(self, &done))
    }

    fn judge(&self, done: &Done, new: &[String]) -> Vec<String> {
        let mut wrong = Vec::new();
        if done.exit != self.exit {
            wrong.push(format!("exit {} instead of {}", done.exit, self.exit));
        }
        let all = format!("{}{}", done.stdout, done.stderr);
        // Tables wrap lines as in a terminal.
        let flat = all.split_whitespace().collect::<Vec<_>>().join(" ");
        for text in self.says {
            if !flat.contains(text) {
                wrong.push(format!("does not say '{text}'"));
            }
        }
        for text in self.never {
            if flat.contains(text) {
                wrong.push(format!("says '{text}'"));
            }
        }
        let failed = done.exit >= 2;
        if failed && !new.is_empty() {
            wrong.push(format!("leaves {new:?}"));
        }
        if failed && !done.stdout.is_empty() {
            wrong.push("prints an answer on standard output".to_owned());
        }
        if new.iter().any(|f| f.contains(".poinsot-")) {
            wrong.push(format!("leaves a temporary file: {new:?}"));
        }
        if done.stderr.contains("panicked") || done.exit == 4 || done.exit == 101 {
            wrong.push("panics".to_owned());
        }
        if done.exit < 0 {
            wrong.push("is killed: it took more than 60 s of processor time".to_owned());
        }
        if let Some(line) = done
            .stderr
            .lines()
            .find(|l| l.chars().count() > LONGEST_LINE)
        {
            wrong.push(format!("a line of {} characters", line.chars().count()));
        }
        if all.contains(|c: char| is_unprintable(c) && !matches!(c, '\n' | '\t')) {
            wrong.push("prints what a terminal obeys".to_owned());
        }
        if failed {
            for line in done.stderr.lines() {
                let coded = line.starts_with('E')
                    && line
                        .get(1..5)
                        .is_some_and(|d| d.bytes().all(|b| b.is_ascii_digit()));
                let counted = line.starts_with("and ") && line.ends_with(" more");
                if coded && !says_what_to_do(line) {
                    wrong.push(format!("does not say what to do: {line}"));
                }
                if !coded && !counted && !done.stderr.starts_with("error:") {
                    wrong.push(format!("a line without code: {line}"));
                }
            }
        }
        if !wrong.is_empty() {
            wrong.push(format!("printed:\n{}{}", done.stdout, done.stderr));
        }
        wrong
    }
}

/// Output of a row, for the document.
pub struct Printed {
    pub id: &'static str,
    pub fault: &'static str,
    pub more: String,
    pub exit: i32,
    pub lines: Vec<String>,
}

impl Printed {
    fn new(row: &Row, done: &Done) -> Self {
        let lines = if done.exit >= 2 {
            done.stderr.lines().take(2).map(str::to_owned).collect()
        } else {
            let all: Vec<&str> = done.stdout.lines().chain(done.stderr.lines()).collect();
            let verdict = all.first().map(|l| (*l).to_owned());
            let told = all.iter().skip(1).filter(|l| {
                let flat = l.split_whitespace().collect::<Vec<_>>().join(" ");
                row.says.iter().any(|s| flat.contains(s))
            });
            verdict
                .into_iter()
                .chain(told.map(|l| l.trim().to_owned()))
                .take(4)
                .collect()
        };
        Self {
            id: row.id,
            fault: row.fault,
            more: if row.run == IDENTIFY {
                row.more.join(" ")
            } else {
                row.run
                    .iter()
                    .chain(row.more)
                    .copied()
                    .collect::<Vec<_>>()
                    .join(" ")
            },
            exit: done.exit,
            lines,
        }
    }
}
