//! Finds things on images with a YOLO network.
//!
//! Any detector that ultralytics exports to ONNX is run: raw heads of YOLOv8, YOLO11, YOLO12,
//! YOLOv3 and YOLOv3-SPP, end-to-end heads of YOLO26 and of exports with `nms=True`, of any
//! input size, in single or half precision. The network itself is computed by
//! [ONNX Runtime](https://onnxruntime.ai), loaded when the first detector is opened; without that
//! library everything else works.
//!
//! What happens before and after is ours and follows the reference, `predict` of ultralytics 8.4
//! (its documentation and behavior, not its code): letterbox, class thresholds, non-maximum
//! suppression (Dalal and Triggs, 2005), boxes back on the image and clipped to it.
//!
//! One detector belongs to one thread; both eyes are looked at at once by [`EyesDetector`]. After the first images of a size it allocates nothing.

mod detector;
mod error;
mod eyes;
mod filler;
mod heads;
mod info;
mod letterbox;
mod library;
mod names;
mod network;
#[cfg(test)]
mod reference_tests;
mod region;
mod settings;
mod shape;
mod shipped;
mod suppress;

pub use detector::Detector;
pub use error::DetectError;
pub use eyes::{EyesDetector, EyesTiming};
pub use info::{DetectorInfo, Head, InputSize, NamesFrom, Precision, Task};
pub use letterbox::Letterbox;
pub use library::Library;
pub use region::{Part, Region};
pub use settings::{ClassFilter, DetectSettings, DetectTiming, DetectorOptions, Provider};
pub use shipped::{ShippedDetector, shipped_detector};
pub use suppress::{Candidate, suppress};
