//! What can be wrong with a session folder, and what to do about it.

use std::fmt;
use std::path::PathBuf;

use crate::files::{FileError, MOST_ROWS};
use crate::formats::FormatError;
use crate::plausible::Implausible;

/// A cell of a table: file, line and column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The file.
    pub file: PathBuf,
    /// Line in the file, counted from 1; the header is line 1.
    pub line: u64,
    /// Name of the column.
    pub column: String,
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, line {}, column {}", self.file.display(), self.line, self.column)
    }
}

/// Why a session could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The path is no folder.
    #[error("{} is not a folder: give the folder that holds session.toml", folder.display())]
    NotAFolder {
        /// The path.
        folder: PathBuf,
    },
    /// A folder of something else.
    #[error("{} is no session: it has no session.toml. Choose the folder that holds one beside its tables", folder.display())]
    NoManifest {
        /// The folder.
        folder: PathBuf,
    },
    /// The manifest cannot be used.
    #[error(transparent)]
    Manifest(#[from] FormatError),
    /// No table, no images, no log.
    #[error(
        "{} holds no measurements: a session has at least one of touches.csv, localizations.csv, poses.csv, images under stereo/left and stereo/right, or log.mcap",
        folder.display()
    )]
    NothingMeasured {
        /// The folder.
        folder: PathBuf,
    },
    /// A table without the part of the manifest that explains it.
    #[error("{} needs the section [{section}] in session.toml: add it, the format description shows an example", table.display())]
    NeedsSection {
        /// The table.
        table: PathBuf,
        /// "touchscreen" or "chain".
        section: &'static str,
    },
    /// A file itself cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// More rows than any session has.
    #[error(
        "{} has more than {MOST_ROWS} rows, too many to work with: check that it is the right table, and divide it among several sessions", file.display()
    )]
    TooManyRows {
        /// The table.
        file: PathBuf,
    },
    /// Not even a header.
    #[error("{} is empty: a table starts with one line of column names; write the names or remove the file", file.display())]
    NoHeader {
        /// The table.
        file: PathBuf,
    },
    /// Not a table of text.
    #[error("{}, line {line}: {reason}; save the table as comma-separated text in UTF-8", file.display())]
    NotCsv {
        /// The table.
        file: PathBuf,
        /// Line of the problem.
        line: u64,
        /// What is wrong.
        reason: String,
    },
    /// A required column is missing.
    #[error("{}, line 1: column {column} is missing; {advice}", file.display())]
    MissingColumn {
        /// The table.
        file: PathBuf,
        /// The column, or the columns of which one is needed.
        column: String,
        /// What to do.
        advice: &'static str,
    },
    /// A column name occurs twice.
    #[error("{}, line 1: column {column} occurs twice; rename or remove one of the two", file.display())]
    DuplicateColumn {
        /// The table.
        file: PathBuf,
        /// The name.
        column: String,
    },
    /// Too many or too few cells.
    #[error(
        "{}, line {line}: {found} cells where the header has {expected}; the first cell without its counterpart is in column {column}. Check for a missing or a decimal comma",
        file.display()
    )]
    RowLength {
        /// The table.
        file: PathBuf,
        /// The row.
        line: u64,
        /// First column that has no cell, or the number of the first cell that has no column.
        column: String,
        /// Cells in the header.
        expected: usize,
        /// Cells in the row.
        found: usize,
    },
    /// A cell of another type.
    #[error(
        "{cell}: \"{found}\" is not {expected}; correct the cell, or leave it empty if it was not measured"
    )]
    WrongType {
        /// Where.
        cell: Cell,
        /// What belongs there.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// A number that is not finite.
    #[error("{cell}: {found} is not a finite number; leave the cell empty if it was not measured")]
    NotFinite {
        /// Where.
        cell: Cell,
        /// What is there.
        found: String,
    },
    /// Numbers that cannot be, in so many rows that the column is another one than it says.
    #[error(
        "{cell}: {what}. So it is in {count} of the {rows} rows: correct the column or its unit, and open the session again"
    )]
    Implausible {
        /// The first of them.
        cell: Cell,
        /// What cannot be, and why.
        what: Box<Implausible>,
        /// Rows that cannot be.
        count: usize,
        /// All rows.
        rows: usize,
    },
    /// One coordinate without the others.
    #[error(
        "{cell} is empty, but the other coordinates of that point are given; fill it, or leave all of them empty"
    )]
    IncompletePoint {
        /// The empty cell.
        cell: Cell,
    },
    /// A vector or quaternion of another length than 1.
    #[error(
        "{cell}: the components have length {length:.3}, not 1: give a unit quaternion, in the order w, x, y, z"
    )]
    NotUnit {
        /// Its cell.
        cell: Cell,
        /// Its length.
        length: f64,
    },
}
