//! Writing a set, and adding to one.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use plumbline_model::JobContext;
use plumbline_model::files::{self, Replacement, Size};

use super::data_yaml::{DataYaml, check_names, text as data_yaml_text};
use super::images::{images_of, label_file_of};
use super::scene::{read_table, scene_of, table_file};
use super::{LabeledImage, Split, YoloSet, YoloSetError, rows};

/// How a set is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WriteOptions {
    /// Images are linked instead of copied where the file system can: they must not be changed
    /// afterwards.
    pub link: bool,
}

/// What was written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WriteReport {
    /// The `data.yaml`.
    pub data_yaml: PathBuf,
    /// Images that are new in the folder.
    pub added: usize,
    /// Images that were there already; their labels were written again.
    pub relabeled: usize,
    /// Boxes in all.
    pub boxes: usize,
    /// Images with nothing on them.
    pub backgrounds: usize,
    /// Images per part: train, val, test.
    pub per_split: [usize; 3],
}

/// Writes a set to a folder. Everything is checked before anything is written; every file comes
/// under a temporary name first, the labels of an image before the image, `data.yaml` last.
pub(super) fn write(
    set: &YoloSet,
    folder: &Path,
    options: &WriteOptions,
    context: &dyn JobContext,
) -> Result<WriteReport, YoloSetError> {
    check(set)?;
    let data_yaml = folder.join("data.yaml");
    let known = existing(set, folder, &data_yaml)?;
    let places = places(set, folder, &known)?;
    let mut report = WriteReport { data_yaml: data_yaml.clone(), ..WriteReport::default() };
    for (index, (image, place)) in set.images.iter().zip(&places).enumerate() {
        context.checkpoint()?;
        context.report(index as f64 / places.len() as f64, "writing images");
        let labels: String = image.boxes.iter().map(|labeled| rows::text(labeled, image.size_px)).collect();
        write_text(&label_file_of(&place.file), &labels)?;
        if place.there {
            report.relabeled += 1;
        } else {
            copy(&image.path, &place.file, options.link)?;
            report.added += 1;
        }
        report.boxes += image.boxes.len();
        report.backgrounds += usize::from(image.boxes.is_empty());
        report.per_split[place.split as usize] += 1;
    }
    write_scenes(set, folder, &data_yaml)?;
    write_description(set, folder, &data_yaml)?;
    Ok(report)
}

fn check(set: &YoloSet) -> Result<(), YoloSetError> {
    check_names(&set.names)?;
    if set.images.is_empty() {
        return Err(YoloSetError::Empty);
    }
    let unsplit = set.images.iter().filter(|image| image.split.is_none()).count();
    if unsplit > 0 {
        return Err(YoloSetError::NotSplit(unsplit));
    }
    let known = set.names.len();
    for image in &set.images {
        if let Some(bad) = image.boxes.iter().find(|labeled| labeled.class.0 >= known) {
            let (image, class) = (image.path.clone(), bad.class.0);
            return Err(YoloSetError::UnnamedClass { image, class, known });
        }
    }
    Ok(())
}

/// What the folder has already.
#[derive(Default)]
struct Existing {
    /// Images by file name.
    images: BTreeMap<String, (PathBuf, Split)>,
    /// Parts of its scenes.
    scenes: BTreeMap<String, Split>,
    /// Where images of a part go.
    folders: BTreeMap<Split, PathBuf>,
}

fn existing(set: &YoloSet, folder: &Path, data_yaml: &Path) -> Result<Existing, YoloSetError> {
    let mut existing = Existing::default();
    if !files::present(data_yaml)? {
        let mut entries = match std::fs::read_dir(folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(existing),
            Err(source) => return Err(YoloSetError::Io { file: folder.to_owned(), source }),
        };
        let empty = entries.next().is_none();
        return if empty { Ok(existing) } else { Err(YoloSetError::NotASet(folder.to_owned())) };
    }
    let described = DataYaml::read(data_yaml)?;
    if described.names != set.names {
        let (there, ours) = (described.names, set.names.clone());
        return Err(YoloSetError::OtherNames { folder: folder.to_owned(), there, ours });
    }
    let scenes = read_table(data_yaml)?;
    for split in Split::ALL.into_iter().filter(|split| described.has(*split)) {
        for place in described.places(split)? {
            // What cannot be read there is no concern of what is added.
            for image in images_of(&place, &described.root, &mut Vec::new())? {
                let scene = scenes.get(&image).unwrap_or_else(|| scene_of(&image));
                existing.scenes.entry(scene).or_insert(split);
                existing.images.entry(name_of(&image)).or_insert((image, split));
            }
            if place.is_dir() {
                existing.folders.entry(split).or_insert(place);
            }
        }
        if !existing.folders.contains_key(&split) {
            return Err(YoloSetError::ListOfImages { file: data_yaml.to_owned(), split });
        }
    }
    Ok(existing)
}

