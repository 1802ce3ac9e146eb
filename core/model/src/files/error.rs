//! What can be wrong with a file as such, whatever is in it.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::size::Size;

/// What a path names if it is no ordinary file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A folder.
    Folder,
    /// A named pipe: reading waits until somebody writes.
    Pipe,
    /// A socket.
    Socket,
    /// A device node, such as `/dev/zero`.
    Device,
    /// Something else.
    Other,
}

impl Kind {
    /// What this is; `None` for an ordinary file.
    pub(super) fn of(about: &std::fs::Metadata) -> Option<Self> {
        let kind = about.file_type();
        if kind.is_file() {
            return None;
        }
        if kind.is_dir() {
            return Some(Self::Folder);
        }
        #[cfg(unix)]
        {
            use std::os::unix::fs::FileTypeExt;
            if kind.is_fifo() {
                return Some(Self::Pipe);
            }
            if kind.is_socket() {
                return Some(Self::Socket);
            }
            if kind.is_char_device() || kind.is_block_device() {
                return Some(Self::Device);
            }
        }
        Some(Self::Other)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Folder => "a folder",
            Self::Pipe => "a pipe",
            Self::Socket => "a socket",
            Self::Device => "a device",
            Self::Other => "something else",
        })
    }
}

/// Why a file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The operating system refused to read.
    #[error("{} cannot be read ({source}): check that the file exists and that you may read it", file.display())]
    Unreadable {
        /// File or folder.
        file: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A link to nothing. That is not the same as no file: somebody meant one to be there.
    #[error("{} is a link to {}, which does not exist: restore that file, or remove the link", file.display(), to.display())]
    Dangling {
        /// The link.
        file: PathBuf,
        /// What it names.
        to: PathBuf,
    },
    /// No ordinary file.
    #[error("{} is {kind}, not a file: give a file", file.display())]
    NotAFile {
        /// The path.
        file: PathBuf,
        /// What it is.
        kind: Kind,
    },
    /// More than such a file can be.
    #[error("{} is too large ({}; at most {largest} are read): check that it is the right file", file.display(), stated(*size, *largest))]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// Its size; `None` where only reading told that it is too large.
        size: Option<Size>,
        /// The limit.
        largest: Size,
    },
    /// Text is expected.
    #[error("{} is not a text file: give a text in UTF-8", file.display())]
    NotText {
        /// The file.
        file: PathBuf,
    },
    /// An image is expected.
    #[error("{} cannot be read as an image ({reason}): give a whole PNG or JPEG file", file.display())]
    NotAnImage {
        /// The file.
        file: PathBuf,
        /// What the decoder said.
        reason: String,
    },
    /// The operating system refused to write.
    #[error(
        "{} cannot be written ({source}): choose a folder that exists, has free space and lets you write; what was there before is unchanged",
        file.display()
    )]
    Unwritable {
        /// File or folder.
        file: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The target is no ordinary file.
    #[error("{} is {kind}, which is not replaced: nothing was written; choose another file name", file.display())]
    NotReplaced {
        /// The target.
        file: PathBuf,
        /// What it is.
        kind: Kind,
    },
    /// The target is a link to nothing.
    #[error(
        "{} is a link to {}, which does not exist: nothing was written; remove the link or choose another file name",
        file.display(), to.display()
    )]
    DanglingTarget {
        /// The link.
        file: PathBuf,
        /// What it names.
        to: PathBuf,
    },
    /// Somebody protected the target.
    #[error("{} is write-protected: nothing was written; choose another file name, or remove the protection", file.display())]
    Protected {
        /// The target.
        file: PathBuf,
    },
    /// It is in its place, but may not survive a power cut.
    #[error("{} was written, but the disk did not confirm it ({source}): check the disk and write it again", file.display())]
    Unconfirmed {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A measurement would be replaced by something exported.
    #[error("{} is part of the session or data set in its folder: nothing was written; choose another file name", file.display())]
    OfSession {
        /// The target.
        file: PathBuf,
    },
    /// The output is an input.
    #[error(
        "the result would replace {}, which is part of what it is computed from ({}): nothing was written; choose another file name",
        output.display(), input.display()
    )]
    IsInput {
        /// Where the result should go.
        output: PathBuf,
        /// The input that it is, or that holds it.
        input: PathBuf,
    },
}

fn stated(size: Option<Size>, largest: Size) -> String {
    size.map_or_else(|| format!("more than {largest}"), |size| size.to_string())
}

impl FileError {
    /// For `map_err`, after a refused read.
    pub fn unreadable(file: &Path) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Unreadable { file: file.to_path_buf(), source }
    }

    /// For `map_err`, after a refused write.
    pub fn unwritable(file: &Path) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Unwritable { file: file.to_path_buf(), source }
    }

    /// Whether there simply is no such file.
    pub fn is_absent(&self) -> bool {
        matches!(self, Self::Unreadable { source, .. } if source.kind() == io::ErrorKind::NotFound)
    }
}

/// For those whose own errors carry what the system said: the words and the kind stay.
impl From<FileError> for io::Error {
    fn from(error: FileError) -> Self {
        let kind = match &error {
            FileError::Unreadable { source, .. }
            | FileError::Unwritable { source, .. }
            | FileError::Unconfirmed { source, .. } => source.kind(),
            FileError::NotText { .. } | FileError::NotAnImage { .. } => io::ErrorKind::InvalidData,
            _ => io::ErrorKind::InvalidInput,
        };
        Self::new(kind, error)
    }
}
