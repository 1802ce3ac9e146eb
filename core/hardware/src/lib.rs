//! Where image pairs come from: a pair of cameras, a folder of pairs, a pair of videos, or
//! memory. All are a [`StereoSource`], so that live eyes and a recording are the same thing
//! to their caller.
//!
//! - [`SourceSpec`] names a source (it can be saved, and made from dropped paths);
//!   [`open`] opens it, [`Retrying`] keeps it open when it disappears and comes back.
//! - [`PairFolder`] gives random access to a folder of pairs, for jobs that want all of them.
//! - [`load_image`] reads one image file into 8-bit RGB and says what is wrong with a bad one.
//! - [`camera_devices`] and [`probe_camera`] tell which cameras this machine has, [`opencv_info`]
//!   which OpenCV.

pub mod camera;
mod cv;
pub mod dynamixel;
mod error;
mod eye_name;
mod folder;
mod folder_source;
mod image_file;
pub mod joints;
mod jpeg;
mod memory;
mod natural_order;
mod pair_by_time;
mod playback;
mod recording_source;
mod replay;
mod retrying;
mod source;
mod spec;
mod video;

pub use camera::{CameraDevice, CameraProbe, CameraSettings, camera_devices, probe_camera};
pub use cv::{OpenCvInfo, opencv_info};
pub use error::{PairProblem, SourceError};
pub use folder::{LoadedPair, PairFiles, PairFolder};
pub use folder_source::FolderSource;
pub use image_file::{ImageNote, ImageProblem, LoadedImage, load_image};
pub use jpeg::{QUALITY, encode as encode_jpeg};
pub use memory::MemorySource;
pub use natural_order::natural_order;
pub use recording_source::RecordingSource;
pub use replay::{Replay, ReplayRate};
pub use retrying::{Lost, RetryPolicy, Retrying, SourceStatus};
pub use source::{Counters, FiniteSource, Growth, Next, Report, SourceDescription, SourceKind, StereoSource};
pub use spec::{Opener, SourceOptions, SourceSpec, open, open_retrying};
pub use video::VideoSource;
