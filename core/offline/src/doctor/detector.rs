//! What computes detectors, and the one that comes with the program.

use plumbline_vision::detect::{Detector, DetectorOptions, Library, shipped_detector};

use super::Check;

/// Loads the library and opens the detector.
pub(super) fn checks() -> Vec<Check> {
    vec![library(), detector()]
}

fn library() -> Check {
    const NAME: &str = "ONNX Runtime";
    match Library::load() {
        Ok(library) => {
            let with: Vec<String> = library.providers().iter().map(ToString::to_string).collect();
            let path = library.path().display();
            Check::good(NAME, format!("{}, computes on {}: {path}", library.version(), with.join(", ")))
        }
        Err(problem) => Check::bad(NAME, problem.to_string()),
    }
}

fn detector() -> Check {
    const NAME: &str = "detector";
    let Some(shipped) = shipped_detector() else {
        return Check::bad(
            NAME,
            "the one that comes with the program was not found: give one of your own with --model, or get assets/detector",
        );
    };
    match Detector::open(&shipped.file, &DetectorOptions::default()) {
        Ok(detector) => Check::good(NAME, detector.info().summary()),
        Err(problem) => Check::bad(NAME, problem.to_string()),
    }
}
