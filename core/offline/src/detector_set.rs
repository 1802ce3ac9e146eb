//! Labeled images for training a detector, drawn by the twin.

use std::path::PathBuf;

use plumbline_model::{ClassNames, JobContext};
use plumbline_twin::training_set::{self, SetError, SetOptions, SetWorld};
use serde::Serialize;

/// What to draw.
#[derive(Clone, Debug, PartialEq)]
pub struct DetectorSetArgs {
    /// Folder that receives `images`, `labels`, `data.yaml` and `recipe.json`.
    pub out: PathBuf,
    /// Image pairs.
    pub pairs: usize,
    /// The same seed gives the same set.
    pub seed: u64,
    /// Number of the first pair, to draw a set in parts.
    pub first: usize,
    /// Share of the pairs that is kept for validation, 0–1.
    pub val_share: f64,
    /// Which world is drawn.
    pub world: SetWorld,
}

impl DetectorSetArgs {
    /// The set on which detectors are judged and never trained.
    pub fn held_out(out: PathBuf, world: SetWorld) -> Self {
        let options = match world {
            SetWorld::Randomised => SetOptions::held_out(),
            SetWorld::Twin => SetOptions::held_out_twin(),
        };
        let SetOptions { pairs, seed, first, val_share, world } = options;
        Self { out, pairs, seed, first, val_share, world }
    }
}

/// What was drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DetectorSetReport {
    /// The description that trainers read.
    pub data_yaml: PathBuf,
    /// Image pairs.
    pub pairs: usize,
    /// Images without any label.
    pub images_without_label: usize,
    /// Boxes of each class, both eyes, in the published order.
    pub boxes: Vec<ClassBoxes>,
    /// The device that drew.
    pub device: String,
}

/// How many boxes a class has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClassBoxes {
    /// Name of the class.
    pub class: String,
    /// Boxes.
    pub boxes: usize,
}

/// Draws and writes the set.
///
/// # Errors
/// When nothing draws, a file cannot be written, or on request.
pub fn detector_set(args: &DetectorSetArgs, context: &dyn JobContext) -> Result<DetectorSetReport, SetError> {
    let options = SetOptions {
        pairs: args.pairs,
        seed: args.seed,
        first: args.first,
        val_share: args.val_share,
        world: args.world,
    };
    let summary = training_set::generate(&args.out, &options, context)?;
    let boxes = ClassNames::published()
        .iter()
        .zip(summary.boxes)
        .map(|((_, name), boxes)| ClassBoxes { class: name.to_owned(), boxes })
        .collect();
    Ok(DetectorSetReport {
        data_yaml: args.out.join("data.yaml"),
        pairs: summary.pairs,
        images_without_label: summary.empty_images,
        boxes,
        device: summary.device,
    })
}
