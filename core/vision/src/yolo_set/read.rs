//! Reading a set, as far as it can be read.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plumbline_model::JobContext;
use plumbline_model::files::{self, Size};

use super::data_yaml::DataYaml;
use super::images::{images_of, label_file_of};
use super::problem::{LabelProblem, RowProblem};
use super::scene::{SceneTable, scene_of};
use super::{LabeledImage, Split, YoloSetError, YoloSurvey, rows, scene};

/// Reads the parts of a set that are asked for. All three may be asked for of a set that has only
/// some of them; one that is asked for alone must be there.
pub(super) fn survey(
    data_yaml: &Path,
    splits: &[Split],
    context: &dyn JobContext,
) -> Result<YoloSurvey, YoloSetError> {
    let described = DataYaml::read(data_yaml)?;
    let mut survey = YoloSurvey::default();
    survey.set.names = described.names.clone();
    let mut images: BTreeMap<PathBuf, Split> = BTreeMap::new();
    let there: Vec<Split> = splits.iter().copied().filter(|split| described.has(*split)).collect();
    let wanted = if there.is_empty() { &splits[..splits.len().min(1)] } else { &there };
    for split in wanted {
        for place in described.places(*split)? {
            for image in images_of(&place, &described.root, &mut survey.problems)? {
                match images.get(&image) {
                    Some(known) if known != split => survey.in_several_splits += 1,
                    Some(_) => {}
                    None => drop(images.insert(image, *split)),
                }
            }
        }
    }
    let scenes = scene::read_table(&described.file)?;
    let count = images.len();
    for (index, (path, split)) in images.into_iter().enumerate() {
        context.checkpoint()?;
        context.report(index as f64 / count as f64, "reading labels");
        labeled(path, split, &scenes, &mut survey);
    }
    Ok(survey)
}

fn labeled(path: PathBuf, split: Split, scenes: &SceneTable, survey: &mut YoloSurvey) {
    let size_px = match size_of(&path) {
        Ok(size_px) => size_px,
        Err(reason) => {
            let what = RowProblem::BadImage { reason };
            survey.problems.push(LabelProblem { file: path, line: None, what });
            return;
        }
    };
    let scene = scenes.get(&path).unwrap_or_else(|| scene_of(&path));
    let mut image = LabeledImage { path, size_px, scene, boxes: Vec::new(), split: Some(split) };
    let file = label_file_of(&image.path);
    match files::read(&file, Size::TEXT) {
        Ok(bytes) => match String::from_utf8(bytes) {
            Ok(text) => boxes(&file, &text, &mut image, survey),
            Err(_) => {
                survey.problems.push(LabelProblem { file, line: None, what: RowProblem::NotText });
                return;
            }
        },
        Err(error) if error.is_absent() => survey.without_labels += 1,
        Err(error) => {
            // An image whose labels cannot be read is not one with nothing on it.
            let what = RowProblem::Unreadable { reason: error.to_string() };
            survey.problems.push(LabelProblem { file, line: None, what });
            return;
        }
    }
    survey.set.images.push(image);
}

fn boxes(file: &Path, text: &str, image: &mut LabeledImage, survey: &mut YoloSurvey) {
    let classes = survey.set.names.len();
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        match rows::row(line, image.size_px, classes) {
            Ok(row) if image.boxes.contains(&row.labeled) => survey.repeated_rows += 1,
            Ok(row) => {
                survey.polygons += usize::from(row.polygon);
                image.boxes.push(row.labeled);
            }
            Err(what) => {
                survey.problems.push(LabelProblem { file: file.to_owned(), line: Some(index + 1), what });
            }
        }
    }
}

/// Width × height from the head of the file, without decoding it.
fn size_of(path: &Path) -> Result<(u32, u32), String> {
    let reader = files::open_image(path).map_err(|error| error.to_string())?;
    reader.into_dimensions().map_err(|error| error.to_string())
}
