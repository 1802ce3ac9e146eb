//! What takes time: reading and writing data sets, reading images, proposing boxes.

use std::path::PathBuf;
use std::sync::Arc;

use image::RgbImage;
use plumbline_model::{ClassNames, JobContext, StereoFrame, counted, files};
use plumbline_vision::yolo_set::{ClassMapping, SplitOptions, YoloSet};

use super::images::{Pixels, read_image};
use super::store::{self, Entry, OpenedSet};
use super::transfer::{self, ImportPlan};
use super::view::{LabelBox, ProposedBox};
use crate::detect::command::{DetectorChoice, Provider};
use crate::detect::{LoadedDetector, OpenDetector};
use crate::ground;
use crate::ground::LongWork;
use crate::ground::jobs::JobError;
use crate::ground::text::sentence;

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum LabelsWork {
    /// Looks which data set was open last.
    Restore {
        /// The file that says so.
        memory: PathBuf,
    },
    /// Reads a data set.
    Open {
        /// Its folder or `data.yaml`.
        path: PathBuf,
        /// Where it is remembered that it was open.
        memory: PathBuf,
    },
    /// Makes a data set and reads it.
    Create {
        /// Its folder.
        folder: PathBuf,
        /// Its classes.
        names: ClassNames,
        /// Where it is remembered that it was open.
        memory: PathBuf,
    },
    /// Reads an image.
    Load {
        /// Its name.
        name: String,
        /// Its file.
        file: PathBuf,
    },
    /// Reads images, made small.
    Thumbnails {
        /// Name and file of each.
        files: Vec<(String, PathBuf)>,
    },
    /// Writes labels, in this order.
    Save {
        /// Files with their new text; `None` removes the file.
        files: Vec<(PathBuf, Option<String>)>,
    },
    /// Adds a pair.
    Capture {
        /// The pair.
        frame: StereoFrame,
        /// When it was taken.
        captured: jiff::Timestamp,
        /// Folder of the data set.
        folder: PathBuf,
    },
    /// Proposes boxes.
    Propose {
        /// How a detector is opened, unless it is ready.
        open: OpenDetector,
        /// Which.
        choice: DetectorChoice,
        /// Where it is computed.
        provider: Provider,
        /// The detector, when it is ready.
        ready: Option<Arc<LoadedDetector>>,
        /// Name of the image.
        name: String,
        /// The image.
        image: Arc<RgbImage>,
        /// Classes of the data set.
        names: ClassNames,
        /// Least confidence, 0–1.
        confidence: f32,
    },
    /// Writes a data set to train with.
    Export {
        /// What is labeled.
        set: Box<YoloSet>,
        /// Where to.
        folder: PathBuf,
        /// How it is split.
        options: SplitOptions,
    },
    /// Looks what an import would do.
    PlanImport {
        /// The other data set.
        path: PathBuf,
        /// Classes of this one.
        names: ClassNames,
        /// Names of the images that are there.
        there: Vec<String>,
    },
    /// Does it.
    Import {
        /// What was shown.
        plan: Arc<ImportPlan>,
        /// Folder of the data set.
        folder: PathBuf,
        /// Where it is remembered that it was open.
        memory: PathBuf,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum LabelsResult {
    /// The data set that was open last.
    Restored(Option<PathBuf>),
    /// A data set is open.
    Opened(Box<OpenedSet>),
    /// An image, or why there is none.
    Loaded(String, Pixels),
    /// Small images by name.
    Thumbnails(Vec<(String, Pixels)>),
    /// All of it is on disk.
    Saved,
    /// A pair is in the data set.
    Captured(Vec<Entry>),
    /// Boxes for an image, and the detector, ready for the next one.
    Proposed {
        /// Name of the image.
        name: String,
        /// What was found, in classes of the data set.
        boxes: Vec<ProposedBox>,
        /// Which choice this detector was.
        choice: DetectorChoice,
        /// The detector.
        detector: Arc<LoadedDetector>,
        /// Classes of the detector that the data set does not have; what it finds of them is left out.
        unknown: Vec<String>,
    },
    /// Written there; a sentence about it.
    Exported(String),
    /// What an import would do.
    Planned(Arc<ImportPlan>),
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, LabelsWork>;

impl LongWork for LabelsWork {
    type Result = LabelsResult;

    fn title(&self) -> String {
        match self {
            Self::Restore { .. } => "Look for the last data set".to_owned(),
            Self::Open { path, .. } => format!("Open the data set {}", short(path)),
            Self::Create { folder, .. } => format!("Make the data set {}", short(folder)),
            Self::Load { name, .. } => format!("Read {name}"),
            Self::Thumbnails { .. } => "Read small pictures".to_owned(),
            Self::Save { .. } => "Save boxes".to_owned(),
            Self::Capture { .. } => "Add the pair".to_owned(),
            Self::Propose { name, .. } => format!("Propose boxes for {name}"),
            Self::Export { set, .. } => format!("Export {}", counted(set.images.len(), "image")),
            Self::PlanImport { path, .. } => format!("Read the data set {}", short(path)),
            Self::Import { plan, .. } => format!("Import {}", counted(plan.view.images, "image")),
        }
    }

    fn is_quiet(&self) -> bool {
        !matches!(
            self,
            Self::Create { .. } | Self::Export { .. } | Self::Import { .. } | Self::Capture { .. }
        )
    }

    fn run(self, context: &dyn JobContext) -> Result<LabelsResult, JobError> {
        match self {
            Self::Restore { memory } => Ok(LabelsResult::Restored(remembered(&memory))),
            Self::Open { path, memory } => opened(&path, &memory, context),
            Self::Create { folder, names, memory } => {
                store::create(&folder, &names)?;
                opened(&folder, &memory, context)
            }
            Self::Load { name, file } => {
                Ok(LabelsResult::Loaded(name, read_image(&file).map(Arc::new).map_err(Arc::new)))
            }
            Self::Thumbnails { files } => thumbnails(files, context),
            Self::Save { files } => save(&files),
            Self::Capture { frame, captured, folder } => {
                transfer::capture(&frame, captured, &folder).map(LabelsResult::Captured)
            }
            Self::Propose { open, choice, provider, ready, name, image, names, confidence } => {
                let detector = match ready {
                    Some(ready) => ready,
                    None => {
                        context.report(0.1, "reading the detector");
                        let opened = open.open(&choice, provider);
                        let opened = opened.map_err(|why| JobError::failed(sentence(&why.to_string())))?;
                        Arc::new(LoadedDetector::new(opened))
                    }
                };
                context.checkpoint()?;
                context.report(0.6, "looking at the image");
                let (boxes, unknown) = propose(&detector, &image, &names, confidence)?;
                Ok(LabelsResult::Proposed { name, boxes, choice, detector, unknown })
            }
            Self::Export { set, folder, options } => {
                transfer::export(*set, &folder, &options, context).map(LabelsResult::Exported)
            }
            Self::PlanImport { path, names, there } => {
                transfer::plan(&path, &names, &there, context).map(Arc::new).map(LabelsResult::Planned)
            }
            Self::Import { plan, folder, memory } => {
                transfer::import(&plan, &folder, context)?;
                opened(&folder, &memory, context)
            }
        }
    }
}

impl LabelsResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Restored(_) => "Looked for the last data set.".to_owned(),
            Self::Opened(set) => format!("The data set has {}.", counted(set.entries.len(), "image")),
            Self::Loaded(name, _) => format!("{name} read."),
            Self::Thumbnails(pictures) => format!("{} small pictures read.", pictures.len()),
            Self::Saved => "Boxes saved.".to_owned(),
            Self::Captured(entries) => {
                let names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
                format!("{} are in the data set.", names.join(" and "))
            }
            Self::Proposed { boxes, .. } => format!("Proposed: {}.", counted(boxes.len(), "box")),
            Self::Exported(text) => text.clone(),
            Self::Planned(plan) => format!("Can be imported: {}.", counted(plan.view.images, "image")),
        }
    }
}

