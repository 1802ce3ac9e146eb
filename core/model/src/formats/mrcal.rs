//! Observed corners as mrcal's `corners.vnl`, so that its solvers and its uncertainty analysis
//! can run on the same views: one line per corner, `# filename x y weight`, `-` for none.

use std::fmt::Write;
use std::path::Path;

use super::error::FormatError;
use super::text_file;
use crate::calibration::Evidence;
use crate::pixel::Eye;

/// Writes every observation offered to the solver. Images are called `left/NAME` and
/// `right/NAME`, so that `left/*` and `right/*` are mrcal's globs of the two cameras; the board
/// is `--object-width-n inner_columns --object-height-n inner_rows --object-spacing square_m`.
///
/// Pairs that the operator dropped are not written; all corners get weight 1.
pub fn write_corners(evidence: &Evidence, file: &Path) -> Result<(), FormatError> {
    let board = &evidence.board;
    let mut out = format!(
        "## board of {}x{} inner corners, squares of {:?} m\n# filename x y weight\n",
        board.inner_columns, board.inner_rows, board.square_m
    );
    let kept = evidence.observations.iter().filter(|pair| !evidence.dropped_pairs.contains(&pair.name));
    for pair in kept {
        if pair.name.is_empty() || pair.name.chars().any(char::is_whitespace) {
            return Err(FormatError::CannotCarry {
                format: "mrcal corners.vnl",
                what: format!("the space in the name of the pair \"{}\"", pair.name),
                instead: "rename the images without spaces and collect them again",
            });
        }
        for eye in Eye::BOTH {
            append_view(&mut out, &format!("{eye}/{}", pair.name), pair.corners(eye).map(Vec::as_slice));
        }
    }
    text_file::write(file, &out)
}

fn append_view(out: &mut String, name: &str, corners: Option<&[Option<crate::Pixel<crate::Raw>>]>) {
    // Writing to a String cannot fail.
    let Some(corners) = corners else {
        let _ = writeln!(out, "{name} - - -");
        return;
    };
    for corner in corners {
        let _ = match corner {
            Some(pixel) => writeln!(out, "{name} {:?} {:?} 1", pixel.u_px, pixel.v_px),
            None => writeln!(out, "{name} - - -"),
        };
    }
}
