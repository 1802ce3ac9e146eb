//! From sessions to rows.

use std::collections::{BTreeMap, HashMap};

use nalgebra::Point3;
use plumbline_model::Session;
use plumbline_model::robot::servo::TICK_RAD;
use plumbline_model::robot::{DescriptionError, Rig, RigPart};
use plumbline_model::session::{EncoderSide, LocalizationRow, PoseRow, PoseTable, TouchRow, TouchTable};

use super::derive;
use super::{Apparatus, LeftOut, Marker, Measurements, MeasurementsError, Observation, What};
use crate::arm::{Arm, Part};
use crate::eyes::Eyes;
use crate::library::Surface;

impl Measurements {
    /// The rows of sessions of one robot; each with its name for people.
    ///
    /// # Errors
    /// When the sessions are of different robots, do not fit to the rig, or no row is usable.
    pub fn of_sessions(sessions: &[(String, Session)], rig: &Rig) -> Result<Self, MeasurementsError> {
        if sessions.is_empty() {
            return Err(MeasurementsError::NoSession);
        }
        same_tip(sessions)?;
        let mut reader =
            Reader { rig, rows: vec![], left_out: vec![], apparatuses: vec![], cells: HashMap::new() };
        for (i, (title, session)) in sessions.iter().enumerate() {
            reader.session(i, title, session)?;
        }
        if reader.rows.is_empty() {
            let rows = reader.left_out.len();
            let why =
                reader.left_out.first().map_or_else(|| "there is none".to_owned(), |out| out.why.clone());
            return Err(MeasurementsError::NothingUsable { rows, why });
        }
        derive::complete(&mut reader.rows, &reader.apparatuses);
        Ok(Self {
            rig: rig.name.clone(),
            apparatuses: reader.apparatuses,
            rows: reader.rows,
            left_out: reader.left_out,
            present: vec![],
        })
    }
}

/// A joint that slides is logged in meters, one that turns in radians.
fn units_of_columns(title: &str, arm: &Arm, table: &PoseTable) -> Result<(), MeasurementsError> {
    let in_other = |part: &&Part| table.slides(&part.joint).is_some_and(|slides| slides != part.slides);
    match arm.parts.iter().find(in_other) {
        None => Ok(()),
        Some(part) => Err(MeasurementsError::OtherMotion {
            session: title.to_owned(),
            joint: part.joint.clone(),
            moves: if part.slides { "slides" } else { "turns" },
            column: part.column("cmd"),
        }),
    }
}

fn same_tip(sessions: &[(String, Session)]) -> Result<(), MeasurementsError> {
    let mut tips = sessions.iter().filter_map(|(_, session)| Some(&session.manifest.chain.as_ref()?.tip));
    let Some(first) = tips.next() else { return Ok(()) };
    match tips.find(|tip| *tip != first) {
        None => Ok(()),
        Some(other) => Err(MeasurementsError::DifferentTips { first: first.clone(), other: other.clone() }),
    }
}

struct Reader<'a> {
    rig: &'a Rig,
    rows: Vec<Observation>,
    left_out: Vec<LeftOut>,
    apparatuses: Vec<Apparatus>,
    /// Number of each cell by what makes it.
    cells: HashMap<String, usize>,
}

/// Refuses a row with a number that cannot be.
fn can_be(implausible: &BTreeMap<usize, String>, row: usize) -> Result<(), String> {
    implausible.get(&row).map_or(Ok(()), |what| Err(format!("{what} (this row only)")))
}

/// The arm of a session and where its joints are in the session's columns.
struct Columns {
    order: Vec<usize>,
}

impl Columns {
    fn of(&self, logged: &[Option<f64>]) -> Option<Vec<f64>> {
        self.order.iter().map(|place| logged.get(*place).copied().flatten()).collect()
    }

    /// Columns `dir_<joint>` of the arm's joints, which runs of touches write beside the format's: 1 or −1, as the
    /// joint moved last.
    fn signs(&self, table: &TouchTable) -> Option<Vec<Vec<Option<f64>>>> {
        let of_joint = |place: &usize| table.extra_numbers(&format!("dir_{}", table.joints().get(*place)?));
        self.order.iter().map(of_joint).collect()
    }
}

/// What was logged of the joints' last motions is surer than what friction tells of them.
fn with_signs(touch: Observation, signs: Option<&[Vec<Option<f64>>]>) -> Observation {
    let of_row = |column: &Vec<Option<f64>>| {
        column.get(touch.row).copied().flatten().filter(|sign| [-1.0, 0.0, 1.0].contains(sign))
    };
    let direction: Option<Vec<f64>> = signs.and_then(|signs| signs.iter().map(of_row).collect());
    match direction {
        Some(direction) => Observation { direction, ..touch },
        None => touch,
    }
}

