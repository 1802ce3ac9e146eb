//! Why a detector cannot be opened or run.

use std::path::PathBuf;

use super::{Provider, Task};

/// Why a detector cannot be opened or run, and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DetectError {
    /// The library that runs networks was not found.
    #[error(
        "the library ONNX Runtime was not found (looked for {}): run ./plumbline setup, or set ORT_DYLIB_PATH to a libonnxruntime of version 1.24 or newer",
        places(.looked_in)
    )]
    NoLibrary {
        /// Where it was looked for.
        looked_in: Vec<PathBuf>,
    },
    /// A library was found but cannot be used.
    #[error(
        "{} cannot be used as ONNX Runtime ({reason}): run ./plumbline setup, or set ORT_DYLIB_PATH to a libonnxruntime of version 1.24 or newer",
        .path.display()
    )]
    BadLibrary {
        /// The library.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The library has no such execution provider, or it does not work here.
    #[error(
        "{provider} cannot run the detector here ({reason}): choose the processor, or set ORT_DYLIB_PATH to an ONNX Runtime that was built with {provider}"
    )]
    NoProvider {
        /// What was asked for.
        provider: Provider,
        /// Why it cannot be used.
        reason: String,
    },
    /// The file cannot be read.
    #[error("{model} cannot be read ({reason}): check the path and the permissions")]
    NotRead {
        /// The file.
        model: String,
        /// What the system says.
        reason: String,
    },
    /// The file is not a network, or not all of one.
    #[error("{model} is not a usable ONNX file ({reason}): export the detector again with format=onnx")]
    NotOnnx {
        /// The file.
        model: String,
        /// What ONNX Runtime says.
        reason: String,
    },
    /// The network does something else than to detect boxes.
    #[error(
        "{model} is a network for {task}, not for detection: give one that was exported with task=detect"
    )]
    OtherTask {
        /// The file.
        model: String,
        /// What it is for.
        task: Task,
    },
    /// The input is not one color image.
    #[error("{model} does not take one color image ({reason}): export it with three channels and batch=1")]
    Input {
        /// The file.
        model: String,
        /// What it takes instead.
        reason: String,
    },
    /// The output is neither a raw nor an end-to-end head.
    #[error(
        "the output of {model} is not that of a YOLO detector ({reason}): export it with ultralytics, format=onnx"
    )]
    Output {
        /// The file.
        model: String,
        /// What it is instead.
        reason: String,
    },
    /// Another number of classes in the network than names.
    #[error(
        "{model}: the network has {} but {} named ({names}): give the data.yaml that it was trained with, or export it again",
        classes(*.in_network),
        are(*.named)
    )]
    ClassCount {
        /// The file.
        model: String,
        /// Classes in the network.
        in_network: usize,
        /// Names in the file or beside it.
        named: usize,
        /// Them.
        names: String,
    },
    /// The network failed on an image.
    #[error(
        "{model} failed on this image ({reason}): try another file; if it goes on, export the detector again"
    )]
    Run {
        /// The file.
        model: String,
        /// What ONNX Runtime says.
        reason: String,
    },
    /// The network answered with what is no number.
    #[error(
        "{model} answered with {count} values that are no numbers: its weights are damaged, or float16 overflowed; export it again as float32"
    )]
    NotFinite {
        /// The file.
        model: String,
        /// How many values.
        count: usize,
    },
    /// The network named a class that it does not have.
    #[error("{model} answered with class {class}, but it has {}: export it again", classes(*.known))]
    UnknownClass {
        /// The file.
        model: String,
        /// The class, as the network wrote it.
        class: String,
        /// Classes that it has.
        known: usize,
    },
    /// The image has no pixels.
    #[error("the image is {width_px}x{height_px} px, so there is nothing to see: give an image with pixels")]
    EmptyImage {
        /// Width.
        width_px: u32,
        /// Height.
        height_px: u32,
    },
    /// The image cannot be resized to the input.
    #[error("the image of {width_px}x{height_px} px cannot be resized ({reason}): give a smaller image")]
    Resize {
        /// Width.
        width_px: u32,
        /// Height.
        height_px: u32,
        /// What OpenCV says.
        reason: String,
    },
    /// A threshold is out of range.
    #[error("the {name} threshold must be between 0 and 1, not {value}")]
    Threshold {
        /// Which.
        name: &'static str,
        /// What was given.
        value: f32,
    },
}

fn places(paths: &[PathBuf]) -> String {
    paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}

fn classes(count: usize) -> String {
    if count == 1 { "1 class".to_owned() } else { format!("{count} classes") }
}

fn are(count: usize) -> String {
    if count == 1 { "1 is".to_owned() } else { format!("{count} are") }
}
