//! How poses were measured: keys of the manifest that only sessions with `poses.csv` have.
//!
//! ```toml
//! [external]
//! frame = "tracker-2020-07"
//! [chain]
//! tip_place = "unknown"
//! encoders = "joint"
//! ```

use super::Manifest;
use crate::formats::FormatError;
use crate::formats::node::Field;

/// Which side of the gear encoder columns were read at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EncoderSide {
    /// Before the gear: its play and its ripple are not seen.
    #[default]
    Motor,
    /// Behind the gear.
    Joint,
}

/// How poses were measured.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PoseSetup {
    /// Sessions of one label share one external frame; without a label a session has its own.
    pub external_frame: Option<String>,
    /// The marker was mounted anew: where it sits at the tip's frame is not known.
    pub tip_is_unknown: bool,
    /// Side of the gear of the encoders.
    pub encoders: EncoderSide,
}

impl PoseSetup {
    /// Of a manifest's document.
    pub(super) fn read(root: &Field<'_>) -> Result<Self, FormatError> {
        let mut setup = Self::default();
        if let Some(external) = root.find("external")?
            && let Some(frame) = external.find("frame")?
        {
            let label = frame.text()?;
            if label.trim().is_empty() {
                return Err(frame.out_of_range("a label that sessions of the same frame share"));
            }
            setup.external_frame = Some(label);
        }
        let Some(chain) = root.find("chain")? else { return Ok(setup) };
        if let Some(place) = chain.find("tip_place")? {
            setup.tip_is_unknown = match place.text()?.as_str() {
                "known" => false,
                "unknown" => true,
                _ => return Err(place.out_of_range("\"known\" or \"unknown\"")),
            };
        }
        if let Some(side) = chain.find("encoders")? {
            setup.encoders = match side.text()?.as_str() {
                "motor" => EncoderSide::Motor,
                "joint" => EncoderSide::Joint,
                _ => return Err(side.out_of_range("\"motor\" or \"joint\"")),
            };
        }
        Ok(setup)
    }
}

impl Manifest {
    /// How poses were measured. The keys stand in [`Manifest::extra`], where they were checked when
    /// the manifest was read.
    pub fn pose_setup(&self) -> PoseSetup {
        let text = |section: &str, key: &str| self.extra.get(section)?.get(key)?.as_str();
        let encoders = match text("chain", "encoders") {
            Some("joint") => EncoderSide::Joint,
            _ => EncoderSide::Motor,
        };
        PoseSetup {
            external_frame: text("external", "frame").map(str::to_owned),
            tip_is_unknown: text("chain", "tip_place") == Some("unknown"),
            encoders,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest(extra: &str) -> Result<Manifest, FormatError> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("session.toml");
        let text = format!(
            "format = 1\nrig = \"nico\"\nstarted = 2026-01-01T00:00:00Z\n[chain]\ntip = \"t\"\njoints = [\"a\"]\n{extra}"
        );
        std::fs::write(&file, text).expect("written");
        Manifest::read(&file)
    }

    #[test]
    fn keys_of_poses_are_read_and_written_again() {
        let read = manifest("tip_place = \"unknown\"\nencoders = \"joint\"\n[external]\nframe = \"hall\"\n");
        let read = read.expect("well formed");
        let setup = PoseSetup {
            external_frame: Some("hall".to_owned()),
            tip_is_unknown: true,
            encoders: EncoderSide::Joint,
        };
        assert_eq!(read.pose_setup(), setup);
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("session.toml");
        read.write(&file).expect("written");
        assert_eq!(Manifest::read(&file).expect("written well").pose_setup(), setup);
        assert_eq!(manifest("").expect("well formed").pose_setup(), PoseSetup::default());
    }

    #[test]
    fn other_words_are_refused() {
        for wrong in
            ["tip_place = \"maybe\"", "encoders = \"both\"", "encoders = 3", "[external]\nframe = \" \""]
        {
            assert!(manifest(wrong).is_err(), "{wrong}");
        }
    }
}
