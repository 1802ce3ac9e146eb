//! `touches.csv`: a fingertip met the touchscreen.

use std::collections::BTreeMap;
use std::path::Path;

use super::error::SessionError;
use super::joint_columns::{ColumnBuilder, JointColumn};
use super::table::{ColumnKind, Table};
use crate::frame::{Point, Robot};
use crate::pixel::{Pixel, PixelSpace};
use crate::plausible::{self, Quantity};

/// The image on the touchscreen. (0, 0) is the center of its top-left pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Screen;
impl PixelSpace for Screen {
    const NAME: &'static str = "touchscreen";
}

const TOUCH: [&str; 2] = ["touch_u_px", "touch_v_px"];
const TARGET: [&str; 3] = ["target_x_m", "target_y_m", "target_z_m"];
const NUMBERS: [&str; 4] = ["screen_height_m", "payload_kg", "move_secs", "t_secs"];
const TEXTS: [&str; 3] = ["group", "approach", "set"];
const OF_JOINTS: [JointColumn; 4] =
    [JointColumn::COMMANDED, JointColumn::ENCODER, JointColumn::TEMPERATURE, JointColumn::LOAD];

/// What a column of numbers holds.
fn quantity(column: &str) -> Option<Quantity> {
    match column {
        _ if TOUCH.contains(&column) => Some(plausible::TOUCH_PX),
        _ if TARGET.contains(&column) => Some(plausible::TARGET_M),
        "screen_height_m" => Some(plausible::BLOCK_HEIGHT_M),
        "payload_kg" => Some(plausible::PAYLOAD_KG),
        "move_secs" => Some(plausible::MOVE_S),
        "t_secs" => Some(plausible::TIME_S),
        _ => JointColumn::quantity(column),
    }
}

/// One touch. `None` means not measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TouchRow {
    /// Commanded joint angles (rad), in the order of the chain's joints.
    pub commanded_rad: Vec<Option<f64>>,
    /// Encoder readings (rad), same order.
    pub encoder_rad: Vec<Option<f64>>,
    /// First contact.
    pub touch: Option<Pixel<Screen>>,
    /// Rows of one group repeat the same command from the same side.
    pub group: Option<String>,
    /// Side from which the pose was approached; `plus` or `minus` when every joint arrived
    /// moving in its positive or negative direction.
    pub approach: Option<String>,
    /// Label that blocks cross-validation.
    pub set: Option<String>,
    /// Height of the block under the touchscreen, m; nominally 0.
    pub screen_height_m: Option<f64>,
    /// Known mass at the palm, kg; nominally 0.
    pub payload_kg: Option<f64>,
    /// Duration of the move, s.
    pub move_secs: Option<f64>,
    /// Time since the robot was switched on, s.
    pub t_secs: Option<f64>,
    /// The point that was sent to inverse kinematics.
    pub target: Option<Point<Robot>>,
    /// Servo temperatures (°C), in the order of the chain's joints.
    pub temperature_c: Vec<Option<f64>>,
    /// Loads as fractions of stall, signed, same order.
    pub load: Vec<Option<f64>>,
}

/// Name of a column that the format does not define, and its value in a row, counted from 0.
pub type ExtraColumn<'a> = (String, &'a dyn Fn(usize) -> Option<f64>);

/// All touches of a session.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchTable {
    joints: Vec<String>,
    table: Table,
}

impl TouchTable {
    /// Reads the table of a chain with these joints.
    pub fn read(file: &Path, joints: &[String]) -> Result<Self, SessionError> {
        let mut read = Table::read(file, |name| {
            let of_joint = OF_JOINTS.iter().any(|column| column.is_of(name, joints));
            if of_joint || [&TOUCH[..], &TARGET, &NUMBERS].iter().any(|names| names.contains(&name)) {
                Some(ColumnKind::Number)
            } else {
                TEXTS.contains(&name).then_some(ColumnKind::Text)
            }
        })?;
        for joint in joints {
            let name = JointColumn::COMMANDED.name(joint);
            read.require(&name, "every joint of the chain in session.toml needs its commanded angle")?;
        }
        for name in TOUCH {
            read.require(name, "add the pixel of the first contact")?;
        }
        read.require_whole_points(&TOUCH)?;
        read.require_whole_points(&TARGET)?;
        read.set_implausible_aside(quantity)?;
        Ok(Self { joints: joints.to_vec(), table: read.table })
    }

    /// Rows with a number that cannot be, counted from 0, and what is wrong with each; they are given
    /// as rows in which nothing was measured.
    pub fn implausible(&self) -> &BTreeMap<usize, String> {
        self.table.implausible()
    }

