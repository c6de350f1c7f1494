//! An inspection as plain text.

use crate::{ChannelSummary, ConventionTest, Inspection, Verdict};
use poinsot_files::counted;
use std::fmt;

/// Titles of the columns of [`Inspection::text`].
const HEAD: [&str; 13] = [
    "channel",
    "unit",
    "axes",
    "samples",
    "rate Hz",
    "lost",
    "gaps",
    "longest s",
    "min",
    "max",
    "quantum",
    "noise",
    "",
];

impl Inspection {
    /// The inspection as text, with the channels as a table that is made of its head and its rows.
    ///
    /// ```
    #[doc = include_str!("../doc/channel.txt")]
    /// let rate = channel("joint1_rad_s", "rad/s", &[0.0, 0.1, 0.2], &[1.0, 3.0, 2.0]);
    /// let found = inspect(&Table { channels: vec![rate], ..Table::default() });
    /// let text = found.text(|head, rows| format!("{}: {}, {}: {}\n", head[0], rows[0][0], head[8], rows[0][8]));
    /// assert!(text.contains("channel: joint1_rad_s, min: 1.000e0\n"));
    /// ```
    pub fn text(&self, table: impl FnOnce(Vec<String>, Vec<Vec<String>>) -> String) -> String {
        let mut out = String::new();
        for s in &self.sources {
            let (path, [from, to], hash) = (&s.path, s.time_s, &s.sha256);
            let rows = counted(s.rows, "row");
            out += &format!("{path}: {rows}, {from} to {to} s, sha256 {hash}\n");
        }
        let rows = self.channels.iter().map(ChannelSummary::cells).collect();
        out += &format!("\n{}", table(HEAD.map(str::to_owned).to_vec(), rows));
        for test in &self.conventions {
            out += &format!("\n{test}");
        }
        section(&mut out, "Repairs", &self.repairs);
        section(&mut out, "Notes", &self.notes);
        let findings = self.findings.iter();
        let found = findings.map(|x| format!("{}: {}: {}", x.check.name(), x.channel, x.text));
        section(&mut out, "Checks", &found.collect::<Vec<_>>());
        let ignored = self.ignored.chunks(10).map(|names| names.join(", "));
        section(&mut out, "Unused columns", &ignored.collect::<Vec<_>>());
        let title = "They may be (check, then write into [telemetry.columns])";
        section(&mut out, title, &self.suggestions);
        out
    }
}

impl ChannelSummary {
    fn cells(&self) -> Vec<String> {
        let number = |x: f64| format!("{x:.3e}");
        let rounded = |x: f64| ((x * 1.0e4).round() / 1.0e4).to_string();
        let or_none = |x: Option<String>| x.unwrap_or_else(|| "-".to_owned());
        vec![
            self.name.clone(),
            self.unit.clone(),
            self.frame.clone(),
            self.samples.to_string(),
            or_none(self.rate_hz.map(rounded)),
            self.lost.to_string(),
            self.gaps.to_string(),
            rounded(self.longest_gap_s),
            number(self.min),
            number(self.max),
            or_none(self.quantum.map(number)),
            or_none(self.noise.map(number)),
            if self.constant { "constant" } else { "" }.to_owned(),
        ]
    }
}

fn section(out: &mut String, title: &str, lines: &[String]) {
    if !lines.is_empty() {
        *out += &format!("\n{title}:\n");
    }
    lines.iter().for_each(|line| *out += &format!("  {line}\n"));
}

impl fmt::Display for ConventionTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([kind, other], [one, two]) = (self.kinds, &self.between);
        let (head, tail) = kind.split_at(1);
        write!(
            f,
            "{}{tail} {one} against {other} {two}: {} intervals, rate {:.3e} {}",
            head.to_uppercase(),
            self.intervals,
            self.rate,
            self.unit
        )?;
        if let Some(scale) = self.scale {
            write!(f, ", scale {scale:.5}")?;
        }
        writeln!(f)?;
        for h in &self.readings {
            let words = self.words(h);
            writeln!(f, "  {:.3e} {}  {words}", h.residual, self.unit)?;
        }
        let (all, best) = self.simplest();
        match (&self.verdict, self.good.first()) {
            (Verdict::Undecided { reason }, _) => return writeln!(f, "  Not decided: {reason}."),
            (Verdict::DeclaredContradicted, Some(h)) => {
                let least = h.residual;
                writeln!(f, "  CONTRADICTED. Best: {least:.3e} {}  {best}", self.unit)?;
            }
            _ => writeln!(f, "  The declared convention fits best.")?,
        }
        match self.good.len() - all {
            0 => Ok(()),
            others => writeln!(
                f,
                "  {others} other conventions fit as well; this motion cannot distinguish them."
            ),
        }
    }
}
