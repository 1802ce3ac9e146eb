//! Tables as comma-separated text.

use std::path::Path;

use plumbline_model::files::{self, Size, shortened};

use super::error::{Cell, TableError};
use super::table::{Node, Table, is_same_place, quantity};

impl<N: Node> Table<N> {
    /// Reads a table: a header with the columns in this order, then one line per point. The
    /// smoothing is the published one.
    ///
    /// # Errors
    /// With file, line and column of what is wrong.
    pub fn read(file: &Path) -> Result<Self, TableError> {
        let bytes = files::read(file, Size::SHORT)?;
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
        let not_csv =
            |error: csv::Error| TableError::NotCsv { file: file.to_path_buf(), reason: error.to_string() };
        // Lengths are checked here, so that the error can say more.
        let mut reader = csv::ReaderBuilder::new().flexible(true).trim(csv::Trim::All).from_reader(bytes);
        let header = reader.headers().map_err(not_csv)?;
        if header.iter().ne(N::COLUMNS.iter().copied()) {
            let found = header.iter().collect::<Vec<_>>().join(",");
            return Err(TableError::Header {
                file: file.to_path_buf(),
                found: shortened(&found),
                expected: N::COLUMNS.join(","),
            });
        }
        let mut points: Vec<N> = Vec::new();
        let mut lines = Vec::new();
        for record in reader.records() {
            let record = record.map_err(not_csv)?;
            let line = record.position().map_or(0, csv::Position::line);
            let point = row(file, line, &record)?;
            if let Some(other) = points.iter().position(|other| is_same_place(other, &point)) {
                return Err(TableError::DuplicateLine {
                    file: file.to_path_buf(),
                    line,
                    first: lines[other],
                });
            }
            points.push(point);
            lines.push(line);
        }
        Self::new(points)
    }

    /// Writes the table; the file replaces its predecessor in one step. The smoothing is not in
    /// the file.
    ///
    /// # Errors
    /// When the table cannot be used, or the file cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), TableError> {
        self.check()?;
        let mut text = N::COLUMNS.join(",") + "\n";
        for point in &self.points {
            // Debug keeps the decimal point and all digits.
            let cells: Vec<String> = point.numbers().iter().map(|number| format!("{number:?}")).collect();
            text += &(cells.join(",") + "\n");
        }
        Ok(files::write(file, text)?)
    }
}

fn row<N: Node>(file: &Path, line: u64, record: &csv::StringRecord) -> Result<N, TableError> {
    let file = file.to_path_buf();
    if record.len() != N::COLUMNS.len() {
        return Err(TableError::Width { file, line, found: record.len(), expected: N::COLUMNS.len() });
    }
    let mut numbers = Vec::with_capacity(record.len());
    for (&column, text) in N::COLUMNS.iter().zip(record) {
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => {
                if let Some(Err(what)) = quantity(column).map(|quantity| quantity.check(number)) {
                    let cell = Cell { file, line, column };
                    return Err(TableError::Implausible { cell, what: Box::new(what) });
                }
                numbers.push(number);
            }
            _ => {
                let cell = Cell { file, line, column };
                return Err(TableError::NotANumber { cell, found: shortened(text) });
            }
        }
    }
    Ok(N::from_numbers(&numbers))
}
