//! Labeled images for training a detector, drawn with everything randomised: light, colors, clutter,
//! postures, toys, lenses, and what the cameras do to their images.
//!
//! The same seed gives the same scenes and labels, and on the same device the same pixels; a pair
//! depends on the seed and its number alone. Boxes enclose what is seen of an object, as the
//! renderer knows it; those of hands enclose the palm only. Nothing that could be seen is left
//! without a label: what shows too little of itself is taken out of the scene.

mod arms;
mod as_twin;
mod clutter;
mod dice;
mod files;
mod finish;
mod labels;
mod placing;
mod room;
mod scene;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::RgbImage;
use plumbline_model::robot::{Rig, RigError};
use plumbline_model::{Cancelled, JobContext};

use self::arms::Bank;
use self::as_twin::Laboratory;
use self::labels::{Appears, Thing, appears};
use self::scene::Scene;
use crate::error::TwinError;
use crate::eyes::{EyeOptions, EyeRenderer, ObjectImage, RenderError, Sensor};
use crate::scene::Snapshot;

pub use labels::Label;

/// Counts up whenever the same seed gives another set.
pub const GENERATOR: u32 = 1;
/// Most pairs of a set.
pub const MOST_PAIRS: usize = 100_000;
/// A scene is looked at at most this often, each time with less in it.
const MOST_TRIES: usize = 6;
/// Quality of the JPEG files of the twin, whose eyes do not compress.
const TWIN_QUALITY: u8 = 95;

/// What to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetOptions {
    /// Pairs, 1 to [`MOST_PAIRS`].
    pub pairs: usize,
    /// The same seed gives the same set.
    pub seed: u64,
    /// Number of the first pair, so that a set can be drawn in parts.
    pub first: usize,
    /// Share of the pairs that is kept for validation, 0–1; both eyes of a pair stay together.
    pub val_share: f64,
    /// Which world is drawn.
    pub world: SetWorld,
}

/// Which world a set shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SetWorld {
    /// Everything randomised, to learn from.
    #[default]
    Randomised,
    /// The running twin as its window shows it; only toys, arms and head differ.
    Twin,
}

impl Default for SetOptions {
    fn default() -> Self {
        Self { pairs: 100, seed: 1, first: 0, val_share: 0.1, world: SetWorld::Randomised }
    }
}

impl SetOptions {
    /// The set that detectors of this program are judged on and never trained on: 300 pairs, all for
    /// validation.
    pub fn held_out() -> Self {
        Self { pairs: 300, seed: 20_261_121, val_share: 1.0, ..Self::default() }
    }

    /// The same for the twin as its window shows it: 150 pairs.
    pub fn held_out_twin() -> Self {
        Self { pairs: 150, world: SetWorld::Twin, ..Self::held_out() }
    }

    /// Whether a pair is for validation. The choice is spread evenly.
    fn is_val(&self, index: usize) -> bool {
        let share = |n: usize| (n as f64 * self.val_share + 1e-9).floor();
        share(index + 1) > share(index)
    }
}

/// What was drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SetSummary {
    /// Pairs.
    pub pairs: usize,
    /// Boxes of each published class, both eyes.
    pub boxes: [usize; 8],
    /// Images without any label.
    pub empty_images: usize,
    /// The device that drew.
    pub device: String,
}

/// Why a set could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum SetError {
    /// Stopped on request; what was drawn so far stays.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// An option that cannot be used.
    #[error("{what} is {value}: {remedy}")]
    Option {
        /// Which.
        what: &'static str,
        /// Its value.
        value: String,
        /// What is right.
        remedy: &'static str,
    },
    /// The robot's description cannot be used.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The renderer failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The twin's world cannot be made.
    #[error(transparent)]
    Twin(#[from] TwinError),
    /// An image could not be encoded.
    #[error("an image could not be encoded as JPEG: {0}. Try again; if it stays so, report it")]
    Encode(String),
    /// The folder holds another set.
    #[error(
        "{} holds a set that was drawn with {found}; now it would be drawn with {wanted}, and two sets in one folder cannot be told apart: choose an empty folder, or the same options to draw it again",
        folder.display()
    )]
    OtherSet {
        /// The folder.
        folder: PathBuf,
        /// How the set in it was drawn.
        found: String,
        /// How it would be drawn now.
        wanted: String,
    },
    /// The folder holds something else.
    #[error(
        "{} is not empty and holds no set that this program drew (no {}): choose an empty folder, so that nothing is mixed up or written over",
        folder.display(), files::RECIPE
    )]
    NotASet {
        /// The folder.
        folder: PathBuf,
    },
    /// A file could not be read or written.
    #[error(transparent)]
    File(#[from] plumbline_model::files::FileError),
}

/// One pair with its labels.
#[derive(Clone, Debug)]
pub struct LabeledImages {
    /// Left and right image as the cameras would give them.
    pub images: [RgbImage; 2],
    /// Labels of the left and the right image.
    pub labels: [Vec<Label>; 2],
    /// Quality of the JPEG files.
    quality: u8,
}

/// Draws pairs of a set one by one.
pub struct SetPainter {
    rig: Rig,
    bank: Bank,
    renderer: EyeRenderer,
    /// Made when the first pair of it is asked for.
    laboratory: Option<Laboratory>,
}

impl SetPainter {
    /// Opens the renderer; takes about two seconds.
    ///
    /// # Errors
    /// When there is no device that draws.
    pub fn new(options: EyeOptions) -> Result<Self, SetError> {
        let rig = Rig::built_in("nico")?;
        let bank = Bank::new(&rig);
        Ok(Self { bank, rig, renderer: EyeRenderer::new(options)?, laboratory: None })
    }

