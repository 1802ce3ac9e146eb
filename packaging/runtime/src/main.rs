//! What an AppImage of Plumbline starts with, on its own file; what is packed lies behind it.
//!
//! It does what the specification of AppImages says where there is no FUSE: without options it unpacks the
//! image, once, into the user's caches, and becomes the program that lies there.

mod cache;
mod contents;
mod error;
mod image;
mod temporary;

use std::ffi::OsString;
use std::fs::File;
use std::io::Write;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, ExitCode};

use contents::Contents;
use error::Error;
use image::Image;

const HELP: &str = "\
Options of the image; all others are the program's.

  --appimage-extract [PATTERN]  unpack into squashfs-root here: all, or what has such a path
  --appimage-extract-and-run    unpack into the folder for temporary files, run, and remove it again;
                                APPIMAGE_EXTRACT_AND_RUN=1 in the environment does the same
  --appimage-offset             where in this file the squashfs starts, in bytes
  --appimage-version            version of what starts this image
  --appimage-help               this text

Without them the image is unpacked once, into $XDG_CACHE_HOME/plumbline or ~/.cache/plumbline, and run
from there. What an older image was unpacked to is removed when nobody runs it any more.
";

fn main() -> ExitCode {
    match run(&std::env::args_os().collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("plumbline: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[OsString]) -> Result<(), Error> {
    let option = arguments.get(1).map(|option| option.to_string_lossy());
    let option = option.as_deref().filter(|option| option.starts_with("--appimage-"));
    let of_option = arguments.get(2);
    let image = || Image::open(&std::env::current_exe().map_err(Error::NoSelf)?);
    match option {
        Some("--appimage-help") => print(HELP),
        Some("--appimage-version") => print(&format!("{}\n", env!("CARGO_PKG_VERSION"))),
        Some("--appimage-offset") => print(&format!("{}\n", image()?.offset)),
        Some("--appimage-extract") => {
            extract(&image()?, of_option.map(|pattern| pattern.to_string_lossy()).as_deref())
        }
        Some("--appimage-extract-and-run") => temporary::run(&image()?, arguments, &arguments[2..]),
        Some(temporary::CLEAN_UP) => temporary::clean_up(of_option.map(Path::new)),
        Some(other) => Err(Error::NoSuchOption(other.to_owned())),
        None if std::env::var_os("APPIMAGE_EXTRACT_AND_RUN").is_some_and(|value| value == "1") => {
            temporary::run(&image()?, arguments, arguments.get(1..).unwrap_or_default())
        }
        None => run_from_cache(&image()?, arguments),
    }
}

fn print(text: &str) -> Result<(), Error> {
    // Who closed the pipe does not want to know.
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
    Ok(())
}

fn run_from_cache(image: &Image, arguments: &[OsString]) -> Result<(), Error> {
    let contents = Contents::read(image)?;
    let caches = cache::folder()?;
    let held = cache::hold(&caches, image, &contents)?;
    cache::remove_older(&caches, image, contents.made_at());
    become_program(image, &held.folder, &held.lock, arguments, arguments.get(1..).unwrap_or_default())
}

/// Runs what was unpacked in place of this process. The lock goes with it, and ends with the last process
/// that came of it.
fn become_program(
    image: &Image,
    folder: &Path,
    lock: &File,
    arguments: &[OsString],
    of_program: &[OsString],
) -> Result<(), Error> {
    let path = folder.join("AppRun");
    let cannot = |source| Error::CannotStart { path: path.clone(), source, elsewhere: cache::ELSEWHERE };
    rustix::io::fcntl_setfd(lock, rustix::io::FdFlags::empty()).map_err(|error| cannot(error.into()))?;
    let mut program = Command::new(&path);
    program.args(of_program).env("APPIMAGE", &image.path).env("APPDIR", folder);
    program.env("ARGV0", arguments.first().unwrap_or(&OsString::new()));
    // A folder that was removed under somebody has no path.
    if let Ok(here) = std::env::current_dir() {
        program.env("OWD", here);
    }
    Err(cannot(program.exec()))
}

/// Unpacks beside whoever calls and says what.
fn extract(image: &Image, pattern: Option<&str>) -> Result<(), Error> {
    let contents = Contents::read(image)?;
    let paths = match pattern {
        Some(pattern) => contents.matching(pattern)?,
        None => contents.all(),
    };
    image.verify()?;
    const ELSEWHERE: &str = "call it in a folder on another disk";
    let folder = Path::new("squashfs-root");
    let cannot = |source| Error::writing(folder, source, ELSEWHERE);
    match folder.symlink_metadata() {
        Ok(found) if found.is_dir() => {}
        Ok(_) => return Err(cannot(std::io::ErrorKind::NotADirectory.into())),
        Err(_) => std::fs::create_dir(folder).map_err(cannot)?,
    }
    room_for(contents.bytes_of(&paths), folder, ELSEWHERE)?;
    contents.unpack(&paths, folder, ELSEWHERE)?;
    print(&paths.iter().map(|path| format!("{}\n", folder.join(path).display())).collect::<String>())
}

/// That the disk has room for all of an image.
fn room_for(bytes: u64, folder: &Path, elsewhere: &'static str) -> Result<(), Error> {
    // Blocks that are not full, and folders.
    const FOR_BLOCKS_BYTES: u64 = 4_000_000;
    let needed = bytes.saturating_add(FOR_BLOCKS_BYTES);
    // A file system that does not tell is tried.
    let Ok(disk) = rustix::fs::statvfs(folder) else { return Ok(()) };
    let free = disk.f_bavail.saturating_mul(disk.f_frsize);
    match free >= needed {
        true => Ok(()),
        false => Err(Error::NoRoom {
            folder: folder.to_owned(),
            needed_mb: needed.div_ceil(1_000_000),
            free_mb: free / 1_000_000,
            elsewhere,
        }),
    }
}
