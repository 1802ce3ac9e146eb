//! What the window remembers from one start to the next.

use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};

use egui_tiles::Tree;
use plumbline_engine::SourceSpec;
use plumbline_model::files::{self, FileError, Size};
use serde::{Deserialize, Serialize};

use super::arrangement::default_arrangement;
use crate::operator::{Pane, Screen};

/// Dark, light, or as the desktop says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum ThemeChoice {
    /// As the desktop says.
    System,
    /// Light on dark.
    #[default]
    Dark,
    /// Dark on light.
    Light,
}

impl ThemeChoice {
    /// For egui.
    pub fn preference(self) -> egui::ThemePreference {
        match self {
            Self::System => egui::ThemePreference::System,
            Self::Dark => egui::ThemePreference::Dark,
            Self::Light => egui::ThemePreference::Light,
        }
    }
}

/// Everything that is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct WindowSettings {
    /// Colors.
    pub theme: ThemeChoice,
    /// The screen that was open.
    pub screen: Screen,
    /// Tiles per screen, as the operator arranged them.
    pub arrangements: BTreeMap<Screen, Tree<Pane>>,
    /// Whether the inspector is open.
    pub inspector_open: bool,
    /// Whether the log is open.
    pub log_open: bool,
    /// Inner size of the window, points.
    pub size: [f32; 2],
    /// Scale of everything on screen.
    pub zoom: f32,
    /// Sources opened before, newest first.
    pub recent_sources: VecDeque<SourceSpec>,
}

impl Default for WindowSettings {
    fn default() -> Self {
        Self {
            theme: ThemeChoice::default(),
            screen: Screen::default(),
            arrangements: BTreeMap::new(),
            inspector_open: true,
            log_open: false,
            size: [1440.0, 900.0],
            zoom: 1.0,
            recent_sources: VecDeque::new(),
        }
    }
}

/// Whether a part of the window stands in two places, or inside itself: drawing it would never end.
fn is_knotted(tree: &Tree<Pane>) -> bool {
    let mut seen = std::collections::HashSet::new();
    let mut next: Vec<egui_tiles::TileId> = tree.root.into_iter().collect();
    while let Some(id) = next.pop() {
        if !seen.insert(id) {
            return true;
        }
        if let Some(egui_tiles::Tile::Container(container)) = tree.tiles.get(id) {
            next.extend(container.children().copied());
        }
    }
    false
}

/// Sides of windows, points: larger ones have no screen, and drawing fails.
const SIDES_POINTS: std::ops::RangeInclusive<f32> = 50.0..=16384.0;
/// Scales; the shortcuts that change it stay inside.
const ZOOMS: std::ops::RangeInclusive<f32> = 0.2..=5.0;

impl WindowSettings {
    /// How many sources are remembered.
    pub const RECENT_SOURCES: usize = 8;

    /// Tiles of a screen; the default ones until they are changed.
    pub fn arrangement(&mut self, screen: Screen) -> &mut Tree<Pane> {
        self.arrangements.entry(screen).or_insert_with(|| default_arrangement(screen))
    }

    /// Puts a source first among the recent ones.
    pub fn remember_source(&mut self, spec: &SourceSpec) {
        self.recent_sources.retain(|known| known != spec);
        self.recent_sources.push_front(spec.clone());
        self.recent_sources.truncate(Self::RECENT_SOURCES);
    }

    /// Reads the file; a missing file gives the defaults.
    pub fn load(file: &Path) -> Result<Self, SettingsError> {
        let text = match files::read_text(file, Size::SHORT) {
            Ok(text) => text,
            Err(error) if error.is_absent() => return Ok(Self::default()),
            Err(error) => return Err(SettingsError::Read { error }),
        };
        let settings: Self = serde_json::from_str(&text)
            .map_err(|error| SettingsError::Parse { file: file.to_owned(), error })?;
        match settings.unusable() {
            None => Ok(settings),
            Some(what) => Err(SettingsError::Value { file: file.to_owned(), what }),
        }
    }

    /// A number with which no window can be shown, in words.
    fn unusable(&self) -> Option<String> {
        if self.arrangements.values().any(is_knotted) {
            return Some("an arrangement with a part that contains itself".to_owned());
        }
        let side = self.size.into_iter().find(|side| !SIDES_POINTS.contains(side));
        let side = side.map(|side| format!("a side of {side:?} points"));
        side.or_else(|| (!ZOOMS.contains(&self.zoom)).then(|| format!("a scale of {:?}", self.zoom)))
    }

