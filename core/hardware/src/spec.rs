//! Which source, as it is saved, given on a command line, or dropped on the window.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use plumbline_model::Eye;
use serde::{Deserialize, Serialize};

use crate::camera::{CameraSettings, CameraSource, camera_number_at_port, camera_port};
use crate::error::SourceError;
use crate::eye_name::eye_of_name;
use crate::folder::PairFolder;
use crate::folder_source::FolderSource;
use crate::image_file::file_name;
use crate::recording_source::RecordingSource;
use crate::replay::Replay;
use crate::retrying::{RetryPolicy, Retrying};
use crate::source::StereoSource;
use crate::video::VideoSource;

/// Names a source of image pairs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SourceSpec {
    /// Two folders whose images pair by name.
    Folders {
        /// Folder of the left eye.
        left: PathBuf,
        /// Folder of the right eye.
        right: PathBuf,
    },
    /// One folder with both eyes in it, see [`PairFolder::open_one`].
    Folder(PathBuf),
    /// Two video files.
    Videos {
        /// Video of the left eye.
        left: PathBuf,
        /// Video of the right eye.
        right: PathBuf,
    },
    /// A recording, `log.mcap` of a session.
    Recording {
        /// The file.
        file: PathBuf,
        /// Whether it is of the simulated robot.
        of_twin: bool,
    },
    /// The eyes of the simulated robot, which the program itself provides.
    Twin,
    /// Two cameras, by their number N in /dev/videoN.
    Cameras {
        /// Number of the left camera.
        left_index: u32,
        /// Number of the right camera.
        right_index: u32,
    },
}

/// How to open a source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SourceOptions {
    /// For folders and videos.
    pub replay: Replay,
    /// For cameras.
    pub cameras: CameraSettings,
}

/// Opens a source. May take as long as it takes to list a folder or to start two cameras
/// (seconds), so not on a thread that draws.
pub fn open(spec: &SourceSpec, options: &SourceOptions) -> Result<Box<dyn StereoSource>, SourceError> {
    Ok(match spec {
        SourceSpec::Folders { left, right } => {
            Box::new(FolderSource::new(PairFolder::open_two(left, right)?, options.replay)?)
        }
        SourceSpec::Folder(folder) => {
            Box::new(FolderSource::new(PairFolder::open_one(folder)?, options.replay)?)
        }
        SourceSpec::Videos { left, right } => Box::new(VideoSource::open(left, right, options.replay)?),
        SourceSpec::Recording { file, .. } => Box::new(RecordingSource::open(file, options.replay)?),
        SourceSpec::Twin => return Err(SourceError::TwinNotRunning),
        SourceSpec::Cameras { left_index, right_index } => {
            Box::new(CameraSource::open(*left_index, *right_index, options.cameras)?)
        }
    })
}

/// How sources are opened; a twin opens its eyes, and tests everything, in their own way.
pub type Opener = Box<dyn FnMut(&SourceSpec, &SourceOptions) -> Result<Retrying, SourceError> + Send>;

/// Opens a source that comes back by itself after it was lost. A camera that was plugged in
/// again is found at its USB port even if its number changed.
pub fn open_retrying(spec: &SourceSpec, options: &SourceOptions) -> Result<Retrying, SourceError> {
    let ports = match spec {
        SourceSpec::Cameras { left_index, right_index } => {
            [camera_port(*left_index), camera_port(*right_index)]
        }
        _ => [None, None],
    };
    let (spec, options) = (spec.clone(), *options);
    let reopen = move || {
        let number = |port: &Option<String>, usual: u32| {
            port.as_deref().and_then(camera_number_at_port).unwrap_or(usual)
        };
        let spec = match spec {
            SourceSpec::Cameras { left_index, right_index } => SourceSpec::Cameras {
                left_index: number(&ports[0], left_index),
                right_index: number(&ports[1], right_index),
            },
            ref other => other.clone(),
        };
        open(&spec, &options)
    };
    Retrying::open(reopen, RetryPolicy::default())
}

