//! What takes time with tables: files, errors, fields.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_correction::tables::{HeightTable, Node, Table, TableError, YawTable};
use plumbline_model::robot::Rig;
use plumbline_model::{JobContext, counted};

use super::{ReadTable, Tables};
use crate::ground::LongWork;
use crate::ground::jobs::JobError;
use crate::ground::shelf::InUse;
use crate::ground::text::sentence;
use crate::models::command::GraspTable;
use crate::models::error::ModelError;
use crate::models::view::Field;

/// Values of the field along x and along y.
const FIELD: (usize, usize) = (25, 40);
/// The table is shown this far around its points, m.
const MARGIN_M: f64 = 0.04;
/// Points that it takes to interpolate.
const FEWEST: usize = 4;

/// Work with tables.
#[derive(Clone, Debug)]
pub enum TablesWork {
    /// Writes the tables to their place and computes their figures.
    Keep {
        /// Where to.
        folder: PathBuf,
        /// What.
        tables: Tables,
        /// On whose table they are shown.
        rig: Arc<Rig>,
    },
    /// Reads a table.
    Import {
        /// Which.
        table: GraspTable,
        /// Where from.
        file: PathBuf,
    },
    /// Writes a table for others.
    Export {
        /// Which.
        table: GraspTable,
        /// Where to.
        file: PathBuf,
        /// Both.
        tables: Tables,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum TablesResult {
    /// They are on disk.
    Kept(TableFigures),
    /// The table that was read; what becomes of the points that were there is said when it is used.
    Imported(ReadTable),
    /// Written there.
    Exported(PathBuf),
}

/// How good the tables are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableFigures {
    /// Leave-one-out error per point, m; empty when it cannot be computed.
    pub height_errors_m: Vec<f64>,
    /// Heights over the table.
    pub height_field: Field,
    /// Leave-one-out error per point, rad; empty when it cannot be computed.
    pub yaw_errors_rad: Vec<f64>,
    /// What the operator should know, a sentence each.
    pub remarks: Vec<String>,
}

impl LongWork for TablesWork {
    type Result = TablesResult;

    fn title(&self) -> String {
        match self {
            Self::Keep { .. } => "Keep the tables".to_owned(),
            Self::Import { .. } => "Read a table".to_owned(),
            Self::Export { .. } => "Write a table".to_owned(),
        }
    }

    fn is_quiet(&self) -> bool {
        matches!(self, Self::Keep { .. } | Self::Import { .. })
    }

    fn run(self, context: &dyn JobContext) -> Result<TablesResult, JobError> {
        let words = |error: TableError| JobError::failed(sentence(&error.to_string()));
        context.checkpoint()?;
        match self {
            Self::Keep { folder, tables, rig } => {
                keep(&folder, &tables).map_err(JobError::failed)?;
                Ok(TablesResult::Kept(figures(&tables, &rig)))
            }
            Self::Import { table: GraspTable::Height, file } => {
                let height = HeightTable::read(&file).map_err(words)?;
                Ok(TablesResult::Imported(ReadTable::Height(Arc::new(height))))
            }
            Self::Import { table: GraspTable::Yaw, file } => {
                let yaw = YawTable::read(&file).map_err(words)?;
                Ok(TablesResult::Imported(ReadTable::Yaw(Arc::new(yaw))))
            }
            Self::Export { table, file, tables } => {
                plumbline_model::files::export(&file)
                    .map_err(|error| JobError::failed(sentence(&error.to_string())))?;
                match (table, &tables.height, &tables.yaw) {
                    (GraspTable::Height, Some(height), _) => height.write(&file).map_err(words)?,
                    (GraspTable::Yaw, _, Some(yaw)) => yaw.write(&file).map_err(words)?,
                    _ => return Err(JobError::failed("This table has no points yet.")),
                }
                Ok(TablesResult::Exported(file))
            }
        }
    }
}

impl TablesResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Kept(_) => "The tables are kept.".to_owned(),
            Self::Imported(ReadTable::Height(table)) => {
                format!("The height table was read: {}.", counted(table.points.len(), "point"))
            }
            Self::Imported(ReadTable::Yaw(table)) => {
                format!("The yaw table was read: {}.", counted(table.points.len(), "point"))
            }
            Self::Exported(file) => format!("The table was written to {}.", file.display()),
        }
    }
}

