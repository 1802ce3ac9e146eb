//! The chessboard pairs of two folders.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use plumbline_engine::eyes::work::{Collected, collect_folder};
use plumbline_engine::ground::text::sentence;
use plumbline_hardware::{PairFiles, PairFolder};
use plumbline_model::{Chessboard, InnerCorners, JobContext, PairObservation, StereoCameras};

use super::OfflineError;
use super::error::size_text;

/// Pairs in which both eyes see the board, and what became of the others.
pub struct BoardPairs {
    /// The board.
    pub board: Chessboard,
    /// Corners of both eyes.
    pub observations: Vec<PairObservation>,
    /// Name and reason of pairs in which an eye does not see the board.
    pub not_found: Vec<(String, String)>,
    /// Names of pairs that were left out as asked.
    pub excluded: Vec<String>,
    /// Size (width, height) of both images.
    pub sizes_px: [(u32, u32); 2],
    /// Where the images are, for people.
    pub title: String,
    /// What was noticed about the files.
    pub notes: Vec<String>,
}

/// Finds the board in all pairs of two folders but the excluded ones.
pub fn find_board(
    [left, right]: [&Path; 2],
    inner: InnerCorners,
    square_m: f64,
    exclude: &[PathBuf],
    context: &dyn JobContext,
) -> Result<BoardPairs, OfflineError> {
    let board = Chessboard::new(inner.columns, inner.rows, square_m)?;
    // One folder that holds both eyes (left01.jpg, right01.jpg) may be named twice.
    let folder = if left == right { PairFolder::open_one(left)? } else { PairFolder::open_two(left, right)? };
    let (excluded, wanted) = split(folder.pairs(), exclude)?;
    let collected = collect_folder(&folder, &wanted, &board, context)?;
    let notes = folder.reports().iter().map(|report| sentence(&report.to_string())).collect();
    let Collected { pairs, not_collected, sizes_px, .. } = collected;
    let (Some(sizes_px), false) = (sizes_px, pairs.is_empty()) else {
        let example = not_collected.first().map(|(name, reason)| format!("For example {name}: {reason}"));
        return Err(OfflineError::BoardNeverSeen {
            pairs: wanted.len(),
            board: board.to_string(),
            example: example.unwrap_or_default(),
        });
    };
    let observations = pairs
        .into_iter()
        .map(|pair| PairObservation { name: pair.name, left: pair.left, right: pair.right })
        .collect();
    Ok(BoardPairs {
        board,
        observations,
        not_found: not_collected,
        excluded: excluded.into_iter().map(|pair| pair.name.clone()).collect(),
        sizes_px,
        title: folder.title(),
        notes,
    })
}

type Split<'a> = (Vec<&'a PairFiles>, Vec<&'a PairFiles>);

/// Excluded and wanted pairs. A pair is excluded by the file name of either of its images.
fn split<'a>(pairs: &'a [PairFiles], exclude: &[PathBuf]) -> Result<Split<'a>, OfflineError> {
    let name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let mut wished: BTreeSet<String> = exclude.iter().filter_map(|path| name(path)).collect();
    let all = wished.clone();
    let (mut excluded, mut wanted) = (Vec::new(), Vec::new());
    for pair in pairs {
        let names = [name(&pair.left), name(&pair.right)];
        let hit = names.iter().flatten().any(|name| all.contains(name));
        for name in names.iter().flatten() {
            wished.remove(name);
        }
        if hit { excluded.push(pair) } else { wanted.push(pair) }
    }
    match wished.into_iter().next() {
        Some(missing) => Err(OfflineError::NothingToExclude(missing)),
        None => Ok((excluded, wanted)),
    }
}

/// Refuses a calibration of other images.
pub fn check_sizes(cameras: &StereoCameras, sizes_px: [(u32, u32); 2]) -> Result<(), OfflineError> {
    let calibrated = [cameras.left.size_px(), cameras.right.size_px()];
    match sizes_px.into_iter().zip(calibrated).find(|(images, calibrated)| images != calibrated) {
        Some((images, calibrated)) => {
            Err(OfflineError::OtherSize { images: size_text(images), calibrated: size_text(calibrated) })
        }
        None => Ok(()),
    }
}