impl Reader<'_> {
    fn session(&mut self, number: usize, title: &str, session: &Session) -> Result<(), MeasurementsError> {
        let missing = |section| MeasurementsError::Missing { session: title.to_owned(), section };
        let misfit = |error| MeasurementsError::Rig { session: title.to_owned(), error };
        let moved = session.touches.is_some() || session.poses.is_some();
        let setup = session.manifest.pose_setup();
        let mut apparatus = Apparatus {
            title: title.to_owned(),
            tip_is_unknown: setup.tip_is_unknown,
            external_frame: setup.external_frame,
            ..Apparatus::default()
        };
        let mut columns = Columns { order: vec![] };
        if moved {
            let chain = session.manifest.chain.as_ref().ok_or_else(|| missing("chain"))?;
            let arm = Arm::logged(self.rig, &chain.tip, &chain.joints).map_err(misfit)?;
            if let Some(table) = &session.poses {
                units_of_columns(title, &arm, table)?;
            }
            let place = |joint: &String| {
                let not_logged = || MeasurementsError::NotLogged {
                    session: title.to_owned(),
                    joint: joint.clone(),
                    tip: chain.tip.clone(),
                };
                chain.joints.iter().position(|name| name == joint).ok_or_else(not_logged)
            };
            if let Some((joint, kind)) =
                chain.joints.iter().find_map(|name| Some((name, self.rig.description.unmoved_kind(name)?)))
            {
                let (joint, kind) = (joint.clone(), kind.to_owned());
                return Err(misfit(DescriptionError::Kind { joint, kind }));
            }
            columns.order = arm.parts.iter().map(|part| place(&part.joint)).collect::<Result<_, _>>()?;
            apparatus.arm = Some(arm);
            apparatus.tip = Some(chain.tip.clone());
        }
        if session.touches.is_some() {
            let screen = session.manifest.touchscreen.as_ref().ok_or_else(|| missing("touchscreen"))?;
            apparatus.surface = Some(Surface::of(screen));
        }
        if session.localizations.is_some() {
            let lacks =
                |error| MeasurementsError::Lacks { session: title.to_owned(), error: Box::new(error) };
            self.rig.need(RigPart::Eyes).map_err(lacks)?;
            apparatus.eyes = Some(Eyes::of_rig(self.rig).map_err(misfit)?);
        }
        self.apparatuses.push(apparatus);
        let first = self.rows.len();
        if let Some(table) = &session.touches {
            let signs = columns.signs(table);
            for (i, row) in table.rows().enumerate() {
                let read = can_be(table.implausible(), i)
                    .and_then(|()| self.touch(number, i, &row, &columns, session))
                    .map(|touch| with_signs(touch, signs.as_deref()));
                self.take(number, What::Touch, i, read);
            }
        }
        if let Some(table) = &session.poses {
            for (i, row) in table.rows().enumerate() {
                let read = can_be(table.implausible(), i).and_then(|()| self.pose(number, i, &row, &columns));
                self.take(number, What::Pose, i, read);
            }
        }
        if let Some(table) = &session.localizations {
            let head = table.head_joints().to_vec();
            for (i, row) in table.rows().enumerate() {
                let read =
                    can_be(table.implausible(), i).and_then(|()| self.localization(number, i, &row, &head));
                self.take(number, What::Place, i, read);
            }
        }
        if setup.encoders == EncoderSide::Joint {
            self.rows[first..].iter_mut().for_each(|row| row.encoder_behind_gear = true);
        }
        Ok(())
    }

    fn take(&mut self, session: usize, what: What, row: usize, read: Result<Observation, String>) {
        match read {
            Ok(observation) => self.rows.push(observation),
            Err(why) => {
                self.left_out.push(LeftOut { session, table: what.table().to_owned(), row, why });
            }
        }
    }

    fn cell(&mut self, key: String) -> usize {
        let next = self.cells.len();
        *self.cells.entry(key).or_insert(next)
    }

    fn touch(
        &mut self,
        session: usize,
        row: usize,
        touch: &TouchRow,
        columns: &Columns,
        of: &Session,
    ) -> Result<Observation, String> {
        let screen = of.manifest.touchscreen.as_ref().ok_or("no touchscreen")?;
        let pixel = touch.touch.ok_or("no pixel was touched")?;
        // A panel errs near its border, but not by its own size.
        let beside = |at_px: f64, count: u32| {
            let count = f64::from(count);
            !(-count..=2.0 * count).contains(&at_px)
        };
        if beside(pixel.u_px, screen.width_px) || beside(pixel.v_px, screen.height_px) {
            return Err(format!(
                "the touch lies far beside the screen of {} × {} px",
                screen.width_px, screen.height_px
            ));
        }
        let commanded_rad = columns.of(&touch.commanded_rad);
        let encoder_rad = columns.of(&touch.encoder_rad);
        let angles = encoder_rad.as_ref().or(commanded_rad.as_ref()).ok_or("an angle is missing")?;
        let joints = angles.len();
        let [u_m, v_m] = screen.pitch_m();
        let middle = screen.middle();
        let measured = vec![(pixel.u_px - middle.u_px) * u_m, (pixel.v_px - middle.v_px) * v_m, 0.0];
        let (height, payload) = (touch.screen_height_m.unwrap_or(0.0), touch.payload_kg.unwrap_or(0.0));
        let cell = self.cell(cell_key(
            session,
            touch.group.as_deref(),
            commanded_rad.as_deref(),
            touch.approach.as_deref(),
            &[height, payload],
            ("touch", row),
        ));
        Ok(Observation {
            session,
            row,
            what: What::Touch,
            measured,
            direction: direction(
                touch.approach.as_deref(),
                joints,
                commanded_rad.as_deref(),
                encoder_rad.as_deref(),
            ),
            payload_kg: payload,
            screen_height_m: height,
            t_secs: touch.t_secs,
            move_secs: touch.move_secs,
            temperature_c: columns.of(&touch.temperature_c),
            cell,
            set: touch.set.clone(),
            approach: touch.approach.clone(),
            commanded_rad,
            encoder_rad,
            ..Observation::imagined(What::Touch)
        })
    }

    fn pose(
        &mut self,
        session: usize,
        row: usize,
        pose: &PoseRow,
        columns: &Columns,
    ) -> Result<Observation, String> {
        let measured = pose.measured.ok_or("no place was measured")?;
        let commanded_rad = columns.of(&pose.commanded_rad);
        let encoder_rad = columns.of(&pose.encoder_rad);
        let angles = encoder_rad.as_ref().or(commanded_rad.as_ref()).ok_or("an angle is missing")?;
        let joints = angles.len();
        let payload = pose.payload_kg.unwrap_or(0.0);
        let marker = self.marker(session, pose.tip.as_deref())?;
        let mut cell = |marker: usize| {
            self.cell(cell_key(
                session,
                pose.group.as_deref(),
                commanded_rad.as_deref(),
                pose.approach.as_deref(),
                &[payload, marker as f64],
                ("pose", row),
            ))
        };
        // Markers of one pose are no repeats of each other, but are held out together.
        let (whole, cell) = (cell(0), cell(marker));
        let mut at: Vec<f64> = measured.coords.iter().copied().collect();
        let what = if pose.orientation.is_some() { What::OrientedPose } else { What::Pose };
        at.resize(what.len(), 0.0);
        Ok(Observation {
            session,
            row,
            measured: at,
            direction: direction(
                pose.approach.as_deref(),
                joints,
                commanded_rad.as_deref(),
                encoder_rad.as_deref(),
            ),
            payload_kg: payload,
            t_secs: pose.t_secs,
            torque_nm: columns.of(&pose.torque_nm),
            cell,
            pose: Some(whole),
            set: pose.set.clone(),
            approach: pose.approach.clone(),
            commanded_rad,
            encoder_rad,
            orientation: pose.orientation,
            sigma_m: pose.sigma_m,
            marker,
            ambient_c: pose.ambient_c,
            ..Observation::imagined(what)
        })
    }

    /// The number of what a row measured; the arm up to it is looked up once.
    fn marker(&mut self, session: usize, tip: Option<&str>) -> Result<usize, String> {
        let apparatus = &mut self.apparatuses[session];
        let Some(name) = tip.filter(|name| apparatus.tip.as_deref() != Some(name)) else { return Ok(0) };
        if let Some(known) = apparatus.markers.iter().position(|marker| marker.name == name) {
            return Ok(known + 1);
        }
        let whole = apparatus.arm.as_ref().ok_or("no arm")?;
        let slides = whole.parts.iter().filter(|part| part.slides).map(|part| part.joint.clone());
        let slides: Vec<String> = slides.collect();
        let arm = Arm::logged(self.rig, name, &slides).map_err(|error| error.to_string())?;
        let mut joints = arm.parts.iter().zip(&whole.parts);
        if arm.len() > whole.len() || joints.any(|(own, of_whole)| own.joint != of_whole.joint) {
            return Err(format!(
                "{name} does not hang on the joints of the chain: measure it in a session of its own"
            ));
        }
        apparatus.markers.push(Marker { name: name.to_owned(), arm });
        Ok(apparatus.markers.len())
    }

    fn localization(
        &mut self,
        session: usize,
        row: usize,
        seen: &LocalizationRow,
        head: &[String],
    ) -> Result<Observation, String> {
        if !seen.valid {
            return Err("marked as failed".to_owned());
        }
        let eyes = self.apparatuses[session].eyes.as_ref().ok_or("no eyes")?;
        let truth_m = seen.truth.ok_or("the known place is missing")?.coords;
        let home = self.rig.home();
        let neck_rad: Vec<f64> = eyes
            .neck
            .parts
            .iter()
            .map(|part| {
                let logged = head.iter().position(|name| *name == part.joint);
                let logged = logged.and_then(|place| seen.head_rad.get(place).copied().flatten());
                logged.or(part.index.map(|index| home[index])).unwrap_or_default()
            })
            .collect();
        let (what, measured) = match (seen.left, seen.right, seen.estimate) {
            (Some(left), Some(right), _) => {
                (What::EyePoints, vec![left.u_px, left.v_px, right.u_px, right.v_px])
            }
            (_, _, Some(estimate)) => {
                let nominal = crate::eyes::EyesDeviation::none(neck_rad.len());
                let in_left: Point3<f64> =
                    eyes.robot_from_left(&neck_rad, &nominal).inverse() * estimate.coords;
                if in_left.z <= 0.0 {
                    return Err("the estimate lies behind the eyes".to_owned());
                }
                (What::Place, eyes.natural(&in_left).to_vec())
            }
            _ => return Err("the eyes found nothing".to_owned()),
        };
        let key = seen
            .group
            .as_ref()
            .map_or_else(|| format!("{session} eyes {row}"), |g| format!("{session} eyes {g:?}"));
        let cell = self.cell(key);
        Ok(Observation {
            session,
            row,
            what,
            measured,
            t_secs: seen.t_secs,
            neck_rad,
            truth_m: Some(truth_m),
            background_m: seen.background_m,
            object: seen.object.clone(),
            cell,
            set: seen.set.clone(),
            ..Observation::imagined(what)
        })
    }
}

