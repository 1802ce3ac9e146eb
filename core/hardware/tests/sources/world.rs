//! Temporary folders with images that know who they are.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use image::{Rgb, RgbImage};
use plumbline_hardware::{Next, SourceError, StereoSource};
use plumbline_model::{Eye, StereoFrame};
use tempfile::TempDir;

/// Image of an eye at a moment: both can be read back from its pixels.
pub fn picture(eye: Eye, moment: u8) -> RgbImage {
    sized_picture(eye, moment, (32, 24))
}

/// The same of another size.
pub fn sized_picture(eye: Eye, moment: u8, size: (u32, u32)) -> RgbImage {
    RgbImage::from_pixel(size.0, size.1, Rgb([moment * 10, 200, if eye == Eye::Left { 0 } else { 255 }]))
}

/// Which moment a pair shows; panics if its two images are not left and right of one moment.
pub fn moment_of(pair: &StereoFrame) -> u8 {
    let (left, right) = (pair.left.get_pixel(3, 3).0, pair.right.get_pixel(3, 3).0);
    // JPEG keeps flat colors to within a few values.
    assert!(left[2] < 10 && right[2] > 245, "the eyes are exchanged");
    assert!(left[0].abs_diff(right[0]) < 5, "two moments were joined");
    (left[0] + 5) / 10
}

/// A temporary folder.
pub struct World {
    folder: TempDir,
}

impl World {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    pub fn at(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// Saves an image; its folders are made as needed.
    pub fn save(&self, name: &str, image: &RgbImage) {
        image.save(self.place(name)).expect("saving an image");
    }

    /// Writes any file.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.place(name), content).expect("writing a file");
    }

    /// Folders `left` and `right` with these moments as `frame_N.png`.
    pub fn save_pairs(&self, moments: impl IntoIterator<Item = u8>) {
        for moment in moments {
            for eye in Eye::BOTH {
                self.save(&format!("{eye}/frame_{moment}.png"), &picture(eye, moment));
            }
        }
    }

    fn place(&self, name: &str) -> PathBuf {
        let path = self.at(name);
        fs::create_dir_all(path.parent().expect("a folder above")).expect("making folders");
        path
    }
}

/// Asks until the source ends, `limit` pairs came, or ten seconds are over.
pub fn collect(source: &mut dyn StereoSource, limit: usize) -> Result<Vec<StereoFrame>, SourceError> {
    let deadline = Instant::now() + Duration::from_secs(10);
    let mut pairs = Vec::new();
    while pairs.len() < limit && Instant::now() < deadline {
        match source.next_pair()? {
            Next::Pair(pair) => pairs.push(pair),
            Next::End => break,
            Next::NotYet => std::thread::sleep(source.wait_hint().min(Duration::from_millis(20))),
        }
    }
    Ok(pairs)
}

/// The moments a source delivers until it ends.
pub fn moments(source: &mut dyn StereoSource) -> Vec<u8> {
    collect(source, 1000).expect("a running source").iter().map(moment_of).collect()
}

/// What the source reports, as text.
pub fn reports(source: &mut dyn StereoSource) -> Vec<String> {
    source.take_reports().iter().map(ToString::to_string).collect()
}
