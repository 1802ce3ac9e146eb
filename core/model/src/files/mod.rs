//! The one room in which files are read whole and written.
//!
//! **Reading** refuses what is no ordinary file (a pipe would wait forever, `/dev/zero` never
//! ends), and what is larger than its kind of file can be, before it is in memory.
//!
//! **Writing** goes to a temporary file beside the target, to the disk, and then to its name, so
//! that a crash, a kill or a full disk leaves the old file or the new one, never half of one.
//!
//! **What grows** while something goes on ([`Growing`]) is added to piece by piece, and never half of one.
//!
//! **An output is never one of the inputs**: [`output`] is asked before the work begins.

mod error;
mod grow;
mod image;
mod output;
mod presence;
mod read;
mod shown;
mod size;
mod sweep;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_write;
mod write;

pub use error::{FileError, Kind};
pub use grow::Growing;
pub use image::{open_image, read_image, write_png};
pub use output::{export, output};
pub use presence::{is_hidden, present};
pub use read::{check, open, read, read_text};
pub use shown::{MOST_SHOWN, MOST_TOLD, shortened, told};
pub use size::{MOST_ROWS, Size};
pub use write::{Replacement, make_folder, make_new_folder, write, write_with};
