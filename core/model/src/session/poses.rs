//! `poses.csv`: a point of the robot was measured from outside.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::{Quaternion, UnitQuaternion};

use super::error::SessionError;
use super::joint_columns::{ColumnBuilder, JointColumn};
use super::table::{ColumnKind, Table};
use crate::frame::{Frame, Point};
use crate::plausible::{self, Quantity};

/// The fixed frame of an external measuring device; it need not be the robot's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct External;
impl Frame for External {
    const NAME: &'static str = "external";
}

const MEASURED: [&str; 3] = ["meas_x_m", "meas_y_m", "meas_z_m"];
const ORIENTATION: [&str; 4] = ["meas_qw", "meas_qx", "meas_qy", "meas_qz"];
const NUMBERS: [&str; 4] = ["payload_kg", "t_secs", "sigma_m", "ambient_c"];
const TEXTS: [&str; 4] = ["group", "approach", "set", "tip"];
/// The length of a measured quaternion may be rounded by this; further off it is no orientation.
const ROUNDED: f64 = 0.01;
const OF_JOINTS: [JointColumn; 3] = [JointColumn::COMMANDED, JointColumn::ENCODER, JointColumn::TORQUE];
const ANGLES: [JointColumn; 2] = [JointColumn::COMMANDED, JointColumn::ENCODER];

/// What a column of numbers holds.
fn quantity(column: &str) -> Option<Quantity> {
    match column {
        _ if MEASURED.contains(&column) => Some(plausible::EXTERNAL_M),
        "payload_kg" => Some(plausible::PAYLOAD_KG),
        "t_secs" => Some(plausible::TIME_S),
        "sigma_m" => Some(plausible::SIGMA_M),
        "ambient_c" => Some(plausible::TEMPERATURE_C),
        _ => JointColumn::quantity(column),
    }
}

/// One measured pose. `None` means not measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PoseRow {
    /// Commanded joint angles (rad), in the order of the chain's joints.
    pub commanded_rad: Vec<Option<f64>>,
    /// Encoder readings (rad), same order.
    pub encoder_rad: Vec<Option<f64>>,
    /// Measured place of the chain's tip.
    pub measured: Option<Point<External>>,
    /// Measured orientation of the tip's frame: `external_from_tip`.
    pub orientation: Option<UnitQuaternion<f64>>,
    /// Standard deviation of the instrument along each axis, m, where it is known.
    pub sigma_m: Option<f64>,
    /// Frame of the rig that was measured in this row; `None`: the chain's tip.
    pub tip: Option<String>,
    /// Room temperature, °C.
    pub ambient_c: Option<f64>,
    /// Measured joint torques (N·m), in the order of the chain's joints.
    pub torque_nm: Vec<Option<f64>>,
    /// Known mass at the palm, kg; nominally 0.
    pub payload_kg: Option<f64>,
    /// Time since the robot was switched on, s.
    pub t_secs: Option<f64>,
    /// Rows of one group repeat the same command from the same side.
    pub group: Option<String>,
    /// Side from which the pose was approached.
    pub approach: Option<String>,
    /// Label that blocks cross-validation.
    pub set: Option<String>,
}

/// All measured poses of a session.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseTable {
    joints: Vec<String>,
    table: Table,
}

impl PoseTable {
    /// Reads the table of a chain with these joints.
    pub fn read(file: &Path, joints: &[String]) -> Result<Self, SessionError> {
        let mut read = Table::read(file, |name| {
            let of_joint = OF_JOINTS.iter().any(|column| column.is_of(name, joints))
                || ANGLES.iter().any(|column| column.slide().is_of(name, joints));
            if of_joint || MEASURED.contains(&name) || ORIENTATION.contains(&name) || NUMBERS.contains(&name)
            {
                Some(ColumnKind::Number)
            } else {
                TEXTS.contains(&name).then_some(ColumnKind::Text)
            }
        })?;
        for joint in joints {
            let names = [JointColumn::COMMANDED.name(joint), JointColumn::ENCODER.name(joint)];
            let slides = ANGLES.map(|column| column.slide().name(joint));
            if !names.iter().chain(&slides).any(|name| read.table.has(name)) {
                return Err(read.missing(
                    &names.join(" or "),
                    "every joint of the chain in session.toml needs its commanded or encoder angle",
                ));
            }
        }
        for name in MEASURED {
            read.require(name, "add the measured place of the chain's tip")?;
        }
        read.require_whole_points(&MEASURED)?;
        if read.has_any(&ORIENTATION) {
            for name in ORIENTATION {
                read.require(name, "an orientation has four components: w, x, y, z")?;
            }
            read.require_whole_points(&ORIENTATION)?;
        }
        read.set_implausible_aside(quantity)?;
        read.set_other_lengths_aside(&ORIENTATION, ROUNDED)?;
        Ok(Self { joints: joints.to_vec(), table: read.table })
    }

