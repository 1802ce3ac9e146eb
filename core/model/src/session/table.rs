//! Tables of typed columns, kept in the order of the file, unknown columns included.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use super::error::{Cell, SessionError};
use crate::files::{self, MOST_ROWS, Size, shortened};
use crate::plausible::Quantity;

/// The values of a column, one per row; `None` where the cell is empty.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnValues {
    /// Finite numbers.
    Numbers(Vec<Option<f64>>),
    /// Texts.
    Texts(Vec<Option<String>>),
    /// True or false.
    Flags(Vec<Option<bool>>),
}

/// What the cells of a column should hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ColumnKind {
    Number,
    Text,
    Flag,
}

/// One column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name in the header.
    pub name: String,
    /// Its cells.
    pub values: ColumnValues,
}

/// A table with a header. Columns that the format does not define are kept as texts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    columns: Vec<Column>,
    row_count: usize,
    /// Rows with a number that cannot be, counted from 0, and what is wrong with each. Their numbers
    /// are in the columns, and in no row that is asked for.
    implausible: BTreeMap<usize, String>,
}

impl ColumnValues {
    fn new(kind: ColumnKind) -> Self {
        match kind {
            ColumnKind::Number => Self::Numbers(Vec::new()),
            ColumnKind::Text => Self::Texts(Vec::new()),
            ColumnKind::Flag => Self::Flags(Vec::new()),
        }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(cells) => cells.len(),
            Self::Texts(cells) => cells.len(),
            Self::Flags(cells) => cells.len(),
        }
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether nothing was measured in any row.
    pub fn is_blank(&self) -> bool {
        (0..self.len()).all(|row| self.text(row).is_empty())
    }

    /// A cell as it is written to a file; empty when not measured.
    fn text(&self, row: usize) -> String {
        match self {
            // Debug keeps the decimal point and all digits.
            Self::Numbers(cells) => cells[row].map(|value| format!("{value:?}")).unwrap_or_default(),
            Self::Texts(cells) => cells[row].clone().unwrap_or_default(),
            Self::Flags(cells) => cells[row].map(|value| value.to_string()).unwrap_or_default(),
        }
    }

    fn push(&mut self, text: &str, cell: impl Fn() -> Cell) -> Result<(), SessionError> {
        let trimmed = text.trim();
        match self {
            Self::Texts(cells) => cells.push(Some(text.to_owned()).filter(|text| !text.is_empty())),
            Self::Numbers(cells) if trimmed.is_empty() => cells.push(None),
            Self::Flags(cells) if trimmed.is_empty() => cells.push(None),
            Self::Numbers(cells) => match trimmed.parse::<f64>() {
                Ok(value) if value.is_finite() => cells.push(Some(value)),
                Ok(_) => return Err(SessionError::NotFinite { cell: cell(), found: shortened(trimmed) }),
                Err(_) => return Err(wrong_type(cell(), "a number", trimmed)),
            },
            // Spreadsheets write TRUE and FALSE.
            Self::Flags(cells) => match trimmed.to_ascii_lowercase().as_str() {
                "true" => cells.push(Some(true)),
                "false" => cells.push(Some(false)),
                _ => return Err(wrong_type(cell(), "true or false", trimmed)),
            },
        }
        Ok(())
    }
}

fn wrong_type(cell: Cell, expected: &'static str, found: &str) -> SessionError {
    SessionError::WrongType { cell, expected, found: shortened(found) }
}

impl Table {
    /// A table from columns of equal length; columns without any value are left out unless
    /// `required` says otherwise.
    pub(crate) fn from_columns(columns: Vec<Column>, required: impl Fn(&str) -> bool) -> Self {
        let row_count = columns.first().map_or(0, |column| column.values.len());
        debug_assert!(columns.iter().all(|column| column.values.len() == row_count));
        let columns = columns
            .into_iter()
            .filter(|column| required(&column.name) || !column.values.is_blank())
            .collect();
        Self { columns, row_count, implausible: BTreeMap::new() }
    }

