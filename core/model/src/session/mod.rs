//! Measurement sessions: a folder with a manifest and plain tables, from which every result can
//! be recomputed. Format version 1; SI units, angles of the joint in radians, an empty cell
//! means "not measured".
//!
//! ```text
//! session.toml                      rig, start, touchscreen, kinematic chain
//! touches.csv                       a fingertip met the touchscreen
//! localizations.csv                 stereo vision located something whose place is known
//! poses.csv                         a point of the robot was measured from outside
//! stereo/left/*  stereo/right/*     images; the same file name makes a pair
//! log.mcap                          live streams, if recorded
//! ```

mod document;
mod error;
mod eyes_setup;
mod joint_columns;
mod localizations;
mod manifest;
mod pose_setup;
mod poses;
mod stereo_images;
mod table;
mod touches;

use std::path::{Path, PathBuf};

use crate::files;

pub use error::{Cell, SessionError};
pub use eyes_setup::CalibratedAt;
pub use localizations::{LocalizationRow, LocalizationTable};
pub use manifest::{Chain, Manifest, RigReference, Touchscreen};
pub use pose_setup::{EncoderSide, PoseSetup};
pub use poses::{External, PoseRow, PoseTable};
pub use stereo_images::{StereoImagePair, StereoImages, UnpairedImage};
pub use table::{Column, ColumnValues, Table};
pub use touches::{ExtraColumn, Screen, TouchRow, TouchTable};

pub use crate::session_names as names;

/// A session in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// What was measured with what, and when.
    pub manifest: Manifest,
    /// `touches.csv`.
    pub touches: Option<TouchTable>,
    /// `localizations.csv`.
    pub localizations: Option<LocalizationTable>,
    /// `poses.csv`.
    pub poses: Option<PoseTable>,
    /// Images under `stereo/`: paths, not pixels.
    pub stereo: StereoImages,
    /// Path of `log.mcap`, if there is one.
    pub log: Option<PathBuf>,
}

impl Session {
    /// With this manifest and nothing measured yet.
    pub fn new(manifest: Manifest) -> Self {
        Self {
            manifest,
            touches: None,
            localizations: None,
            poses: None,
            stereo: StereoImages::default(),
            log: None,
        }
    }

    /// Reads a session folder; images and log are listed, not opened.
    pub fn read(folder: &Path) -> Result<Self, SessionError> {
        if !folder.is_dir() {
            return Err(SessionError::NotAFolder { folder: folder.to_path_buf() });
        }
        let manifest = folder.join(names::MANIFEST);
        if !files::present(&manifest)? {
            return Err(SessionError::NoManifest { folder: folder.to_path_buf() });
        }
        let manifest = Manifest::read(&manifest)?;
        let existing = |name: &str| -> Result<Option<PathBuf>, SessionError> {
            let file = folder.join(name);
            Ok(files::present(&file)?.then_some(file))
        };
        let joints = |file: &Path| manifest.chain_for(file).map(|chain| chain.joints.as_slice());
        let session = Self {
            touches: existing(names::TOUCHES)?
                .map(|file| {
                    manifest.touchscreen_for(&file)?;
                    TouchTable::read(&file, joints(&file)?)
                })
                .transpose()?,
            localizations: existing(names::LOCALIZATIONS)?
                .map(|file| LocalizationTable::read(&file))
                .transpose()?,
            poses: existing(names::POSES)?.map(|file| PoseTable::read(&file, joints(&file)?)).transpose()?,
            stereo: StereoImages::list(&folder.join(names::STEREO))?,
            log: existing(names::LOG)?,
            manifest,
        };
        if session.is_empty() {
            return Err(SessionError::NothingMeasured { folder: folder.to_path_buf() });
        }
        Ok(session)
    }

    /// Rows that hold a number that cannot be: table, row counted from 0, and what is wrong with it.
    /// They are in the tables as rows in which nothing was measured.
    pub fn implausible(&self) -> impl Iterator<Item = (&'static str, usize, &str)> {
        let tables = [
            (names::TOUCHES, self.touches.as_ref().map(TouchTable::implausible)),
            (names::LOCALIZATIONS, self.localizations.as_ref().map(LocalizationTable::implausible)),
            (names::POSES, self.poses.as_ref().map(PoseTable::implausible)),
        ];
        tables.into_iter().flat_map(|(name, rows)| {
            rows.into_iter().flatten().map(move |(row, what)| (name, *row, what.as_str()))
        })
    }

    fn is_empty(&self) -> bool {
        self.touches.is_none()
            && self.localizations.is_none()
            && self.poses.is_none()
            && self.stereo.is_empty()
            && self.log.is_none()
    }

    /// Writes manifest and tables into the folder, which is made if need be. Each file replaces
    /// its predecessor in one step; tables that this session does not have, images and the log
    /// are left as they are.
    pub fn write(&self, folder: &Path) -> Result<(), SessionError> {
        files::make_folder(folder)?;
        let touches = self.touches.as_ref().map(|table| (names::TOUCHES, table.table()));
        let localizations = self.localizations.as_ref().map(|table| (names::LOCALIZATIONS, table.table()));
        let poses = self.poses.as_ref().map(|table| (names::POSES, table.table()));
        if touches.is_some() {
            self.manifest.touchscreen_for(&folder.join(names::TOUCHES))?;
        }
        for (name, _) in touches.iter().chain(&poses) {
            self.manifest.chain_for(&folder.join(name))?;
        }
        for (name, table) in touches.into_iter().chain(localizations).chain(poses) {
            table.write(&folder.join(name))?;
        }
        self.manifest.write(&folder.join(names::MANIFEST))
    }
}
