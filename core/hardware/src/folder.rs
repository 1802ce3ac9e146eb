//! A folder of image pairs with random access, for jobs that want every pair.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use image::RgbImage;
use plumbline_model::Eye;

use crate::error::{PairProblem, SourceError};
use crate::eye_name::eye_of_name;
use crate::image_file::{ImageNote, file_name, image_size, load_image};
use crate::natural_order::natural_order;
use crate::source::Report;

/// Two files that show the same moment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairFiles {
    /// Name of the pair: the left file's name.
    pub name: String,
    /// Image of the left eye.
    pub left: PathBuf,
    /// Image of the right eye.
    pub right: PathBuf,
}

/// Both images of a pair, read.
#[derive(Clone, Debug)]
pub struct LoadedPair {
    /// Image of the left eye.
    pub left: RgbImage,
    /// Image of the right eye, of the same size.
    pub right: RgbImage,
    /// Conversions, with the file's name.
    pub notes: Vec<(String, ImageNote)>,
}

/// The pairs of a folder, in natural order of their names.
#[derive(Clone, Debug)]
pub struct PairFolder {
    left: PathBuf,
    right: PathBuf,
    pairs: Vec<PairFiles>,
    image_size: Option<(u32, u32)>,
    reports: Vec<Report>,
}

impl PairFolder {
    /// Pairs from two folders. Images with the same file name belong together; those left
    /// over belong together if their names agree up to extension and the word left or right.
    pub fn open_two(left: &Path, right: &Path) -> Result<Self, SourceError> {
        let left_files = image_files(left)?;
        let right_files = image_files(right)?;
        if left.canonicalize().ok().is_some_and(|path| right.canonicalize().ok() == Some(path)) {
            return Err(SourceError::SameForBothEyes { path: left.to_path_buf() });
        }
        refuse_exchanged(Eye::Left, left, &left_files.images)?;
        refuse_exchanged(Eye::Right, right, &right_files.images)?;
        let mut reports = left_files.ignored;
        reports.extend(right_files.ignored);
        Self::join(left, right, left_files.images, right_files.images, reports)
    }

    /// Pairs from one folder: with subfolders `left` and `right` (also below `stereo`, as in
    /// a session), or with the eye in the names of its files. One of the two subfolders will
    /// do as well: the other is found beside it.
    pub fn open_one(folder: &Path) -> Result<Self, SourceError> {
        if let Some((left, right)) = eye_subfolders(folder)? {
            return Self::open_two(&left, &right);
        }
        let session = folder.join("stereo");
        if session.is_dir()
            && let Some((left, right)) = eye_subfolders(&session)?
        {
            return Self::open_two(&left, &right);
        }
        let files = image_files(folder).map_err(|error| unless_data_set(folder, error))?;
        let mut reports = files.ignored;
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for file in files.images {
            match eye_of_name(&stem(&file)).map(|name| name.eye) {
                Some(Eye::Left) => left.push(file),
                Some(Eye::Right) => right.push(file),
                None => reports.push(Report::Ignored {
                    file: file_name(&file),
                    reason: "its name does not say left or right; rename it like left_01.png".to_owned(),
                }),
            }
        }
        if left.is_empty() || right.is_empty() {
            if let Some((left, right)) = with_sibling(folder) {
                return Self::open_two(&left, &right);
            }
            return Err(unless_data_set(folder, SourceError::NoLayout { path: folder.to_path_buf() }));
        }
        Self::join(folder, folder, left, right, reports)
    }

    fn join(
        left_folder: &Path,
        right_folder: &Path,
        left: Vec<PathBuf>,
        right: Vec<PathBuf>,
        mut reports: Vec<Report>,
    ) -> Result<Self, SourceError> {
        let examples = (left.first().map(|f| file_name(f)), right.first().map(|f| file_name(f)));
        let mut matching = Matching { left, right, pairs: Vec::new() };
        matching.join_by(|path, _| Some(file_name(path)));
        matching.join_by(|path, _| Some(stem(path)));
        matching.join_by(|path, eye| {
            eye_of_name(&stem(path)).filter(|name| name.eye == eye).map(|name| name.rest)
        });
        let Matching { left, right, mut pairs } = matching;
        if pairs.is_empty() {
            return Err(SourceError::NoPairs {
                left: left_folder.to_path_buf(),
                right: right_folder.to_path_buf(),
                left_example: examples.0.unwrap_or_default(),
                right_example: examples.1.unwrap_or_default(),
            });
        }
        for (eye, files) in [(Eye::Left, left), (Eye::Right, right)] {
            if !files.is_empty() {
                reports.push(Report::Unpaired {
                    eye,
                    files: files.iter().map(|path| shown_name(path)).collect(),
                });
            }
        }
        pairs.sort_by(|a, b| natural_order(&a.name, &b.name));
        Ok(Self {
            left: left_folder.to_path_buf(),
            right: right_folder.to_path_buf(),
            image_size: most_common_size(&pairs),
            pairs,
            reports,
        })
    }

