//! Rows of a label file.

use plumbline_model::files::shortened;
use plumbline_model::{ClassIndex, PixelBox};

use super::LabeledBox;
use super::problem::RowProblem;

/// What a row says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    /// The box.
    pub labeled: LabeledBox,
    /// Whether it was an outline, of which this is the box.
    pub polygon: bool,
}

/// Reads one row, for an image of this size and so many classes.
pub(super) fn row(line: &str, size_px: (u32, u32), classes: usize) -> Result<Row, RowProblem> {
    let fields: Vec<&str> = line.split_whitespace().collect();
    let corners = match fields.len() {
        5 => None,
        6 => return Err(RowProblem::Confidence),
        n if n >= 7 && n % 2 == 1 => Some(()),
        found => return Err(RowProblem::Fields { found }),
    };
    let class = class(fields[0], classes)?;
    let parts: Vec<f64> = fields[1..].iter().map(|text| part(text)).collect::<Result<_, _>>()?;
    let (w, h) = (f64::from(size_px.0), f64::from(size_px.1));
    let [x0, y0, x1, y1] = match corners {
        None => {
            let (x, y, half_w, half_h) = (parts[0], parts[1], 0.5 * parts[2], 0.5 * parts[3]);
            [x - half_w, y - half_h, x + half_w, y + half_h]
        }
        Some(()) => around(&parts),
    };
    // Less than a thousandth of a pixel is nothing that anybody drew.
    if !((x1 - x0) * w > 1e-3 && (y1 - y0) * h > 1e-3) {
        return Err(RowProblem::NoExtent);
    }
    let area = PixelBox::new((x0 * w) as f32, (y0 * h) as f32, (x1 * w) as f32, (y1 * h) as f32);
    Ok(Row { labeled: LabeledBox { class, area }, polygon: corners.is_some() })
}

/// The row of a box: parts of the image with eight digits, a hundred-thousandth of a pixel.
pub(super) fn text(labeled: &LabeledBox, size_px: (u32, u32)) -> String {
    let [x, y, width, height] = labeled.area.in_shares(size_px);
    format!("{} {x:.8} {y:.8} {width:.8} {height:.8}\n", labeled.class.0)
}

fn class(text: &str, classes: usize) -> Result<ClassIndex, RowProblem> {
    // Some programs write all fields as numbers with a point.
    let whole = text.strip_suffix(".0").unwrap_or(text);
    let class: usize = whole.parse().map_err(|_| RowProblem::NotAClass { text: shortened(text) })?;
    if class >= classes {
        return Err(RowProblem::UnknownClass { class, known: classes });
    }
    Ok(ClassIndex(class))
}

fn part(text: &str) -> Result<f64, RowProblem> {
    let number: f64 = text.parse().map_err(|_| RowProblem::NotANumber { text: shortened(text) })?;
    if !number.is_finite() {
        return Err(RowProblem::NotANumber { text: shortened(text) });
    }
    // Six digits after the point leave a millionth of rounding.
    if !(-1e-6..=1.0 + 1e-6).contains(&number) {
        return Err(RowProblem::OffImage { text: shortened(text) });
    }
    Ok(number)
}

fn around(corners: &[f64]) -> [f64; 4] {
    let mut edges = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for corner in corners.chunks_exact(2) {
        edges[0] = edges[0].min(corner[0]);
        edges[1] = edges[1].min(corner[1]);
        edges[2] = edges[2].max(corner[0]);
        edges[3] = edges[3].max(corner[1]);
    }
    edges
}
