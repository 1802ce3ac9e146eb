//! Reads rig files (TOML): the keys, and the checks that make a [`Rig`] of them.

mod moved;
mod parts;
mod places;

use std::path::Path;
use std::sync::Arc;

use serde::Deserialize;

use self::parts::File;
pub(super) use self::parts::{
    ArmPart, BoardPart, BusPart, CoupledPart, EyesPart, GatePart, PosePart, ScreenPart, ServoPart, TablePart,
    WorkspacePart,
};
use super::description::{Description, JointIndex};
use super::error::{DescriptionError, RigError};
use super::rig::{Board, Bus, Rig};
use crate::files::{self, Size, told};
use crate::formats::depth;
use crate::plausible::Quantity;

/// Version of the format.
pub(super) const FORMAT: u32 = 1;

/// Rigs that come with the program: name, rig file, description.
const BUILT_IN: &[(&str, &str, &str)] = &[(
    "nico",
    include_str!("../../../../../assets/robots/nico/rig.toml"),
    include_str!("../../../../../assets/robots/nico/nico.urdf"),
)];

/// The rig that is used unless another one is chosen.
pub fn default_rig() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("the rig that comes with the program is tested"))
}

impl Rig {
    /// Names of the rigs that come with the program.
    pub fn built_in_names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, ..)| *name)
    }

    /// A rig that comes with the program.
    ///
    /// # Errors
    /// When there is none of that name.
    pub fn built_in(name: &str) -> Result<Self, RigError> {
        let found = BUILT_IN.iter().find(|(known, ..)| *known == name);
        let (_, rig, description) = found.ok_or_else(|| RigError::Unreadable {
            file: format!("rig {name}"),
            reason: format!(
                "no rig of that name comes with the program; there are: {}",
                Self::built_in_names().collect::<Vec<_>>().join(", ")
            ),
        })?;
        Self::parse(&format!("{name}/rig.toml"), rig, |_| Ok((*description).to_owned()))
    }

    /// The files of a rig that comes with the program: the rig and its description; `None`: there is none of
    /// that name.
    pub fn built_in_files(name: &str) -> Option<[&'static str; 2]> {
        BUILT_IN.iter().find(|(known, ..)| *known == name).map(|(_, rig, description)| [*rig, *description])
    }

    /// Reads a rig file; the description it names lies beside it.
    pub fn read(file: &Path) -> Result<Self, RigError> {
        let read = |path: &Path| Ok(files::read_text(path, Size::TEXT)?);
        let folder = file.parent().unwrap_or(Path::new(""));
        Self::parse(&file.display().to_string(), &read(file)?, |name| read(&folder.join(name)))
    }

    /// The name of the description that a rig file names, which lies beside it.
    ///
    /// # Errors
    /// When the file cannot be read or names none.
    pub fn description_of(file: &Path) -> Result<String, RigError> {
        #[derive(Deserialize)]
        struct Named {
            description: String,
        }
        let text = files::read_text(file, Size::TEXT)?;
        let not = |reason: String| RigError::NotRig { file: file.display().to_string(), reason };
        depth::check(depth::of_toml(&text)).map_err(not)?;
        let named: Named = toml::from_str(&text).map_err(|error| not(told(&error.to_string())))?;
        Ok(named.description)
    }

    /// From the text of a rig file; `description` gives the text of the description that it names.
    pub fn parse(
        file: &str,
        text: &str,
        description: impl FnOnce(&str) -> Result<String, RigError>,
    ) -> Result<Self, RigError> {
        depth::check(depth::of_toml(text))
            .map_err(|reason| RigError::NotRig { file: file.to_owned(), reason })?;
        let parts: File = toml::from_str(text)
            .map_err(|error| RigError::NotRig { file: file.to_owned(), reason: told(&error.to_string()) })?;
        let urdf = description(&parts.description)?;
        let robot = Description::from_urdf(&urdf).map_err(|error| RigError::Description {
            file: parts.description.clone(),
            error: Box::new(error),
        })?;
        Reader { file, robot: &robot }.rig(parts)
    }
}

/// Knows where it reads, for its errors.
pub(super) struct Reader<'a> {
    pub file: &'a str,
    pub robot: &'a Description,
}

impl Reader<'_> {
    fn rig(&self, parts: File) -> Result<Rig, RigError> {
        if parts.format != FORMAT {
            return Err(self.value("format", format!("is {}, this program reads {FORMAT}", parts.format)));
        }
        let servos = parts.servo.iter().map(|part| self.servo(part)).collect::<Result<Vec<_>, _>>()?;
        self.unique(&servos, &parts.board)?;
        let rig = Rig {
            description: Arc::new(self.robot.clone()),
            bus: Bus { baud: parts.bus.baud },
            servos,
            boards: parts
                .board
                .into_iter()
                .map(|b| Board { id: b.id, model: b.model, title: b.title })
                .collect(),
            coupled_limits: parts.coupled_limit.iter().map(|p| self.coupled(p)).collect::<Result<_, _>>()?,
            eyes: self.eyes(&parts.eyes)?,
            table: self.table(&parts.table)?,
            work_patch: self.work_patch(&parts.workspace)?,
            touchscreen: self.screen(&parts.touchscreen)?,
            arms: parts.arm.iter().map(|part| self.arm(part)).collect::<Result<_, _>>()?,
            poses: parts.pose.iter().map(|part| self.pose(part)).collect::<Result<_, _>>()?,
            outlines: self.outlines(&parts.outlines)?,
            gate: self.gate(&parts.gate)?,
            name: parts.name,
            title: parts.title,
            lacking: vec![],
        };
        for pose in &rig.poses {
            for (joint, angle_rad) in &pose.joints {
                let limits = rig.limits(*joint);
                if !limits.contain(*angle_rad) {
                    return Err(self.value(
                        &format!("pose {}", pose.name),
                        format!(
                            "puts {} at {angle_rad} rad, outside of its limits {} to {}",
                            rig.description.joint(*joint).name,
                            limits.lower_rad,
                            limits.upper_rad
                        ),
                    ));
                }
            }
        }
        Ok(rig)
    }

    pub(super) fn value(&self, place: &str, what: String) -> RigError {
        RigError::Value { file: self.file.to_owned(), place: place.to_owned(), what: told(&what) }
    }

    fn finite(&self, place: &str, values: &[f64]) -> Result<(), RigError> {
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(self.value(place, format!("{value} is not a number that can be used"))),
            None => Ok(()),
        }
    }

    /// Refuses numbers that cannot be what they are said to be.
    pub(super) fn plausible(&self, place: &str, quantity: Quantity, values: &[f64]) -> Result<(), RigError> {
        self.finite(place, values)?;
        quantity.check_all(values).map_err(|what| self.value(place, what.to_string()))
    }

    fn unknown(&self, place: &str, error: DescriptionError) -> RigError {
        RigError::Unknown { file: self.file.to_owned(), place: place.to_owned(), error: Box::new(error) }
    }

    fn joint(&self, place: &str, name: &str) -> Result<JointIndex, RigError> {
        self.robot.find_joint(name).map_err(|error| self.unknown(place, error))
    }
}
