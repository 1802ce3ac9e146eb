//! The detector that comes with the program.

use std::path::{Path, PathBuf};

use super::{DetectError, Detector, DetectorOptions};

/// Where it lies in the checkout, and beside an installed program.
const FILE: &str = "assets/detector/plumbline-detector.onnx";

/// The detector that comes with the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShippedDetector {
    /// Its file.
    pub file: PathBuf,
}

impl ShippedDetector {
    /// Opens it.
    ///
    /// # Errors
    /// As [`Detector::open`].
    pub fn open(&self, options: &DetectorOptions) -> Result<Detector, DetectError> {
        Detector::open(&self.file, options)
    }
}

/// The detector that comes with the program: beside it, or in a folder above it, or in the
/// checkout that it was built from. `None` if it is in none of them.
pub fn shipped_detector() -> Option<ShippedDetector> {
    let program = std::env::current_exe().ok();
    let above = program.iter().flat_map(|program| program.ancestors().skip(1).take(4));
    let checkout = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2);
    above
        .chain(checkout)
        .map(|folder| folder.join(FILE))
        .find(|file| file.is_file())
        .map(|file| ShippedDetector { file })
}
