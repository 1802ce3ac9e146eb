//! Colors are decided in `theme` and in the tables of `colormap`, nowhere else.

use std::path::{Path, PathBuf};

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the source folder is there") {
        let path = entry.expect("an entry can be read").path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn no_color_is_written_outside_of_the_theme() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    assert!(files.len() > 20);
    let constants = ["from_rgb(0x", "from_gray(", "from_black_alpha(", "from_white_alpha(", "hex_color!"];
    for file in files {
        let place = file.strip_prefix(&source).expect("below the source folder");
        if place.starts_with("theme") || place.ends_with("colormap/table.rs") {
            continue;
        }
        let text = std::fs::read_to_string(&file).expect("source is text");
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for constant in constants {
            // `ColorImage::from_gray` takes pixels, not a color.
            let uses =
                code.matches(constant).count() - code.matches(&format!("ColorImage::{constant}")).count();
            assert_eq!(uses, 0, "{} writes a color with {constant}", place.display());
        }
    }
}
