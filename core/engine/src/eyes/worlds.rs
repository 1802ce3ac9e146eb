//! The eyes of the robot and those of the twin are different eyes: each have their own pairs,
//! calibration and history, and a calibration of one is never used for the other.

use std::path::{Path, PathBuf};

use plumbline_hardware::SourceSpec;
use plumbline_model::Workspace;

use super::EyesState;
use super::store::Store;

/// Whose eyes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum World {
    /// The robot's, live or recorded.
    #[default]
    Robot,
    /// The simulated robot's.
    Twin,
}

impl World {
    /// Where its files are kept: the twin's in a folder of its own.
    pub fn folder(self, data_dir: &Path) -> PathBuf {
        match self {
            Self::Robot => data_dir.to_owned(),
            Self::Twin => data_dir.join("twin"),
        }
    }

    /// Whose arm is connected.
    pub fn of_robot(twin: bool) -> Self {
        if twin { Self::Twin } else { Self::Robot }
    }

    /// Whose eyes a source shows.
    pub fn of(source: Option<&SourceSpec>) -> Self {
        match source {
            Some(SourceSpec::Twin) => Self::Twin,
            _ => Self::Robot,
        }
    }
}

/// The workflow once per world; one of them is shown.
#[derive(Clone, Debug)]
pub struct EyesOfWorlds {
    /// Which world the source shows.
    pub shown: World,
    robot: EyesState,
    twin: EyesState,
}

impl EyesOfWorlds {
    /// Nothing collected.
    pub fn new(data_dir: &Path, workspace: Workspace) -> Self {
        let eyes = |world: World| {
            let folder = world.folder(data_dir);
            EyesState::new(Store::new(folder.join("calibrations")), folder.join("sessions"), workspace)
        };
        Self { shown: World::default(), robot: eyes(World::Robot), twin: eyes(World::Twin) }
    }

    /// The eyes that the source shows.
    pub fn shown(&self) -> &EyesState {
        self.of(self.shown)
    }

    /// The eyes of a world.
    pub fn of(&self, world: World) -> &EyesState {
        match world {
            World::Robot => &self.robot,
            World::Twin => &self.twin,
        }
    }

    /// The eyes of a world.
    pub fn of_mut(&mut self, world: World) -> &mut EyesState {
        match world {
            World::Robot => &mut self.robot,
            World::Twin => &mut self.twin,
        }
    }

    /// Where the eyes are over the table, for the maps of the next assessment.
    pub fn set_workspace(&mut self, workspace: Workspace) {
        self.robot.set_workspace(workspace);
        self.twin.set_workspace(workspace);
    }
}
