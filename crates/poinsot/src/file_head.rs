//! The first lines of a text file: layout, header, units and the first row.

use poinsot_telemetry::{Layout, Unit, parse_unit};
use std::io::Read;
use std::path::Path;

/// Bytes and lines of a file that are read.
const BYTES: u64 = 1 << 18;
const LINES: usize = 200;

/// The parsed first lines of a file.
pub(crate) struct FileHead {
    /// What differs from the default.
    layout: Layout,
    pub header: Vec<String>,
    /// Unit of each column, where the row below the header names units.
    pub units: Option<Vec<Option<Unit>>>,
    first: Vec<String>,
}

impl FileHead {
    /// Reads the head of a file; `None` if it is not text with a header.
    pub fn read(path: &Path) -> Option<Self> {
        let mut bytes = Vec::new();
        let (file, _) = poinsot_files::open(path).ok()?;
        file.take(BYTES).read_to_end(&mut bytes).ok()?;
        let text = String::from_utf8_lossy(&bytes);
        (!bytes.contains(&0)).then(|| Self::of(&text)).flatten()
    }

    fn of(text: &str) -> Option<Self> {
        let lines: Vec<&str> = text.lines().take(LINES).collect();
        let comment = lines.first()?.chars().next().filter(|c| "#%!".contains(*c));
        let is_comment = |line: &str| comment.is_some_and(|c| line.starts_with(c));
        let body: Vec<(usize, &str)> = lines
            .iter()
            .enumerate()
            .filter(|(_, line)| !is_comment(line) && !line.trim().is_empty())
            .map(|(k, line)| (k + 1, *line))
            .collect();
        // The last complete line gives the number of fields.
        let last = body.get(body.len().checked_sub(2)?)?.1;
        let fields = |delimiter: char| last.matches(delimiter).count();
        let delimiter = [',', ';', '\t', '|']
            .into_iter()
            .max_by_key(|d| (fields(*d), *d == ','))
            .filter(|d| fields(*d) > 0)?;
        let split = |line: &str| -> Vec<String> {
            let cells = line.split(delimiter);
            cells
                .map(|c| c.trim().trim_matches('"').to_owned())
                .collect()
        };
        let width = fields(delimiter) + 1;
        let first = body
            .iter()
            .position(|(_, line)| split(line).len() == width)?;
        let (line, header) = body.get(first)?;
        let (mut line, mut header, mut skipped) = (*line, split(header), first + 1);
        let behind = header.iter().any(|h| h.parse::<f64>().is_ok());
        if behind {
            // The header is the last comment: "# t,wx,wy". The reader leaves out "#", and no other sign.
            let above = lines.iter().enumerate().take(line.saturating_sub(1)).rev();
            let mut named = above.filter(|(_, l)| is_comment(l) && split(l).len() == width);
            let (at, text) = named.next()?;
            header = split(text.trim_start_matches('#').trim_start());
            (line, skipped) = (at + 1, first);
        }
        let mut rows = body.iter().skip(skipped).map(|(_, line)| split(line));
        let mut row = rows.next()?;
        let is_unit = |cell: &String| parse_unit(bare(cell)).is_ok();
        let is_number = |cell: &String| cell.parse::<f64>().is_ok();
        let named = row.iter().any(is_unit) && !row.iter().any(is_number);
        let parsed = || row.iter().map(|cell| parse_unit(bare(cell)).ok()).collect();
        let units = named.then(parsed);
        if units.is_some() {
            row = rows.next()?;
        }
        // Comments are skipped anywhere; other lines above the header are counted.
        let above = lines.iter().take(line.saturating_sub(1));
        let plain_above = above.filter(|l| behind || !is_comment(l)).count();
        let of_header = behind && comment == Some('#');
        let delimiter = match delimiter {
            '\t' => "tab".to_owned(),
            other => other.to_string(),
        };
        let layout = Layout {
            comment: comment.filter(|_| !behind).map(String::from),
            delimiter: Some(delimiter).filter(|mark| mark != ","),
            header_row: (plain_above > 0 || of_header).then_some(line as u64),
            decimal: None,
            units_row: units.is_some().then_some(true),
        };
        Some(Self {
            layout,
            header,
            units,
            first: row,
        })
    }

    /// The keys of the layout that differ from the default.
    pub fn layout(&self) -> String {
        let keys = toml::Table::try_from(&self.layout).unwrap_or_default();
        toml::to_string(&keys).unwrap_or_default()
    }

    /// A cell of the first row.
    pub fn cell(&self, column: usize) -> &str {
        self.first.get(column).map_or("", String::as_str)
    }
}

fn bare(cell: &str) -> &str {
    cell.trim().trim_matches(['[', ']', '(', ')']).trim()
}

/// A text as TOML writes it; that of a header or an answer is on one line.
pub(crate) fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}
