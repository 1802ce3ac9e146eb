//! What may stand where a file is expected.

use std::os::unix::fs::symlink;
use std::path::Path;

use rustix::fs::{CWD, FileType, Mode, mknodat};
use strum::VariantArray;

use crate::dice::Dice;

/// No file, or no ordinary one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, VariantArray)]
pub enum Special {
    /// A folder.
    Folder,
    /// A folder with something in it.
    FullFolder,
    /// A link to nothing.
    DanglingLink,
    /// A link to itself.
    CircularLink,
    /// A pipe that nobody writes to.
    Pipe,
    /// A device that never ends.
    EndlessDevice,
    /// A device that is empty.
    EmptyDevice,
    /// Nothing of that name.
    Missing,
}

impl Special {
    /// One of them.
    pub fn any(dice: &mut Dice) -> Self {
        *dice.pick(Self::VARIANTS)
    }

    /// Puts it in the place of a file.
    ///
    /// # Errors
    /// What the file system says.
    pub fn put(self, path: &Path) -> std::io::Result<()> {
        match self {
            Self::Folder => std::fs::create_dir(path),
            Self::FullFolder => {
                std::fs::create_dir(path)?;
                std::fs::write(path.join("data.yaml"), "names: [a]\n")
            }
            Self::DanglingLink => symlink("nothing-of-that-name", path),
            Self::CircularLink => match path.file_name() {
                Some(name) => symlink(name, path),
                None => Ok(()),
            },
            Self::Pipe => Ok(mknodat(CWD, path, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0)?),
            Self::EndlessDevice => symlink("/dev/zero", path),
            Self::EmptyDevice => symlink("/dev/null", path),
            Self::Missing => Ok(()),
        }
    }
}
