//! What is different about this robot from what its description says: the hidden reality of a
//! twin. Read from TOML; every key left out means "as described".
//!
//! These values become bodies, joints, springs, stops and lens places of the physics. They stay
//! out of everything that calibrates, searches, trains or grasps.

pub mod drawn;
mod fingerprint;

use std::collections::BTreeMap;
use std::path::Path;

use plumbline_model::files::{self, Size, told};
use serde::{Deserialize, Serialize};

use crate::error::TwinError;

/// Version of the format.
const FORMAT: u32 = 1;

/// Scenarios that come with the program: name and text.
const BUILT_IN: &[(&str, &str)] = &[
    ("lab", include_str!("../../scenarios/lab.toml")),
    ("perfect", include_str!("../../scenarios/perfect.toml")),
];

/// Hidden reality of a twin. Vectors are x, y, z; rotations are rotation vectors (axis times
/// angle); meters, radians.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Version of the format.
    pub format: u32,
    /// Short name.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// What it is like, a sentence that gives nothing away.
    pub about: String,
    /// How servos hold.
    #[serde(default)]
    pub(crate) servo: ServoReality,
    /// By name of the joint.
    #[serde(default)]
    pub(crate) joint: BTreeMap<String, JointReality>,
    /// The table, and all that stands on it.
    #[serde(default)]
    pub(crate) table: Displacement,
    /// The touchscreen on the table.
    #[serde(default)]
    pub(crate) touchscreen: ScreenReality,
    /// The eyes in the head.
    #[serde(default)]
    pub(crate) eyes: EyesReality,
    /// Fingers, by name of their link: where their tips really are.
    #[serde(default)]
    pub(crate) fingertip: BTreeMap<String, FingertipReality>,
    /// Contacts.
    #[serde(default)]
    pub(crate) contact: ContactReality,
}

/// How servos hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ServoReality {
    /// What holds the load.
    #[serde(default)]
    pub holding: Holding,
}

/// What holds the load of a servo.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Holding {
    /// A torque in proportion to the error, as in the real servos: they droop, and friction makes
    /// them stop early.
    #[default]
    Proportional,
    /// Weight is carried and nothing rubs: servos end exactly where they are sent.
    Exact,
}

/// What is different about a joint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct JointReality {
    /// Turn of the driven part when the encoder reads zero, rad.
    pub encoder_zero_rad: f64,
    /// Free play between gear and driven part, from stop to stop, rad.
    pub slack_rad: f64,
    /// Give of the bracket behind the gear, rad per Nm.
    pub compliance_rad_per_nm: f64,
    /// Turn of the whole joint, axes of the joint.
    pub axis_tilt_rad: [f64; 3],
    /// Shift of the whole joint, axes of its parent link.
    pub origin_shift_m: [f64; 3],
}

/// A rigid displacement, axes of the robot, about the thing's own middle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Displacement {
    /// Turn.
    pub rotation_rad: [f64; 3],
    /// Shift.
    pub translation_m: [f64; 3],
}

/// What is different about the touchscreen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ScreenReality {
    /// Turn, axes of the robot, about its middle.
    pub rotation_rad: [f64; 3],
    /// Shift, axes of the robot.
    pub translation_m: [f64; 3],
    /// True over nominal size along u and v.
    pub scale: [f64; 2],
}

impl Default for ScreenReality {
    fn default() -> Self {
        Self { rotation_rad: [0.0; 3], translation_m: [0.0; 3], scale: [1.0; 2] }
    }
}

/// What is different about the eyes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct EyesReality {
    /// Turn of both eyes together, axes of the head, about the left eye.
    pub rotation_rad: [f64; 3],
    /// Shift of both eyes together, axes of the head.
    pub translation_m: [f64; 3],
    /// Additional turn of the right eye, axes of that eye.
    pub right_rotation_rad: [f64; 3],
    /// How they warm up.
    pub heat: HeatReality,
}

/// Two heat nodes, the electronics of the eyes and the housing around them, and how the housing
/// turns the lenses as it expands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct HeatReality {
    /// Heat of the electronics, W.
    pub power_w: f64,
    /// Heat capacity of the electronics, J/K.
    pub electronics_j_per_k: f64,
    /// Heat capacity of the housing, J/K.
    pub housing_j_per_k: f64,
    /// Conductance from electronics to housing, W/K.
    pub inner_w_per_k: f64,
    /// Conductance from housing to the room, W/K.
    pub outer_w_per_k: f64,
    /// Turn of the left eye per kelvin of the housing above the room, axes of the eye, rad/K.
    pub left_rad_per_k: [f64; 3],
    /// The same of the right eye.
    pub right_rad_per_k: [f64; 3],
}

impl Default for HeatReality {
    fn default() -> Self {
        Self {
            power_w: 1.2,
            electronics_j_per_k: 15.0,
            housing_j_per_k: 30.0,
            inner_w_per_k: 0.15,
            outer_w_per_k: 0.12,
            left_rad_per_k: [0.0; 3],
            right_rad_per_k: [0.0; 3],
        }
    }
}

