//! The images behind a cell of a confusion matrix.

use std::collections::BTreeMap;
use std::sync::Arc;

use plumbline_model::{ClassIndex, JobContext};
use plumbline_vision::detect_score::{Cell, ModelEvaluation};

use super::command::ConfusionCell;
use super::evaluation::Evaluation;
use super::view::{CellPicture, OpenedCell};
use crate::ground::jobs::JobError;
use crate::labels::read_image;
use crate::labels::view::{LabelBox, ProposedBox};

/// Images that are read for a cell.
const MOST: usize = 60;

/// The boxes of one image that fell into the cell, by place in truth and in what was found.
type InCell = Vec<(Option<usize>, Option<usize>)>;

/// Reads the images of a cell.
///
/// # Errors
/// A sentence.
pub fn open(
    evaluation: &Evaluation,
    model: usize,
    cell: ConfusionCell,
    context: &dyn JobContext,
) -> Result<OpenedCell, JobError> {
    let Some(judged) = evaluation.models.get(model).and_then(Option::as_ref) else {
        return Err(JobError::failed("This detector could not be judged. Look at its row in the table."));
    };
    let place = Cell { truth: cell.truth.map(ClassIndex), found: cell.found.map(ClassIndex) };
    let mut images: BTreeMap<usize, InCell> = BTreeMap::new();
    for entry in judged.matrix.entries(place) {
        images.entry(entry.image).or_default().push((entry.truth, entry.found));
    }
    let of = images.len();
    let mut pictures = Vec::new();
    for (image, in_cell) in images.into_iter().take(MOST) {
        context.checkpoint()?;
        context.report(pictures.len() as f64 / of.min(MOST) as f64, "reading images");
        pictures.extend(picture(judged, image, &in_cell));
    }
    Ok(OpenedCell { model, cell, pictures, of })
}

/// Truth and what was found from the matrix's confidence on, places counted anew among those.
fn picture(judged: &ModelEvaluation, image: usize, in_cell: &InCell) -> Option<CellPicture> {
    let (labeled, found) = (judged.images.get(image)?, judged.found.get(image)?);
    let sure: Vec<usize> =
        (0..found.len()).filter(|i| f64::from(found[*i].confidence) >= judged.confidence).collect();
    let anew = |place: Option<usize>| place.and_then(|place| sure.iter().position(|i| *i == place));
    let truth = labeled.boxes.iter().map(|b| LabelBox { class: b.class, area: b.area });
    let proposed = sure.iter().map(|i| ProposedBox {
        label: LabelBox { class: found[*i].class, area: found[*i].area },
        confidence: found[*i].confidence,
    });
    Some(CellPicture {
        name: labeled.path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        pixels: read_image(&labeled.path).map(Arc::new).map_err(Arc::new),
        truth: truth.collect(),
        found: proposed.collect(),
        in_cell: in_cell.iter().map(|(truth, found)| (*truth, anew(*found))).collect(),
    })
}