    /// The pair of a number.
    ///
    /// # Errors
    /// When the renderer fails.
    pub fn pair(&mut self, seed: u64, index: usize) -> Result<LabeledImages, SetError> {
        let (scene, without) = self.clear_scene(seed, index as u64)?;
        let drawn = self.renderer.render_labeled(
            &scene.scenery(&without),
            &scene.snapshot,
            &scene.sensor,
            scene.noise_seed,
        )?;
        let (labels, _) = label(&scene.things, &scene.snapshot, &[drawn.left_objects, drawn.right_objects]);
        let mut images = [drawn.pair.left, drawn.pair.right];
        images.iter_mut().enumerate().for_each(|(eye, image)| scene.finish.apply(image, eye));
        Ok(LabeledImages { images, labels, quality: scene.finish.quality })
    }

    /// The pair of a number, of the running twin.
    ///
    /// # Errors
    /// When the twin cannot be made or the renderer fails.
    pub fn twin_pair(&mut self, seed: u64, index: usize) -> Result<LabeledImages, SetError> {
        let laboratory = match &mut self.laboratory {
            Some(laboratory) => laboratory,
            none => none.insert(Laboratory::new(Arc::new(self.rig.clone()))?),
        };
        let scene = laboratory.scene(&self.bank, seed, index as u64);
        let sensor = Sensor::default();
        let mut without: Vec<u16> = vec![];
        for _ in 0..MOST_TRIES {
            let objects = self.renderer.objects(&scene.scenery(&without), &scene.snapshot, &sensor)?;
            let (_, barely) = label(&scene.things, &scene.snapshot, &objects);
            if barely.is_empty() {
                break;
            }
            without.extend(barely);
        }
        let scenery = scene.scenery(&without);
        let drawn = self.renderer.render_labeled(&scenery, &scene.snapshot, &sensor, scene.noise_seed)?;
        let (labels, _) = label(&scene.things, &scene.snapshot, &[drawn.left_objects, drawn.right_objects]);
        Ok(LabeledImages { images: [drawn.pair.left, drawn.pair.right], labels, quality: TWIN_QUALITY })
    }

    /// A scene, and what must be left out of it so that nothing remains of which only a little is
    /// seen. It takes a fraction of the time that the images take.
    fn clear_scene(&mut self, seed: u64, index: u64) -> Result<(Scene, Vec<u16>), SetError> {
        let scene = Scene::draw(&self.rig, &self.bank, seed, index);
        let mut without: Vec<u16> = vec![];
        for _ in 0..MOST_TRIES {
            let objects = self.renderer.objects(&scene.scenery(&without), &scene.snapshot, &scene.sensor)?;
            let (_, barely) = label(&scene.things, &scene.snapshot, &objects);
            if barely.is_empty() {
                break;
            }
            without.extend(barely);
        }
        Ok((scene, without))
    }
}

/// Labels of both eyes, and the objects of which too little is seen.
fn label(
    things: &[Thing],
    snapshot: &Snapshot,
    [left, right]: &[ObjectImage; 2],
) -> ([Vec<Label>; 2], Vec<u16>) {
    let eyes = &snapshot.eyes;
    let views = [
        (left, &eyes.left, &eyes.robot_from_left.isometry),
        (right, &eyes.right, &eyes.robot_from_right.isometry),
    ];
    let mut labels = [vec![], vec![]];
    let mut barely = vec![];
    for thing in things {
        for (own, (image, camera, robot_from_eye)) in labels.iter_mut().zip(views) {
            match appears(thing, image, camera, robot_from_eye) {
                Appears::Unseen => {}
                Appears::As(area) => own.push(Label { class: thing.class, area }),
                Appears::Barely => barely.push(thing.object),
            }
        }
    }
    (labels, barely)
}

/// Draws a set into a folder: `images` and `labels` with `train` and `val`, `data.yaml`,
/// `recipe.json`.
///
/// # Errors
/// When an option cannot be used, nothing draws, a file cannot be written, or on request.
pub fn generate(out: &Path, options: &SetOptions, context: &dyn JobContext) -> Result<SetSummary, SetError> {
    if options.pairs == 0 || options.pairs > MOST_PAIRS {
        return Err(SetError::Option {
            what: "the number of pairs",
            value: options.pairs.to_string(),
            remedy: "give 1 to 100000",
        });
    }
    if !(0.0..=1.0).contains(&options.val_share) {
        return Err(SetError::Option {
            what: "the share for validation",
            value: options.val_share.to_string(),
            remedy: "give 0 to 1",
        });
    }
    files::prepare(out, options)?;
    let mut painter = SetPainter::new(EyeOptions::default())?;
    let mut summary =
        SetSummary { device: painter.renderer.adapter_name().to_owned(), ..SetSummary::default() };
    for index in options.first..options.first + options.pairs {
        context.checkpoint()?;
        let pair = match options.world {
            SetWorld::Randomised => painter.pair(options.seed, index)?,
            SetWorld::Twin => painter.twin_pair(options.seed, index)?,
        };
        let split = if options.is_val(index) { "val" } else { "train" };
        for (eye, (image, labels)) in ["left", "right"].iter().zip(pair.images.iter().zip(&pair.labels)) {
            files::one(out, split, &format!("{index:05}_{eye}"), image, pair.quality, labels)?;
            summary.empty_images += usize::from(labels.is_empty());
            for label in labels {
                summary.boxes[label.class.0] += 1;
            }
        }
        summary.pairs += 1;
        let fraction = summary.pairs as f64 / options.pairs as f64;
        context.report(fraction, "drawing pairs");
    }
    files::recipe(out, options, &summary)?;
    Ok(summary)
}