    /// Writes the file in one step, so that a crash leaves the old one or the new one.
    pub fn save(&self, file: &Path) -> Result<(), FileError> {
        if let Some(folder) = file.parent() {
            files::make_folder(folder)?;
        }
        files::write_with(file, |out| Ok(serde_json::to_writer_pretty(out, self)?))
    }
}

/// The settings could not be read; the defaults are used.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    /// Not readable.
    #[error("The window's settings cannot be used: {error}. It starts with the default layout.")]
    Read {
        /// Which file, and why.
        error: FileError,
    },
    /// A number that no window can have.
    #[error("The window's settings in {} hold {what}; it starts with the default layout.", file.display())]
    Value {
        /// Which file.
        file: PathBuf,
        /// Which number.
        what: String,
    },
    /// Not what was expected.
    #[error(
        "The window's settings in {} are not from this version ({error}); it starts with the default layout.",
        file.display()
    )]
    Parse {
        /// Which file.
        file: PathBuf,
        /// Where and what.
        error: serde_json::Error,
    },
}

/// Where the settings are kept: `folder` if given, else the user's configuration folder.
pub fn settings_file(folder: Option<&Path>) -> Option<PathBuf> {
    let folder = match folder {
        Some(folder) => folder.to_owned(),
        None => directories::ProjectDirs::from("", "", "plumbline")?.config_dir().to_owned(),
    };
    Some(folder.join("window.json"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_survive_a_restart() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("deeper").join("window.json");
        let mut settings = WindowSettings { theme: ThemeChoice::Light, ..Default::default() };
        settings.arrangement(Screen::Judge);
        settings.remember_source(&SourceSpec::Cameras { left_index: 0, right_index: 2 });
        settings.save(&file).expect("a folder that can be written");
        assert_eq!(WindowSettings::load(&file).expect("what was written can be read"), settings);
    }

    #[test]
    fn a_missing_file_is_the_first_start_and_a_broken_one_is_said() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("window.json");
        assert_eq!(WindowSettings::load(&file).expect("defaults"), WindowSettings::default());
        std::fs::write(&file, "{\"screen\": \"moon\"}").expect("a folder that can be written");
        let message = WindowSettings::load(&file).expect_err("no such screen").to_string();
        assert!(message.contains("window.json") && message.contains("default layout"), "{message}");
    }

    #[test]
    fn recent_sources_are_few_and_the_newest_comes_first() {
        let mut settings = WindowSettings::default();
        for right_index in 0..20 {
            settings.remember_source(&SourceSpec::Cameras { left_index: 0, right_index });
        }
        settings.remember_source(&SourceSpec::Cameras { left_index: 0, right_index: 17 });
        assert_eq!(settings.recent_sources.len(), WindowSettings::RECENT_SOURCES);
        assert_eq!(settings.recent_sources[0], SourceSpec::Cameras { left_index: 0, right_index: 17 });
        assert_eq!(settings.recent_sources[1], SourceSpec::Cameras { left_index: 0, right_index: 19 });
    }

    #[test]
    fn numbers_that_no_window_can_have_are_named() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("window.json");
        for (size, zoom, said) in [
            ([1280.0, 1e30], 1.0, "a side of 1e30 points"),
            ([0.0, 800.0], 1.0, "a side of 0.0 points"),
            ([1280.0, 800.0], 0.0, "a scale of 0.0"),
            ([1280.0, 800.0], 1e9, "a scale of 1000000000.0"),
        ] {
            WindowSettings { size, zoom, ..Default::default() }.save(&file).expect("writable");
            let error = WindowSettings::load(&file).expect_err("no window is like that").to_string();
            assert!(error.contains(said) && error.contains("default layout"), "{error}");
        }
    }

    #[test]
    fn an_arrangement_that_contains_itself_is_refused() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("window.json");
        let mut settings = WindowSettings::default();
        let tree = settings.arrangement(Screen::Live);
        let root = tree.root.expect("it has one");
        if let Some(egui_tiles::Tile::Container(container)) = tree.tiles.get_mut(root) {
            container.add_child(root);
        }
        settings.save(&file).expect("writable");
        let error = WindowSettings::load(&file).expect_err("drawing it would never end").to_string();
        assert!(error.contains("contains itself"), "{error}");
    }
}
