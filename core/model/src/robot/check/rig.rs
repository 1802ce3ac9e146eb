//! All that is wrong with a rig file.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};

use super::description::{self, Checked};
use super::keys::{FILE, Keys};
use super::names::tables;
use super::{Problem, Problems};
use crate::formats::depth;
use crate::robot::description::{Description, Limits};
use crate::robot::error::RigError;
use crate::robot::outlines::OutlinesPart;
use crate::robot::rig_file::{
    ArmPart, BoardPart, BusPart, CoupledPart, EyesPart, FORMAT, GatePart, PosePart, Reader, ScreenPart,
    ServoPart, TablePart, WorkspacePart,
};

/// Checks the text of a rig file, and the description that it names.
pub(super) fn check(
    file: &str,
    text: &str,
    description: impl FnOnce(&str) -> Result<String, String>,
) -> Vec<Problem> {
    let mut problems = Problems::new(file, text);
    if let Err(reason) = depth::check(depth::of_toml(text)) {
        problems.add(None, reason, "write it flatter, as the rig file that comes with the program is");
        return problems.found;
    }
    let (table, errors) = DeTable::parse_recoverable(text);
    for error in &errors {
        let at = error.span().map_or(0, |span| span.start);
        problems.at(at, format!("this is not TOML: {}", error.message()), "correct the line");
    }
    if !errors.is_empty() {
        // What else seems wrong may come from that.
        return problems.found;
    }
    let mut checker = Checker { problems, whole: BTreeSet::new() };
    let mut value = Spanned::new(table.span(), DeValue::Table(table.into_inner()));
    checker.keys(&FILE, &mut value, "the file");
    let found = checker.sections(&value, description);
    let mut problems = checker.problems.found;
    problems.sort_by_key(|problem| problem.line.unwrap_or(0));
    problems.extend(found);
    problems
}

pub(super) struct Checker<'a> {
    pub(super) problems: Problems<'a>,
    /// Where tables begin in which no key is missing.
    whole: BTreeSet<usize>,
}

/// A value of the file with what it was read as.
type Read<T> = (Range<usize>, T);