    /// Rows with a number that cannot be, counted from 0, and what is wrong with each; they are given
    /// as rows in which nothing was measured.
    pub fn implausible(&self) -> &BTreeMap<usize, String> {
        self.table.implausible()
    }

    /// A table from rows; columns that no row has are left out, commanded angles only when every
    /// joint has encoder readings.
    pub fn from_rows(joints: Vec<String>, rows: &[PoseRow]) -> Self {
        let mut columns = ColumnBuilder::new(rows);
        columns.text("group", |row| row.group.clone());
        columns.text("approach", |row| row.approach.clone());
        columns.text("set", |row| row.set.clone());
        columns.joints(&joints, JointColumn::COMMANDED, |row| &row.commanded_rad);
        columns.joints(&joints, JointColumn::ENCODER, |row| &row.encoder_rad);
        for (i, name) in MEASURED.into_iter().enumerate() {
            columns.number(name, |row| row.measured.map(|point| point.coords[i]));
        }
        for (i, name) in ORIENTATION.into_iter().enumerate() {
            columns.number(name, |row| row.orientation.map(|turn| [turn.w, turn.i, turn.j, turn.k][i]));
        }
        columns.number("sigma_m", |row| row.sigma_m);
        columns.text("tip", |row| row.tip.clone());
        columns.number("ambient_c", |row| row.ambient_c);
        columns.joints(&joints, JointColumn::TORQUE, |row| &row.torque_nm);
        columns.number("payload_kg", |row| row.payload_kg);
        columns.number("t_secs", |row| row.t_secs);
        let encoders_known = (0..joints.len())
            .all(|i| rows.iter().any(|row| row.encoder_rad.get(i).copied().flatten().is_some()));
        let table = columns.finish(|name| {
            MEASURED.contains(&name) || (!encoders_known && JointColumn::COMMANDED.is_of(name, &joints))
        });
        Self { joints, table }
    }

    /// The same table with other rows: joints that slide keep their columns in meters.
    #[must_use]
    pub fn with_rows(&self, rows: &[PoseRow]) -> Self {
        let mut table = Self::from_rows(self.joints.clone(), rows);
        for joint in self.joints.iter().filter(|joint| self.slides(joint) == Some(true)) {
            for column in ANGLES {
                table.table.rename(&column.name(joint), &column.slide().name(joint));
            }
        }
        table
    }

    /// Whether a joint was logged in meters, as what slides is; `None` where it was not logged at all.
    pub fn slides(&self, joint: &str) -> Option<bool> {
        let has =
            |columns: [JointColumn; 2]| columns.iter().any(|column| self.table.has(&column.name(joint)));
        if has(ANGLES) { Some(false) } else { has(ANGLES.map(JointColumn::slide)).then_some(true) }
    }

    /// Joints of the chain, from base to tip.
    pub fn joints(&self) -> &[String] {
        &self.joints
    }

    /// The columns themselves, those that the format does not define included.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// Number of poses.
    pub fn row_count(&self) -> usize {
        self.table.row_count()
    }

    /// One pose; `None` past the last row.
    pub fn row(&self, row: usize) -> Option<PoseRow> {
        let (table, joints) = (&self.table, &self.joints);
        (row < table.row_count()).then(|| PoseRow {
            commanded_rad: JointColumn::COMMANDED.row(table, joints, row),
            encoder_rad: JointColumn::ENCODER.row(table, joints, row),
            measured: table.tuple(MEASURED, row).map(|[x, y, z]| Point::new(x, y, z)),
            orientation: table
                .tuple(ORIENTATION, row)
                .map(|[w, x, y, z]| UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z))),
            sigma_m: table.number("sigma_m", row),
            tip: table.text("tip", row),
            ambient_c: table.number("ambient_c", row),
            torque_nm: JointColumn::TORQUE.row(table, joints, row),
            payload_kg: table.number("payload_kg", row),
            t_secs: table.number("t_secs", row),
            group: table.text("group", row),
            approach: table.text("approach", row),
            set: table.text("set", row),
        })
    }

    /// All poses in order.
    pub fn rows(&self) -> impl Iterator<Item = PoseRow> + '_ {
        (0..self.row_count()).filter_map(|row| self.row(row))
    }
}
