//! The files of the repository.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Root of the repository.
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests is in the repository").to_path_buf()
}

/// Content of a file that must be there.
pub fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Name and text of every text file that belongs to the repository, without the lock file.
pub fn tracked_text_files() -> Vec<(String, String)> {
    let root = repository();
    let names = tracked(&root).unwrap_or_else(|| all_files(&root));
    assert!(names.iter().any(|name| name == "Cargo.toml"), "the repository was not found");
    names
        .into_iter()
        .filter(|name| name != "Cargo.lock")
        .filter_map(|name| std::fs::read_to_string(root.join(&name)).ok().map(|text| (name, text)))
        .collect()
}

/// As git knows them; `None` where there is no git or no repository (an unpacked archive).
fn tracked(root: &Path) -> Option<Vec<String>> {
    let output = Command::new("git").arg("-C").arg(root).args(["ls-files", "-z"]).output().ok()?;
    let names: Vec<String> = String::from_utf8(output.stdout)
        .ok()?
        .split('\0')
        .filter(|name| !name.is_empty())
        .map(str::to_owned)
        .collect();
    (output.status.success() && !names.is_empty()).then_some(names)
}

fn all_files(root: &Path) -> Vec<String> {
    let mut names = Vec::new();
    let mut folders = vec![root.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                if path != root.join("target") && path != root.join(".git") {
                    folders.push(path);
                }
            } else if let Ok(name) = path.strip_prefix(root) {
                names.push(name.to_string_lossy().into_owned());
            }
        }
    }
    names
}
