//! Data sets on disk, in the YOLO layout so that nothing is locked in: `data.yaml` with the classes
//! in order, `images`, `labels`. Beside them `to-check.txt` names the images that somebody wants to
//! look at again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use plumbline_model::files::{self, Size};
use plumbline_model::{ClassNames, JobContext, counted};
use plumbline_vision::yolo_set::{LabelProblem, RowProblem, Split, YoloSet, label_file_of, scene_of};

use super::view::LabelBox;
use crate::ground::jobs::JobError;
use crate::ground::text::sentence;

const DATA_YAML: &str = "data.yaml";
const TO_CHECK: &str = "to-check.txt";

/// A data set as it was read.
#[derive(Clone, Debug)]
pub struct OpenedSet {
    /// Its folder: where `data.yaml` is.
    pub folder: PathBuf,
    /// Its classes.
    pub names: ClassNames,
    /// Its images in order: scenes by name, left eye first.
    pub entries: Vec<Entry>,
    /// What is left out or odd, a sentence each.
    pub problems: Vec<String>,
}

/// An image of a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its name, unique in the set.
    pub name: String,
    /// What it shows: the same for both eyes of a pair.
    pub scene: String,
    /// The image.
    pub image: PathBuf,
    /// Its boxes.
    pub label_file: PathBuf,
    /// Width and height; zero when it cannot be read.
    pub size_px: (u32, u32),
    /// The boxes as they are on disk.
    pub boxes: Vec<LabelBox>,
    /// Whether it has a label file.
    pub labeled: bool,
    /// Whether it is marked to be looked at again.
    pub to_check: bool,
    /// Why its boxes must not be changed, a sentence: its label file says something that would be lost.
    pub locked: Option<String>,
    /// Why the image cannot be shown, a sentence.
    pub unusable: Option<String>,
}

/// The `data.yaml` that a path means: a file, or one in a folder.
pub fn data_yaml_of(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(DATA_YAML) } else { path.to_owned() }
}

/// Reads a data set.
///
/// # Errors
/// A sentence.
pub fn open(path: &Path, context: &dyn JobContext) -> Result<OpenedSet, JobError> {
    let data_yaml = data_yaml_of(path);
    if !data_yaml.is_file() {
        return Err(JobError::failed(format!(
            "{} has no data.yaml, so it is no data set. Choose the folder of one, or make a new data set there.",
            path.display()
        )));
    }
    let survey = YoloSet::survey(&data_yaml, &Split::ALL, context).map_err(failed)?;
    let folder = data_yaml.parent().unwrap_or(Path::new("")).to_owned();
    let to_check = read_to_check(&folder);
    let mut by_file: BTreeMap<PathBuf, Vec<LabelProblem>> = BTreeMap::new();
    for problem in survey.problems {
        by_file.entry(problem.file.clone()).or_default().push(problem);
    }
    let mut entries = Vec::with_capacity(survey.set.images.len());
    for image in survey.set.images {
        let label_file = label_file_of(&image.path);
        let locked = by_file.remove(&label_file).map(|problems| locked(&problems));
        let boxes = image.boxes.iter().map(|b| LabelBox { class: b.class, area: b.area }).collect();
        let mut entry = entry_of(&folder, image.path, image.scene, image.size_px, boxes);
        entry.labeled = label_file.exists();
        entry.to_check = to_check.contains(&entry.name);
        entry.locked = locked;
        entries.push(entry);
    }
    let mut problems = Vec::new();
    for (file, of_file) in by_file {
        let text = sentence(&of_file[0].to_string());
        match of_file[0].what {
            // An image that cannot be read stays in the list, so that it is seen which one.
            RowProblem::BadImage { .. } => entries.push(unusable(&folder, file, text)),
            _ => problems.push(text),
        }
    }
    if survey.repeated_rows > 0 {
        let rows = counted(survey.repeated_rows, "row");
        problems.push(format!("Standing twice in the label file, and counting once: {rows}."));
    }
    if survey.polygons > 0 {
        problems.push(format!(
            "{} outlines are taken for the boxes around them; changing an image writes boxes.",
            survey.polygons
        ));
    }
    sort(&mut entries);
    make_names_unique(&mut entries, &folder);
    Ok(OpenedSet { folder, names: survey.set.names, entries, problems })
}

fn locked(problems: &[LabelProblem]) -> String {
    let more = if problems.len() > 1 { format!(" ({} more)", problems.len() - 1) } else { String::new() };
    format!(
        "Boxes of this image cannot be changed: {}{more}. Correct or delete that file, then open the data set again.",
        problems[0]
    )
}

