//! What can be asked of the source, and what of it the source's thread does.

use std::path::PathBuf;

use plumbline_hardware::SourceSpec;
use serde::{Deserialize, Serialize};

/// Where the images come from and, for recordings, how they are played.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SourceCommand {
    /// Opens a source in place of the present one.
    Open(SourceSpec),
    /// Opens what these paths mean: a folder of pairs, two folders, two videos, or image files.
    OpenPaths(Vec<PathBuf>),
    /// Stops delivering and forgets the source.
    Close,
    /// Tries a lost source again at once.
    Retry,
    /// Plays a recording.
    Play,
    /// Holds a recording (or a camera's picture) still.
    Pause,
    /// Moves by this many pairs and stays there; negative goes back.
    Step(i64),
    /// Shows the pair with this index (0 is the first).
    Seek(u64),
    /// Starts over at the end.
    Loop(bool),
    /// Pairs per second at which a recording is played.
    PairsPerSecond(f64),
    /// Goes to the end of a recording that is still being written, and on with what comes; or stays.
    Follow(bool),
    /// Looks which cameras this machine has, see [`crate::view::SourceView::cameras`].
    ListCameras,
}

/// What the operator does with the source.
#[derive(Clone, Debug, PartialEq)]
pub enum Control {
    /// Opens a source in place of the present one.
    Open(SourceSpec),
    /// Opens what these paths mean.
    OpenPaths(Vec<PathBuf>),
    /// Forgets the source.
    Close,
    /// Tries a lost source at once.
    Retry,
    /// Goes on by itself.
    Play,
    /// Stays.
    Pause,
    /// Moves by so many pairs and stays.
    Step(i64),
    /// Shows this pair.
    Seek(u64),
    /// Starts over at the end.
    Loop(bool),
    /// Changes the rate of a recording.
    PairsPerSecond(f64),
    /// Stays at the end of a recording that is still being written, or does so no more.
    Follow(bool),
}

impl Control {
    /// The part of a command that concerns the source itself.
    pub fn from_command(command: SourceCommand) -> Option<Self> {
        Some(match command {
            SourceCommand::Open(spec) => Self::Open(spec),
            SourceCommand::OpenPaths(paths) => Self::OpenPaths(paths),
            SourceCommand::Close => Self::Close,
            SourceCommand::Retry => Self::Retry,
            SourceCommand::Play => Self::Play,
            SourceCommand::Pause => Self::Pause,
            SourceCommand::Step(by) => Self::Step(by),
            SourceCommand::Seek(index) => Self::Seek(index),
            SourceCommand::Loop(looping) => Self::Loop(looping),
            SourceCommand::PairsPerSecond(rate) => Self::PairsPerSecond(rate),
            SourceCommand::Follow(on) => Self::Follow(on),
            SourceCommand::ListCameras => return None,
        })
    }
}
