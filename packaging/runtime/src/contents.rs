//! What is in the squashfs, and its way out: looked at as a whole before anything is written, so that no
//! entry ever lands outside of the folder.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{DirBuilder, File, OpenOptions, Permissions};
use std::io::{BufReader, Read, Write};
use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt, PermissionsExt};
use std::path::{Component, Path, PathBuf};
use std::time::{Duration, SystemTime};

use backhand::{FilesystemReader, InnerNode, SquashfsFileReader};

use crate::error::Error;
use crate::image::Image;

/// Entries of an image by their paths from its root, none of which leaves it.
pub struct Contents {
    system: FilesystemReader<'static>,
    entries: BTreeMap<PathBuf, Entry>,
    image: PathBuf,
}

#[derive(Debug, Clone)]
struct Entry {
    /// Rights of owner, group and others.
    mode: u32,
    what: What,
}

#[derive(Debug, Clone)]
enum What {
    Folder,
    File(SquashfsFileReader),
    Link(PathBuf),
    /// A device, a pipe or a socket.
    Other,
}

impl Contents {
    /// Reads the tables of the squashfs and looks at every path.
    ///
    /// # Errors
    /// [`Error::Damaged`] when they cannot be read, [`Error::Leaves`] when an entry would not stay inside.
    pub fn read(image: &Image) -> Result<Self, Error> {
        let damaged = |why: String| Error::Damaged { image: image.path.clone(), why };
        let file = File::open(&image.path).map_err(|error| damaged(error.to_string()))?;
        let system = FilesystemReader::from_reader_with_offset(BufReader::new(file), image.offset)
            .map_err(|error| damaged(format!("its squashfs cannot be read ({error})")))?;
        let mut entries = BTreeMap::new();
        for node in system.files().filter(|node| node.fullpath != Path::new("/")) {
            let what = match &node.inner {
                InnerNode::Dir(_) => What::Folder,
                InnerNode::File(file) => What::File(file.clone()),
                InnerNode::Symlink(link) => What::Link(link.link.clone()),
                _ => What::Other,
            };
            let leaves = |why| Error::Leaves { entry: node.fullpath.clone(), why };
            let path = inside(&node.fullpath).ok_or_else(|| leaves("whose name leads out of the folder"))?;
            let entry = Entry { mode: u32::from(node.header.permissions) & 0o777, what };
            if entries.insert(path, entry).is_some() {
                return Err(leaves("twice"));
            }
        }
        check(&entries)?;
        Ok(Self { system, entries, image: image.path.clone() })
    }

    /// When the image was made.
    pub fn made_at(&self) -> SystemTime {
        SystemTime::UNIX_EPOCH + Duration::from_secs(u64::from(self.system.mod_time))
    }

    /// Bytes of all files.
    pub fn bytes(&self) -> u64 {
        self.entries.values().map(|entry| entry.file_bytes().unwrap_or_default()).sum()
    }

    /// Bytes of these files.
    pub fn bytes_of(&self, paths: &BTreeSet<PathBuf>) -> u64 {
        paths.iter().filter_map(|path| self.entries.get(path)?.file_bytes()).sum()
    }

    /// Whether all of it lies in this folder. What a file holds is not looked at, only how long it is.
    pub fn are_in(&self, folder: &Path) -> bool {
        self.entries.iter().all(|(path, entry)| match (&entry.what, folder.join(path).symlink_metadata()) {
            (What::Folder, Ok(found)) => found.is_dir(),
            (What::Link(_), Ok(found)) => found.is_symlink(),
            (What::File(_), Ok(found)) => found.is_file() && Some(found.len()) == entry.file_bytes(),
            (What::Other, _) | (_, Err(_)) => false,
        })
    }