fn short(path: &std::path::Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn remembered(memory: &std::path::Path) -> Option<PathBuf> {
    let text = files::read_text(memory, files::Size::SHORT).ok()?;
    let path = PathBuf::from(text.trim());
    path.join("data.yaml").is_file().then_some(path)
}

fn opened(
    path: &std::path::Path,
    memory: &std::path::Path,
    context: &dyn JobContext,
) -> Result<LabelsResult, JobError> {
    let set = store::open(path, context)?;
    // Only a convenience: a data set is open all the same where this cannot be written.
    if let Err(error) = store::write(memory, &format!("{}\n", set.folder.display())) {
        log::warn!("{error}");
    }
    Ok(LabelsResult::Opened(Box::new(set)))
}

/// Width of a small picture, px.
const SMALL_WIDTH: u32 = 128;

fn thumbnails(files: Vec<(String, PathBuf)>, context: &dyn JobContext) -> Result<LabelsResult, JobError> {
    let mut small = Vec::with_capacity(files.len());
    for (name, file) in files {
        context.checkpoint()?;
        let picture = read_image(&file).map(|image| {
            let height = (image.height() * SMALL_WIDTH / image.width().max(1)).max(1);
            Arc::new(image::imageops::thumbnail(&image, SMALL_WIDTH, height))
        });
        small.push((name, picture.map_err(Arc::new)));
    }
    Ok(LabelsResult::Thumbnails(small))
}

/// Not to be cancelled: what the operator drew goes to the disk whatever else is stopped.
fn save(files: &[(PathBuf, Option<String>)]) -> Result<LabelsResult, JobError> {
    for (file, text) in files {
        match text {
            Some(text) => store::write(file, text)?,
            None => match std::fs::remove_file(file) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                    return Err(store::cannot(file, &error));
                }
                _ => {}
            },
        }
    }
    Ok(LabelsResult::Saved)
}

/// What a detector finds, in classes of the data set, by name.
fn propose(
    detector: &LoadedDetector,
    image: &RgbImage,
    names: &ClassNames,
    confidence: f32,
) -> Result<(Vec<ProposedBox>, Vec<String>), JobError> {
    let mapping = ClassMapping::known_only(&detector.facts.names, names);
    let mut found = Vec::new();
    let detected = detector.lock().detect(image, PROPOSED_IOU, &mut found);
    detected.map_err(|why| JobError::failed(sentence(&why.to_string())))?;
    let sure = found.iter().filter(|detection| detection.confidence >= confidence);
    let boxes = sure.filter_map(|detection| {
        let class = mapping.target(detection.class)?;
        let area = detection.area.on_image(image.dimensions())?;
        Some(ProposedBox { label: LabelBox { class, area }, confidence: detection.confidence })
    });
    let unknown = detector.facts.names.iter().filter(|(_, name)| names.index_of(name).is_none());
    Ok((boxes.collect(), unknown.map(|(_, name)| name.to_owned()).collect()))
}

/// Overlap from which two proposals of a class are one thing.
const PROPOSED_IOU: f32 = 0.6;