struct Place {
    file: PathBuf,
    split: Split,
    there: bool,
}

/// Where each image goes. One that is there already stays in its part, and so does its scene:
/// what was judged by must not be learned from later.
fn places(set: &YoloSet, folder: &Path, existing: &Existing) -> Result<Vec<Place>, YoloSetError> {
    // Labels are named by the stem, so `a.png` and `a.jpg` would share them.
    let mut taken: BTreeMap<String, String> =
        existing.images.keys().map(|name| (stem_of(Path::new(name)), name.clone())).collect();
    let mut seen = BTreeSet::new();
    let mut places = Vec::with_capacity(set.images.len());
    for image in &set.images {
        let name = name_of(&image.path);
        let taken_by = taken.entry(stem_of(&image.path)).or_insert_with(|| name.clone());
        if *taken_by != name || !seen.insert(name.clone()) {
            return Err(YoloSetError::NameTaken(image.path.clone()));
        }
        let place = match existing.images.get(&name) {
            Some((file, split)) if same_content(&image.path, file)? => {
                Place { file: file.clone(), split: *split, there: true }
            }
            Some((file, _)) => return Err(YoloSetError::NameTaken(file.clone())),
            None => {
                let known = existing.scenes.get(&image.scene).copied();
                let split = known.or(image.split).unwrap_or(Split::Train);
                let part = existing.folders.get(&split).cloned();
                let part = part.unwrap_or_else(|| folder.join("images").join(split.key()));
                Place { file: part.join(name), split, there: false }
            }
        };
        places.push(place);
    }
    Ok(places)
}

fn stem_of(image: &Path) -> String {
    image.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

fn name_of(image: &Path) -> String {
    image.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

fn same_content(a: &Path, b: &Path) -> Result<bool, YoloSetError> {
    let read = |file: &Path| files::read(file, Size::IMAGE);
    Ok(a == b || read(a)? == read(b)?)
}

fn copy(from: &Path, to: &Path, link: bool) -> Result<(), YoloSetError> {
    make_folder_of(to)?;
    let replacement = Replacement::of(to)?;
    if !(link && std::fs::hard_link(from, replacement.temporary()).is_ok()) {
        files::check(from, Size::IMAGE)?;
        std::fs::copy(from, replacement.temporary()).map_err(YoloSetError::io(from))?;
    }
    Ok(replacement.commit()?)
}

fn write_text(file: &Path, text: &str) -> Result<(), YoloSetError> {
    make_folder_of(file)?;
    Ok(files::write(file, text)?)
}

fn make_folder_of(file: &Path) -> Result<(), YoloSetError> {
    match file.parent() {
        Some(folder) => std::fs::create_dir_all(folder).map_err(YoloSetError::io(folder)),
        None => Ok(()),
    }
}

/// Scenes that the names of the images do not say.
fn write_scenes(set: &YoloSet, folder: &Path, data_yaml: &Path) -> Result<(), YoloSetError> {
    let mut table = read_table(data_yaml)?;
    for LabeledImage { path, scene, .. } in &set.images {
        table.insert(path, scene);
    }
    match table.text() {
        Some(text) => write_text(&table_file(folder), &text),
        None => Ok(()),
    }
}

/// `data.yaml` of a new set; an old one stays as somebody wrote it, unless a part is new in it.
fn write_description(set: &YoloSet, folder: &Path, data_yaml: &Path) -> Result<(), YoloSetError> {
    let parts: Vec<Split> =
        Split::ALL.into_iter().filter(|split| folder.join("images").join(split.key()).is_dir()).collect();
    if !files::present(data_yaml)? {
        // Trainers insist on both.
        let both = Split::ALL.into_iter().filter(|split| *split != Split::Test || parts.contains(split));
        for split in [Split::Train, Split::Val] {
            let empty = folder.join("images").join(split.key());
            std::fs::create_dir_all(&empty).map_err(YoloSetError::io(&empty))?;
        }
        return write_text(data_yaml, &data_yaml_text(&set.names, &both.collect::<Vec<_>>()));
    }
    let described = DataYaml::read(data_yaml)?;
    let new = parts.iter().filter(|split| !described.has(**split));
    let lines: String = new
        .map(|split| {
            // Relative to what the file says, so the whole path where that is another folder.
            let below = Path::new("images").join(split.key());
            let place = if described.root.as_path() == folder { below } else { folder.join(below) };
            format!("{}: '{}'\n", split.key(), place.display().to_string().replace('\'', "''"))
        })
        .collect();
    if lines.is_empty() {
        return Ok(());
    }
    let old = files::read_text(data_yaml, Size::SHORT)?;
    write_text(data_yaml, &format!("{}\n{lines}", old.trim_end()))
}
