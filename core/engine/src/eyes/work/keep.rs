//! Keeps captured pairs as a session, so that neither a crash nor a power cut costs them.

use std::path::{Path, PathBuf};

use image::RgbImage;
use plumbline_model::session::{Manifest, RigReference, names};
use plumbline_model::{Eye, StereoFrame};

use crate::jobs::JobError;

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
            write_image(image, &folder.join(format!("{}.png", self.name)))?;
        }
        let manifest = self.folder.join(names::MANIFEST);
        if !manifest.exists() {
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

/// Under a temporary name first: half an image is worse than none.
fn write_image(image: &RgbImage, file: &Path) -> Result<(), JobError> {
    let temporary = file.with_extension("png.tmp");
    image
        .save_with_format(&temporary, image::ImageFormat::Png)
        .map_err(|error| not_kept(file, &error))
        .and_then(|()| std::fs::rename(&temporary, file).map_err(|error| not_kept(file, &error)))
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
}
