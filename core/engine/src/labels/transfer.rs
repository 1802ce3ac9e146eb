//! Images that come into a data set and go out of it: capture, export, import.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Duration;

use image::RgbImage;
use jiff::Timestamp;
use plumbline_model::files::{self, FileError, Replacement, Size};
use plumbline_model::{ClassNames, Eye, JobContext, StereoFrame, counted};
use plumbline_vision::yolo_set::{
    ClassMapping, LabeledImage, MappingProposal, Split, SplitOptions, WriteOptions, YoloSet, label_file_of,
    label_text, scene_of,
};

use super::store::{self, Entry, cannot, data_yaml_of, entry_of, failed};
use super::view::ImportView;
use crate::ground::jobs::JobError;
use crate::ground::text::sentence;

/// Adds both images of a pair, named by the eye and the time in seconds since 1970, so that the scene
/// of both is the same.
///
/// # Errors
/// A sentence; then neither image is in the data set.
pub fn capture(frame: &StereoFrame, captured: Timestamp, folder: &Path) -> Result<Vec<Entry>, JobError> {
    let since_1970 = Duration::try_from(captured.as_duration()).map_err(|_| {
        JobError::failed("The clock of this computer stands before 1970. Set it, then capture again.")
    })?;
    let stamp = format!("{}.{:06}", since_1970.as_secs(), since_1970.subsec_micros());
    let images = folder.join("images");
    std::fs::create_dir_all(&images).map_err(|error| cannot(&images, &error))?;
    let file = |eye: Eye| images.join(format!("{eye}_{stamp}.png"));
    let pair = [(Eye::Left, &frame.left), (Eye::Right, &frame.right)];
    if let Some((eye, _)) = pair.iter().find(|(eye, _)| file(*eye).exists()) {
        return Err(JobError::failed(format!(
            "{} is there already. Capture again in a moment.",
            file(*eye).display()
        )));
    }
    let written: Vec<Replacement> =
        pair.iter().map(|(eye, image)| png(image, &file(*eye))).collect::<Result<_, _>>()?;
    for replacement in written {
        replacement.commit().map_err(refused)?;
    }
    let entry = |(eye, image): &(Eye, &std::sync::Arc<RgbImage>)| {
        let file = file(*eye);
        entry_of(folder, file.clone(), scene_of(&file), image.dimensions(), Vec::new())
    };
    Ok(pair.iter().map(entry).collect())
}

/// Without loss, so that nothing is learned from the artifacts of a second compression.
fn png(image: &RgbImage, file: &Path) -> Result<Replacement, JobError> {
    let replacement = Replacement::of(file).map_err(refused)?;
    let written = image.save_with_format(replacement.temporary(), image::ImageFormat::Png);
    written.map_err(|error| cannot(file, &error))?;
    Ok(replacement)
}

fn refused(error: FileError) -> JobError {
    JobError::failed(sentence(&error.to_string()))
}

/// Writes a data set to train with.
///
/// # Errors
/// A sentence.
pub fn export(
    mut set: YoloSet,
    folder: &Path,
    options: &SplitOptions,
    context: &dyn JobContext,
) -> Result<String, JobError> {
    if std::fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
        return Err(JobError::failed(format!(
            "{} is not empty. Choose an empty folder, so that images of an earlier export do not mix in.",
            folder.display()
        )));
    }
    for image in &mut set.images {
        image.split = None;
    }
    let counts = set.split(options).map_err(failed)?;
    let report = set.write(folder, &WriteOptions::default(), context).map_err(failed)?;
    Ok(format!(
        "In {}: {} to train on and {} to validate ({}, {}).",
        folder.display(),
        counted(counts.train, "image"),
        counts.val,
        counted(counts.scenes, "scene"),
        counted(report.boxes, "box")
    ))
}

/// An import that was looked at and not yet done.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportPlan {
    /// For the window.
    pub view: ImportView,
    /// Images that come, boxes in classes of the open data set.
    images: Vec<(LabeledImage, bool)>,
}

/// Looks what an import would do.
///
/// # Errors
/// A sentence.
pub fn plan(
    path: &Path,
    names: &ClassNames,
    there: &[String],
    context: &dyn JobContext,
) -> Result<ImportPlan, JobError> {
    let data_yaml = data_yaml_of(path);
    let survey = YoloSet::survey(&data_yaml, &Split::ALL, context).map_err(failed)?;
    let there: BTreeSet<&str> = there.iter().map(String::as_str).collect();
    let from = survey.set.names.clone();
    let proposal = MappingProposal::new(&from, names);
    let mapped = survey.set.mapped(&ClassMapping::known_only(&from, names));
    let stem =
        |image: &LabeledImage| image.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let (mut images, mut skipped, mut taken) = (Vec::new(), Vec::new(), BTreeSet::new());
    for image in mapped.images {
        let name = stem(&image);
        if there.contains(name.as_str()) || !taken.insert(name.clone()) {
            skipped.push(name);
        } else {
            let labeled = label_file_of(&image.path).exists();
            images.push((image, labeled));
        }
    }
    let view = ImportView {
        from: data_yaml,
        classes: from.iter().map(|(_, name)| (name.to_owned(), names.index_of(name))).collect(),
        renumbered: proposal.renumbered,
        images: images.len(),
        boxes: images.iter().map(|(image, _)| image.boxes.len()).sum(),
        skipped,
        problems: survey.problems.iter().map(|problem| sentence(&problem.to_string())).collect(),
    };
    Ok(ImportPlan { view, images })
}

/// Copies images and labels of a plan; the labels of an image before the image, so that one without
/// labels is never taken for labeled or the other way round.
///
/// # Errors
/// A sentence. What was copied before is complete.
pub fn import(plan: &ImportPlan, folder: &Path, context: &dyn JobContext) -> Result<(), JobError> {
    let images = folder.join("images");
    std::fs::create_dir_all(&images).map_err(|error| cannot(&images, &error))?;
    for (i, (image, labeled)) in plan.images.iter().enumerate() {
        context.checkpoint()?;
        context.report(i as f64 / plan.images.len() as f64, "copying images");
        let Some(name) = image.path.file_name() else { continue };
        let target: PathBuf = images.join(name);
        if *labeled {
            store::write(&label_file_of(&target), &label_text(&image.boxes, image.size_px))?;
        }
        let replacement = Replacement::of(&target).map_err(refused)?;
        files::check(&image.path, Size::IMAGE).map_err(refused)?;
        std::fs::copy(&image.path, replacement.temporary()).map_err(|error| cannot(&target, &error))?;
        replacement.commit().map_err(refused)?;
    }
    Ok(())
}
