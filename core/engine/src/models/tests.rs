//! The workflow driven by commands, its work done on the spot.

mod life;
mod refusals;
mod tables;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use nalgebra::Vector3;
use plumbline_correction::Method;
use plumbline_model::robot::Rig;
use plumbline_model::session::{Chain, Manifest, RigReference, Screen, TouchRow, TouchTable, Touchscreen};
use plumbline_model::{JobContext, Pixel, Point, Robot, Session, Unattended};

use crate::Skipped;
use crate::command::{Command, ModelsCommand};
use crate::context::Action;
use crate::state::State;
use crate::view::{ModelsView, View};

pub(crate) fn nico() -> Rig {
    Rig::built_in("nico").expect("the rig that comes with the program is tested")
}

/// What must be sent for a pixel of the made-up lab: up to 20 mm beside its place, smoothly.
pub(crate) fn needed(screen: &Touchscreen, pixel: Pixel<Screen>) -> Point<Robot> {
    let (u, v) = (pixel.u_px / 1920.0 - 0.5, pixel.v_px / 1080.0 - 0.5);
    let shift = Vector3::new(0.012 + 0.03 * u * v, -0.008 + 0.02 * u * u, 0.004 - 0.01 * v * v);
    Point::from(screen.point_at(pixel).coords + shift)
}

/// A session of 9 × 7 touches, in rows of 9 that were touched one after the other.
pub(crate) fn made_up_session(rig: &Rig) -> Session {
    let screen = &rig.touchscreen;
    let arm = &rig.arms[0];
    let joints: Vec<String> =
        arm.joints.iter().map(|joint| rig.description.joint(*joint).name.clone()).collect();
    let touch = |i: u32, j: u32| {
        // Not quite a grid, and 0.2 mm of noise: what is the same everywhere can be learned by heart.
        let jitter = f64::from((i * 37 + j * 91) % 17) - 8.0;
        let pixel = Pixel::new(240.0 + 180.0 * f64::from(i) + jitter, 120.0 + 140.0 * f64::from(j) - jitter);
        let noise = 0.0002 * (f64::from((i * 53 + j * 29) % 11) / 5.0 - 1.0);
        let sent = needed(screen, pixel).coords;
        TouchRow {
            commanded_rad: vec![Some(0.1); joints.len()],
            touch: Some(pixel),
            set: Some(format!("row {j}")),
            target: Some(Point::new(sent.x + noise, sent.y - noise, sent.z)),
            ..TouchRow::default()
        }
    };
    let rows: Vec<TouchRow> = (0..7).flat_map(|j| (0..9).map(move |i| touch(i, j))).collect();
    let manifest = Manifest {
        rig: RigReference::Named(rig.name.clone()),
        started: "2026-05-01T10:00:00Z".parse().expect("a time"),
        operator: String::new(),
        notes: String::new(),
        touchscreen: Some(screen.clone()),
        chain: Some(Chain { tip: "right_index_tip".to_owned(), joints: joints.clone() }),
        extra: toml::Table::new(),
    };
    Session {
        manifest,
        touches: Some(TouchTable::from_rows(joints, &rows)),
        localizations: None,
        poses: None,
        stereo: Default::default(),
        log: None,
    }
}

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
