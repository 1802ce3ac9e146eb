//! `plumbline detect`: what a detector finds on the images of a folder.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use plumbline_hardware::{load_image, natural_order};
use plumbline_model::files;
use plumbline_model::{Detection, JobContext};
use plumbline_vision::detect::{
    DetectSettings, DetectTiming, Detector, DetectorInfo, DetectorOptions, shipped_detector,
};
use plumbline_vision::yolo_set::{is_image_name, label_file_of};
use serde::Serialize;

use super::OfflineError;

/// What to look at, and with what.
#[derive(Clone, Debug)]
pub struct DetectArgs {
    /// ONNX file; `None` takes the detector that comes with the program.
    pub model: Option<PathBuf>,
    /// Folder of images, or one image.
    pub images: PathBuf,
    /// Folder that receives a YOLO label file per image and the names of the classes.
    pub labels_out: Option<PathBuf>,
    /// Which boxes count.
    pub settings: DetectSettings,
    /// What computes.
    pub options: DetectorOptions,
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DetectReport {
    /// File of the detector.
    pub model: PathBuf,
    /// What is known of it.
    pub detector: DetectorInfo,
    /// Images that were looked at.
    pub images: usize,
    /// Images that were left out.
    pub left_out: Vec<LeftOutImage>,
    /// Median over the images of the whole time for one, without reading the file.
    pub milliseconds_median: f64,
    /// Its parts: letterbox.
    pub milliseconds_before: f64,
    /// The network alone.
    pub milliseconds_network: f64,
    /// Reading the head and suppression.
    pub milliseconds_after: f64,
    /// Boxes, image by image, the surest first.
    pub detections: Vec<FoundBox>,
    /// What was noticed.
    pub notes: Vec<String>,
}

/// An image that was left out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOutImage {
    /// File name.
    pub image: String,
    /// Why, and what to do.
    pub reason: String,
}

/// A box on an image.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundBox {
    /// File name.
    pub image: String,
    /// Name of the class.
    pub class: String,
    /// Its number.
    pub class_index: usize,
    /// 0–1.
    pub confidence: f32,
    /// Left edge; 0 is the left edge of the first pixel.
    pub x0_px: f32,
    /// Upper edge.
    pub y0_px: f32,
    /// Right edge.
    pub x1_px: f32,
    /// Lower edge.
    pub y1_px: f32,
}

/// Runs a detector on a folder.
pub fn detect(args: &DetectArgs, context: &dyn JobContext) -> Result<DetectReport, OfflineError> {
    let model = match &args.model {
        Some(file) => file.clone(),
        None => shipped_detector().ok_or(OfflineError::NoDetector)?.file,
    };
    let images = image_files(&args.images)?;
    let labels = args.labels_out.as_deref();
    if let Some(folder) = labels {
        check_labels(folder, &images)?;
    }
    let mut detector = Detector::open(&model, &args.options)?;
    let mut work = Work { report: empty(model, detector.info().clone()), timings: Vec::new(), refused: None };
    if let Some(folder) = labels {
        files::make_folder(folder)?;
        write_names(folder, &work.report.detector)?;
    }
    for (done, file) in images.iter().enumerate() {
        context.checkpoint()?;
        context.report(done as f64 / images.len() as f64, "detecting");
        work.image(&mut detector, file, &args.settings, labels)?;
    }
    context.report(1.0, "detecting");
    work.finish()
}

struct Work {
    report: DetectReport,
    timings: Vec<DetectTiming>,
    /// Place in the list of left out images of the first one that could be read, so that the
    /// detector is to blame.
    refused: Option<usize>,
}

impl Work {
    /// Adds one image, or why it is left out.
    fn image(
        &mut self,
        detector: &mut Detector,
        file: &Path,
        settings: &DetectSettings,
        labels: Option<&Path>,
    ) -> Result<(), OfflineError> {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let mut found = Vec::new();
        let mut readable = false;
        let looked = load_image(file).map_err(|problem| problem.to_string()).and_then(|loaded| {
            readable = true;
            let notes = loaded.notes.iter().map(|note| format!("{name}: {note}"));
            self.report.notes.extend(notes);
            let timing = detector.detect(&loaded.image, settings, &mut found);
            Ok((loaded.image.dimensions(), timing.map_err(|error| error.to_string())?))
        });
        let (size, timing) = match looked {
            Ok(looked) => looked,
            Err(reason) => {
                if readable && self.refused.is_none() {
                    self.refused = Some(self.report.left_out.len());
                }
                self.report.left_out.push(LeftOutImage { image: name, reason });
                return Ok(());
            }
        };
        self.timings.push(timing);
        if let Some(folder) = labels {
            let path = folder.join(&name).with_extension("txt");
            files::write(&path, label_lines(&found, size))?;
        }
        let names = &self.report.detector.names;
        self.report.detections.extend(found.iter().map(|detection| FoundBox {
            image: name.clone(),
            class: names.get(detection.class).unwrap_or_default().to_owned(),
            class_index: detection.class.0,
            confidence: detection.confidence,
            x0_px: detection.area.x0_px,
            y0_px: detection.area.y0_px,
            x1_px: detection.area.x1_px,
            y1_px: detection.area.y1_px,
        }));
        Ok(())
    }

