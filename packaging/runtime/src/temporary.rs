//! Unpacked for one run only: into the folder for temporary files, and away when the run has ended.

use std::ffi::OsString;
use std::fs::{DirBuilder, File, OpenOptions};
use std::os::unix::fs::DirBuilderExt;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::contents::Contents;
use crate::error::Error;
use crate::image::Image;

/// The option that the image starts itself with to wait for the end of a run.
pub const CLEAN_UP: &str = "--appimage-clean-up";

/// How to have an image unpacked to another place.
const ELSEWHERE: &str = "set TMPDIR to a folder on another disk";
const NAME: &str = "plumbline-run-";
const LOCK: &str = "lock";
const UNPACKED: &str = "AppDir";

/// Unpacks, leaves somebody behind who removes it, and becomes the program. So signals and exit codes are
/// the program's own, and a kill of it leaves nothing.
pub fn run(image: &Image, arguments: &[OsString], of_program: &[OsString]) -> Result<(), Error> {
    let contents = Contents::read(image)?;
    image.verify()?;
    let place = std::env::temp_dir();
    let place = std::path::absolute(&place).map_err(|source| Error::CannotWrite {
        path: place,
        source,
        elsewhere: ELSEWHERE,
    })?;
    crate::room_for(contents.bytes(), &place, ELSEWHERE)?;
    let folder = make_folder(&place)?;
    let unpacked = folder.join(UNPACKED);
    let ready = unpack(&contents, &folder, &unpacked).and_then(|lock| {
        leave_somebody(image, &folder)?;
        Ok(lock)
    });
    let started =
        ready.and_then(|lock| crate::become_program(image, &unpacked, &lock, arguments, of_program));
    // Only what failed comes back; what says why comes first.
    let _ = std::fs::remove_dir_all(&folder);
    started
}

fn make_folder(place: &Path) -> Result<PathBuf, Error> {
    for try_number in 0.. {
        let folder = place.join(format!("{NAME}{}-{try_number}", std::process::id()));
        match DirBuilder::new().mode(0o700).create(&folder) {
            Ok(()) => return Ok(folder),
            // Left by a process of the same number.
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists && try_number < 100 => {}
            Err(source) => return Err(Error::writing(&folder, source, ELSEWHERE)),
        }
    }
    unreachable!("the last try ends it")
}

/// The lock is held before anybody waits for it.
fn unpack(contents: &Contents, folder: &Path, unpacked: &Path) -> Result<File, Error> {
    let cannot = |source| Error::writing(folder, source, ELSEWHERE);
    let lock = OpenOptions::new().write(true).create_new(true).open(folder.join(LOCK)).map_err(cannot)?;
    lock.lock_shared().map_err(cannot)?;
    DirBuilder::new().mode(0o700).create(unpacked).map_err(cannot)?;
    contents.unpack(&contents.all(), unpacked, ELSEWHERE)?;
    Ok(lock)
}

/// A process that outlives this one. What interrupts the program at a terminal does not reach it.
fn leave_somebody(image: &Image, folder: &Path) -> Result<(), Error> {
    let mut command = Command::new(&image.path);
    command.arg(CLEAN_UP).arg(folder).process_group(0).current_dir("/");
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let left = command.spawn().map(|_| ());
    left.map_err(|source| Error::CannotStart { path: image.path.clone(), source, elsewhere: ELSEWHERE })
}

/// Waits until nobody runs from the folder any more and removes it; nothing but what [`run`] made.
pub fn clean_up(folder: Option<&Path>) -> Result<(), Error> {
    let no_option = || Error::NoSuchOption(CLEAN_UP.to_owned());
    let is_ours =
        |folder: &&Path| folder.file_name().is_some_and(|name| name.to_string_lossy().starts_with(NAME));
    let folder = folder.filter(is_ours).ok_or_else(no_option)?;
    let cannot = |source| Error::writing(folder, source, ELSEWHERE);
    let lock = File::open(folder.join(LOCK)).map_err(cannot)?;
    lock.lock().map_err(cannot)?;
    std::fs::remove_dir_all(folder).map_err(cannot)
}
