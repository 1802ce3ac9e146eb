//! What became of the touches of a run, as it is kept on disk beside the plan.

use std::collections::BTreeMap;

use jiff::Timestamp;
use plumbline_model::session::{Screen, TouchRow};
use plumbline_model::touch_plan::{Purpose, Side};
use plumbline_model::{Pixel, Point, Robot};
use serde::{Deserialize, Serialize};

use super::plan::Aim;
use crate::robot::TouchMeasurement;

/// Version of the progress file.
pub const FORMAT: u32 = 1;

/// Whether a touch counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Standing {
    /// It stands in `touches.csv`.
    Counts,
    /// The operator rejected it.
    Rejected,
    /// The operator wanted it once more.
    Redone,
}

/// A touch that was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TouchRecord {
    /// Number of the planned touch, from 1.
    pub number: usize,
    /// Whether it counts.
    pub standing: Standing,
    /// First contact.
    pub touched: Pixel<Screen>,
    /// Pixel that was to be touched.
    pub target: Pixel<Screen>,
    /// The point that was sent, robot frame, m: where the tip was commanded at the contact. `None`
    /// when that was not logged: the planned point may lie a centimeter below it.
    pub sent_m: Option<[f64; 3]>,
    /// Label of repeats.
    pub group: String,
    /// Label for blocking.
    pub set: String,
    /// From where the fingertip arrived.
    pub side: Side,
    /// Height of the block under the screen, m.
    pub screen_height_m: f64,
    /// Known mass at the palm, kg.
    pub payload_kg: f64,
    /// Angles commanded at the contact, rad; lists are in the order of the chain's joints.
    pub commanded_rad: Vec<Option<f64>>,
    /// Encoders at the contact, rad.
    pub encoder_rad: Vec<Option<f64>>,
    /// Encoders after the dwell, rad.
    pub later_encoder_rad: Vec<Option<f64>>,
    /// Sign of the last motion of each joint: −1, 0 or 1.
    pub direction: Vec<i8>,
    /// Temperatures, °C.
    pub temperature_c: Vec<Option<f64>>,
    /// Loads as signed shares of the stall torque.
    pub load: Vec<Option<f64>>,
    /// Duration of the lowering, s.
    pub move_secs: Option<f64>,
    /// Seconds since the connection was made.
    pub connected_secs: Option<f64>,
}

impl TouchRecord {
    /// What was measured at a planned touch; `None` when the contact is not a number.
    pub fn new(aim: &Aim, measured: &TouchMeasurement) -> Option<Self> {
        let pixel = measured.pixel;
        if !(pixel.u_px.is_finite() && pixel.v_px.is_finite()) {
            return None;
        }
        // A file holds no number that is none: it is "not measured" there.
        let finite =
            |list: &[Option<f64>]| list.iter().map(|value| value.filter(|v| v.is_finite())).collect();
        let touch = &aim.touch;
        Some(Self {
            number: touch.number,
            standing: Standing::Counts,
            touched: pixel,
            target: touch.target,
            // The screen is met above or beside the planned point: what is learned is where the tip
            // was sent when it met it.
            sent_m: measured
                .commanded_tip
                .map(|tip| tip.coords.coords.into())
                .filter(|sent_m: &[f64; 3]| sent_m.iter().all(|m| m.is_finite())),
            group: touch.group.clone(),
            set: touch.set.clone(),
            side: touch.side,
            screen_height_m: touch.screen_height_m,
            payload_kg: touch.payload_kg,
            commanded_rad: finite(&measured.commanded_rad),
            encoder_rad: finite(&measured.encoder_rad),
            later_encoder_rad: finite(&measured.later_encoder_rad),
            direction: measured.direction.clone(),
            temperature_c: finite(&measured.temperature_c),
            load: finite(&measured.load),
            move_secs: Some(measured.move_secs).filter(|s| s.is_finite()),
            connected_secs: Some(measured.connected_secs).filter(|s| s.is_finite()),
        })
    }

    /// The side, or `plus` / `minus` when every joint arrived moving in that direction.
    pub fn approach(&self) -> &'static str {
        let all = |sign: i8| !self.direction.is_empty() && self.direction.iter().all(|d| *d == sign);
        match (all(1), all(-1)) {
            (true, _) => "plus",
            (_, true) => "minus",
            _ => self.side.name(),
        }
    }

    /// As a row of the session.
    pub fn row(&self) -> TouchRow {
        TouchRow {
            commanded_rad: self.commanded_rad.clone(),
            encoder_rad: self.encoder_rad.clone(),
            touch: Some(self.touched),
            group: Some(self.group.clone()),
            approach: Some(self.approach().to_owned()),
            set: Some(self.set.clone()),
            screen_height_m: Some(self.screen_height_m),
            payload_kg: Some(self.payload_kg),
            move_secs: self.move_secs,
            t_secs: self.connected_secs,
            target: self.sent_m.map(|[x, y, z]| Point::<Robot>::new(x, y, z)),
            temperature_c: self.temperature_c.clone(),
            load: self.load.clone(),
        }
    }
}

