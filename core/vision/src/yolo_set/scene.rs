//! Which images show the same scene.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plumbline_model::files::{self, Size};

use super::YoloSetError;

/// Name of the table of scenes beside `data.yaml`: file name of an image and its scene.
const TABLE: &str = "scenes.csv";
const HEADER: &str = "image,scene";

/// The scene of an image by its file name: what left and right image of a pair share. The words
/// `left` and `right` are taken off, and what data set services add (`.rf.` and a code).
pub fn scene_of(image: &Path) -> String {
    let stem = image.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let name = match stem.split_once(".rf.") {
        Some((name, _)) => {
            ["_jpg", "_jpeg", "_png"].iter().find_map(|end| name.strip_suffix(end)).unwrap_or(name)
        }
        None => &stem,
    };
    let parts: Vec<&str> = name.split(['_', '-', ' ']).collect();
    let last = parts.len() - 1;
    let is_side = |index: usize, part: &str| {
        let at_the_edge = index == 0 || index == last;
        let is = |word: &str| part.eq_ignore_ascii_case(word);
        is("left") || is("right") || (at_the_edge && (is("l") || is("r")))
    };
    let rest = parts.iter().enumerate().filter(|(index, part)| !is_side(*index, part) && !part.is_empty());
    let scene = rest.map(|(_, part)| *part).collect::<Vec<_>>().join("_");
    if scene.is_empty() { stem } else { scene }
}

/// The time stamp in the name of a scene, seconds since 1970, if there is one: seconds with or
/// without decimals, milliseconds, microseconds or nanoseconds.
pub fn seconds_of(scene: &str) -> Option<f64> {
    scene.split('_').find_map(|part| {
        let digits = part.split('.').next().filter(|whole| whole.bytes().all(|b| b.is_ascii_digit()))?;
        let number: f64 = part.parse().ok()?;
        match digits.len() {
            10 => Some(number),
            13 => Some(number * 1e-3),
            16 => Some(number * 1e-6),
            19 => Some(number * 1e-9),
            _ => None,
        }
    })
}

/// Scenes that a set's table names, by file name of the image.
#[derive(Debug, Default)]
pub(super) struct SceneTable(BTreeMap<String, String>);

impl SceneTable {
    /// The scene of an image, where the table has it.
    pub fn get(&self, image: &Path) -> Option<String> {
        self.0.get(file_name(image).as_str()).cloned()
    }

    /// Adds an image.
    pub fn insert(&mut self, image: &Path, scene: &str) {
        self.0.insert(file_name(image), scene.to_owned());
    }

    /// As a file, or nothing where every name says its scene itself.
    pub fn text(&self) -> Option<String> {
        let told = self.0.iter().filter(|(image, scene)| scene_of(Path::new(image)) != **scene);
        let rows: String =
            told.map(|(image, scene)| format!("{},{}\n", quoted(image), quoted(scene))).collect();
        (!rows.is_empty()).then(|| format!("{HEADER}\n{rows}"))
    }
}

/// The table beside a `data.yaml`; empty where there is none.
pub(super) fn read_table(data_yaml: &Path) -> Result<SceneTable, YoloSetError> {
    let file = table_file(data_yaml.parent().unwrap_or(Path::new("")));
    let text = match files::read_text(&file, Size::TEXT) {
        Ok(text) => text,
        Err(error) if error.is_absent() => return Ok(SceneTable::default()),
        Err(error) => return Err(error.into()),
    };
    let mut table = SceneTable::default();
    let bad = |line: usize| YoloSetError::DataYaml {
        file: file.clone(),
        reason: format!(
            "line {line} of this table of scenes is not \"image,scene\"; delete the table if it is of no use"
        ),
    };
    for (index, line) in text.lines().enumerate().skip(1) {
        let (image, scene) = cells(line).ok_or_else(|| bad(index + 1))?;
        table.0.insert(image, scene);
    }
    Ok(table)
}

/// Place of the table in the folder of a set.
pub(super) fn table_file(folder: &Path) -> PathBuf {
    folder.join(TABLE)
}

fn file_name(image: &Path) -> String {
    image.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

fn quoted(cell: &str) -> String {
    let line = cell.replace(['\n', '\r'], " ");
    if line.contains([',', '"']) { format!("\"{}\"", line.replace('"', "\"\"")) } else { line }
}

/// Two cells of a row.
fn cells(line: &str) -> Option<(String, String)> {
    let (mut cells, mut quoted, mut chars) = (vec![String::new()], false, line.chars().peekable());
    while let Some(c) = chars.next() {
        match c {
            '"' if quoted && chars.peek() == Some(&'"') => {
                chars.next();
                cells.last_mut()?.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            c => cells.last_mut()?.push(c),
        }
    }
    let scene = cells.pop()?;
    let image = cells.pop()?;
    cells.is_empty().then_some((image, scene))
}
