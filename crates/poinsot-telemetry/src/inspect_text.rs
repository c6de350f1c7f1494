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
        section(
            f,
            "They may be (check, then write into [telemetry.columns])",
            &self.suggestions,
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
