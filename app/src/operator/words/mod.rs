//! What several panels, the bottom line and the window say in the same words.

pub mod drift;
pub mod effect;
pub mod eyes;
pub mod gap;
pub mod grasp;
pub mod health;
pub mod mount;
pub mod proof;
pub mod robot;
pub mod screen;
pub mod sources;
pub mod timeline;
pub mod trials;
pub mod truth;

use std::path::{Path, PathBuf};

use plumbline_engine::{SourceSpec, View};

/// Reasons of errors begin small, because they often follow a colon.
pub fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A reason or a warning as a sentence of its own. What begins with the name of a session or of a file keeps it.
pub fn sentence(text: &str) -> String {
    let first = text.split_whitespace().next().unwrap_or_default();
    let is_name = first.ends_with(':') || first.trim_end_matches('.').contains(['/', '.', '_']);
    let begun = if is_name { text.to_owned() } else { capitalized(text) };
    let end = if begun.is_empty() || begun.ends_with(['.', '!', '?', '…']) { "" } else { "." };
    format!("{begun}{end}")
}

/// Of fewer repeats the gap, too, makes no noise.
const FEW_REPEATS: usize = 10;

/// What the spread of so many repeats is called; `None`: there are none.
pub fn noise_of_repeats(repeats: Option<usize>) -> String {
    match repeats {
        Some(repeats) if repeats < FEW_REPEATS => {
            format!("rough noise, of {}", plumbline_widgets::format::count(repeats, "repeat"))
        }
        _ => "noise floor of repeats".to_owned(),
    }
}

/// That more doubts than the one that was said are listed, a sentence behind it; nothing where there are none.
pub fn more_doubts(more: usize) -> String {
    match more {
        0 => String::new(),
        1 => " One more doubt is listed.".to_owned(),
        n => format!(" {n} more doubts are listed."),
    }
}

/// What a source is called: the last parts of the paths.
pub fn source_name(spec: &SourceSpec) -> String {
    let last = |path: &Path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    match spec {
        SourceSpec::Folder(folder) => last(folder),
        SourceSpec::Folders { left, right } => match (left.parent(), right.parent()) {
            // The usual layout: one folder with `left` and `right` in it.
            (Some(a), Some(b)) if a == b => last(a),
            _ => format!("{} and {}", last(left), last(right)),
        },
        SourceSpec::Videos { left, right } => format!("{} and {}", last(left), last(right)),
        SourceSpec::Recording { file, .. } => {
            format!("recording {}", file.parent().map_or_else(|| last(file), last))
        }
        SourceSpec::Twin => "the twin's eyes".to_owned(),
        SourceSpec::Cameras { left_index, right_index } => format!("cameras {left_index} and {right_index}"),
    }
}

/// The recording that is exported: the one that is open, else the one that was made last.
pub fn recording_to_export(view: &View) -> Option<PathBuf> {
    let open = match &view.source.spec {
        Some(SourceSpec::Recording { file, .. }) => Some(file.clone()),
        _ => None,
    };
    open.or_else(|| view.recording.last.as_ref().map(|last| last.file()))
}

/// "14:02", with the day before it when that is not today, and its year when that is not this one.
pub fn clock(at: jiff::Timestamp) -> String {
    let zone = jiff::tz::TimeZone::system();
    let (at, now) = (at.to_zoned(zone.clone()), jiff::Timestamp::now().to_zoned(zone));
    let format = if at.date() == now.date() {
        "%H:%M"
    } else if at.year() == now.year() {
        "%-d %b, %H:%M"
    } else {
        "%-d %b %Y, %H:%M"
    };
    at.strftime(format).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_and_warnings_become_sentences() {
        assert_eq!(sentence("row 7 lies far off"), "Row 7 lies far off.");
        assert_eq!(sentence("Done."), "Done.");
        assert_eq!(sentence("morning: row 7 lies far off"), "morning: row 7 lies far off.");
        assert_eq!(sentence("t_secs goes backwards"), "t_secs goes backwards.");
        assert_eq!(sentence(""), "");
    }

    #[test]
    fn two_folders_of_one_parent_are_called_by_the_parent() {
        let spec = SourceSpec::Folders { left: "data/board/left".into(), right: "data/board/right".into() };
        assert_eq!(source_name(&spec), "board");
        let spec = SourceSpec::Folders { left: "a/left".into(), right: "b/right".into() };
        assert_eq!(source_name(&spec), "left and right");
    }
}
