//! `localizations.csv`: stereo vision located something whose place is known.

use std::collections::BTreeMap;
use std::path::Path;

use super::error::SessionError;
use super::joint_columns::{ColumnBuilder, JointColumn};
use super::table::{ColumnKind, Table};
use crate::frame::{Point, Robot};
use crate::pixel::{Pixel, Raw};
use crate::plausible::{self, Quantity};

const TRUE: [&str; 3] = ["true_x_m", "true_y_m", "true_z_m"];
const ESTIMATE: [&str; 3] = ["est_x_m", "est_y_m", "est_z_m"];
const LEFT: [&str; 2] = ["left_u_px", "left_v_px"];
const RIGHT: [&str; 2] = ["right_u_px", "right_v_px"];
const NUMBERS: [&str; 2] = ["t_secs", "background_m"];
const TEXTS: [&str; 3] = ["object", "group", "set"];

/// What a column of numbers holds.
fn quantity(column: &str) -> Option<Quantity> {
    match column {
        _ if TRUE.contains(&column) => Some(plausible::PLACE_M),
        _ if ESTIMATE.contains(&column) => Some(plausible::ESTIMATE_M),
        _ if LEFT.contains(&column) || RIGHT.contains(&column) => Some(plausible::IMAGE_PX),
        "background_m" => Some(plausible::BACKGROUND_M),
        "t_secs" => Some(plausible::TIME_S),
        _ => JointColumn::quantity(column),
    }
}

/// One localization. `None` means not measured.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalizationRow {
    /// The known place.
    pub truth: Option<Point<Robot>>,
    /// The stereo estimate, through the rig's nominal head chain and eye mounts.
    pub estimate: Option<Point<Robot>>,
    /// Matched point in the left image.
    pub left: Option<Pixel<Raw>>,
    /// Matched point in the right image.
    pub right: Option<Pixel<Raw>>,
    /// Head joint angles (rad), in the order of [`LocalizationTable::head_joints`]; the rig's
    /// default where `None`.
    pub head_rad: Vec<Option<f64>>,
    /// Time since the cameras were switched on, s.
    pub t_secs: Option<f64>,
    /// What was seen.
    pub object: Option<String>,
    /// Distance of what lies behind it, m.
    pub background_m: Option<f64>,
    /// Rows of one group repeat the same measurement.
    pub group: Option<String>,
    /// Label that blocks cross-validation.
    pub set: Option<String>,
    /// False: the estimate is known to have failed; reported, never fitted.
    pub valid: bool,
}

impl Default for LocalizationRow {
    fn default() -> Self {
        Self {
            truth: None,
            estimate: None,
            left: None,
            right: None,
            head_rad: Vec::new(),
            t_secs: None,
            object: None,
            background_m: None,
            group: None,
            set: None,
            valid: true,
        }
    }
}

/// All localizations of a session.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalizationTable {
    head_joints: Vec<String>,
    table: Table,
}

impl LocalizationTable {
    /// Reads the table; head joints are those that have a column.
    pub fn read(file: &Path) -> Result<Self, SessionError> {
        let mut read = Table::read(file, |name| {
            let number = JointColumn::HEAD.joint(name).is_some()
                || [&TRUE[..], &ESTIMATE, &LEFT, &RIGHT, &NUMBERS].iter().any(|names| names.contains(&name));
            if number {
                Some(ColumnKind::Number)
            } else if name == "valid" {
                Some(ColumnKind::Flag)
            } else {
                TEXTS.contains(&name).then_some(ColumnKind::Text)
            }
        })?;
        for name in TRUE {
            read.require(name, "add the known place in the robot frame")?;
        }
        let pixels = [LEFT, RIGHT].concat();
        for names in [&ESTIMATE[..], &pixels] {
            if read.has_any(names) {
                for name in names {
                    read.require(name, "a point needs all of its coordinates")?;
                }
            }
        }
        if !read.has_any(&ESTIMATE) && !read.has_any(&pixels) {
            return Err(read.missing(
                "est_x_m (or left_u_px)",
                "add what vision measured: est_x_m, est_y_m, est_z_m, or left_u_px, left_v_px, right_u_px, right_v_px",
            ));
        }
        for names in [&TRUE[..], &ESTIMATE, &LEFT, &RIGHT] {
            read.require_whole_points(names)?;
        }
        read.set_implausible_aside(quantity)?;
        let head_joints = read
            .table
            .columns()
            .iter()
            .filter_map(|column| JointColumn::HEAD.joint(&column.name).map(str::to_owned))
            .collect();
        Ok(Self { head_joints, table: read.table })
    }

