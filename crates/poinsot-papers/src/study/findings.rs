//! Results of a study: tables, figures and numbers for a page.

use poinsot_figures::{Axis, Figure, Plot, Series};
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
    /// Digits of the numbers of each column.
    digits: Vec<Digits>,
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

impl Digits {
    /// `3` is three significant figures, `.3` three decimals.
    pub(crate) fn named(text: &str) -> Self {
        match text.strip_prefix('.') {
            Some(decimals) => Self::Decimals(decimals.parse().unwrap_or(0)),
            None => Self::Figures(text.parse().unwrap_or(2)),
        }
    }

    /// A number as text; a dash if it is not available.
    ///
    /// ```
    /// use poinsot_papers::study::Digits;
    ///
    /// assert_eq!(Digits::Figures(3).text(0.012345), "0.0123");
    /// assert_eq!(Digits::Decimals(2).text(3.14159), "3.14");
    /// ```
    pub fn text(self, x: f64) -> String {
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
    /// Its number; NaN for a word or a pair.
    fn number(&self) -> f64 {
        match self {
            Self::Number(x, _) => *x,
            _ => f64::NAN,
        }
    }

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
    /// An empty table. Columns are `a | b :3 | c :.4`: b with three significant figures, c with four decimals, and two
    /// significant figures where nothing is said.
    pub fn new(name: impl Into<String>, title: impl Into<String>, head: &str) -> Self {
        let column = |text: &str| {
            let (title, digits) = text.rsplit_once(':').unwrap_or((text, "2"));
            (title.trim().to_owned(), Digits::named(digits))
        };
        let (head, digits) = head.split(" | ").map(column).unzip();
        Self {
            name: name.into(),
            title: title.into(),
            head,
            digits,
            rows: Vec::new(),
        }
    }

    /// Adds a row: its words as `a | b`, then numbers with the digits of their columns.
    pub fn row(&mut self, words: impl AsRef<str>, numbers: impl IntoIterator<Item = f64>) {
        let words = words.as_ref().split(" | ");
        self.rows
            .push(words.map(|w| Cell::Word(w.to_owned())).collect());
        numbers.into_iter().for_each(|x| self.push(x));
    }

    /// Adds a number to the last row.
    pub fn push(&mut self, x: f64) {
        self.cell(|digits| Cell::Number(x, digits));
    }

    /// Adds a word to the last row.
    pub fn word(&mut self, text: impl Into<String>) {
        self.cell(|_| Cell::Word(text.into()));
    }

    /// Adds two numbers in one cell to the last row.
    pub fn pair(&mut self, [a, b]: [f64; 2], between: &'static str) {
        self.cell(|digits| Cell::Pair(a, between, b, digits));
    }

    /// Adds a number with its own digits to the last row.
    pub fn with(&mut self, x: f64, digits: Digits) {
        self.cell(|_| Cell::Number(x, digits));
    }

    fn cell(&mut self, cell: impl FnOnce(Digits) -> Cell) {
        if let Some(row) = self.rows.last_mut() {
            let digits = self.digits.get(row.len()).copied();
            row.push(cell(digits.unwrap_or(Digits::Figures(2))));
        }
    }

    /// The number in a cell; NaN without one.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        let cell = self.rows.get(row).and_then(|r| r.get(column));
        cell.map_or(f64::NAN, Cell::number)
    }
}

impl Findings {
    /// Results with these tables.
    pub fn of(tables: impl IntoIterator<Item = Table>) -> Self {
        Self {
            tables: tables.into_iter().collect(),
            ..Self::default()
        }
    }

    /// Adds a plot.
    pub fn plot(&mut self, name: &str, plot: Plot) {
        self.figures.push(Figure::plot(name, plot));
    }

    /// Adds the number of a statement of the page's last table.
    pub fn state(&mut self, statement: &str, number: impl Into<String>) {
        self.statements.push((statement.to_owned(), number.into()));
    }

    /// Adds statements `statement = number`, in which `{table.row.column}` stands for that cell,
    /// `{table.row.column:.1}` for its number with one decimal, and `{a/b}` for the ratio of two cells.
    #[must_use]
    pub fn say(mut self, lines: &[&str]) -> Self {
        for (statement, text) in lines.iter().filter_map(|l| l.split_once(" = ")) {
            let mut parts = text.split('{');
            let mut said = parts.next().unwrap_or_default().to_owned();
            for (place, rest) in parts.filter_map(|p| p.split_once('}')) {
                said += &self.told(place).unwrap_or_default();
                said += rest;
            }
            self.state(statement, said);
        }
        self
    }

    fn told(&self, place: &str) -> Option<String> {
        let (place, digits) = place.split_once(':').unwrap_or((place, ""));
        if let Some((a, b)) = place.split_once('/') {
            let ratio = self.cell(a)?.number() / self.cell(b)?.number();
            return Some(Digits::named(digits).text(ratio));
        }
        let cell = self.cell(place)?;
        Some(match digits {
            "" => cell.text(),
            _ => Digits::named(digits).text(cell.number()),
        })
    }

    fn cell(&self, place: &str) -> Option<&Cell> {
        let mut path = place.split('.');
        let name = path.next()?;
        let mut index = || path.next()?.parse::<usize>().ok();
        let (row, column) = (index()?, index()?);
        let table = self.tables.iter().find(|t| t.name == name)?;
        table.rows.get(row)?.get(column)
    }
}

/// A plot of curves over axes `quantity, unit`.
pub(crate) fn curves(title: impl Into<String>, x: &str, y: &str, series: Vec<Series>) -> Plot {
    let axis = |text: &str| {
        let (label, unit) = text.split_once(", ").unwrap_or((text, ""));
        Axis::new(label, unit)
    };
    Plot {
        title: title.into(),
        x: axis(x),
        y: axis(y),
        series,
        ..Plot::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_cells_show_the_digits_asked_for() {
        assert_eq!(Digits::Figures(2).text(10_864.0), "11000");
        assert_eq!(Digits::Figures(2).text(0.097_4), "0.097");
        assert_eq!(Digits::Decimals(2).text(-1759.561), "-1759.56");
        assert_eq!(Digits::Decimals(3).text(-1.0e-9), "0.000");
        assert_eq!(Digits::Figures(2).text(f64::INFINITY), "-");
        let pair = Cell::Pair(401.52, "+-", 7.71, Digits::Decimals(1));
        assert_eq!(pair.text(), "401.5 +- 7.7");
    }

    #[test]
    fn exact_a_table_and_a_statement_of_its_cells() {
        let mut table = Table::new("a", "title", " | word | x | y :.3");
        table.row("one | two", [50.0, 0.25]);
        table.word("end");
        assert_eq!(table.head, ["", "word", "x", "y"]);
        let cells: Vec<String> = table.rows[0].iter().map(Cell::text).collect();
        assert_eq!(cells, ["one", "two", "50", "0.250", "end"]);
        let found = Findings::of([table]).say(&["claim = {a.0.2} %, {a.0.3:.1} kg"]);
        assert_eq!(
            found.statements,
            [("claim".to_owned(), "50 %, 0.2 kg".to_owned())]
        );
    }
}
