//! The files of a case.

use std::path::Path;

use crate::dice::Dice;
use crate::mutate::{Changed, change};
use crate::readers::Reader;
use crate::seeds::Seeds;

/// Files of a case as they lie in a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Staged {
    /// What was done to which file.
    pub change: String,
}

/// Writes the files of a case into an empty folder; nothing is changed where there is no index.
///
/// # Errors
/// What the file system says.
pub fn stage(
    reader: &Reader,
    seeds: &Seeds,
    seed: u64,
    index: Option<u64>,
    folder: &Path,
) -> std::io::Result<Staged> {
    let files: Vec<(&str, &[u8])> = seeds.below(reader.files).collect();
    let changeable: Vec<usize> = (0..files.len()).filter(|&k| reader.changes(files[k].0)).collect();
    if changeable.is_empty() {
        return Err(std::io::Error::other(format!("{} has no seeds", reader.name)));
    }
    let mut changed = vec![];
    if let Some(index) = index {
        let mut dice = Dice::new(seed, reader.name, index);
        // Pieces of other files: of its own, and of any.
        let others: Vec<&[u8]> =
            files.iter().map(|(_, content)| *content).chain(seeds.0.values().map(Vec::as_slice)).collect();
        for _ in 0..if dice.once_in(10) { 2 } else { 1 } {
            let file = *dice.pick(&changeable);
            if changed.iter().all(|(other, _, _)| *other != file) {
                let (what, content) = change(&mut dice, files[file].1, &others);
                changed.push((file, what, content));
            }
        }
    }
    for (k, (path, content)) in files.iter().enumerate() {
        let path = folder.join(path);
        if let Some(above) = path.parent() {
            std::fs::create_dir_all(above)?;
        }
        match changed.iter().find(|(file, _, _)| *file == k) {
            Some((_, _, Changed::Special(special))) => special.put(&path)?,
            Some((_, _, Changed::Bytes(bytes))) => std::fs::write(path, bytes)?,
            None => std::fs::write(path, content)?,
        }
    }
    let told = changed.iter().map(|(file, what, _)| format!("{}: {what}", files[*file].0));
    Ok(Staged { change: told.collect::<Vec<_>>().join("; ") })
}