    /// Paths of the entries whose own name, or that of a folder around them, is of this pattern, with
    /// the folders that they lie in.
    ///
    /// # Errors
    /// When that is no pattern, or no entry is of it.
    pub fn matching(&self, pattern: &str) -> Result<BTreeSet<PathBuf>, Error> {
        let by = glob::Pattern::new(pattern.strip_prefix("./").unwrap_or(pattern).trim_start_matches('/'))
            .map_err(|error| Error::Pattern { pattern: pattern.to_owned(), why: error.msg.to_owned() })?;
        let options = glob::MatchOptions { require_literal_separator: true, ..Default::default() };
        let is_wanted =
            |path: &&PathBuf| path.ancestors().any(|around| by.matches_path_with(around, options));
        let wanted: Vec<&PathBuf> = self.entries.keys().filter(is_wanted).collect();
        if wanted.is_empty() {
            return Err(Error::NothingMatches(pattern.to_owned()));
        }
        Ok(wanted.into_iter().flat_map(|path| folders_around(path).chain([path.clone()])).collect())
    }

    /// All paths.
    pub fn all(&self) -> BTreeSet<PathBuf> {
        self.entries.keys().cloned().collect()
    }

    /// Writes these entries into a folder that is there. What lies there under the same names is replaced,
    /// and no link that lies there is followed. Links come last, so nothing is written through one.
    ///
    /// # Errors
    /// When a file cannot be written, with how to have it unpacked elsewhere.
    pub fn unpack(
        &self,
        paths: &BTreeSet<PathBuf>,
        folder: &Path,
        elsewhere: &'static str,
    ) -> Result<(), Error> {
        let is_link = |path: &&PathBuf| matches!(self.entries[*path].what, What::Link(_));
        let (links, others): (Vec<&PathBuf>, Vec<&PathBuf>) = paths.iter().partition(is_link);
        // A folder sorts before what lies in it.
        for path in others.into_iter().chain(links) {
            let (entry, to) = (&self.entries[path], folder.join(path));
            let cannot = |source| Error::writing(&to, source, elsewhere);
            match &entry.what {
                What::Folder => make_folder(&to, entry.mode).map_err(cannot)?,
                What::File(file) => self.unpack_file(file, entry.mode, &to, elsewhere)?,
                What::Link(target) => {
                    remove_if_there(&to).map_err(cannot)?;
                    std::os::unix::fs::symlink(target, &to).map_err(cannot)?;
                }
                What::Other => {}
            }
        }
        Ok(())
    }

    fn unpack_file(
        &self,
        file: &SquashfsFileReader,
        mode: u32,
        to: &Path,
        elsewhere: &'static str,
    ) -> Result<(), Error> {
        let cannot = |source| Error::writing(to, source, elsewhere);
        let damaged = |why: String| Error::Damaged {
            image: self.image.clone(),
            why: format!("{} in it cannot be read ({why})", to.display()),
        };
        remove_if_there(to).map_err(cannot)?;
        let mut out = OpenOptions::new().write(true).create_new(true).mode(0o600).open(to).map_err(cannot)?;
        let mut content =
            self.system.file(file).reader_checked().map_err(|error| damaged(error.to_string()))?;
        let (mut buffer, mut left) = (vec![0; 1 << 17], file.file_len());
        while left > 0 {
            let read = content.read(&mut buffer).map_err(|error| damaged(error.to_string()))?;
            if read == 0 {
                return Err(damaged("it is too short".to_owned()));
            }
            left = left.saturating_sub(read);
            out.write_all(&buffer[..read]).map_err(cannot)?;
        }
        out.set_permissions(Permissions::from_mode(mode)).map_err(cannot)
    }
}

impl Entry {
    fn file_bytes(&self) -> Option<u64> {
        match &self.what {
            What::File(file) => Some(file.file_len() as u64),
            _ => None,
        }
    }
}

/// A path of the image from its root; `None` when it is not made of plain names.
fn inside(path: &Path) -> Option<PathBuf> {
    let path = path.strip_prefix("/").ok()?;
    let is_plain = path.components().all(|part| matches!(part, Component::Normal(_)));
    (is_plain && path != Path::new("")).then(|| path.to_owned())
}