    /// Reads a table; `kind` gives the type of the columns that the format defines.
    pub(crate) fn read(
        file: &Path,
        kind: impl Fn(&str) -> Option<ColumnKind>,
    ) -> Result<ReadTable<'_>, SessionError> {
        let bytes = files::read(file, Size::TEXT)?;
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
        // Lengths are checked here, so that the error can name the column.
        let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(bytes);
        let header = reader.headers().map_err(|error| not_csv(file, &error))?.clone();
        let mut columns = read_header(file, &header, kind)?;
        let mut record = csv::StringRecord::new();
        let mut lines = Vec::new();
        while reader.read_record(&mut record).map_err(|error| not_csv(file, &error))? {
            let line = record.position().map_or(0, csv::Position::line);
            if lines.len() == MOST_ROWS {
                return Err(SessionError::TooManyRows { file: file.to_path_buf() });
            }
            read_row(file, line, &record, &mut columns)?;
            lines.push(line);
        }
        Ok(ReadTable {
            file,
            table: Self { columns, row_count: lines.len(), implausible: BTreeMap::new() },
            lines,
        })
    }

    /// Writes the table in one step.
    pub(crate) fn write(&self, file: &Path) -> Result<(), SessionError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let in_memory = "a table is written to memory, row by row of equal length";
        writer.write_record(self.columns.iter().map(|column| column.name.as_str())).expect(in_memory);
        for row in 0..self.row_count {
            writer.write_record(self.columns.iter().map(|column| column.values.text(row))).expect(in_memory);
        }
        let bytes = writer.into_inner().expect(in_memory);
        Ok(files::write(file, bytes)?)
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.row_count
    }

    /// All columns, in the order of the file.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Whether a column is there.
    pub fn has(&self, name: &str) -> bool {
        self.column(name).is_some()
    }

    /// Gives a column another name; nothing where it is not there.
    pub(super) fn rename(&mut self, from: &str, to: &str) {
        if let Some(column) = self.columns.iter_mut().find(|column| column.name == from) {
            to.clone_into(&mut column.name);
        }
    }

    fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// A column of numbers; `None` if there is no such column.
    pub fn numbers(&self, name: &str) -> Option<&[Option<f64>]> {
        match &self.column(name)?.values {
            ColumnValues::Numbers(cells) => Some(cells),
            _ => None,
        }
    }

    /// A column of texts; `None` if there is no such column.
    pub fn texts(&self, name: &str) -> Option<&[Option<String>]> {
        match &self.column(name)?.values {
            ColumnValues::Texts(cells) => Some(cells),
            _ => None,
        }
    }

    /// A column of flags; `None` if there is no such column.
    pub fn flags(&self, name: &str) -> Option<&[Option<bool>]> {
        match &self.column(name)?.values {
            ColumnValues::Flags(cells) => Some(cells),
            _ => None,
        }
    }

    /// Rows with a number that cannot be, counted from 0: line, column, number, range and likely
    /// cause. They count as rows in which nothing was measured.
    pub fn implausible(&self) -> &BTreeMap<usize, String> {
        &self.implausible
    }

    /// A cell of numbers; `None` if column, row or value is not there, or the row cannot be.
    pub(crate) fn number(&self, name: &str, row: usize) -> Option<f64> {
        if self.implausible.contains_key(&row) {
            return None;
        }
        *self.numbers(name)?.get(row)?
    }

    /// A cell of texts, same; without the spaces around it, which nobody sees.
    pub(crate) fn text(&self, name: &str, row: usize) -> Option<String> {
        let text = self.texts(name)?.get(row)?.as_deref()?.trim();
        (!text.is_empty()).then(|| text.to_owned())
    }

    /// All of these numbers, or `None` if any is not there.
    pub(crate) fn tuple<const N: usize>(&self, names: [&str; N], row: usize) -> Option<[f64; N]> {
        let mut values = [0.0; N];
        for (value, name) in values.iter_mut().zip(names) {
            *value = self.number(name, row)?;
        }
        Some(values)
    }
}

/// A table that was just read, with the line of every row, for the checks of its kind of table.
pub(crate) struct ReadTable<'a> {
    file: &'a Path,
    lines: Vec<u64>,
    pub table: Table,
}