/// What makes a cell: the label of its group, else the same command to a tenth of an encoder step
/// under the same conditions, else the row by itself.
fn cell_key(
    session: usize,
    group: Option<&str>,
    commanded_rad: Option<&[f64]>,
    approach: Option<&str>,
    conditions: &[f64],
    (table, row): (&str, usize),
) -> String {
    let conditions: Vec<i64> = conditions.iter().map(|value| (value * 1e6).round() as i64).collect();
    if let Some(group) = group {
        return format!("{session} {table} {group:?} {approach:?} {conditions:?}");
    }
    match commanded_rad {
        Some(angles) => {
            let command: Vec<i64> = angles.iter().map(|angle| (angle / 1.5e-4).round() as i64).collect();
            format!("{session} {table} {command:?} {approach:?} {conditions:?}")
        }
        None => format!("{session} {table} row {row}"),
    }
}

/// A joint that stands nearer than this to where it was sent tells nothing of how it came there:
/// half a step of an encoder, rad.
const STANDS_RAD: f64 = 0.5 * TICK_RAD;

/// Last motion of each joint. `plus` and `minus` say that every joint arrived moving so. Without
/// such a label friction tells it, where command and encoder were logged: a joint stops short of
/// its goal on the side from which it came.
fn direction(
    approach: Option<&str>,
    joints: usize,
    commanded_rad: Option<&[f64]>,
    encoder_rad: Option<&[f64]>,
) -> Vec<f64> {
    match (approach, commanded_rad, encoder_rad) {
        (Some("plus"), ..) => vec![1.0; joints],
        (Some("minus"), ..) => vec![-1.0; joints],
        (_, Some(commanded), Some(encoder)) => commanded
            .iter()
            .zip(encoder)
            .map(|(goal, at)| if (goal - at).abs() > STANDS_RAD { (goal - at).signum() } else { 0.0 })
            .collect(),
        _ => vec![0.0; joints],
    }
}
