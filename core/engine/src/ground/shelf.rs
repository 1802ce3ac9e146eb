//! Where accepted things are kept. A [`Shelf`] keeps each in a file of its own for ever, under a name
//! that begins with the time; an [`InUse`] keeps one, which another takes the place of. Who writes
//! brings a writer that replaces a file whole or not at all.

use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use plumbline_model::files;

/// Things in a folder, each in a file of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shelf {
    folder: PathBuf,
    extension: &'static str,
}

impl Shelf {
    /// In this folder, which is made when something is kept, in files with this extension.
    pub fn new(folder: PathBuf, extension: &'static str) -> Self {
        Self { folder, extension }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Makes the folder if it is not there.
    ///
    /// # Errors
    /// What the system says.
    pub fn make_folder(&self) -> Result<()> {
        std::fs::create_dir_all(&self.folder)
    }

    /// The file of a name.
    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.{}", self.extension))
    }

    /// The file of a name that comes from elsewhere (a journal, a file) and may be anything; `None`
    /// when it leads out of the folder.
    pub fn file_inside(&self, name: &str) -> Option<PathBuf> {
        Some(self.file(name)).filter(|file| file.parent() == Some(&self.folder))
    }

    /// A name that is not taken: the time, what follows it, and a number where that is taken.
    pub fn free_name(&self, at: Timestamp, ending: &str) -> String {
        let name = format!("{}{ending}", at.strftime("%Y-%m-%dT%H-%M-%SZ"));
        std::iter::once(name.clone())
            .chain((2..).map(|n| format!("{name}_{n:03}")))
            .find(|name| !self.file(name).exists())
            .unwrap_or(name)
    }

    /// Names of all things, in no order; what is being written is left out.
    ///
    /// # Errors
    /// When there is a folder that cannot be read.
    pub fn names(&self) -> Result<Vec<String>> {
        let listing = match std::fs::read_dir(&self.folder) {
            Ok(listing) => listing,
            // Nothing was ever kept.
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(error),
        };
        let ours = |path: &PathBuf| {
            !files::is_hidden(path) && path.extension().is_some_and(|extension| extension == self.extension)
        };
        let files = listing.flatten().map(|entry| entry.path()).filter(ours);
        Ok(files.filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned())).collect())
    }
}

/// One thing in one file, or none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InUse {
    file: PathBuf,
}

impl InUse {
    /// In this file, whose folder is made when something is kept.
    pub fn new(file: PathBuf) -> Self {
        Self { file }
    }

    /// The file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// What is in use; `None` when nothing is.
    ///
    /// # Errors
    /// When there is a file that cannot be read.
    pub fn read<T, E>(
        &self,
        read: impl FnOnce(&Path) -> std::result::Result<T, E>,
    ) -> std::result::Result<Option<T>, E>
    where
        E: From<files::FileError>,
    {
        if files::present(&self.file)? { read(&self.file).map(Some) } else { Ok(None) }
    }

    /// Puts something in use.
    ///
    /// # Errors
    /// When the folder cannot be made or the file not written; what was in use stays.
    pub fn put<E>(
        &self,
        no_folder: impl FnOnce(Error) -> E,
        write: impl FnOnce(&Path) -> std::result::Result<(), E>,
    ) -> std::result::Result<(), E> {
        if let Some(folder) = self.file.parent() {
            std::fs::create_dir_all(folder).map_err(no_folder)?;
        }
        write(&self.file)
    }

    /// Nothing is in use any more; it is fine when nothing was.
    ///
    /// # Errors
    /// What the system says.
    pub fn forget(&self) -> Result<()> {
        match std::fs::remove_file(&self.file) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_begin_with_the_time_are_free_and_listed() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let shelf = Shelf::new(folder.path().join("things"), "json");
        assert_eq!(shelf.names().expect("none yet"), Vec::<String>::new());
        shelf.make_folder().expect("writable");
        let at = Timestamp::UNIX_EPOCH;
        for expected in
            ["1970-01-01T00-00-00Z_m3", "1970-01-01T00-00-00Z_m3_002", "1970-01-01T00-00-00Z_m3_003"]
        {
            let name = shelf.free_name(at, "_m3");
            assert_eq!(name, expected);
            std::fs::write(shelf.file(&name), "{}").expect("writable");
        }
        std::fs::write(shelf.folder().join(".hidden.json"), "{}").expect("writable");
        std::fs::write(shelf.folder().join("other.txt"), "").expect("writable");
        assert_eq!(shelf.names().expect("a list").len(), 3);
    }

    #[test]
    fn a_name_does_not_lead_out_of_the_folder() {
        let shelf = Shelf::new(PathBuf::from("things"), "json");
        assert_eq!(shelf.file_inside("one"), Some(PathBuf::from("things/one.json")));
        assert_eq!(shelf.file_inside("../one"), None);
        assert_eq!(shelf.file_inside("deeper/one"), None);
    }

    #[test]
    fn what_is_in_use_is_read_back_and_forgotten() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let in_use = InUse::new(folder.path().join("deep/one.txt"));
        let read = || in_use.read(|file| files::read_text(file, files::Size::SHORT));
        assert_eq!(read().expect("nothing"), None);
        in_use.put(|error| panic!("{error}"), |file| files::write(file, "one")).expect("writable");
        assert_eq!(read().expect("there").as_deref(), Some("one"));
        in_use.forget().expect("removed");
        in_use.forget().expect("gone already");
        assert_eq!(read().expect("nothing"), None);
    }
}