/// Why a planned touch is over without a touch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// No contact: why.
    Missed(String),
    /// Left out by the operator.
    Skipped,
}

/// What became of a planned touch.
#[derive(Clone, Debug, PartialEq)]
pub enum Fate {
    /// Still to be done.
    Waiting,
    /// Touched, and counts.
    Touched,
    /// No contact: why.
    Missed(String),
    /// Left out.
    Skipped,
    /// Touched, does not count.
    Rejected,
}

/// Everything that happened in a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Version of the file.
    pub format: u32,
    /// For what.
    pub purpose: Purpose,
    /// When it was begun.
    pub started: Timestamp,
    /// Touches of the plan that can be reached.
    pub planned: usize,
    /// Whether it was finished.
    pub finished: bool,
    /// Height of the block under the screen (m) and mass in the hand (kg) as they are now.
    pub prepared: [f64; 2],
    /// Touches in the order in which they were made.
    pub records: Vec<TouchRecord>,
    /// Planned touches that are over without a touch, by number.
    pub ended: BTreeMap<usize, Ended>,
    /// Numbers that are to be touched once more, at the end.
    pub again: Vec<usize>,
    /// When a place of the screen was found from these touches; such a place does not make them
    /// outdated.
    pub gave_placement: Option<Timestamp>,
}

impl Progress {
    /// Nothing touched yet; the screen as it lies, the hand empty.
    pub fn new(purpose: Purpose, started: Timestamp, planned: usize) -> Self {
        Self {
            format: FORMAT,
            purpose,
            started,
            planned,
            finished: false,
            prepared: [0.0, 0.0],
            records: vec![],
            ended: BTreeMap::new(),
            again: vec![],
            gave_placement: None,
        }
    }

    /// Touches that count, in the order in which they were made.
    pub fn counted(&self) -> impl Iterator<Item = &TouchRecord> {
        self.records.iter().filter(|record| record.standing == Standing::Counts)
    }

    /// The touch of this number that counts.
    pub fn counted_of(&self, number: usize) -> Option<&TouchRecord> {
        self.counted().find(|record| record.number == number)
    }

    /// What became of a planned touch.
    pub fn fate(&self, number: usize) -> Fate {
        if self.again.contains(&number) {
            return Fate::Waiting;
        }
        if self.counted_of(number).is_some() {
            return Fate::Touched;
        }
        match self.ended.get(&number) {
            Some(Ended::Missed(why)) => return Fate::Missed(why.clone()),
            Some(Ended::Skipped) => return Fate::Skipped,
            None => {}
        }
        let made = self.records.iter().any(|record| record.number == number);
        if made { Fate::Rejected } else { Fate::Waiting }
    }

    /// A touch was made.
    pub fn touched(&mut self, record: TouchRecord) {
        let number = record.number;
        self.put_aside(number, Standing::Redone);
        self.leave(number);
        self.records.push(record);
    }

    /// A planned touch is over without a touch.
    pub fn end(&mut self, number: usize, how: Ended) {
        self.leave(number);
        self.ended.insert(number, how);
    }

    /// To be touched once more at the end; the touch that was made does not count any more.
    pub fn redo(&mut self, number: usize) {
        self.put_aside(number, Standing::Redone);
        self.leave(number);
        self.again.push(number);
        self.finished = false;
    }

    /// The touch of this number does not count any more; whether there was one.
    pub fn reject(&mut self, number: usize) -> bool {
        let found = self.put_aside(number, Standing::Rejected);
        if found {
            self.leave(number);
        }
        found
    }

    /// The newest touch of this number counts again; whether there was one.
    pub fn restore(&mut self, number: usize) -> bool {
        if self.counted_of(number).is_some() {
            return false;
        }
        let Some(record) = self.records.iter_mut().rev().find(|record| record.number == number) else {
            return false;
        };
        record.standing = Standing::Counts;
        self.leave(number);
        true
    }

    fn put_aside(&mut self, number: usize, standing: Standing) -> bool {
        let mut found = false;
        for record in &mut self.records {
            if record.number == number && record.standing == Standing::Counts {
                record.standing = standing;
                found = true;
            }
        }
        found
    }

    fn leave(&mut self, number: usize) {
        self.ended.remove(&number);
        self.again.retain(|waiting| *waiting != number);
    }
}
