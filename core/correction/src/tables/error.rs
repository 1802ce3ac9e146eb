//! What can be wrong with a table.

use std::fmt;
use std::path::PathBuf;

use plumbline_model::files::FileError;

use plumbline_model::plausible::Implausible;

use crate::border::BorderError;

/// A cell of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The file.
    pub file: PathBuf,
    /// Line in the file, counted from 1; the header is line 1.
    pub line: u64,
    /// Name of the column.
    pub column: &'static str,
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, line {}, column {}", self.file.display(), self.line, self.column)
    }
}

/// Why a table cannot be read, changed, used or written.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file itself cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Not a table of text.
    #[error("{}: {reason}; save the table as comma-separated text in UTF-8", file.display())]
    NotCsv {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Other columns than those of this table.
    #[error("{}, line 1: the columns are \"{found}\", this table has \"{expected}\"; choose another file or correct the header", file.display())]
    Header {
        /// The file.
        file: PathBuf,
        /// Its columns.
        found: String,
        /// The right ones.
        expected: String,
    },
    /// A row with more or fewer cells than columns.
    #[error("{}, line {line}: {found} cells for {expected} columns; complete the line or remove it", file.display())]
    Width {
        /// The file.
        file: PathBuf,
        /// Its line.
        line: u64,
        /// Number of cells.
        found: usize,
        /// Number of columns.
        expected: usize,
    },
    /// A cell that holds no finite number.
    #[error("{cell}: \"{found}\" is no finite number; correct the cell or remove the line")]
    NotANumber {
        /// Where.
        cell: Cell,
        /// What stands there.
        found: String,
    },
    /// Two points of a file at one place.
    #[error("{}, line {line}: the same place as line {first}; remove one of the two", file.display())]
    DuplicateLine {
        /// The file.
        file: PathBuf,
        /// The second point.
        line: u64,
        /// The first point.
        first: u64,
    },
    /// Two points of a table at one place.
    #[error("there is a point at this place already (point {index}, counted from 0): change that one")]
    Duplicate {
        /// The point that is there.
        index: usize,
    },
    /// A coordinate or value that is no number.
    #[error("{column} of the point is no finite number: give one in its unit")]
    NotFinite {
        /// Which one.
        column: &'static str,
    },
    /// A coordinate or value that cannot be.
    #[error("{column} of the point: {what}")]
    ImplausiblePoint {
        /// Which one.
        column: &'static str,
        /// What cannot be, and why.
        what: Box<Implausible>,
    },
    /// A cell of a file that cannot be.
    #[error("{cell}: {what}. Correct the cell or remove the line")]
    Implausible {
        /// Where.
        cell: Cell,
        /// What cannot be, and why.
        what: Box<Implausible>,
    },
    /// No such point.
    #[error("there is no point {index}: the table has {count}, counted from 0")]
    NoSuchPoint {
        /// What was asked for.
        index: usize,
        /// Number of points.
        count: usize,
    },
    /// Too few to interpolate.
    #[error(
        "a table of {found} points cannot be interpolated: it needs at least {}; add points",
        super::table::FEWEST
    )]
    TooFew {
        /// Number of points.
        found: usize,
    },
    /// The smoothing makes no sense.
    #[error("a smoothing of {found} cannot be used: choose 0 (through all points) or more")]
    Smoothing {
        /// What was given.
        found: f64,
    },
    /// The points have no area.
    #[error("the points of the table have no area ({0})")]
    NoArea(#[source] BorderError),
    /// The equations have no solution.
    #[error("the equations of the table have no unique solution: change the smoothing a little")]
    Singular,
    /// The angles go all around.
    #[error(
        "the yaw angles go all around the circle, so that none can be told between two of them: split the table or check the angles"
    )]
    YawAllAround,
}
