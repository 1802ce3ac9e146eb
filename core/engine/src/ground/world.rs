//! The eyes of the robot and those of the twin are different eyes, and so are their arms: each have
//! their own pairs, touches, calibration and history, and what was found out of one is never used
//! for the other.

use std::path::{Path, PathBuf};

use plumbline_hardware::SourceSpec;

/// Whose eyes, whose arm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum World {
    /// The robot's, live or recorded.
    #[default]
    Robot,
    /// The simulated robot's.
    Twin,
}

impl World {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Robot, Self::Twin];

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
            Some(SourceSpec::Twin | SourceSpec::Recording { of_twin: true, .. }) => Self::Twin,
            _ => Self::Robot,
        }
    }
}

/// Something that there is once per world.
#[derive(Clone, Debug, Default)]
pub struct PerWorld<T> {
    robot: T,
    twin: T,
}

impl<T> PerWorld<T> {
    /// Made for each.
    pub fn new(mut make: impl FnMut(World) -> T) -> Self {
        Self { robot: make(World::Robot), twin: make(World::Twin) }
    }

    /// That of a world.
    pub fn of(&self, world: World) -> &T {
        match world {
            World::Robot => &self.robot,
            World::Twin => &self.twin,
        }
    }

    /// That of a world.
    pub fn of_mut(&mut self, world: World) -> &mut T {
        match world {
            World::Robot => &mut self.robot,
            World::Twin => &mut self.twin,
        }
    }

    /// Both.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut T> {
        [&mut self.robot, &mut self.twin].into_iter()
    }
}
