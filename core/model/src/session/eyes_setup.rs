//! How warm the eyes were when those were calibrated that localized: keys of the manifest that sessions of places
//! which were seen have. Without them nobody knows it.
//!
//! ```toml
//! [eyes]
//! cameras_calibrated_at_s = 720.0
//! mount_calibrated_at_s = 780.0
//! ```

use super::Manifest;
use crate::formats::FormatError;
use crate::formats::node::Field;

const SECTION: &str = "eyes";
const CAMERAS: &str = "cameras_calibrated_at_s";
const MOUNT: &str = "mount_calibrated_at_s";

/// Refuses times that cannot be.
pub(super) fn check(root: &Field<'_>) -> Result<(), FormatError> {
    let Some(eyes) = root.find(SECTION)? else { return Ok(()) };
    for key in [CAMERAS, MOUNT] {
        if let Some(field) = eyes.find(key)?
            && field.number()? < 0.0
        {
            return Err(field.out_of_range("a time since the eyes were switched on, s: 0 or more"));
        }
    }
    Ok(())
}

/// Time since the eyes were switched on when the pairs of a calibration were taken, in the mean, s. Eyes turn while they
/// warm up: what they had turned until then is in the calibration. `None`: not known, or not calibrated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CalibratedAt {
    /// Of lenses, and of how the eyes sit to each other.
    pub cameras_s: Option<f64>,
    /// Of the mount in the head.
    pub mount_s: Option<f64>,
}

impl Manifest {
    /// How warm the eyes were when they were calibrated. The keys stand in [`Manifest::extra`], where they were
    /// checked when the manifest was read.
    pub fn calibrated_at(&self) -> CalibratedAt {
        let seconds = |key: &str| {
            let value = self.extra.get(SECTION)?.get(key)?;
            value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
        };
        CalibratedAt { cameras_s: seconds(CAMERAS), mount_s: seconds(MOUNT) }
    }

    /// Keeps how warm the eyes were when they were calibrated, as far as it is known.
    pub fn set_calibrated_at(&mut self, calibrated_at: &CalibratedAt) {
        let times = [(CAMERAS, calibrated_at.cameras_s), (MOUNT, calibrated_at.mount_s)];
        let known: toml::Table =
            times.into_iter().filter_map(|(key, at_s)| Some((key.to_owned(), at_s?.into()))).collect();
        if !known.is_empty() {
            self.extra.insert(SECTION.to_owned(), known.into());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest(extra: &str) -> Result<Manifest, FormatError> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("session.toml");
        let text = format!("format = 1\nrig = \"nico\"\nstarted = 2026-01-01T00:00:00Z\n{extra}");
        std::fs::write(&file, text).expect("written");
        Manifest::read(&file)
    }

    #[test]
    fn what_is_known_is_written_and_read_again() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("session.toml");
        let both = CalibratedAt { cameras_s: Some(720.0), mount_s: Some(780.5) };
        for known in [both, CalibratedAt { mount_s: None, ..both }, CalibratedAt::default()] {
            let mut written = manifest("").expect("well formed");
            written.set_calibrated_at(&known);
            written.write(&file).expect("written");
            assert_eq!(Manifest::read(&file).expect("written well").calibrated_at(), known);
        }
        let by_hand = manifest("[eyes]\ncameras_calibrated_at_s = 600\n").expect("whole numbers, too");
        assert_eq!(by_hand.calibrated_at(), CalibratedAt { cameras_s: Some(600.0), mount_s: None });
    }

    #[test]
    fn times_that_cannot_be_are_refused_by_name() {
        for wrong in ["cameras_calibrated_at_s = -1.0", "mount_calibrated_at_s = \"warm\""] {
            let key = wrong.split(' ').next().expect("a key");
            let refused = manifest(&format!("[eyes]\n{wrong}\n")).expect_err(wrong);
            assert!(refused.to_string().contains(key), "{refused}");
        }
    }
}
