//! Every result of a world as the timeline sees it. This is the one place past which nothing is put in
//! use: after everything that any workflow did it is looked at what is in use now.

use std::sync::Arc;

use plumbline_correction::CorrectionModel;
use plumbline_effects::RigModel;
use plumbline_model::touchscreen::ScreenPlacement;
use plumbline_model::{StereoCalibration, counted};
use plumbline_vision::mount::MountCalibration;

use super::State;
use super::actions::Action;
use super::measured::MeasuredNow;
use super::rooms::{Neighbors, Rooms};
use crate::eyes::EyesWorkflow;
use crate::eyes::command::EyesCommand;
use crate::eyes::view::AcceptedCalibration;
use crate::gap::view::FindingEntry;
use crate::ground::notice::NoticeLevel;
use crate::ground::{Workflow as _, World};
use crate::mount::MountWorkflow;
use crate::mount::command::MountCommand;
use crate::rig_models::made_at;
use crate::timeline::view::{Figure, Subject};
use crate::timeline::{Finding, Standing, StepBack, TimelineAround, TimelineWorkflow};
use crate::touch::TouchWorkflow;
use crate::touch::command::TouchCommand;
use crate::work::Work;

/// What is in use in a world, cheap to compare. Outside `None`: not read yet.
#[derive(Clone, Debug, Default)]
pub(super) struct Results {
    eyes: Option<Option<Arc<StereoCalibration>>>,
    mount: Option<Option<Arc<MountCalibration>>>,
    screen: Option<Option<Arc<ScreenPlacement>>>,
    correction: Option<Option<Arc<CorrectionModel>>>,
    effects: Option<Arc<RigModel>>,
    findings: Arc<[FindingEntry]>,
    measured: MeasuredNow,
}

impl Results {
    fn is(&self, other: &Self) -> bool {
        fn same<T: ?Sized>(a: &Option<Option<Arc<T>>>, b: &Option<Option<Arc<T>>>) -> bool {
            match (a, b) {
                (Some(Some(a)), Some(Some(b))) => Arc::ptr_eq(a, b),
                (None, None) | (Some(None), Some(None)) => true,
                _ => false,
            }
        }
        let effects = |results: &Self| Some(results.effects.clone());
        same(&self.eyes, &other.eyes)
            && same(&self.mount, &other.mount)
            && same(&self.screen, &other.screen)
            && same(&self.correction, &other.correction)
            && same(&effects(self), &effects(other))
            && Arc::ptr_eq(&self.findings, &other.findings)
            && self.measured.is(&other.measured)
    }
}

impl State {
    /// Tells the timeline of a world when something of it was put in use, taken back, found or checked.
    pub(super) fn watch_results(&mut self, world: World) {
        let now = self.results_of(world);
        if self.results.of(world).is(&now) {
            return;
        }
        // Before the timeline is told, which comes back here.
        *self.results.of_mut(world) = now;
        self.with::<TimelineWorkflow>(world, |timeline, around, context| timeline.look(around, context));
    }

    /// Has the workflow of a result put in use again what was before. What it refuses is no step.
    fn step_back(&mut self, world: World, step: StepBack) {
        let asked = self.actions.len();
        match (step.subject, step.to.clone()) {
            (Subject::Eyes, id) => {
                let command = EyesCommand::UseEarlier { id };
                self.with::<EyesWorkflow>(world, |room, around, context| {
                    room.apply(command, around, context)
                });
            }
            (Subject::Mount, id) => {
                let command = id.map_or(MountCommand::UseNominal, |id| MountCommand::UseEarlier { id });
                self.with::<MountWorkflow>(world, |room, around, context| {
                    room.apply(command, around, context)
                });
            }
            (Subject::Screen, id) => {
                let command = id
                    .map_or(TouchCommand::UseNominalPlacement, |id| TouchCommand::UseEarlierPlacement { id });
                self.with::<TouchWorkflow>(world, |room, around, context| {
                    room.apply(command, around, context)
                });
            }
            // The workflows of these keep the order in which theirs were in use themselves; what was only measured
            // changed nothing.
            _ => return self.notify(NoticeLevel::Warning, "That cannot be taken back on the timeline."),
        }
        let work = self.actions[asked..].iter().find_map(|action| match action {
            Action::Start(id, Work::Eyes(_) | Work::Mount(_) | Work::Touch(_)) => Some(*id),
            _ => None,
        });
        if let Some(work) = work {
            self.rooms.timeline.of_mut(world).stepping_back(step, work);
        }
    }

