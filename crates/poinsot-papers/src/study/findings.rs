//! Results of a study: tables, figures and numbers for a page.

use poinsot_figures::{Figure, Plot};
use poinsot_files::{significant, to_digits};

/// Results of a study.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Findings {
    /// Tables in reading order.
    pub tables: Vec<Table>,
    /// Figures.
    pub figures: Vec<Figure>,
    /// Statements of the paper with their numbers, for the last table of the paper's page.
    pub statements: Vec<(String, String)>,
}

/// A table; a cell holds text, or one or two numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name of its file and of its place on the page.
    pub name: String,
    /// Title with meaning and units of the numbers.
    pub title: String,
    /// Column titles.
    pub head: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell. A value that is not finite means "not available".
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Text.
    Word(String),
    /// A number.
    Number(f64, Digits),
    /// Two numbers with a separator.
    Pair(f64, &'static str, f64, Digits),
}

/// Number of digits shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digits {
    /// Significant figures.
    Figures(i32),
    /// Decimals.
    Decimals(usize),
}

/// A text cell.
///
/// ```
/// use poinsot_papers::study::word;
///
/// assert_eq!(word("holds").text(), "holds");
/// ```
pub fn word(text: impl Into<String>) -> Cell {
    Cell::Word(text.into())
}

/// A number with significant figures.
///
/// ```
/// use poinsot_papers::study::figures;
///
/// assert_eq!(figures(0.012345, 3).text(), "0.0123");
/// ```
pub fn figures(x: f64, count: i32) -> Cell {
    Cell::Number(x, Digits::Figures(count))
}

/// A number with decimals.
///
/// ```
/// use poinsot_papers::study::decimals;
///
/// assert_eq!(decimals(3.14159, 2).text(), "3.14");
/// ```
pub fn decimals(x: f64, count: usize) -> Cell {
    Cell::Number(x, Digits::Decimals(count))
}

/// A fraction in percent, with significant figures; the column has the unit.
///
/// ```
/// use poinsot_papers::study::percent;
///
/// assert_eq!(percent(0.0123, 2).text(), "1.2");
/// ```
pub fn percent(share: f64, count: i32) -> Cell {
    figures(100.0 * share, count)
}

impl Digits {
    fn text(self, x: f64) -> String {
        match self {
            _ if !x.is_finite() => "-".to_owned(),
            Self::Figures(count) => significant(to_digits(x, count.max(1) as usize), count),
            Self::Decimals(count) => match format!("{x:.count$}") {
                zero if zero.bytes().all(|b| b"-0.".contains(&b)) => format!("{:.count$}", 0.0),
                text => text,
            },
        }
    }
}

impl Cell {
    /// Cell text; a dash if not available.
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
    /// An empty table; column titles are given as `a | b`.
    pub fn new(name: impl Into<String>, title: &str, head: &str) -> Self {
        Self {
            name: name.into(),
            title: title.to_owned(),
            head: head.split(" | ").map(str::to_owned).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row: title and cells.
    pub fn row(&mut self, title: impl Into<String>, cells: impl IntoIterator<Item = Cell>) {
        let mut row = vec![word(title)];
        row.extend(cells);
        self.rows.push(row);
    }

    /// Markdown of the table, as on the page.
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
    /// Results with one table.
    pub fn of(table: Table) -> Self {
        let mut findings = Self::default();
        findings.tables.push(table);
        findings
    }

    /// Adds a plot.
    pub fn plot(&mut self, name: &str, plot: Plot) {
        self.figures.push(Figure::plot(name, plot));
    }

    /// Adds the number of a statement of the page's last table.
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
