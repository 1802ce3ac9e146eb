//! Images made for tests: the runtime as it was built, a squashfs and the line that seals it.

use std::io::{Cursor, Read, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, PoisonError};

use backhand::compression::Compressor;
use backhand::{FilesystemCompressor, FilesystemWriter, NodeHeader};
use sha2::{Digest, Sha256};

/// Says what it was told and ends with 7.
pub const TELLS: &str = "#!/bin/sh\necho \"$APPIMAGE|$APPDIR|$ARGV0|$OWD|$*\"\nexit 7\n";
/// Says that it runs, and runs until its input ends.
pub const WAITS: &str = "#!/bin/sh\necho runs\nread -r line\n";

/// A process that is forked while another thread writes an image has that file open until it becomes the
/// program it is to be, and nobody can start the image until then.
static FORKS: Mutex<()> = Mutex::new(());

pub fn spawn(command: &mut Command) -> Child {
    let _alone = FORKS.lock().unwrap_or_else(PoisonError::into_inner);
    command.spawn().expect("it starts")
}

pub fn output(command: &mut Command) -> Output {
    spawn(command).wait_with_output().expect("it ends")
}

/// A place with an image in it and caches beside it.
pub struct Place {
    pub folder: tempfile::TempDir,
}

/// What an image is made of.
pub struct Packed<'a> {
    pub writer: FilesystemWriter<'a, 'a, 'a>,
}

impl<'a> Packed<'a> {
    /// With this script to run, made so many seconds after the first of all times.
    pub fn new(script: &'a str, made_at_s: u32) -> Self {
        let mut packed = Self { writer: FilesystemWriter::default() };
        let gzip = FilesystemCompressor::new(Compressor::Gzip, None).expect("gzip");
        packed.writer.set_compressor(gzip);
        packed.writer.set_time(made_at_s);
        packed.writer.set_root_mode(0o755);
        packed.file("AppRun", 0o755, script.as_bytes());
        packed.folder("share");
        packed.file("share/plumbline.svg", 0o644, b"<svg/>");
        packed.link(".DirIcon", "share/plumbline.svg");
        packed
    }

    pub fn file(&mut self, path: &str, mode: u16, content: &'a [u8]) {
        self.writer.push_file(Cursor::new(content), path, header(mode)).expect("a file");
    }

    pub fn folder(&mut self, path: &str) {
        self.writer.push_dir(path, header(0o755)).expect("a folder");
    }

    pub fn link(&mut self, path: &str, to: &str) {
        self.writer.push_symlink(to, path, header(0o777)).expect("a link");
    }

    pub fn squashfs(mut self) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        self.writer.write(&mut bytes).expect("a squashfs");
        bytes.into_inner()
    }
}

fn header(mode: u16) -> NodeHeader {
    NodeHeader { permissions: mode, ..NodeHeader::default() }
}

/// The squashfs with a name of its folders changed to one of the same length, which nobody who makes one
/// would write.
pub fn renamed(mut squashfs: Vec<u8>, name: &[u8], to: &[u8]) -> Vec<u8> {
    // Where the table of folders starts, and its first block: how long it is when compressed, and its bytes.
    let start = u64::from_le_bytes(squashfs[72..80].try_into().expect("eight bytes")) as usize;
    let bytes = usize::from(u16::from_le_bytes(squashfs[start..start + 2].try_into().expect("two bytes")));
    let block = start + 2..start + 2 + bytes;
    let mut names = Vec::new();
    flate2::read::ZlibDecoder::new(&squashfs[block.clone()]).read_to_end(&mut names).expect("compressed");
    let at = names.windows(name.len()).position(|part| part == name).expect("the name");
    names[at..at + to.len()].copy_from_slice(to);
    let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    packed.write_all(&names).expect("in memory");
    let mut packed = packed.finish().expect("in memory");
    assert!(packed.len() <= bytes, "{} do not fit into {bytes}", packed.len());
    // What follows the end of the compressed bytes is not read.
    packed.resize(bytes, 0);
    squashfs[block].copy_from_slice(&packed);
    squashfs
}

pub fn runtime() -> Vec<u8> {
    std::fs::read(env!("CARGO_BIN_EXE_plumbline-runtime")).expect("the runtime")
}

/// All of an image, sealed.
pub fn sealed(squashfs: &[u8]) -> Vec<u8> {
    let mut image = [runtime(), squashfs.to_vec()].concat();
    let sum: String = Sha256::digest(&image).iter().map(|byte| format!("{byte:02x}")).collect();
    image.extend(format!("\nplumbline-image sha256 {sum}\n").into_bytes());
    image
}

/// What a process said: its output and its errors.
pub fn said(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr))
}

impl Place {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a folder") }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, image: &[u8]) -> PathBuf {
        let path = self.path(name);
        let _alone = FORKS.lock().unwrap_or_else(PoisonError::into_inner);
        std::fs::write(&path, image).expect("written");
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).expect("executable");
        path
    }

    pub fn put(&self, name: &str, packed: Packed<'_>) -> PathBuf {
        self.write(name, &sealed(&packed.squashfs()))
    }

    /// The image with its caches and temporary files here, and nothing else of this environment.
    pub fn command(&self, image: &Path) -> Command {
        let mut command = Command::new(image);
        self.at_home(&mut command);
        command
    }

    /// So that a command's caches and temporary files are here.
    pub fn at_home<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        let path = std::env::var_os("PATH").unwrap_or_default();
        std::fs::create_dir_all(self.path("temporary")).expect("a folder");
        command.env_clear().env("PATH", path).env("XDG_CACHE_HOME", self.path("caches"));
        command.env("TMPDIR", self.path("temporary")).current_dir(self.folder.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped())
    }

    pub fn start(&self, image: &Path, arguments: &[&str]) -> Output {
        output(self.command(image).args(arguments))
    }

    /// Names of what lies among the caches.
    pub fn cached(&self) -> Vec<String> {
        names(&self.path("caches/plumbline"))
    }

    /// What was unpacked.
    pub fn unpacked(&self) -> Vec<PathBuf> {
        let whole = self.cached().into_iter().filter(|name| !name.contains('.'));
        whole.map(|name| self.path("caches/plumbline").join(name)).collect()
    }
}

pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
