//! What can go wrong with a source, and with one pair of it.

use std::path::{Path, PathBuf};

use plumbline_model::Eye;

use crate::image_file::ImageProblem;

/// A source cannot be opened, or is gone.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SourceError {
    /// No such folder.
    #[error(
        "the folder {} does not exist: check the path, and whether the disk that holds it is connected",
        .path.display()
    )]
    NoSuchFolder {
        /// The path asked for.
        path: PathBuf,
    },
    /// A file where a folder was expected.
    #[error("{} is not a folder: give the folder that holds the images", .path.display())]
    NotAFolder {
        /// The path asked for.
        path: PathBuf,
    },
    /// A folder that exists but cannot be listed.
    #[error("the folder {} cannot be read ({detail}): check its permissions", .path.display())]
    Unreadable {
        /// The folder.
        path: PathBuf,
        /// What the operating system says.
        detail: String,
    },
    /// No PNG or JPEG in the folder.
    #[error(
        "the folder {} holds no PNG or JPEG image: choose the folder with the image files in it",
        .path.display()
    )]
    NoImages {
        /// The folder.
        path: PathBuf,
    },
    /// The folder's layout was not recognized.
    #[error(
        "no pairs were recognized in {}: it needs subfolders named left and right, or files named like left_01.png and right_01.png; otherwise open the left and the right folder separately",
        .path.display()
    )]
    NoLayout {
        /// The folder.
        path: PathBuf,
    },
    /// A folder of single images with boxes.
    #[error("{} is a data set for detectors, not a source of pairs: open it in Detect, Images", .path.display())]
    DataSet {
        /// The folder.
        path: PathBuf,
    },
    /// Two folders with images, none of which belong together.
    #[error(
        "no image of {} has a partner in {}: the images of a pair must have the same name in both folders (found {left_example} and {right_example})",
        .left.display(), .right.display()
    )]
    NoPairs {
        /// Folder of the left eye.
        left: PathBuf,
        /// Folder of the right eye.
        right: PathBuf,
        /// A left file name.
        left_example: String,
        /// A right file name.
        right_example: String,
    },
    /// The same folder or file for both eyes.
    #[error("{} was given for both eyes: give one for the left and another for the right", .path.display())]
    SameForBothEyes {
        /// The path.
        path: PathBuf,
    },
    /// File names say that the folders or videos were given the wrong way round.
    #[error(
        "the names in {} say {}, but it was given for the {eye} eye: give the two the other way round",
        .path.display(), other(.eye)
    )]
    EyesExchanged {
        /// The eye it was given for.
        eye: Eye,
        /// The folder or file.
        path: PathBuf,
    },
    /// What was dropped or given cannot be made into a source.
    #[error(
        "{found}: give a folder of pairs, the left and the right folder, or the left and the right video"
    )]
    NotASource {
        /// What was given instead.
        found: String,
    },
    /// The twin's eyes, which exist only while the twin runs.
    #[error("the twin is not running, so it has no eyes: connect to the twin first")]
    TwinNotRunning,
    /// Two folders or files whose names do not say which eye they are.
    #[error(
        "the names {first} and {second} do not say which is the left eye: name them left and right, or open each by its own button"
    )]
    WhichIsLeft {
        /// First name.
        first: String,
        /// Second name.
        second: String,
    },
    /// A video file that cannot be used.
    #[error("the video {} cannot be played: {problem}", .path.display())]
    Video {
        /// The file.
        path: PathBuf,
        /// Why, and what to do.
        problem: String,
    },
    /// A recording that cannot be used.
    #[error("{problem}")]
    Recording {
        /// Why, and what to do.
        problem: String,
    },
    /// A camera that cannot be used.
    #[error("the {eye} camera (number {index}) cannot be used: {problem}")]
    Camera {
        /// Which eye.
        eye: Eye,
        /// Camera number, N of /dev/videoN.
        index: u32,
        /// Why, and what to do.
        problem: String,
    },
    /// Same camera number for both eyes.
    #[error("camera {index} was given for both eyes: give two different camera numbers")]
    SameCamera {
        /// The number.
        index: u32,
    },
    /// A source that worked and is gone.
    #[error("{reason}")]
    Lost {
        /// Why, and what to do.
        reason: String,
    },
    /// No pair of the recording can be used.
    #[error("none of the {pairs} pairs can be used; the first one fails because {first}")]
    NothingUsable {
        /// Number of pairs tried.
        pairs: usize,
        /// What is wrong with the first.
        first: String,
    },
    /// A position beyond the end.
    #[error("there is no pair number {index}: the source has {pairs}, counted from 0")]
    NoSuchPair {
        /// Asked for.
        index: usize,
        /// Number of pairs.
        pairs: usize,
    },
    /// Not a replay rate.
    #[error("{rate_hz} is not a replay rate: give between 0.01 and 1000 pairs per second")]
    ReplayRate {
        /// Asked for.
        rate_hz: f64,
    },
    /// A time limit for pairing, or another camera setting, out of range.
    #[error("the camera setting {setting} cannot be used: {problem}")]
    CameraSetting {
        /// Which.
        setting: &'static str,
        /// Why, and what to give.
        problem: String,
    },
    /// The operating system refused a thread.
    #[error("no thread could be started ({0}): close other programs and open the source again")]
    NoThread(String),
}

/// One pair that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PairProblem {
    /// One of its images.
    #[error("{eye} image {problem}")]
    Image {
        /// Which eye.
        eye: Eye,
        /// What is wrong with it.
        problem: ImageProblem,
    },
    /// The two images differ in size.
    #[error(
        "the left image is {}x{} px and the right {}x{} px: both eyes must be recorded at the same size",
        .left.0, .left.1, .right.0, .right.1
    )]
    EyesDiffer {
        /// Left width and height, pixels.
        left: (u32, u32),
        /// Right width and height, pixels.
        right: (u32, u32),
    },
    /// Both images have another size than the other pairs.
    #[error(
        "its images are {}x{} px while the others are {}x{} px: keep pairs of different sizes in different folders",
        .size.0, .size.1, .expected.0, .expected.1
    )]
    SizeChanged {
        /// Width and height of this pair, pixels.
        size: (u32, u32),
        /// Width and height of the source, pixels.
        expected: (u32, u32),
    },
}

impl SourceError {
    /// A folder that cannot be listed, told apart by cause.
    pub(crate) fn folder(path: &Path, error: &std::io::Error) -> Self {
        let path = path.to_path_buf();
        match error.kind() {
            std::io::ErrorKind::NotFound => Self::NoSuchFolder { path },
            std::io::ErrorKind::NotADirectory => Self::NotAFolder { path },
            _ => Self::Unreadable { path, detail: error.to_string() },
        }
    }
}

/// The eye that is not `eye`.
pub(crate) fn other(eye: &Eye) -> Eye {
    match eye {
        Eye::Left => Eye::Right,
        Eye::Right => Eye::Left,
    }
}
