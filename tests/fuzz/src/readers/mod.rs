//! Everything that takes a file, a folder, bytes or words from outside, and whole verbs.

mod broken;
mod data;
mod eyes;
mod hardware;
mod model;
mod verbs;
mod words;

use std::path::Path;

use crate::check::Heard;

/// Something that reads.
pub struct Reader {
    /// On the command line and in the table.
    pub name: &'static str,
    /// Files that it needs: paths of seeds that begin with one of these.
    pub files: &'static [&'static str],
    /// Of these, files that are changed; none: all.
    pub changed: &'static [&'static str],
    /// Its share of the cases.
    pub weight: u32,
    /// Whether what it takes must hold finite numbers only.
    pub finite: bool,
    /// Reads in a folder that holds the files.
    pub read: fn(&Path) -> Heard,
}

impl Reader {
    /// Whether a file of its seeds is one that is changed.
    pub fn changes(&self, path: &str) -> bool {
        self.changed.is_empty() || self.changed.iter().any(|start| path.starts_with(start))
    }
}

/// All of them.
pub fn all() -> Vec<Reader> {
    [
        model::readers(),
        eyes::readers(),
        hardware::readers(),
        data::readers(),
        words::readers(),
        verbs::readers(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Readers with every defect that is looked for, to test the search itself.
pub use broken::readers as broken;

/// The one of this name.
pub fn of_name(name: &str) -> Option<Reader> {
    all().into_iter().chain(broken()).find(|reader| reader.name == name)
}

/// A reader of one file, which is the only one changed.
fn one(name: &'static str, file: &'static [&'static str], weight: u32, read: fn(&Path) -> Heard) -> Reader {
    Reader { name, files: file, changed: &[], weight, finite: true, read }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_told_apart_and_every_reader_has_cases() {
        let readers = all();
        let names: std::collections::BTreeSet<&str> = readers.iter().map(|reader| reader.name).collect();
        assert_eq!(names.len(), readers.len());
        assert!(readers.iter().all(|reader| reader.weight > 0 && !reader.files.is_empty()));
        assert!(of_name("urdf").is_some() && of_name("nothing").is_none());
    }
}