    /// The pairs in natural order of their names.
    pub fn pairs(&self) -> &[PairFiles] {
        &self.pairs
    }

    /// Width and height that most of the images have, in pixels; `None` if no file's head
    /// could be read.
    pub fn image_size(&self) -> Option<(u32, u32)> {
        self.image_size
    }

    /// Files without a partner and files left out, found when the folder was opened.
    pub fn reports(&self) -> &[Report] {
        &self.reports
    }

    /// Folder of the left and of the right eye (may be the same).
    pub fn folders(&self) -> (&Path, &Path) {
        (&self.left, &self.right)
    }

    /// Where the pairs are, in short.
    pub fn title(&self) -> String {
        let parent = self.left.parent().unwrap_or(Path::new(""));
        let place = if self.left == self.right {
            self.left.display().to_string()
        } else if self.right.parent() == Some(parent) && parent != Path::new("") {
            parent.display().to_string()
        } else {
            format!("{} and {}", self.left.display(), self.right.display())
        };
        let plural = if self.pairs.len() == 1 { "pair" } else { "pairs" };
        format!("{} {plural} in {place}", self.pairs.len())
    }

    /// Reads both images of a pair and checks that they fit each other and the folder.
    pub fn load(&self, pair: &PairFiles) -> Result<LoadedPair, PairProblem> {
        let read = |eye, path: &Path| load_image(path).map_err(|problem| PairProblem::Image { eye, problem });
        let left = read(Eye::Left, &pair.left)?;
        let right = read(Eye::Right, &pair.right)?;
        let (left_size, right_size) = (left.image.dimensions(), right.image.dimensions());
        if left_size != right_size {
            return Err(PairProblem::EyesDiffer { left: left_size, right: right_size });
        }
        if let Some(expected) = self.image_size
            && left_size != expected
        {
            return Err(PairProblem::SizeChanged { size: left_size, expected });
        }
        let named = |path: &Path, notes: Vec<ImageNote>| {
            let name = shown_name(path);
            notes.into_iter().map(move |note| (name.clone(), note))
        };
        let notes = named(&pair.left, left.notes).chain(named(&pair.right, right.notes)).collect();
        Ok(LoadedPair { left: left.image, right: right.image, notes })
    }
}

struct ImageFiles {
    images: Vec<PathBuf>,
    ignored: Vec<Report>,
}

/// Image files of a folder in natural order. Files that are no images are passed over in
/// silence (notes, calibration files); images of a kind that is not read are reported.
fn image_files(folder: &Path) -> Result<ImageFiles, SourceError> {
    let mut found = ImageFiles { images: Vec::new(), ignored: Vec::new() };
    for path in entries(folder)? {
        // Hidden files are the operating system's, also those called `._frame.png`.
        if file_name(&path).starts_with('.') || !path.is_file() {
            continue;
        }
        match path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).as_deref() {
            Some("png" | "jpg" | "jpeg") => found.images.push(path),
            Some("bmp" | "tif" | "tiff" | "pgm" | "ppm" | "pnm" | "webp" | "gif") => {
                found.ignored.push(Report::Ignored {
                    file: shown_name(&path),
                    reason: "this kind of image is not read; save it as PNG or JPEG".to_owned(),
                });
            }
            _ => {}
        }
    }
    if found.images.is_empty() {
        return Err(SourceError::NoImages { path: folder.to_path_buf() });
    }
    Ok(found)
}

/// What is in a folder, in natural order.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, SourceError> {
    let failed = |error: std::io::Error| SourceError::folder(folder, &error);
    let mut paths = std::fs::read_dir(folder)
        .map_err(failed)?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(failed)?;
    paths.sort_by(|a, b| natural_order(&file_name(a), &file_name(b)));
    Ok(paths)
}

