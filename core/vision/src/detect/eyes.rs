//! Both eyes at once.

use std::path::Path;

use image::RgbImage;
use plumbline_model::Eye;
use plumbline_model::detection::Detection;

use super::{
    DetectError, DetectSettings, DetectTiming, Detector, DetectorInfo, DetectorOptions, Part, Provider,
};

/// Finds things on the images of both eyes, each eye on a processor core of its own.
///
/// The layers of a small network are over too soon for several threads to share each of them well:
/// they wait for each other at every one, and for whatever else keeps one of the cores busy. An eye
/// has nothing to wait for. What is found is the same as by one [`Detector`] on one image after the
/// other.
#[derive(Debug)]
pub struct EyesDetector {
    left: Detector,
    /// `None`: the right eye comes after the left one, by the same detector.
    right: Option<Detector>,
}

/// What became of a look at both eyes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EyesTiming {
    /// Of each eye, left first.
    pub eyes: [DetectTiming; 2],
    /// Whether they were looked at at the same time.
    pub at_once: bool,
}

impl EyesTiming {
    /// The parts of the time that passed: of the eye that took longer, or of both one after the other.
    pub fn passed(&self) -> DetectTiming {
        let [left, right] = self.eyes;
        if self.at_once {
            return if left.total() < right.total() { right } else { left };
        }
        DetectTiming {
            before: left.before + right.before,
            network: left.network + right.network,
            after: left.after + right.after,
        }
    }
}

impl From<Detector> for EyesDetector {
    /// One eye after the other.
    fn from(detector: Detector) -> Self {
        Self { left: detector, right: None }
    }
}

impl EyesDetector {
    /// Opens an ONNX file, for both eyes at once where the processor computes it and has two threads
    /// for it. [`DetectorOptions::threads`] are those of both eyes together.
    ///
    /// # Errors
    /// As [`Detector::open`].
    pub fn open(path: &Path, options: &DetectorOptions) -> Result<Self, DetectError> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = options.threads.unwrap_or(cores);
        let of_eye = DetectorOptions { threads: Some((threads / 2).max(1)), ..options.clone() };
        let left = Detector::open(path, if threads > 1 { &of_eye } else { options })?;
        let at_once = threads > 1 && left.info().provider_used == Provider::Cpu;
        let right = at_once.then(|| Detector::open(path, &of_eye)).transpose()?;
        Ok(Self { left, right })
    }

    /// What is known of the detector.
    pub fn info(&self) -> &DetectorInfo {
        self.left.info()
    }

    /// The detector of one eye, for single images.
    pub fn one(&mut self) -> &mut Detector {
        &mut self.left
    }

    /// Finds things on a part of each image, left eye first; see [`Detector::detect_in`].
    ///
    /// # Errors
    /// As [`Detector::detect_in`], of the left eye if both fail. Nothing is found in either then.
    pub fn detect_in(
        &mut self,
        images: [&RgbImage; 2],
        parts: [Part; 2],
        settings: &DetectSettings,
        found: [&mut Vec<Detection>; 2],
    ) -> Result<EyesTiming, DetectError> {
        let [in_left, in_right] = found;
        let at_once = self.right.is_some();
        let looked = match &mut self.right {
            None => one_by_one(&mut self.left, images, parts, settings, [&mut *in_left, &mut *in_right]),
            Some(right) => {
                let of_right =
                    |found: &mut Vec<Detection>| right.detect_in(images[1], parts[1], settings, found);
                let found = [&mut *in_left, &mut *in_right];
                both(&mut self.left, images[0], parts[0], settings, found, of_right)
            }
        };
        match looked {
            Ok(eyes) => Ok(EyesTiming { eyes, at_once }),
            Err(error) => {
                in_left.clear();
                in_right.clear();
                Err(error)
            }
        }
    }
}

fn one_by_one(
    detector: &mut Detector,
    images: [&RgbImage; 2],
    parts: [Part; 2],
    settings: &DetectSettings,
    [in_left, in_right]: [&mut Vec<Detection>; 2],
) -> Result<[DetectTiming; 2], DetectError> {
    let [l, r] = Eye::BOTH.map(Eye::index);
    let left = detector.detect_in(images[l], parts[l], settings, in_left)?;
    let right = detector.detect_in(images[r], parts[r], settings, in_right)?;
    Ok([left, right])
}

/// The right eye on a thread of its own, the left one here.
fn both(
    detector: &mut Detector,
    image: &RgbImage,
    part: Part,
    settings: &DetectSettings,
    [in_left, in_right]: [&mut Vec<Detection>; 2],
    mut of_right: impl FnMut(&mut Vec<Detection>) -> Result<DetectTiming, DetectError> + Send,
) -> Result<[DetectTiming; 2], DetectError> {
    let mut right = None;
    let spawned = std::thread::scope(|scope| {
        let work = || right = Some(of_right(&mut *in_right));
        let thread = std::thread::Builder::new().name("detect-right-eye".to_owned());
        let Ok(thread) = thread.spawn_scoped(scope, work) else { return None };
        let left = detector.detect_in(image, part, settings, in_left);
        if let Err(panic) = thread.join() {
            std::panic::resume_unwind(panic);
        }
        Some(left)
    });
    // Where no thread can be had, the eyes follow each other.
    let left = match spawned {
        Some(left) => left?,
        None => detector.detect_in(image, part, settings, in_left)?,
    };
    let right = match right {
        Some(right) => right?,
        None => of_right(in_right)?,
    };
    Ok([left, right])
}
