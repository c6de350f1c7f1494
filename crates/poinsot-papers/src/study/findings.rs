//! Tables, figures and numbers of a page, as data.

use poinsot_report::{Figure, Plot, significant};

/// What a study found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Findings {
    /// Tables in reading order.
    pub tables: Vec<Table>,
    /// Figures.
    pub figures: Vec<Figure>,
    /// Statements of the paper with their numbers, as the last table of the paper's page has them.
    pub statements: Vec<(String, String)>,
}

/// A table; a cell holds a word, or one or two numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name of its file, and of its place on the paper's page.
    pub name: String,
    /// Title with what the numbers mean and their units.
    pub title: String,
    /// Column titles.
    pub head: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell. A number that is not finite is one that cannot be given.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Text.
    Word(String),
    /// A number.
    Number(f64, Digits),
    /// Two numbers with what stands between them.
    Pair(f64, &'static str, f64, Digits),
}

/// How many digits of a number are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digits {
    /// Significant figures.
    Figures(i32),
    /// Decimals.
    Decimals(usize),
}

/// A cell of text.
pub fn word(text: impl Into<String>) -> Cell {
    Cell::Word(text.into())
}

/// A number with significant figures.
pub fn figures(x: f64, count: i32) -> Cell {
    Cell::Number(x, Digits::Figures(count))
}

/// A number with decimals.
pub fn decimals(x: f64, count: usize) -> Cell {
    Cell::Number(x, Digits::Decimals(count))
}

/// A share in percent with significant figures; the column says the unit.
pub fn percent(share: f64, count: i32) -> Cell {
    figures(100.0 * share, count)
}

impl Digits {
    fn text(self, x: f64) -> String {
        match self {
            _ if !x.is_finite() => "-".to_owned(),
            Self::Figures(count) => significant(rounded(x, count), count),
            Self::Decimals(count) => match format!("{x:.count$}") {
                zero if zero.bytes().all(|b| b"-0.".contains(&b)) => format!("{:.count$}", 0.0),
                text => text,
            },
        }
    }
}

/// Without the digits before the point that the figures do not cover.
fn rounded(x: f64, count: i32) -> f64 {
    let unit = 10.0_f64.powi(x.abs().max(1.0).log10().floor() as i32 + 1 - count);
    if unit > 1.0 {
        (x / unit).round() * unit
    } else {
        x
    }
}

impl Cell {
    /// As read by a person; a dash where there is no number.
    pub fn text(&self) -> String {
        match self {
            Self::Word(text) => text.clone(),
            Self::Number(x, digits) => digits.text(*x),
            Self::Pair(a, between, b, digits) => {
                format!("{} {between} {}", digits.text(*a), digits.text(*b))
            }
        }
    }
}

impl Table {
    /// An empty table; column titles as `a | b`.
    pub fn new(name: impl Into<String>, title: &str, head: &str) -> Self {
        Self {
            name: name.into(),
            title: title.to_owned(),
            head: head.split(" | ").map(str::to_owned).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row: its title, then cells.
    pub fn row(&mut self, title: impl Into<String>, cells: impl IntoIterator<Item = Cell>) {
        let mut row = vec![word(title)];
        row.extend(cells);
        self.rows.push(row);
    }

    /// As the page has it.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let mut out = line(&self.head).replace("|  |", "| |");
        out += &format!("|{}\n", "---|".repeat(self.head.len()));
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(Cell::text).collect();
            out += &line(&cells);
        }
        out
    }
}

impl Findings {
    /// Findings of one table.
    pub fn of(table: Table) -> Self {
        let mut findings = Self::default();
        findings.tables.push(table);
        findings
    }

    /// Adds a figure of curves.
    pub fn plot(&mut self, name: &str, plot: Plot) {
        self.figures.push(Figure::plot(name, plot));
    }

    /// Says the number of a statement of the page's last table.
    pub fn state(&mut self, statement: &str, number: impl Into<String>) {
        self.statements.push((statement.to_owned(), number.into()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_cells_show_the_digits_asked_for() {
        assert_eq!(figures(10_864.0, 2).text(), "11000");
        assert_eq!(figures(0.097_4, 2).text(), "0.097");
        assert_eq!(decimals(-1759.561, 2).text(), "-1759.56");
        assert_eq!(decimals(-1.0e-9, 3).text(), "0.000");
        assert_eq!(figures(f64::INFINITY, 2).text(), "-");
        let pair = Cell::Pair(401.52, "+-", 7.71, Digits::Decimals(1));
        assert_eq!(pair.text(), "401.5 +- 7.7");
    }

    #[test]
    fn exact_a_table_as_the_page_has_it() {
        let mut table = Table::new("a", "title", " | x");
        table.row("one", [percent(0.5, 2)]);
        assert_eq!(table.markdown(), "| | x |\n|---|---|\n| one | 50 |\n");
    }
}
