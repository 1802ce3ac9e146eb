//! Keeps captured pairs as a session, so that neither a crash nor a power cut costs them.

use std::path::{Path, PathBuf};

use image::RgbImage;
use plumbline_model::session::{Manifest, RigReference, names};
use plumbline_model::{Eye, StereoFrame, files};

use crate::ground::jobs::JobError;

/// Keep one pair.
#[derive(Clone, Debug)]
pub struct Keep {
    /// The pair.
    pub frame: StereoFrame,
    /// Its name in the collection.
    pub name: String,
    /// The session's folder, made if it is not there.
    pub folder: PathBuf,
    /// When the session began.
    pub started: jiff::Timestamp,
}

impl Keep {
    /// Writes both images and, the first time, the manifest.
    pub fn run(self) -> Result<PathBuf, JobError> {
        for (eye, image) in [(Eye::Left, &self.frame.left), (Eye::Right, &self.frame.right)] {
            let folder = self.folder.join(names::STEREO).join(eye.to_string());
            std::fs::create_dir_all(&folder).map_err(|error| not_kept(&folder, &error))?;
            let file = folder.join(format!("{}.png", self.name));
            let image = image::DynamicImage::from(RgbImage::clone(image));
            files::write_png(&file, &image).map_err(|error| not_kept(&file, &error))?;
        }
        let manifest = self.folder.join(names::MANIFEST);
        if !files::present(&manifest).map_err(|error| not_kept(&manifest, &error))? {
            let content = Manifest {
                rig: RigReference::Named("nico".to_owned()),
                started: self.started,
                operator: String::new(),
                notes: "chessboard pairs captured for calibrating the eyes".to_owned(),
                touchscreen: None,
                chain: None,
                extra: Default::default(),
            };
            content.write(&manifest).map_err(JobError::failed)?;
        }
        Ok(self.folder)
    }
}

fn not_kept(file: &Path, error: &dyn std::fmt::Display) -> JobError {
    JobError::failed(format!(
        "The captured pair is in memory only, because {} cannot be written ({error}). Check the free space and the permissions.",
        file.display()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use plumbline_model::{Session, Stamp};
    use std::sync::Arc;

    #[test]
    fn kept_pairs_are_a_session() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let session = folder.path().join("session");
        let image = Arc::new(RgbImage::from_pixel(8, 6, image::Rgb([1, 2, 3])));
        let frame = StereoFrame {
            stamp: Stamp { seq: 0, captured_at: std::time::Instant::now() },
            left: image.clone(),
            right: image.clone(),
            time_difference_s: None,
            name: None,
            beside: Default::default(),
        };
        for name in ["capture 001", "capture 002"] {
            let started = jiff::Timestamp::UNIX_EPOCH;
            let keep = Keep { frame: frame.clone(), name: name.into(), folder: session.clone(), started };
            keep.run().expect("written");
        }
        let read = Session::read(&session).expect("a session");
        let names: Vec<&str> = read.stereo.pairs.iter().map(|pair| pair.name.as_str()).collect();
        assert_eq!(names, ["capture 001.png", "capture 002.png"]);
        assert_eq!(image::open(&read.stereo.pairs[0].left).expect("an image").into_rgb8(), *image);
    }

    /// Keeps a pair of a size that takes a while to write.
    #[cfg(target_os = "linux")]
    fn keep(session: &Path, number: usize) -> Result<PathBuf, JobError> {
        let image =
            RgbImage::from_fn(160, 120, |x, y| image::Rgb([(x * y) as u8, (x ^ y) as u8, number as u8]));
        let image = Arc::new(image);
        let frame = StereoFrame {
            stamp: Stamp { seq: 0, captured_at: std::time::Instant::now() },
            left: image.clone(),
            right: image,
            time_difference_s: None,
            name: None,
            beside: Default::default(),
        };
        let (folder, started) = (session.to_owned(), jiff::Timestamp::UNIX_EPOCH);
        Keep { frame, name: format!("capture {number:04}"), folder, started }.run()
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_kill_leaves_whole_pairs() {
        const TEST: &str = "eyes::work::keep::tests::a_kill_leaves_whole_pairs";
        let count = |session: &Path| Session::read(session).map_or(0, |read| read.stereo.pairs.len());
        if let Some(folder) = crate::ground::kept::writing() {
            let session = folder.join("session");
            let there = count(&session);
            for number in crate::ground::kept::until_killed() {
                keep(&session, there + number).expect("kept");
            }
            return;
        }
        let folder = tempfile::tempdir().expect("temporary folder");
        let session = folder.path().join("session");
        // The first pair brings the manifest.
        keep(&session, 0).expect("kept");
        let mut pairs = 1;
        // How much is written between two kills is the disk's affair: some pairs, in the end.
        let mut nth = 0;
        while nth < 15 || (pairs <= 15 && nth < 100) {
            crate::ground::kept::kill(TEST, folder.path(), nth);
            nth += 1;
            let read = Session::read(&session).expect("a session");
            assert!(read.stereo.unpaired.len() <= 1 && read.stereo.pairs.len() >= pairs, "kill {nth}");
            pairs = read.stereo.pairs.len();
            for pair in &read.stereo.pairs {
                for file in [&pair.left, &pair.right] {
                    assert!(image::open(file).is_ok(), "kill {nth}: half of {}", file.display());
                }
            }
        }
        assert!(pairs > 15, "{pairs} pairs");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_told_and_leaves_no_half_image() {
        const TEST: &str = "eyes::work::keep::tests::a_full_disk_is_told_and_leaves_no_half_image";
        if let Some(folder) = crate::ground::kept::writing() {
            match keep(&folder.join("session"), 1) {
                Err(JobError::Failed(why)) => assert!(why.contains("is in memory only"), "{why}"),
                other => panic!("kept on a full disk: {other:?}"),
            }
            return;
        }
        let folder = tempfile::tempdir().expect("temporary folder");
        let session = folder.path().join("session");
        keep(&session, 0).expect("kept");
        for room in [0, 1024] {
            assert!(
                crate::ground::kept::run_on_full_disk(TEST, folder.path(), room).success(),
                "room for {room}"
            );
            let read = Session::read(&session).expect("a session");
            assert_eq!((read.stereo.pairs.len(), read.stereo.unpaired.len()), (1, 0));
            assert_eq!(std::fs::read_dir(session.join("stereo/left")).expect("there").count(), 1);
        }
    }
}
