//! Small valid inputs that changes begin with: made by the program's own writers, so that they follow
//! its formats, or given with the program.

mod arm;
mod data_folder;
mod detection;
mod eyes;
mod pictures;
mod video;
mod words;

use std::collections::BTreeMap;
use std::path::Path;

/// What makes them fails only when the program itself is broken.
pub type Problem = Box<dyn std::error::Error + Send + Sync>;

/// Files by their path below one folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Seeds(pub BTreeMap<String, Vec<u8>>);

/// Writes all seeds into a folder. Takes some seconds.
///
/// # Errors
/// When a writer of the program refuses what it should write; the other seeds are there then.
pub fn make(folder: &Path) -> Result<(), Problem> {
    all([
        &|| arm::make(folder),
        &|| eyes::make(folder),
        &|| pictures::make(folder),
        &|| video::make(folder),
        &|| detection::make(folder),
        &|| words::make(folder),
        &|| data_folder::make(folder),
    ])
}

/// Does all parts, and gives the problems together.
fn all<const N: usize>(parts: [&dyn Fn() -> Result<(), Problem>; N]) -> Result<(), Problem> {
    let problems: Vec<String> =
        parts.iter().filter_map(|part| part().err()).map(|problem| problem.to_string()).collect();
    if problems.is_empty() { Ok(()) } else { Err(problems.join("; ").into()) }
}

impl Seeds {
    /// All files of a folder.
    ///
    /// # Errors
    /// What the file system says.
    pub fn read(folder: &Path) -> std::io::Result<Self> {
        let mut files = BTreeMap::new();
        gather(folder, "", &mut files)?;
        Ok(Self(files))
    }

    /// Files whose path begins with one of these.
    pub fn below<'a>(&'a self, prefixes: &'a [&str]) -> impl Iterator<Item = (&'a str, &'a [u8])> {
        self.0
            .iter()
            .filter(|(path, _)| prefixes.iter().any(|prefix| path.starts_with(prefix)))
            .map(|(path, content)| (path.as_str(), content.as_slice()))
    }
}

fn gather(folder: &Path, above: &str, files: &mut BTreeMap<String, Vec<u8>>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let path = format!("{above}{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() {
            gather(&entry.path(), &format!("{path}/"), files)?;
        } else {
            files.insert(path, std::fs::read(entry.path())?);
        }
    }
    Ok(())
}

/// Writes a file and the folders above it.
fn put(folder: &Path, path: &str, content: impl AsRef<[u8]>) -> std::io::Result<()> {
    let file = folder.join(path);
    if let Some(above) = file.parent() {
        std::fs::create_dir_all(above)?;
    }
    std::fs::write(file, content)
}