impl Checker<'_> {
    /// Unknown and missing keys of a table and of the tables inside of it; unknown ones are taken out.
    fn keys(&mut self, keys: &Keys, value: &mut Spanned<DeValue<'_>>, place: &str) {
        let begin = value.span().start;
        let DeValue::Table(table) = value.get_mut() else { return };
        let unknown: Vec<_> = table.keys().filter(|key| !keys.know(key.get_ref())).cloned().collect();
        for key in unknown {
            let fix = format!("take it out, or correct its name: {place} has {}", keys.list());
            self.problems.at(key.span().start, format!("unknown key {} in {place}", key.get_ref()), fix);
            table.remove(&key);
        }
        let has = |name: &str| table.keys().any(|key| key.get_ref() == name);
        let missing: Vec<&str> = keys.required.iter().copied().filter(|key| !has(key)).collect();
        for key in &missing {
            let what = format!("{place} has no {key}");
            let fix = format!("add {key} = …, as in the rig file that comes with the program");
            self.lacks(keys, begin, &what, &fix);
        }
        if missing.is_empty() {
            self.whole.insert(begin);
        }
        for inside in keys.inside {
            let Some((key, value)) = table.iter_mut().find(|(key, _)| key.get_ref() == inside.name) else {
                if inside.needed {
                    let what = format!("{place} has no [{}]: {}", within(place, inside.name), inside.purpose);
                    let required = inside.required.join(", ");
                    let fix =
                        format!("add it with {required}, as in the rig file that comes with the program");
                    self.lacks(keys, begin, &what, &fix);
                    self.whole.remove(&begin);
                }
                continue;
            };
            let (start, name) = (key.span().start, inside.name);
            let deeper = within(place, name);
            match value.get_mut() {
                DeValue::Table(_) => self.inner(inside, value, &format!("[{deeper}]"), begin),
                DeValue::Array(list) => {
                    for (number, value) in list.iter_mut().enumerate() {
                        self.inner(inside, value, &format!("{deeper} {}", number + 1), begin);
                    }
                }
                _ => {
                    let fix = format!("write it as a section [{name}]");
                    self.problems.at(start, format!("{deeper} is no section"), fix);
                    self.whole.remove(&begin);
                }
            }
        }
    }

    /// Something that a table does not have: it is told where the table begins; what the file as a whole
    /// lacks stands nowhere.
    fn lacks(&mut self, keys: &Keys, begin: usize, what: &str, fix: &str) {
        if keys.name == FILE.name {
            self.problems.add(None, what, fix);
        } else {
            self.problems.at(begin, what, fix);
        }
    }

    /// A table inside of one that begins at `outer`, which is whole only if this one is.
    fn inner(&mut self, keys: &Keys, value: &mut Spanned<DeValue<'_>>, place: &str, outer: usize) {
        let begin = value.span().start;
        self.keys(keys, value, place);
        if !self.whole.contains(&begin) {
            self.whole.remove(&outer);
        }
    }

    /// What a section is, unless keys of it are missing or values of it are of another kind.
    fn read<T: DeserializeOwned>(&mut self, value: &Spanned<DeValue<'_>>, place: &str) -> Option<Read<T>> {
        let span = value.span();
        if value.get_ref().is_table() && !self.whole.contains(&span.start) {
            return None;
        }
        match T::deserialize(ValueDeserializer::from(value.clone())) {
            Ok(part) => Some((span, part)),
            Err(error) => {
                let at = error.span().map_or(span.start, |span| span.start);
                let fix = "write it as in the rig file that comes with the program";
                self.problems.at(at, format!("{place}: {}", error.message()), fix);
                None
            }
        }
    }

    /// The one section of a name.
    fn one<T: DeserializeOwned>(&mut self, table: &DeTable<'_>, name: &str) -> Option<Read<T>> {
        let (_, value) = table.iter().find(|(key, _)| key.get_ref() == name)?;
        self.read(value, name)
    }

    /// All sections of a name.
    fn all<T: DeserializeOwned>(&mut self, table: &DeTable<'_>, name: &str) -> Vec<Read<T>> {
        let Some((_, value)) = table.iter().find(|(key, _)| key.get_ref() == name) else { return vec![] };
        let DeValue::Array(list) = value.get_ref() else {
            let fix = format!("write it as [[{name}]]: there may be several");
            self.problems.at(value.span().start, format!("{name} is no list of sections"), fix);
            return vec![];
        };
        list.iter()
            .enumerate()
            .filter_map(|(i, value)| self.read(value, &format!("{name} {}", i + 1)))
            .collect()
    }

    /// What the sections say, and what is wrong with the description that they speak of.
    fn sections(
        &mut self,
        value: &Spanned<DeValue<'_>>,
        description: impl FnOnce(&str) -> Result<String, String>,
    ) -> Vec<Problem> {
        let DeValue::Table(table) = value.get_ref() else { return vec![] };
        if let Some((span, format)) = self.one::<i64>(table, "format")
            && format != i64::from(FORMAT)
        {
            let fix = format!("write format = {FORMAT}, and the keys of that format");
            self.problems.at(span.start, format!("format {format} is not known"), fix);
        }
        let _: [Option<Read<String>>; 2] = ["name", "title"].map(|key| self.one(table, key));
        let named: Option<Read<String>> = self.one(table, "description");
        let text = named.as_ref().map(|(span, name)| (span.clone(), name, description(name)));
        let checked = match text {
            Some((_, name, Ok(text))) => Some(description::check(name, &text)),
            Some((span, name, Err(reason))) => {
                let fix =
                    "put the URDF of the robot beside the rig file under that name, or correct the name";
                self.problems.at(span.start, format!("its description {name} cannot be read: {reason}"), fix);
                None
            }
            None => None,
        };
        self.parts(table, checked.as_ref());
        checked.map(|checked| checked.problems).unwrap_or_default()
    }

    fn parts(&mut self, table: &DeTable<'_>, checked: Option<&Checked>) {
        let _: Option<Read<BusPart>> = self.one(table, "bus");
        let servos: Vec<Read<ServoPart>> = self.all(table, "servo");
        let boards: Vec<Read<BoardPart>> = self.all(table, "board");
        let coupled: Vec<Read<CoupledPart>> = self.all(table, "coupled_limit");
        let eyes: Option<Read<EyesPart>> = self.one(table, "eyes");
        let arms: Vec<Read<ArmPart>> = self.all(table, "arm");
        let poses: Vec<Read<PosePart>> = self.all(table, "pose");
        let top: Option<Read<TablePart>> = self.one(table, "table");
        let patch: Option<Read<WorkspacePart>> = self.one(table, "workspace");
        let screen: Option<Read<ScreenPart>> = self.one(table, "touchscreen");
        let outlines: Option<Read<OutlinesPart>> = self.one(table, "outlines");
        let gate: Option<Read<GatePart>> = self.one(table, "gate");
        self.twice(&servos, &boards);
        let stub = checked.and_then(|checked| checked.robot.as_ref()).map(Description::of_names);
        let sound = checked.and_then(|checked| checked.description.as_ref());
        let Some(robot) = sound.or(stub.as_ref()) else { return };
        self.names(table, robot);
        self.poses(table, &poses, robot);
        let file = self.problems.file;
        let reader = Reader { file, robot };
        for (span, part) in &servos {
            for error in reader.servo_problems(part) {
                self.wrong(span, &error);
            }
        }
        let all = coupled.iter().map(|(span, part)| (span, reader.coupled(part).err()));
        let all = all.chain(eyes.iter().map(|(span, part)| (span, reader.eyes(part).err())));
        let all = all.chain(arms.iter().map(|(span, part)| (span, reader.arm(part).err())));
        let all = all.chain(poses.iter().map(|(span, part)| (span, reader.pose(part).err())));
        let all = all.chain(top.iter().map(|(span, part)| (span, reader.table(part).err())));
        let all = all.chain(patch.iter().map(|(span, part)| (span, reader.work_patch(part).err())));
        let all = all.chain(screen.iter().map(|(span, part)| (span, reader.screen(part).err())));
        let all = all.chain(outlines.iter().map(|(span, part)| (span, reader.outlines(part).err())));
        let all = all.chain(gate.iter().map(|(span, part)| (span, reader.gate(part).err())));
        for (span, error) in all {
            error.iter().for_each(|error| self.wrong(span, error));
        }
    }

    /// What a reader says of a section. Names that are not known are told where they stand.
    fn wrong(&mut self, span: &Range<usize>, error: &RigError) {
        let what = match error {
            RigError::Unknown { .. } => return,
            RigError::Value { place, what, .. } => format!("{place}: {what}"),
            other => other.to_string(),
        };
        self.problems.at(span.start, what, "correct the value in this section");
    }

    /// Ids and joints that occur twice.
    fn twice(&mut self, servos: &[Read<ServoPart>], boards: &[Read<BoardPart>]) {
        let (mut ids, mut joints) = (BTreeMap::new(), BTreeMap::new());
        for (span, servo) in servos {
            if let Some(first) = ids.insert(servo.id, &servo.title) {
                let what = format!("the servos {first} and {} both have the id {}", servo.title, servo.id);
                self.problems.at(span.start, what, "give each servo the id that it answers to on the bus");
            }
            if let Some(first) = joints.insert(&servo.joint, &servo.title) {
                let what = format!("the servos {first} and {} both move {}", servo.title, servo.joint);
                self.problems.at(span.start, what, "give each servo a joint of its own");
            }
        }
        for (span, board) in boards {
            if let Some(first) = ids.insert(board.id, &board.title) {
                let what = format!("the board {} has the id {} of {first}", board.title, board.id);
                self.problems.at(span.start, what, "give each part of the bus an id of its own");
            }
        }
    }

    /// Named poses outside of the limits of their joints.
    fn poses(&mut self, table: &DeTable<'_>, poses: &[Read<PosePart>], robot: &Description) {
        for (span, pose) in poses {
            let part = tables_at(table, "pose", span);
            for (joint, angle_rad) in &pose.joints_rad {
                let Ok(index) = robot.find_joint(joint) else { continue };
                let Limits { lower_rad, upper_rad } = robot.limits(index);
                if (lower_rad..=upper_rad).contains(angle_rad) {
                    continue;
                }
                let place = part.and_then(|part| tables(part, "joints_rad").next());
                let key = place.and_then(|joints| joints.keys().find(|key| key.get_ref() == joint));
                let at = key.map_or(span.start, |key| key.span().start);
                let what =
                    format!("pose {} puts {joint} at {angle_rad} rad, outside of its limits", pose.name);
                self.problems.at(at, what, format!("write an angle from {lower_rad} to {upper_rad}"));
            }
        }
    }
}

/// What a table in a table is called.
fn within(place: &str, name: &str) -> String {
    match place.strip_prefix('[').and_then(|section| section.strip_suffix(']')) {
        Some(section) => format!("{section}.{name}"),
        None if place == "the file" => name.to_owned(),
        None => format!("{name} of {place}"),
    }
}

/// The table of a list that stands at a place.
fn tables_at<'t, 'i>(table: &'t DeTable<'i>, name: &str, span: &Range<usize>) -> Option<&'t DeTable<'i>> {
    let (_, value) = table.iter().find(|(key, _)| key.get_ref() == name)?;
    let DeValue::Array(list) = value.get_ref() else { return None };
    match list.iter().find(|value| value.span() == *span)?.get_ref() {
        DeValue::Table(table) => Some(table),
        _ => None,
    }
}