/// The folders that a path leads through, the outermost first, without the root.
fn folders_around(path: &Path) -> impl Iterator<Item = PathBuf> {
    let mut around: Vec<PathBuf> =
        path.ancestors().skip(1).filter(|folder| *folder != Path::new("")).map(Path::to_owned).collect();
    around.reverse();
    around.into_iter()
}

/// That everything is of a kind that is unpacked, lies in folders, and no link leads out.
fn check(entries: &BTreeMap<PathBuf, Entry>) -> Result<(), Error> {
    for (path, entry) in entries {
        let leaves = |why| Error::Leaves { entry: path.clone(), why };
        let is_folder =
            |around: PathBuf| entries.get(&around).is_some_and(|around| matches!(around.what, What::Folder));
        if !folders_around(path).all(is_folder) {
            return Err(leaves("which lies in something that is no folder"));
        }
        match &entry.what {
            What::Other => return Err(leaves("which is neither a file nor a folder nor a link")),
            What::Link(to) if !stays_inside(path, to) => {
                return Err(leaves("a link that leads out of the folder"));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Whether a link leads to a place inside. Only its first steps may go up: folders around it are real ones,
/// so they are counted right, whereas what `..` means behind a name depends on where other links lead.
fn stays_inside(link: &Path, to: &Path) -> bool {
    let depth = link.components().count().saturating_sub(1);
    let (mut up, mut down) = (0, false);
    for part in to.components() {
        match part {
            Component::ParentDir if !down => up += 1,
            Component::Normal(_) => down = true,
            Component::CurDir => {}
            _ => return false,
        }
    }
    up <= depth
}

/// Makes a folder, or takes the one that is there; its owner may always write into it.
fn make_folder(path: &Path, mode: u32) -> std::io::Result<()> {
    match path.symlink_metadata() {
        Ok(found) if found.is_dir() => {}
        Ok(_) => {
            remove_if_there(path)?;
            DirBuilder::new().mode(0o700).create(path)?;
        }
        Err(_) => DirBuilder::new().mode(0o700).create(path)?,
    }
    std::fs::set_permissions(path, Permissions::from_mode(mode | 0o700))
}

/// Removes a file or a link, not what the link leads to.
fn remove_if_there(path: &Path) -> std::io::Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(of: &[(&str, What)]) -> BTreeMap<PathBuf, Entry> {
        of.iter().map(|(path, what)| (path.into(), Entry { mode: 0o644, what: what.clone() })).collect()
    }

    fn link(to: &str) -> What {
        What::Link(to.into())
    }

    #[test]
    fn only_plain_names_are_inside() {
        assert_eq!(inside(Path::new("/lib/libmujoco.so")), Some("lib/libmujoco.so".into()));
        for out in ["/", "lib", "", "/../etc/passwd", "/lib/../../etc", "/lib/.."] {
            assert_eq!(inside(Path::new(out)), None, "{out}");
        }
    }

    #[test]
    fn a_link_that_stays_is_taken_and_one_that_leaves_is_not() {
        let at = |to| check(&entries(&[("a", What::Folder), ("a/link", link(to))]));
        for stays in ["file", "../b", "..", "./deep/file", "../a/file"] {
            at(stays).unwrap_or_else(|error| panic!("{stays}: {error}"));
        }
        for leaves in ["/etc/passwd", "../..", "../../etc", "/"] {
            at(leaves).expect_err(leaves);
        }
        // Behind another link `..` goes up from wherever that one leads to.
        let chain =
            [("a", What::Folder), ("a/up", link("..")), ("out", link("a/up/..")), ("b", What::Folder)];
        assert!(matches!(check(&entries(&chain)), Err(Error::Leaves { .. })));
    }

    #[test]
    fn nothing_lies_in_a_link() {
        let through = [("out", link("a")), ("out/file", What::Folder), ("a", What::Folder)];
        let refused = check(&entries(&through)).expect_err("it would be written through the link");
        assert!(refused.to_string().contains("out/file"), "{refused}");
        check(&entries(&[("nowhere/file", What::Folder)])).expect_err("its folder is missing");
        check(&entries(&[("device", What::Other)])).expect_err("a device");
    }
}