/// Where a fingertip really is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct FingertipReality {
    /// Shift of the whole finger, axes of its link.
    pub offset_m: [f64; 3],
}

/// How things touch.
#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ContactReality {
    /// Coefficient of friction of toys against hands and table.
    pub toy_friction: f64,
    /// Mass of toys, times that of the usual ones.
    pub toy_mass: f64,
    /// Size of toys, times that of the usual ones.
    pub toy_size: f64,
    /// Coefficient of friction of the hand's skin on glass.
    pub glass_friction: f64,
    /// A touch is felt from this force on, N.
    pub touch_threshold_n: f64,
}

/// What says nothing of sizes reads as it did before there were any: labs that were commissioned before there was a
/// [fingerprint](Scenario::fingerprint) know their twin by this text.
impl std::fmt::Debug for ContactReality {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { toy_friction, toy_mass, toy_size, glass_friction, touch_threshold_n } = self;
        let mut text = to.debug_struct("ContactReality");
        text.field("toy_friction", toy_friction).field("toy_mass", toy_mass);
        if (toy_size - Self::default().toy_size).abs() > 0.0 {
            text.field("toy_size", toy_size);
        }
        text.field("glass_friction", glass_friction).field("touch_threshold_n", touch_threshold_n).finish()
    }
}

impl Default for ContactReality {
    fn default() -> Self {
        Self { toy_friction: 1.0, toy_mass: 1.0, toy_size: 1.0, glass_friction: 0.3, touch_threshold_n: 0.15 }
    }
}

impl Scenario {
    /// Names of the scenarios that come with the program, the usual one first.
    pub fn built_in_names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// A scenario that comes with the program, or of a robot [that is drawn by chance](drawn).
    ///
    /// # Errors
    /// When there is none of that name.
    pub fn built_in(name: &str) -> Result<Self, TwinError> {
        if let Some(text) = drawn::named(name) {
            return Self::from_toml(name, &text);
        }
        let known = || Self::built_in_names().chain(drawn::NAMES).collect::<Vec<_>>().join(", ");
        let (_, text) = BUILT_IN
            .iter()
            .find(|(known, _)| *known == name)
            .ok_or_else(|| TwinError::UnknownScenario { name: name.to_owned(), known: known() })?;
        Self::from_toml(name, text)
    }

    /// A scenario that comes with the program by its name, else the one of a file anywhere.
    ///
    /// # Errors
    /// When there is neither, or the file is no scenario.
    pub fn named_or_file(text: &str) -> Result<Self, TwinError> {
        let is_file = text.ends_with(".toml") || Path::new(text).exists();
        if Self::built_in_names().any(|name| name == text) || drawn::named(text).is_some() || !is_file {
            return Self::built_in(text);
        }
        Self::from_toml(text, &files::read_text(Path::new(text), Size::SHORT)?)
    }

    /// How a scenario is called for short that was given by name or by file.
    pub fn short_name(text: &str) -> &str {
        let stem = text.strip_suffix(".toml").and_then(|path| Path::new(path).file_name()?.to_str());
        stem.unwrap_or(text)
    }

    /// Reads the text of a scenario file; `file` names it in messages.
    ///
    /// # Errors
    /// When it is not TOML, has a key that is not known, or a value that makes no sense.
    pub fn from_toml(file: &str, text: &str) -> Result<Self, TwinError> {
        let wrong = |reason: String| TwinError::Scenario { file: file.to_owned(), reason };
        let scenario: Self = toml::from_str(text).map_err(|error| wrong(told(&error.to_string())))?;
        scenario.check().map_err(wrong)?;
        Ok(scenario)
    }

