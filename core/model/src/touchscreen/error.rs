//! Why the screen was not placed, or a placement not read.

use std::path::PathBuf;

use crate::formats::FormatError;

/// Why the screen was not placed, or a placement not read or written.
#[derive(Debug, thiserror::Error)]
pub enum PlacementError {
    /// Fewer than three touches.
    #[error("{touches} touched places do not tell how the screen lies: touch at least three of its corners")]
    TooFew {
        /// How many there were.
        touches: usize,
    },
    /// A touch is not a number, or the screen has no size.
    #[error("{what} is not a number that can be used: leave it out or measure it again")]
    NotFinite {
        /// Which.
        what: String,
    },
    /// A pixel that the screen does not have.
    #[error(
        "touch {number} at pixel ({u_px:.0}, {v_px:.0}) lies beside the screen of {width_px}×{height_px} pixels: \
         check the resolution in the rig file"
    )]
    OffScreen {
        /// Which touch, counted from 1.
        number: usize,
        /// Its column.
        u_px: f64,
        /// Its row.
        v_px: f64,
        /// Pixels across.
        width_px: u32,
        /// Pixels down.
        height_px: u32,
    },
    /// All touches near one line.
    #[error(
        "the touched places lie on a line (they spread {} mm across it), so how the screen is turned about it \
         stays unknown: touch a corner away from it", mm(.spread_m)
    )]
    OnALine {
        /// Standard deviation across the line, m.
        spread_m: f64,
    },
    /// The placed screen would face away.
    #[error(
        "the touches only fit to a mirrored screen: corners were touched in another order, or the rig file's \
         u_axis and v_axis have the wrong handedness"
    )]
    Mirrored,
    /// The placed screen would be turned very far.
    #[error(
        "the touches fit to a screen turned by {:.0}° from where the rig file places it: corners were touched \
         in another order, or the rig file is of another table", .turned_rad.to_degrees()
    )]
    Turned {
        /// Angle, rad.
        turned_rad: f64,
    },
    /// The touches do not fit to a rigid screen of this size.
    #[error(
        "the touches miss a screen of this size by {} mm rms (the worst is touch {worst} with {} mm): check the \
         size in the rig file, and that the fingertip of the model is the one that touched",
        mm(.rms_m), mm(.worst_m)
    )]
    Implausible {
        /// √(Σ|residual|² / touches), m.
        rms_m: f64,
        /// The touch that fits least, counted from 1.
        worst: usize,
        /// Its distance, m.
        worst_m: f64,
    },
    /// The file cannot be read or written.
    #[error(transparent)]
    File(#[from] FormatError),
    /// Not a placement.
    #[error("{file} is not a screen placement that this program reads: {reason}. Place the screen again")]
    NotPlacement {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A placement for another rig.
    #[error(
        "the screen placement belongs to the rig \"{found}\", not to \"{expected}\": place the screen again"
    )]
    OtherRig {
        /// Rig of the placement.
        found: String,
        /// Rig it was to be used with.
        expected: String,
    },
    /// Written before [`ScreenPlacement::of_rig`].
    #[error("the screen placement does not say which rig it belongs to: name it first")]
    NoRig,
}

fn mm(meters: &f64) -> String {
    format!("{:.1}", meters * 1e3)
}
