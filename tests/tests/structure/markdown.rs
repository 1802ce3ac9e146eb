//! Tables of a Markdown file.

use std::collections::BTreeSet;

/// One table.
#[derive(Debug)]
pub struct Table {
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// The table with exactly this header.
    pub fn with_header(text: &str, header: &[&str]) -> Self {
        Self::find(text, &format!("header {header:?}"), |table| table.header == header)
    }

    /// The table whose first column is called so.
    pub fn starting_with(text: &str, first: &str) -> Self {
        Self::find(text, first, |table| table.header[0] == first)
    }

    fn find(text: &str, what: &str, wanted: impl Fn(&Self) -> bool) -> Self {
        let mut found: Vec<Self> = tables(text).into_iter().filter(wanted).collect();
        assert_eq!(found.len(), 1, "exactly one table with {what}");
        found.remove(0)
    }

    /// The row whose first cell is this.
    pub fn row(&self, first: &str) -> &[String] {
        self.rows.iter().find(|row| row[0] == first).unwrap_or_else(|| panic!("no row {first}"))
    }

    /// Names of the columns that are ticked in a row.
    pub fn ticked(&self, first: &str) -> BTreeSet<&str> {
        let row = self.row(first);
        self.header.iter().zip(row).filter(|(_, cell)| *cell == "✓").map(|(name, _)| name.as_str()).collect()
    }
}

fn tables(text: &str) -> Vec<Table> {
    let mut found: Vec<Table> = Vec::new();
    let mut open = false;
    for line in text.lines() {
        let Some(cells) = cells(line) else {
            open = false;
            continue;
        };
        if !open {
            found.push(Table { header: cells, rows: Vec::new() });
            open = true;
        } else if !cells.iter().all(|cell| !cell.is_empty() && cell.chars().all(|c| "-:".contains(c))) {
            let table = found.last_mut().expect("a table is open");
            assert_eq!(cells.len(), table.header.len(), "a row of another length: {line}");
            table.rows.push(cells);
        }
    }
    found
}

fn cells(line: &str) -> Option<Vec<String>> {
    let inner = line.trim().strip_prefix('|')?.strip_suffix('|')?;
    Some(inner.split('|').map(|cell| cell.trim().to_owned()).collect())
}
