//! An inspection as plain text.

use crate::{ConventionTest, Inspection, Verdict};
use std::fmt;

impl fmt::Display for Inspection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for s in &self.sources {
            writeln!(
                f,
                "{}: {} rows, {} to {} s, sha256 {}",
                s.path, s.rows, s.time_s[0], s.time_s[1], s.sha256
            )?;
        }
        let width = self
            .channels
            .iter()
            .map(|c| c.name.len())
            .max()
            .unwrap_or(0)
            .max(7);
        writeln!(
            f,
            "\n{:width$}  unit    axes      samples   rate Hz  lost  gaps  longest s         min         max     quantum       noise",
            "channel"
        )?;
        for c in &self.channels {
            let number = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.4e}"));
            writeln!(
                f,
                "{:width$}  {:6}  {:8} {:8} {:>9} {:5} {:5} {:10.4} {:11.4e} {:11.4e} {:>11} {:>11}{}",
                c.name,
                c.unit,
                c.frame,
                c.samples,
                c.rate_hz.map_or("-".to_owned(), |r| format!("{r:.4}")),
                c.lost,
                c.gaps,
                c.longest_gap_s,
                c.min,
                c.max,
                number(c.quantum),
                number(c.noise),
                if c.constant { "  constant" } else { "" }
            )?;
        }
        for test in &self.conventions {
            write!(f, "\n{test}")?;
        }
        section(f, "Repairs", &self.repairs)?;
        section(f, "Notes", &self.notes)?;
        let found: Vec<String> = self
            .findings
            .iter()
            .map(|x| format!("{}: {}: {}", x.check.name(), x.channel, x.text))
            .collect();
        section(f, "Checks", &found)?;
        let ignored: Vec<String> = self
            .ignored
            .chunks(10)
            .map(|names| names.join(", "))
            .collect();
        section(f, "Unused columns", &ignored)?;
        let lines: Vec<String> = self.suggestions.iter().map(|s| s.toml.clone()).collect();
        section(
            f,
            "They may be (check, then write into [telemetry.columns])",
            &lines,
        )
    }
}

fn section(f: &mut fmt::Formatter<'_>, title: &str, lines: &[String]) -> fmt::Result {
    if lines.is_empty() {
        return Ok(());
    }
    writeln!(f, "\n{title}:")?;
    lines.iter().try_for_each(|line| writeln!(f, "  {line}"))
}

impl fmt::Display for ConventionTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "Attitude {} against gyro {}: {} intervals, rate {:.3e} rad/s, scale {:.5}",
            self.attitude, self.gyro, self.intervals, self.rate_rad_s, self.scale
        )?;
        let readings = self.attitude_readings.iter();
        for h in readings.chain(self.gyro_units.iter().filter(|h| !h.is_declared())) {
            writeln!(f, "  {:.3e} rad/s  {h}", h.residual_rad_s)?;
        }
        match &self.verdict {
            Verdict::DeclaredFits => writeln!(f, "  The declared convention fits best.")?,
            Verdict::DeclaredContradicted => writeln!(
                f,
                "  CONTRADICTED. Best: {:.3e} rad/s  {}",
                self.best.residual_rad_s, self.best
            )?,
            Verdict::Undecided { reason } => writeln!(f, "  Not decided: {reason}.")?,
        }
        if !self.as_good.is_empty() && !matches!(self.verdict, Verdict::Undecided { .. }) {
            writeln!(
                f,
                "  {} other conventions fit as well; this motion cannot distinguish them.",
                self.as_good.len()
            )?;
        }
        Ok(())
    }
}
