//! Detectors in ONNX files, run by ONNX Runtime.

use image::RgbImage;
use plumbline_model::detection::Detection;
use plumbline_vision::detect::{
    ClassFilter, DetectSettings, DetectTiming, DetectorInfo, DetectorOptions, EyesDetector, Part, Provider,
    shipped_detector,
};

use super::command::DetectorChoice;
use super::detector::{DetectorError, Detects, OpenDetector, SHOWN_FROM};
use super::view::{DetectionTiming, DetectorFacts};
use crate::ground::text::sentence;

/// Boxes of one image that are kept at most.
const MOST: usize = 300;

impl Default for OpenDetector {
    /// With ONNX Runtime.
    fn default() -> Self {
        Self::new(open)
    }
}

/// Opens a detector.
fn open(choice: &DetectorChoice, provider: Provider) -> Result<Box<dyn Detects>, DetectorError> {
    let options = DetectorOptions {
        provider,
        threads: Some(threads()),
        shares_processor: true,
        ..DetectorOptions::default()
    };
    let detector = match choice {
        DetectorChoice::Off => return Err(DetectorError::NoneChosen),
        DetectorChoice::Shipped => {
            EyesDetector::open(&shipped_detector().ok_or(DetectorError::NoneShipped)?.file, &options)?
        }
        DetectorChoice::File(file) => EyesDetector::open(file, &options)?,
    };
    let settings = DetectSettings {
        confidence: SHOWN_FROM,
        most: MOST,
        classes: ClassFilter::All,
        ..DetectSettings::default()
    };
    Ok(Box::new(FileDetector { detector, settings, shipped: *choice == DetectorChoice::Shipped }))
}

/// Threads for both eyes. Cameras, disparity, the window and the bus, which moves an arm, need the
/// processor too; but where there are two cores, each eye has one: a pair keeps them busy as long
/// together as one core alone, and is known in half of the time.
pub fn threads() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    (cores / 2).max(2).min(cores)
}

struct FileDetector {
    detector: EyesDetector,
    settings: DetectSettings,
    shipped: bool,
}

impl Detects for FileDetector {
    fn facts(&self) -> DetectorFacts {
        facts(self.detector.info(), self.shipped)
    }

    fn detect(
        &mut self,
        image: &RgbImage,
        iou: f32,
        found: &mut Vec<Detection>,
    ) -> Result<DetectionTiming, DetectorError> {
        self.detect_in(image, Part::default(), iou, found)
    }

    fn detect_in(
        &mut self,
        image: &RgbImage,
        part: Part,
        iou: f32,
        found: &mut Vec<Detection>,
    ) -> Result<DetectionTiming, DetectorError> {
        self.settings.iou = iou;
        Ok(timing(self.detector.one().detect_in(image, part, &self.settings, found)?))
    }

    fn detect_eyes(
        &mut self,
        images: [&RgbImage; 2],
        parts: [Part; 2],
        iou: f32,
        found: [&mut Vec<Detection>; 2],
    ) -> Result<DetectionTiming, DetectorError> {
        self.settings.iou = iou;
        Ok(timing(self.detector.detect_in(images, parts, &self.settings, found)?.passed()))
    }
}

fn timing(of: DetectTiming) -> DetectionTiming {
    let DetectTiming { before, network, after } = of;
    DetectionTiming { before, network, after, ..DetectionTiming::default() }
}

fn facts(info: &DetectorInfo, shipped: bool) -> DetectorFacts {
    let differing = |other: &Option<_>| other.clone().filter(|other| *other != info.names);
    let other_names = differing(&info.names_beside)
        .map(|names| (names, "the data.yaml beside the file".to_owned()))
        .or_else(|| differing(&info.names_in_file).map(|names| (names, "the file itself".to_owned())));
    let mut rows = vec![
        ("Input".to_owned(), info.input.to_string()),
        ("Output".to_owned(), info.head.to_string()),
        ("Numbers".to_owned(), info.precision.to_string()),
        ("Computed by".to_owned(), info.provider_used.to_string()),
        ("Library".to_owned(), info.runtime.clone()),
    ];
    rows.extend(info.made_by.iter().map(|made_by| ("Made by".to_owned(), made_by.clone())));
    let remarks = [&info.disagreement, &info.provider_note];
    DetectorFacts {
        name: if shipped { DetectorChoice::Shipped.name() } else { info.name.clone() },
        file: info.file.clone().filter(|_| !shipped),
        names: info.names.clone(),
        names_from: info.names_from.to_string(),
        other_names,
        rows,
        remarks: remarks.into_iter().flatten().map(|remark| sentence(remark)).collect(),
    }
}
