//! How tables name and build the columns of joints, and tables from rows.

use super::table::{Column, ColumnValues, Table};
use crate::plausible::{self, Quantity};

/// Collects rows into named columns, for writing.
pub(crate) struct ColumnBuilder<'a, R> {
    rows: &'a [R],
    columns: Vec<Column>,
}

impl<'a, R> ColumnBuilder<'a, R> {
    pub fn new(rows: &'a [R]) -> Self {
        Self { rows, columns: Vec::new() }
    }

    pub fn number(&mut self, name: impl Into<String>, value: impl Fn(&R) -> Option<f64>) {
        let values = ColumnValues::Numbers(self.rows.iter().map(value).collect());
        self.columns.push(Column { name: name.into(), values });
    }

    /// Values by the number of the row, counted from 0.
    pub fn indexed(&mut self, name: &str, value: impl Fn(usize) -> Option<f64>) {
        let values = ColumnValues::Numbers((0..self.rows.len()).map(value).collect());
        self.columns.push(Column { name: name.to_owned(), values });
    }

    pub fn text(&mut self, name: &str, value: impl Fn(&R) -> Option<String>) {
        let cells = self.rows.iter().map(|row| value(row).filter(|text| !text.is_empty())).collect();
        self.columns.push(Column { name: name.to_owned(), values: ColumnValues::Texts(cells) });
    }

    pub fn flag(&mut self, name: &str, value: impl Fn(&R) -> Option<bool>) {
        let values = ColumnValues::Flags(self.rows.iter().map(value).collect());
        self.columns.push(Column { name: name.to_owned(), values });
    }

    /// One column per joint: `prefix_<joint>_suffix`.
    pub fn joints(&mut self, joints: &[String], naming: JointColumn, values: impl Fn(&R) -> &[Option<f64>]) {
        for (i, joint) in joints.iter().enumerate() {
            self.number(naming.name(joint), |row| values(row).get(i).copied().flatten());
        }
    }

    pub fn finish(self, required: impl Fn(&str) -> bool) -> Table {
        Table::from_columns(self.columns, required)
    }
}

/// How the columns of one quantity of every joint are called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct JointColumn {
    prefix: &'static str,
    suffix: &'static str,
}

impl JointColumn {
    pub const COMMANDED: Self = Self { prefix: "cmd_", suffix: "_rad" };
    pub const ENCODER: Self = Self { prefix: "enc_", suffix: "_rad" };
    pub const HEAD: Self = Self { prefix: "head_", suffix: "_rad" };
    pub const TORQUE: Self = Self { prefix: "tau_", suffix: "_nm" };
    pub const TEMPERATURE: Self = Self { prefix: "temp_", suffix: "_c" };
    pub const LOAD: Self = Self { prefix: "load_", suffix: "" };

    /// Name of the column of a joint.
    pub fn name(self, joint: &str) -> String {
        format!("{}{joint}{}", self.prefix, self.suffix)
    }

    /// Joint of a column, if the column is one of these.
    pub fn joint(self, column: &str) -> Option<&str> {
        column.strip_prefix(self.prefix)?.strip_suffix(self.suffix).filter(|joint| !joint.is_empty())
    }

    /// The same of a joint that slides: `cmd_<joint>_m`.
    pub fn slide(self) -> Self {
        Self { suffix: "_m", ..self }
    }

    /// Name of the column that a table has of a joint, be it in radians or in meters.
    pub fn name_in(self, table: &Table, joint: &str) -> String {
        let slide = self.slide().name(joint);
        if table.has(&slide) && !table.has(&self.name(joint)) { slide } else { self.name(joint) }
    }

    /// What a column holds, by its name, if it is one of any joint.
    pub fn quantity(column: &str) -> Option<Quantity> {
        [
            (Self::COMMANDED, plausible::JOINT_ANGLE_RAD),
            (Self::ENCODER, plausible::JOINT_ANGLE_RAD),
            (Self::HEAD, plausible::JOINT_ANGLE_RAD),
            (Self::TORQUE, plausible::TORQUE_NM),
            (Self::TEMPERATURE, plausible::TEMPERATURE_C),
            (Self::LOAD, plausible::LOAD),
            (Self::COMMANDED.slide(), plausible::SLIDE_M),
            (Self::ENCODER.slide(), plausible::SLIDE_M),
        ]
        .into_iter()
        .find_map(|(columns, quantity)| columns.joint(column).map(|_| quantity))
    }

    /// Whether the column is that of one of the joints.
    pub fn is_of(self, column: &str, joints: &[String]) -> bool {
        self.joint(column).is_some_and(|joint| joints.iter().any(|known| known == joint))
    }

    /// The cells of a row, in the order of the joints.
    pub fn row(self, table: &Table, joints: &[String], row: usize) -> Vec<Option<f64>> {
        joints.iter().map(|joint| table.number(&self.name_in(table, joint), row)).collect()
    }
}