    fn finish(mut self) -> Result<DetectReport, OfflineError> {
        if self.timings.is_empty()
            && let Some(LeftOutImage { image, reason }) =
                self.report.left_out.get(self.refused.unwrap_or_default())
        {
            return Err(OfflineError::NoImageDetected {
                images: self.report.left_out.len(),
                example: format!("{image}: {reason}"),
            });
        }
        let milliseconds = |part: fn(&DetectTiming) -> Duration| {
            let mut parts: Vec<f64> =
                self.timings.iter().map(|timing| part(timing).as_secs_f64() * 1000.0).collect();
            parts.sort_by(f64::total_cmp);
            parts.get(parts.len() / 2).copied().unwrap_or_default()
        };
        self.report.images = self.timings.len();
        self.report.milliseconds_median = milliseconds(DetectTiming::total);
        self.report.milliseconds_before = milliseconds(|timing| timing.before);
        self.report.milliseconds_network = milliseconds(|timing| timing.network);
        self.report.milliseconds_after = milliseconds(|timing| timing.after);
        Ok(self.report)
    }
}

fn empty(model: PathBuf, detector: DetectorInfo) -> DetectReport {
    let notes = detector.disagreement.iter().chain(&detector.provider_note).cloned().collect();
    DetectReport {
        model,
        detector,
        images: 0,
        left_out: Vec::new(),
        milliseconds_median: 0.0,
        milliseconds_before: 0.0,
        milliseconds_network: 0.0,
        milliseconds_after: 0.0,
        detections: Vec::new(),
        notes,
    }
}

/// The images of a folder in natural order, or the one image.
fn image_files(images: &Path) -> Result<Vec<PathBuf>, OfflineError> {
    if images.is_file() {
        return Ok(vec![images.to_owned()]);
    }
    let entries = std::fs::read_dir(images).map_err(OfflineError::io(images))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.is_file() && is_image_name(path))
        .collect();
    files.sort_by(|a, b| natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
    if files.is_empty() {
        return Err(OfflineError::NoImages { folder: images.to_owned() });
    }
    Ok(files)
}

/// YOLO labels: class, middle and size as parts of the image's width and height.
fn label_lines(found: &[Detection], size_px: (u32, u32)) -> String {
    let mut text = String::new();
    for Detection { class, area, .. } in found {
        let [x, y, width, height] = area.in_shares(size_px);
        let _ = writeln!(text, "{} {x:.6} {y:.6} {width:.6} {height:.6}", class.0);
    }
    text
}

const CLASSES: &str = "classes.txt";

/// Labels that belong to the images are what detectors are judged by; they are not written over.
fn check_labels(folder: &Path, images: &[PathBuf]) -> Result<(), OfflineError> {
    for image in images {
        let own = label_file_of(image);
        let Some(name) = own.file_name() else { continue };
        let target = folder.join(name);
        if target.exists() {
            files::output(&target, &[&own])?;
        }
        let names = folder.join(CLASSES);
        if names.exists() {
            files::output(&names, &[&own.with_file_name(CLASSES)])?;
        }
    }
    Ok(())
}

/// The names, one per line in order, as labeling tools keep them beside the labels.
fn write_names(folder: &Path, detector: &DetectorInfo) -> Result<(), OfflineError> {
    let path = folder.join(CLASSES);
    let names: String = detector.names.iter().map(|(_, name)| format!("{name}\n")).collect();
    Ok(files::write(&path, names)?)
}

#[cfg(test)]
mod tests {
    use plumbline_model::{ClassIndex, PixelBox};

    use super::*;

    #[test]
    fn labels_are_parts_of_the_image() {
        let found = [Detection {
            class: ClassIndex(3),
            confidence: 0.9,
            area: PixelBox::new(160.0, 120.0, 480.0, 240.0),
        }];
        assert_eq!(label_lines(&found, (640, 480)), "3 0.500000 0.375000 0.500000 0.250000\n");
        assert_eq!(label_lines(&[], (640, 480)), "");
    }

    #[test]
    fn a_folder_without_images_is_said() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("notes.txt"), "no image").expect("writing");
        let error = image_files(folder.path()).expect_err("no image").to_string();
        assert!(error.contains("no images"), "{error}");
    }

    #[test]
    fn images_come_in_natural_order() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["left_10.jpg", "left_2.jpg", "left_1.png"] {
            std::fs::write(folder.path().join(name), "").expect("writing");
        }
        let files = image_files(folder.path()).expect("images");
        let names: Vec<_> = files.iter().filter_map(|file| file.file_name()?.to_str()).collect();
        assert_eq!(names, ["left_1.png", "left_2.jpg", "left_10.jpg"]);
    }
}
