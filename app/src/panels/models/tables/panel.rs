//! How the tables are looked at.

use std::time::Instant;

use plumbline_engine::GraspTable;
use plumbline_engine::view::TablesView;
use plumbline_widgets::format::Quantity;
use plumbline_widgets::seen::Seen;

use super::rows::PointRow;
use crate::operator::snapshot::models::{HeightTable, YawTable};

/// How the tables are looked at.
#[derive(Debug, Default)]
pub struct TablesPanel {
    /// Which table.
    pub table: GraspTable,
    /// Whether points are colored by their error rather than by their value.
    pub by_error: bool,
    /// Layer of the yaw table that is shown, m; `None` shows all.
    pub layer_m: Option<f64>,
    /// The chosen point, counted from 0.
    pub chosen: Option<usize>,
    /// Whether a click on the map adds a point.
    pub adding: bool,
    /// A point that is being edited in the fields.
    pub(super) draft: Option<PointRow>,
    /// A point that was moved, until the engine has answered.
    pub(super) moved: Option<Moved>,
}

#[derive(Debug)]
pub(super) struct Moved {
    pub(super) point: usize,
    pub(super) at_m: [f64; 2],
    /// The table that it was moved in.
    pub(super) of: SeenTable,
    pub(super) when: Instant,
}

/// A table as it was seen; every change of it makes another one.
#[derive(Debug, PartialEq)]
pub(super) enum SeenTable {
    Height(Seen<HeightTable>),
    Yaw(Seen<YawTable>),
}

impl SeenTable {
    pub(super) fn of(tables: &TablesView, table: GraspTable) -> Self {
        match table {
            GraspTable::Height => Self::Height(Seen::of_any(tables.height.as_ref())),
            GraspTable::Yaw => Self::Yaw(Seen::of_any(tables.yaw.as_ref())),
        }
    }
}

/// What the values of a table are.
pub(super) fn quantity(table: GraspTable) -> Quantity {
    match table {
        GraspTable::Height => Quantity::Length,
        GraspTable::Yaw => Quantity::Angle,
    }
}
