//! The model's file: TOML, written in one step.

use std::path::Path;

use plumbline_model::files::{self, Size};
use plumbline_model::formats::depth;
use plumbline_model::robot::Rig;
use serde::{Deserialize, Serialize};

use super::{Contents, RigModel, RigModelError, Step, StepGap};

/// Version of the format, the value of the key `rig_model`. Format 1 had gaps in millimeters.
pub const FORMAT: u32 = 2;
/// The oldest one that is read.
const OLDEST: u32 = 1;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    /// Tells this file from others, and its format.
    rig_model: u32,
    rig: String,
    #[serde(default)]
    present: Contents,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    history: Vec<Step>,
}

/// Whether a table of TOML is a model with effects, of whatever version.
pub fn is_rig_model(keys: &toml::Table) -> bool {
    keys.contains_key("rig_model")
}

impl RigModel {
    /// Reads a model of this rig.
    ///
    /// # Errors
    /// When the file cannot be read, is none, of another version or of another rig, or holds an effect
    /// that is unknown or has no place in the rig.
    pub fn read(file: &Path, rig: &Rig) -> Result<Self, RigModelError> {
        let bytes = files::read(file, Size::TEXT)?;
        let not = |reason: String| RigModelError::NotModel { file: file.to_owned(), reason };
        let text = String::from_utf8(bytes).map_err(|_| not("it is no text".to_owned()))?;
        Self::parse(file, text.strip_prefix('\u{feff}').unwrap_or(&text), rig)
    }

    fn parse(file: &Path, text: &str, rig: &Rig) -> Result<Self, RigModelError> {
        let not = |reason: String| RigModelError::NotModel { file: file.to_owned(), reason };
        depth::check(depth::of_toml(text)).map_err(not)?;
        let keys: toml::Table =
            toml::from_str(text).map_err(|error| not(format!("it is not TOML ({})", error.message())))?;
        match keys.get("rig_model") {
            Some(toml::Value::Integer(found)) if (i64::from(OLDEST)..=i64::from(FORMAT)).contains(found) => {}
            Some(toml::Value::Integer(found)) => {
                let (file, found) = (file.to_owned(), *found);
                return Err(RigModelError::OtherVersion { file, found, known: FORMAT });
            }
            Some(_) => return Err(not("its rig_model is no number".to_owned())),
            None => return Err(not("it has no key rig_model".to_owned())),
        }
        let mut read: File = toml::from_str(text).map_err(|error| not(error.message().to_owned()))?;
        read.history.iter_mut().filter_map(|step| step.gap.as_mut()).for_each(StepGap::make_si);
        if read.rig != rig.name {
            return Err(RigModelError::OtherRig { found: read.rig, expected: rig.name.clone() });
        }
        let unusable = |reason| RigModelError::EffectOfFile { file: file.to_owned(), reason };
        read.history
            .iter()
            .filter_map(|step| step.gap.as_ref())
            .try_for_each(StepGap::check)
            .map_err(unusable)?;
        // What could come back by an undo must be usable, too.
        for contents in std::iter::once(&read.present).chain(read.history.iter().map(|step| &step.before)) {
            contents.check(rig).map_err(unusable)?;
        }
        Ok(Self { rig: read.rig, contents: read.present, history: read.history })
    }

    /// The text of its file.
    ///
    /// # Errors
    /// When it holds what cannot be read again.
    pub fn to_toml(&self, file: &Path, rig: &Rig) -> Result<String, RigModelError> {
        let not = |reason: String| RigModelError::NotModel { file: file.to_owned(), reason };
        let (present, history) = (self.contents.clone(), self.history.clone());
        let parts = File { rig_model: FORMAT, rig: self.rig.clone(), present, history };
        let text = toml::to_string(&parts).map_err(|error| not(error.to_string()))?;
        // What cannot be read again must not replace what could.
        Self::parse(file, &text, rig)?;
        Ok(text)
    }

    /// Writes it in one step: after a crash there is the old file or the new one.
    ///
    /// # Errors
    /// When it holds what cannot be read again, or the file cannot be written.
    pub fn write(&self, file: &Path, rig: &Rig) -> Result<(), RigModelError> {
        let text = self.to_toml(file, rig)?;
        Ok(files::write(file, text)?)
    }
}

/// A touchscreen in a file.
pub(super) mod screen_part {
    use nalgebra::Vector3;
    use plumbline_model::session::Touchscreen;
    use plumbline_model::{Direction, Point, Robot};
    use serde::de::Error as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Part {
        width_px: u32,
        height_px: u32,
        width_m: f64,
        height_m: f64,
        origin_m: [f64; 3],
        u_axis: [f64; 3],
        v_axis: [f64; 3],
    }

    pub fn serialize<S: Serializer>(screen: &Touchscreen, to: S) -> Result<S::Ok, S::Error> {
        Part {
            width_px: screen.width_px,
            height_px: screen.height_px,
            width_m: screen.width_m,
            height_m: screen.height_m,
            origin_m: screen.origin.coords.coords.into(),
            u_axis: screen.u_axis.vector().into(),
            v_axis: screen.v_axis.vector().into(),
        }
        .serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Touchscreen, D::Error> {
        let part = Part::deserialize(from)?;
        let axis = |name: &str, vector: [f64; 3]| {
            Direction::<Robot>::new(Vector3::from(vector))
                .ok_or_else(|| D::Error::custom(format!("{name} of a screen has no direction")))
        };
        let [x, y, z] = part.origin_m;
        let screen = Touchscreen {
            width_px: part.width_px,
            height_px: part.height_px,
            width_m: part.width_m,
            height_m: part.height_m,
            origin: Point::new(x, y, z),
            u_axis: axis("u_axis", part.u_axis)?,
            v_axis: axis("v_axis", part.v_axis)?,
        };
        if screen.is_usable() {
            Ok(screen)
        } else {
            Err(D::Error::custom("a screen has no size, or its axes are not at right angles"))
        }
    }
}

/// A rigid motion in a file.
pub(super) mod isometry_part {
    use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
    use serde::de::Error as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Part {
        translation_m: [f64; 3],
        quaternion_xyzw: [f64; 4],
    }

    pub fn serialize<S: Serializer>(motion: &Isometry3<f64>, to: S) -> Result<S::Ok, S::Error> {
        let turn = motion.rotation.coords;
        Part { translation_m: motion.translation.vector.into(), quaternion_xyzw: turn.into() }.serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Isometry3<f64>, D::Error> {
        let Part { translation_m: [a, b, c], quaternion_xyzw: [x, y, z, w] } = Part::deserialize(from)?;
        let turn = Quaternion::new(w, x, y, z);
        let finite = [a, b, c].iter().all(|value| value.is_finite());
        if !(finite && (turn.norm() - 1.0).abs() < 1e-6) {
            return Err(D::Error::custom("a rigid motion is none: its quaternion has not the length 1"));
        }
        // Not normalized again: what was written comes back to the last bit.
        Ok(Isometry3::from_parts(Translation3::new(a, b, c), UnitQuaternion::new_unchecked(turn)))
    }
}