    fn check(&self) -> Result<(), String> {
        if self.format != FORMAT {
            return Err(format!("format {} is not known; this version reads {FORMAT}", self.format));
        }
        let within = |place: &str, value: f64, least: f64, most: f64| {
            if value >= least && value <= most {
                return Ok(());
            }
            Err(format!("{place} is {value}; give a value from {least} to {most}"))
        };
        for (name, joint) in &self.joint {
            within(&format!("joint.{name}.encoder_zero_rad"), joint.encoder_zero_rad, -0.3, 0.3)?;
            within(&format!("joint.{name}.slack_rad"), joint.slack_rad, 0.0, 0.1)?;
            within(&format!("joint.{name}.compliance_rad_per_nm"), joint.compliance_rad_per_nm, 0.0, 0.2)?;
            for (tilt, shift) in joint.axis_tilt_rad.iter().zip(&joint.origin_shift_m) {
                within(&format!("joint.{name}.axis_tilt_rad"), *tilt, -0.3, 0.3)?;
                within(&format!("joint.{name}.origin_shift_m"), *shift, -0.05, 0.05)?;
            }
        }
        let turns = [self.table.rotation_rad, self.touchscreen.rotation_rad, self.eyes.rotation_rad];
        let shifts = [self.table.translation_m, self.touchscreen.translation_m, self.eyes.translation_m];
        for (turn, shift) in turns.iter().flatten().zip(shifts.iter().flatten()) {
            within("a rotation of table, touchscreen or eyes", *turn, -0.3, 0.3)?;
            within("a translation of table, touchscreen or eyes", *shift, -0.1, 0.1)?;
        }
        for scale in self.touchscreen.scale {
            within("touchscreen.scale", scale, 0.5, 2.0)?;
        }
        for offset in self.fingertip.values().flat_map(|finger| finger.offset_m) {
            within("fingertip offset_m", offset, -0.03, 0.03)?;
        }
        let heat = &self.eyes.heat;
        let capacities = [heat.electronics_j_per_k, heat.housing_j_per_k];
        let conductances = [heat.inner_w_per_k, heat.outer_w_per_k];
        for value in capacities {
            within("a heat capacity of the eyes", value, 5.0, 1e4)?;
        }
        for value in conductances {
            within("a heat conductance of the eyes", value, 1e-3, 1.0)?;
        }
        for turn in
            heat.left_rad_per_k.iter().chain(&heat.right_rad_per_k).chain(&self.eyes.right_rotation_rad)
        {
            within("a turn of an eye", *turn, -0.1, 0.1)?;
        }
        within("eyes.heat.power_w", heat.power_w, 0.0, 50.0)?;
        within("contact.toy_friction", self.contact.toy_friction, 0.0, 3.0)?;
        within("contact.toy_mass", self.contact.toy_mass, 0.1, 20.0)?;
        within("contact.toy_size", self.contact.toy_size, 0.5, 1.5)?;
        within("contact.glass_friction", self.contact.glass_friction, 0.0, 3.0)?;
        within("contact.touch_threshold_n", self.contact.touch_threshold_n, 0.01, 10.0)
    }

    /// What is different about a joint.
    pub(crate) fn joint(&self, name: &str) -> JointReality {
        self.joint.get(name).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "format = 1\nname = \"x\"\ntitle = \"X\"\nabout = \"x\"\n";

    #[test]
    fn a_scenario_is_found_by_name_and_in_a_file_anywhere() {
        assert_eq!(Scenario::named_or_file("perfect").expect("known").name, "perfect");
        let folder = tempfile::tempdir().expect("a folder for the test");
        let file = folder.path().join("mine.toml");
        let text = "format = 1\nname = \"mine\"\ntitle = \"Mine\"\nabout = \"As described.\"\n";
        std::fs::write(&file, text).expect("written");
        let path = file.display().to_string();
        assert_eq!(Scenario::named_or_file(&path).expect("a file").name, "mine");
        assert_eq!((Scenario::short_name(&path), Scenario::short_name("lab")), ("mine", "lab"));
        let gone = folder.path().join("gone.toml").display().to_string();
        let said = Scenario::named_or_file(&gone).expect_err("no file").to_string();
        assert!(said.contains("gone.toml"), "{said}");
        let said = Scenario::named_or_file("moon").expect_err("no name").to_string();
        assert!(said.contains("moon") && said.contains("perfect"), "{said}");
    }

    #[test]
    fn the_scenarios_that_come_along_are_valid() {
        for name in Scenario::built_in_names() {
            let scenario = Scenario::built_in(name).expect("a valid scenario");
            assert_eq!(scenario.name, name);
        }
    }

    #[test]
    fn an_unknown_scenario_is_told_with_those_that_are_known() {
        let error = Scenario::built_in("moon").expect_err("there is none").to_string();
        assert!(error.contains("moon") && error.contains("lab"), "{error}");
    }

    #[test]
    fn unknown_keys_and_senseless_values_are_refused() {
        for (text, part) in [
            ("[joint.r_arm_x]\nencoder_zero = 0.1", "encoder_zero"),
            ("[joint.r_arm_x]\nslack_rad = -0.1", "slack_rad"),
            ("[joint.r_arm_x]\ncompliance_rad_per_nm = nan", "compliance_rad_per_nm"),
            ("[touchscreen]\nscale = [0.0, 1.0]", "scale"),
            ("[eyes.heat]\nhousing_j_per_k = 0.0", "heat capacity"),
            ("[gravity]\nz = 0", "gravity"),
        ] {
            let error = Scenario::from_toml("x.toml", &format!("{HEAD}{text}")).expect_err(text).to_string();
            assert!(error.contains(part) && error.contains("x.toml"), "{error}");
        }
    }

    #[test]
    fn only_other_sizes_of_toys_are_told_of() {
        let text = |keys: &str| {
            let read = Scenario::from_toml("x.toml", &format!("{HEAD}[contact]\n{keys}")).expect("valid");
            format!("{read:?}")
        };
        assert_eq!(text("toy_size = 1.0"), text(""));
        assert!(!text("").contains("toy_size") && text("toy_size = 1.1").contains("toy_size: 1.1"));
        assert_ne!(text("toy_mass = 2.0"), text(""));
    }

    #[test]
    fn another_format_is_refused() {
        let error = Scenario::from_toml("x.toml", &HEAD.replace("format = 1", "format = 2"));
        assert!(error.expect_err("not known").to_string().contains("format 2"));
    }
}
