//! Calibrations of the eyes in every format, mounts, detectors, labeled sets.

use std::path::{Path, PathBuf};

use plumbline_model::formats::{LengthUnit, ReadOptions};
use plumbline_model::{AimedPair, StereoCalibration, Unattended, Workspace};
use plumbline_vision::calibration_file;
use plumbline_vision::detect::{DetectSettings, Detector, DetectorOptions};
use plumbline_vision::mount::MountCalibration;
use plumbline_vision::yolo_set::{Split, YoloSet};

use super::model::nico;
use super::{Reader, one};
use crate::check::Heard;

pub fn readers() -> Vec<Reader> {
    vec![
        one("calibration-native", &["cameras/native.yaml"], 40, |folder| {
            cameras(folder, &["cameras/native.yaml"])
        }),
        one("calibration-bare", &["cameras/bare.yaml"], 40, |folder| cameras(folder, &["cameras/bare.yaml"])),
        one("calibration-kalibr", &["cameras/kalibr.yaml"], 40, |folder| {
            cameras(folder, &["cameras/kalibr.yaml"])
        }),
        one("calibration-ros", &["cameras/ros-left.yaml", "cameras/ros-right.yaml"], 40, |folder| {
            cameras(folder, &["cameras/ros-left.yaml", "cameras/ros-right.yaml"])
        }),
        one("calibration-opencv-yaml", &["cameras/opencv.yaml"], 40, |folder| {
            cameras(folder, &["cameras/opencv.yaml"])
        }),
        one("calibration-opencv-xml", &["cameras/opencv.xml"], 40, |folder| {
            cameras(folder, &["cameras/opencv.xml"])
        }),
        one("pinhole-kalibr", &["cameras/pinhole-kalibr.yaml"], 20, |folder| {
            cameras(folder, &["cameras/pinhole-kalibr.yaml"])
        }),
        one(
            "pinhole-ros",
            &["cameras/pinhole-ros-left.yaml", "cameras/pinhole-ros-right.yaml"],
            20,
            |folder| cameras(folder, &["cameras/pinhole-ros-left.yaml", "cameras/pinhole-ros-right.yaml"]),
        ),
        one("pinhole-opencv", &["cameras/pinhole-opencv.yaml"], 20, |folder| {
            cameras(folder, &["cameras/pinhole-opencv.yaml"])
        }),
        one("calibration-in-millimeters", &["cameras/millimeters.yaml"], 15, |folder| {
            let options = ReadOptions {
                length_unit: Some(LengthUnit::Millimeters),
                image_size_px: Some((640, 480)),
                ..ReadOptions::default()
            };
            used(calibration_file::load_with(&[folder.join("cameras/millimeters.yaml")], &options))
        }),
        one("mount", &["mount/mount.toml"], 30, |folder| {
            MountCalibration::read(&folder.join("mount/mount.toml"), &nico()).into()
        }),
        one("detector-raw", &["detectors/raw.onnx"], 6, |folder| {
            detector(&folder.join("detectors/raw.onnx"))
        }),
        one("detector-end-to-end", &["detectors/end-to-end.onnx"], 6, |folder| {
            detector(&folder.join("detectors/end-to-end.onnx"))
        }),
        one("detector-seeing", &["detectors/seeing.onnx"], 6, |folder| {
            detector(&folder.join("detectors/seeing.onnx"))
        }),
        one("detector-open-shape", &["detectors/open-shape.onnx"], 6, |folder| {
            detector(&folder.join("detectors/open-shape.onnx"))
        }),
        one("detector-float16", &["detectors/float16.onnx"], 6, |folder| {
            detector(&folder.join("detectors/float16.onnx"))
        }),
        Reader {
            changed: &["detectors/data.yaml"],
            ..one("detector-names", &["detectors/end-to-end.onnx", "detectors/data.yaml"], 6, |folder| {
                detector(&folder.join("detectors/end-to-end.onnx"))
            })
        },
        one("label-set", &["labels/"], 50, label_set),
    ]
}

fn cameras(folder: &Path, files: &[&str]) -> Heard {
    let files: Vec<PathBuf> = files.iter().map(|file| folder.join(file)).collect();
    used(calibration_file::load(&files))
}

/// A calibration is also aimed at the table.
fn used(calibration: Result<StereoCalibration, plumbline_model::FormatError>) -> Heard {
    match calibration {
        Err(error) => Heard::refused(error),
        Ok(calibration) => {
            let aimed = AimedPair::suited(&calibration.cameras, &Workspace::default());
            let told = aimed.as_ref().err().map(ToString::to_string);
            Heard::accepted((&calibration, aimed.ok())).and(told)
        }
    }
}

/// A detector is also shown an image.
fn detector(file: &Path) -> Heard {
    let options = DetectorOptions { threads: Some(1), ..DetectorOptions::default() };
    match Detector::open(file, &options) {
        Err(error) => Heard::refused(error),
        Ok(mut detector) => {
            let image = image::RgbImage::from_pixel(32, 24, image::Rgb([90, 120, 30]));
            let mut found = vec![];
            match detector.detect(&image, &DetectSettings::default(), &mut found) {
                Ok(_) => Heard::accepted(&found),
                Err(error) => Heard::refused(error),
            }
        }
    }
}

fn label_set(folder: &Path) -> Heard {
    let data_yaml = folder.join("labels/data.yaml");
    let strict = YoloSet::read_all(&data_yaml);
    match YoloSet::survey(&data_yaml, &Split::ALL, &Unattended) {
        Err(error) => Heard::refused(error),
        Ok(survey) => Heard::accepted(&survey)
            .and(survey.problems.iter().map(ToString::to_string))
            .and(strict.err().map(|error| error.to_string())),
    }
}