fn files(folder: &Path) -> (PathBuf, PathBuf) {
    (folder.join("height.csv"), folder.join("yaw.csv"))
}

/// Writes the tables; one that has too few points to be used has no file.
fn keep(folder: &Path, tables: &Tables) -> Result<(), ModelError> {
    std::fs::create_dir_all(folder)
        .map_err(|error| ModelError::NoFolder { folder: folder.to_owned(), error })?;
    let (height, yaw) = files(folder);
    keep_one(tables.height.as_deref(), &height)?;
    keep_one(tables.yaw.as_deref(), &yaw)
}

fn keep_one<N: Node>(table: Option<&Table<N>>, file: &Path) -> Result<(), ModelError> {
    match table.filter(|table| table.points.len() >= FEWEST) {
        Some(table) => Ok(table.write(file)?),
        None => {
            let kept = InUse::new(file.to_owned());
            kept.forget().map_err(|error| ModelError::NotRemoved { file: file.to_owned(), error })
        }
    }
}

/// What was kept, and what could not be read, a sentence each.
pub(in crate::models) fn restore(folder: &Path) -> (Tables, Vec<String>) {
    let (height, yaw) = files(folder);
    let mut problems = Vec::new();
    let tables = Tables { height: read_one(&height, &mut problems), yaw: read_one(&yaw, &mut problems) };
    (tables, problems)
}

fn read_one<N: Node>(file: &Path, problems: &mut Vec<String>) -> Option<Arc<Table<N>>> {
    let read = match plumbline_model::files::present(file) {
        Ok(false) => return None,
        Ok(true) => Table::read(file).map_err(|error| error.to_string()),
        Err(error) => Err(error.to_string()),
    };
    read.map(Arc::new).map_err(|problem| problems.push(sentence(&problem))).ok()
}

/// Errors and fields of tables.
pub(in crate::models) fn figures(tables: &Tables, rig: &Rig) -> TableFigures {
    let mut figures = TableFigures::default();
    let mut remark = |name: &str, error: TableError| {
        figures.remarks.push(format!("The {name} table cannot be used yet: {error}."));
    };
    if let Some(table) = tables.height.as_deref() {
        match table.leave_one_out() {
            Ok(errors) => figures.height_errors_m = errors,
            Err(error) => remark("height", error),
        }
        figures.height_field = height_field(table, rig).unwrap_or_default();
    }
    if let Some(table) = tables.yaw.as_deref() {
        match table.leave_one_out() {
            Ok(errors) => figures.yaw_errors_rad = errors,
            Err(error) => remark("yaw", error),
        }
    }
    figures
}

/// Heights over the points of the table and a little around, where they may be trusted.
fn height_field(table: &HeightTable, rig: &Rig) -> Option<Field> {
    let surface = table.surface().ok()?;
    let around = |values: Vec<f64>, [low, high]: [f64; 2]| {
        let least = values.iter().copied().fold(high, f64::min) - MARGIN_M;
        let most = values.iter().copied().fold(low, f64::max) + MARGIN_M;
        [least, most]
    };
    let x_m = around(table.points.iter().map(|point| point.x_m).collect(), rig.work_patch.x_range_m);
    let y_m = around(table.points.iter().map(|point| point.y_m).collect(), rig.work_patch.y_range_m);
    Some(Field::fill(x_m, y_m, FIELD, |x_m, y_m| {
        let height = surface.interpolate(x_m, y_m).ok()?;
        height.inside.then_some(height.value)
    }))
}