    fn results_of(&self, world: World) -> Results {
        let Rooms { eyes, mount, touch, models, gap, .. } = &self.rooms;
        let accepted = eyes.of(world).accepted();
        Results {
            eyes: accepted.map(|in_use| in_use.map(|in_use| in_use.calibration.clone())),
            mount: mount.of(world).accepted().map(|in_use| in_use.cloned()),
            screen: touch.of(world).accepted().map(|in_use| in_use.cloned()),
            correction: models.of(world).accepted().map(|(_, model)| model.cloned()),
            effects: gap.of(world).model().cloned(),
            findings: gap.of(world).entries(),
            measured: self.measured_of(world),
        }
    }
}

impl Neighbors<TimelineWorkflow> for State {
    fn around(&self, world: World) -> TimelineAround {
        let Rooms { eyes, mount, touch, models, gap, .. } = &self.rooms;
        let touch = touch.of(world);
        let in_use = [
            eyes.of(world).accepted().map(|in_use| of_eyes(in_use.map(|in_use| &**in_use))),
            mount.of(world).accepted().map(|in_use| of_mount(in_use.map(|in_use| &**in_use))),
            touch.accepted().map(|in_use| of_screen(in_use.map(|in_use| &**in_use))),
            models.of(world).accepted().map(|(id, model)| {
                of_correction(id, model.map(|model| &**model), models.of(world).mean_before_m())
            }),
            gap.of(world).model().map(|model| of_effects(model, gap.of(world).effects_in_use())),
        ];
        TimelineAround {
            rig: self.rig.name.clone(),
            is_twin: world == World::Twin,
            in_use: in_use.into_iter().flatten().collect(),
            against: self.in_doubt(world).collect(),
            findings: gap.of(world).entries().iter().map(of_finding).collect(),
            measured: self.told_of(world),
        }
    }

    fn after(&mut self, world: World) {
        for step in self.rooms.timeline.of_mut(world).take_steps() {
            self.step_back(world, step);
        }
    }
}

fn nothing(subject: Subject, title: &str) -> Standing {
    Standing {
        subject,
        id: None,
        title: title.to_owned(),
        before: None,
        after: None,
        basis: String::new(),
        accepted: None,
    }
}

fn of_eyes(in_use: Option<&AcceptedCalibration>) -> Standing {
    let Some(AcceptedCalibration { id, calibration, accepted, .. }) = in_use else {
        return nothing(Subject::Eyes, "no calibration: the eyes as they are described");
    };
    let summary = calibration.summary.as_ref();
    let title = match calibration.per_pair.len() {
        0 => "calibration from a file".to_owned(),
        pairs => format!("calibration of {}", counted(pairs, "pair")),
    };
    Standing {
        subject: Subject::Eyes,
        id: Some(id.clone()),
        title,
        before: None,
        after: summary.map(|s| Figure::Pixels(s.cross_validated_px.unwrap_or(s.rms_stereo_px))),
        basis: match summary.and_then(|summary| summary.cross_validated_px) {
            Some(_) => "rms on pairs kept aside, of each calibration its own",
            None if summary.is_some() => "rms on the pairs it was solved from",
            None => "",
        }
        .to_owned(),
        accepted: Some(*accepted),
    }
}

