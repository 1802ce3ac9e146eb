//! `plumbline detect`: what a detector finds on images.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use plumbline_offline::detector::{ClassFilter, DetectSettings, DetectorOptions, Provider};
use plumbline_offline::{self as offline, DetectArgs, DetectReport};

use super::calibrate::say_notes;
use super::output::Output;

/// Arguments of `detect`.
#[derive(Debug, Args)]
pub struct Detect {
    /// Detector, an ONNX file as ultralytics exports it; else the one that comes with the program.
    #[arg(long, value_name = "FILE.onnx")]
    model: Option<PathBuf>,
    /// Folder of images, or one image.
    #[arg(long, value_name = "DIR")]
    images: PathBuf,
    /// Folder that receives a YOLO label file per image, and classes.txt.
    #[arg(long, value_name = "DIR")]
    labels_out: Option<PathBuf>,
    /// Boxes above this confidence count, 0 to 1.
    #[arg(long, value_name = "PART", default_value_t = 0.25)]
    confidence: f32,
    /// Of boxes of a class that overlap by more than this, intersection over union, one stays.
    #[arg(long, value_name = "PART", default_value_t = 0.7)]
    iou: f32,
    /// At most so many boxes an image.
    #[arg(long, value_name = "N", default_value_t = 300)]
    most: usize,
    /// What computes the network.
    #[arg(long, value_enum, default_value_t)]
    provider: On,
    /// Threads on the processor; else one per core.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// What computes a network.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum On {
    /// The processor.
    #[default]
    Cpu,
    /// A graphics card of NVIDIA.
    Cuda,
    /// The same with TensorRT.
    Tensorrt,
    /// Any graphics card under Windows.
    Directml,
    /// Apple's accelerators.
    Coreml,
}

impl From<On> for Provider {
    fn from(on: On) -> Self {
        match on {
            On::Cpu => Self::Cpu,
            On::Cuda => Self::Cuda,
            On::Tensorrt => Self::TensorRt,
            On::Directml => Self::DirectMl,
            On::Coreml => Self::CoreMl,
        }
    }
}

/// Runs the detector.
pub fn run(arguments: Detect, output: &Output) -> anyhow::Result<()> {
    let settings = DetectSettings {
        confidence: arguments.confidence,
        iou: arguments.iou,
        most: arguments.most,
        classes: ClassFilter::All,
        ..DetectSettings::default()
    };
    let options = DetectorOptions {
        provider: arguments.provider.into(),
        threads: arguments.threads.map(usize::from),
        ..DetectorOptions::default()
    };
    let args = DetectArgs {
        model: arguments.model,
        images: arguments.images,
        labels_out: arguments.labels_out,
        settings,
        options,
    };
    let report = offline::detect(&args, output)?;
    say_notes(&report.notes);
    output.result(&report, text)
}

fn text(report: &DetectReport) -> String {
    let mut text = format!("{}\n", report.detector.summary());
    for (class, name) in report.detector.names.iter() {
        let found = report.detections.iter().filter(|found| found.class_index == class.0);
        let mut images: Vec<&str> = found.clone().map(|found| found.image.as_str()).collect();
        images.dedup();
        text.push_str(&format!("{name}: {} times on {} images\n", found.count(), images.len()));
    }
    text.push_str(&format!(
        "{} images, {:.1} ms each: {:.1} before, {:.1} network, {:.1} after\n",
        report.images,
        report.milliseconds_median,
        report.milliseconds_before,
        report.milliseconds_network,
        report.milliseconds_after,
    ));
    for left_out in &report.left_out {
        text.push_str(&format!("left out: {}\n", left_out.reason));
    }
    text
}
