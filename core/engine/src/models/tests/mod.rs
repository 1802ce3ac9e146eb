//! The workflow driven by commands, its work done on the spot.

mod life;
mod made_up;
mod refusals;
mod tables;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use nalgebra::Vector3;
use plumbline_correction::Method;
use plumbline_model::robot::Rig;
use plumbline_model::session::{Screen, Touchscreen};
use plumbline_model::{JobContext, Pixel, Unattended};

pub(crate) use made_up::{made_up_session, needed, nico};

use super::command::ModelsCommand;
use super::view::ModelsView;
use crate::Skipped;
use crate::command::Command;
use crate::state::{Action, State};
use crate::view::View;

/// The engine's state on a folder of its own.
struct Lab {
    folder: tempfile::TempDir,
    state: State,
}

impl Lab {
    /// With one session of touches.
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("temporary folder");
        let session = folder.path().join("sessions/2026-05-01T10-00-00_touch");
        made_up_session(&nico()).write(&session).expect("written");
        Self::on(folder)
    }

    fn on(folder: tempfile::TempDir) -> Self {
        let state = State::new(folder.path());
        let mut lab = Self { folder, state };
        lab.work(&Unattended);
        lab
    }

    /// The program is closed and started again.
    fn restarted(self) -> Self {
        Self::on(self.folder)
    }

    fn session(&self) -> PathBuf {
        self.path("sessions/2026-05-01T10-00-00_touch")
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Gives a command and does all work that comes of it.
    fn tell(&mut self, command: ModelsCommand) -> Arc<ModelsView> {
        self.state.apply(Command::Models(command));
        self.work(&Unattended);
        self.view()
    }

    /// Does what was asked for, until nothing is left.
    fn work(&mut self, context: &dyn JobContext) {
        loop {
            let actions = self.state.take_actions();
            let started: Vec<_> = actions
                .into_iter()
                .filter_map(|action| match action {
                    Action::Start(id, work) => Some((id, work)),
                    _ => None,
                })
                .collect();
            if started.is_empty() {
                return;
            }
            for (id, work) in started {
                self.state.work_ended(id, work.run(context).into(), Duration::ZERO);
            }
        }
    }

    fn whole_view(&mut self) -> View {
        self.state.view(Skipped::default(), 0, Instant::now())
    }

    fn view(&mut self) -> Arc<ModelsView> {
        self.whole_view().models
    }

    /// The newest message.
    fn said(&mut self) -> String {
        self.whole_view().notices.last().map(|notice| notice.text.clone()).unwrap_or_default()
    }
}

fn train(methods: &[Method]) -> ModelsCommand {
    ModelsCommand::Train { methods: methods.into(), seed: 1, published_recipe: false }
}

/// Mean distance in the plane between what a model sends and what is needed, over the touched
/// area, m.
fn mean_error_m(model: &plumbline_correction::CorrectionModel, screen: &Touchscreen) -> f64 {
    let pixels = (0..8).flat_map(|i| (0..6).map(move |j| (f64::from(i), f64::from(j))));
    let errors: Vec<f64> = pixels
        .map(|(i, j)| {
            let pixel = Pixel::new(330.0 + 180.0 * i, 190.0 + 140.0 * j);
            (model.correct(pixel).target.coords.xy() - needed(screen, pixel).coords.xy()).norm()
        })
        .collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}

fn files_in(folder: &Path) -> usize {
    std::fs::read_dir(folder).map_or(0, |entries| entries.flatten().count())
}