    /// Rows with a number that cannot be, counted from 0, and what is wrong with each; they are given
    /// as rows in which nothing was measured.
    pub fn implausible(&self) -> &BTreeMap<usize, String> {
        self.table.implausible()
    }

    /// A table from rows; columns that no row has are left out, and the estimate is kept as
    /// empty columns when no row has image points either.
    pub fn from_rows(head_joints: Vec<String>, rows: &[LocalizationRow]) -> Self {
        let mut columns = ColumnBuilder::new(rows);
        for (i, name) in TRUE.into_iter().enumerate() {
            columns.number(name, |row| row.truth.map(|point| point.coords[i]));
        }
        for (i, name) in ESTIMATE.into_iter().enumerate() {
            columns.number(name, |row| row.estimate.map(|point| point.coords[i]));
        }
        columns.number(LEFT[0], |row| row.left.map(|pixel| pixel.u_px));
        columns.number(LEFT[1], |row| row.left.map(|pixel| pixel.v_px));
        columns.number(RIGHT[0], |row| row.right.map(|pixel| pixel.u_px));
        columns.number(RIGHT[1], |row| row.right.map(|pixel| pixel.v_px));
        columns.joints(&head_joints, JointColumn::HEAD, |row| &row.head_rad);
        columns.number("t_secs", |row| row.t_secs);
        columns.text("object", |row| row.object.clone());
        columns.number("background_m", |row| row.background_m);
        columns.text("group", |row| row.group.clone());
        columns.text("set", |row| row.set.clone());
        columns.flag("valid", |row| Some(row.valid));
        let seen_by = |left: bool| rows.iter().any(|row| if left { row.left } else { row.right }.is_some());
        let pixels = seen_by(true) || seen_by(false);
        let table = columns.finish(|name| {
            TRUE.contains(&name)
                || JointColumn::HEAD.is_of(name, &head_joints)
                || (if pixels {
                    LEFT.contains(&name) || RIGHT.contains(&name)
                } else {
                    ESTIMATE.contains(&name)
                })
        });
        Self { head_joints, table }
    }

    /// Joints of the head whose angles were logged.
    pub fn head_joints(&self) -> &[String] {
        &self.head_joints
    }

    /// The columns themselves, those that the format does not define included.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// Number of localizations.
    pub fn row_count(&self) -> usize {
        self.table.row_count()
    }

    /// One localization; `None` past the last row.
    pub fn row(&self, row: usize) -> Option<LocalizationRow> {
        let table = &self.table;
        let point = |names| table.tuple(names, row).map(|[x, y, z]| Point::new(x, y, z));
        let pixel = |names| table.tuple(names, row).map(|[u, v]| Pixel::new(u, v));
        let flag = || table.flags("valid")?.get(row).copied().flatten();
        (row < table.row_count()).then(|| LocalizationRow {
            truth: point(TRUE),
            estimate: point(ESTIMATE),
            left: pixel(LEFT),
            right: pixel(RIGHT),
            head_rad: JointColumn::HEAD.row(table, &self.head_joints, row),
            t_secs: table.number("t_secs", row),
            object: table.text("object", row),
            background_m: table.number("background_m", row),
            group: table.text("group", row),
            set: table.text("set", row),
            valid: flag().unwrap_or(true),
        })
    }

    /// All localizations in order.
    pub fn rows(&self) -> impl Iterator<Item = LocalizationRow> + '_ {
        (0..self.row_count()).filter_map(|row| self.row(row))
    }
}