fn of_mount(in_use: Option<&MountCalibration>) -> Standing {
    let Some(mount) = in_use else {
        return nothing(Subject::Mount, "the mount as it is described");
    };
    Standing {
        subject: Subject::Mount,
        id: Some(made_at(mount.evidence.created)),
        title: format!("mount from {}", counted(mount.per_view.len(), "view")),
        before: None,
        after: Some(Figure::Pixels(mount.rms_px)),
        basis: "rms on the views it was solved from".to_owned(),
        accepted: Some(mount.evidence.created),
    }
}

fn of_screen(in_use: Option<&ScreenPlacement>) -> Standing {
    let Some(placement) = in_use else {
        return nothing(Subject::Screen, "the described place");
    };
    Standing {
        subject: Subject::Screen,
        id: Some(made_at(placement.at)),
        title: format!("place from {}", counted(placement.touches, "touch")),
        before: None,
        after: Some(Figure::Meters(placement.rms_m)),
        basis: "rms on the touches that placed it".to_owned(),
        accepted: Some(placement.at),
    }
}

fn of_correction(id: Option<String>, model: Option<&CorrectionModel>, before_m: Option<f64>) -> Standing {
    let Some(model) = model else {
        return nothing(Subject::Correction, "no model corrects targets");
    };
    let made_of = model.provenance();
    let held_out = made_of.cross_validation.as_ref();
    let touches = made_of.touches.len();
    let title = match touches {
        0 => format!("{}, imported", model.method().name()),
        n => format!("{} from {}", model.method().name(), counted(n, "touch")),
    };
    Standing {
        subject: Subject::Correction,
        id,
        title,
        before: before_m.filter(|_| held_out.is_some()).map(Figure::Meters),
        after: held_out.map(|held_out| Figure::Meters(held_out.errors.mean_2d_m)),
        basis: if held_out.is_some() {
            "mean error on the same held-out touches; before: without a model".to_owned()
        } else {
            String::new()
        },
        accepted: None,
    }
}

/// What the errors of a model are that has all that is usually wrong with arms.
const RMS: &str = "rms error along the glass and in height, on touches that were held out; a search counts the mean along the glass";

fn of_effects(model: &RigModel, titles: Vec<String>) -> Standing {
    let Some((place, step)) = model.history.iter().enumerate().rev().find(|(_, step)| step.can_be_undone())
    else {
        return nothing(Subject::Effects, "the robot as it is described");
    };
    let basis = match (step.gap.is_some(), model.is_rms(place)) {
        (false, _) => "",
        (true, false) => "mean error on rows that were not used",
        (true, true) => RMS,
    };
    let of =
        |value: f64, unit: &str| if unit == "px" { Figure::Pixels(value) } else { Figure::Meters(value) };
    let gap = step.gap.as_ref();
    Standing {
        subject: Subject::Effects,
        id: Some(made_at(step.at)),
        title: match (titles.is_empty(), step.sentence == plumbline_handeye::SENTENCE) {
            (true, false) => "the robot as it is described".to_owned(),
            (true, true) => "arms tied to the eyes".to_owned(),
            (false, false) => titles.join("; "),
            (false, true) => format!("arms tied to the eyes, with {}", titles.join("; ")),
        },
        before: gap.map(|gap| of(gap.before, &gap.unit)),
        after: gap.map(|gap| of(gap.after, &gap.unit)),
        basis: basis.to_owned(),
        accepted: Some(step.at),
    }
}

fn of_finding(entry: &FindingEntry) -> Finding {
    let [before, after, _] =
        entry.errors.map(|error| if entry.in_pixels { Figure::Pixels(error) } else { Figure::Meters(error) });
    let title = match entry.named.as_slice() {
        [] => "search: nothing was named".to_owned(),
        named => format!("found: {}", named.join("; ")),
    };
    Finding { id: entry.id.clone(), made: entry.made, title, before, after }
}
