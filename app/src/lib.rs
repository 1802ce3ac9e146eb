//! The program: a window and a command line over the same engine.

mod cli;
mod operator;
mod panels;
mod window;

pub use cli::{run, understands};
pub use operator::{Action, Outbox, Pane, Screen};
pub use window::{
    Backend, LaunchOptions, LogStore, PlumblineWindow, ScriptStep, Stopper, ThemeChoice, TouchSurface,
    WindowOptions, WindowSettings, launch, start_log, touch_surface,
};

#[cfg(test)]
mod floors {
    use std::path::{Path, PathBuf};

    /// A floor, and what it must not know.
    const ABOVE: [(&str, &[&str]); 4] = [
        ("operator", &["crate::panels", "crate::window", "crate::cli"]),
        ("panels", &["crate::window", "crate::cli"]),
        ("window", &["crate::cli"]),
        ("cli", &["crate::panels"]),
    ];

    fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).expect("the sources are here") {
            let path = entry.expect("can be read").path();
            match path.is_dir() {
                true => sources(&path, found),
                false => found.push(path),
            }
        }
    }

    #[test]
    fn no_arrow_points_up_and_other_packages_have_one_door() {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        for (floor, above) in ABOVE {
            let mut files = Vec::new();
            sources(&source.join(floor), &mut files);
            assert!(files.len() > 10, "{floor} was not found");
            for file in files {
                let text = std::fs::read_to_string(&file).expect("a text");
                let known = above.iter().find(|above| text.contains(**above));
                assert_eq!(known, None, "{} is below that", file.display());
                let others =
                    ["correction", "effects", "gap", "report"].map(|p| format!("plumbline_engine::{p}::"));
                let past = others.iter().find(|other| text.contains(other.as_str()));
                assert!(
                    past.is_none() || file.ends_with("operator/snapshot.rs"),
                    "{}: {past:?}",
                    file.display()
                );
            }
        }
    }
}
