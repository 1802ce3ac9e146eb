//! What the program keeps: the data folder, journals, settings, saved poses.

use std::path::Path;
use std::time::{Duration, Instant};

use plumbline::WindowSettings;
use plumbline_engine::jobs::Outcome;
use plumbline_engine::robot::PoseLibrary;
use plumbline_engine::state::State;
use plumbline_engine::trials::{TrialsError, store};
use plumbline_engine::{Action, Skipped, journal};
use plumbline_model::Unattended;
use plumbline_twin::Scenario;

use super::model::nico;
use super::{Reader, one};
use crate::check::Heard;

pub fn readers() -> Vec<Reader> {
    vec![
        Reader { finite: false, ..one("data-folder", &["data/"], 12, data_folder) },
        Reader { finite: false, ..one("grasp-record", &["data/grasps/"], 20, data_folder) },
        Reader { finite: false, ..one("commissioning", &["data/commission.json"], 20, data_folder) },
        Reader { finite: false, ..one("experiments", &["data/experiments/"], 10, data_folder) },
        one("experiment", &["data/experiments/"], 30, experiment),
        Reader { finite: false, ..one("journal", &["journal/journal.jsonl"], 40, replay) },
        one("saved-poses", &["data/poses/"], 20, |folder| {
            let (library, problem) = PoseLibrary::read(&folder.join("data"), &nico());
            let heard = Heard::accepted(library.all(&nico()));
            Heard { accepted: problem.is_none(), ..heard }.and(problem)
        }),
        one("window-settings", &["window/window.json"], 20, |folder| {
            WindowSettings::load(&folder.join("window/window.json"))
                .map(|settings| (settings.size, settings.zoom))
                .into()
        }),
        one("scenario", &["twin/lab.toml"], 30, scenario),
    ]
}

/// Starts as the program does: everything kept is read, and what cannot be is told.
fn data_folder(folder: &Path) -> Heard {
    let mut state = State::new(&folder.join("data"));
    work_off(&mut state);
    told(&mut state)
}

/// An experiment is shown with all that came of it.
fn experiment(folder: &Path) -> Heard {
    let folder = folder.join("data/experiments/one");
    let read = || {
        let experiment = store::read_experiment(&folder)?;
        let summary = store::conclude(&folder, &experiment, &nico())?;
        Ok::<_, TrialsError>((experiment.positions_m, summary.missing))
    };
    read().into()
}

/// Commands of a journal are applied; work that they start is not done, for it may write anywhere.
fn replay(folder: &Path) -> Heard {
    let entries = match journal::read(&folder.join("journal/journal.jsonl")) {
        Ok((_, entries)) => entries,
        Err(error) => return Heard::refused(error),
    };
    let mut state = State::new(&folder.join("empty"));
    work_off(&mut state);
    for entry in entries.into_iter().take(200) {
        state.apply(entry.command);
        state.take_actions();
    }
    // What the state answers is no refusal of the journal.
    Heard { accepted: true, ..told(&mut state) }
}

fn work_off(state: &mut State) {
    for _ in 0..4 {
        for action in state.take_actions() {
            if let Action::Start(id, work) = action {
                let outcome = match work.run(&Unattended) {
                    Ok(result) => Outcome::Done(result),
                    Err(error) => Outcome::Failed(error.to_string()),
                };
                state.work_ended(id, outcome, Duration::ZERO);
            }
        }
    }
}

fn told(state: &mut State) -> Heard {
    let view = state.view(Skipped::default(), 0, Instant::now());
    let notices: Vec<String> = view.notices.iter().map(|notice| notice.text.clone()).collect();
    let heard = Heard::accepted(view.notices.len());
    Heard { accepted: notices.is_empty(), ..heard }.and(notices)
}

fn scenario(folder: &Path) -> Heard {
    // The window has no way to open a scenario file: the text is read here.
    let text = match std::fs::metadata(folder.join("twin/lab.toml")) {
        Ok(data) if data.is_file() => std::fs::read(folder.join("twin/lab.toml")).unwrap_or_default(),
        _ => return Heard::refused("no file"),
    };
    match String::from_utf8(text) {
        Err(_) => Heard::refused("no text"),
        Ok(text) => Scenario::from_toml("lab.toml", &text).into(),
    }
}
