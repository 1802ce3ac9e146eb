//! Where measured data of the real robot lies, for tests and benchmarks. None of it is part of
//! the project: whoever has it points to it, everybody else's tests say that they were skipped.

use std::path::{Path, PathBuf};

/// The data are not on this machine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "skipped: measured data \"{name}\" are not at hand (looked in {looked_in}); set PLUMBLINE_DATA to their folder"
)]
pub struct NotAtHand {
    /// What was asked for.
    pub name: String,
    /// Folder that was searched.
    pub looked_in: String,
}

/// Folder `name` (for example `nico-chessboard`) of the measured data: in the folder named by the
/// environment variable `PLUMBLINE_DATA`, else in `shared/data` beside the checkout.
pub fn folder(name: &str) -> Result<PathBuf, NotAtHand> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let root = std::env::var_os("PLUMBLINE_DATA").map_or_else(beside, PathBuf::from);
    let folder = root.join(name);
    if folder.is_dir() {
        return Ok(folder);
    }
    Err(NotAtHand { name: name.to_owned(), looked_in: root.display().to_string() })
}