/// An image with boxes, its label file where the layout wants it.
pub fn entry_of(
    folder: &Path,
    image: PathBuf,
    scene: String,
    size_px: (u32, u32),
    boxes: Vec<LabelBox>,
) -> Entry {
    let name = short_name(&image, folder, false);
    let label_file = label_file_of(&image);
    let (labeled, to_check) = (false, false);
    Entry { name, scene, image, label_file, size_px, boxes, labeled, to_check, locked: None, unusable: None }
}

fn unusable(folder: &Path, image: PathBuf, why: String) -> Entry {
    let scene = scene_of(&image);
    Entry { unusable: Some(why), ..entry_of(folder, image, scene, (0, 0), Vec::new()) }
}

/// Scenes by name, which sorts time stamps by time; the left eye first.
pub fn sort(entries: &mut [Entry]) {
    let is_right = |entry: &Entry| entry.name.to_lowercase().contains("right");
    entries.sort_by(|a, b| (&a.scene, is_right(a), &a.image).cmp(&(&b.scene, is_right(b), &b.image)));
}

/// File name without extension; with the folder where that is needed to tell images apart.
fn short_name(image: &Path, folder: &Path, whole: bool) -> String {
    let path = if whole {
        image.strip_prefix(folder).unwrap_or(image)
    } else {
        Path::new(image.file_name().unwrap_or_default())
    };
    path.with_extension("").to_string_lossy().into_owned()
}

fn make_names_unique(entries: &mut [Entry], folder: &Path) {
    let mut seen = BTreeSet::new();
    let doubled: BTreeSet<String> = entries
        .iter()
        .filter(|entry| !seen.insert(entry.name.clone()))
        .map(|entry| entry.name.clone())
        .collect();
    for entry in entries.iter_mut().filter(|entry| doubled.contains(&entry.name)) {
        entry.name = short_name(&entry.image, folder, true);
    }
}

/// Makes a data set without images.
///
/// # Errors
/// A sentence.
pub fn create(folder: &Path, names: &ClassNames) -> Result<(), JobError> {
    if names.is_empty() {
        return Err(JobError::failed("A data set needs at least one class. Name one."));
    }
    if let Some((class, name)) = names.iter().find(|(class, name)| {
        name.trim().is_empty() || name.chars().any(char::is_control) || names.index_of(name) != Some(*class)
    }) {
        return Err(JobError::failed(format!(
            "Class {} is called \"{name}\", which is empty or there already. Give every class a name of its own.",
            class.0 + 1
        )));
    }
    if std::fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
        return Err(JobError::failed(format!(
            "{} is not empty. Open the data set in it, or choose an empty folder for a new one.",
            folder.display()
        )));
    }
    for part in ["images", "labels"] {
        let part = folder.join(part);
        std::fs::create_dir_all(&part).map_err(|error| cannot(&part, &error))?;
    }
    let mut text = "train: images\nval: images\n".to_owned();
    text += &format!("nc: {}\nnames:\n", names.len());
    for (class, name) in names.iter() {
        text += &format!("  {}: '{}'\n", class.0, name.replace('\'', "''"));
    }
    write(&folder.join(DATA_YAML), &text)
}

/// Names of images to be looked at again.
fn read_to_check(folder: &Path) -> BTreeSet<String> {
    let text = files::read_text(&folder.join(TO_CHECK), Size::TEXT).unwrap_or_default();
    text.lines().map(|line| line.trim().to_owned()).filter(|line| !line.is_empty()).collect()
}

/// The list of images to be looked at again, as a file to write.
pub fn to_check_file<'a>(folder: &Path, names: impl Iterator<Item = &'a str>) -> (PathBuf, String) {
    (folder.join(TO_CHECK), names.map(|name| format!("{name}\n")).collect())
}

/// Writes a text in one step: whoever reads it sees the old one or the new one.
///
/// # Errors
/// A sentence.
pub fn write(file: &Path, text: &str) -> Result<(), JobError> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder).map_err(|error| cannot(folder, &error))?;
    }
    files::write(file, text).map_err(|error| JobError::failed(sentence(&error.to_string())))
}

/// That a file cannot be written.
pub fn cannot(file: &Path, reason: &dyn std::fmt::Display) -> JobError {
    JobError::failed(format!(
        "{} cannot be written ({reason}). Check that the disk has free space and the folder can be written.",
        file.display()
    ))
}

/// A sentence of an error of the data set.
pub fn failed(error: plumbline_vision::yolo_set::YoloSetError) -> JobError {
    match error {
        plumbline_vision::yolo_set::YoloSetError::Cancelled(cancelled) => cancelled.into(),
        other => JobError::failed(sentence(&other.to_string())),
    }
}