impl ReadTable<'_> {
    /// Whether any of the columns is there.
    pub fn has_any(&self, columns: &[&str]) -> bool {
        columns.iter().any(|column| self.table.has(column))
    }

    /// Requires a column.
    pub fn require(&self, column: &str, advice: &'static str) -> Result<(), SessionError> {
        if self.table.has(column) { Ok(()) } else { Err(self.missing(column, advice)) }
    }

    /// The error for a column that has to be there.
    pub fn missing(&self, column: &str, advice: &'static str) -> SessionError {
        SessionError::MissingColumn { file: self.file.to_path_buf(), column: column.to_owned(), advice }
    }

    /// Sets rows aside in which a number cannot be. A few are left out of what follows; when more than
    /// a quarter of the rows are like that, the column is in another unit.
    ///
    /// # Errors
    /// [`SessionError::Implausible`] with the first of them.
    pub fn set_implausible_aside(
        &mut self,
        quantity: impl Fn(&str) -> Option<Quantity>,
    ) -> Result<(), SessionError> {
        let mut first = None;
        for column in &self.table.columns {
            let (ColumnValues::Numbers(cells), Some(quantity)) = (&column.values, quantity(&column.name))
            else {
                continue;
            };
            for (row, value) in cells.iter().enumerate() {
                let Some(what) = value.and_then(|value| quantity.check(value).err()) else { continue };
                let line = self.lines[row];
                let name = shortened(&column.name);
                self.table
                    .implausible
                    .entry(row)
                    .or_insert_with(|| format!("line {line}, column {name}: {what}"));
                first.get_or_insert((line, name, what));
            }
        }
        let (count, rows) = (self.table.implausible.len(), self.table.row_count);
        let too_many = count == rows || (count > 1 && 4 * count > rows);
        match first.filter(|_| too_many) {
            Some((line, column, what)) => Err(SessionError::Implausible {
                cell: Cell { file: self.file.to_path_buf(), line, column },
                what: Box::new(what),
                count,
                rows,
            }),
            None => Ok(()),
        }
    }

    /// Sets rows aside in which the components of a unit vector or quaternion do not have length 1
    /// within `tolerance`; more than a quarter of the rows like that are another thing.
    ///
    /// # Errors
    /// [`SessionError::NotUnit`] with the first of them.
    pub fn set_other_lengths_aside(&mut self, names: &[&str], tolerance: f64) -> Result<(), SessionError> {
        let mut first = None;
        let mut count = 0;
        let mut rows = 0;
        for (row, &line) in self.lines.iter().enumerate() {
            let given: Vec<f64> = names.iter().filter_map(|name| self.table.number(name, row)).collect();
            if given.len() < names.len() {
                continue;
            }
            rows += 1;
            let length = given.iter().map(|value| value * value).sum::<f64>().sqrt();
            if (length - 1.0).abs() <= tolerance {
                continue;
            }
            count += 1;
            first.get_or_insert((line, length));
            let what =
                format!("line {line}, columns {}: their length is {length:.3}, not 1", names.join(", "));
            self.table.implausible.entry(row).or_insert(what);
        }
        let too_many = count == rows || (count > 1 && 4 * count > rows);
        match first.filter(|_| too_many) {
            Some((line, length)) => {
                let column = names.join(", ");
                let cell = Cell { file: self.file.to_path_buf(), line, column };
                Err(SessionError::NotUnit { cell, length })
            }
            None => Ok(()),
        }
    }

    /// Requires that in each row the coordinates of a point are all given or all empty.
    pub fn require_whole_points(&self, names: &[&str]) -> Result<(), SessionError> {
        for (row, &line) in self.lines.iter().enumerate() {
            let given: Vec<bool> = names.iter().map(|name| self.table.number(name, row).is_some()).collect();
            if given.contains(&true)
                && let Some(absent) = given.iter().position(|given| !given)
            {
                let column = names[absent].to_owned();
                return Err(SessionError::IncompletePoint {
                    cell: Cell { file: self.file.to_path_buf(), line, column },
                });
            }
        }
        Ok(())
    }
}

fn not_csv(file: &Path, error: &csv::Error) -> SessionError {
    let line = match error.kind() {
        csv::ErrorKind::Utf8 { pos: Some(position), .. } => position.line(),
        _ => error.position().map_or(1, csv::Position::line),
    };
    SessionError::NotCsv { file: file.to_path_buf(), line, reason: error.to_string() }
}

fn read_header(
    file: &Path,
    header: &csv::StringRecord,
    kind: impl Fn(&str) -> Option<ColumnKind>,
) -> Result<Vec<Column>, SessionError> {
    if header.iter().all(|name| name.trim().is_empty()) {
        return Err(SessionError::NoHeader { file: file.to_path_buf() });
    }
    if header.len() == 1 && header.iter().any(|name| name.contains([';', '\t'])) {
        return Err(SessionError::NotCsv {
            file: file.to_path_buf(),
            line: 1,
            reason: "the columns are not separated by commas".to_owned(),
        });
    }
    let mut seen = HashSet::new();
    let mut columns = Vec::with_capacity(header.len());
    for name in header.iter().map(str::trim) {
        if !name.is_empty() && !seen.insert(name.to_owned()) {
            return Err(SessionError::DuplicateColumn { file: file.to_path_buf(), column: shortened(name) });
        }
        let kind = kind(name).unwrap_or(ColumnKind::Text);
        columns.push(Column { name: name.to_owned(), values: ColumnValues::new(kind) });
    }
    Ok(columns)
}

fn read_row(
    file: &Path,
    line: u64,
    record: &csv::StringRecord,
    columns: &mut [Column],
) -> Result<(), SessionError> {
    if record.len() != columns.len() {
        let shorter = record.len().min(columns.len());
        return Err(SessionError::RowLength {
            file: file.to_path_buf(),
            line,
            column: columns.get(shorter).map_or(format!("number {}", shorter + 1), |c| c.name.clone()),
            expected: columns.len(),
            found: record.len(),
        });
    }
    for (column, text) in columns.iter_mut().zip(record) {
        let name = &column.name;
        column.values.push(text, || Cell { file: file.to_path_buf(), line, column: name.clone() })?;
    }
    Ok(())
}