impl SourceSpec {
    /// The source meant by paths dropped on the window or given on a command line: a folder of
    /// pairs, two folders, two videos, or image files (their folder or folders are opened).
    ///
    /// Which of two is the left eye must be in their names.
    pub fn from_paths(paths: &[PathBuf]) -> Result<Self, SourceError> {
        if let Some(missing) = paths.iter().find(|path| !path.exists()) {
            return Err(SourceError::NotASource { found: format!("{} does not exist", missing.display()) });
        }
        match paths {
            [] => Err(SourceError::NotASource { found: "nothing was given".to_owned() }),
            [file] if is_recording(file) => Self::of_recording(file),
            [folder] if folder.join(plumbline_recording::FILE).is_file() => {
                Self::of_recording(&folder.join(plumbline_recording::FILE))
            }
            [folder] if folder.is_dir() => Ok(Self::Folder(folder.clone())),
            [a, b] if a.is_dir() && b.is_dir() => {
                let (left, right) = left_and_right(a, b)?;
                Ok(Self::Folders { left, right })
            }
            [a, b] if is_video(a) && is_video(b) => {
                let (left, right) = left_and_right(a, b)?;
                Ok(Self::Videos { left, right })
            }
            files if files.iter().all(|path| is_image(path)) => Self::from_images(files),
            [video] if is_video(video) => Err(SourceError::NotASource {
                found: format!("{} is the video of one eye only", file_name(video)),
            }),
            [one] => Err(SourceError::NotASource {
                found: format!("{} is neither a folder nor an image nor a video", file_name(one)),
            }),
            many => Err(SourceError::NotASource {
                found: format!("these {} paths do not make a pair of eyes", many.len()),
            }),
        }
    }

    fn of_recording(file: &Path) -> Result<Self, SourceError> {
        let whose = plumbline_recording::Whose::read(file);
        let whose = whose.map_err(|error| SourceError::Recording { problem: error.to_string() })?;
        Ok(Self::Recording { file: file.to_owned(), of_twin: whose.of_twin })
    }

    fn from_images(files: &[PathBuf]) -> Result<Self, SourceError> {
        let folders: BTreeSet<&Path> = files.iter().filter_map(|file| file.parent()).collect();
        let folders: Vec<PathBuf> = folders
            .into_iter()
            .map(|folder| if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.into() })
            .collect();
        match folders.as_slice() {
            [folder] => Ok(Self::Folder(folder.clone())),
            [a, b] => {
                let (left, right) = left_and_right(a, b)?;
                Ok(Self::Folders { left, right })
            }
            many => {
                Err(SourceError::NotASource { found: format!("the images are in {} folders", many.len()) })
            }
        }
    }
}

fn left_and_right(a: &Path, b: &Path) -> Result<(PathBuf, PathBuf), SourceError> {
    let name = |path: &Path| {
        let name = if path.is_dir() { path.file_name() } else { path.file_stem() };
        name.unwrap_or_default().to_string_lossy().into_owned()
    };
    let eye = |path: &Path| eye_of_name(&name(path)).map(|found| found.eye);
    match (eye(a), eye(b)) {
        (Some(Eye::Left), Some(Eye::Right) | None) | (None, Some(Eye::Right)) => Ok((a.into(), b.into())),
        (Some(Eye::Right), Some(Eye::Left) | None) | (None, Some(Eye::Left)) => Ok((b.into(), a.into())),
        _ => Err(SourceError::WhichIsLeft { first: file_name(a), second: file_name(b) }),
    }
}

fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    path.extension().is_some_and(|found| extensions.iter().any(|known| found.eq_ignore_ascii_case(known)))
}

fn is_video(path: &Path) -> bool {
    has_extension(path, &["avi", "mp4", "mkv", "mov", "m4v", "webm", "mpg", "mpeg", "ogv", "mjpeg"])
}

fn is_recording(path: &Path) -> bool {
    has_extension(path, &["mcap"])
}

fn is_image(path: &Path) -> bool {
    has_extension(path, &["png", "jpg", "jpeg"])
}