/// The one subfolder whose name says left and the one that says right.
fn eye_subfolders(folder: &Path) -> Result<Option<(PathBuf, PathBuf)>, SourceError> {
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for path in entries(folder)?.into_iter().filter(|path| path.is_dir()) {
        match eye_of_name(&file_name(&path)).map(|name| name.eye) {
            Some(Eye::Left) => left.push(path),
            Some(Eye::Right) => right.push(path),
            None => {}
        }
    }
    // A folder called exactly `left` wins over `left_masks` beside it.
    Ok(best(left, "left").zip(best(right, "right")))
}

/// For a folder called `left` (or `right`): the two folders of its parent.
fn with_sibling(folder: &Path) -> Option<(PathBuf, PathBuf)> {
    let folder = folder.canonicalize().ok()?;
    let both = eye_subfolders(folder.parent()?).ok()??;
    (both.0 == folder || both.1 == folder).then_some(both)
}

fn best(folders: Vec<PathBuf>, plain: &str) -> Option<PathBuf> {
    let exact = folders.iter().find(|path| file_name(path).eq_ignore_ascii_case(plain)).cloned();
    exact.or_else(|| <[PathBuf; 1]>::try_from(folders).ok().map(|[only]| only))
}

/// Why a folder is no source: what is in it says more than what is not.
fn unless_data_set(folder: &Path, error: SourceError) -> SourceError {
    let lacks_pairs = matches!(error, SourceError::NoImages { .. } | SourceError::NoLayout { .. });
    match lacks_pairs && folder.join("data.yaml").is_file() {
        true => SourceError::DataSet { path: folder.to_path_buf() },
        false => error,
    }
}

/// Refuses a folder most of whose files say that they are the other eye's.
fn refuse_exchanged(eye: Eye, folder: &Path, files: &[PathBuf]) -> Result<(), SourceError> {
    let wrong =
        files.iter().filter(|file| eye_of_name(&stem(file)).is_some_and(|name| name.eye != eye)).count();
    if wrong * 2 > files.len() {
        return Err(SourceError::EyesExchanged { eye, path: folder.to_path_buf() });
    }
    Ok(())
}

/// Files that still look for a partner.
struct Matching {
    left: Vec<PathBuf>,
    right: Vec<PathBuf>,
    pairs: Vec<PairFiles>,
}

impl Matching {
    /// Joins left and right files that have the same key; a file without a key waits.
    fn join_by(&mut self, key: impl Fn(&Path, Eye) -> Option<String>) {
        let mut partners: HashMap<String, Vec<PathBuf>> = HashMap::new();
        let mut waiting_right = Vec::new();
        // Backwards, so that `pop` hands out the first of several with the same key.
        for path in self.right.drain(..).rev() {
            match key(&path, Eye::Right) {
                Some(key) => partners.entry(key).or_default().push(path),
                None => waiting_right.push(path),
            }
        }
        let mut waiting_left = Vec::new();
        for path in self.left.drain(..) {
            let partner = key(&path, Eye::Left).and_then(|key| partners.get_mut(&key)?.pop());
            match partner {
                Some(right) => {
                    self.pairs.push(PairFiles { name: file_name(&path), left: path, right });
                }
                None => waiting_left.push(path),
            }
        }
        waiting_right.extend(partners.into_values().flatten());
        waiting_right.sort_by(|a, b| natural_order(&file_name(a), &file_name(b)));
        (self.left, self.right) = (waiting_left, waiting_right);
    }
}

/// Size of most images, looked up in the heads of at most a hundred pairs; of two sizes as
/// frequent, the one that comes first.
fn most_common_size(pairs: &[PairFiles]) -> Option<(u32, u32)> {
    const LOOKED_AT: usize = 100;
    let mut counts: Vec<((u32, u32), usize)> = Vec::new();
    for pair in pairs.iter().step_by(pairs.len().div_ceil(LOOKED_AT).max(1)) {
        for size in [&pair.left, &pair.right].into_iter().filter_map(|path| image_size(path)) {
            match counts.iter_mut().find(|(known, _)| *known == size) {
                Some((_, count)) => *count += 1,
                None => counts.push((size, 1)),
            }
        }
    }
    let most = counts.iter().map(|(_, count)| *count).max()?;
    counts.into_iter().find(|(_, count)| *count == most).map(|(size, _)| size)
}

/// File name with its folder's, because both eyes' files often have the same name.
fn shown_name(path: &Path) -> String {
    match path.parent().and_then(Path::file_name) {
        Some(folder) => format!("{}/{}", folder.to_string_lossy(), file_name(path)),
        None => file_name(path),
    }
}

/// File name without its last extension.
fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