    /// A table from rows; columns that no row has are left out.
    pub fn from_rows(joints: Vec<String>, rows: &[TouchRow]) -> Self {
        Self::from_rows_with(joints, rows, &[])
    }

    /// The same with columns of numbers that the format does not define: each a name and the value
    /// of a row, counted from 0. The names must differ from each other and from those of the format.
    pub fn from_rows_with(joints: Vec<String>, rows: &[TouchRow], extra: &[ExtraColumn<'_>]) -> Self {
        let mut columns = ColumnBuilder::new(rows);
        columns.text("group", |row| row.group.clone());
        columns.text("approach", |row| row.approach.clone());
        columns.text("set", |row| row.set.clone());
        columns.joints(&joints, JointColumn::COMMANDED, |row| &row.commanded_rad);
        columns.joints(&joints, JointColumn::ENCODER, |row| &row.encoder_rad);
        columns.number(TOUCH[0], |row| row.touch.map(|pixel| pixel.u_px));
        columns.number(TOUCH[1], |row| row.touch.map(|pixel| pixel.v_px));
        for (i, name) in TARGET.into_iter().enumerate() {
            columns.number(name, |row| row.target.map(|point| point.coords[i]));
        }
        columns.number("screen_height_m", |row| row.screen_height_m);
        columns.number("payload_kg", |row| row.payload_kg);
        columns.number("move_secs", |row| row.move_secs);
        columns.number("t_secs", |row| row.t_secs);
        columns.joints(&joints, JointColumn::TEMPERATURE, |row| &row.temperature_c);
        columns.joints(&joints, JointColumn::LOAD, |row| &row.load);
        for (name, value) in extra {
            columns.indexed(name, value);
        }
        let table =
            columns.finish(|name| TOUCH.contains(&name) || JointColumn::COMMANDED.is_of(name, &joints));
        Self { joints, table }
    }

    /// Writes `touches.csv`, or another table of the same columns, in one step.
    ///
    /// # Errors
    /// When the file cannot be written; what was there before is unchanged.
    pub fn write(&self, file: &Path) -> Result<(), SessionError> {
        self.table.write(file)
    }

    /// A column that the format does not define, as numbers: `None` where the cell is empty or holds
    /// no number; `None` altogether if there is no such column.
    pub fn extra_numbers(&self, name: &str) -> Option<Vec<Option<f64>>> {
        if let Some(numbers) = self.table.numbers(name) {
            return Some(numbers.to_vec());
        }
        let number = |text: &Option<String>| text.as_ref().and_then(|text| text.trim().parse().ok());
        Some(self.table.texts(name)?.iter().map(number).collect())
    }

    /// Joints of the chain, from base to tip.
    pub fn joints(&self) -> &[String] {
        &self.joints
    }

    /// The columns themselves, those that the format does not define included.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// Number of touches.
    pub fn row_count(&self) -> usize {
        self.table.row_count()
    }

    /// Commanded angles of one joint (rad), one per row.
    pub fn commanded_rad(&self, joint: &str) -> Option<&[Option<f64>]> {
        self.table.numbers(&JointColumn::COMMANDED.name(joint))
    }

    /// Encoder readings of one joint (rad), one per row; `None` if they were not logged.
    pub fn encoder_rad(&self, joint: &str) -> Option<&[Option<f64>]> {
        self.table.numbers(&JointColumn::ENCODER.name(joint))
    }

    /// One touch; `None` past the last row.
    pub fn row(&self, row: usize) -> Option<TouchRow> {
        let (table, joints) = (&self.table, &self.joints);
        (row < table.row_count()).then(|| TouchRow {
            commanded_rad: JointColumn::COMMANDED.row(table, joints, row),
            encoder_rad: JointColumn::ENCODER.row(table, joints, row),
            touch: table.tuple(TOUCH, row).map(|[u, v]| Pixel::new(u, v)),
            group: table.text("group", row),
            approach: table.text("approach", row),
            set: table.text("set", row),
            screen_height_m: table.number("screen_height_m", row),
            payload_kg: table.number("payload_kg", row),
            move_secs: table.number("move_secs", row),
            t_secs: table.number("t_secs", row),
            target: table.tuple(TARGET, row).map(|[x, y, z]| Point::new(x, y, z)),
            temperature_c: JointColumn::TEMPERATURE.row(table, joints, row),
            load: JointColumn::LOAD.row(table, joints, row),
        })
    }

    /// All touches in order.
    pub fn rows(&self) -> impl Iterator<Item = TouchRow> + '_ {
        (0..self.row_count()).filter_map(|row| self.row(row))
    }
}
